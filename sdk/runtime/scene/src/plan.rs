//! The plan: the stages of a scene with their order, rates, costs and reasons.

use std::collections::BTreeMap;

use htex_device::{Capabilities, Quantity};
use serde::Serialize;

use crate::SceneError;
use crate::cost::Costs;
use crate::file::{Effect, Levels, Switch};
use crate::load::Scene;
use crate::played::PlayedSurface;
use crate::representation::{self, Choice};
use crate::requirements::Requirements;
use crate::stages::{EFFECTS, Entry, HEADROOM, Need, StagePlace, resampling_work};

/// A plan for playing a scene: the stages that run, the effects that are left out, and the reason
/// for each decision.
#[derive(Debug, Serialize)]
pub struct Plan {
    /// The stages in processing order.
    pub stages: Vec<PlannedStage>,
    /// The effects that are left out.
    pub left_out: Vec<OmittedEffect>,
    /// The representation of each surface that the finger touches.
    pub representation: Vec<ModelChoice>,
    /// Time that the renderer itself takes, without its stages, nanoseconds per sample.
    pub renderer_ns: f64,
    /// Total cost of the stages and the renderer, nanoseconds per sample.
    pub ns_per_sample_total: f64,
    /// True if nothing changes while the scene plays. The renderer then updates no stage between
    /// blocks.
    pub constant: bool,
    /// Rate of the device, hertz.
    pub rate_hz: f64,
    /// Number of frames in a control block. The renderer reads the motion once per control block.
    pub block_frames: usize,
    /// Length of the scene, frames. `None` if it is endless.
    pub frames: Option<u64>,
    /// Name of the machine on which the costs were measured, and how they were measured.
    pub costs: String,
    /// Reference level: the RMS that is mapped to the drive voltage or the preview level, in the
    /// assets' unit.
    pub reference_rms: f64,
    /// Notes for the user.
    pub notes: Vec<String>,
    #[serde(skip)]
    pub(crate) required: Requirements,
    #[serde(skip)]
    pub(crate) surfaces: Vec<PlannedSurface>,
    #[serde(skip)]
    pub(crate) mixes: Vec<Mix>,
    #[serde(skip)]
    pub(crate) device: Vec<(&'static Entry, bool)>,
}

/// A stage of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlannedStage {
    pub name: &'static str,
    /// The surface that the stage belongs to. `None` for all surfaces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<usize>,
    /// Why the stage is included.
    pub reason: String,
    /// Sample rate of the stage's output, hertz.
    pub rate_hz: f64,
    /// Estimated run time, nanoseconds per sample of the device, averaged over the scene.
    pub ns_per_sample: f64,
}

/// An effect that is left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OmittedEffect {
    /// Name of the effect.
    pub name: &'static str,
    /// The surface that the effect belongs to. `None` for all surfaces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<usize>,
    /// Why the effect is left out.
    pub reason: String,
}

/// The representation that plays a surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelChoice {
    /// Index of the surface.
    pub surface: usize,
    pub model: String,
    /// Why the representation was chosen.
    pub why: String,
}

/// A surface with its own effects. The flag of an effect says whether it is neutral.
#[derive(Debug)]
pub(crate) struct PlannedSurface {
    pub(crate) played: PlayedSurface,
    pub(crate) effects: BTreeMap<Effect, bool>,
}

