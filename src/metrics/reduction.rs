//! Reduction of a set to fewer members of each group, so that the highest of several measures of
//! scatter stays almost the same.
//!
//! Götz and Polach (section 4.1) choose nine sections per zone so that the highest standard
//! deviation of a validation quantity over all sections remains almost the same. They do not
//! describe the method. Here members are removed one at a time, always the one whose removal
//! changes the scatter least; then members are exchanged as long as the result improves. While very
//! many are too many, a small part of them is removed at a time.

use rayon::prelude::*;

use super::moments::{Moments, Summed};

/// Weight of the scatter of single measures against the highest.
const OTHERS: f64 = 0.1;
/// Largest number of exchanges.
const MOST_EXCHANGES: usize = 200;
/// An exchange that improves less is none, but rounding.
const IMPROVES: f64 = 1e-12;

/// Of the members that are still too many, one in so many is removed at a time, at least one. The
/// work then grows with the number of members, and not with its square. Fewer than twice this
/// number are removed one by one.
const PART: usize = 100;

/// The scatter of members with these moments in all; 0 where it is not defined.
fn scatter(measure: &Summed, total: Moments) -> f64 {
    measure.value(total).unwrap_or(0.0)
}

/// The scatter of some members by each measure.
pub fn over(measures: &[Summed], members: &[usize]) -> Vec<f64> {
    let of = |measure: &Summed| scatter(measure, measure.total(members.iter().copied()));
    measures.iter().map(of).collect()
}

/// How far the scatter of some members is from that of all.
struct Cost<'a> {
    measures: &'a [Summed],
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
        self.of(over(self.measures, &kept.concat()).into_iter())
    }

    /// The cost after each of the changes, from sums over all members.
    fn after(&self, kept: &[Vec<usize>], changes: &[Change]) -> Vec<f64> {
        let members = kept.concat();
        let totals: Vec<Moments> =
            self.measures.iter().map(|measure| measure.total(members.iter().copied())).collect();
        let cost = |change: &Change| {
            self.of(self.measures.iter().zip(&totals).map(|(measure, total)| {
                let out = measure.moments[kept[change.group][change.place]];
                let put = change.put.map_or_else(Moments::default, |put| measure.moments[put]);
                scatter(measure, total.minus(out).plus(put))
            }))
        };
        changes.par_iter().map(cost).collect()
    }
}

/// A change takes a member out and may put another in.
#[derive(Clone, Copy)]
struct Change {
    group: usize,
    place: usize,
    put: Option<usize>,
}

/// The members of each group that are kept, at most `keep` of each, in the order given.
pub fn reduced(groups: &[Vec<usize>], keep: &[usize], measures: &[Summed]) -> Vec<Vec<usize>> {
    let all = groups.concat();
    let cost = Cost { measures, all: over(measures, &all) };
    let mut kept: Vec<Vec<usize>> = groups.to_vec();
    while let Some(without) = without_some(&cost, &kept, keep) {
        kept = without;
    }
    let mut now = cost.over(&kept);
    for _ in 0..MOST_EXCHANGES {
        let mut changes = Vec::new();
        for (group, of) in groups.iter().enumerate() {
            let others: Vec<usize> =
                of.iter().copied().filter(|other| !kept[group].contains(other)).collect();
            for place in 0..kept[group].len() {
                changes.extend(others.iter().map(|&other| Change {
                    group,
                    place,
                    put: Some(other),
                }));
            }
        }
        let costs = cost.after(&kept, &changes);
        // The costs of others differ from the least by more than rounding, or improve as little.
        let least = changes.iter().zip(costs).min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((&Change { group, place, put: Some(put) }, _)) = least else { break };
        let out = std::mem::replace(&mut kept[group][place], put);
        let changed = cost.over(&kept);
        if changed >= now - IMPROVES {
            kept[group][place] = out;
            break;
        }
        now = changed;
    }
    kept.iter_mut().for_each(|members| members.sort_unstable());
    kept
}

/// The groups without the members whose removal costs least: one in [`PART`] of those that are too
/// many, at least one. `None` if no group has too many.
fn without_some(cost: &Cost<'_>, kept: &[Vec<usize>], keep: &[usize]) -> Option<Vec<Vec<usize>>> {
    let mut excess: Vec<usize> =
        kept.iter().zip(keep).map(|(members, keep)| members.len().saturating_sub(*keep)).collect();
    let all: usize = excess.iter().sum();
    let mut left = if all == 0 { return None } else { (all / PART).max(1) };
    let more = (0..kept.len()).filter(|&group| excess[group] > 0);
    let changes: Vec<Change> = more
        .flat_map(|group| {
            (0..kept[group].len()).map(move |place| Change { group, place, put: None })
        })
        .collect();
    let costs = cost.after(kept, &changes);
    let mut order: Vec<usize> = (0..changes.len()).collect();
    order.sort_by(|&a, &b| costs[a].total_cmp(&costs[b]));
    let mut goes: Vec<Vec<bool>> = kept.iter().map(|members| vec![false; members.len()]).collect();
    for Change { group, place, .. } in order.into_iter().map(|at| changes[at]) {
        if left > 0 && excess[group] > 0 {
            (goes[group][place], excess[group], left) = (true, excess[group] - 1, left - 1);
        }
    }
    let stay = |(members, goes): (&Vec<usize>, &Vec<bool>)| {
        members.iter().zip(goes).filter(|(_, goes)| !**goes).map(|(at, _)| *at).collect()
    };
    Some(kept.iter().zip(&goes).map(stay).collect())
}

