//! The renderer and the device that play the trials of a study.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use htex_base::files::{AtFile, OwnFolder};
use htex_base::finding::plain;
use htex_device::{DeviceError, SettingKind};
use htex_format::ErrorMeasure;
use htex_lab::LabError;
use htex_lab::study::{
    DeviceUsed, Felt, Meter, OutputLevels, Playback, Rig, Stimulus, Study, full_drive, scene_of,
    set_gain,
};
use htex_scene::file::Motion;
use htex_scene::{DeviceOverride, Renderer, Scene, output_name};

use crate::failure::{Failure, Result, for_file};
use crate::motions::Motions;
use crate::output::tell;
use crate::playing::Output;
use crate::scenes::{Loader, Ready, costs};
use crate::signals::interrupted;

/// The device setting for how long samples wait before they are output.
const BUFFER: &str = "buffer_ms";

/// Plays the trials of a study.
pub(super) struct StudyRig<'a> {
    pub(super) study: &'a Study,
    pub(super) path: PathBuf,
    pub(super) loader: Loader,
    pub(super) device: DeviceOverride,
    /// Format of the files that are written, if the device is a file.
    pub(super) format: String,
    /// Folder of these files, inside the folder of answers.
    pub(super) folder: PathBuf,
    /// The folder of answers, if the device is a file.
    pub(super) answers: Option<OwnFolder>,
    /// The finger's motion, if it is live.
    pub(super) motions: Option<Motions>,
    /// Whether trials are played as fast as the device accepts samples.
    pub(super) is_fast: bool,
    pub(super) told: RefCell<BTreeSet<String>>,
    pub(super) errors_db: RefCell<BTreeMap<(String, String), Option<f64>>>,
    pub(super) ended: bool,
    /// Records what the participant feels; `None` without a source.
    pub(super) felt: Option<Felt>,
    /// Drive of a display (volts) and levels of the current or last trial; `None` before a device
    /// is opened.
    pub(super) playing: Option<(Option<f64>, Meter)>,
}

impl StudyRig<'_> {
    /// Loads a texture with a model and the device.
    fn load(&self, texture: &str, model: &str, file: &str) -> Result<Ready> {
        let listed = self.study.textures.iter().find(|t| t.name() == texture);
        let Some(listed) = listed else {
            return Err(Failure::Other(format!("the study has no texture {texture}")));
        };
        let name = output_name(file.as_ref(), &self.format);
        let path = self.folder.join(name);
        let device =
            DeviceOverride { output: Some(path.display().to_string()), ..self.device.clone() };
        let scene = scene_of(self.study, &listed.asset, model);
        let told = &mut self.told.borrow_mut();
        self.loader
            .load(&self.path, told, |around| Scene::from_bytes(&self.path, &scene, around, &device))
    }

    /// Describes the device that will be used.
    pub(super) fn device_used(&self) -> Result<DeviceUsed> {
        let (first, model) = (&self.study.textures[0], &self.study.models[0]);
        let ready = self.load(&first.name(), model, "device")?;
        let descriptor = ready.device.descriptor();
        // The name of a file is left out, because it is different in each trial.
        let is_file = |name: &str| {
            let mut settings = descriptor.settings.iter();
            settings.any(|setting| setting.name == name && setting.kind == SettingKind::Path)
        };
        // A participant notices how long samples wait only if the motion is live. In other studies,
        // the buffer may be made longer during a session, e.g. after it ran dry.
        let is_live = matches!(self.study.motion, Motion::Live);
        let is_unfelt = |name: &str| is_file(name) || (name == BUFFER && !is_live);
        let settings = ready.scene.settings.iter().filter(|(name, _)| !is_unfelt(name));
        Ok(DeviceUsed {
            adapter: descriptor.id.clone(),
            profile: self.device.profile.clone().unwrap_or_default(),
            settings: settings.map(|(name, value)| (name.to_owned(), value.to_owned())).collect(),
            limit: ready.capabilities.limit,
            quantity_gain: ready.scene.file.device.quantity_gain,
        })
    }

    /// Whether the device writes a file for each trial.
    pub(super) fn plays_to_files(&self) -> Result<bool> {
        let (first, model) = (&self.study.textures[0], &self.study.models[0]);
        let ready = self.load(&first.name(), model, "device")?;
        let settings = &ready.device.descriptor().settings;
        Ok(settings.iter().any(|s| s.kind == SettingKind::Path))
    }

    /// Refuses a trial whose file would be written through a link in the folder of answers.
    fn check_file(&self, stimulus: &Stimulus) -> Result<()> {
        let Some(answers) = &self.answers else {
            return Ok(());
        };
        let path = self.folder.join(output_name(stimulus.file.as_ref(), &self.format));
        let inside = path.strip_prefix(answers.path()).unwrap_or(&path);
        answers.path_to_write(inside).writing(&path)?;
        Ok(())
    }

    fn begin(&self, stimulus: &Stimulus) -> Result<(Ready, Option<f64>)> {
        self.check_file(stimulus)?;
        let mut ready = self.load(&stimulus.texture, &stimulus.model, &stimulus.file)?;
        let scene = &mut ready.scene.file;
        scene.duration_s = stimulus.seconds;
        scene.seed = stimulus.seed;
        let able = &ready.capabilities;
        let drive_v = match stimulus.gain_db {
            Some(gain_db) => {
                let rms = stimulus.reference_rms;
                set_gain(&mut scene.device, able, gain_db, rms)
            }
            None => full_drive(&scene.device, able),
        };
        Ok((ready, drive_v))
    }
}

