//! Guiding forces on the four wheels of the leading bogie for two friction coefficients and
//! measured, arranged as in a top view of the bogie: `cargo run --release --example friction_figure
//! -- CAMPAIGN SECTION [-o FILE.svg]`.
//!
//! After Figures 3 and 4 of Götz and Polach, Verification and validation of simulations in a
//! railway vehicle certification context.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

#[path = "../tests/simulation/model/common.rs"]
#[allow(dead_code)]
mod common;

use fishplate::metrics::filter::{Band, Cutoff, Filter, Phase};
use fishplate::model::SAMPLING_RATE;
use fishplate::report::figure::axis::{Scale, title};
use fishplate::report::figure::canvas::{Canvas, Font, Group};
use fishplate::report::figure::frame::Frame;
use fishplate::report::figure::legend::{Entry, Legend};
use fishplate::report::figure::style::{
    BLUE, DASHED, Dash, GRID, INK, MEASURED, MUTED, SHADE, SOLID, TEXT, VERMILION, WIDTH,
};
use plotters::style::RGBColor;

const FRICTION: [f64; 2] = [0.3, 0.6];
const PANEL: f64 = 105.0;
/// Distance of the rows, for the drawing of the bogie.
const BETWEEN: f64 = 78.0;

/// Channel, label, column (0 left), row (0 top). The vehicle runs to the right, so its left side is
/// at the top.
const WHEELS: [(&str, &str, usize, usize); 4] = [
    ("Y_2L", "trailing, left", 0, 0),
    ("Y_1L", "leading, left", 1, 0),
    ("Y_2R", "trailing, right", 0, 1),
    ("Y_1R", "leading, right", 1, 1),
];

struct Curve {
    color: RGBColor,
    width: f64,
    dash: Dash,
    x: Vec<f64>,
    /// One per wheel, kN.
    y: Vec<Vec<f64>>,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [campaign, name, rest @ ..] = arguments.as_slice() else {
        println!("arguments: CAMPAIGN SECTION [-o FILE.svg]");
        std::process::exit(2);
    };
    let section = common::section(campaign, name);
    let low_pass =
        Filter::design(Band::LowPass(20.0), 4, SAMPLING_RATE, Phase::Zero, Cutoff::AsApplied)
            .unwrap();
    let curve = |color, width, dash, x: &[f64], y: Vec<&Vec<f64>>| {
        let shown: Vec<usize> = (0..x.len())
            .filter(|i| x[*i] >= section.start - 20.0 && x[*i] <= section.end + 20.0)
            .collect();
        let smooth = y.into_iter().map(|y| low_pass.apply(y).unwrap());
        let y = smooth.map(|y| shown.iter().map(|i| y[*i]).collect()).collect();
        Curve { color, width, dash, x: shown.iter().map(|i| x[*i]).collect(), y }
    };
    let measured =
        common::columns(&common::folder(campaign).join("measurement").join(format!("{name}.csv")));
    let of_wheels = WHEELS.map(|wheel| common::channel(wheel.0));
    let mut curves = vec![curve(
        MEASURED,
        1.8,
        SOLID,
        &measured[1],
        of_wheels.iter().map(|at| &measured[2 + at]).collect(),
    )];
    println!("median of Y in kN inside {name}, friction {FRICTION:?}");
    let mut medians = vec![Vec::new(); 4];
    for (friction, color, dash) in [(FRICTION[0], BLUE, DASHED), (FRICTION[1], VERMILION, SOLID)] {
        let vehicle = common::vehicle(campaign, &[("friction", friction)]);
        let record = section.simulate(&vehicle, &common::profile(campaign, &vehicle)).unwrap();
        for (wheel, at) in of_wheels.iter().enumerate() {
            medians[wheel]
                .push(common::median(&section.inside(&record.distance, &record.channels[*at])));
        }
        curves.push(curve(
            color,
            0.9,
            dash,
            &record.distance,
            of_wheels.iter().map(|at| &record.channels[*at]).collect(),
        ));
    }
    for (wheel, medians) in WHEELS.iter().zip(&medians) {
        println!(
            "{} ({}): {:7.2} {:7.2}, change {:+.2}",
            wheel.0,
            wheel.1,
            medians[0],
            medians[1],
            medians[1] - medians[0]
        );
    }
    let drawn = draw(&curves, section.start, section.end);
    match rest {
        [option, file] if option == "-o" => std::fs::write(file, drawn).unwrap(),
        _ => println!("{drawn}"),
    }
}

