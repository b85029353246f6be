//! Recordings with degenerate spectra, passed through every model of the registry.

use crate::seen::{
    every_model, every_model_but, fit_with, model, outcome_text, refusal, refusal_of_all, spectrum,
};
use crate::signals::{SAMPLES, far_apart, friction, impulse, noise, quantised, scaled, sum, tone};
use crate::{Bound, Case, Section, refused, within};

pub(crate) const SECTION: Section = Section {
    title: "Recordings",
    about: "Two seconds at 20 kHz, cut into segments of 0.2 s and averaged. *Every model* is every model of the \
            registry; each is fitted, its magnitude has unit RMS, it is mixed half and half with a \
            fit of friction noise, rendered, and retuned before every sample. No sample is subnormal, \
            and the largest is bounded.",
    cases: CASES,
};

/// A row in which these models are fitted, played and changed.
const fn lives(input: &'static str, subject: &'static str, worst: fn() -> f64) -> Case {
    let bound = Bound(12.0, "× RMS", "finite, and samples");
    let operation = "fit, magnitude, mix, render, retune";
    within(input, subject, operation, bound, worst)
}

const ALL: &str = "every model";
const NO_PEAK: &str = "CannotFit: the spectrum has no peak";

/// How sPeak refuses peaks at bins, if it refuses all in the same way.
fn refusal_of_bins(signals: &[Vec<f64>]) -> String {
    let at_bins = [("frequency", "bin")];
    let refused = |signal: &Vec<f64>| {
        outcome_text(fit_with(&model("speak"), &spectrum(signal), &[], &at_bins))
    };
    let mut all: Vec<String> = signals.iter().map(refused).collect();
    all.dedup();
    all.join("; ")
}

fn one_bit() -> Vec<f64> {
    friction().iter().map(|x| x.signum()).collect()
}

const CASES: &[Case] = &[
    refused("silence", "every model", "fit", "CannotFit", || refusal_of_all(&[0.0; SAMPLES])),
    refused("a constant 3 N", "every model", "fit", "CannotFit", || {
        refusal_of_all(&[3.0; SAMPLES])
    }),
    lives("one sample of 1 N", "every model but sPeak", || every_model_but(&["speak"], &impulse())),
    refused("one sample of 1 N", "sPeak", "fit", NO_PEAK, || refusal("speak", &impulse())),
    lives("a tone of 500 Hz", ALL, || every_model(&tone(500.0))),
    lives("a tone of 999 Hz", ALL, || every_model(&tone(999.0))),
    lives("a tone of 20 Hz, the first bin", ALL, || every_model(&tone(20.0))),
    lives("a tone of 21 Hz", ALL, || every_model(&tone(21.0))),
    lives("a tone of 1000 Hz, the last bin", ALL, || every_model(&tone(1000.0))),
    refused("tones of 20 Hz and of 1000 Hz", "sPeak at bins", "fit", NO_PEAK, || {
        refusal_of_bins(&[tone(20.0), tone(1000.0)])
    }),
    lives("tones of 50 and 700 Hz, 120 dB apart", ALL, || every_model(&far_apart())),
    lives("friction noise of one bit", ALL, || every_model(&one_bit())),
    lives("3 N and half a step of a 16-bit converter", ALL, || {
        every_model(&quantised(&sum(&[3.0; SAMPLES], &scaled(&noise(), 1e-5)), 1e-5))
    }),
    lives("friction noise of 1e30 N", ALL, || every_model(&scaled(&friction(), 1e30))),
    refused("friction noise of 1e200 N", "MFCC", "fit", "not finite", || {
        refusal("mfcc", &scaled(&friction(), 1e200))
    }),
    lives("friction noise of 1e-300 N", ALL, || every_model(&scaled(&friction(), 1e-300))),
    lives("friction noise of subnormal size, 1e-310 N", ALL, || {
        every_model(&scaled(&friction(), 1e-310))
    }),
    refused(
        "NaN in one sample",
        "every model",
        "fit",
        "InvalidArgument: `magnitude`[0] is not a finite number",
        || {
            let mut broken = noise();
            broken[5_000] = f64::NAN;
            refusal("ar", &broken)
        },
    ),
];
