//! The calls of the model ABI on an instance of a module. Each call copies the arguments into the
//! instance's buffer, and copies the results out of this buffer.

use htex_model::{Band, FitInput, Motion};

use super::fault::Fault;
use super::instance::{Deadline, Instance};

/// Longest last-error text that is read, bytes.
const LONGEST_ERROR: usize = 4096;
/// Longest block that one call renders, samples. Longer blocks are rendered in parts.
pub(super) const BLOCK: usize = 8192;

impl Instance {
    pub(super) fn abi_version(&mut self) -> Result<u32, Fault> {
        self.call(Deadline::Call, |f| &f.abi_version, ())
    }

    pub(super) fn descriptor(&mut self, out: &mut [u8]) -> Result<i64, Fault> {
        // An empty buffer would be at address 0, which a module may refuse as null.
        let at = self.buffer(out.len().max(8))?;
        let behind = at + out.len() as u32;
        self.guard(behind)?;
        let len = self.call(Deadline::Call, |f| &f.descriptor, (at, out.len() as u32))?;
        self.unharmed(behind, "capacity", out.len())?;
        self.read(at, out)?;
        Ok(len)
    }

    pub(super) fn last_error(&mut self) -> Result<String, Fault> {
        let at = self.buffer(LONGEST_ERROR)?;
        let buffer = (at, LONGEST_ERROR as u32);
        self.guard(at + buffer.1)?;
        let len = self.call(Deadline::Call, |f| &f.last_error, buffer)?;
        self.unharmed(at + buffer.1, "capacity", LONGEST_ERROR)?;
        let mut text = vec![0; usize::try_from(len).unwrap_or(0).min(LONGEST_ERROR)];
        self.read(at, &mut text)?;
        Ok(String::from_utf8_lossy(&text).into_owned())
    }

    pub(super) fn fit(
        &mut self,
        input: &FitInput<'_>,
        parameters: &mut [f64],
        level_rms: &mut f64,
    ) -> Result<i64, Fault> {
        let bins = input.frequency_hz.len().min(input.magnitude.len());
        let numbers = 2 * bins + input.signal.len() + input.options.len() + parameters.len() + 1;
        // All arrays consist of f64, so each array that follows another one is aligned.
        let frequency = self.buffer(numbers * 8)?;
        let magnitude = self.write(frequency, &input.frequency_hz[..bins])?;
        let signal = self.write(magnitude, &input.magnitude[..bins])?;
        let options = self.write(signal, input.signal)?;
        let level = self.write(options, input.options)?;
        // The initial level is NaN, so that `LoadedModel::fit` notices if the module does not write
        // a level.
        let out = self.write(level, &[f64::NAN])?;
        let behind = out + (parameters.len() * 8) as u32;
        self.guard(behind)?;
        let (low, high) = input.band.edges();
        let (signals, knobs) = (input.signal.len() as u32, input.options.len() as u32);
        let (rate_hz, capacity) = (input.signal_rate_hz, parameters.len() as u32);
        let bins = bins as u32;
        let returned = if self.follows_motion() {
            let (speed, force) = input.condition.numbers();
            self.call_if(
                Deadline::Call,
                |f| Some(&f.motion.as_ref()?.fit),
                (
                    low, high, frequency, magnitude, bins, signal, signals, rate_hz, options,
                    knobs, speed, force, out, capacity, level,
                ),
            )?
        } else {
            self.call(
                Deadline::Call,
                |f| &f.fit,
                (
                    low, high, frequency, magnitude, bins, signal, signals, rate_hz, options,
                    knobs, out, capacity, level,
                ),
            )?
        };
        self.unharmed(behind, "capacity", parameters.len())?;
        self.read(level, std::slice::from_mut(level_rms))?;
        self.read(out, parameters)?;
        Ok(returned)
    }

