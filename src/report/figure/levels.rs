//! Reference levels of a diagram of differences: mean, standard deviation and their limits.

use super::kit::*;
use crate::report::estimates;
use crate::result::{Direction, QuantityResult, Scope, StatisticName, StatisticResult};

/// Most limits that are told apart by their dashes, each with an entry of the legend.
const NAMED: usize = LIMITS.len();

/// A horizontal line over some of the sections.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    pub value: f64,
    pub pen: Pen,
    /// Over which zones.
    pub scope: Scope,
}

/// A background between two values over some of the sections.
#[derive(Clone, Debug)]
pub struct Band {
    pub low: f64,
    pub high: f64,
    pub scope: Scope,
}

/// Lines and backgrounds with their legend.
#[derive(Clone, Debug, Default)]
pub struct Levels {
    pub lines: Vec<Level>,
    pub bands: Vec<Band>,
    pub legend: Vec<Entry>,
    /// Texts of the limits around zero, each once.
    limits: Vec<String>,
}

impl Levels {
    /// Levels of the statistics in the unit of the values.
    ///
    /// The limit of a standard deviation is drawn around the mean, for comparison with the band of
    /// the standard deviation.
    pub fn of(quantity: &QuantityResult) -> Self {
        if quantity.from.is_some() {
            return Self::of_assessed(quantity);
        }
        let mut levels = Self::default();
        let two_sided =
            quantity.has_sides || quantity.values.iter().any(|pair| pair.difference < 0.0);
        for limit in estimates::limits(quantity) {
            let first = limit.results[0];
            let same = limit.results.iter().all(|one| one.limit == first.limit);
            for statistic in limit
                .results
                .into_iter()
                .filter(|one| one.unit == quantity.unit && one.divided_at.is_none())
            {
                let two_sided = two_sided && statistic.direction == Direction::Magnitude;
                let shown = Shown { two_sided, same };
                match statistic.name {
                    StatisticName::Mean => levels.mean(statistic, shown),
                    StatisticName::StandardDeviation => {
                        levels.deviation(statistic, center(quantity, statistic), shown)
                    }
                    _ => levels.other(statistic, shown),
                }
            }
        }
        levels
    }

    /// Limits of an assessed quantity zone by zone. Its estimates are not drawn: one for a further
    /// value may lie far beyond all values.
    fn of_assessed(quantity: &QuantityResult) -> Self {
        let mut levels = Self::default();
        let two_sided = quantity.values.iter().any(|pair| pair.difference < 0.0);
        let direction =
            quantity.statistics.first().map_or(Direction::Magnitude, |one| one.direction);
        for statistic in quantity
            .statistics
            .iter()
            .filter(|statistic| statistic.unit == quantity.unit && statistic.divided_at.is_none())
        {
            for scope in scopes(statistic) {
                let two_sided = two_sided && statistic.direction == Direction::Magnitude;
                for value in
                    statistic.limit.iter().flat_map(|limit| edges(statistic, *limit, two_sided))
                {
                    levels.draw(Level { value, pen: LIMIT, scope: scope.clone() });
                }
            }
        }
        if !levels.lines.is_empty() {
            // Around zero a limit has two lines, and one number.
            let two_sided = two_sided && direction == Direction::Magnitude;
            let number = |line: &Level| if two_sided { line.value.abs() } else { line.value };
            let mut all: Vec<f64> = levels.lines.iter().map(number).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            let decimals = number::decimals(&quantity.unit, all.iter().copied());
            let texts: Vec<String> =
                all.iter().map(|limit| number::fixed(*limit, decimals)).collect();
            match texts.as_slice() {
                [first, .., last] if texts.len() > NAMED => {
                    let text = format!("limits {}{first} to {last}", sign(two_sided, direction));
                    levels.explain(Entry::line(LIMIT, text));
                }
                // Each limit has a dash of its own, or the lines could not be told apart.
                several => {
                    let compared = quantity.statistics.iter().flat_map(StatisticResult::compared);
                    let compared: Vec<_> = compared.collect();
                    for ((text, limit), dash) in several.iter().zip(&all).zip(LIMITS) {
                        let edge = compared.iter().find(|edge| edge.limit == Some(*limit));
                        let direction = edge.map_or(direction, |edge| edge.direction);
                        let text = format!("limit {}{text}", sign(two_sided, direction));
                        levels.explain(Entry::line(Pen { dash, ..LIMIT }, text));
                    }
                    for line in &mut levels.lines {
                        let nth = all.iter().position(|limit| *limit == number(line));
                        line.pen.dash =
                            nth.and_then(|nth| LIMITS.get(nth).copied()).unwrap_or(DASHED);
                    }
                }
            }
        }
        levels
    }

