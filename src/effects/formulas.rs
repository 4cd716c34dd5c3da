//! Reads the parts of a catalogue in the protocol language: `signals` of an effect.

use super::{
    catalogue::{Action, Parameter},
    expression::{Formula, Known},
    read::{CHANNEL, Reader},
};
use crate::problem::problem;
use crate::syntax::document::Text;
use crate::units::Unit;
use crate::yaml::Node;

impl Reader<'_, '_> {
    /// `signals`: channels with their expressions.
    pub fn formulas(
        &mut self,
        effect: &Node,
        signals: &Node,
        parameters: &[Parameter],
    ) -> Option<Action> {
        for key in ["operator", "channels", "each", "together"] {
            if let Some((key, _)) = effect.entry(key) {
                self.fault(
                    "contradiction",
                    format!(
                        "`{}` cannot be combined with `signals`, which defines the channels itself",
                        key.text
                    ),
                    &key.span,
                );
            }
        }
        if signals.entries().is_empty() {
            self.tell(signals.is_not("`signals`", "a map of channels and expressions"));
            return None;
        }
        for Parameter { name, neutral, .. } in parameters {
            if neutral.is_some() && !name.contains(CHANNEL) {
                continue;
            }
            let says = format!(
                "`{name}` needs a number as `neutral`, at which the expressions change nothing"
            );
            self.fault("key-missing", says, effect.span_of("parameters"));
        }
        let named = |Parameter { name, unit, .. }: &Parameter| {
            (name.rsplit('.').next().unwrap_or_default().to_string(), unit.clone())
        };
        let names: Vec<(String, Unit)> = parameters.iter().map(named).collect();
        let channels = self.with.units.clone();
        let mut formulas = Vec::new();
        for (key, written) in signals.entries() {
            let Some((_, unit)) = channels.iter().find(|(channel, _)| *channel == key.text) else {
                let known = channels.iter().map(|(channel, _)| channel);
                self.tell(
                    problem!(
                        "unit-missing",
                        &key.span,
                        "the channel `{}` has no unit in this catalogue",
                        key.text
                    )
                    .suggest(&key.text, known),
                );
                continue;
            };
            let Some(text) = written.scalar_text() else {
                self.tell(written.is_not("an expression", "text"));
                continue;
            };
            let text =
                Text { text: text.to_string(), span: written.span.clone(), exact: written.exact };
            let known = Known { channels: &channels, parameters: &names };
            formulas.extend(Formula::read((&key.text, unit), &text, known, self.problems));
        }
        Some(Action::Formulas(formulas))
    }
}
