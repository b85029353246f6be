//! Plays an asset at a condition or along a stroke, or plays a scene, for an export. The result
//! consists of the samples, and of an envelope with one value for each block of samples.

use htex_author::threshold_magnitude;
use htex_dsp::envelope::Analyser;
use htex_dsp::grid::Band;
use htex_dsp::vibrotactile::Listener;
use htex_format::{Manifest, Quantity, Rights};
use htex_play::{Motion, Texture, VoiceOptions};

use crate::error::ExchangeError;
use crate::stroke::Stroke;

/// Number of bands in the envelope.
pub(crate) const BANDS: usize = 14;
/// Largest number of samples of an export on a 32-bit machine, such as a WASM module. The memory of
/// such a machine cannot hold more samples.
const MOST_SAMPLES: usize = 1 << 24;
/// Time that is played before the first exported sample, so that the analysis windows are full,
/// seconds.
const BEFORE_S: f64 = 0.2;

/// How the finger moves during an export.
#[derive(Debug, Clone)]
pub enum Path {
    /// At one constant speed and force. `None` stands for the asset's default condition.
    Condition(Option<Motion>),
    Stroke(Stroke),
}

/// The sound of a scene, in the unit of its textures.
pub struct SceneSound<'a> {
    /// The scene's name, which is stored in the exported file.
    pub name: &'a str,
    /// Licence and author that apply to all textures of the scene, and so to the exported file.
    pub rights: &'a Rights,
    pub quantity: Quantity,
    /// The frequency band of the scene's textures.
    pub band: Band,
    /// Length of the scene, seconds.
    pub seconds: f64,
    /// Returns the samples of the whole scene at a sample rate in hertz.
    pub samples: &'a dyn Fn(f64) -> Result<Vec<f32>, String>,
}

/// The source of what is played.
#[derive(Clone, Copy)]
pub(crate) enum Source<'a> {
    Asset { asset: &'a Texture, model: Option<&'a str>, path: &'a Path, seed: u64 },
    Scene(&'a SceneSound<'a>),
}

/// A source, and for how long it is played.
pub(crate) struct Playing<'a> {
    pub(crate) source: Source<'a>,
    pub(crate) seconds: f64,
}

/// The result of playing: samples and their envelope.
pub(crate) struct Heard {
    pub(crate) quantity: Quantity,
    pub(crate) rate_hz: f64,
    pub(crate) samples: Vec<f64>,
    pub(crate) edges_hz: Vec<f64>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) block_s: f64,
}

/// A block of the envelope, some milliseconds long. Its values are in the asset's unit.
pub(crate) struct Block {
    /// Mean square in each band. The sum is the mean square of the block's samples.
    pub(crate) powers: Vec<f64>,
}

impl Block {
    /// Returns the block with the powers of only these bands.
    pub(crate) fn only(&self, bands: &[usize]) -> Self {
        let mut powers = vec![0.0; self.powers.len()];
        for ((k, own), power) in powers.iter_mut().enumerate().zip(&self.powers) {
            *own = if bands.contains(&k) { *power } else { 0.0 };
        }
        Self { powers }
    }
}

impl Source<'_> {
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Asset { asset, .. } => &asset.manifest().name,
            Self::Scene(scene) => scene.name,
        }
    }

    /// Returns the licence and author of what is played. They are written into every file.
    pub(crate) fn rights(&self) -> Rights {
        match self {
            Self::Asset { asset, .. } => Rights::from_manifest(asset.manifest()),
            Self::Scene(scene) => scene.rights.clone(),
        }
    }

    pub(crate) fn band(&self) -> Band {
        match self {
            Self::Asset { asset, .. } => asset.band(),
            Self::Scene(scene) => scene.band,
        }
    }

    fn quantity(&self) -> Quantity {
        match self {
            Self::Asset { asset, .. } => asset.quantity(),
            Self::Scene(scene) => scene.quantity,
        }
    }

    /// Returns the manifest, if a single asset is played.
    pub(crate) fn manifest(&self) -> Option<&Manifest> {
        match self {
            Self::Asset { asset, .. } => Some(asset.manifest()),
            Self::Scene(_) => None,
        }
    }

    /// Returns the stroke, if the finger follows one.
    pub(crate) fn stroke(&self) -> Option<&Stroke> {
        match self {
            Self::Asset { path: Path::Stroke(stroke), .. } => Some(stroke),
            _ => None,
        }
    }

    /// Returns the speed of the finger, if it is constant and known.
    pub(crate) fn speed_mm_s(&self) -> Option<f64> {
        match self {
            Self::Asset { path: Path::Condition(Some(motion)), .. } => Some(motion.speed_mm_s),
            Self::Asset { asset, model, path: Path::Condition(None), .. } => {
                let default = asset.representation(*model).ok()?.default_condition();
                asset.manifest().conditions.get(default)?.speed_mm_s
            }
            _ => None,
        }
    }
}

