//! The renderer of a scene: runs the chain of stages that a plan describes.

use htex_play::Motion;

use crate::SceneError;
use crate::ahead::Ahead;
use crate::file::{Effect, Surface};
use crate::load::Scene;
use crate::motion::{Course, Readings, topmost};
use crate::path::Path;
use crate::plan::{Mix, Plan, PlannedSurface};
use crate::requirements::Requirements;
use crate::stages::{Chain, Context, Slot, StagePlace, StageRun, Statistics};
use crate::track::{FingerOnPath, Track};

/// Largest number of samples mixed at a time.
const PIECE: usize = 256;

/// Plays a scene. [`Renderer::render`] is real-time safe: it does not allocate, lock or wait.
/// [`Scene::renderer`] makes a renderer for a program that takes the samples itself.
pub struct Renderer {
    surfaces: Vec<Surface>,
    course: Course,
    readings: Readings,
    path: Path,
    timing: Timing,
    mixes: Vec<MixChain>,
    device: Chain,
    sum: Vec<f32>,
    live: Motion,
    frame: u64,
    /// Frames until the next control block.
    left: usize,
    /// Whether stages are updated at control blocks. If not, the scene does not change and is
    /// rendered ahead.
    follows: bool,
    ahead: Ahead,
    timed: bool,
    peak: f32,
}

/// The parts of the requirements that the renderer needs while it plays.
struct Timing {
    rate_hz: f64,
    control: usize,
    frames: Option<u64>,
    ramp: u64,
}

impl Timing {
    fn new(required: &Requirements) -> Self {
        Self {
            rate_hz: required.rate_hz,
            control: required.control,
            frames: required.frames,
            ramp: required.ramp_frames(),
        }
    }
}

/// Surfaces that have the same rate, and the stages after their sum.
struct MixChain {
    tracks: Vec<Track>,
    chain: Chain,
    piece: Vec<f32>,
}

impl Renderer {
    /// Builds the stages of the plan.
    ///
    /// # Errors
    /// Returns an error if a model cannot make a voice.
    pub fn new(scene: &Scene, plan: &Plan) -> Result<Self, SceneError> {
        let required = &plan.required;
        let mixes = plan
            .mixes
            .iter()
            .map(|mix| MixChain::new(scene, required, &plan.surfaces, mix))
            .collect::<Result<_, _>>()?;
        let mut device = Chain::default();
        for (entry, neutral) in &plan.device {
            if let StagePlace::Device { build, .. } = &entry.place {
                let stage = build(required, *neutral);
                device.slots.push(Slot::new(entry.name, None, stage));
            }
        }
        // The contact stage fades at the end, so it needs updates even if nothing else changes.
        let ends = plan.device.iter().any(|(entry, _)| entry.effect == Effect::Contact);
        let course = Course::new(&scene.file.motion, scene.trace.as_ref());
        Ok(Self {
            surfaces: scene.file.surfaces.clone(),
            path: Path::new(&course),
            readings: Readings::new(required.control_s()),
            course,
            timing: Timing::new(required),
            mixes,
            device,
            sum: vec![0.0; PIECE],
            live: Motion::AWAY,
            frame: 0,
            left: 0,
            follows: !plan.constant || ends,
            ahead: Ahead::new(plan.constant && !ends, scene.file.seed),
            timed: false,
            peak: 0.0,
        })
    }

    /// Makes a renderer without surfaces and stages, to measure the time that the renderer itself
    /// takes.
    pub(crate) fn silent(required: &Requirements, constant: bool) -> Self {
        let course = Course::Live;
        Self {
            surfaces: Vec::new(),
            path: Path::new(&course),
            readings: Readings::new(required.control_s()),
            course,
            timing: Timing::new(required),
            mixes: Vec::new(),
            device: Chain::default(),
            sum: Vec::new(),
            live: Motion::AWAY,
            frame: 0,
            left: 0,
            follows: !constant,
            ahead: Ahead::new(constant, 0),
            timed: false,
            peak: 0.0,
        }
    }

    /// Enables timing of each stage, which slows down rendering.
    #[must_use]
    pub fn timed(mut self) -> Self {
        self.timed = true;
        self
    }

    pub fn rate_hz(&self) -> f64 {
        self.timing.rate_hz
    }

    /// Sets the motion of the finger in a live scene. The speed is negative on the back stroke. If
    /// the motion has no position, the finger can touch only surfaces without a region.
    ///
    /// A speed above 1000 mm/s, a force above 20 N, or another number that is out of range counts
    /// as a failed reading. The renderer then holds the last valid motion for at most 100 ms. After
    /// that, the finger has no contact until the next valid motion.
    ///
    /// # Errors
    /// Returns [`SceneError::Motion`] if a number is not finite or the force is negative. Such a
    /// motion also counts as a failed reading.
    pub fn set_motion(&mut self, motion: Motion) -> Result<(), SceneError> {
        // An invalid reading is also stored, so that `Readings` sees the failure.
        self.live = motion;
        if motion.is_reading() {
            self.path.moved(&motion, self.seconds());
        }
        let place = motion.place_mm.unwrap_or_default();
        let finite = motion.speed_mm_s.is_finite() && place.iter().all(|x| x.is_finite());
        if finite && motion.force_n.is_finite() && motion.force_n >= 0.0 {
            Ok(())
        } else {
            Err(SceneError::Motion { speed_mm_s: motion.speed_mm_s, force_n: motion.force_n })
        }
    }

