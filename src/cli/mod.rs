//! The command line: from arguments to an exit code.

mod blind;
mod certify;
mod compare;
mod convert_records;
mod diagnose;
mod effects;
mod exercise;
mod explain;
mod impact;
mod import;
mod init;
mod inputs;
mod kit;
mod needs;
mod new;
mod of_runs;
mod output;
mod places;
mod protocols;
mod reduce;
mod report;
mod scaffold;
pub mod schema;
mod sections;
mod sign;
mod simulate;
mod simulator;
mod sources;
mod study;
mod values;
mod verify;

use std::{
    ffi::OsString,
    io::{ErrorKind, Write},
    path::PathBuf,
};

use clap::{Parser, Subcommand, ValueEnum};

use crate::problem::plain;
use output::Console;
pub use output::Exit;

/// Validates simulation models of rail vehicles: a protocol and a campaign of records give a
/// certification report.
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
    /// Evaluate a protocol on a campaign and write the report.
    #[command(
        after_help = "Examples:\n  fishplate certify examples/coach --out target/coach-report\n  fishplate certify examples/coach-good examples/coach --out target/coach-pool"
    )]
    Certify(certify::Certify),
    /// Evaluate a part of the sections of a campaign to a file of values, to be judged together
    /// with the other parts.
    #[command(
        after_help = "Example:\n  fishplate reduce examples/coach --shard 0/2 --out target/values-0.parquet\n  fishplate reduce examples/coach --shard 1/2 --out target/values-1.parquet\n  fishplate judge target/values-0.parquet target/values-1.parquet --out target/judged"
    )]
    Reduce(reduce::Reduce),
    /// Write the report of a campaign from the values of all its parts: the same bytes as those of
    /// `certify`.
    #[command(
        after_help = "Example:\n  fishplate judge target/values-0.parquet target/values-1.parquet --out target/judged"
    )]
    Judge(reduce::Judge),
    /// Check that a report is consistent and, with its campaign, that the same files still give the
    /// same numbers and pages.
    #[command(
        after_help = "Example:\n  fishplate verify target/coach-report/report.pdf examples/coach\n\nExit code: 0 everything agrees, 1 something differs, 2 an input is wrong, 3 the check could not be completed"
    )]
    Verify(verify::Verify),
    /// Trace one number of a report to the line of its rule and to the rows of its data.
    #[command(
        after_help = "Example:\n  fishplate trace target/coach-report/results.json Y_max S05 Y_1R --campaign examples/coach"
    )]
    Trace(verify::Trace),
    /// Create a pair of keys for signing reports.
    #[command(after_help = "Example:\n  fishplate keygen laboratory")]
    Keygen(sign::Keygen),
    /// Sign files; each signature is a separate file in the format of minisign.
    #[command(
        after_help = "Example:\n  fishplate sign target/coach-report/report.pdf --key laboratory.key"
    )]
    Sign(sign::Sign),
    /// Find sections in the runs of a campaign, as a protocol says, and write them as a table of
    /// sections.
    #[command(
        after_help = "Example:\n  fishplate sections examples/run --out target/found-sections.csv"
    )]
    Sections(sections::Sections),
    /// Study how the verdict depends on the sections, the synchronisation and the parameters of the
    /// protocol, and how far it is from another one.
    #[command(
        after_help = "Example:\n  fishplate study sections examples/coach --out target/coach-sections"
    )]
    Study {
        #[command(subcommand)]
        study: study::Study,
    },
    /// Compare protocols side by side over campaigns: verdicts, agreement, sensitivity,
    /// applicability, and what each difference does.
    #[command(
        after_help = "Example:\n  fishplate compare examples/coach --protocol en14363-2016-annex-t --protocol sprague-geers --out target/coach-compared"
    )]
    Compare(compare::Compare),
    /// Replay an archive of campaigns under the old and the new text of a protocol: which verdicts
    /// differ, which changed rules suffice for it, and how close the others came.
    #[command(
        after_help = "Examples:\n  fishplate impact en14363-2016-annex-t en14363-2016-annex-t-strict-acceleration --over examples/coach examples/coach-good --out target/impact\n  fishplate reduce examples/coach --out target/coach-values.parquet\n  fishplate impact en14363-2016-annex-t my-proposal.fp --over target/coach-values.parquet --out target/impact"
    )]
    Impact(impact::Impact),
    /// Write, for each limit of a protocol, two campaigns that meet and exceed it by less than
    /// 0.1 % and differ in nothing else.
    #[command(
        after_help = "Example:\n  fishplate exercise en14363-2016-annex-t --from examples/coach-good --out target/exercise"
    )]
    Exercise(exercise::Exercise),
    /// Simulate one section or a whole campaign, with the reference vehicle model or another
    /// simulator; effects can be added.
    #[command(
        after_help = "Example:\n  fishplate simulate examples/coach --effect friction=0.5 --out target/coach-wet\n  fishplate simulate examples/coach --simulator sim.yaml --increment --effect friction=0.5 --out target/coach-wet\n  fishplate simulate --vehicle examples/coach/vehicle.yaml --track examples/coach/track/S13.csv --speed '70 km/h' -o S13.csv"
    )]
    Simulate(simulate::Simulate),
    /// Locate the differences of simulation and measurement, identify their cause, and compute how
    /// far the gap decreases with it.
    #[command(
        after_help = "Example:\n  fishplate diagnose examples/coach --out target/coach-diagnosis"
    )]
    Diagnose(diagnose::Diagnose),
    /// Import records of other systems, as a mapping states, to a campaign; or propose a mapping
    /// from the files.
    #[command(
        after_help = "Example:\n  fishplate import examples/foreign/mapping.yaml --out target/foreign\n  fishplate import --draft examples/foreign/*/* --out target/draft.yaml"
    )]
    Import(import::Import),
    /// Diagnose all campaigns in folders, then score the answers against the withheld truths.
    #[command(after_help = "Example:\n  fishplate blind campaigns --out target/blind")]
    Blind(blind::Blinded),
    /// List the effects that can be added to a simulation, or print a shipped catalogue.
    #[command(after_help = "Example:\n  fishplate effects\n  fishplate effects --text > mine.yaml")]
    Effects(effects::Effects),
    /// Write the draft of a protocol and an empty campaign, from a list of channels or from what a
    /// protocol needs.
    #[command(
        after_help = "Examples:\n  fishplate init target/new --channels \"Y_1R [kN], Y_1L [kN], ay_I [m/s^2]\"\n  fishplate init target/new --channels-from examples/coach/measurement/S01.csv\n  fishplate init target/new --extends en14363-2016-annex-t"
    )]
    Init(init::Init),
    /// Make a campaign, a protocol, a catalogue of effects and the stub of a simulator for any
    /// machine, from simulated and measured records.
    #[command(
        after_help = "Example:\n  fishplate new target/axis --domain drive --from sim.csv meas.csv --from sim2.csv meas2.csv"
    )]
    New(new::New),
    /// Check protocols, and show every problem with its place.
    #[command(
        after_help = "Example:\n  fishplate check protocols/en14363-2016-annex-t.fp my-variant.yaml"
    )]
    Check {
        /// Paths of protocols, or names of shipped ones.
        #[arg(required = true, value_name = "PROTOCOL")]
        protocols: Vec<String>,
    },
    /// Write protocols in canonical form.
    #[command(
        after_help = "Example:\n  fishplate fmt my-variant.fp\n  fishplate fmt --check protocols/*.fp"
    )]
    Fmt {
        #[arg(required = true, value_name = "PROTOCOL")]
        protocols: Vec<PathBuf>,
        /// Change nothing; exit with 1 if a file is not in canonical form.
        #[arg(long)]
        check: bool,
    },
    /// Convert a protocol to the other form, without loss.
    #[command(
        after_help = "Example:\n  fishplate convert en14363-2016-annex-t --to yaml -o annex-t.yaml"
    )]
    Convert {
        #[arg(value_name = "PROTOCOL")]
        protocol: String,
        #[arg(long, value_enum)]
        to: Form,
        /// Output file [default: standard output]
        #[arg(long, short)]
        output: Option<PathBuf>,
    },
    /// Copy a campaign with its records in another format, CSV or Parquet; no number changes.
    #[command(
        after_help = "Example:\n  fishplate convert-records examples/coach --to parquet --out target/coach-parquet"
    )]
    ConvertRecords(convert_records::ConvertRecords),
    /// Show a protocol at any stage of its processing, or what it needs; without a protocol, list
    /// the functions of the language.
    #[command(
        after_help = "Example:\n  fishplate explain en14363-2016-annex-t --stage graph --format svg -o graph.svg\n  fishplate explain en14363-2016-annex-t --stage needs --format csv -o needs.csv\n  fishplate explain"
    )]
    Explain(explain::Explain),
    /// Show the differences in meaning between two protocols, rule by rule.
    #[command(after_help = "Example:\n  fishplate diff en14363-2016-annex-t my-variant.fp")]
    Diff {
        #[arg(value_name = "PROTOCOL")]
        before: String,
        #[arg(value_name = "PROTOCOL")]
        after: String,
    },
    /// List the shipped protocols, or print one.
    #[command(
        after_help = "Example:\n  fishplate protocols\n  fishplate protocols sprague-geers > mine.fp"
    )]
    Protocols {
        #[arg(value_name = "NAME")]
        name: Option<String>,
    },
    /// Print the JSON Schema of the YAML form, for editors, or of a file of results.
    #[command(
        after_help = "Examples:\n  fishplate schema > protocol.schema.json\n  fishplate schema --of results"
    )]
    Schema {
        /// Whose schema.
        #[arg(long, value_enum, default_value_t = schema::Of::Protocol)]
        of: schema::Of,
    },
    /// Print shell completions.
    #[command(
        after_help = "Example:\n  fishplate completions bash > /etc/bash_completion.d/fishplate"
    )]
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

