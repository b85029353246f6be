//! Random-phase noise with a given spectrum, streamed by overlap-add.
//!
//! Each frame is an inverse FFT with uniformly random phases. Neighbouring frames overlap by an
//! eighth: one fades out while the next fades in. Frames are independent and the squares of the two
//! fade weights add up to 1, so the power is the same at every sample. The components of a frame
//! repeat only after the length of the frame, so no part of a frame repeats an earlier part (see
//! random phase in the numeric definitions of the specification).
//!
//! When the spectrum changes (a retune), the current frame is computed again with the same phases
//! and the new spectrum. Over 10 ms, the output cross-fades to the new frame. Parameters that
//! arrive during a cross-fade wait until the cross-fade ends. At that time, only the most recent
//! parameters are converted to a spectrum. In this way a retune computes one frame instead of two.
//! Frames have single precision, like the output.

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::grid::{Band, GRID_HZ, ReadPart};
use crate::inverse_fft::{InverseRealFft, Workspace, smooth_length};
use crate::shared::Shared;
use crate::uniform::Uniform;

/// Minimum length of half a frame, seconds: components are at most 2.5 Hz apart.
const HALF_S: f64 = 0.2;
/// Length of a frame's overlap, as a divisor of its length: neighbouring frames overlap by an
/// eighth.
const OVERLAP: usize = 8;
/// Duration of the cross-fade after a retune, seconds.
const FADE_S: f64 = 0.010;

/// Sample rate below which the noise ends at the same frequencies as at 2 kHz, hertz.
const LOW_RATE_HZ: f64 = 2_400.0;

/// An endless stream of noise whose spectrum follows a magnitude curve.
///
/// The noise has unit RMS, as measured in the bins of the band. At the edges of the band, these
/// bins miss some of the power (1/6 of the power of an edge bin). So all components are amplified
/// to compensate for this loss.
pub struct ShapedNoise {
    frames: Arc<Frames>,
    /// Half the amplitude of each component, because the inverse FFT doubles it.
    amplitude: Vec<f32>,
    pending: Pending,
    pending_amplitude: Vec<f64>,
    // Three states of the generator. They are the states before it drew the phases of three frames:
    // the frame that ends in this hop, the frame that begins in this hop, and the next frame. From
    // these states a retune draws the phases of the first two frames again.
    ending: Uniform,
    beginning: Uniform,
    next: Uniform,
    /// State of the generator after the phases of the next frame, if `faded` contains the next hop.
    prepared: Option<Uniform>,
    /// Position in the hop at which the next hop is computed. The position depends on the seed.
    /// Otherwise all streams that start at the same time would compute a frame in the same block.
    prepare_at: usize,
    /// Whether the spectrum has changed in this hop. If so, the stream does not prepare the next
    /// hop, because the spectrum may change again, which would make the prepared hop useless.
    changes: bool,
    /// Cosines and sines of the phases that were drawn last.
    cos: Vec<f32>,
    sin: Vec<f32>,
    workspace: Workspace,
    /// The current hop: the frame that began last, mixed with the end of the previous frame. After
    /// the hop comes the part of the frame that overlaps the next frame.
    now: Vec<f32>,
    /// During a cross-fade, the current hop with the new amplitudes. Otherwise possibly the next
    /// hop (see `prepared`).
    faded: Vec<f32>,
    tail: Vec<f32>,
    position: usize,
    fade_position: Option<usize>,
}

/// Identifies a sample rate and a band. The three numbers are the bits of the rate and of the
/// band's two edges.
pub type ComponentsKey = [u64; 3];

/// Data that all streams with the same rate and band share.
struct Frames {
    key: ComponentsKey,
    inverse: InverseRealFft,
    /// Fade-in weights of a frame. In reverse order they fade out the frame before it.
    rise: Vec<f32>,
    /// Length of a frame, samples.
    len: usize,
    /// Distance between the starts of two frames, samples.
    hop: usize,
    fade_len: usize,
    first: usize,
    component_hz: Vec<f64>,
    /// Amplitudes of the first and of the last component, relative to the curve. A part of the
    /// component's interval lies between the edges of the noise. The amplitude is the square root
    /// of this part.
    edges: [f64; 2],
    /// Part of each component's power that the bins of the band measure.
    read: Vec<f64>,
}

/// Whether a change of the spectrum is waiting.
#[derive(Clone, Copy, PartialEq)]
enum Pending {
    None,
    /// The amplitudes are in `pending_amplitude`.
    Made,
    /// The amplitudes will be computed when the change can begin.
    Wanted,
}

