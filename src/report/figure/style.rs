//! Common style of all figures: colours, type, marks. Every distinction by colour is also made by
//! shape or line, so that a figure is readable in grey and for colour-blind readers.

use std::fmt;

use crate::report::visible::visible;

/// Font families of all text; the later ones are fallbacks.
pub const FAMILY: &str = "IBM Plex Sans, DejaVu Sans, Arial, sans-serif";

/// Width of every figure in points: 17 cm, the text width of an A4 page.
pub const WIDTH: f64 = 482.0;

/// Text of axes, legends and labels, in points.
pub const TEXT: f64 = 7.5;
/// Numbers at ticks, in points.
pub const TICK: f64 = 7.0;
/// Names of sections side by side, in points: the smallest type in any figure.
pub const SMALL: f64 = 6.0;

/// A colour: red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color(pub u8, pub u8, pub u8);

impl fmt::Display for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(red, green, blue) = self;
        write!(f, "#{red:02X}{green:02X}{blue:02X}")
    }
}

pub const INK: Color = Color(0x1f, 0x24, 0x2b);
pub const WHITE: Color = Color(0xff, 0xff, 0xff);
pub const MUTED: Color = Color(0x55, 0x5e, 0x6a);
pub const GRID: Color = Color(0xdd, 0xe1, 0xe6);
/// Background beyond a limit.
pub const BEYOND: Color = Color(0xf1, 0xee, 0xea);
/// Background of highlighted ranges: the evaluated section, the band of a standard deviation.
pub const SHADE: Color = Color(0xe4, 0xec, 0xf3);
/// Wide, light line of a measured signal under the thin, dark line of the simulated one.
pub const MEASURED: Color = Color(0xa3, 0xa9, 0xb1);

/// Okabe and Ito, "Color Universal Design" (2008): blue, vermilion, bluish green, reddish purple,
/// orange, sky blue, black. The yellow of the set is omitted, since it is hardly visible on white
/// paper.
pub const PALETTE: [Color; 7] = [
    Color(0x00, 0x72, 0xb2),
    Color(0xd5, 0x5e, 0x00),
    Color(0x00, 0x9e, 0x73),
    Color(0xcc, 0x79, 0xa7),
    Color(0xe6, 0x9f, 0x00),
    Color(0x56, 0xb4, 0xe9),
    Color(0x00, 0x00, 0x00),
];

pub const BLUE: Color = PALETTE[0];
pub const VERMILION: Color = PALETTE[1];

/// The colour of the n-th of several series.
pub fn color(n: usize) -> Color {
    PALETTE[n % PALETTE.len()]
}

/// Shape and colour of the marks of the n-th of several series.
pub fn look(n: usize) -> (Mark, Color) {
    (Mark::ALL[n % Mark::ALL.len()], color(n))
}

/// Shape of a mark; the n-th series has the n-th shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    Circle,
    Triangle,
    Square,
    Diamond,
    TriangleDown,
    Pentagon,
    Hexagon,
    Bar,
}

impl Mark {
    pub const ALL: [Self; 8] = [
        Self::Circle,
        Self::Triangle,
        Self::Square,
        Self::Diamond,
        Self::TriangleDown,
        Self::Pentagon,
        Self::Hexagon,
        Self::Bar,
    ];
}

/// Dashes of a line, in points; `None` is a solid line.
pub type Dash = Option<&'static [f64]>;

pub const SOLID: Dash = None;
pub const DASHED: Dash = Some(&[5.0, 2.5]);
pub const DOTTED: Dash = Some(&[1.2, 2.0]);
pub const DASH_DOT: Dash = Some(&[6.0, 2.0, 1.2, 2.0]);
const LONG_DASH: Dash = Some(&[10.0, 2.5]);

/// How a line is drawn; the width in points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    pub color: Color,
    pub width: f64,
    pub dash: Dash,
}

impl Pen {
    /// A line without dashes.
    pub const fn solid(color: Color, width: f64) -> Self {
        Self { color, width, dash: SOLID }
    }
}

/// The line of a limit.
pub const LIMIT: Pen = Pen { color: INK, width: 0.9, dash: DASHED };

