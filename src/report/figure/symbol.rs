//! Symbols of quantities as labels. Subscripts, and dots over letters for which no precomposed
//! character exists, are drawn.
//!
//! A font would print a letter and its dots as two glyphs, which a PDF cannot map to one character.

use super::{
    canvas::{Canvas, Font, Held, Point},
    style::{Mark, cut, text_width},
};

/// Combining diaeresis: two dots over the preceding letter.
const DIAERESIS: char = '\u{308}';

/// Size of a subscript relative to its letter.
const SMALLER: f64 = 0.78;
/// Offset of a subscript below its letter, relative to the letter's size.
const LOWER: f64 = 0.22;

/// The parts of a symbol before and after its single underscore.
fn parts(label: &str) -> (&str, &str) {
    label
        .split_once('_')
        .filter(|(base, sub)| !base.is_empty() && !sub.is_empty() && !sub.contains('_'))
        .unwrap_or((label, ""))
}

/// A symbol at a point, centred or right-aligned, cut to a width, with its subscript.
pub fn symbol(canvas: &mut Canvas, label: &str, (x, y): Point, font: &Font, width: f64) {
    let size = font.size;
    let (base, sub) = parts(label);
    let wide = |base: &str, sub: &str| {
        NARROWER * (text_width(base, size) + SMALLER * text_width(sub, size))
    };
    let without_sub = sub.is_empty() || wide(base, sub) > width;
    let wide_in_all =
        if without_sub { wide(&bare(&cut(label, size, width)), "") } else { wide(base, sub) };
    let x = if font.held == Held::End { x - 0.5 * wide_in_all } else { x };
    let middle = Font { held: Held::Middle, ..*font };
    if without_sub {
        return plain(canvas, label, (x, y), &middle, width);
    }
    let (own, right) = (wide("", sub), 0.5 * wide(&bare(base), "") - 0.5 * wide("", sub));
    plain(canvas, base, (x - 0.5 * own, y), &middle, f64::INFINITY);
    let below = Font { size: SMALLER * size, held: Held::Start, ..*font };
    canvas.text(sub, (x + right + 0.04 * size, y + LOWER * size), &below);
}

/// Without accents.
fn bare(label: &str) -> String {
    label.chars().filter(|c| !('\u{300}'..='\u{36f}').contains(c)).collect()
}

/// A label centred at a point, cut to a width; diaereses are drawn over their letters, other
/// accents are omitted.
fn plain(canvas: &mut Canvas, label: &str, (x, y): Point, font: &Font, width: f64) {
    let size = font.size;
    let shown = cut(&bare(label), size, width);
    let Some(letter) = dotted(label).filter(|letter| *letter < shown.chars().count()) else {
        canvas.text(&shown, (x, y), font);
        return;
    };
    // The letter is placed separately, so that the dots are above it for any font metrics.
    let before: String = shown.chars().take(letter).collect();
    let own: String = shown.chars().skip(letter).take(1).collect();
    let after: String = shown.chars().skip(letter + 1).collect();
    let half = 0.5 * NARROWER * text_width(&own, size);
    let center =
        x - 0.5 * NARROWER * text_width(&shown, size) + NARROWER * text_width(&before, size) + half;
    for (text, at, held) in [
        (&before, center - half, Held::End),
        (&own, center, Held::Middle),
        (&after, center + half, Held::Start),
    ] {
        if !text.is_empty() {
            canvas.text(text, (at, y), &Font { held, ..*font });
        }
    }
    for side in [-1.0, 1.0] {
        let dot = (center + side * 0.13 * size, y - 0.42 * size);
        canvas.mark((Mark::Circle, font.color), dot, 0.06 * size);
    }
}

/// Width of letters relative to the estimated width.
const NARROWER: f64 = 0.88;

/// Index of the first letter with a diaeresis among the characters without accents.
fn dotted(label: &str) -> Option<usize> {
    let letters = label
        .chars()
        .take_while(|c| *c != DIAERESIS)
        .filter(|c| !('\u{300}'..='\u{36f}').contains(c))
        .count();
    (label.contains(DIAERESIS) && letters > 0).then(|| letters - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_letter_with_dots_is_found_and_gets_two() {
        assert_eq!(
            (dotted("z\u{308}*_rms"), dotted("az\u{308}"), dotted("ÿ"), dotted("\u{308}")),
            (Some(0), Some(1), None, None)
        );
        let dots = |label: &str| {
            let mut canvas = Canvas::new(60.0, 20.0);
            symbol(&mut canvas, label, (30.0, 10.0), &Font::middle(8.0), 50.0);
            canvas.finish().matches("<circle").count()
        };
        assert_eq!((dots("z\u{308}*_rms"), dots("ÿ*_rms")), (2, 0));
    }
}
