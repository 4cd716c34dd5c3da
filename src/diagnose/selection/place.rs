//! Weighing of differences with the tolerances simulated together with members. A vehicle with low
//! damping is sensitive to a stiffness that has no influence otherwise, and short waves matter less
//! where others are present.

use std::sync::Arc;

use crate::diagnose::inference::fit::Fitted;
use crate::diagnose::levels::place::ALIKE;
use crate::diagnose::uncertainty::whiten::{Covariance, Whitener};

/// A weighing: difference and covariance with members, or without effects.
#[derive(Debug)]
pub struct Place {
    /// The members that are simulated with it: candidate, mask and size.
    pub members: Vec<(usize, usize, f64)>,
    /// Measured - simulated, without the expected deviation of the tolerances simulated with the
    /// members.
    pub difference: Vec<f64>,
    pub covariance: Covariance,
    pub whitener: Whitener,
    /// The whitened difference.
    pub z: Vec<f64>,
}

impl Place {
    /// The weighing without effects.
    #[must_use]
    pub fn new(covariance: Covariance, difference: Vec<f64>) -> Self {
        let whitener = covariance.whitener();
        Self {
            members: Vec::new(),
            z: whitener.apply(&difference),
            difference,
            covariance,
            whitener,
        }
    }

    #[must_use]
    pub fn is_alone(&self) -> bool {
        self.members.is_empty()
    }

    /// Whether it is for these members, of any size.
    fn is_beside(&self, members: &[Fitted]) -> bool {
        let same = |((candidate, mask, _), member): (&(usize, usize, f64), &Fitted)| {
            (*candidate, *mask) == (member.candidate, member.mask)
        };
        self.members.len() == members.len() && self.members.iter().zip(members).all(same)
    }

    /// Whether it is for these members, of about these sizes.
    fn is_near(&self, members: &[Fitted]) -> bool {
        let near = |((.., size), member): (&(usize, usize, f64), &Fitted)| {
            (size - member.size).abs() <= ALIKE * size.abs()
        };
        self.is_beside(members) && self.members.iter().zip(members).all(near)
    }
}

/// Weighings with members, in order of computation.
#[derive(Clone, Debug, Default)]
pub struct Places(Vec<Arc<Place>>);

impl Places {
    pub fn push(&mut self, place: Arc<Place>) {
        self.0.push(place);
    }

    /// The last one for these members, of any size.
    #[must_use]
    pub fn beside(&self, members: &[Fitted]) -> Option<Arc<Place>> {
        self.0.iter().rev().find(|place| place.is_beside(members)).cloned()
    }

    /// The last one for these members, with sizes close to these.
    #[must_use]
    pub fn near(&self, members: &[Fitted]) -> Option<Arc<Place>> {
        self.0.iter().rev().find(|place| place.is_near(members)).cloned()
    }
}
