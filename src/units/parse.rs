//! Reads compound units: products by space, `*` or `·`, one or more `/`, powers as `^2`, `²`, `^-1`,
//! `m2`, `^1.5` or `^(1/3)`.

use super::{Dimension, SYMBOLS, Symbol, Unit, UnknownUnit, raised};

pub(super) fn unit(text: &str) -> Result<Unit, UnknownUnit> {
    let mut factor = 1.0;
    let mut dimension = Dimension::ONE;
    let mut below = false;
    let mut expects_symbol = true;
    let mut rest = text.trim();
    let unknown = |word: &str| UnknownUnit { word: word.to_string(), near: near(word) };
    if rest.is_empty() {
        return Err(unknown(text));
    }
    while !rest.is_empty() {
        let first = rest.chars().next().unwrap_or(' ');
        match first {
            ' ' | '*' | '·' if !expects_symbol => {
                rest = rest[first.len_utf8()..].trim_start();
                expects_symbol = !rest.starts_with('/');
                continue;
            }
            '/' if !expects_symbol => {
                below = true;
                rest = rest[1..].trim_start();
                expects_symbol = true;
                continue;
            }
            _ if !expects_symbol => return Err(unknown(rest)),
            _ => {}
        }
        let mut inside = false;
        let ends = |c: char| {
            inside = c == '(' || inside && c != ')';
            !inside && matches!(c, ' ' | '*' | '·' | '/')
        };
        let end = rest.find(ends).unwrap_or(rest.len());
        let word = &rest[..end];
        let (symbol, exponent) = power(word).ok_or_else(|| unknown(word))?;
        let known =
            SYMBOLS.iter().find(|known| known.symbol == symbol).ok_or_else(|| unknown(symbol))?;
        let exponent = if below { -exponent } else { exponent };
        factor *= raised(known.factor, exponent);
        dimension = dimension * known.dimension.power(exponent).ok_or_else(|| unknown(word))?;
        rest = &rest[end..];
        expects_symbol = false;
    }
    if expects_symbol {
        return Err(unknown(text));
    }
    let text = if text.trim() == "1" { "-" } else { text.trim() };
    Ok(Unit { text: text.to_string(), factor, dimension })
}

/// The symbol that a word most likely stands for.
fn near(word: &str) -> Option<&'static str> {
    let symbols = || SYMBOLS.iter().map(|known| known.symbol);
    let same = symbols().find(|symbol| symbol.eq_ignore_ascii_case(word));
    same.or_else(|| {
        // Of two letters, one is half of the word: `dB` is not a slip of `dm`.
        symbols().find(|symbol| {
            symbol.len() > 1 && word.len() > 2 && strsim::levenshtein(symbol, word) == 1
        })
    })
}

/// The unit of a dimension that a number with another unit probably has: `0.65 gn` of an
/// acceleration for `0.65 g`, in words of help.
pub(super) fn meant(number: &str, wanted: Dimension) -> Option<String> {
    let (digits, written) = number.split_at(super::number_end(number));
    let written = written.trim();
    let own = SYMBOLS.iter().find(|known| known.symbol == written)?;
    // A metre is not a slip of `mN`, though its symbol is a prefix.
    let prefix = ["m", "h", "T"].contains(&written);
    let begins = |symbol: &Symbol| {
        let same = symbol.symbol.eq_ignore_ascii_case(written);
        same || !prefix && symbol.symbol.starts_with(written)
    };
    let meant = SYMBOLS.iter().find(|known| known.dimension == wanted && begins(known))?;
    let (name, symbol) = (own.name, meant.symbol);
    Some(format!(
        "`{written}` is the {name}; the {} is `{symbol}`: `{digits} {symbol}`",
        meant.name
    ))
}

