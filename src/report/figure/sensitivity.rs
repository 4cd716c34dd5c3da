//! Sensitivity of metrics: rms change of value / limit over the size of a disturbance.

use super::kit::*;

/// Height of the drawing area, in points.
const PANEL: f64 = 130.0;
/// Largest number of curves that can be told apart; further metrics are in the table only.
const MOST: usize = 12;

/// The axis ends at so many times the median of what the curves reach: one metric that is much more
/// sensitive than the others would press them onto the axis.
const HIGHEST: f64 = 5.0;

/// Name of a metric, and pairs of size and sensitivity.
type Curve = (String, Vec<(f64, f64)>);

/// Where the axis ends: at the largest value, or below it.
fn highest(curves: &[Curve]) -> f64 {
    let mut reached: Vec<f64> = curves
        .iter()
        .map(|(_, points)| points.iter().map(|(_, value)| *value).fold(0.0, f64::max))
        .collect();
    reached.sort_by(f64::total_cmp);
    let most = reached.last().copied().unwrap_or(0.0);
    let end = HIGHEST * reached.get(reached.len() / 2).copied().unwrap_or(0.0);
    (if end > 0.0 { most.min(end) } else { most }).max(f64::MIN_POSITIVE)
}

/// One curve for each metric: its name, and pairs of size and sensitivity.
pub fn sensitivity(disturbance: &str, curves: &[Curve]) -> String {
    let curves = &curves[..curves.len().min(MOST)];
    let high = highest(curves);
    let names: Vec<&str> = curves.iter().map(|(name, _)| name.as_str()).collect();
    let names = cut_apart(&names, TEXT, 0.44 * WIDTH);
    let entry = |(n, (_, points)): (usize, &Curve)| {
        let beyond = points.iter().any(|(_, value)| *value > high);
        let says = if beyond { " (beyond the axis)" } else { "" };
        Entry::mark(look(n), format!("{}{says}", names[n]))
    };
    let legend = Legend::new(curves.iter().enumerate().map(entry), WIDTH - 40.0);
    let sizes = curves.iter().flat_map(|(_, points)| points.iter().map(|(size, _)| *size));
    let x = (0.0, 1.05 * sizes.fold(0.0, f64::max));
    let (y, ticks, top) = ((0.0, 1.05 * high), 6, legend.height() + 8.0);
    let frame = Frame::new(x, y, (axis::room(y, ticks), WIDTH - 10.0), (top, top + PANEL));
    let mut canvas = Canvas::new(WIDTH, frame.bottom() + 30.0);
    legend.draw(&mut canvas, (40.0, 0.0));
    frame.y_axis(&mut canvas, ticks, "rms change of value / limit");
    frame.x_axis(&mut canvas, 8, &format!("size of the disturbance ({disturbance})"));
    for (n, (name, points)) in curves.iter().enumerate() {
        let placed: Vec<(f64, f64)> = [(0.0, 0.0)]
            .iter()
            .chain(points)
            .map(|(size, value)| frame.at(*size, value.min(1.05 * high)))
            .collect();
        canvas.path(&placed, color(n), 0.9);
        for ((size, value), point) in points.iter().zip(&placed[1..]) {
            let title = format!("{name}, size {size}: {}", number::significant(*value, 3));
            canvas.group(&Group::mark(&title), |canvas| canvas.mark(look(n), *point, 2.0));
        }
    }
    frame.spine(&mut canvas);
    canvas.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_metric_does_not_press_the_others_onto_the_axis() {
        let curve = |high: f64| (String::new(), vec![(0.1, 0.5 * high), (0.2, high)]);
        assert_eq!(highest(&[curve(1.0), curve(2.0), curve(3.0)]), 3.0);
        assert_eq!(highest(&[curve(1.0), curve(2.0), curve(1e15)]), 10.0);
        assert_eq!(highest(&[curve(0.0), curve(0.0), curve(2.0)]), 2.0);
        assert!(highest(&[]) > 0.0);
    }
}
