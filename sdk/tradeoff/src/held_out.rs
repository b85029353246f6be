//! What a contender is fitted to and what is held out of it: the odd and the even blocks of a
//! recording.

use htex_author::{OddAndEven, SegmentSpectra, SpectrumOptions, agreement, odd_and_even};

use crate::accuracy::{Accuracy, FAR_DB, accuracy};
use crate::contender::{Contender, ContenderKind};
use crate::error_axis::HELD_OUT_MEASURE;
use crate::measured::rms_of;
use crate::{Subject, TradeoffError};

/// The halves of a recording and their difference.
#[derive(Debug, Clone)]
pub(crate) struct HeldOut {
    pub(crate) halves: OddAndEven,
    /// Third-octave difference of the odd blocks from the even ones, decibels: above 0.
    pub(crate) floor_db: f64,
    /// All measures of that difference.
    pub(crate) repeats: Accuracy,
}

impl HeldOut {
    /// Cuts what is read of a recording into blocks.
    ///
    /// # Errors
    /// Why there is nothing to hold out.
    pub(crate) fn new(
        part: &SegmentSpectra,
        options: &SpectrumOptions,
    ) -> Result<Self, &'static str> {
        let halves = odd_and_even(std::slice::from_ref(part), options.averaging)
            .ok_or("fewer than four blocks of 0.2 s are read of it")?;
        let mut repeats = accuracy(&halves.even, &halves.odd.magnitude);
        // The difference is the repeatability itself.
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
    /// Fits the odd blocks, plays, and returns the third-octave difference from the even ones,
    /// decibels; `None` without blocks. Of the recording, it is the difference of the odd blocks.
    pub(crate) fn held_out_error_db(
        &self,
        subject: &Subject,
        quick: bool,
    ) -> Result<Option<f64>, TradeoffError> {
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
