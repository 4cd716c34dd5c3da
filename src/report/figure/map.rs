//! Map of the gap: quantity and position by zone and band; the shade is the share of the gap.

use super::kit::*;
use crate::result::diagnosis::Where;

const ROW: f64 = 11.0;
const NAMES: f64 = 176.0;
const HEAD: f64 = 60.0;
/// Height of the scale below the map, with its margins.
const SCALE: f64 = 27.0;
/// Shades of the scale.
const STEPS: usize = 6;

/// Rows in decreasing order of their shares; a dot marks significant cells.
pub fn map(places: &[Where]) -> String {
    let mut rows: Vec<(String, f64)> = Vec::new();
    let mut columns: Vec<(String, String)> = Vec::new();
    for place in places {
        let row = name(place);
        match rows.iter_mut().find(|(known, _)| *known == row) {
            Some((_, share)) => *share += place.share_of_gap,
            None => rows.push((row, place.share_of_gap)),
        }
        let column = (place.zones.join(", "), place.wavelength_or_band.clone());
        if !columns.contains(&column) {
            columns.push(column);
        }
    }
    rows.sort_by(|a, b| b.1.total_cmp(&a.1));
    // Zones in order; in each, quasi-static first, then bands by frequency.
    let edge = |band: &str| {
        let place = places.iter().find(|place| place.wavelength_or_band == band);
        place.and_then(|place| place.frequency).unwrap_or(-1.0)
    };
    columns.sort_by(|a, b| a.0.cmp(&b.0).then(edge(&a.1).total_cmp(&edge(&b.1))));
    let wide = (WIDTH - NAMES) / columns.len().max(1) as f64;
    let most = places.iter().map(|place| place.share_of_gap).fold(1e-12, f64::max);
    let bottom = HEAD + ROW * rows.len() as f64;
    let mut canvas = Canvas::new(WIDTH, bottom + SCALE);
    for (at, (zone, band)) in columns.iter().enumerate() {
        let x = NAMES + wide * (at as f64 + 0.5);
        let font = Font::middle(SMALL).upward().color(MUTED);
        canvas.text(&cut(band, SMALL, HEAD - 14.0), (x, HEAD - 18.0), &font);
        if at == 0 || columns[at - 1].0 != *zone {
            let count = columns.iter().filter(|(of, _)| of == zone).count() as f64;
            let middle = NAMES + wide * (at as f64 + 0.5 * count);
            canvas.text(&format!("zone {zone}"), (middle, 5.0), &Font::middle(TEXT).bold(true));
        }
    }
    for (at, (row, _)) in rows.iter().enumerate() {
        let y = HEAD + ROW * (at as f64 + 0.5);
        canvas.text(&cut(row, SMALL, NAMES - 6.0), (NAMES - 4.0, y), &Font::right(SMALL));
    }
    for place in places {
        let row = rows.iter().position(|(known, _)| *known == name(place));
        let column = columns.iter().position(|(zone, band)| {
            *zone == place.zones.join(", ") && *band == place.wavelength_or_band
        });
        let (Some(row), Some(column)) = (row, column) else { continue };
        let (x, y) = (NAMES + wide * column as f64, HEAD + ROW * row as f64);
        let share = (place.share_of_gap / most).sqrt();
        let says = format!(
            "{}: {} % of the gap",
            place.says,
            number::fixed(100.0 * place.share_of_gap, 1)
        );
        canvas.group(&Group::mark(&says), |canvas| {
            canvas.rect((x + 0.4, y + 0.4), (x + wide - 0.4, y + ROW - 0.4), shade(share));
            if place.significant {
                let middle = (x + 0.5 * wide, y + 0.5 * ROW);
                canvas.mark((Mark::Circle, on_shade(share)), middle, 0.9);
            }
        });
    }
    for at in (1..columns.len()).filter(|at| columns[at - 1].0 != columns[*at].0) {
        let x = NAMES + wide * at as f64;
        canvas.line((x, HEAD - 4.0), (x, bottom), INK, 0.6);
    }
    canvas.line((NAMES, HEAD), (WIDTH, HEAD), GRID, 0.5);
    scale(&mut canvas, bottom + 0.5 * (SCALE - ROW), most);
    canvas.finish()
}

/// The scale of shades, from zero to the largest share.
fn scale(canvas: &mut Canvas, top: f64, most: f64) {
    let wide = (WIDTH - NAMES) / STEPS as f64;
    let middle = top + 0.5 * ROW;
    canvas.text("share of the gap", (NAMES - 4.0, middle), &Font::right(SMALL).color(MUTED));
    for step in 0..STEPS {
        let of = step as f64 / (STEPS - 1) as f64;
        let x = NAMES + wide * step as f64;
        canvas.rect((x, top), (x + wide - 1.0, top + ROW), shade(of));
        let says = format!("{} %", number::significant(100.0 * most * of * of, 2));
        let font = Font::middle(SMALL).color(on_shade(of));
        canvas.text(&says, (x + 0.5 * wide, middle), &font);
    }
    for y in [top, top + ROW] {
        canvas.line((NAMES, y), (WIDTH - 1.0, y), GRID, 0.5);
    }
}

fn name(place: &Where) -> String {
    format!("{}, {}", place.quantity, place.position)
}

/// What is drawn on a shade.
fn on_shade(share: f64) -> Color {
    if share > 0.55 { WHITE } else { INK }
}

/// From white to dark blue; readable in grey.
fn shade(share: f64) -> Color {
    let mix = |to: u8| {
        (f64::from(u8::MAX) + share.clamp(0.0, 1.0) * (f64::from(to) - f64::from(u8::MAX))).round()
            as u8
    };
    Color(mix(0x0b), mix(0x3c), mix(0x6f))
}