    fn seconds(&self) -> f64 {
        self.frame as f64 / self.timing.rate_hz
    }

    /// Ends the scene as early as possible, with a ramp to silence.
    pub fn stop(&mut self) {
        // The stages learn of the end at the next control block, which may be a whole block away.
        let end = self.frame + self.timing.ramp + self.timing.control as u64;
        self.timing.frames = Some(self.timing.frames.map_or(end, |frames| frames.min(end)));
    }

    /// Returns the number of frames until the end, or `None` if the scene is endless.
    pub fn frames_left(&self) -> Option<u64> {
        self.timing.frames.map(|frames| frames.saturating_sub(self.frame))
    }

    /// Fills `out` with the next samples, in the unit of the device, and returns their number. At
    /// the end of the scene, this number is smaller than the length of `out`. The samples of `out`
    /// after the end are zero. The samples do not depend on the length of `out`.
    ///
    /// # Errors
    /// Returns the first error of a model since the last call. Even then, `out` is filled: the
    /// surface of the failed model is silent, and the other surfaces continue. The caller may
    /// continue to render.
    pub fn render(&mut self, out: &mut [f32]) -> Result<usize, SceneError> {
        let frames = if self.follows { self.render_blocks(out) } else { self.render_ahead(out) };
        self.failure().map_or(Ok(frames), Err)
    }

    /// Renders many samples at once, even if few are requested. Only for scenes that do not change.
    /// When several renderers run in turn, each renderer then loads the memory of its chain only
    /// once for many blocks.
    fn render_ahead(&mut self, out: &mut [f32]) -> usize {
        let mut done = 0;
        loop {
            let left = self.frames_left().unwrap_or(u64::MAX);
            let wanted = (out.len() - done).min(usize::try_from(left).unwrap_or(usize::MAX));
            if wanted == 0 {
                break;
            }
            if self.ahead.is_empty() {
                self.fill_ahead(left);
            }
            let taken = self.ahead.read(&mut out[done..done + wanted]);
            self.frame += taken as u64;
            done += taken;
        }
        out[done..].fill(0.0);
        done
    }

    /// Renders at most `left` samples ahead.
    fn fill_ahead(&mut self, left: u64) {
        // The motion is constant, so one update at the start suffices.
        if self.frame == 0 {
            let (_, on_path) = self.finger();
            let tracks = self.mixes.iter_mut().flat_map(|mix| &mut mix.tracks);
            tracks.for_each(|track| track.set_finger(&on_path));
        }
        let mut samples = self.ahead.begin(left);
        for piece in samples.chunks_mut(PIECE) {
            self.piece(piece);
        }
        self.ahead.end(samples);
    }

    /// Renders samples, and updates the stages before every control block.
    fn render_blocks(&mut self, out: &mut [f32]) -> usize {
        let mut done = 0;
        while done < out.len() {
            if self.left == 0 {
                self.update();
            }
            let wanted = (out.len() - done).min(self.left).min(PIECE);
            let left = self.frames_left().unwrap_or(u64::MAX);
            let frames = (wanted as u64).min(left) as usize;
            if frames == 0 {
                break;
            }
            self.piece(&mut out[done..done + frames]);
            self.left -= frames;
            self.frame += frames as u64;
            done += frames;
        }
        out[done..].fill(0.0);
        done
    }

    fn piece(&mut self, out: &mut [f32]) {
        let Self { mixes, device, sum, timed, .. } = self;
        device.render(*timed, out, &mut |block| mix(mixes, sum, *timed, block));
        let peak = out.iter().fold(self.peak, |peak, x| peak.max(x.abs()));
        self.peak = peak;
    }

    /// Returns the finger's motion at the current frame and its position along the path. Failed
    /// readings are already replaced.
    fn finger(&mut self) -> (Motion, FingerOnPath) {
        let t_s = self.seconds();
        let reading = match self.course {
            Course::Live => self.live,
            ref course => course.motion(t_s),
        };
        let finger = self.readings.filter(reading, 1);
        let mut point = self.path.point_at(t_s);
        // After the hold, the path must not continue at its last speed.
        if !self.readings.is_good() && !finger.slides() {
            point.speed_mm_s = 0.0;
        }
        let on_path =
            FingerOnPath { t_s, force_n: finger.force_n, point, place_mm: finger.place_mm };
        (finger, on_path)
    }

