//! Plans of Fourier transforms. A plan takes longer to make than to use, so that each thread keeps
//! those it has made.

use std::{cell::RefCell, sync::Arc};

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

thread_local! {
    static PLANNER: RefCell<RealFftPlanner<f64>> = RefCell::new(RealFftPlanner::new());
}

/// From `length` real samples to `length / 2 + 1` spectral lines, not normalised.
pub fn forward(length: usize) -> Arc<dyn RealToComplex<f64>> {
    planned(length, RealFftPlanner::plan_fft_forward)
}

/// The way back, also not normalised: the result of both is `length` times the samples.
pub fn inverse(length: usize) -> Arc<dyn ComplexToReal<f64>> {
    planned(length, RealFftPlanner::plan_fft_inverse)
}

/// Longest transform whose plan is kept; it takes about 1 MB. Records of a section are shorter.
const LONGEST: usize = 1 << 16;

/// Only plans of powers of two are kept: there are few of them, and samples are padded to such
/// lengths.
fn planned<T>(length: usize, plan: impl Fn(&mut RealFftPlanner<f64>, usize) -> T) -> T {
    if length.is_power_of_two() && length <= LONGEST {
        PLANNER.with_borrow_mut(|planner| plan(planner, length))
    } else {
        plan(&mut RealFftPlanner::new(), length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The transform of a cosine of three periods: half the samples in line 3, nothing elsewhere;
    /// and back.
    #[test]
    fn a_cosine_there_and_back() {
        for length in [16, 24] {
            let wave: Vec<f64> = (0..length)
                .map(|at| (std::f64::consts::TAU * 3.0 * at as f64 / length as f64).cos())
                .collect();
            for _ in 0..2 {
                let mut lines = forward(length).make_output_vec();
                forward(length)
                    .process(&mut wave.clone(), &mut lines)
                    .expect("the lengths of the plan");
                for (at, line) in lines.iter().enumerate() {
                    let expected = if at == 3 { length as f64 / 2.0 } else { 0.0 };
                    assert!(
                        (line.re - expected).abs() < 1e-12 && line.im.abs() < 1e-12,
                        "{at}: {line}"
                    );
                }
                let mut back = inverse(length).make_output_vec();
                inverse(length).process(&mut lines, &mut back).expect("the lengths of the plan");
                assert!(
                    back.iter()
                        .zip(&wave)
                        .all(|(back, wave)| (back / length as f64 - wave).abs() < 1e-14)
                );
            }
        }
    }
}
