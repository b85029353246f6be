//! A playing texture.

use crate::block::{Block, Kind};
use crate::layout::MIN_SLIDING_MM_S;
use crate::noise::Noise;
use crate::tones::Tones;
use crate::upsampler::Upsampler;

/// The source at the internal rate.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant)] // There is no heap, and a player holds one of them.
enum Source {
    Noise(Noise),
    Tones(Tones),
}

impl Source {
    fn glide(&mut self) {
        match self {
            Self::Noise(noise) => noise.glide(),
            Self::Tones(tones) => tones.glide(),
        }
    }

    fn silence(&mut self) {
        match self {
            Self::Noise(noise) => noise.silence(),
            Self::Tones(tones) => tones.silence(),
        }
    }

    fn tick(&mut self) -> f32 {
        match self {
            Self::Noise(noise) => noise.tick(),
            Self::Tones(tones) => tones.tick(),
        }
    }
}

/// An endless stream of samples of a block, in the asset's unit. The samples do not depend on the lengths of the buffers.
///
/// ```no_run
/// use htex_player::{Block, Player};
/// # fn run(bytes: &[u8]) -> Result<(), htex_player::OpenError> {
/// let mut player = Player::new(Block::open(bytes)?, 7);
/// let mut buffer = [0.0; 64];
/// player.set_motion(80.0, 0.4);
/// player.render(&mut buffer);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Player<'a> {
    block: Block<'a>,
    source: Source,
    upsampler: Upsampler<'a>,
    up: usize,
    /// Phase of the next sample; 0 needs a new one of the source.
    phase: usize,
    /// Remaining steps of the current glide.
    gliding: u32,
    is_silent: bool,
    is_started: bool,
}

impl<'a> Player<'a> {
    /// Makes a player at the first condition. Players of different seeds have independent noise.
    pub fn new(block: Block<'a>, seed: u32) -> Self {
        let (up, row, rows) = block.upsampling();
        let source = match block.kind() {
            Kind::Noise { half } => Source::Noise(Noise::new(half, seed)),
            Kind::Tones {
                count,
                random_phase,
            } => Source::Tones(Tones::new(count, random_phase, seed)),
        };
        let mut player = Self {
            block,
            source,
            upsampler: Upsampler::new(rows, row),
            up,
            phase: 0,
            gliding: 0,
            is_silent: false,
            is_started: false,
        };
        let (speed, force) = block.first();
        player.retune(speed, force, false);
        player
    }

    /// Returns the block.
    pub fn block(&self) -> &Block<'a> {
        &self.block
    }

    /// Sets the motion: speed in mm/s, of either sign, and normal force in newtons. Spectrum and level glide to it; before
    /// the first sample they are set at once. A motion beyond the grid is clamped to it, and the player is silent while
    /// the finger does not slide (below 0.5 mm/s, or without force). Returns false, without a change, if a number is not
    /// finite.
    pub fn set_motion(&mut self, speed_mm_s: f32, force_n: f32) -> bool {
        if !(speed_mm_s.is_finite() && force_n.is_finite()) {
            return false;
        }
        let speed = speed_mm_s.abs();
        let is_silent = speed < MIN_SLIDING_MM_S || force_n <= 0.0;
        self.retune(speed, force_n, is_silent);
        true
    }

    fn retune(&mut self, speed: f32, force: f32, is_silent: bool) {
        let mut target = self.block.target(speed, force);
        if is_silent {
            target.level = 0.0;
        }
        let samples = match self.is_started {
            true => self.block.glide(),
            false => 0,
        };
        match &mut self.source {
            Source::Noise(noise) => noise.retune(&self.block, target, samples),
            Source::Tones(tones) => tones.retune(&self.block, target, samples),
        }
        (self.gliding, self.is_silent) = (samples, is_silent);
    }

    /// Fills `out` with the next samples.
    pub fn render(&mut self, out: &mut [f32]) {
        out.iter_mut().for_each(|x| *x = self.tick());
    }

    /// Fills `out` with the next samples as integers: `full_scale`, in the asset's unit, becomes 32767, and larger samples
    /// are limited. If `full_scale` is not above zero the integers are zero.
    pub fn render_i16(&mut self, out: &mut [i16], full_scale: f32) {
        let gain = match full_scale > 0.0 {
            true => 32_767.0 / full_scale,
            false => 0.0,
        };
        for x in out {
            let scaled = self.tick() * gain;
            // Conversions to integers truncate and saturate.
            *x = (scaled + if scaled < 0.0 { -0.5 } else { 0.5 }) as i16;
        }
    }

    fn tick(&mut self) -> f32 {
        self.is_started = true;
        if self.up == 1 {
            return self.next();
        }
        if self.phase == 0 {
            let input = self.next();
            self.upsampler.push(input);
        }
        let sample = self.upsampler.at(self.phase);
        self.phase += 1;
        if self.phase >= self.up {
            self.phase = 0;
        }
        sample
    }

    /// Returns the next sample of the source.
    fn next(&mut self) -> f32 {
        if self.gliding > 0 {
            self.source.glide();
            self.gliding -= 1;
            if self.gliding == 0 && self.is_silent {
                self.source.silence();
            }
        }
        self.source.tick()
    }
}

/// Most bytes of a player, and so of the memory of a voice.
const MOST_BYTES: usize = 16 * 1024;
const _: () = assert!(size_of::<Player<'_>>() <= MOST_BYTES);