/// Dashes of several limits in one diagram.
pub const LIMITS: [Dash; 4] = [DASHED, DOTTED, DASH_DOT, LONG_DASH];

/// Approximate width of a text in points, for layout without font metrics: advance widths of a
/// humanist sans by kind of character, slightly overestimated.
pub fn text_width(text: &str, size: f64) -> f64 {
    let em: f64 = text
        .chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '|' | '\'' | '!' => 0.30,
            ' ' | 'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '/' | '-' => 0.40,
            'm' | 'w' | 'M' | 'W' | '@' | '%' => 0.90,
            'A'..='Z' | '±' | '\u{2212}' => 0.66,
            c if (c as u32) >= 0x1100 => 1.0,
            _ => 0.58,
        })
        .sum();
    em * size
}

/// A text cut to a width with an ellipsis.
pub fn cut(text: &str, size: f64, width: f64) -> String {
    let text = visible(text);
    if text_width(&text, size) <= width {
        return text;
    }
    let mut kept = String::new();
    for c in text.chars() {
        kept.push(c);
        if text_width(&kept, size) + 0.9 * size > width {
            kept.pop();
            break;
        }
    }
    kept.truncate(kept.trim_end().len());
    kept.push('…');
    kept
}

/// Several texts cut to a width. Texts that would look alike keep the part in which they differ,
/// and lose a part of what they share.
pub fn cut_apart(texts: &[&str], size: f64, width: f64) -> Vec<String> {
    let mut shown: Vec<String> = texts.iter().map(|text| cut(text, size, width)).collect();
    let alike = |shown: &[String], at: usize| -> Vec<usize> {
        (0..texts.len())
            .filter(|other| {
                shown[*other] == shown[at] && (*other == at || texts[*other] != texts[at])
            })
            .collect()
    };
    for at in 0..texts.len() {
        let same = alike(&shown, at);
        if same.len() < 2 {
            continue;
        }
        let letters: Vec<Vec<char>> =
            same.iter().map(|nth| visible(texts[*nth]).chars().collect()).collect();
        let common = (0..letters[0].len())
            .take_while(|n| letters.iter().all(|one| one.get(*n) == letters[0].get(*n)))
            .count();
        for (nth, own) in same.iter().zip(&letters) {
            // At least half of the width is for what differs.
            let mut rest: String = own[common..].iter().collect();
            let mut kept = String::new();
            for c in &own[..common] {
                kept.push(*c);
                if text_width(&kept, size) + text_width(&rest, size).min(0.5 * width) + 1.0 * size
                    > width
                {
                    kept.pop();
                    break;
                }
            }
            rest = cut(&rest, size, width - text_width(&kept, size) - size);
            shown[*nth] = format!("{}…{rest}", kept.trim_end());
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_that_differ_are_cut_to_texts_that_differ() {
        let long = "a-protocol-with-a-long-name";
        let texts = [
            format!("{long}: mean"),
            format!("{long}-and-a-variant: mean"),
            format!("{long}: standard deviation"),
            "b".into(),
        ];
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let shown = cut_apart(&texts, TEXT, 100.0);
        assert!(
            shown[0].ends_with("…: mean")
                && shown[1].contains("…-and-a-v")
                && shown[2].contains("…: standard"),
            "{shown:?}"
        );
        assert!(shown.iter().all(|text| text_width(text, TEXT) < 108.0), "{shown:?}");
        assert_eq!(cut_apart(&["b", "b", long], TEXT, 200.0), ["b", "b", long]);
    }

    #[test]
    fn cut_texts_fit_and_short_ones_stay() {
        assert_eq!(cut("Y_max", TEXT, 100.0), "Y_max");
        let short = cut(&"wide ".repeat(40), TEXT, 60.0);
        assert!(short.ends_with('…') && text_width(&short, TEXT) <= 66.0, "{short}");
        assert_eq!(cut("abc", TEXT, 0.0), "…");
        assert!(text_width(&cut(&"\u{202e}".repeat(9), TEXT, 60.0), TEXT) <= 66.0);
    }
}
