//! The reference spectra.

/// A spectrum as a curve over frequency: newtons as a function of hertz.
pub(crate) struct Reference {
    pub(crate) name: &'static str,
    pub(crate) curve: fn(f64) -> f64,
}

/// Five simplified spectra of real surfaces.
pub(crate) const REFERENCES: &[Reference] = &[
    Reference { name: "two bumps", curve: two_bumps },
    Reference { name: "falling", curve: |f| 0.02 * (-f / 90.0).exp() * (1.2 + (f / 25.0).sin()) },
    Reference {
        name: "rising",
        curve: |f| 0.002 * (f / 1000.0).powf(1.5) * (1.2 + 0.5 * (f / 60.0).sin()),
    },
    Reference { name: "broad with ripple", curve: |f| 0.004 * (1.0 + 0.3 * (f * 0.18).sin()) },
    Reference { name: "few peaks", curve: few_peaks },
];

/// Degenerate spectra. A fit to one of these may succeed or return a status.
pub(crate) const HARD: &[Reference] = &[
    Reference { name: "silence", curve: |_| 0.0 },
    Reference { name: "one line", curve: |f| if f == 200.0 { 0.01 } else { 0.0 } },
    Reference { name: "flat", curve: |_| 0.003 },
    Reference { name: "very faint", curve: |f| 1e-200 * two_bumps(f) },
    Reference { name: "very strong", curve: |f| 1e100 * two_bumps(f) },
    Reference { name: "all at the low edge", curve: |f| if f == 20.0 { 0.01 } else { 0.0 } },
];

fn two_bumps(f: f64) -> f64 {
    0.01 * (-(f / 150.0).ln().powi(2)).exp() + 0.002 * (-((f - 600.0) / 120.0).powi(2)).exp()
}

fn few_peaks(f: f64) -> f64 {
    let peak = |at: f64, height: f64| height / (1.0 + ((f - at) / 12.0).powi(2));
    1e-4 + peak(85.0, 0.01) + peak(240.0, 0.006) + peak(610.0, 0.002)
}