/// Returns the rate in hertz at which a voice of [`ShapedNoise`] should render if the host wants
/// `wanted_hz`. The result is `wanted_hz` divided by an integer. It is the lowest such rate whose
/// half lies far enough above the band to leave room for a wide transition band in the
/// interpolation to `wanted_hz`.
pub fn economical_rate_hz(wanted_hz: f64, band: Band) -> f64 {
    // The first image then begins at 2.7 times the upper edge, so a single short filter separates
    // it (see `specs` in `resample.rs`).
    let parts = libm::floor(wanted_hz / (3.7 * band.high_hz)).max(1.0);
    wanted_hz / parts
}

/// Returns the part of a component's power that the band's bins measure. A component is not a line
/// but spreads over neighbouring frequencies, because frames are finite. This function approximates
/// this spread by the spread of a rectangular window with the length of a hop.
fn frame_read_part(part: &ReadPart, hz: f64, spacing_hz: f64) -> f64 {
    // If the part is 1 at both ends of the spread, it is also 1 in between. In this case the sum
    // below would be exactly 1. Most components take this shortcut.
    if part.part_at(hz - FRAME_SPREAD * spacing_hz) == 1.0
        && part.part_at(hz + FRAME_SPREAD * spacing_hz) == 1.0
    {
        return 1.0;
    }
    // The spacing belongs to a frame. The hop is shorter than the frame by one part in `OVERLAP`,
    // so the spread of the hop is wider.
    let lobe_hz = spacing_hz * OVERLAP as f64 / (OVERLAP - 1) as f64;
    let steps = (FRAME_SPREAD * FRAME_STEPS) as i64;
    let (mut read, mut all) = (0.0, 0.0);
    for step in -steps..=steps {
        let offset_hz = step as f64 / FRAME_STEPS * spacing_hz;
        let x = core::f64::consts::PI * offset_hz / lobe_hz;
        let amplitude = if step == 0 { 1.0 } else { crate::trig::sin(x) / x };
        let weight = amplitude * amplitude;
        read += weight * part.part_at(hz + offset_hz);
        all += weight;
    }
    read / all
}

/// A component spreads over this number of component spacings on either side. The second number
/// says at how many points per spacing the spread is evaluated.
const FRAME_SPREAD: f64 = 4.0;
const FRAME_STEPS: f64 = 2.0;

/// Fade-in weight at sample `n` of `overlap`: `sin(π/2 sin²)`. The squares of the weight and of its
/// mirror image add up to 1. Unlike a sine it is smooth at both ends, which keeps the noise floor
/// of steep spectra low.
fn rise(n: usize, overlap: usize) -> f64 {
    let quarter = core::f64::consts::FRAC_PI_2;
    // Half a sample of offset makes the weights at `n` and at its mirror image complementary, so
    // that their squares add up to 1 at every sample.
    let sine = crate::trig::sin(quarter * (n as f64 + 0.5) / overlap as f64);
    crate::trig::sin(quarter * sine * sine)
}

/// [`ShapedNoise::prepare_at`] for a seed. Multiples of the golden ratio spread consecutive seeds
/// evenly over the hop.
fn prepare_at(seed: u64, hop: usize) -> usize {
    // The function uses the upper bits of the product, because its lower bits depend only on the
    // lower bits of the seed.
    let part = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
    ((part * hop as u64) >> 32) as usize
}

impl Frames {
    /// Returns the shared data of a rate and a band.
    fn shared(rate_hz: f64, band: Band) -> Arc<Self> {
        static FRAMES: Shared<ComponentsKey, Frames> = Shared::new();
        let key = [rate_hz, band.low_hz, band.high_hz].map(f64::to_bits);
        FRAMES.get(key, || Arc::new(Self::new(key, rate_hz, band)))
    }

