//! A playing texture.

use crate::block::{Block, BlockKind};
use crate::layout::{MIN_SLIDING_MM_S, MOST_FORCE_N, MOST_SPEED_MM_S};
use crate::noise::Noise;
use crate::tones::Tones;
use crate::upsampler::Upsampler;

/// Numbers that change while a block is played.
#[derive(Debug, Clone)]
struct Memory {
    noise: Noise,
    tones: Tones,
    upsampler: Upsampler,
    /// Phase of the next sample; 0 needs a new one of the internal rate.
    phase: usize,
    /// Remaining steps of the current glide.
    gliding: u32,
    /// Speed and force of the last motion that sounded.
    last: (f32, f32),
    /// RMS at the motion that was set, in the asset's unit.
    level: f32,
    /// Samples until a held motion ends.
    held: u32,
    /// Whether the last reading was none of a finger.
    is_held: bool,
    is_silent: bool,
    is_started: bool,
}

impl Memory {
    const ZERO: Self = Self {
        noise: Noise::ZERO,
        tones: Tones::ZERO,
        upsampler: Upsampler::ZERO,
        phase: 0,
        gliding: 0,
        last: (0.0, 0.0),
        level: 0.0,
        held: 0,
        is_held: false,
        is_silent: false,
        is_started: false,
    };
}

/// An endless stream of samples of a block, in the asset's unit. The samples do not depend on the
/// lengths of the buffers.
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
    memory: Memory,
}

impl<'a> Player<'a> {
    /// Makes a player at the first condition. Players of different seeds have independent noise.
    pub fn new(block: Block<'a>, seed: u32) -> Self {
        let mut player = Self { block, memory: Memory::ZERO };
        player.start(seed);
        player
    }

    /// Starts to play; all numbers of the memory are zero before.
    fn start(&mut self, seed: u32) {
        match self.block.kind() {
            BlockKind::Noise { half, .. } => self.memory.noise.start(half, seed),
            BlockKind::Tones { count, random_phase } => {
                self.memory.tones.start(count, random_phase, seed)
            }
        }
        self.sound(self.block.first());
    }

    pub fn block(&self) -> &Block<'a> {
        &self.block
    }

    /// Returns the RMS of the samples at the motion that was set, once they have glided to it, in
    /// the asset's unit; 0 if the player is silent or becomes so.
    pub fn level(&self) -> f32 {
        self.memory.level
    }

    /// Sets the motion: speed in mm/s, of either sign, and normal force in newtons. Spectrum and
    /// level glide to it; before the first sample they are set at once. Beyond the grid the level
    /// follows the law of the block from the nearest motion of the grid, and so do the frequencies
    /// of sinusoids. The player is silent while the finger does not slide (below 0.5 mm/s, or
    /// without force). A reading above 1000 mm/s or 20 N is none of a finger: the last motion is
    /// held for 0.1 s, then the player is silent until the next good one. Returns false, without a
    /// change, if a number is not finite.
    pub fn set_motion(&mut self, speed_mm_s: f32, force_n: f32) -> bool {
        if !(speed_mm_s.is_finite() && force_n.is_finite()) {
            return false;
        }
        let speed = speed_mm_s.abs();
        if speed > MOST_SPEED_MM_S || force_n > MOST_FORCE_N {
            self.hold();
            return true;
        }
        self.memory.is_held = false;
        if speed < MIN_SLIDING_MM_S || force_n <= 0.0 {
            self.fade()
        } else {
            self.follow((speed, force_n))
        }
        true
    }

    /// Holds the motion; a hold that goes on is not prolonged.
    fn hold(&mut self) {
        if !self.memory.is_held {
            (self.memory.is_held, self.memory.held) = (true, self.block.hold());
        }
    }

    /// Follows a motion that sounds; that of before changes nothing.
    fn follow(&mut self, motion: (f32, f32)) {
        if self.memory.is_silent || self.memory.last != motion {
            self.sound(motion);
        }
    }

    fn sound(&mut self, motion: (f32, f32)) {
        let target = self.block.target(motion);
        let samples = self.start_glide(false);
        self.memory.last = motion;
        let Memory { noise, tones, .. } = &mut self.memory;
        self.memory.level = match self.block.kind() {
            BlockKind::Noise { .. } => noise.retune(&self.block, target, samples),
            BlockKind::Tones { .. } => tones.retune(&self.block, target, samples),
        };
    }

    /// Glides to silence, unless the player is silent.
    fn fade(&mut self) {
        if self.memory.is_silent {
            return;
        }
        let samples = self.start_glide(true);
        self.memory.level = 0.0;
        let Memory { noise, tones, .. } = &mut self.memory;
        match self.block.kind() {
            BlockKind::Noise { .. } => noise.fade(samples),
            BlockKind::Tones { .. } => tones.fade(samples),
        }
    }

    /// Returns the length of a glide that starts, samples at the internal rate.
    fn start_glide(&mut self, is_silent: bool) -> u32 {
        let samples = if self.memory.is_started { self.block.glide() } else { 0 };
        (self.memory.gliding, self.memory.is_silent) = (samples, is_silent);
        samples
    }

    /// Fills `out` with the next samples.
    pub fn render(&mut self, out: &mut [f32]) {
        out.iter_mut().for_each(|x| *x = self.tick());
    }

    /// Fills `out` with the next samples as integers: `full_scale`, in the asset's unit, becomes
    /// 32767, and larger samples are limited. If `full_scale` is not above zero the integers are
    /// zero.
    pub fn render_i16(&mut self, out: &mut [i16], full_scale: f32) {
        let gain = if full_scale > 0.0 { 32_767.0 / full_scale } else { 0.0 };
        for x in out {
            let scaled = self.tick() * gain;
            // Conversions to integers truncate and saturate.
            *x = (scaled + if scaled < 0.0 { -0.5 } else { 0.5 }) as i16;
        }
    }

    fn tick(&mut self) -> f32 {
        self.memory.is_started = true;
        self.count_held();
        if self.block.up() == 1 {
            return self.next();
        }
        let phase = self.memory.phase;
        let row = self.block.row(phase);
        if phase == 0 {
            let input = self.next();
            self.memory.upsampler.push(input, row.len());
        }
        self.memory.phase = if phase + 1 < self.block.up() { phase + 1 } else { 0 };
        self.memory.upsampler.at(row)
    }

    /// Counts a sample of a held motion; after the last one the player becomes silent.
    fn count_held(&mut self) {
        if !self.memory.is_held {
            return;
        }
        match self.memory.held {
            0 => self.fade(),
            _ => self.memory.held -= 1,
        }
    }

    /// Returns the next sample at the internal rate.
    fn next(&mut self) -> f32 {
        let memory = &mut self.memory;
        let is_last = memory.gliding == 1;
        let is_gliding = memory.gliding > 0;
        memory.gliding = memory.gliding.saturating_sub(1);
        let becomes_silent = is_last && memory.is_silent;
        match self.block.kind() {
            BlockKind::Noise { .. } => memory.noise.next(is_gliding, becomes_silent),
            BlockKind::Tones { .. } => memory.tones.next(is_gliding, becomes_silent),
        }
    }
}

/// Most bytes of a player, and so of the memory of a voice.
const MOST_BYTES: usize = 16 * 1024;
const _: () = assert!(size_of::<Player<'_>>() <= MOST_BYTES);
