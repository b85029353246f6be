//! Guards that stand between hard inputs and arithmetic: what each is, and what the code is without it.
//! `cargo run -p htex-hard-cases --example guards` takes them out one after the other and asks whether a
//! case fails. Comparisons are not listed: `cargo mutants` turns those round by itself.

/// A guard in the code.
#[derive(Debug)]
pub struct Guard {
    /// The file, from the workspace's folder.
    pub file: &'static str,
    /// The code with the guard, found once in the file.
    pub with: &'static str,
    /// The code without.
    pub without: &'static str,
    /// The sections whose cases hold it, as tests of `tests/table.rs`.
    pub held_by: &'static str,
    /// Whether those need the feature `pipeline`.
    pub pipeline: bool,
}

const fn guard(
    file: &'static str,
    with: &'static str,
    without: &'static str,
    held_by: &'static str,
) -> Guard {
    Guard {
        file,
        with,
        without,
        held_by,
        pipeline: false,
    }
}

const fn piped(guard: Guard) -> Guard {
    Guard {
        pipeline: true,
        ..guard
    }
}

/// All of them.
pub const GUARDS: &[Guard] = &[
    guard(
        "sdk/dsp/src/linear_prediction.rs",
        "let k = reflection.clamp(-MAX_REFLECTION, MAX_REFLECTION);",
        "let k = reflection;",
        "prediction",
    ),
    guard(
        "sdk/dsp/src/linear_prediction.rs",
        "let (even, odd) = ((front + back) * of_sum, (front - back) * of_difference);",
        "let (even, odd) = (0.5 * (front + k * back + back + k * front) / ((1.0 - k) * (1.0 + k)), 0.5 * (front + k * back - back - k * front) / ((1.0 - k) * (1.0 + k))); let _ = (of_sum, of_difference);",
        "prediction",
    ),
    guard(
        "sdk/dsp/src/biquad.rs",
        "const SMALLEST_STATE: f64 = 1e-200;",
        "const SMALLEST_STATE: f64 = 0.0;",
        "prediction sound",
    ),
    guard(
        "sdk/dsp/src/estimation.rs",
        "let error = (gram[0] - explained).max(0.0) / count.max(1) as f64;",
        "let error = (gram[0] - explained) / count.max(1) as f64;",
        "prediction",
    ),
    guard(
        "sdk/dsp/src/non_negative.rs",
        "column.between(&scratch.at).max(0.0)",
        "column.between(&scratch.at)",
        "cepstrum",
    ),
    guard("sdk/dsp/src/biquad.rs", ".max(0.0)\n}", "\n}", "slope"),
    guard(
        "plugins/ar/src/fit.rs",
        "within_radius(coefficients, radius)",
        "{ let _ = (within_radius(&[], 0.5), radius); coefficients.to_vec() }",
        "autoregression",
    ),
    guard(
        "plugins/ar/src/lib.rs",
        "level > 0.0 && level.is_finite()",
        "level > 0.0",
        "autoregression",
    ),
    guard(
        "plugins/mfcc/src/lib.rs",
        "libm::log(e.max(FLOOR))",
        "libm::log(e.max(0.0 * FLOOR))",
        "cepstrum",
    ),
    guard(
        "plugins/mfcc/src/inverse.rs",
        "*power = power.max(0.0)",
        "*power = *power",
        "cepstrum recordings",
    ),
    guard(
        "plugins/speak/src/lib.rs",
        "const FAINTEST: f64 = 1e-7;",
        "const FAINTEST: f64 = 0.0;",
        "recordings",
    ),
    guard(
        "plugins/sbeta/src/fit.rs",
        "let shape = |x: f64| (bound + x * x).min(LARGEST);",
        "let shape = |x: f64| (bound + x * x).min(1e9 * LARGEST);",
        "beta",
    ),
    guard(
        "plugins/sbeta/src/lib.rs",
        "{ 0.25 * GRID_HZ }",
        "{ 0.0 * GRID_HZ }",
        "beta",
    ),
    guard(
        "plugins/sbeta/src/fit.rs",
        "const HIGHEST: f64 = 2.0;",
        "const HIGHEST: f64 = f64::INFINITY;",
        "beta",
    ),
    guard("plugins/sslope/src/fit.rs", ".max(1.0);", ";", "slope"),
    guard(
        "plugins/sslope/src/fit.rs",
        "(steps * step_db_per_decade / DB_PER_ORDER).min(MAX_ORDER)",
        "(steps * step_db_per_decade / DB_PER_ORDER)",
        "slope",
    ),
    piped(guard(
        "sdk/author/src/spectrum.rs",
        "h.conj() / (norm * norm.max(floor))",
        "h.conj() / (norm * norm)",
        "files",
    )),
    piped(guard(
        "sdk/play/src/exploration.rs",
        "self.force.ratio(force_n).min(MOST_GAIN)",
        "self.force.ratio(force_n)",
        "motion",
    )),
    piped(guard(
        "sdk/scene/src/stages/square_root.rs",
        "radicand.max(0.0).sqrt()",
        "radicand.sqrt()",
        "motion",
    )),
    piped(guard(
        "sdk/scene/src/stages/limiter.rs",
        "sample.clamp(-limit, limit)",
        "*sample",
        "motion",
    )),
    piped(guard(
        "sdk/scene/src/stages/gain.rs",
        "call.level_rms > LEAST_RMS",
        "call.level_rms > 0.0",
        "motion",
    )),
];