    fn new(key: ComponentsKey, rate_hz: f64, band: Band) -> Self {
        let half = smooth_length(libm::round(rate_hz * HALF_S).max(2.0) as usize);
        let len = 2 * half;
        let overlap = len.div_ceil(OVERLAP);
        let hop = len - overlap;
        let spacing = rate_hz / len as f64;
        // Each bin of the texture spectrum represents half a bin on either side, and each component
        // represents half a spacing on either side. A component at an edge of the noise gets only
        // the power of the part of its interval inside the edge. If the edges depended on the rate,
        // a steep spectrum would have another level at each rate. Therefore, the edges are computed
        // for components at the usual spacing. At higher rates the edges still depend on the rate,
        // so that files play the same samples as in earlier versions. If rounding has moved a
        // component just beyond the edge, the tolerance of 1e-9 keeps the component.
        let usual = if rate_hz < LOW_RATE_HZ { 0.5 / HALF_S } else { spacing };
        let low = libm::ceil((band.low_hz - 0.5 * GRID_HZ) / usual - 1e-9).max(1.0);
        let high = libm::floor((band.high_hz + 0.5 * GRID_HZ) / usual + 1e-9).max(low);
        let [low_hz, high_hz] = [(low - 0.5) * usual, (high + 0.5) * usual];
        let low = (libm::floor(low_hz / spacing + 0.5 + 1e-9) as usize).max(1);
        let high = libm::ceil(high_hz / spacing - 0.5 - 1e-9) as usize;
        // The inverse FFT has no bin at the Nyquist frequency.
        let high = high.min(half - 1).max(low);
        let inside = |j: usize| {
            let [begin, end] = [j as f64 - 0.5, j as f64 + 0.5].map(|j| j * spacing);
            let part = (end.min(high_hz) - begin.max(low_hz)) / spacing;
            if part > 1.0 - 1e-9 { 1.0 } else { crate::root::sqrt(part.max(0.0)) }
        };
        let part = ReadPart::new(band);
        let components = || (low..=high).map(|j| j as f64 * spacing);
        Self {
            key,
            inverse: InverseRealFft::new(half),
            rise: (0..overlap).map(|n| rise(n, overlap) as f32).collect(),
            len,
            hop,
            // If a fade were longer than a hop, it would never begin (`begin_fade`).
            fade_len: libm::ceil(FADE_S * rate_hz).max(1.0).min(hop as f64) as usize,
            first: low,
            edges: [low, high].map(inside),
            // Components outside the band have the magnitude of the edge.
            component_hz: components().map(|hz| hz.clamp(band.low_hz, band.high_hz)).collect(),
            read: components().map(|hz| frame_read_part(&part, hz, spacing)).collect(),
        }
    }
}

impl ShapedNoise {
    /// Makes a stream with this seed at `rate_hz`, which is clamped to 20 Hz to 10 MHz. The stream
    /// is silent until [`Self::start`] is called.
    pub fn new(rate_hz: f64, band: Band, seed: u64) -> Self {
        let frames = Frames::shared(rate_hz.clamp(20.0, 1e7), band);
        let components = frames.component_hz.len();
        let zeros = |n| alloc::vec![0.0; n];
        let mut noise = Self {
            amplitude: zeros(components),
            pending: Pending::None,
            pending_amplitude: alloc::vec![0.0; components],
            ending: Uniform::new(seed),
            beginning: Uniform::new(seed),
            next: Uniform::new(seed),
            prepared: None,
            prepare_at: prepare_at(seed, frames.hop),
            changes: false,
            cos: zeros(components),
            sin: zeros(components),
            workspace: frames.inverse.workspace(),
            now: zeros(frames.len),
            faded: zeros(frames.len),
            tail: zeros(frames.rise.len()),
            position: 0,
            fade_position: None,
            frames,
        };
        // Draws two frames, because the first hop contains the end of one frame and the beginning
        // of the other.
        noise.draw_next();
        noise.draw_next();
        noise
    }

    /// Frequencies of the components, hertz, ascending.
    pub fn component_hz(&self) -> &[f64] {
        &self.frames.component_hz
    }

    /// Returns a key for looking up tables that have one value for each component. Streams with
    /// equal keys have the same [`Self::component_hz`].
    pub fn components_key(&self) -> ComponentsKey {
        self.frames.key
    }

    /// Sets the spectrum before the first sample. `magnitude(i, f)` returns the magnitude at `f`,
    /// which is `component_hz()[i]`, in any scale. Negative and non-finite values count as zero.
    pub fn start(&mut self, magnitude: impl Fn(usize, f64) -> f64) {
        self.fill(magnitude);
        self.normalise();
        self.take_pending();
        self.remake_hop();
        core::mem::swap(&mut self.now, &mut self.faded);
    }

    /// Cross-fades to another spectrum over the next 10 ms. Does not allocate.
    pub fn retune(&mut self, magnitude: impl Fn(usize, f64) -> f64) {
        self.fill(magnitude);
        self.normalise();
        self.pending = Pending::Made;
    }

