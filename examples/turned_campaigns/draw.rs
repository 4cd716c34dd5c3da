//! Random sizes.

use fishplate::effects::Gauss;

/// Random numbers, reproducible from a seed.
#[derive(Debug)]
pub struct Draw(Gauss);

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self(Gauss::new(seed))
    }

    /// Uniform between two numbers, rounded to so many decimals.
    pub fn between(&mut self, low: f64, high: f64, decimals: i32) -> f64 {
        rounded(low + (high - low) * self.0.uniform(), decimals)
    }

    /// In one of two ranges.
    pub fn either(&mut self, low: (f64, f64), high: (f64, f64), decimals: i32) -> f64 {
        let (from, to) = if self.chance(0.5) { low } else { high };
        self.between(from, to, decimals)
    }

    /// Between two numbers, or between their negatives.
    pub fn either_sign(&mut self, low: f64, high: f64, decimals: i32) -> f64 {
        self.either((low, high), (-high, -low), decimals)
    }

    pub fn normal(&mut self, deviation: f64) -> f64 {
        deviation * self.0.next()
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.0.uniform() < share
    }

    pub fn below(&mut self, bound: usize) -> usize {
        self.0.below(bound)
    }

    pub fn one<'a, T: ?Sized>(&mut self, of: &[&'a T]) -> &'a T {
        of[self.below(of.len())]
    }

    /// Draws `count` elements in random order, without repetition.
    pub fn some<T>(&mut self, mut of: Vec<T>, count: usize) -> Vec<T> {
        let mut taken = Vec::new();
        while taken.len() < count && !of.is_empty() {
            let at = self.below(of.len());
            taken.push(of.swap_remove(at));
        }
        taken
    }
}

fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    (value * scale).round() / scale
}
