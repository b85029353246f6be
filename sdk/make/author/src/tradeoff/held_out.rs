//! The two halves of a recording, which are used to measure held-out errors. The sweep fits each
//! contender (a model with a setting, or a baseline) to the odd blocks and compares it with the
//! even blocks.

use crate::{AuthorError, OddAndEven, SegmentSpectra, SpectrumOptions, agreement, odd_and_even};

use crate::tradeoff::Subject;
use crate::tradeoff::accuracy::{Accuracy, FAR_DB, accuracy};
use crate::tradeoff::contender::{Contender, ContenderKind};
use crate::tradeoff::error_axis::HELD_OUT_MEASURE;
use crate::tradeoff::measurement::rms_of;

/// The halves of a recording and the difference between them.
#[derive(Debug, Clone)]
pub(crate) struct HeldOut {
    pub(crate) halves: OddAndEven,
    /// Third-octave difference between the odd and the even blocks, decibels; always above 0.
    pub(crate) floor_db: f64,
    /// All measures of that difference.
    pub(crate) repeats: Accuracy,
}

impl HeldOut {
    /// Cuts the stretches of a recording that are read into odd and even blocks.
    ///
    /// # Errors
    /// Returns the reason as an error if the recording has too few blocks to hold any out.
    pub(crate) fn new(
        part: &SegmentSpectra,
        options: &SpectrumOptions,
    ) -> Result<Self, &'static str> {
        let halves = odd_and_even(std::slice::from_ref(part), options.averaging)
            .ok_or("fewer than four blocks of 0.2 s are read of it")?;
        let mut repeats = accuracy(&halves.even, &halves.odd.magnitude);
        // This difference is the repeatability itself, so it is within the repeatability by
        // definition.
        repeats.felt.within_repeatability = true;
        let found = agreement(halves.even.as_ref(), &halves.odd.magnitude).get(HELD_OUT_MEASURE);
        let floor_db = found.filter(|db| db.is_finite()).ok_or("half of its blocks are silent")?;
        if floor_db <= 0.0 {
            return Err("all its blocks are equal");
        }
        Ok(Self { halves, floor_db, repeats })
    }
}

impl Contender {
    /// Fits the contender to the odd blocks, plays it, and returns the third-octave difference, in
    /// decibels, from the even blocks. If the contender is the recording, returns the difference
    /// between the odd and the even blocks. `None` if the recording has no blocks.
    pub(crate) fn held_out_error_db(
        &self,
        subject: &Subject,
        quick: bool,
    ) -> Result<Option<f64>, AuthorError> {
        let Ok(held_out) = &subject.held_out else {
            return Ok(None);
        };
        if matches!(self.kind, ContenderKind::Recording) {
            return Ok(Some(held_out.floor_db));
        }
        let OddAndEven { odd, even, .. } = &held_out.halves;
        let stored = self.store(subject, odd, &self.fit(odd)?)?;
        let rendered = self.rendered(subject, &stored, quick)?;
        let found = agreement(even.as_ref(), &rms_of(&rendered.spectra)).get(HELD_OUT_MEASURE);
        Ok(Some(found.unwrap_or(FAR_DB).min(FAR_DB)))
    }
}