    /// Cross-fades to another spectrum, which is computed only when it is needed.
    ///
    /// If no change is in progress, the spectrum is computed at once. Otherwise
    /// [`Self::render_with`] computes the spectrum at the end of the change in progress. If several
    /// changes were requested by then, only the last request counts. `make` receives
    /// [`Self::component_hz`] and writes the magnitude at each frequency, in any scale. Negative
    /// and non-finite values count as zero. Does not allocate.
    ///
    /// Returns false if the spectrum was computed at once and all magnitudes are zero. The stream
    /// then continues unchanged.
    pub fn retune_with(&mut self, make: impl FnOnce(&[f64], &mut [f64])) -> bool {
        if self.fade_position.is_some() {
            self.pending = Pending::Wanted;
            return true;
        }
        let made = self.make_pending(make);
        self.pending = if made { Pending::Made } else { Pending::None };
        made
    }

    /// Computes magnitudes from a curve.
    fn fill(&mut self, magnitude: impl Fn(usize, f64) -> f64) {
        let places = self.frames.component_hz.iter().enumerate();
        for ((i, &hz), m) in places.zip(&mut self.pending_amplitude) {
            *m = magnitude(i, hz);
        }
    }

    fn make_pending(&mut self, make: impl FnOnce(&[f64], &mut [f64])) -> bool {
        make(&self.frames.component_hz, &mut self.pending_amplitude);
        self.normalise()
    }

    /// Scales the magnitudes to amplitudes so that a measurement of the noise gives unit RMS.
    /// Returns false if all magnitudes are zero.
    fn normalise(&mut self) -> bool {
        let [first, last] = self.frames.edges;
        self.pending_amplitude.first_mut().into_iter().for_each(|a| *a *= first);
        self.pending_amplitude.last_mut().into_iter().for_each(|a| *a *= last);
        let mut power = 0.0;
        for (a, read) in self.pending_amplitude.iter_mut().zip(&self.frames.read) {
            if !a.is_finite() || *a <= 0.0 {
                *a = 0.0;
            }
            // Half the square of an amplitude is the power of a sinusoid.
            power += 0.5 * read * *a * *a;
        }
        let gain = if power > 0.0 { 1.0 / crate::root::sqrt(power) } else { 0.0 };
        self.pending_amplitude.iter_mut().for_each(|a| *a *= gain);
        power > 0.0
    }

    /// Replaces the current amplitudes by the pending ones.
    fn take_pending(&mut self) {
        for (a, &pending) in self.amplitude.iter_mut().zip(&self.pending_amplitude) {
            *a = 0.5 * pending as f32;
        }
    }

    /// Fills `out` with the next samples. Does not allocate.
    pub fn render(&mut self, out: &mut [f32]) {
        self.render_with(out, &mut |_, magnitude| magnitude.fill(0.0));
    }

    /// Fills `out` with the next samples, as [`Self::render`] does. `make` computes a spectrum that
    /// [`Self::retune_with`] has postponed.
    pub fn render_with(&mut self, out: &mut [f32], make: &mut dyn FnMut(&[f64], &mut [f64])) {
        let mut rest = out;
        while !rest.is_empty() {
            // The end of the hop is handled first, and the start of a fade second. In this order, a
            // fade that waits for the next hop starts at that hop's first sample.
            if self.position == self.frames.hop {
                self.next_hop();
            }
            if self.pending != Pending::None {
                self.begin_fade(make);
            }
            let run = match self.fade_position {
                Some(done) => self.run_fade(done, rest),
                None => self.run_steady(rest),
            };
            rest = &mut rest[run..];
        }
    }

    /// Renders samples up to the end of the current hop; returns their number. The samples do not
    /// depend on the block size, even while a change waits for the next hop.
    fn run_steady(&mut self, out: &mut [f32]) -> usize {
        // `faded` is free here: while a cross-fade needs it, `run_fade` renders instead.
        if self.position >= self.prepare_at && !self.changes && self.prepared.is_none() {
            self.prepare();
        }
        let run = out.len().min(self.frames.hop - self.position);
        out[..run].copy_from_slice(&self.now[self.position..self.position + run]);
        self.position += run;
        run
    }

