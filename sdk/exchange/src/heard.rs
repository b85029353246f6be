//! What an asset plays at a condition or along a stroke: its samples, and its envelope block by block.

use htex_author::threshold_magnitude;
use htex_dsp::vibrotactile::Listener;
use htex_format::Quantity;
use htex_play::{Asset, Motion, Voice, VoiceOptions};

use crate::error::ExchangeError;
use crate::stroke::Stroke;

/// Bands of the envelope.
pub(crate) const BANDS: usize = 14;
/// What is played before the first sample, so that windows are full, seconds.
const BEFORE_S: f64 = 0.2;

/// Where a finger moves.
#[derive(Debug, Clone)]
pub enum Path {
    /// At one speed and force; `None` for those of the asset's first condition.
    Condition(Option<Motion>),
    Stroke(Stroke),
}

/// How an asset is played.
pub(crate) struct Playing<'a> {
    pub(crate) asset: &'a Asset,
    pub(crate) model: Option<&'a str>,
    pub(crate) path: &'a Path,
    pub(crate) seconds: f64,
    pub(crate) seed: u64,
}

/// What was played.
pub(crate) struct Heard {
    pub(crate) quantity: Quantity,
    pub(crate) rate_hz: f64,
    pub(crate) samples: Vec<f64>,
    pub(crate) edges_hz: Vec<f64>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) block_s: f64,
}

/// An envelope of some milliseconds, in the asset's unit.
pub(crate) struct Block {
    /// Mean square in each band; together that of the block's samples.
    pub(crate) powers: Vec<f64>,
}

impl Block {
    /// With the powers of these bands alone.
    pub(crate) fn only(&self, bands: &[usize]) -> Self {
        let mut powers = vec![0.0; self.powers.len()];
        for ((k, own), power) in powers.iter_mut().enumerate().zip(&self.powers) {
            *own = if bands.contains(&k) { *power } else { 0.0 };
        }
        Self { powers }
    }
}

impl Playing<'_> {
    /// Plays at a rate, with an envelope of blocks of about `block_s`.
    pub(crate) fn heard(&self, rate_hz: f64, block_s: f64) -> Result<Heard, ExchangeError> {
        let mut options = VoiceOptions::default()
            .with_rate_hz(rate_hz)
            .with_seed(self.seed)
            .with_motion(self.motion_at(0.0))
            .with_envelope_bands(BANDS);
        options.model = self.model;
        let mut voice = self.asset.voice(&options)?;
        voice.render(&mut vec![0.0; (BEFORE_S * rate_hz) as usize])?;
        voice.envelope(&mut [])?;
        let len = libm::round(self.seconds * rate_hz).max(1.0) as usize;
        let own = (libm::round(block_s * rate_hz).max(1.0) as usize).min(len);
        let mut heard = Heard {
            quantity: self.asset.quantity(),
            rate_hz,
            samples: Vec::with_capacity(len),
            edges_hz: voice.envelope_edges_hz().to_vec(),
            blocks: Vec::new(),
            block_s: own as f64 / rate_hz,
        };
        while heard.samples.len() < len {
            let frames = own.min(len - heard.samples.len());
            let block = self.block(&mut voice, &mut heard.samples, frames, rate_hz)?;
            heard.blocks.push(block);
        }
        Ok(heard)
    }

    fn motion_at(&self, time_s: f64) -> Option<Motion> {
        match self.path {
            Path::Condition(motion) => *motion,
            Path::Stroke(stroke) => Some(stroke.motion_at(time_s)),
        }
    }

    fn block(
        &self,
        voice: &mut Voice,
        samples: &mut Vec<f64>,
        frames: usize,
        rate_hz: f64,
    ) -> Result<Block, ExchangeError> {
        if let Path::Stroke(_) = self.path
            && let Some(motion) = self.motion_at(samples.len() as f64 / rate_hz)
        {
            voice.set_motion(motion)?;
        }
        let mut block = vec![0.0f32; frames];
        voice.render(&mut block)?;
        samples.extend(block.iter().map(|x| f64::from(*x)));
        let mut powers = vec![0.0; BANDS];
        let envelope = voice.envelope(&mut powers)?;
        // The level is that of the samples; the bands are of windows that lag.
        let sum: f64 = powers.iter().sum();
        let scale = if sum > 0.0 {
            envelope.level_rms * envelope.level_rms / sum
        } else {
            0.0
        };
        powers.iter_mut().for_each(|power| *power *= scale);
        Ok(Block { powers })
    }
}

impl Heard {
    /// Returns the middle of each band, hertz, in equal ratios from its edges.
    pub(crate) fn middles_hz(&self) -> Vec<f64> {
        let pairs = self.edges_hz.windows(2);
        pairs
            .map(|pair| libm::sqrt(pair.iter().product()))
            .collect()
    }

    /// Returns the time of the middle of a block, seconds.
    pub(crate) fn middle_s(&self, block: usize) -> f64 {
        ((block as f64 + 0.5) * self.block_s).min(self.seconds())
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.samples.len() as f64 / self.rate_hz
    }
}

/// Acceleration, m/s², that is felt as a sample of 1 of a quantity is, at a frequency: both displace the skin equally.
pub(crate) fn acceleration_of(quantity: Quantity, hertz: f64) -> f64 {
    let listener = Listener::default();
    threshold_magnitude(hertz, Quantity::Acceleration, &listener)
        / threshold_magnitude(hertz, quantity, &listener)
}

/// Smallest amplitude of a quantity that is felt at a frequency.
pub(crate) fn threshold(quantity: Quantity, hertz: f64) -> f64 {
    threshold_magnitude(hertz, quantity, &Listener::default())
}