/// Runs the program with the arguments of the process.
pub fn run() -> Exit {
    run_with(std::env::args_os())
}

/// Runs the program with arguments; the first one is its name.
pub fn run_with(words: impl IntoIterator<Item = OsString>) -> Exit {
    let words: Vec<OsString> = words.into_iter().collect();
    let arguments = match Arguments::try_parse_from(&words) {
        Ok(arguments) => arguments,
        Err(error) => {
            // The same of words that a terminal can show: the message repeats them.
            let plain = words.iter().map(|word| plain(&word.to_string_lossy()));
            let error = Arguments::try_parse_from(plain).err().unwrap_or(error);
            let printed = error.print().and_then(|()| std::io::stdout().flush());
            // clap also reports help and version as errors, which go to standard output.
            return match printed {
                _ if error.use_stderr() => Exit::Wrong,
                Err(why) if why.kind() != ErrorKind::BrokenPipe => Exit::Unfinished,
                _ => Exit::Done,
            };
        }
    };
    let console = Console::new(arguments.quiet, arguments.color);
    let done = match arguments.command {
        Command::Certify(certify) => certify.run(&console),
        Command::Reduce(reduce) => reduce.run(&console),
        Command::Judge(judge) => judge.run(&console),
        Command::Verify(verify) => verify.run(&console),
        Command::Trace(trace) => trace.run(&console),
        Command::Keygen(keygen) => keygen.run(&console),
        Command::Sign(sign) => sign.run(&console),
        Command::Sections(sections) => sections.run(&console),
        Command::Study { study } => study.run(&console),
        Command::Compare(compare) => compare.run(&console),
        Command::Impact(impact) => impact.run(&console),
        Command::Exercise(exercise) => exercise.run(&console),
        Command::Simulate(simulate) => simulate.run(&console),
        Command::Diagnose(diagnose) => diagnose.run(&console),
        Command::Import(import) => import.run(&console),
        Command::Blind(blinded) => blinded.run(&console),
        Command::Effects(effects) => effects.run(&console),
        Command::Init(init) => init.run(&console),
        Command::New(new) => new.run(&console),
        Command::Check { protocols } => protocols::check(&protocols, &console),
        Command::Fmt { protocols, check } => protocols::fmt(&protocols, check, &console),
        Command::Convert { protocol, to, output } => {
            protocols::convert(&protocol, matches!(to, Form::Yaml), output.as_deref(), &console)
        }
        Command::ConvertRecords(convert) => convert.run(&console),
        Command::Explain(explain) => explain.run(&console),
        Command::Diff { before, after } => protocols::diff(&before, &after, &console),
        Command::Protocols { name } => protocols::list(name.as_deref(), &console),
        Command::Schema { of } => schema::print(of, &console),
        Command::Completions { shell } => {
            let mut bytes = Vec::new();
            clap_complete::generate(
                shell,
                &mut <Arguments as clap::CommandFactory>::command(),
                "fishplate",
                &mut bytes,
            );
            console.print_file(&String::from_utf8_lossy(&bytes))
        }
        Command::Man { out } => protocols::man(&out, &console),
    };
    done.unwrap_or_else(|ended| {
        console.problems(&ended.problems);
        ended.exit
    })
}