impl Rig for StudyRig<'_> {
    type Error = Failure;

    fn play(&mut self, stimulus: &Stimulus, ends: &mut dyn FnMut() -> bool) -> Result<Playback> {
        // `felt` is taken out of the rig, because `play_with` borrows the whole rig.
        let mut felt = self.felt.take();
        self.playing = None;
        let played = self.play_with(felt.as_mut(), stimulus, ends);
        if let (Err(_), Some(felt)) = (&played, &mut felt) {
            felt.abort();
        }
        self.felt = felt;
        played
    }

    fn output_before_error(&mut self) -> Option<(Option<f64>, OutputLevels)> {
        let (drive_v, meter) = self.playing.take()?;
        Some((drive_v, meter.levels()))
    }

    fn ran_dry(error: &Failure) -> bool {
        matches!(error, Failure::Device(DeviceError::Underflow { .. }))
    }

    fn tell(&self, notice: &str) {
        tell!("note: {}", plain(notice));
    }

    fn band_error_db(&self, texture: &str, model: &str) -> Option<f64> {
        let key = (texture.to_owned(), model.to_owned());
        if let Some(known) = self.errors_db.borrow().get(&key) {
            return *known;
        }
        let error_db = self.load(texture, model, "error").ok().and_then(|ready| {
            let asset = ready.scene.assets.first()?;
            let representation = asset.representation(model).ok()?;
            representation.data().error_db(ErrorMeasure::NineBand)
        });
        self.errors_db.borrow_mut().insert(key, error_db);
        error_db
    }

    fn is_interrupted(&self) -> bool {
        self.ended || interrupted()
    }
}

impl StudyRig<'_> {
    /// Plays a trial and records what is felt.
    fn play_with(
        &mut self,
        mut felt: Option<&mut Felt>,
        stimulus: &Stimulus,
        ends: &mut dyn FnMut() -> bool,
    ) -> Result<Playback> {
        let (ready, drive_v) = self.begin(stimulus)?;
        let plan = ready.plan(&costs())?;
        let mut renderer = Renderer::new(&ready.scene, &plan).map_err(for_file(&self.path))?;
        if ready.scene.file.motion == Motion::Live {
            // Until the first reading, the finger does not touch the surface.
            renderer.set_motion(htex::Motion::AWAY).map_err(for_file(&self.path))?;
        }
        let recorded = felt.as_mut().zip(stimulus.felt.as_ref());
        if let Some((felt, name)) = recorded {
            let seconds = stimulus.seconds.unwrap_or(self.study.trial_s);
            // Starts before the device plays, so that the beginning of the trial is recorded.
            felt.begin(name, seconds).map_err(LabError::felt)?;
        }
        let mut output = Output::open(&ready, &plan)?;
        if !self.is_fast && !ready.capabilities.paced {
            output = output.paced();
        }
        let unit = ready.capabilities.quantity.unit();
        self.playing = Some((drive_v, Meter::new(unit, plan.rate_hz)));
        let (mut stopped, mut left) = (false, false);
        loop {
            let goes_on = output.step(&mut renderer)?;
            if let Some((_, meter)) = &mut self.playing {
                // The level also includes the last block, which may be shorter.
                meter.push(output.last_block());
            }
            if let Some(felt) = felt.as_deref().filter(|felt| felt.waits()) {
                felt.sounds(output.lead_s());
            }
            if !goes_on {
                break;
            }
            if !stopped {
                let motions = self.motions.as_mut();
                self.ended |= motions.is_some_and(|motions| !motions.follow(&mut renderer));
                left = self.ended || interrupted() || ends();
                stopped = left || felt.as_deref().is_some_and(Felt::has_failed);
                if stopped {
                    renderer.stop();
                }
            }
        }
        let underruns = output.device.status().underruns;
        output.finish()?;
        if underruns > 0 {
            // The device went on, but the participant felt a gap. The session can play the trial
            // again.
            return Err(ran_dry(&ready).into());
        }
        let levels = self.playing.as_ref().map(|(_, meter)| meter.levels());
        let mut played = Playback {
            drive_v,
            output: levels.unwrap_or_default(),
            reference_rms: plan.reference_rms,
            felt: None,
        };
        if let Some(felt) = felt {
            if left { felt.abort() } else { played.felt = felt.finish(stimulus, &played)? }
        }
        Ok(played)
    }
}

/// Returns the error for a device that continued after it ran dry.
fn ran_dry(ready: &Ready) -> DeviceError {
    DeviceError::Underflow {
        device: ready.device.descriptor().name.clone(),
        frames: 0,
        advice: "close other programs, or give it a larger buffer".to_owned(),
    }
}
