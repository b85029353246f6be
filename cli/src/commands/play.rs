use std::path::PathBuf;

use clap::Args;
use clap::builder::{Resettable, StyledStr};
use htex_device::Status;
use htex_device_builtin::SOUND;
use htex_scene::file::{Effect, Motion, Switch};
use htex_scene::{DeviceOverride, Plan, Renderer};

use crate::devices::{DeviceArgs, built_with};
use crate::failure::{Exit, Failure, Result, for_file};
use crate::gains::{FeltArgs, apply_gain};
use crate::located;
use crate::motions::Motions;
use crate::output::{note, print};
use crate::playing::{Output, limited_text};
use crate::scenes::{ChoiceArgs, Ready, SceneArgs, costs, is_asset};
use crate::signals::{self, interrupted};

/// Play a scene or an asset on a device
///
/// The command plays until the scene ends or you press Ctrl-C.
///
/// htex plays an asset at the speed and force of the asset's first condition, or of its strongest
/// condition if the first is silent. An asset plays as sound unless you give --device.
#[derive(Args)]
#[command(after_help = without_sound())]
pub(crate) struct Play {
    /// The scene or the asset
    #[arg(value_parser = located::ASSET)]
    file: PathBuf,

    /// Read the finger's motion from standard input during playback, as lines
    /// `speed_mm_s force_n [x_mm y_mm]`. A negative speed means that the finger moves backwards.
    /// Playback stops at the end of the input
    #[arg(long, value_name = "-", value_parser = ["-"])]
    motion: Option<String>,

    /// Duration, s [default: the duration of the scene]
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,

    /// Drive the display with the gain that `htex gain` found for this person
    #[arg(long, value_name = "NAME")]
    person: Option<String>,

    /// Use the gain of --person that `htex gain --texture` stored under this name
    #[arg(long, value_name = "NAME", requires = "person")]
    texture: Option<String>,

    /// Let the strength of the textures fluctuate over time as in their recordings, if the assets
    /// contain this fluctuation. The fluctuation does not change the mean level. It has not been
    /// tested on people whether this makes a texture feel more real
    #[arg(long)]
    fluctuation: bool,

    #[command(flatten)]
    felt: FeltArgs,

    #[command(flatten)]
    choice: ChoiceArgs,

    #[command(flatten)]
    with: SceneArgs,
}

fn without_sound() -> Resettable<StyledStr> {
    let told = format!("This build has no sound: {}.", built_with(&SOUND));
    (!SOUND.is_built).then(|| told.into()).into()
}

impl Play {
    pub(crate) fn run(self) -> Result {
        let ready = self.load()?;
        self.choice.check_unnamed(&ready)?;
        let plan = ready.plan(&costs())?;
        note(&plan.notes);
        let mut renderer = Renderer::new(&ready.scene, &plan).map_err(for_file(&self.file))?;
        // Called before the device is opened: from then on, a signal must bring the output to zero
        // before the program ends.
        signals::ask();
        let mut output = Output::open(&ready, &plan)?;
        let mut motions = self.motion.is_some().then(Motions::from_stdin);
        let endless = motions.is_some() || plan.frames.is_none();
        // A device without a clock takes samples as fast as they are made, so that a file would
        // fill the disk.
        if endless && !ready.capabilities.paced {
            output = output.paced();
        }
        while output.step(&mut renderer)? {
            let ended = motions.as_mut().is_some_and(|motions| !motions.follow(&mut renderer));
            if ended || interrupted() {
                renderer.stop();
            }
        }
        let status = output.finish()?;
        print(&text(&ready, &plan, &status, &renderer))?;
        Ok(Exit::SUCCESS)
    }

    fn load(&self) -> Result<Ready> {
        if let Some(seconds) = self.seconds.filter(|s| !(*s > 0.0 && *s <= 1e9)) {
            return Err(Failure::Usage(format!("--seconds {seconds}: more than 0, at most 1e9")));
        }
        let device =
            DeviceOverride { live: self.motion.is_some(), ..self.choice.to_override(None, false)? };
        let mut ready = open(&self.with, &self.file, self.motion.is_some(), device)?;
        let scene = &mut ready.scene.file;
        scene.duration_s = self.seconds.or(scene.duration_s);
        match (self.motion.is_some(), scene.motion == Motion::Live) {
            (true, false) => scene.motion = Motion::Live,
            (false, true) => {
                return Err(Failure::usage("the scene's motion is live; give it with --motion -"));
            }
            _ => {}
        }
        if self.fluctuation {
            ready.scene.file.effects.insert(Effect::Fluctuation, Switch::On);
        }
        self.felt.apply(&mut ready)?;
        if let Some(person) = &self.person {
            // Applied after `--levels`: if each model keeps its own level, the scene also needs the
            // level at which the gain was found.
            apply_gain(person, self.texture.as_deref(), &mut ready)?;
        }
        Ok(ready)
    }
}

/// Opens a scene, or makes a scene from an asset. An asset plays as sound if no device is named.
pub(crate) fn open(
    with: &SceneArgs,
    file: &std::path::Path,
    live: bool,
    mut device: DeviceOverride,
) -> Result<Ready> {
    if is_asset(file) {
        device.adapter.get_or_insert_with(|| SOUND.short_name().to_owned());
    }
    // If this build lacks the device, the error says how to get it.
    if let Some(why) = device.adapter.as_deref().and_then(DeviceArgs::missing) {
        return Err(why.into());
    }
    if !is_asset(file) {
        return with.open(file, &device);
    }
    let motion = if live { Motion::Live } else { with.default_motion(file)? };
    with.of_asset(file, motion, None, &device)
}

fn text(ready: &Ready, plan: &Plan, status: &Status, renderer: &Renderer) -> String {
    let seconds = status.frames_written as f64 / plan.rate_hz;
    let (unit, name) = (ready.capabilities.quantity.unit(), &ready.device.descriptor().name);
    let mut text = format!(
        "{name}: {seconds:.3} s at {} Hz, latency {:.1} ms, {} underruns, peak {:.4} {unit}\n",
        plan.rate_hz,
        1e3 * status.latency_s,
        status.underruns,
        status.peak,
    );
    text += &limited_text(renderer.limited_samples());
    text
}