/// `s^2`, `s²`, `s2`, `m^-1` into symbol and exponent.
fn power(word: &str) -> Option<(&str, f64)> {
    if word == "1" {
        return Some((word, 1.0));
    }
    let usual = |exponent: &f64| (-9.0..=9.0).contains(exponent);
    if let Some((symbol, exponent)) = word.split_once('^') {
        let bare = exponent.strip_prefix('(').and_then(|inner| inner.strip_suffix(')'));
        let exponent = match bare.and_then(|bare| bare.split_once('/')) {
            Some((above, below)) => {
                above.trim().parse::<f64>().ok()? / below.trim().parse::<f64>().ok()?
            }
            None => bare.unwrap_or(exponent).parse().ok()?,
        };
        return Some((symbol, exponent)).filter(|(_, exponent)| usual(exponent));
    }
    for (mark, exponent) in [("⁻¹", -1.0), ("⁻²", -2.0), ("²", 2.0), ("³", 3.0)] {
        if let Some(symbol) = word.strip_suffix(mark) {
            return Some((symbol, exponent));
        }
    }
    let digits = word.trim_end_matches(|c: char| c.is_ascii_digit());
    if digits.len() < word.len() && !digits.is_empty() {
        return Some((
            digits,
            word[digits.len()..].parse().ok().filter(|exponent| (1.0..=9.0).contains(exponent))?,
        ));
    }
    Some((word, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_the_field() {
        // (text, factor to SI, dimension); factors by definition of the units
        for (text, factor, dimension) in [
            ("kN", 1e3, [1, 1, -2, 0, 0, 0]),
            ("m/s^2", 1.0, [1, 0, -2, 0, 0, 0]),
            ("m/s²", 1.0, [1, 0, -2, 0, 0, 0]),
            ("m s^-2", 1.0, [1, 0, -2, 0, 0, 0]),
            ("km/h", 1.0 / 3.6, [1, 0, -1, 0, 0, 0]),
            ("N s/m", 1.0, [0, 1, -1, 0, 0, 0]),
            ("kN*m", 1e3, [2, 1, -2, 0, 0, 0]),
            ("1/m", 1.0, [-1, 0, 0, 0, 0, 0]),
            ("mm", 1e-3, [1, 0, 0, 0, 0, 0]),
            ("-", 1.0, [0; 6]),
            ("mrad/mm", 1.0, [-1, 0, 0, 0, 0, 0]),
            ("t", 1e3, [0, 1, 0, 0, 0, 0]),
        ] {
            let unit = unit(text).unwrap_or_else(|e| panic!("{text}: {e:?}"));
            assert!((unit.factor / factor - 1.0).abs() < 1e-15, "{text}");
            assert_eq!(unit.dimension, Dimension::of(dimension), "{text}");
        }
    }

    /// Factors by definition: a kilowatt to the power of 0.3 is 1000^0.3 of a watt's.
    #[test]
    fn powers_with_decimals_and_fractions() {
        for (text, factor, dimension) in [
            ("m/s^1.5", 1.0, "m s^-1.5"),
            ("mm/s^1.5", 1e-3, "m s^-1.5"),
            ("m s^-1.5", 1.0, "m s^-1.5"),
            ("m^0.5", 1.0, "m^0.5"),
            ("km^(1/3)", 10.0, "m^(1/3)"),
            ("N/m^(-2/3)", 1.0, "m^(5/3) kg s^-2"),
            ("kW^0.3", 7.943_282_347_242_815, "m^0.6 kg^0.3 s^-0.9"),
        ] {
            let unit = unit(text).unwrap_or_else(|e| panic!("{text}: {e:?}"));
            assert!((unit.factor / factor - 1.0).abs() < 1e-15, "{text}");
            assert_eq!(unit.dimension.to_string(), dimension, "{text}");
        }
        for text in
            ["m^0.333", "m^(1/7)", "m^(1/0)", "m^(1/3", "m^1/3)", "m^nan", "m^9.5", "m^(/3)"]
        {
            assert!(unit(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_unit_of_another_dimension_is_told_where_it_begins_alike() {
        let dimension = |text: &str| unit(text).expect("a unit").dimension;
        let help = |number: &str, wanted: &str| meant(number, dimension(wanted));
        let told = "`g` is the gram; the standard acceleration of gravity is `gn`: `0.65 gn`";
        assert_eq!(help("0.65 g", "m/s^2").as_deref(), Some(told));
        assert!(help("3 kg", "kN").is_some_and(|help| help.ends_with("`3 kgf`")));
        assert!(help("3 T", "kg").is_some_and(|help| help.ends_with("`3 t`")));
        for (number, wanted) in [("3 m", "kN"), ("3 mm", "kN"), ("3", "kN"), ("3 xyz", "kN")] {
            assert_eq!(help(number, wanted), None, "{number}");
        }
    }

    #[test]
    fn nonsense_is_refused_with_the_nearest_symbol() {
        assert_eq!(unit("kn").expect_err("no such unit").near, Some("kN"));
        for text in ["", "m/", "/s", "m//s", "kN^x", "m^99", "m s/ "] {
            assert!(unit(text).is_err(), "{text}");
        }
    }
}
