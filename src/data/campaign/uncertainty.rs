//! Uncertainties of the channels, as `campaign.yaml` states them: the one source of all that
//! computes with them.

use crate::data::prelude::*;
use crate::units::number;
use crate::yaml::{OneOrMore, Reader, span_of_value};

/// The key in `campaign.yaml`.
pub const UNCERTAINTY: &str = "uncertainty";

/// The key that holds for all channels.
const CORRELATED: &str = "correlated";

/// Of what an uncertainty is, as one standard deviation.
#[derive(Clone, Debug, PartialEq)]
pub enum Size {
    /// Of the factor between true and measured value.
    Gain(f64),
    /// Of what is added to the measured value, in SI, and the unit in which it is stated.
    Offset(f64, Unit),
}

impl Size {
    pub fn word(&self) -> &'static str {
        match self {
            Self::Gain(_) => "gain",
            Self::Offset(..) => "offset",
        }
    }

    pub fn si(&self) -> f64 {
        let (Self::Gain(standard) | Self::Offset(standard, _)) = *self;
        standard
    }
}

/// One uncertainty of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    pub channel: Spanned<String>,
    pub size: Size,
    /// One error for all positions of the channel, or one for each.
    pub correlated: bool,
    pub span: Span,
}

fields! {
    /// As it is written.
    struct Written: "an uncertainty" {
        "standard" standard: Option<Spanned<String>>,
        "expanded" expanded: Option<Spanned<String>>,
        "k" k: Option<Spanned<f64>>,
        "correlated" correlated: Option<bool>,
    } also {
        span: Span = span_of_value,
    }
}

/// The uncertainties of the channels: `Y: {expanded: 1 kN, k: 2}`, several of one in a list.
///
/// Problems: `wrong-kind`, `unknown-key`, `key-missing`, `unknown-unit`, `uncertainty-coverage` (no
/// factor to an expanded one, or one that is not above zero), `uncertainty-twice`.
pub fn uncertainties<C>(
    reader: &mut Reader<'_, C>,
    key: &Key,
    node: &Node,
) -> Option<Vec<Uncertainty>> {
    if node.entries().is_empty() {
        let problem = node.is_not(&format!("`{}`", key.text), "a map of channels");
        reader.tell(problem.help("for instance: `uncertainty: {Y: {expanded: 1 kN, k: 2}}`"));
    }
    let correlated = reader.optional(node, CORRELATED).unwrap_or(true);
    let mut all: Vec<Uncertainty> = Vec::new();
    for (key, node) in node.entries().iter().filter(|(key, _)| key.text != CORRELATED) {
        let channel = Spanned::new(key.text.trim().to_string(), key.span.clone());
        let OneOrMore(written) = OneOrMore::<Written>::from_node(reader, key, node)?;
        for written in written {
            let Some(size) = reader.keep(size(&channel.value, &written)) else { continue };
            let kind = size.word();
            let same = |known: &&Uncertainty| {
                known.channel.value == channel.value && known.size.word() == kind
            };
            if let Some(first) = all.iter().find(same) {
                let problem = problem!(
                    "uncertainty-twice",
                    &written.span,
                    "the uncertainty of the {kind} of `{}` is stated twice",
                    channel.value
                );
                reader.tell(problem.also(&first.span, "first here"));
                continue;
            }
            let correlated = written.correlated.unwrap_or(correlated);
            let (channel, span) = (channel.clone(), written.span);
            all.push(Uncertainty { channel, size, correlated, span });
        }
    }
    Some(all)
}

/// One standard deviation.
fn size(channel: &str, written: &Written) -> Result<Size, Problem> {
    let (text, factor) = match (&written.standard, &written.expanded) {
        (Some(standard), None) => {
            if let Some(k) = &written.k {
                let says = "a standard uncertainty has no coverage factor `k`";
                return Err(error("uncertainty-coverage", says, &k.span)
                    .help("write `expanded` in place of `standard`, or leave `k` out"));
            }
            (standard, 1.0)
        }
        (None, Some(expanded)) => match &written.k {
            Some(k) if k.value > 0.0 => (expanded, k.value),
            Some(k) => {
                let says = format!("the coverage factor `k` must be above zero, not {}", k.value);
                return Err(error("uncertainty-coverage", says, &k.span));
            }
            None => {
                let says = format!("the expanded uncertainty of `{channel}` has no `k`");
                return Err(error("uncertainty-coverage", says, &expanded.span)
                    .help("write the coverage factor of the calibration certificate: `k: 2`"));
            }
        },
        (None, None) => {
            let says = format!("the uncertainty of `{channel}` has no size");
            return Err(error("key-missing", says, &written.span.part(0..0))
                .help("write `{standard: 0.5 kN}` or `{expanded: 1 kN, k: 2}`"));
        }
        (Some(standard), Some(expanded)) => {
            let says = format!("the uncertainty of `{channel}` is both standard and expanded");
            return Err(error("wrong-kind", says, &expanded.span)
                .also(&standard.span, "the standard uncertainty"));
        }
    };
    sized(&text.value, factor).map_err(|problem| problem.at(&text.span))
}

/// A number in per cent is of the gain; one in another unit is of an offset.
fn sized(text: &str, factor: f64) -> Result<Size, Problem> {
    let any = Unit::parse("-").map_err(|_| Problem::error("unknown-unit", "no unit"))?;
    let wrong = |says: String| Problem::error("wrong-kind", says);
    let (value, unit) =
        number::split(text, &any).map_err(|refused| wrong(refused.says).help_if(refused.help))?;
    if value < 0.0 {
        return Err(wrong(format!("an uncertainty is a number from 0 on, not `{text}`")));
    }
    if unit.is_empty() {
        let help = "in `%` it is of the gain, in the unit of the channel of an offset: `1 %`, `0.5 kN`, `0.02 -`";
        return Err(wrong(format!("the uncertainty `{text}` has no unit")).help(help));
    }
    let unit = Unit::parse(unit).map_err(|unknown| {
        let problem =
            Problem::error("unknown-unit", format!("`{}` is not a known unit", unknown.word));
        problem.help_if(unknown.near.map(|near| format!("did you mean `{near}`?")))
    })?;
    let standard = unit.to_si(value) / factor;
    Ok(if unit.text == "%" { Size::Gain(standard) } else { Size::Offset(standard, unit) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_expanded_uncertainty_is_divided_by_its_factor() {
        let kilonewton = Unit::parse("kN").expect("known");
        assert_eq!(sized("1 kN", 2.0).ok(), Some(Size::Offset(500.0, kilonewton)));
        assert_eq!(sized("3 %", 2.0).ok(), Some(Size::Gain(0.015)));
        // A share that is not in per cent is an offset of a channel without unit.
        assert!(matches!(sized("0.02 -", 1.0), Ok(Size::Offset(standard, _)) if standard == 0.02));
        for (text, code) in [
            ("0.5", "wrong-kind"),
            ("-1 %", "wrong-kind"),
            ("1 furlong", "unknown-unit"),
            ("about", "wrong-kind"),
        ] {
            assert_eq!(sized(text, 1.0).expect_err("refused").code, code, "{text}");
        }
    }
}
