//! The player: renders the samples of a block.

use crate::block::{Block, BlockKind};
use crate::envelope::Envelope;
use crate::layout::{MIN_SLIDING_MM_S, MOST_FORCE_N, MOST_SPEED_MM_S};
use crate::noise::Noise;
use crate::tones::Tones;
use crate::upsampler::Upsampler;

/// The state of a player: the numbers that change while it plays a block.
#[derive(Debug, Clone)]
struct Memory {
    noise: Noise,
    tones: Tones,
    upsampler: Upsampler,
    envelope: Envelope,
    /// Phase of the next output sample. At phase 0 a new sample at the internal rate is needed.
    phase: usize,
    /// Number of steps left in the current glide.
    gliding: u32,
    /// Speed and force of the last motion that was not silent.
    last: (f32, f32),
    /// RMS at the current motion, in the asset's unit.
    level: f32,
    /// Number of samples until the hold of a motion ends.
    held: u32,
    /// Whether the last reading was not plausible, so that the motion is held.
    is_held: bool,
    is_silent: bool,
    is_started: bool,
}

impl Memory {
    const ZERO: Self = Self {
        noise: Noise::ZERO,
        tones: Tones::ZERO,
        upsampler: Upsampler::ZERO,
        envelope: Envelope::ZERO,
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

/// Renders a block as an endless stream of samples, in the asset's unit. The samples do not depend
/// on the lengths of the buffers.
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
    /// Makes a player that starts with the motion of the first condition. Players with different
    /// seeds have independent noise.
    pub fn new(block: Block<'a>, seed: u32) -> Self {
        let mut player = Self { block, memory: Memory::ZERO };
        player.start(seed);
        player
    }

    /// Starts to play. All numbers of the state must be zero before the call.
    fn start(&mut self, seed: u32) {
        match self.block.kind() {
            BlockKind::Noise { half, .. } => self.memory.noise.start(half, seed),
            BlockKind::Tones { count, random_phase } => {
                self.memory.tones.start(count, random_phase, seed)
            }
        }
        if let Some(fluctuation) = self.block.fluctuation() {
            self.memory.envelope.start(fluctuation, self.block.rate_hz(), seed);
        }
        self.sound(self.block.first());
    }

    pub fn block(&self) -> &Block<'a> {
        &self.block
    }

    /// Returns the RMS of the samples at the current motion, in the asset's unit. If the level is
    /// still changing, this is the level after the change. The RMS is 0 if the player is silent or
    /// is becoming silent.
    pub fn level(&self) -> f32 {
        self.memory.level
    }

    /// Sets the motion: speed in mm/s, of either sign, and normal force in newtons. Returns false,
    /// and keeps the previous motion, if a number is not finite.
    ///
    /// Spectrum and level change gradually to the new motion. Before the first sample, they change
    /// at once. Beyond the grid, the player starts from the nearest motion of the grid, and scales
    /// the level and the frequencies of sinusoids by the law of the block. While the finger does
    /// not slide (below 0.5 mm/s, or without force), the player is silent. A motion above 1000 mm/s
    /// or 20 N counts as a failed reading of a sensor. The player then holds the last plausible
    /// motion for 0.1 s. After that, it is silent until the next plausible motion.
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

    /// Holds the current motion. A hold that is already in progress is not prolonged.
    fn hold(&mut self) {
        if !self.memory.is_held {
            (self.memory.is_held, self.memory.held) = (true, self.block.hold());
        }
    }

    /// Changes to a motion at which the finger slides. Does nothing if the motion is unchanged.
    fn follow(&mut self, motion: (f32, f32)) {
        // A fade does not change `last`, so the same motion must be able to end a silence.
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

    /// Glides to silence, unless the player is silent already.
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

    /// Starts a glide, and returns its duration, samples at the internal rate.
    fn start_glide(&mut self, is_silent: bool) -> u32 {
        let samples = if self.memory.is_started { self.block.glide() } else { 0 };
        (self.memory.gliding, self.memory.is_silent) = (samples, is_silent);
        samples
    }

    /// Fills `out` with the next samples.
    pub fn render(&mut self, out: &mut [f32]) {
        out.iter_mut().for_each(|x| *x = self.tick());
    }

    /// Fills `out` with the next samples as integers. A sample of `full_scale` (in the asset's
    /// unit) becomes 32767, and larger samples are clipped. If `full_scale` is not above zero, all
    /// integers are zero.
    pub fn render_i16(&mut self, out: &mut [i16], full_scale: f32) {
        let gain = if full_scale > 0.0 { 32_767.0 / full_scale } else { 0.0 };
        for x in out {
            let scaled = self.tick() * gain;
            // Conversions to integers truncate and saturate, so adding 0.5 rounds.
            *x = (scaled + if scaled < 0.0 { -0.5 } else { 0.5 }) as i16;
        }
    }

    fn tick(&mut self) -> f32 {
        let sample = self.steady();
        match self.block.fluctuation() {
            Some(fluctuation) => sample * self.memory.envelope.factor(fluctuation),
            None => sample,
        }
    }

    /// Returns the next sample without the fluctuation.
    fn steady(&mut self) -> f32 {
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
        self.memory.upsampler.sample(row)
    }

    /// Counts down the samples of a held motion. After the last sample, the player fades to
    /// silence.
    fn count_held(&mut self) {
        if !self.memory.is_held {
            return;
        }
        match self.memory.held {
            // Called again for each later sample, but then the player is already silent.
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

/// Largest size of a player, and therefore of the memory of a voice, bytes.
const MOST_BYTES: usize = 16 * 1024;
const _: () = assert!(size_of::<Player<'_>>() <= MOST_BYTES);