/// Surfaces that are mixed at one rate, and the effects of the mix.
#[derive(Debug)]
pub(crate) struct Mix {
    /// Indices of the surfaces.
    pub(crate) surfaces: Vec<usize>,
    pub(crate) entries: Vec<(&'static Entry, bool)>,
}

/// Plans a scene for a device.
///
/// # Errors
/// See [`SceneError`].
pub fn plan(scene: &Scene, device: &Capabilities, costs: &Costs) -> Result<Plan, SceneError> {
    let mut required = Requirements::gather(scene, device)?;
    // The reference level is known only after this choice, but no cost depends on it.
    let choices = {
        let cost = |surfaces: &[PlayedSurface]| {
            let mut draft = Draft::new(scene, &required, costs);
            draft.all(surfaces)?;
            Ok(draft.total())
        };
        representation::choose(scene, &required, &cost)?
    };
    let loudest_rms = choices.iter().map(|c| c.played.level_rms).fold(0.0, f64::max);
    required.level_rms = match scene.file.device.levels {
        Levels::Normalised => loudest_rms,
        Levels::Own => representation::reference_rms(scene, &required),
    };
    check_drive(&required, loudest_rms)?;
    let surfaces: Vec<PlayedSurface> = choices.iter().map(|c| c.played.clone()).collect();
    let mut draft = Draft::new(scene, &required, costs);
    draft.all(&surfaces)?;
    let (renderer_ns, ns_per_sample_total) = (draft.renderer_ns(), draft.total());
    let Draft { stages, left_out, surfaces, mixes, device, .. } = draft;
    let constant = is_constant(&required, &surfaces);
    Ok(Plan {
        renderer_ns,
        ns_per_sample_total,
        stages,
        left_out,
        representation: choices.iter().map(chosen).collect(),
        constant,
        rate_hz: required.rate_hz,
        block_frames: required.control,
        frames: required.frames,
        costs: costs.machine.clone(),
        notes: notes(&required, constant, loudest_rms),
        reference_rms: required.level_rms,
        required,
        surfaces,
        mixes,
        device,
    })
}

/// Maximum percentage of samples that the drive may clip. Noise 7 dB above the reference level
/// reaches this percentage.
const MOST_CLAMPED_PERCENT: f64 = 5.0;

/// Rejects a texture that is far too strong for the drive. At the reference level, about one in
/// 150,000 samples of noise is clipped.
fn check_drive(required: &Requirements, loudest_rms: f64) -> Result<(), SceneError> {
    let over = loudest_rms / required.level_rms;
    // Without a reference level the gain is 0, and nothing is clipped.
    if required.device.quantity != Quantity::DisplayVoltage || !over.is_finite() {
        return Ok(());
    }
    // Both tails of the normal distribution.
    let percent = 100.0 * libm::erfc(HEADROOM / over / std::f64::consts::SQRT_2);
    if percent > MOST_CLAMPED_PERCENT {
        Err(SceneError::Clamped {
            above_db: 20.0 * libm::log10(over),
            percent,
            most_percent: MOST_CLAMPED_PERCENT,
        })
    } else {
        Ok(())
    }
}

fn chosen(choice: &Choice) -> ModelChoice {
    ModelChoice {
        surface: choice.played.surface,
        model: choice.played.model.clone(),
        why: choice.why.clone(),
    }
}

/// Whether the motion is constant from the first sample to the last.
fn is_constant(required: &Requirements, surfaces: &[PlannedSurface]) -> bool {
    let steady = |p: &PlannedSurface| {
        p.played.always_touched && p.played.speed_mm_s.is_point() && p.played.force_n.is_point()
    };
    !required.live
        && !required.breaks_contact
        && !required.turns_round
        && surfaces.iter().all(steady)
}

fn notes(required: &Requirements, constant: bool, loudest_rms: f64) -> Vec<String> {
    let mut notes = Vec::new();
    if constant {
        notes.push("nothing changes over the scene: the constant path is used".to_owned());
    }
    // The two levels can differ only if `levels` is `own`.
    if required.level_rms > 0.0 && loudest_rms > 0.0 && loudest_rms != required.level_rms {
        let db = 20.0 * libm::log10(loudest_rms / required.level_rms);
        notes.push(format!(
            "levels are not normalised: the loudest texture, {} RMS, is {db:+.1} dB relative to the reference of {}",
            required.quantity.text(loudest_rms),
            required.quantity.text(required.level_rms)
        ));
    }
    match required.device.quantity {
        Quantity::DisplayVoltage => notes.push(format!(
            "the drive's shift is {HEADROOM} times the RMS, since a stream's minimum is not known: \
             against a shift by the minimum of ten seconds of noise (about 4 times the RMS) the texture \
             is {:.1} dB weaker at the same largest voltage",
            20.0 * libm::log10(HEADROOM / 4.0)
        )),
        Quantity::Sound => notes.push(format!(
            "a preview by ear: the level is {} dB relative to full scale, independent of the texture's level{}",
            required.level_dbfs,
            if required.pitch == 1.0 { String::new() } else { format!(", and frequencies are multiplied by {}", required.pitch) }
        )),
        _ => {}
    }
    notes
}

/// Two costs of a stage, nanoseconds per frame of the device: one if the stage is needed, and one
/// if it changes nothing.
struct Ns {
    needed: f64,
    neutral: f64,
}

/// A plan under construction.
struct Draft<'a> {
    scene: &'a Scene,
    required: &'a Requirements,
    costs: &'a Costs,
    stages: Vec<PlannedStage>,
    left_out: Vec<OmittedEffect>,
    surfaces: Vec<PlannedSurface>,
    mixes: Vec<Mix>,
    device: Vec<(&'static Entry, bool)>,
}

impl<'a> Draft<'a> {
    fn new(scene: &'a Scene, required: &'a Requirements, costs: &'a Costs) -> Self {
        Self {
            scene,
            required,
            costs,
            stages: Vec::new(),
            left_out: Vec::new(),
            surfaces: Vec::new(),
            mixes: Vec::new(),
            device: Vec::new(),
        }
    }