#[cfg(test)]
mod tests {
    use super::super::moments::Moment;
    use super::*;

    #[test]
    fn the_members_that_scatter_are_kept() {
        let values: [f64; 8] = [0.0, 0.1, -0.1, 5.0, -5.0, 0.2, 1.0, -1.0];
        let members: Vec<Vec<f64>> = values.iter().map(|value| vec![*value]).collect();
        let measure = Summed::new(Moment::Deviation { ddof: 1.0 }, 1.0, &members);
        let highest = |members: &[usize]| over(std::slice::from_ref(&measure), members)[0];
        let kept =
            reduced(&[vec![0, 1, 2, 3, 4, 5], vec![6, 7]], &[3, 2], std::slice::from_ref(&measure));
        assert_eq!(kept[1], [6, 7]);
        assert_eq!(kept[0].len(), 3);
        let all: Vec<usize> = (0..8).collect();
        assert!((highest(&kept.concat()) - highest(&all)).abs() < 0.4, "{kept:?}");
        assert_eq!(reduced(&[vec![2, 0]], &[5], std::slice::from_ref(&measure)), [[0, 2]]);
    }

    /// No other removal costs less, when each is summed anew.
    #[test]
    fn what_goes_costs_least() {
        let mut random = fastrand::Rng::with_seed(5);
        for count in [7, 20, 40] {
            let measures = measures(count, &mut random);
            let groups = [(0..count / 2).collect::<Vec<_>>(), (count / 2..count).collect()];
            let cost = cost(&measures);
            let mut kept = groups.to_vec();
            while let Some(next) = without_some(&cost, &kept, &[3, 3]) {
                let places = (0..2).filter(|&group| kept[group].len() > 3);
                let places = places
                    .flat_map(|group| (0..kept[group].len()).map(move |place| (group, place)));
                let least = places
                    .map(|(group, place)| {
                        let mut changed = kept.clone();
                        changed[group].remove(place);
                        cost.over(&changed)
                    })
                    .min_by(f64::total_cmp)
                    .expect("one can go");
                assert!((cost.over(&next) - least).abs() < 1e-12, "{} {least}", cost.over(&next));
                assert_eq!(next.concat().len() + 1, kept.concat().len());
                kept = next;
            }
        }
    }

    fn measures(count: usize, random: &mut fastrand::Rng) -> [Summed; 2] {
        let values = (0..count).map(|at| if at % 5 == 0 { 1.0 } else { random.f64() - 0.5 });
        let members: Vec<Vec<f64>> = values.map(|value| vec![value]).collect();
        [
            Summed::new(Moment::Deviation { ddof: 1.0 }, 0.5, &members),
            Summed::new(Moment::RootMeanSquare, 2.0, &members),
        ]
    }

    fn cost(measures: &[Summed]) -> Cost<'_> {
        let all: Vec<usize> = (0..measures[0].moments.len()).collect();
        Cost { measures, all: over(measures, &all) }
    }

    /// Also where many are removed at a time, the scatter stays. 2000 members of four groups, nine
    /// of each are kept. Before the exchanges the scatter of both measures is within 5 % of that of
    /// all (a bound set after a look at the results; removed one at a time, such samples come to 2
    /// to 8 %, computed with NumPy). After the exchanges the cost is below 1e-3. Far fewer rounds
    /// than members are needed.
    #[test]
    fn many_at_a_time_keep_the_scatter() {
        let count = 2000;
        let measures = measures(count, &mut fastrand::Rng::with_seed(9));
        let groups: Vec<Vec<usize>> =
            (0..4).map(|group| (group..count).step_by(4).collect()).collect();
        let cost = cost(&measures);
        let (mut kept, mut rounds) = (groups.clone(), 0);
        while let Some(without) = without_some(&cost, &kept, &[9; 4]) {
            (kept, rounds) = (without, rounds + 1);
        }
        assert!(rounds < 500 && kept.iter().all(|members| members.len() == 9), "{rounds}");
        for (found, all) in over(&measures, &kept.concat()).iter().zip(&cost.all) {
            assert!((found / all - 1.0).abs() < 0.05);
        }
        assert!(cost.over(&reduced(&groups, &[9; 4], &measures)) < 1e-3);
    }
}
