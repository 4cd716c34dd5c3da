//! Every constant of the diagnosis that can change an answer, by the step that uses it: its unit,
//! and why it has this value.
//!
//! A value without a source is a judgement. None is fitted to a campaign; where results were looked
//! at before a value was set, this is said.

pub mod common {
    /// Half the width of a 90 % interval, in standard errors.
    pub const NINETY: f64 = 1.645;
    /// Bootstrap resamples of the sections (Efron and Tibshirani 1993, ch. 13: some hundred for a
    /// standard error, more for tails).
    pub const RESAMPLES: usize = 400;
}

pub mod settings {
    /// Default of the largest lag in m. A larger lag means that the records belong to different
    /// places.
    pub const FURTHEST: f64 = 50.0;
    /// Default of the share of campaigns with nothing hidden in which an effect may reach the
    /// required evidence by chance.
    pub const FALSE_NAMES: f64 = 0.04;
}

pub mod cache {
    /// Largest entry in bytes: a million features.
    pub const LARGEST: u64 = 8 << 20;
    /// Length in bytes of the checksum at the start of an entry.
    pub const SEAL: usize = 64;
}

pub mod faults {
    /// A channel that keeps one value for this time in s while the simulation varies has failed.
    pub const STILL: f64 = 0.5;
    /// Variation of the simulation meanwhile, as a share of its range in the section.
    pub const MOVES: f64 = 0.02;
    /// A channel is saturated if it reaches its extreme value this many times, for this many
    /// consecutive samples.
    pub const TIMES: usize = 3;
    pub const ROW: usize = 3;
}

pub mod features {
    /// Share of the samples at either end that is replaced (Winsorised).
    pub const SPIKES: f64 = 0.01;
    /// A record is inverted if its best negative correlation exceeds the best positive one by this
    /// factor; records with a low correlation reach smaller factors by chance.
    pub const INVERTED: f64 = 1.35;
}

pub mod increments {
    /// Order of the low-pass, in each of two directions, that limits the frequencies compared.
    pub const LIMIT_ORDER: usize = 4;
    /// Largest order of the autoregressive filter; the order is that of the least AIC (Akaike
    /// 1974).
    pub const ORDER: usize = 12;
    /// A change that is to this share of its length a combination of the changes before it adds no
    /// direction.
    pub const NEW: f64 = 1e-3;
    /// Least number of samples per direction and coefficient of the filter.
    pub const SAMPLES: usize = 4;
}

pub mod observations {
    /// Sampling rates follow from rounded time stamps; a band that ends at half the rate is then
    /// allowed.
    pub const ROUNDED: f64 = 1e-3;
}

pub mod scatter {
    /// Least length of the bootstrap blocks in s.
    pub const BLOCK: f64 = 1.0;
    /// Bootstrap draws.
    pub const DRAWS: usize = 60;
    /// From this ratio of the second-largest to the largest correlation on, the lag is not unique
    /// and is not used.
    pub const AS_ALIKE: f64 = 0.8;
}

pub mod covariance {
    /// Standard deviation of a gain that the campaign declares without a number.
    pub const GAIN: f64 = 0.02;
    /// Variance of the logarithm of an rms, times bandwidth and length of the record: that of noise
    /// in a band is 1 / (4 B T) (Bendat and Piersol, section 8.5).
    pub const BAND_SCATTER: f64 = 0.25;
    /// Variance of a gain, times the length of the record in s.
    pub const GAIN_SCATTER: f64 = 0.1;
    /// Scatter of the zero point of a channel between sections, as a share of its declared offset:
    /// records of heavy vehicles, whose transducers have larger offsets, scatter by 0.6 kN where
    /// 1.1 kN is declared.
    pub const ZERO_POINT: f64 = 0.6;
    /// Variance of a feature that carries no information.
    pub const NOTHING: f64 = 1e12;
}

pub mod whiten {
    /// Number of differences that are whitened together: enough for a product of matrices to be
    /// fast.
    pub const TOGETHER: usize = 64;
}