impl Playing<'_> {
    /// Plays the source at a sample rate, and measures an envelope with blocks of about `block_s`
    /// seconds.
    pub(crate) fn heard(&self, rate_hz: f64, block_s: f64) -> Result<Heard, ExchangeError> {
        let (quantity, band) = (self.source.quantity(), self.source.band());
        let len = libm::round(self.seconds * rate_hz).max(1.0) as usize;
        if usize::BITS < 64 && len > MOST_SAMPLES {
            let range = "at this sample rate, so many samples do not fit into the memory";
            return Err(ExchangeError::OutOfRange { name: "seconds", value: self.seconds, range });
        }
        let mut analyser = Analyser::new(BANDS, band, rate_hz);
        let edges_hz = analyser.edges_hz().to_vec();
        let frames = (libm::round(block_s * rate_hz).max(1.0) as usize).min(len);
        let (before, samples) = self.samples(rate_hz, len, frames)?;
        analyser.push(&before);
        // The samples so far belong to no block. Reading the analyser discards their level.
        analyser.read(&mut []);
        let blocks = samples.chunks(frames).map(|block| {
            analyser.push(block);
            Block::measured(&mut analyser)
        });
        Ok(Heard {
            quantity,
            rate_hz,
            edges_hz,
            blocks: blocks.collect(),
            block_s: frames as f64 / rate_hz,
            samples: samples.into_iter().map(f64::from).collect(),
        })
    }

    /// Returns the samples that are played before the first exported sample, and the exported
    /// samples. Both are rendered in blocks.
    fn samples(
        &self,
        rate_hz: f64,
        len: usize,
        frames: usize,
    ) -> Result<(Vec<f32>, Vec<f32>), ExchangeError> {
        match self.source {
            Source::Scene(scene) => {
                let mut samples =
                    (scene.samples)(rate_hz).map_err(|problem| ExchangeError::Scene { problem })?;
                samples.resize(len, 0.0);
                Ok((Vec::new(), samples))
            }
            Source::Asset { asset, model, path, seed } => {
                let options = VoiceOptions::default()
                    .with_rate_hz(rate_hz)
                    .with_seed(seed)
                    .with_motion(path.motion_at(0.0));
                let mut voice = asset.representation(model)?.voice(&options)?;
                let mut before = vec![0.0; (BEFORE_S * rate_hz) as usize];
                voice.render(&mut before)?;
                let mut samples = vec![0.0; len];
                for (i, block) in samples.chunks_mut(frames).enumerate() {
                    if let Path::Stroke(stroke) = path {
                        voice.set_motion(stroke.motion_at((i * frames) as f64 / rate_hz))?;
                    }
                    voice.render(block)?;
                }
                Ok((before, samples))
            }
        }
    }
}

impl Path {
    /// Makes the path of a finger that moves at a constant speed (mm/s) and force (N). If one of
    /// the values is missing, it comes from the default condition of the representation with this
    /// model. If the default condition does not state the value either, the value comes from the
    /// study of Balasubramanian & Vardar 2026 (80 mm/s, 0.4 N). If both values are missing, the
    /// finger moves at the asset's default condition.
    ///
    /// # Errors
    /// Returns an error when the asset has no representation with this model.
    pub fn at(
        asset: &Texture,
        model: Option<&str>,
        speed_mm_s: Option<f64>,
        force_n: Option<f64>,
    ) -> Result<Self, ExchangeError> {
        if speed_mm_s.is_none() && force_n.is_none() {
            return Ok(Self::Condition(None));
        }
        let motion = asset.representation(model)?.motion(speed_mm_s, force_n);
        Ok(Self::Condition(Some(motion)))
    }

    fn motion_at(&self, time_s: f64) -> Option<Motion> {
        match self {
            Self::Condition(motion) => *motion,
            Self::Stroke(stroke) => Some(stroke.motion_at(time_s)),
        }
    }
}

impl Block {
    /// Returns what an analyser measured since the last call, as a block.
    fn measured(analyser: &mut Analyser) -> Self {
        let mut powers = vec![0.0; BANDS];
        let level_rms = analyser.read(&mut powers).level_rms;
        // The level is measured on the samples themselves, but the bands come from windows that lag
        // behind.
        let sum: f64 = powers.iter().sum();
        let scale = if sum > 0.0 { level_rms * level_rms / sum } else { 0.0 };
        powers.iter_mut().for_each(|power| *power *= scale);
        Self { powers }
    }
}

impl Heard {
    /// Returns the middle of each band in hertz: the geometric mean of its edges.
    pub(crate) fn middles_hz(&self) -> Vec<f64> {
        let pairs = self.edges_hz.windows(2);
        pairs.map(|pair| libm::sqrt(pair.iter().product())).collect()
    }

    /// Returns the time at the middle of a block, seconds.
    pub(crate) fn middle_s(&self, block: usize) -> f64 {
        ((block as f64 + 0.5) * self.block_s).min(self.seconds())
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.samples.len() as f64 / self.rate_hz
    }
}

/// Returns the acceleration, m/s², that feels like a quantity with the value 1 at a frequency. Both
/// displace the skin by the same amount.
pub(crate) fn acceleration_of(quantity: Quantity, hertz: f64) -> f64 {
    let listener = Listener::default();
    threshold_magnitude(hertz, Quantity::Acceleration, &listener)
        / threshold_magnitude(hertz, quantity, &listener)
}

/// Returns the smallest amplitude of a quantity that can be felt at a frequency.
pub(crate) fn threshold(quantity: Quantity, hertz: f64) -> f64 {
    threshold_magnitude(hertz, quantity, &Listener::default())
}
