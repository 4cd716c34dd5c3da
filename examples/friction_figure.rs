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
use fishplate::report::figure::axis::{over, title};
use fishplate::report::figure::canvas::{Canvas, Font};
use fishplate::report::figure::frame::Frame;
use fishplate::report::figure::legend::{Entry, Legend};
use fishplate::report::figure::style::{
    BLUE, DASHED, GRID, INK, MEASURED, MUTED, Pen, SHADE, TEXT, VERMILION, WIDTH,
};

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
    pen: Pen,
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
    let curve = |pen, x: &[f64], y: Vec<&Vec<f64>>| {
        let shown: Vec<usize> = (0..x.len())
            .filter(|i| x[*i] >= section.start - 20.0 && x[*i] <= section.end + 20.0)
            .collect();
        let smooth = y.into_iter().map(|y| low_pass.apply(y).unwrap());
        let y = smooth.map(|y| shown.iter().map(|i| y[*i]).collect()).collect();
        Curve { pen, x: shown.iter().map(|i| x[*i]).collect(), y }
    };
    let measured =
        common::columns(&common::folder(campaign).join("measurement").join(format!("{name}.csv")));
    let of_wheels = WHEELS.map(|wheel| common::channel(wheel.0));
    let mut curves = vec![curve(
        Pen::solid(MEASURED, 1.8),
        &measured[1],
        of_wheels.iter().map(|at| &measured[2 + at]).collect(),
    )];
    println!("median of Y in kN inside {name}, friction {FRICTION:?}");
    let mut medians = vec![Vec::new(); 4];
    let pens = [Pen { dash: DASHED, ..Pen::solid(BLUE, 0.9) }, Pen::solid(VERMILION, 0.9)];
    for (friction, pen) in FRICTION.into_iter().zip(pens) {
        let vehicle = common::vehicle(campaign, &[("friction", friction)]);
        let record = section.simulate(&vehicle, &common::profile(campaign, &vehicle)).unwrap();
        for (wheel, at) in of_wheels.iter().enumerate() {
            medians[wheel]
                .push(common::median(&section.inside(&record.distance, &record.channels[*at])));
        }
        curves.push(curve(
            pen,
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
    let simulated = |nth: usize| {
        let pen = Pen { width: 1.0, ..curves[1 + nth].pen };
        Entry::line(pen, format!("simulated, friction {}", FRICTION[nth]))
    };
    let entries = [
        Entry::line(curves[0].pen, "measured"),
        simulated(0),
        simulated(1),
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
        let y = over(curves.iter().flat_map(|curve| curve.y.iter().flatten().copied()));
        let across = (left, left + WIDTH / 2.0 - 38.0);
        let frame = Frame::new((low, high), y, across, (top, top + PANEL));
        canvas.rect(frame.upright(start).0, frame.upright(end).1, SHADE);
        frame.x_axis(&mut canvas, 5, &title("distance", "m"));
        frame.y_axis(&mut canvas, 6, &title(channel, "kN"));
        for curve in curves {
            let samples = curve.x.iter().zip(&curve.y[wheel]);
            let points: Vec<(f64, f64)> = samples.map(|(x, y)| frame.at(*x, *y)).collect();
            canvas.curve("curve", curve.pen, &points);
        }
        frame.spine(&mut canvas);
        canvas.text(words, (left, top - 7.0), &Font::left(TEXT).bold(true));
    }
    bogie(&mut canvas, rows[0] + PANEL + 28.0, BETWEEN - 52.0);
    canvas.finish()
}

/// Two wheelsets on two rails, running to the right.
fn bogie(canvas: &mut Canvas, top: f64, height: f64) {
    let middle = WIDTH / 2.0;
    let rails = [top, top + height];
    for rail in rails {
        canvas.line((middle - 80.0, rail), (middle + 80.0, rail), GRID, 2.0);
    }
    for axle in [middle - 35.0, middle + 35.0] {
        canvas.line((axle, rails[0] - 2.0), (axle, rails[1] + 2.0), INK, 1.0);
        for rail in rails {
            canvas.rect((axle - 9.0, rail - 2.0), (axle + 9.0, rail + 2.0), INK);
        }
    }
    canvas.line(
        (middle - 35.0, top + height / 2.0),
        (middle + 35.0, top + height / 2.0),
        MUTED,
        3.0,
    );
    let tip = (middle + 110.0, top + height / 2.0);
    canvas.line((middle + 88.0, tip.1), tip, MUTED, 1.0);
    canvas.fill(&[tip, (tip.0 - 6.0, tip.1 - 3.0), (tip.0 - 6.0, tip.1 + 3.0)], MUTED);
    canvas.text("leading bogie", (middle - 88.0, tip.1), &Font::right(TEXT).color(MUTED));
}