pub mod metric {
    /// A component of the model error below this variance, in units of the allowed difference, is
    /// left out.
    pub const NEGLIGIBLE: f64 = 1e-3;
}

pub mod recorded {
    /// Seed of the noise. One seed for all channels and sections, so that their order and a change
    /// of sides do not change an answer.
    pub const SEED: u64 = 0x5EED;
}

pub mod sensitivity {
    /// Step of the finite differences, in standard deviations: large against the scatter of contact
    /// solutions, small enough to be linear.
    pub const STEP: f64 = 1.5;
}

pub mod standing {
    /// Standard deviation of the part of a discrepancy that varies between campaigns, as a share of
    /// the whole: engineering judgement.
    pub const OWN: f64 = 0.5;
}

pub mod locate {
    /// Least change of a cell by the true effect, in standard deviations, for the score of the
    /// location.
    pub const MOVED: f64 = 3.0;
}

pub mod cells {
    /// False discovery rate among the cells called significant.
    pub const FALSE_DISCOVERIES: f64 = 0.05;
}

pub mod invariants {
    /// Deviation from which an invariant is reported, in standard deviations.
    pub const WORTH: f64 = 3.0;
}

pub mod shapes {
    /// Points of a spectrum per octave; each is the power of one sixth of an octave.
    pub const TO_THE_OCTAVE: f64 = 12.0;
    /// Least number of spectral lines in a band.
    pub const RESOLVED: f64 = 3.0;
    /// Share of the Nyquist frequency up to which spectra are compared.
    pub const USABLE: f64 = 0.9;
    /// Least number of points of a spectrum.
    pub const LEAST_POINTS: f64 = 4.0;
    /// Least ratio of the largest to the smallest speed that discriminates frequency from
    /// wavelength.
    pub const SPREAD: f64 = 1.2;
    /// Least share of the resamples that agree on the scaling.
    pub const SURE: f64 = 0.95;
    /// Least significance of the largest difference, in standard errors, and its least size as a
    /// ratio.
    pub const ERRORS: f64 = 4.0;
    pub const LARGE: f64 = 1.25;
    /// Numbers of waves per wheel revolution that are reported, and their relative tolerance;
    /// higher numbers would match by chance.
    pub const TURNS: [f64; 2] = [1.0, 2.0];
    pub const WHOLE: f64 = 0.06;
    /// Least share of the variance explained by the mean row for a sentence in the report.
    pub const ALIKE: f64 = 0.5;
}

pub mod trends {
    /// Correlation from which the campaign does not discriminate two covariates.
    pub const TOGETHER: f64 = 0.8;
    /// Probability below which a trend of the residual is certain, among all trends tested
    /// (Bonferroni). It is small because the allowed discrepancy is a judgement.
    pub const CERTAIN: f64 = 1e-5;
}

pub mod workshop {
    /// How far beyond the plausible range an operation is applied, as a share of the distance from
    /// neutral.
    pub const BEYOND: f64 = 0.2;
}

pub mod calibration {
    /// Campaigns drawn from the covariance, with nothing hidden, for the required evidence and the
    /// rate of false names: 200 resolve half a per cent.
    pub const NOTHING_HIDDEN: usize = 200;
    /// Campaigns drawn with a single effect, with two effects, and with an effect that the search
    /// does not know.
    pub const SINGLES: usize = 60;
    pub const PAIRS: usize = 20;
    pub const OUTSIDE: usize = 20;
    /// Share of the campaigns in which an effect is named that counts as detectable.
    pub const NAMED: f64 = 0.9;
    /// How often another effect and size is drawn where one could not be named.
    pub const TRIES: usize = 50;
}

pub mod fit {
    /// Least distance of nodes from a size, as a share of it, for the estimate of the slope.
    pub const APART: f64 = 0.05;
}