    fn total(&self) -> f64 {
        let stages = self.stages.iter().map(|s| s.ns_per_sample);
        stages.sum::<f64>() + self.renderer_ns()
    }

    /// Returns the time that the renderer itself takes. It reads the motion before every block,
    /// unless nothing changes.
    fn renderer_ns(&self) -> f64 {
        let ends = |(entry, _): &(&Entry, bool)| entry.effect == Effect::Contact;
        let constant = is_constant(self.required, &self.surfaces);
        // The ramp at the end needs updates even if the motion never changes.
        self.costs.renderer_ns[usize::from(!constant || self.device.iter().any(ends))]
    }

    fn all(&mut self, surfaces: &[PlayedSurface]) -> Result<(), SceneError> {
        for played in surfaces {
            self.surface(played)?;
        }
        self.untouched(surfaces);
        for group in groups(surfaces) {
            self.mix(surfaces, group)?;
        }
        let required = self.required;
        for entry in EFFECTS {
            if let StagePlace::Device { need, .. } = &entry.place {
                let ns = Ns {
                    needed: self.costs.stage(entry.name),
                    neutral: self.costs.neutral(entry.name),
                };
                if let Some(neutral) =
                    self.decide(entry, None, need(required), required.rate_hz, ns)?
                {
                    self.device.push((entry, neutral));
                }
            }
        }
        Ok(())
    }

    /// Adds the stages of one surface, at its model's rate.
    fn surface(&mut self, played: &PlayedSurface) -> Result<(), SceneError> {
        let surface = Some(played.surface);
        // A voice is rendered only while its surface is touched. If there is a constant frequency
        // ratio, the voice is read at another speed.
        let per_frame = played.share * played.rate_hz * played.fixed_ratio / self.required.rate_hz;
        let model_ns = self.costs.model(&played.model) * per_frame;
        self.push("synthesis", surface, always(played), played.rate_hz, model_ns);
        let mut effects = BTreeMap::new();
        for entry in EFFECTS {
            let StagePlace::Surface { need, .. } = &entry.place else {
                continue;
            };
            let per_frame = per_frame * played.oversampling;
            let ns = Ns {
                needed: match entry.effect {
                    Effect::Interpolation => {
                        // Parameters change once per control block, not per sample.
                        self.costs.retune(&played.model) * played.share
                            / self.required.control as f64
                    }
                    _ => self.costs.stage(entry.name) * per_frame,
                },
                neutral: self.costs.neutral(entry.name) * per_frame,
            };
            let need = need(self.required, played);
            let decided = self.decide(entry, surface, need, played.mix_rate_hz, ns)?;
            effects.extend(decided.map(|neutral| (entry.effect, neutral)));
            // The level stage has the same place in `Track::new`.
            if entry.effect == Effect::FrequencyScaling {
                let level_ns = self.costs.stage("level") * per_frame;
                let reason = "the model's samples have unit RMS; the asset gives the level";
                self.push("level", surface, reason.into(), played.mix_rate_hz, level_ns);
            }
        }
        self.surfaces.push(PlannedSurface { played: played.clone(), effects });
        Ok(())
    }

    /// Leaves out surfaces that are never touched.
    fn untouched(&mut self, surfaces: &[PlayedSurface]) {
        let touched = |i: &usize| surfaces.iter().any(|p| p.surface == *i);
        let all = 0..self.required.touches.len();
        let out = all.filter(|i| self.required.touches[*i].share == 0.0 && !touched(i));
        self.left_out.extend(out.map(|surface| OmittedEffect {
            name: "synthesis",
            surface: Some(surface),
            reason: "the finger never slides over this surface".to_owned(),
        }));
    }

    /// Adds the stages for a mix of surfaces that have the same rate.
    fn mix(&mut self, surfaces: &[PlayedSurface], group: Vec<usize>) -> Result<(), SceneError> {
        let first = &surfaces[group[0]];
        let surface = (group.len() == 1 && surfaces.len() > 1).then_some(first.surface);
        let mut entries = Vec::new();
        for entry in EFFECTS {
            let StagePlace::Mix { need, .. } = &entry.place else {
                continue;
            };
            let (rate_hz, ns) = self.mix_cost(entry, first)?;
            if let Some(neutral) =
                self.decide(entry, surface, need(self.required, first), rate_hz, ns)?
            {
                entries.push((entry, neutral));
            }
        }
        self.mixes.push(Mix { surfaces: group, entries });
        Ok(())
    }

