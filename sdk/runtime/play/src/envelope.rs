//! A voice's output summarised in a few numbers, for vibration motors, phones and gamepads that
//! play a level and a frequency instead of samples.
//!
//! The level is exact and has no delay, because it is computed from the block's own samples. The
//! centroid and the bands have a delay, because they are computed from Hann windows
//! ([`htex_dsp::envelope`]). At sample rates of 20 and 48 kHz, the middle of a window is 21 to 26
//! ms before its end, and a window ends every 11 to 13 ms.

use htex_dsp::envelope::Analyser;
use htex_dsp::grid::Band;

use crate::Error;

/// Largest number of bands in an envelope.
pub const MOST_BANDS: usize = 32;

/// Level and mean frequency of the samples that a voice played since the last call of
/// [`Voice::envelope`](crate::Voice::envelope). Effects, gain and limiter are included.
///
/// ```no_run
/// use htex::{Texture, VoiceOptions};
/// let options = VoiceOptions::default().with_envelope_bands(1);
/// let mut voice = Texture::open("sandpaper.htex")?.voice(&options)?;
/// voice.render(&mut [0.0; 200])?;
/// let envelope = voice.envelope(&mut [])?;
/// println!("{} N at {} Hz", envelope.level_rms, envelope.centroid_hz);
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Envelope {
    /// Level: the RMS of the samples in the asset's unit; 0 if there were no samples.
    pub level_rms: f64,
    /// Mean frequency, weighted by power, hertz; 0 for silence.
    pub centroid_hz: f64,
    /// Number of samples since the last call.
    pub frames: u64,
}

/// Makes a voice's analyser with `count` bands, or returns `None` if `count` is 0.
///
/// # Errors
/// Returns an error if there are more than [`MOST_BANDS`].
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

/// Reads an analyser, and writes its bands to `bands`. The length of `bands` must be the number of
/// bands or 0.
///
/// # Errors
/// Returns an error if `bands` has another length. The analyser then keeps its state.
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
