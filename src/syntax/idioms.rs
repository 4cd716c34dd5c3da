//! Words of the field, of other tools and of other languages that this language says in another
//! way, each with what is written instead.

/// Words in lower case, and the help.
const IDIOMS: [(&[&str], &str); 13] = [
    (
        &["psd", "asd", "spectrum", "fft", "power_spectral_density"],
        "the power spectral density of `ay` is `spectrum(ay, 4 s)`; take a number of it: `maximum of spectrum(ay, 4 s, 1 Hz, 10 Hz)`; the rms of a band is `filter  band-pass 2 Hz to 4 Hz` and `value  rms`",
    ),
    (
        &["db", "decibel"],
        "a level in dB is a plain number: write `20 * log10(...)`, of spectra `10 * log10(...)`, as the value and its limit without unit",
    ),
    (&["peak_to_peak", "peak2peak", "p2p", "ptp"], "write `range`: the largest minus the smallest"),
    (&["average", "avg"], "write `mean`"),
    (&["sigma", "sd", "stdev", "stddev", "standard_deviation"], "write `std`"),
    (&["var", "variance"], "write `std^2`"),
    (&["abs", "fabs"], "write the magnitude as `|...|`"),
    (&["log"], "write `ln(...)` or `log10(...)`"),
    (&["pow", "power"], "write a power as `a^2`"),
    (&["if", "iif", "ifelse"], "write `a when CONDITION, otherwise b`"),
    (&["count", "num"], "the number of independent units is `n`, in an estimate"),
    (&["rmse", "rmsd"], "write `metric  root-mean-square difference`"),
    (&["diff", "ddx", "gradient"], "write `derivative(...)`"),
];

/// How the language says what a word means elsewhere.
pub fn idiom(word: &str) -> Option<&'static str> {
    let word = word.to_lowercase();
    IDIOMS.iter().find(|(words, _)| words.contains(&word.as_str())).map(|(_, help)| *help)
}
