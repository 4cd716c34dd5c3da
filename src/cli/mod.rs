//! The command line: arguments to stages to an exit code.

mod blind;
mod certify;
mod diagnose;
mod effects;
mod explain;
mod inputs;
mod output;
mod places;
mod protocols;
mod sign;
mod simulate;
mod simulator;
mod study;
mod values;
mod verify;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Parser, Subcommand, ValueEnum};

use crate::problem::{acts, plain};
use output::Console;
pub use output::Exit;

/// Validation of rail vehicle simulation models: from a protocol text and a campaign folder to a certification report.
#[derive(Debug, Parser)]
#[command(name = "fishplate", version, about, arg_required_else_help = true)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Print errors only.
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Colours and underlines on the terminal.
    #[arg(long, global = true, value_enum, default_value_t = Color::Auto)]
    color: Color,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Color {
    Auto,
    Always,
    Never,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a protocol over a campaign and write the report.
    #[command(after_help = "Example:\n  fishplate certify examples/coach --out target/coach-report")]
    Certify(certify::Certify),
    /// Check a report: that it agrees with itself and, with its campaign, that the same files still give the same numbers and pages.
    #[command(
        after_help = "Example:\n  fishplate verify target/coach-report/report.pdf examples/coach\n\nExit code: 0 everything agrees, 1 something differs, 2 an input is wrong, 3 could not be finished"
    )]
    Verify(verify::Verify),
    /// Follow one number of a report back to the line of its rule and the rows of its data.
    #[command(after_help = "Example:\n  fishplate trace target/coach-report/results.json Y_max S05 Y_1R --campaign examples/coach")]
    Trace(verify::Trace),
    /// Make a pair of keys to sign reports with.
    #[command(after_help = "Example:\n  fishplate keygen laboratory")]
    Keygen(sign::Keygen),
    /// Sign files; the signatures are files of their own, in the format of minisign.
    #[command(after_help = "Example:\n  fishplate sign target/coach-report/report.pdf --key laboratory.key")]
    Sign(sign::Sign),
    /// How far the verdict depends on choices: sections, synchronisation, parameters of the protocol.
    #[command(after_help = "Example:\n  fishplate study sections examples/coach --out target/coach-sections")]
    Study {
        #[command(subcommand)]
        study: study::Study,
    },
    /// Simulate one section, or every section of a campaign, with the reference vehicle model or another simulator; effects can be added.
    #[command(
        after_help = "Example:\n  fishplate simulate examples/coach --effect friction=0.5 --out target/coach-wet\n  fishplate simulate examples/coach --simulator sim.yaml --increment --effect friction=0.5 --out target/coach-wet\n  fishplate simulate --vehicle examples/coach/vehicle.yaml --track examples/coach/track/S13.csv --speed '70 km/h' -o S13.csv"
    )]
    Simulate(simulate::Simulate),
    /// Say where simulation and measurement differ, which effect causes it, and how far the gap shrinks once it is added.
    #[command(after_help = "Example:\n  fishplate diagnose examples/coach --out target/coach-diagnosis")]
    Diagnose(diagnose::Diagnose),
    /// Diagnose every campaign below folders, then score the answers against the truths that were withheld.
    #[command(after_help = "Example:\n  fishplate blind campaigns --out target/blind")]
    Blind(blind::Blinded),
    /// List the effects that can be added to a simulation, or print a shipped catalogue.
    #[command(after_help = "Example:\n  fishplate effects\n  fishplate effects --text > mine.yaml")]
    Effects(effects::Effects),
    /// Check protocols: every problem with its place.
    #[command(after_help = "Example:\n  fishplate check protocols/en14363-2016-annex-t.fp my-variant.yaml")]
    Check {
        /// Paths of protocols, or names of shipped ones.
        #[arg(required = true, value_name = "PROTOCOL")]
        protocols: Vec<String>,
    },
    /// Write protocols in canonical form.
    #[command(after_help = "Example:\n  fishplate fmt my-variant.fp\n  fishplate fmt --check protocols/*.fp")]
    Fmt {
        #[arg(required = true, value_name = "PROTOCOL")]
        protocols: Vec<PathBuf>,
        /// Change nothing; exit with 1 if a file is not in canonical form.
        #[arg(long)]
        check: bool,
    },
    /// Turn a protocol into the other form, without loss.
    #[command(after_help = "Example:\n  fishplate convert en14363-2016-annex-t --to yaml -o annex-t.yaml")]
    Convert {
        #[arg(value_name = "PROTOCOL")]
        protocol: String,
        #[arg(long, value_enum)]
        to: Form,
        /// File to write; the terminal otherwise.
        #[arg(long, short)]
        output: Option<PathBuf>,
    },
    /// Show a protocol at any stage; without a protocol, everything the language can do with signals and numbers.
    #[command(
        after_help = "Example:\n  fishplate explain en14363-2016-annex-t --stage graph --format svg -o graph.svg\n  fishplate explain"
    )]
    Explain(explain::Explain),
    /// What differs in meaning between two protocols, rule by rule.
    #[command(after_help = "Example:\n  fishplate diff en14363-2016-annex-t my-variant.fp")]
    Diff {
        #[arg(value_name = "PROTOCOL")]
        before: String,
        #[arg(value_name = "PROTOCOL")]
        after: String,
    },
    /// List the shipped protocols, or print one.
    #[command(after_help = "Example:\n  fishplate protocols\n  fishplate protocols sprague-geers > mine.fp")]
    Protocols {
        #[arg(value_name = "NAME")]
        name: Option<String>,
    },
    /// Print the JSON Schema of the YAML form, for editors.
    #[command(after_help = "Example:\n  fishplate schema > protocol.schema.json")]
    Schema,
    /// Print shell completions.
    #[command(after_help = "Example:\n  fishplate completions bash > /etc/bash_completion.d/fishplate")]
    Completions {
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
    /// Write the manual pages.
    #[command(after_help = "Example:\n  fishplate man --out target/man")]
    Man {
        #[arg(long)]
        out: PathBuf,
    },
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Form {
    Yaml,
    Fp,
}

/// Runs the program as called.
pub fn run() -> Exit {
    run_with(std::env::args_os())
}

/// Runs the program with arguments, its own name first.
pub fn run_with(words: impl IntoIterator<Item = OsString>) -> Exit {
    let words: Vec<OsString> = words.into_iter().collect();
    let arguments = match Arguments::try_parse_from(&words) {
        Ok(arguments) => arguments,
        Err(error) => {
            // clap prints help and versions this way too, which are no errors.
            let failed = error.use_stderr();
            if words.iter().any(|word| word.to_string_lossy().chars().any(acts)) {
                eprint!("{}", plain(&error.render().to_string()));
            } else {
                let _ = error.print();
            }
            return if failed { Exit::Wrong } else { Exit::Done };
        }
    };
    let console = Console::new(arguments.quiet, arguments.color);
    match arguments.command {
        Command::Certify(certify) => certify.run(&console),
        Command::Verify(verify) => verify.run(&console),
        Command::Trace(trace) => trace.run(&console),
        Command::Keygen(keygen) => keygen.run(&console),
        Command::Sign(sign) => sign.run(&console),
        Command::Study { study } => study.run(&console),
        Command::Simulate(simulate) => simulate.run(&console),
        Command::Diagnose(diagnose) => diagnose.run(&console),
        Command::Blind(blinded) => blinded.run(&console),
        Command::Effects(effects) => effects.run(&console),
        Command::Check { protocols } => protocols::check(&protocols, &console),
        Command::Fmt { protocols, check } => protocols::fmt(&protocols, check, &console),
        Command::Convert { protocol, to, output } => protocols::convert(&protocol, matches!(to, Form::Yaml), output.as_deref(), &console),
        Command::Explain(explain) => explain.run(&console),
        Command::Diff { before, after } => protocols::diff(&before, &after, &console),
        Command::Protocols { name } => protocols::list(name.as_deref(), &console),
        Command::Schema => console.print(&(serde_json::to_string_pretty(&crate::syntax::schema::json_schema()).unwrap_or_default() + "\n")),
        Command::Completions { shell } => {
            let mut bytes = Vec::new();
            clap_complete::generate(shell, &mut <Arguments as clap::CommandFactory>::command(), "fishplate", &mut bytes);
            console.print(&String::from_utf8_lossy(&bytes))
        }
        Command::Man { out } => protocols::man(&out, &console),
    }
}