fn draw(curves: &[Curve], start: f64, end: f64) -> String {
    let entries = vec![
        Entry::line(curves[0].color, curves[0].width, curves[0].dash, "measured"),
        Entry::line(
            curves[1].color,
            1.0,
            curves[1].dash,
            format!("simulated, friction {}", FRICTION[0]),
        ),
        Entry::line(
            curves[2].color,
            1.0,
            curves[2].dash,
            format!("simulated, friction {}", FRICTION[1]),
        ),
        Entry::ground(SHADE, "evaluated section"),
    ];
    let legend = Legend::new(entries, WIDTH - 20.0);
    let first = legend.height() + 18.0;
    let rows = [first, first + PANEL + BETWEEN];
    let mut canvas = Canvas::new(WIDTH, rows[1] + PANEL + 26.0);
    legend.draw(&mut canvas, (30.0, 0.0));
    let low = curves[1].x[0];
    let high = *curves[1].x.last().unwrap();
    for (wheel, (channel, words, column, row)) in WHEELS.iter().enumerate() {
        let left = [30.0, WIDTH / 2.0 + 30.0][*column];
        let top = rows[*row];
        // The same scale everywhere, for comparison.
        let y = Scale::over(
            curves.iter().flat_map(|curve| curve.y.iter().flatten().copied()),
            top + PANEL,
            top,
        );
        let frame = Frame { x: Scale { low, high, from: left, to: left + WIDTH / 2.0 - 38.0 }, y };
        canvas.draw(|layer| {
            layer.rect((frame.x.at(start), top), (frame.x.at(end), top + PANEL), SHADE)
        });
        frame.x_axis(&mut canvas, &frame.x.ticks(5), &title("distance", "m"));
        frame.y_axis(&mut canvas, &y.ticks(6), &title(channel, "kN"));
        for curve in curves {
            let points: Vec<(f64, f64)> = curve
                .x
                .iter()
                .zip(&curve.y[wheel])
                .map(|(x, y)| (frame.x.at(*x), frame.y.at(*y)))
                .collect();
            canvas.group(&Group { dash: curve.dash, ..Group::default() }, |layer| {
                layer.path(&points, curve.color, curve.width)
            });
        }
        frame.spine(&mut canvas);
        canvas.draw(|layer| layer.text(words, (left, top - 7.0), &Font::left(TEXT).bold(true)));
    }
    bogie(&mut canvas, rows[0] + PANEL + 28.0, BETWEEN - 52.0);
    canvas.finish()
}

/// Two wheelsets on two rails, running to the right.
fn bogie(canvas: &mut Canvas, top: f64, height: f64) {
    let middle = WIDTH / 2.0;
    let rails = [top, top + height];
    canvas.draw(|layer| {
        for rail in rails {
            layer.line((middle - 80.0, rail), (middle + 80.0, rail), GRID, 2.0);
        }
        for axle in [middle - 35.0, middle + 35.0] {
            layer.line((axle, rails[0] - 2.0), (axle, rails[1] + 2.0), INK, 1.0);
            for rail in rails {
                layer.rect((axle - 9.0, rail - 2.0), (axle + 9.0, rail + 2.0), INK);
            }
        }
        layer.line(
            (middle - 35.0, top + height / 2.0),
            (middle + 35.0, top + height / 2.0),
            MUTED,
            3.0,
        );
        let tip = (middle + 110.0, top + height / 2.0);
        layer.line((middle + 88.0, tip.1), tip, MUTED, 1.0);
        layer.fill(&[tip, (tip.0 - 6.0, tip.1 - 3.0), (tip.0 - 6.0, tip.1 + 3.0)], MUTED);
        layer.text("leading bogie", (middle - 88.0, tip.1), &Font::right(TEXT).color(MUTED));
    });
}
