//! Reduction of a set to fewer members of each group, so that the highest of several measures of scatter stays almost the same.
//!
//! Götz and Polach (section 4.1) choose nine sections per zone so that the highest standard deviation of a validation quantity over all
//! sections remains almost the same. They do not describe the method. Here members are removed one at a time, always the one whose
//! removal changes the scatter least; then members are exchanged as long as the result improves.

/// Weight of the scatter of single measures against the highest.
const OTHERS: f64 = 0.1;
/// Largest number of exchanges.
const MOST_EXCHANGES: usize = 200;
/// An exchange that improves less is none, but rounding.
const IMPROVES: f64 = 1e-12;

/// Costs that follow from sums are this close to those that are summed anew: rounding of a variance from sums of squares.
const NEAR: f64 = 1e-7;

/// A measure of scatter: a standard deviation or root mean square, which follows from sums of each member.
#[derive(Clone, Debug)]
pub struct Measure {
    /// The divisor is n - `ddof`; `None` for a root mean square.
    pub ddof: Option<f64>,
    /// By which the value is multiplied: one over its limit.
    pub scale: f64,
    /// Of each member the number of values, their sum and sum of squares.
    pub sums: Vec<[f64; 3]>,
}

impl Measure {
    /// Of some members; 0 where it is not defined.
    pub fn over(&self, members: &[usize]) -> f64 {
        self.of(self.total(members))
    }

    fn total(&self, members: &[usize]) -> [f64; 3] {
        members.iter().fold([0.0; 3], |[n, x, xx], &at| {
            let of = self.sums[at];
            [n + of[0], x + of[1], xx + of[2]]
        })
    }

    fn of(&self, [n, x, xx]: [f64; 3]) -> f64 {
        let value = match self.ddof {
            None => (xx / n).sqrt(),
            Some(ddof) if n > ddof => ((xx - x * x / n).max(0.0) / (n - ddof)).sqrt(),
            Some(_) => 0.0,
        } * self.scale;
        if value.is_finite() { value } else { 0.0 }
    }
}

/// How far the scatter of some members is from that of all.
struct Cost<'a> {
    measures: &'a [Measure],
    all: Vec<f64>,
}