pub mod joint {
    /// Rounds in which the model error is computed again for the fitted sizes, and the change of
    /// the shares that ends them.
    pub const ROUNDS: usize = 3;
    pub const ALIKE: f64 = 0.01;
    /// Turns of the alternating fit, and its convergence criterion as a share of chi-squared.
    /// Similar changes converge slowly.
    pub const TURNS: usize = 200;
    pub const CONVERGED: f64 = 1e-8;
}

pub mod pictures {
    /// Number of sections, and of panels per section.
    pub const SECTIONS: usize = 2;
    pub const PANELS: usize = 4;
    /// Cut-off frequency of the low-pass for display, in Hz.
    pub const SMOOTH: f64 = 20.0;
}

pub mod causes {
    /// Error of the interpolation between simulated sizes, as a share of the size; one standard
    /// deviation.
    pub const INTERPOLATION: f64 = 0.02;
}

pub mod rivals {
    /// Largest loss of evidence of a rival that the data do not discriminate from the answer.
    pub const NEAREST: f64 = 8.0;
    /// Prior weight of a cause outside the catalogue against the answer: in general, where a
    /// vehicle parameter outside the catalogue explains more, and where a residual remains.
    pub const OUTSIDE: f64 = 0.05;
    pub const OUTSIDE_SUSPECTED: f64 = 1.0;
    pub const OUTSIDE_UNEXPLAINED: f64 = 4.0;
    /// Divisor of the evidence before it becomes a probability: real discrepancies deviate from the
    /// assumed covariance.
    pub const TEMPERATURE: f64 = 4.0;
    /// Distance from which two causes are not confused by chance, in standard deviations.
    pub const TOLD_APART: f64 = 5.0;
}

pub mod verdict {
    /// Ratio of chi-squared to the number of features from which the fit is refuted: what is left
    /// is then on average 1.4 times as large as noise, tolerances and model discrepancy together.
    /// Below a quarter, they are more than twice as large as what is left.
    pub const MISFIT: f64 = 2.0;
    pub const ROOMY: f64 = 0.25;
}

pub mod words {
    /// Trends with a probability below this are reported, whether significant or not.
    pub const TOLD: f64 = 0.05;
    /// Number of unnamed candidates that are reported, and their least evidence.
    pub const TOLD_NEAREST: usize = 3;
    pub const TELLING: f64 = 10.0;
}

pub mod preflight {
    /// A change of a feature counts from one standard deviation on.
    pub const SEEN: f64 = 1.0;
    /// Number of features that are listed for an effect.
    pub const LISTED: usize = 4;
}

pub mod score {
    /// Whitened length, in standard deviations, from which an effect counts as detectable.
    pub const DETECTABLE: f64 = 5.0;
}

pub mod search {
    /// Largest number of effects in an answer.
    pub const MOST: usize = 3;
    /// The same with those within their declared tolerance, which are fitted and not named.
    pub const TOGETHER: usize = 5;
    /// Number of candidates whose joint evidence is computed, of those with the most evidence for
    /// what a set leaves; of second effects and replacements; and their least evidence. With the
    /// members fixed, an effect similar to a member has little evidence left.
    pub const TRIED: usize = 16;
    pub const SECONDS: usize = 6;
    pub const WORTH: f64 = 5.0;
    /// Number of first effects beside which second ones are tried. The best single effect need not
    /// be a member of the best pair.
    pub const FIRSTS: usize = 5;
    /// Gain of evidence of a step: the least called positive (Kass and Raftery 1995).
    pub const BETTER: f64 = 2.0;
    /// Declared standard deviations from which an effect on a tolerated parameter is named: the
    /// declared value is itself an estimate.
    pub const TOLERANCE_SD: f64 = 3.5;
    /// Least evidence that a confinement adds, and as a share of the evidence of the effect:
    /// excluding the sections that fit worst always adds some.
    pub const CONFINED: f64 = 15.0;
    pub const CONFINED_SHARE: f64 = 0.15;
}

