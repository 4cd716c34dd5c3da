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

/// The members of each group that are kept, at most `keep` of each, in the order given. `scatter` gives the measures of some members.
pub fn reduced(groups: &[Vec<usize>], keep: &[usize], scatter: &dyn Fn(&[usize]) -> Vec<f64>) -> Vec<Vec<usize>> {
    let flat = |kept: &[Vec<usize>]| kept.concat();
    let all = scatter(&flat(groups));
    let highest = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
    let cost = |members: &[usize]| {
        let found = scatter(members);
        let others = found.iter().zip(&all).map(|(found, all)| (found - all).powi(2)).sum::<f64>() / all.len().max(1) as f64;
        (highest(&found) - highest(&all)).abs() + OTHERS * others.sqrt()
    };
    let mut kept: Vec<Vec<usize>> = groups.to_vec();
    // One member removed, or one exchanged for another: the first of the best.
    while let Some(next) = (0..kept.len())
        .filter(|&group| kept[group].len() > keep[group])
        .flat_map(|group| (0..kept[group].len()).map(move |place| (group, place)))
        .map(|(group, place)| {
            let mut without = kept.clone();
            without[group].remove(place);
            (cost(&flat(&without)), without)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
    {
        kept = next.1;
    }
    let mut now = cost(&flat(&kept));
    for _ in 0..MOST_EXCHANGES {
        let mut best: Option<(f64, Vec<Vec<usize>>)> = None;
        for (group, of) in groups.iter().enumerate() {
            for place in 0..kept[group].len() {
                for &other in of.iter().filter(|other| !kept[group].contains(other)) {
                    let mut changed = kept.clone();
                    changed[group][place] = other;
                    let cost = cost(&flat(&changed));
                    if cost < now - IMPROVES && best.as_ref().is_none_or(|(before, _)| cost < *before) {
                        best = Some((cost, changed));
                    }
                }
            }
        }
        let Some((cost, changed)) = best else { break };
        (now, kept) = (cost, changed);
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
        let deviation = |members: &[usize]| {
            let mean = members.iter().map(|&at| values[at]).sum::<f64>() / members.len() as f64;
            vec![(members.iter().map(|&at| (values[at] - mean).powi(2)).sum::<f64>() / (members.len() as f64 - 1.0)).sqrt()]
        };
        let kept = reduced(&[vec![0, 1, 2, 3, 4, 5], vec![6, 7]], &[3, 2], &deviation);
        assert_eq!(kept[1], [6, 7]);
        assert_eq!(kept[0].len(), 3);
        let all: Vec<usize> = (0..8).collect();
        assert!((deviation(&kept.concat())[0] - deviation(&all)[0]).abs() < 0.4, "{kept:?}");
        assert_eq!(reduced(&[vec![2, 0]], &[5], &deviation), [[0, 2]]);
    }
}
