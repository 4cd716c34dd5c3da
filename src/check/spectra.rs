//! Checks signals with points of their own: `spectrum(ay, 4 s)`, with `frequency` among its lines, and
//! `cycle_ranges(Q)`.

use super::prelude::*;
use crate::catalog::{Reducer, TOTAL};
use crate::metrics::welch::Density;

/// Overlap of the segments, unless one is stated: the usual one of Hann windows.
const OVERLAP: f64 = 0.5;

impl Checker<'_> {
    /// `spectrum(ay, 4 s)`, with an overlap, a band or both behind the length of a segment.
    pub fn spectrum(
        &mut self,
        name: &At<String>,
        arguments: &[Phrase],
        span: Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let (of, segment, overlap, band) = match arguments {
            [of, segment] => (of, segment, None, None),
            [of, segment, overlap] => (of, segment, Some(overlap), None),
            [of, segment, low, high] => (of, segment, None, Some((low, high))),
            [of, segment, overlap, low, high] => (of, segment, Some(overlap), Some((low, high))),
            _ => {
                let says = "`spectrum` needs a signal and the length of a segment";
                let help = "`spectrum(ay, 4 s)`; with an overlap and a band `spectrum(ay, 4 s, 75 %, 1 Hz, 10 Hz)`";
                return self.refuse(error("arguments", says, name).help(help));
            }
        };
        let signal = self.expr(of, scope);
        let segment = self.size("segment", Dimension::TIME, segment);
        let overlap = match overlap {
            None => Some(OVERLAP),
            Some(overlap) => self.overlap(overlap),
        };
        let band = if_written(band.map(|(low, high)| self.band(low, high)))?;
        let density = Density { segment: segment?, overlap: overlap?, band };
        let signal = signal?;
        let Some(points) = signal.points() else {
            let says = "a number has no spectrum: it is the same all along";
            return self.refuse(error("arguments", says, &signal));
        };
        self.of_record(&signal, &span)?;
        let axis = self.axis_dimension();
        if axis != Dimension::TIME && (points == Points::Track || self.time.is_none()) {
            let says = "a spectrum is computed over the time";
            let help = match points {
                Points::Track => "the track record has no time",
                _ => "the protocol has no field `time`",
            };
            return self.refuse(error("no-time", says, &span).help(help));
        }
        let of = signal.dimension();
        let kind = Kind::OfSection(SectionOperation::Spectrum(density), Box::new(signal));
        Some(Expr::samples(kind, of * of / Dimension::FREQUENCY, Points::Spectrum, &span))
    }

    /// `cycle_ranges(Q)`.
    pub fn cycle_ranges(
        &mut self,
        name: &At<String>,
        arguments: &[Phrase],
        span: Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let [of] = arguments else {
            let says = "`cycle_ranges` needs one signal";
            return self.refuse(error("arguments", says, name).help("`cycle_ranges(Q)`"));
        };
        let signal = self.expr(of, scope)?;
        if signal.points().is_none() {
            let says = "a number has no cycles: it is the same all along";
            return self.refuse(error("arguments", says, &signal));
        }
        self.of_record(&signal, &span)?;
        let dimension = signal.dimension();
        let kind = Kind::OfSection(SectionOperation::CycleRanges, Box::new(signal));
        Some(Expr::samples(kind, dimension, Points::Cycles, &span))
    }

    /// Whether a number can be taken of samples: of cycles none that depends on their order, and the
    /// total of cycles alone.
    pub fn suits_points(&mut self, reducer: Reducer, of: &Expr, at: &Origin) -> Option<()> {
        let cycles = of.points() == Some(Points::Cycles);
        let problem = match reducer {
            Reducer::Named(entry) if !cycles && *entry == TOTAL => {
                error("count-of-samples", "the number of samples depends on the rate", at).help(
                    "write `share where ...`, `longest run where ...`, `crossings where ...` or `mean of ...`; cycles have a number and a total: `count where cycle_ranges(Q) > 10 kN`",
                )
            }
            _ if cycles && !reducer.of_cycles() => {
                let says = "cycles have no order along the record";
                error("order-of-cycles", says, at).help(
                    "of cycles there are `total`, `mean`, `rms`, `std`, `maximum`, percentiles and the like, `share where` and `count where`",
                )
            }
            _ => return Some(()),
        };
        self.refuse(problem)
    }

    /// A constant above zero.
    fn size(&mut self, what: &str, dimension: Dimension, written: &Phrase) -> Option<f64> {
        let value = self.constant_of(what, dimension, &dimension.in_words(), written)?;
        self.positive(what, value, &written.place())?;
        Some(value)
    }

    fn overlap(&mut self, written: &Phrase) -> Option<f64> {
        let value = self.constant_of("overlap", Dimension::ONE, "a share", written)?;
        if (0.0..1.0).contains(&value) {
            return Some(value);
        }
        let says = "the overlap of segments must be from 0 % to below 100 %";
        self.refuse(error("out-of-range", says, written).help("write it as a share: `50 %`"))
    }

    fn band(&mut self, low: &Phrase, high: &Phrase) -> Option<(f64, f64)> {
        let (from, to) = (low, high);
        let mut edge = |edge| self.size("frequency", Dimension::FREQUENCY, edge);
        let (low, high) = (edge(from), edge(to));
        let (low, high) = (low?, high?);
        if low < high {
            return Some((low, high));
        }
        let says = "the band must end above the frequency at which it begins";
        self.refuse(error("out-of-range", says, to).also(from, "its begin"))
    }

    /// Whether a name is that of the frequencies of a spectrum: what the protocol calls so itself
    /// is meant instead.
    pub fn is_frequency(&self, name: &str) -> bool {
        let names = &self.names;
        let mut data = names.columns.iter().chain(&names.vehicle);
        name == "frequency"
            && !names.defines.contains_key(name)
            && !names.parameter_blocks.contains_key(name)
            && !self.is_signal(name)
            && !data.any(|datum| datum.name == name)
    }

    /// An expression of which a number is taken, with its `frequency` that of its spectrum.
    pub fn at_frequencies(&mut self, mut expr: Expr) -> Option<Expr> {
        let Some(frequency) = expr.find(&|part| matches!(part.kind, Kind::Frequency)) else {
            return Some(expr);
        };
        let is_spectrum =
            |part: &Expr| matches!(part.kind, Kind::OfSection(SectionOperation::Spectrum(_), _));
        let Some(spectrum) = expr.find(&is_spectrum) else {
            let says = "`frequency` is that of the lines of a spectrum, and there is none here";
            let help = "for instance `maximum of (spectrum(ay, 4 s) when frequency > 2 Hz)`";
            return self.refuse(error("no-spectrum", says, frequency).help(help));
        };
        let kind = Kind::OfSection(SectionOperation::Frequencies, Box::new(spectrum.clone()));
        expr.with_frequencies(&kind);
        Some(expr)
    }

    /// What samples of a record are taken at; a spectrum is refused where it is used.
    pub fn of_record(&mut self, expr: &Expr, used: &Span) -> Option<Points> {
        match expr.points() {
            Some(points) if points.of_section() => {
                let (says, what, help) = if points == Points::Spectrum {
                    (
                        "this needs a signal along the record, and a spectrum is one over frequency",
                        "a spectrum",
                        "filter the signal before: `spectrum(ay through LP20, 4 s)`; a quantity is `of` the signal, and its `value` of the spectrum: `maximum of spectrum(ay, 4 s)`",
                    )
                } else {
                    (
                        "this needs a signal along the record, and cycles are not along it",
                        "cycles",
                        "filter the signal before: `cycle_ranges(Q through LP20)`; a quantity is `of` the signal, and its `value` of the cycles: `total of cycle_ranges(Q)^5`",
                    )
                };
                self.refuse(error("not-along-record", says, used).also(expr, what).help(help))
            }
            points => Some(points.unwrap_or(Points::Record)),
        }
    }

    /// A signal along the record.
    pub fn record_signal(&mut self, phrase: &Phrase, at: &Assignment) -> Option<Expr> {
        let signal = self.signal(phrase, at)?;
        self.of_record(&signal, &phrase.place())?;
        Some(signal)
    }
}
