//! Streaming writers for the four file formats.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};

use hound::{SampleFormat, WavSpec, WavWriter};
use htex_device::Quantity;

use crate::file::encoding::{Encoding, code};
use crate::file::plan::{Form, Plan};

/// Number of bytes that are buffered before they are written.
const BUFFER: usize = 1 << 16;
/// Maximum number of bytes of samples in a WAV file. Sizes in a WAV file have 32 bits, and the
/// headers need some bytes.
const MAX_WAV_BYTES: u64 = u32::MAX as u64 - 128;

/// A writer of a file.
pub(crate) struct Sink {
    form: Form,
    encoding: Encoding,
    /// The factor of each channel of a WAV file. A channel contains each sample multiplied by its
    /// factor.
    factors: Vec<f32>,
    rate_hz: f64,
    frames: u64,
    out: Out,
}

enum Out {
    Wav(WavWriter<BufWriter<File>>),
    Plain(BufWriter<File>),
}

impl Sink {
    /// Creates the writer and writes the header.
    pub(crate) fn new(file: File, plan: &Plan, rate_hz: f64) -> io::Result<Self> {
        let mut file = BufWriter::with_capacity(BUFFER, file);
        let out = match plan.form {
            Form::Wav => {
                let spec = wav_spec(plan.encoding, plan.factors.len() as u16, rate_hz);
                Out::Wav(WavWriter::new(file, spec).map_err(wav_error)?)
            }
            Form::Csv => {
                writeln!(file, "t_s,{}", column(plan.quantity))?;
                Out::Plain(file)
            }
            Form::Npy => {
                file.write_all(&npy_header(plan.encoding, 0))?;
                Out::Plain(file)
            }
            Form::Raw => Out::Plain(file),
        };
        Ok(Self {
            form: plan.form,
            encoding: plan.encoding,
            factors: plan.factors.clone(),
            rate_hz,
            frames: 0,
            out,
        })
    }

    /// Writes samples that the caller has checked.
    pub(crate) fn write(&mut self, samples: &[f32]) -> io::Result<()> {
        let after = self.frames + samples.len() as u64;
        let (form, encoding, rate_hz) = (self.form, self.encoding, self.rate_hz);
        match &mut self.out {
            Out::Wav(wav) => {
                let channels = self.factors.len() as u64;
                check_wav_size(after * channels, encoding, rate_hz * channels as f64)?;
                write_wav(wav, encoding, samples, &self.factors).map_err(wav_error)?;
            }
            Out::Plain(out) if form == Form::Csv => {
                for (i, sample) in samples.iter().enumerate() {
                    // The time is computed anew for each row, so that rounding errors do not add
                    // up.
                    let t_s = (self.frames + i as u64) as f64 / rate_hz;
                    writeln!(out, "{t_s},{sample}")?;
                }
            }
            Out::Plain(out) => write_bytes(out, encoding, samples)?,
        }
        self.frames = after;
        Ok(())
    }

    /// Writes the buffered bytes, and completes the header.
    pub(crate) fn end(self) -> io::Result<()> {
        match self.out {
            Out::Wav(wav) => wav.finalize().map_err(wav_error),
            Out::Plain(mut out) => {
                if self.form == Form::Npy {
                    let header = npy_header(self.encoding, self.frames);
                    // `seek` writes the buffered samples first.
                    out.seek(SeekFrom::Start(0))?;
                    out.write_all(&header)?;
                }
                out.flush()
            }
        }
    }
}

fn wav_spec(encoding: Encoding, channels: u16, rate_hz: f64) -> WavSpec {
    WavSpec {
        channels,
        // `Plan::check_rate` has ensured that the rate is a whole number of at most a million.
        sample_rate: rate_hz as u32,
        bits_per_sample: 8 * encoding.bytes(),
        sample_format: match encoding {
            Encoding::F32 => SampleFormat::Float,
            Encoding::Integer { .. } => SampleFormat::Int,
        },
    }
}

fn write_wav(
    wav: &mut WavWriter<BufWriter<File>>,
    encoding: Encoding,
    samples: &[f32],
    factors: &[f32],
) -> hound::Result<()> {
    let frame = |sample: &f32| {
        let sample = *sample;
        factors.iter().map(move |factor| sample * factor)
    };
    let mut all = samples.iter().flat_map(frame);
    match encoding {
        Encoding::F32 => all.try_for_each(|sample| wav.write_sample(sample)),
        Encoding::Integer { step, .. } => {
            all.try_for_each(|sample| wav.write_sample(code(sample, step)))
        }
    }
}

/// Checks that a WAV file can hold this number of samples at `rate_hz`.
fn check_wav_size(samples: u64, encoding: Encoding, rate_hz: f64) -> io::Result<()> {
    let most = MAX_WAV_BYTES / u64::from(encoding.bytes());
    if samples <= most {
        return Ok(());
    }
    let hours = most as f64 / rate_hz / 3600.0;
    Err(io::Error::other(format!(
        "a WAV file holds at most 4 GiB, {hours:.1} h at this rate; write npy or raw"
    )))
}

/// Writes the samples one after the other, little-endian.
fn write_bytes(out: &mut impl Write, encoding: Encoding, samples: &[f32]) -> io::Result<()> {
    let mut all = samples.iter();
    match encoding {
        Encoding::F32 => all.try_for_each(|sample| out.write_all(&sample.to_le_bytes())),
        Encoding::Integer { step, .. } => {
            let bytes = usize::from(encoding.bytes());
            all.try_for_each(|&sample| out.write_all(&code(sample, step).to_le_bytes()[..bytes]))
        }
    }
}

/// Returns the header of an NPY file of `frames` samples. The header always has 128 bytes, which
/// are enough for any number of samples.
fn npy_header(encoding: Encoding, frames: u64) -> Vec<u8> {
    let kind = match encoding {
        Encoding::F32 => "f4",
        Encoding::Integer { .. } => "i2",
    };
    let dictionary =
        format!("{{'descr': '<{kind}', 'fortran_order': False, 'shape': ({frames}, ), }}");
    // NPY requires a multiple of 64 bytes: 10 bytes of magic, version and length, and 118 bytes
    // (0x76) of text make 128.
    let text = format!("{dictionary:<117}\n");
    [b"\x93NUMPY\x01\x00\x76\x00", text.as_bytes()].concat()
}

fn column(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::LateralForce => "lateral_force_n",
        Quantity::NormalForce => "normal_force_n",
        Quantity::Acceleration => "acceleration_m_s2",
        Quantity::Velocity => "velocity_m_s",
        Quantity::Displacement => "displacement_m",
        Quantity::DisplayVoltage => "display_voltage_v",
        Quantity::Sound => "sound",
    }
}

fn wav_error(error: hound::Error) -> io::Error {
    match error {
        hound::Error::IoError(error) => error,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn npy_headers_have_one_length() {
        for encoding in [Encoding::F32, Encoding::integer(16, 1.0)] {
            for frames in [0, 1, 1 << 40, u64::MAX] {
                assert_eq!(npy_header(encoding, frames).len(), 128);
            }
        }
    }

    #[test]
    fn a_wav_file_ends_before_four_gibibytes() {
        let i16 = Encoding::integer(16, 1.0);
        assert!(check_wav_size(2_147_483_583, i16, 1e4).is_ok());
        assert!(check_wav_size(2_147_483_584, i16, 1e4).is_err());
        assert!(check_wav_size(1 << 30, Encoding::F32, 1e4).is_err());
    }
}