    /// Renders samples of a cross-fade, `done` samples after its start; returns their number.
    fn run_fade(&mut self, done: usize, out: &mut [f32]) -> usize {
        let fade_len = self.frames.fade_len;
        let run = out.len().min(fade_len - done);
        let old = &self.now[self.position..self.position + run];
        let new = &self.faded[self.position..self.position + run];
        for (i, ((out, old), new)) in out.iter_mut().zip(old).zip(new).enumerate() {
            // The weights are linear, because both signals have the same phases. Therefore, their
            // amplitudes add up, and not their powers.
            let weight = (done + i + 1) as f32 / fade_len as f32;
            *out = old + weight * (new - old);
        }
        self.position += run;
        self.fade_position = Some(done + run);
        // The last weight was 1, so exchanging the buffers causes no jump.
        if done + run == fade_len {
            core::mem::swap(&mut self.now, &mut self.faded);
            self.fade_position = None;
        }
        run
    }

    /// Starts a cross-fade to the pending spectrum. The cross-fade waits if another one is in
    /// progress. It also waits if the rest of the hop is too short, because a frame that is
    /// computed again covers only this hop.
    fn begin_fade(&mut self, make: &mut dyn FnMut(&[f64], &mut [f64])) {
        if self.fade_position.is_some() || self.position + self.frames.fade_len > self.frames.hop {
            return;
        }
        let made = self.pending == Pending::Made || self.make_pending(make);
        self.pending = Pending::None;
        if made {
            self.take_pending();
            // This must come before `remake_hop`. After the overlap, `remake_hop` uses the phases
            // that were drawn last, and these must be the phases of the current frame.
            self.discard_prepared();
            self.remake_hop();
            self.fade_position = Some(0);
            self.changes = true;
        }
    }

    /// Advances to the next frame.
    fn next_hop(&mut self) {
        // A cross-fade begins only if it ends within its hop, so no cross-fade is in progress here.
        // Therefore, `faded` is free for the next hop.
        if self.prepared.is_none() {
            self.prepare();
        }
        if let Some(after) = self.prepared.take() {
            self.ending = core::mem::replace(&mut self.beginning, self.next.clone());
            self.next = after;
        }
        core::mem::swap(&mut self.now, &mut self.faded);
        self.position = 0;
        self.changes = false;
    }

    /// Computes the next hop in `faded`.
    fn prepare(&mut self) {
        self.tail.copy_from_slice(&self.now[self.frames.hop..]);
        let mut phases = self.next.clone();
        phases.fill_directions(&mut self.cos, &mut self.sin);
        self.prepared = Some(phases);
        self.make_frame();
        self.blend();
    }

    /// Discards a prepared hop, because a cross-fade needs its buffer, and draws the phases of the
    /// current frame again.
    fn discard_prepared(&mut self) {
        if self.prepared.take().is_some() {
            self.draw(self.beginning.clone());
        }
    }

    /// Draws the phases of the next frame.
    fn draw_next(&mut self) {
        self.ending = self.beginning.clone();
        self.beginning = self.next.clone();
        self.next.fill_directions(&mut self.cos, &mut self.sin);
    }

    /// Draws the phases of a frame from a copy of the generator, which itself stays unchanged.
    fn draw(&mut self, mut phases: Uniform) {
        phases.fill_directions(&mut self.cos, &mut self.sin);
    }

    /// Computes the rest of the current hop again into `faded`, with the same phases and the
    /// current amplitudes.
    fn remake_hop(&mut self) {
        // After the overlap, the hop contains only one frame, so only this frame is computed.
        let overlaps = self.position < self.frames.rise.len();
        if overlaps {
            self.draw(self.ending.clone());
            self.make_frame();
            self.tail.copy_from_slice(&self.faded[self.frames.hop..]);
            self.draw(self.beginning.clone());
        }
        self.make_frame();
        if overlaps {
            self.blend();
        }
    }

    /// Computes a frame into `faded`, from the phases that were drawn last.
    fn make_frame(&mut self) {
        self.frames.inverse.run(
            &mut self.workspace,
            self.frames.first,
            [&self.cos, &self.sin],
            &self.amplitude,
            &mut self.faded,
        );
    }

    /// Fades in the frame in `faded`, and fades out the frame whose end is in `tail`.
    fn blend(&mut self) {
        let rise = &self.frames.rise;
        let falling = rise.iter().rev().zip(&self.tail);
        let rising = self.faded.iter_mut().zip(rise);
        for ((x, rise), (fall, tail)) in rising.zip(falling) {
            *x = rise * *x + fall * tail;
        }
    }
}

#[cfg(test)]
mod tests;
