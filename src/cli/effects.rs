//! `effects`: lists the effects that can be added to a simulation.

use std::fmt::Write;

use super::{kit::*, simulate::load_catalogue};
use crate::effects::{Action, Catalogue};
use crate::yaml::Words;

#[derive(Debug, Args)]
pub struct Effects {
    /// Catalogue of effects: a path, or the name of a shipped one.
    #[arg(default_value = library::CATALOGUES[0].name)]
    catalogue: String,
    /// Print the text of the catalogue instead of a list.
    #[arg(long)]
    text: bool,
}

impl Effects {
    pub fn run(self, console: &Console) -> Done {
        let catalogue = console.read(|problems| load_catalogue(&self.catalogue, problems))?;
        if self.text {
            console.print_file(&catalogue.source.text)
        } else {
            console.print(&list(&catalogue))
        }
    }
}

fn list(catalogue: &Catalogue) -> Lines {
    let mut out = Lines::default();
    out += &catalogue.title;
    for effect in &catalogue.effects {
        let how = match &effect.action {
            Action::Simulator => "simulated".to_string(),
            Action::Formulas(_) => "signals: expressions".to_string(),
            Action::Signals(operator, _) => format!("signals: {}", operator.word()),
        };
        out += "\n";
        let _ = writeln!(out, "{}  ({}, {how})", effect.name, effect.acts.word());
        let _ = writeln!(out, "  {}: {}", effect.title, effect.means);
        for parameter in &effect.parameters {
            let unit = parameter.unit.suffix();
            let neutral = parameter
                .neutral
                .map_or("as in the vehicle file".to_string(), |value| format!("{value}{unit}"));
            let _ = writeln!(
                out,
                "    {:42} {} to {}{unit}, neutral {neutral}",
                parameter.name, parameter.low, parameter.high
            );
        }
    }
    out
}