    /// All values of lines and backgrounds.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        self.lines
            .iter()
            .map(|line| line.value)
            .chain(self.bands.iter().flat_map(|band| [band.low, band.high]))
    }

    fn line(&mut self, statistic: &StatisticResult, values: &[f64], pen: Pen, text: String) {
        for scope in scopes(statistic) {
            for value in values {
                self.draw(Level { value: *value, pen, scope: scope.clone() });
            }
        }
        self.explain(Entry::line(pen, text));
    }

    /// Adds a line once: groups of other things than zones often have the same limit over all
    /// sections.
    fn draw(&mut self, level: Level) {
        if !self.lines.contains(&level) {
            self.lines.push(level);
        }
    }

    /// Adds an entry once for the same level of several zones.
    fn explain(&mut self, entry: Entry) {
        if !self.legend.iter().any(|known| known.text == entry.text) {
            self.legend.push(entry);
        }
    }

    /// The number of a limit around zero, by its text.
    fn number(&mut self, text: &str) -> usize {
        self.limits.iter().position(|known| known == text).unwrap_or_else(|| {
            self.limits.push(text.into());
            self.limits.len() - 1
        })
    }

    fn mean(&mut self, statistic: &StatisticResult, with: Shown) {
        if let Some(value) = statistic.value.filter(|_| over_sections(statistic)) {
            let text = says(statistic, &shown(statistic, value));
            self.line(statistic, &[value], Pen::solid(BLUE, 1.3), text);
        }
        if let Some(limit) = statistic.limit {
            let text = says_of_limit(statistic, with);
            self.number(&text);
            let pen = Pen { color: BLUE, ..LIMIT };
            self.line(statistic, &edges(statistic, limit, with.two_sided), pen, text);
        }
    }

    fn deviation(&mut self, statistic: &StatisticResult, center: f64, with: Shown) {
        if let Some(value) = statistic.value.filter(|_| over_sections(statistic)) {
            let band = |scope: Scope| Band { low: center - value, high: center + value, scope };
            self.bands.extend(scopes(statistic).into_iter().map(band));
            self.explain(Entry::ground(
                SHADE,
                format!("mean ± {}", says(statistic, &shown(statistic, value))),
            ));
        }
        if let Some(limit) = statistic.limit {
            let text =
                format!("mean ± {}", says_of_limit(statistic, Shown { two_sided: false, ..with }));
            let pen = Pen { color: VERMILION, dash: DOTTED, ..LIMIT };
            self.line(statistic, &both(center, limit, true), pen, text);
        }
    }

    fn other(&mut self, statistic: &StatisticResult, with: Shown) {
        if let Some(value) = statistic
            .value
            .filter(|_| statistic.name != StatisticName::Each && over_sections(statistic))
        {
            let pen = Pen { color: color(2), width: 1.1, dash: DASH_DOT };
            self.line(statistic, &[value], pen, says(statistic, &shown(statistic, value)));
        }
        if let Some(limit) = statistic.limit {
            let text = says_of_limit(statistic, with);
            // Limits of several estimates have a dash each.
            let pen = Pen { dash: LIMITS[self.number(&text) % NAMED], ..LIMIT };
            self.line(statistic, &edges(statistic, limit, with.two_sided), pen, text);
        }
    }
}

/// How the limits of one rule are drawn and told.
#[derive(Clone, Copy, Debug)]
struct Shown {
    two_sided: bool,
    /// Whether all groups have the same limit.
    same: bool,
}

/// The sections that a result is drawn over: each of its zones, or all.
fn scopes(statistic: &StatisticResult) -> Vec<Scope> {
    match statistic.scope.zones.as_slice() {
        [] => vec![Scope::default()],
        zones => zones.iter().map(|zone| Scope::zone(zone)).collect(),
    }
}

/// Whether the values of a result are all those of its sections. The result of a record or of a
/// position is not drawn: there is one for each in the same place.
fn over_sections(statistic: &StatisticResult) -> bool {
    let Scope { zones, keys, .. } = &statistic.scope;
    statistic.scope.is_all() || keys.is_empty() && !zones.is_empty()
}