    /// Returns the output rate of a stage of a mix, and the stage's cost per frame of the device.
    fn mix_cost(&self, entry: &Entry, played: &PlayedSurface) -> Result<(f64, Ns), SceneError> {
        let costs = self.costs;
        let neutral = costs.neutral(entry.name);
        Ok(match entry.effect {
            Effect::Resampling => {
                let work = resampling_work(self.required, played)?;
                let needed = work.map_or(0.0, |work| costs.resampling(work));
                (self.required.rate_hz, Ns { needed, neutral })
            }
            _ => {
                let taps = crate::stages::compensation_taps(played) as f64;
                let per_frame = played.mix_rate_hz * played.fixed_ratio / self.required.rate_hz;
                let ns = Ns {
                    needed: costs.compensation.time_ns(1.0, taps) * per_frame,
                    neutral: neutral * per_frame,
                };
                (played.mix_rate_hz, ns)
            }
        })
    }

    /// Decides whether to include an effect. Returns whether the included effect is neutral, or
    /// `None` if the effect is left out.
    fn decide(
        &mut self,
        entry: &'static Entry,
        surface: Option<usize>,
        need: Need,
        rate_hz: f64,
        ns: Ns,
    ) -> Result<Option<bool>, SceneError> {
        let switch = self.scene.file.effects.get(&entry.effect);
        match (switch.copied().unwrap_or_default(), need) {
            (Switch::Off, Need::In(reason)) if self.is_needed(entry) => {
                Err(SceneError::Needed { effect: entry.name.to_owned(), reason })
            }
            (Switch::Off, Need::In(reason)) => {
                let reason = format!("switched off by the scene, although {reason}");
                self.leave_out(entry, surface, reason);
                Ok(None)
            }
            (Switch::Auto | Switch::Off, Need::Out(reason)) => {
                self.leave_out(entry, surface, reason);
                Ok(None)
            }
            (_, Need::In(reason)) => {
                self.push(entry.name, surface, reason, rate_hz, ns.needed);
                Ok(Some(false))
            }
            (Switch::On, Need::Out(reason)) => {
                let reason = format!("switched on by the scene; neutral, since {reason}");
                self.push(entry.name, surface, reason, rate_hz, ns.neutral);
                Ok(Some(true))
            }
        }
    }

    /// Whether the device would receive invalid samples without the effect.
    fn is_needed(&self, entry: &Entry) -> bool {
        match entry.effect {
            Effect::Resampling => true,
            Effect::Gain => {
                !self.required.device.quantity.is_physical() || self.required.quantity_gain != 1.0
            }
            Effect::SquareRoot => !self.required.device.quantity.is_physical(),
            // A voltage must start and end at zero, stay within the drive, and not charge the
            // person who touches the display.
            Effect::Contact | Effect::Limiter | Effect::Carrier => {
                self.required.device.quantity == Quantity::DisplayVoltage
            }
            _ => false,
        }
    }

    fn push(
        &mut self,
        name: &'static str,
        surface: Option<usize>,
        reason: String,
        rate_hz: f64,
        ns_per_sample: f64,
    ) {
        self.stages.push(PlannedStage { name, surface, reason, rate_hz, ns_per_sample });
    }

    fn leave_out(&mut self, entry: &Entry, surface: Option<usize>, reason: String) {
        self.left_out.push(OmittedEffect { name: entry.name, surface, reason });
    }
}

fn always(played: &PlayedSurface) -> String {
    if played.share < 1.0 {
        format!("touched {:.0} % of the time", 100.0 * played.share)
    } else {
        "the texture itself".to_owned()
    }
}

/// Groups the surfaces that can share one resampler, as indices.
fn groups(surfaces: &[PlayedSurface]) -> Vec<Vec<usize>> {
    let key = |p: &PlayedSurface| (p.own_rate, [p.mix_rate_hz, p.fixed_ratio, p.top_hz]);
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (i, played) in surfaces.iter().enumerate() {
        match groups.iter_mut().find(|g| key(&surfaces[g[0]]) == key(played)) {
            Some(group) => group.push(i),
            None => groups.push(vec![i]),
        }
    }
    groups
}