impl Cost<'_> {
    fn of(&self, scatter: impl Iterator<Item = f64>) -> f64 {
        let (mut highest, mut others) = (0.0_f64, 0.0);
        for (found, all) in scatter.zip(&self.all) {
            highest = highest.max(found);
            others += (found - all).powi(2);
        }
        let of_all = self.all.iter().copied().fold(0.0, f64::max);
        (highest - of_all).abs() + OTHERS * (others / self.all.len().max(1) as f64).sqrt()
    }

    fn over(&self, kept: &[Vec<usize>]) -> f64 {
        let members = kept.concat();
        self.of(self.measures.iter().map(|measure| measure.over(&members)))
    }

    /// The first of the changes with the least cost, and this cost. A change takes a member out and may put another in. Its cost follows
    /// from sums over all members; only the changes that come near the least cost are summed anew.
    fn best(&self, kept: &[Vec<usize>], changes: &[Change]) -> Option<(f64, Vec<Vec<usize>>)> {
        let members = kept.concat();
        let totals: Vec<[f64; 3]> = self.measures.iter().map(|measure| measure.total(&members)).collect();
        let near = |change: &Change| {
            self.of(self.measures.iter().zip(&totals).map(|(measure, total)| {
                let (out, put) = (measure.sums[kept[change.group][change.place]], change.put.map_or([0.0; 3], |put| measure.sums[put]));
                measure.of([0, 1, 2].map(|at| total[at] - out[at] + put[at]))
            }))
        };
        let costs: Vec<f64> = changes.iter().map(near).collect();
        let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
        let close = changes.iter().zip(&costs).filter(|(_, cost)| **cost <= least + NEAR);
        let anew = close.map(|(change, _)| {
            let changed = change.made(kept);
            (self.over(&changed), changed)
        });
        anew.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

struct Change {
    group: usize,
    place: usize,
    put: Option<usize>,
}

impl Change {
    fn made(&self, kept: &[Vec<usize>]) -> Vec<Vec<usize>> {
        let mut changed = kept.to_vec();
        match self.put {
            Some(put) => changed[self.group][self.place] = put,
            None => {
                changed[self.group].remove(self.place);
            }
        }
        changed
    }
}

/// The members of each group that are kept, at most `keep` of each, in the order given.
pub fn reduced(groups: &[Vec<usize>], keep: &[usize], measures: &[Measure]) -> Vec<Vec<usize>> {
    let all = groups.concat();
    let cost = Cost { measures, all: measures.iter().map(|measure| measure.over(&all)).collect() };
    let mut kept: Vec<Vec<usize>> = groups.to_vec();
    loop {
        let more = (0..kept.len()).filter(|&group| kept[group].len() > keep[group]);
        let changes = more.flat_map(|group| (0..kept[group].len()).map(move |place| Change { group, place, put: None }));
        let Some((_, without)) = cost.best(&kept, &changes.collect::<Vec<_>>()) else { break };
        kept = without;
    }
    let mut now = cost.over(&kept);
    for _ in 0..MOST_EXCHANGES {
        let mut changes = Vec::new();
        for (group, of) in groups.iter().enumerate() {
            let others: Vec<usize> = of.iter().copied().filter(|other| !kept[group].contains(other)).collect();
            for place in 0..kept[group].len() {
                changes.extend(others.iter().map(|&other| Change { group, place, put: Some(other) }));
            }
        }
        let Some((least, changed)) = cost.best(&kept, &changes).filter(|(least, _)| *least < now - IMPROVES) else { break };
        (now, kept) = (least, changed);
    }
    kept.iter_mut().for_each(|members| members.sort_unstable());
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_members_that_scatter_are_kept() {
        let values: [f64; 8] = [0.0, 0.1, -0.1, 5.0, -5.0, 0.2, 1.0, -1.0];
        let one = |at: &[f64]| Measure { ddof: Some(1.0), scale: 1.0, sums: at.iter().map(|value| [1.0, *value, value * value]).collect() };
        let measure = one(&values);
        let kept = reduced(&[vec![0, 1, 2, 3, 4, 5], vec![6, 7]], &[3, 2], std::slice::from_ref(&measure));
        assert_eq!(kept[1], [6, 7]);
        assert_eq!(kept[0].len(), 3);
        let all: Vec<usize> = (0..8).collect();
        assert!((measure.over(&kept.concat()) - measure.over(&all)).abs() < 0.4, "{kept:?}");
        assert_eq!(reduced(&[vec![2, 0]], &[5], &[measure]), [[0, 2]]);
    }

    /// The same choice as when each change is summed anew.
    #[test]
    fn costs_from_sums_choose_the_same_members() {
        let mut random = fastrand::Rng::with_seed(5);
        for count in [7, 20, 40] {
            let values: Vec<f64> = (0..count).map(|at| if at % 5 == 0 { 1.0 } else { random.f64() - 0.5 }).collect();
            let sums: Vec<[f64; 3]> = values.iter().map(|value| [1.0, *value, value * value]).collect();
            let measures = [Measure { ddof: Some(1.0), scale: 0.5, sums: sums.clone() }, Measure { ddof: None, scale: 2.0, sums }];
            let groups = [(0..count / 2).collect::<Vec<_>>(), (count / 2..count).collect()];
            let all = groups.concat();
            let cost = Cost { measures: &measures, all: measures.iter().map(|measure| measure.over(&all)).collect() };
            let mut kept = groups.to_vec();
            while kept.iter().any(|members| members.len() > 3) {
                let more = (0..2).filter(|&group| kept[group].len() > 3);
                let changes = more.flat_map(|group| (0..kept[group].len()).map(move |place| Change { group, place, put: None }));
                let (_, best) = cost.best(&kept, &changes.collect::<Vec<_>>()).expect("one can go");
                let more = (0..2).filter(|&group| kept[group].len() > 3);
                let anew = more.flat_map(|group| (0..kept[group].len()).map(move |place| Change { group, place, put: None }));
                let anew = anew.map(|change| change.made(&kept)).min_by(|a, b| cost.over(a).total_cmp(&cost.over(b)));
                assert_eq!(Some(&best), anew.as_ref());
                kept = best;
            }
        }
    }
}