    /// Starts a control block: passes the finger's motion to all stages.
    fn update(&mut self) {
        self.left = self.timing.control;
        let (finger, on_path) = self.finger();
        let context = Context { finger, level_rms: 0.0, ends_in: self.frames_left() };
        let touched = topmost(&self.surfaces, &finger);
        for mix in &mut self.mixes {
            mix.chain.follow(&context);
            for track in &mut mix.tracks {
                track.follow(&context, touched == Some(track.surface), self.timed);
                track.set_finger(&on_path);
            }
        }
        self.device.follow(&context);
    }

    /// Returns statistics of each stage so far, in the order of the plan.
    pub fn stages_run(&self) -> Vec<StageRun> {
        let frames = self.timed.then_some(self.frame);
        let mut tracks: Vec<&Track> = self.mixes.iter().flat_map(|mix| &mix.tracks).collect();
        // Mixes group the surfaces by rate, but the plan lists them by number.
        tracks.sort_by_key(|track| track.surface);
        let tracks = tracks.into_iter().flat_map(|track| track.runs(frames));
        let mixes = self.mixes.iter().flat_map(|mix| &mix.chain.slots);
        let behind = mixes.chain(&self.device.slots).map(|slot| slot.run(frames));
        tracks.chain(behind).collect()
    }

    /// Returns the largest absolute sample so far, in the unit of the device. If the motion is
    /// constant, the renderer renders up to 1,024 samples ahead. This maximum,
    /// [`Self::limited_samples`] and [`Self::rooted_samples`] include the samples that are rendered
    /// ahead.
    pub fn peak(&self) -> f64 {
        f64::from(self.peak)
    }

    /// Returns the number of samples clipped at the device's limit.
    pub fn limited_samples(&self) -> u64 {
        self.statistics().limited
    }

    /// Returns the number of samples for which the radicand of the square root was negative and was
    /// set to zero. Only scenes for electrovibration displays have a square root.
    pub fn rooted_samples(&self) -> u64 {
        self.statistics().rooted
    }

    fn statistics(&self) -> Statistics {
        let mut statistics = Statistics::default();
        self.device.slots.iter().for_each(|slot| slot.count(&mut statistics));
        statistics
    }

    /// Returns and clears the first failure of a model.
    fn failure(&mut self) -> Option<SceneError> {
        let mut tracks = self.mixes.iter_mut().flat_map(|mix| &mut mix.tracks);
        tracks.find_map(|track| {
            let source = track.synthesis.take_failure()?;
            Some(SceneError::Surface { surface: track.surface, asset: track.asset.clone(), source })
        })
    }
}

/// Sums all mixes at the device's rate.
fn mix(mixes: &mut [MixChain], sum: &mut [f32], timed: bool, out: &mut [f32]) {
    match mixes.split_first_mut() {
        None => out.fill(0.0),
        Some((first, others)) => {
            first.render(timed, out);
            for other in others {
                for piece in out.chunks_mut(PIECE) {
                    let more = &mut sum[..piece.len()];
                    other.render(timed, more);
                    piece.iter_mut().zip(more).for_each(|(x, more)| *x += *more);
                }
            }
        }
    }
}

impl MixChain {
    fn new(
        scene: &Scene,
        required: &Requirements,
        surfaces: &[PlannedSurface],
        mix: &Mix,
    ) -> Result<Self, SceneError> {
        let tracks = mix.surfaces.iter().map(|&i| Track::new(scene, required, &surfaces[i]));
        let mut chain = Chain::default();
        let first = &surfaces[mix.surfaces[0]].played;
        let surface = (mix.surfaces.len() == 1 && surfaces.len() > 1).then_some(first.surface);
        for (entry, neutral) in &mix.entries {
            if let StagePlace::Mix { build, .. } = &entry.place {
                let stage = build(required, first, *neutral)?;
                chain.slots.push(Slot::new(entry.name, surface, stage));
            }
        }
        Ok(Self { tracks: tracks.collect::<Result<_, _>>()?, chain, piece: vec![0.0; PIECE] })
    }

    fn render(&mut self, timed: bool, out: &mut [f32]) {
        let (tracks, piece) = (&mut self.tracks, &mut self.piece);
        self.chain.render(timed, out, &mut |block| {
            for block in block.chunks_mut(PIECE) {
                sum_of(tracks, piece, timed, block);
            }
        });
    }
}

/// Sums the audible surfaces.
fn sum_of(tracks: &mut [Track], piece: &mut [f32], timed: bool, out: &mut [f32]) {
    let mut first = true;
    for track in tracks {
        if !track.sounds {
            track.skip(out.len());
            continue;
        }
        if first {
            track.render(timed, out);
            first = false;
            continue;
        }
        let more = &mut piece[..out.len()];
        track.render(timed, more);
        out.iter_mut().zip(more).for_each(|(x, more)| *x += *more);
    }
    if first {
        out.fill(0.0);
    }
}
