//! One surface of a running scene: its voice, and the stages that run before surfaces are mixed.

use htex_play::Motion;

use crate::SceneError;
use crate::file::Effect;
use crate::load::Scene;
use crate::path::PathPoint;
use crate::plan::PlannedSurface;
use crate::requirements::Requirements;
use crate::stages::{
    Chain, Context, Crossfade, EFFECTS, Level, Slot, Stage, StagePlace, StageRun, Synthesis,
};

/// One surface.
pub(crate) struct Track {
    pub(crate) surface: usize,
    pub(crate) asset: std::path::PathBuf,
    pub(crate) synthesis: Synthesis,
    synthesis_run: Count,
    /// The flag says whether the interpolation is neutral.
    interpolation: Option<(Count, bool)>,
    chain: Chain,
    crossfade: Option<(Crossfade, Count)>,
    /// Whether the surface is audible: touched, or fading out.
    pub(crate) sounds: bool,
    /// `Some` if the model follows the motion itself.
    follower: Option<Follower>,
}

/// The clock of a voice that receives the position of the finger.
struct Follower {
    /// Ratio of the voice's time to the scene's time.
    pitch: f64,
    /// Rate of the frames, hertz.
    rate_hz: f64,
    /// Frames during which the voice was not rendered.
    skipped: u64,
}

/// Force, path position and place of the finger at one time of the scene.
pub(crate) struct FingerOnPath {
    pub(crate) t_s: f64,
    pub(crate) force_n: f64,
    pub(crate) point: PathPoint,
    /// Place on the surface, mm, if known.
    pub(crate) place_mm: Option<[f64; 2]>,
}

/// How often a stage outside the chain ran, and its total time.
#[derive(Default)]
struct Count {
    blocks: u64,
    ns: u64,
}

impl Track {
    pub(crate) fn new(
        scene: &Scene,
        required: &Requirements,
        planned: &PlannedSurface,
    ) -> Result<Self, SceneError> {
        let played = &planned.played;
        let source = played
            .source(scene, required)
            .map_err(SceneError::for_surface(played.surface, scene))?;
        let synthesis = Synthesis::new(source);
        let mut chain = Chain::default();
        for entry in EFFECTS {
            let Some(&neutral) = planned.effects.get(&entry.effect) else {
                continue;
            };
            if let StagePlace::Surface { build: Some(build), .. } = &entry.place {
                let stage = build(required, played, neutral);
                chain.slots.push(Slot::new(entry.name, Some(played.surface), stage));
            }
        }
        // The level stage comes after the stages that change the rate, and before the stages that
        // change the level.
        let scaled = planned.effects.contains_key(&Effect::FrequencyScaling);
        let level = Level::new(played, synthesis.level_rms());
        let level = Slot::new("level", Some(played.surface), Box::new(level));
        chain.slots.insert(usize::from(scaled), level);
        let crossfade = planned.effects.get(&Effect::Crossfade).map(|neutral| {
            // A neutral cross-fade stays at full weight. A cross-fade that is needed starts silent.
            let fade = Crossfade::new(played.mix_rate_hz, *neutral);
            (fade, Count::default())
        });
        Ok(Self {
            surface: played.surface,
            asset: scene.file.surfaces[played.surface].asset.clone(),
            synthesis,
            synthesis_run: Count::default(),
            interpolation: planned
                .effects
                .get(&Effect::Interpolation)
                .map(|neutral| (Count::default(), *neutral)),
            chain,
            crossfade,
            sounds: true,
            follower: played.follows_motion.then_some(Follower {
                pitch: played.fixed_ratio,
                rate_hz: played.mix_rate_hz,
                skipped: 0,
            }),
        })
    }

    /// Updates the stages at the start of a control block.
    pub(crate) fn follow(&mut self, context: &Context, touched: bool, timed: bool) {
        if let Some((crossfade, _)) = &mut self.crossfade {
            crossfade.set(touched);
            // This changes only at control blocks, so that samples do not depend on the caller's
            // block sizes.
            self.sounds = touched || !crossfade.is_silent();
        }
        if let (Some((count, neutral)), true) = (&mut self.interpolation, touched) {
            let moves = !*neutral && context.finger.slides();
            count.run(timed, || {
                if moves {
                    self.synthesis.set_motion(context.finger.without_direction());
                }
            });
        }
        // The voice was retuned first, so that the level stage gets the level of this motion.
        self.chain.follow(&Context { level_rms: self.synthesis.level_rms(), ..*context });
    }

    /// While the surface is audible, passes motion, position and place to a model that follows the
    /// motion itself. Position and time are on the voice's time scale, so both are multiplied by
    /// the pitch. The place on the surface stays unchanged.
    pub(crate) fn set_finger(&mut self, finger: &FingerOnPath) {
        let Some(follower) = self.follower.as_ref().filter(|_| self.sounds) else {
            return;
        };
        // The voice was not rendered while the surface was silent, so its time is behind the
        // scene's time.
        let skipped_s = follower.skipped as f64 / follower.rate_hz;
        let motion = Motion::new(finger.point.speed_mm_s, finger.force_n)
            .with_position_mm(finger.point.position_mm * follower.pitch)
            .with_place_mm(finger.place_mm);
        let at_s = finger.t_s * follower.pitch - skipped_s;
        self.synthesis.follow_finger(motion, at_s);
    }

    /// Counts frames during which the surface is silent and not rendered.
    pub(crate) fn skip(&mut self, frames: usize) {
        if let Some(follower) = &mut self.follower {
            follower.skipped += frames as u64;
        }
    }

    /// Renders the surface through its stages and its crossfade.
    pub(crate) fn render(&mut self, timed: bool, out: &mut [f32]) {
        let (synthesis, count) = (&mut self.synthesis, &mut self.synthesis_run);
        self.chain.render(timed, out, &mut |block| {
            count.run(timed, || synthesis.render(block, &mut |_| {}));
        });
        if let Some((fade, count)) = &mut self.crossfade {
            count.run(timed, || fade.apply(out));
        }
    }

    /// Statistics of all stages of the surface.
    pub(crate) fn runs(&self, frames: Option<u64>) -> Vec<StageRun> {
        let run = |name, count: &Count| StageRun {
            name,
            surface: Some(self.surface),
            blocks: count.blocks,
            ns_per_sample: frames.map(|frames| count.ns as f64 / frames.max(1) as f64),
        };
        let synthesis = run("synthesis", &self.synthesis_run);
        let interpolation = self.interpolation.as_ref();
        let crossfade = self.crossfade.as_ref();
        std::iter::once(synthesis)
            .chain(interpolation.map(|(count, _)| run("interpolation", count)))
            .chain(self.chain.slots.iter().map(|slot| slot.run(frames)))
            .chain(crossfade.map(|(_, count)| run("crossfade", count)))
            .collect()
    }
}

impl Count {
    fn run(&mut self, timed: bool, what: impl FnOnce()) {
        self.blocks += 1;
        if !timed {
            return what();
        }
        let start = std::time::Instant::now();
        what();
        self.ns += start.elapsed().as_nanos() as u64;
    }
}
