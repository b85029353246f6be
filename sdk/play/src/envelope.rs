//! What a voice plays, in a few numbers: for vibration motors, phones and pads that are driven by
//! level and frequency instead of samples.
//!
//! The level is that of the samples of a block, exactly and without delay. Centroid and bands are
//! those of Hann windows, as [`htex_dsp::envelope`] defines them. They lag: the middle of a window
//! is 21 to 26 ms before its end at 20 and 48 kHz, and a window ends every 11 to 13 ms.

use htex_dsp::envelope::Analyser;
use htex_dsp::grid::Band;

use crate::Error;

/// Most bands of an envelope.
pub const MOST_BANDS: usize = 32;

/// What a voice played since it was last asked ([`Voice::envelope`](crate::Voice::envelope)),
/// effects, gain and limiter included.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Envelope {
    /// Level of the samples, RMS in the asset's unit; 0 for no samples.
    pub level_rms: f64,
    /// Mean frequency, weighted by power, hertz; 0 for silence.
    pub centroid_hz: f64,
    /// Samples since the last call.
    pub frames: u64,
}

/// Makes the analyser of a voice with `count` bands; `None` for 0.
///
/// # Errors
/// When there are more than [`MOST_BANDS`].
pub(crate) fn analyser(count: usize, band: Band, rate_hz: f64) -> Result<Option<Analyser>, Error> {
    match count {
        0 => Ok(None),
        1..=MOST_BANDS => Ok(Some(Analyser::new(count, band, rate_hz))),
        _ => Err(Error::OutOfRange {
            name: "number of bands",
            value: count as f64,
            range: "an envelope has at most 32",
        }),
    }
}

/// Reads an analyser of as many bands as `bands` has, or none of them.
///
/// # Errors
/// When `bands` has another number of places; nothing is forgotten then.
pub(crate) fn read(analyser: Option<&mut Analyser>, bands: &mut [f64]) -> Result<Envelope, Error> {
    let there = analyser.as_ref().map_or(0, |analyser| analyser.bands());
    let given = bands.len();
    match analyser {
        Some(analyser) if given == 0 || given == there => {
            let measured = analyser.read(bands);
            Ok(Envelope {
                level_rms: measured.level_rms,
                centroid_hz: measured.centroid_hz,
                frames: measured.frames,
            })
        }
        _ => Err(Error::Bands { given, there }),
    }
}