/// The mean of the same scope, around which a standard deviation is drawn.
fn center(quantity: &QuantityResult, of: &StatisticResult) -> f64 {
    let stated = quantity
        .statistics
        .iter()
        .find(|one| one.name == StatisticName::Mean && one.scope == of.scope && over_sections(of));
    stated.and_then(|one| one.value).unwrap_or_else(|| {
        let within = quantity.values.iter().filter(|pair| of.scope.has_zone(pair.zone.as_deref()));
        let (sum, count) =
            within.fold((0.0, 0_u32), |(sum, count), pair| (sum + pair.difference, count + 1));
        if count == 0 { 0.0 } else { sum / f64::from(count) }
    })
}

/// Where the limits of a statistic are drawn.
fn edges(statistic: &StatisticResult, limit: f64, two_sided: bool) -> Vec<f64> {
    let between = statistic.between().map(|(low, high)| vec![low, high]);
    between.unwrap_or_else(|| both(0.0, limit, two_sided))
}

fn both(center: f64, limit: f64, two_sided: bool) -> Vec<f64> {
    if two_sided { vec![center - limit, center + limit] } else { vec![center + limit] }
}

fn sign(two_sided: bool, direction: Direction) -> &'static str {
    if two_sided && direction == Direction::Magnitude { "±" } else { direction.sign() }
}

/// The value as in the tables, with the decimals of the limit.
fn shown(statistic: &StatisticResult, value: f64) -> String {
    let decimals = number::decimals(&statistic.unit, statistic.limit.or(Some(value)));
    statistic.limit.map_or_else(
        || number::fixed(value, decimals),
        |limit| number::beside(value, limit, decimals),
    )
}

/// A statistic and its value; without value if it differs between zones.
fn says(statistic: &StatisticResult, value: &str) -> String {
    if statistic.scope.is_all() {
        format!("{} {value}", statistic.title)
    } else {
        format!("{} by {}", statistic.title, by(statistic))
    }
}

/// The limit of a statistic; without its number if it differs between groups.
fn says_of_limit(statistic: &StatisticResult, Shown { two_sided, same }: Shown) -> String {
    let one = statistic.scope.is_all() || same && !statistic.scope.keys.is_empty();
    let limit = statistic.limit.filter(|_| one).map(|limit| match statistic.between() {
        Some((low, high)) => format!("{} to {}", shown(statistic, low), shown(statistic, high)),
        None => format!("{}{}", sign(two_sided, statistic.direction), shown(statistic, limit)),
    });
    format!(
        "limit of {} {}",
        statistic.title,
        limit.unwrap_or_else(|| format!("by {}", by(statistic)))
    )
}

/// What the groups of a statistic are: `zone`, `record`, `record and wheelset`.
fn by(statistic: &StatisticResult) -> String {
    if statistic.scope.keys.is_empty() && !statistic.scope.zones.is_empty() {
        return "zone".into();
    }
    let keys: Vec<&str> = statistic.scope.members().into_iter().map(|(key, _)| key).collect();
    match keys.as_slice() {
        [] => "condition".into(),
        [key] => (*key).into(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::{RulePlace, Sample};

    fn of_record(record: &str, limit: f64) -> StatisticResult {
        StatisticResult {
            name: StatisticName::Each,
            title: "each value".into(),
            scope: Scope { keys: vec![("record".into(), record.into())], ..Scope::default() },
            group: Vec::new(),
            count: 1,
            n: 1,
            unit: "kN".into(),
            value: Some(0.5),
            interval: None,
            marginal: false,
            limit: Some(limit),
            direction: Direction::Magnitude,
            edges: Vec::new(),
            normalised: None,
            sample: Sample::default(),
            regression: None,
            divided_at: None,
            outside: Vec::new(),
            beyond: None,
            holds: Some(true),
            factors: Vec::new(),
            limit_text: "1 kN".into(),
            limit_printed: "1 kN".into(),
            reason: None,
            rule: RulePlace { file: "a.fp".into(), line: 1 },
        }
    }

    /// There are no zones: the limit is one line over all sections, with its number where all
    /// records have the same.
    #[test]
    fn the_limit_of_each_record_is_drawn() {
        let with = |same| Shown { two_sided: true, same };
        let mut levels = Levels::default();
        [of_record("A", 2.0), of_record("B", 2.0)]
            .iter()
            .for_each(|one| levels.other(one, with(true)));
        let drawn: Vec<(f64, bool)> =
            levels.lines.iter().map(|line| (line.value, line.scope.is_all())).collect();
        assert_eq!(drawn, [(-2.0, true), (2.0, true)]);
        assert_eq!(
            levels.legend.iter().map(|entry| entry.text.as_str()).collect::<Vec<_>>(),
            ["limit of each value ±2.00"]
        );
        assert_eq!(
            says_of_limit(&of_record("A", 2.0), with(false)),
            "limit of each value by record"
        );
    }
}
