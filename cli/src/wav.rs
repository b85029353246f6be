//! WAV files of 32-bit floats.

use std::fs::File;
use std::io::{BufWriter, Error};
use std::path::Path;

use hound::{SampleFormat, WavSpec, WavWriter};
use htex_format::Rights;

use crate::failure::{Failure, Result};
use crate::output::{OutputFile, shown, warn};

/// Maximum number of frames in a WAV file.
// Sizes in a RIFF file have 32 bits. 64 bytes are for the header. Licence and author are left out
// if they do not fit.
const MAX_FRAMES: u64 = (u32::MAX as u64 - 64) / 4;

/// Writes `frames` samples of one channel, and the rights of the textures that are played. `render`
/// produces the samples block by block. Warns if all samples are 0.
pub(crate) fn write_wav(
    wav: OutputFile<'_>,
    rate_hz: u32,
    frames: u64,
    rights: &Rights,
    mut render: impl FnMut(&mut [f32]) -> Result<()>,
) -> Result<()> {
    if frames > MAX_FRAMES {
        let hours = MAX_FRAMES as f64 / f64::from(rate_hz) / 3600.0;
        return Err(Failure::Other(format!(
            "{}: a WAV file holds at most 4 GiB, {hours:.1} h at this rate; take fewer seconds",
            shown(&wav.path())
        )));
    }
    let spec = WavSpec {
        channels: 1,
        sample_rate: rate_hz,
        bits_per_sample: 32,
        sample_format: SampleFormat::Float,
    };
    // `replace` passes on only errors of the system, so an error of the model is stored here.
    let mut failed = None;
    let mut is_silent = true;
    let path = wav.path();
    let written = wav.replace(|file: &mut File| {
        let mut wav = WavWriter::new(BufWriter::new(&mut *file), spec).map_err(Error::other)?;
        let mut block = [0.0f32; 4096];
        let mut left = frames;
        while left > 0 {
            let block = &mut block[..left.min(4096) as usize];
            if let Err(failure) = render(block) {
                failed = Some(failure);
                return Err(Error::other("rendering failed"));
            }
            is_silent &= block.iter().all(|sample| *sample == 0.0);
            for &sample in &*block {
                wav.write_sample(sample).map_err(Error::other)?;
            }
            left -= block.len() as u64;
        }
        wav.finalize().map_err(Error::other)?;
        rights.add_to_wav(file)
    });
    match (failed, written) {
        (Some(failure), _) => Err(failure),
        (None, Err(error)) => Err(error.into()),
        (None, Ok(())) => {
            warn(&Vec::from_iter(is_silent.then(|| silence(&path))));
            Ok(())
        }
    }
}

/// Returns the warning for a file whose samples are all 0.
pub(crate) fn silence(path: &Path) -> String {
    format!(
        "{}: all samples are 0: nothing is felt at this motion; `htex info` lists the speeds and the forces at which a texture plays",
        shown(path)
    )
}
