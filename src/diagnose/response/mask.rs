//! Sections to which an effect is confined.

use super::candidate::Candidate;

/// Sections to which an effect is confined; mask 0 is all sections.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    /// Column and values; nothing for all sections.
    pub confined: Option<(String, Vec<String>)>,
    pub sections: Vec<bool>,
    /// The candidate whose fit selected the sections, if they were selected from the data: the
    /// selection has a penalty.
    pub asked_by: Option<usize>,
}

#[must_use]
pub fn allowed(candidates: &[Candidate], masks: &[Mask], candidate: usize, mask: usize) -> bool {
    mask == 0 || masks[mask].asked_by.map_or(candidates[candidate].confinable, |by| by == candidate)
}

impl Mask {
    /// Bias of sections selected from the data by their size: the expected mean of that many
    /// largest values of a standard normal sample, in standard deviations. 0 where nothing was
    /// selected.
    #[must_use]
    pub fn picked(&self) -> f64 {
        use statrs::distribution::{Continuous, ContinuousCDF, Normal};
        let inside = self.sections.iter().filter(|inside| **inside).count();
        let share = inside as f64 / self.sections.len().max(1) as f64;
        if self.asked_by.is_none() || inside == 0 || share >= 1.0 {
            return 0.0;
        }
        // The mean of the upper tail of a normal distribution.
        let normal = Normal::standard();
        normal.pdf(normal.inverse_cdf(1.0 - share)) / share
    }

    /// A change in the sections of the mask, zero elsewhere.
    #[must_use]
    pub fn on(&self, change: &[f64]) -> Vec<f64> {
        let mut masked = change.to_vec();
        let size = masked.len() / self.sections.len().max(1);
        for (section, inside) in self.sections.iter().enumerate() {
            if !inside {
                masked[section * size..(section + 1) * size].fill(0.0);
            }
        }
        masked
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of the upper half of a standard normal distribution is (2 / pi)^1/2 = 0.798, of the
    /// upper quarter 1.271 (tables of selection intensity, Falconer and Mackay 1996, appendix A).
    #[test]
    fn sections_that_were_picked_are_off_by_chance() {
        let mask = |inside: usize, asked_by| Mask {
            confined: None,
            sections: (0..16).map(|at| at < inside).collect(),
            asked_by,
        };
        assert!((mask(8, Some(0)).picked() - std::f64::consts::FRAC_2_PI.sqrt()).abs() < 1e-9);
        assert!((mask(4, Some(0)).picked() - 1.271).abs() < 1e-3);
        assert_eq!((mask(8, None).picked(), mask(16, Some(0)).picked()), (0.0, 0.0));
    }
}