pub mod iterate {
    /// Least evidence of a cause: real discrepancies deviate from the assumed covariance.
    pub const FLOOR: f64 = 30.0;
    /// The same for an operation on the signals, which such discrepancies do not affect: half as
    /// much; 10 is called very strong (Kass and Raftery 1995).
    pub const FLOOR_EXACT: f64 = 15.0;
    /// All sizes of a candidate are simulated from this share of the largest evidence on, and from
    /// this evidence on.
    pub const NEAR: f64 = 0.5;
    pub const WORTH: f64 = 10.0;
    /// Number of further candidates that are simulated at the point.
    pub const NEAREST: usize = 3;
    /// Largest number of rounds, and of fits within one with the fitted sizes simulated.
    pub const ROUNDS: usize = 4;
    pub const POLISHED: usize = 3;
    /// Number of members that are rejected at their own point after which the rounds end.
    pub const REFUSED: usize = 6;
    /// Relative difference of sizes up to which the answer stands still.
    pub const STILL: f64 = 0.1;
}

pub mod point {
    /// Relative difference of sizes up to which a simulated one serves for a fitted one.
    pub const ALIKE: f64 = 0.01;
    /// Least distance of the sizes to either side of a fitted one, as a share of its distance from
    /// neutral: over less, scatter of contact solutions exceeds the change.
    pub const APART: f64 = 0.15;
    /// A tolerance whose change of the features is below this, in standard deviations of all else,
    /// is not simulated again: the scatter of contact solutions alone reaches about one.
    pub const MATTERS: f64 = 1.5;
    /// Range of a lag between half and one and a half times an effect, in standard deviations, from
    /// which the lag is excluded.
    pub const JUMP: f64 = 5.0;
}

pub mod heterogeneity {
    /// Probability below which the sizes differ, among all tests (Bonferroni). Real responses
    /// deviate from simulated ones: right answers had 2e-7 at least, before the correction.
    pub const CHANCE: f64 = 1e-6;
    /// Least length of the change in a part of a view, in standard deviations.
    pub const SEEN: f64 = 2.0;
}

pub mod further {
    /// Span of the path of a free tolerance, in declared standard deviations to either side.
    pub const SPAN: f64 = 50.0;
    /// Cosine of two whitened changes above which they count as the same cause.
    pub const SAME: f64 = 0.8;
    /// Evidence of a further candidate beside an answer from which the gap is not explained: that of
    /// two effects.
    pub const LEFT: f64 = 60.0;
    /// Evidence of a tolerance from which it is a gap by itself: that of a declared deviation of
    /// four and a half.
    pub const TOLERANCE: f64 = 15.0;
    /// Gain of evidence from which a free tolerance in place of a member refutes the answer, and
    /// from which it is as possible.
    pub const REFUTES: f64 = 30.0;
    pub const POSSIBLE: f64 = 8.0;
}

pub mod channels {
    /// Lack of fit of a channel from which the residual is significant, in standard deviations of
    /// chi-squared.
    pub const LACK: f64 = 5.0;
    /// The gap is unexplained if more than this share of the excess remains in several channels, or
    /// in one that exceeds [`LACK`] by this factor.
    pub const MOST_LEFT: f64 = 0.5;
    pub const FAR_BEYOND: f64 = 3.0;
    /// One section in this many may be an outlier, such as a wheelset that reaches the flange on
    /// one side of the comparison only.
    pub const ONE_IN: usize = 8;
}

pub mod stability {
    /// Candidates with at least this share of a member's evidence are compared with it.
    pub const NEAR: f64 = 0.3;
    /// Least share of the resamples in which a member must be first, that is, have the most
    /// evidence.
    pub const FIRST: f64 = 0.5;
}

pub mod decrease {
    /// Number of folds for cross-validation, stratified.
    pub const FOLDS: usize = 4;
    /// An effect touches a quantity if the root mean square change of its values exceeds this share
    /// of the limit of their standard deviation.
    pub const TOUCHED: f64 = 0.1;
}