    pub(super) fn magnitude(
        &mut self,
        parameters: &[f64],
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<i64, Fault> {
        let bins = frequency_hz.len().min(magnitude.len());
        let at = self.buffer((parameters.len() + 2 * bins) * 8)?;
        let frequency = self.write(at, parameters)?;
        let out = self.write(frequency, &frequency_hz[..bins])?;
        let after = out + (bins * 8) as u32;
        self.guard(after)?;
        let (low, high) = band.edges();
        let returned = self.call(
            Deadline::Call,
            |f| &f.magnitude,
            (at, parameters.len() as u32, low, high, frequency, out, bins as u32),
        )?;
        self.unharmed(after, "bins", bins)?;
        self.read(out, &mut magnitude[..bins])?;
        Ok(returned)
    }

    pub(super) fn interpolate(
        &mut self,
        sets: &[f64],
        weights: &[f64],
        parameters: &mut [f64],
    ) -> Result<i64, Fault> {
        let at = self.buffer((sets.len() + weights.len() + parameters.len()) * 8)?;
        let behind = self.write(at, sets)?;
        let out = self.write(behind, weights)?;
        let after = out + (parameters.len() * 8) as u32;
        self.guard(after)?;
        let (sets, weights) = ((at, sets.len() as u32), (behind, weights.len() as u32));
        let returned = self.call(
            Deadline::Call,
            |f| &f.interpolate,
            (sets.0, sets.1, weights.0, weights.1, out, parameters.len() as u32),
        )?;
        self.unharmed(after, "capacity", parameters.len())?;
        self.read(out, parameters)?;
        Ok(returned)
    }

    pub(super) fn voice_rate(
        &mut self,
        parameters: &[f64],
        band: Band,
        wanted_hz: f64,
    ) -> Result<f64, Fault> {
        let (at, len) = self.pass(parameters)?;
        let (low, high) = band.edges();
        self.call(Deadline::Call, |f| &f.voice_rate, (at, len, low, high, wanted_hz))
    }

    pub(super) fn voice_new(
        &mut self,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<i64, Fault> {
        // Allocated once for the voice. The buffer is enlarged only if the voice is retuned to a
        // parameter set that is longer than a block.
        self.buffer(4 * BLOCK)?;
        let (at, len) = self.pass(parameters)?;
        let (low, high) = band.edges();
        self.call(Deadline::Call, |f| &f.voice_new, (at, len, low, high, rate_hz, seed))
    }

    /// Renders at most [`BLOCK`] samples.
    pub(super) fn voice_render(&mut self, voice: i64, out: &mut [f32]) -> Result<i64, Fault> {
        let at = self.buffer(4 * BLOCK)?;
        let block = (voice, at, out.len() as u32);
        let behind = at + 4 * block.2;
        self.guard(behind)?;
        let returned = self.call(Deadline::Render, |f| &f.voice_render, block)?;
        self.unharmed(behind, "frames", out.len())?;
        self.read(at, out)?;
        Ok(returned)
    }

    pub(super) fn voice_retune(&mut self, voice: i64, parameters: &[f64]) -> Result<i64, Fault> {
        let (at, len) = self.pass(parameters)?;
        self.call(Deadline::Render, |f| &f.voice_retune, (voice, at, len))
    }

    pub(super) fn motion_set(&mut self, voice: i64, motion: Motion) -> Result<i64, Fault> {
        if !self.follows_motion() {
            return Ok(0);
        }
        let Motion { speed_mm_s, force_n, position_mm, x_mm, y_mm } = motion;
        self.call_if(
            Deadline::Render,
            |f| Some(&f.motion.as_ref()?.set),
            (voice, speed_mm_s, force_n, position_mm, x_mm, y_mm),
        )
    }

    pub(super) fn voice_free(&mut self, voice: i64) -> Result<i64, Fault> {
        self.call(Deadline::Call, |f| &f.voice_free, voice)
    }

    pub(super) fn extension(&mut self, id: &[u8]) -> Result<i64, Fault> {
        let at = self.buffer(id.len())?;
        self.write_text(at, id)?;
        self.call(Deadline::Call, |f| &f.extension, (at, id.len() as u32))
    }

    fn pass(&mut self, numbers: &[f64]) -> Result<(u32, u32), Fault> {
        let at = self.buffer(numbers.len() * 8)?;
        self.write(at, numbers)?;
        Ok((at, numbers.len() as u32))
    }
}
