//! Records with a sensor what participants feel during the trials of a study.

use std::path::Path;

use clap::Args;
use htex_author::Exploration;
use htex_lab::record::Format;
use htex_lab::study::{Felt, FeltSetup, Study};
use htex_scene::file::Motion;

use super::asker::AskingArgs;
use crate::devices::{DeviceArgs, pairs};
use crate::failure::{Failure, Result};
use crate::inputs::{InputArgs, paced};
use crate::invocation::tool;
use crate::output::warn;

/// Options for the source that records what participants feel.
#[derive(Args)]
pub(super) struct FeltArgs {
    /// Record the signals at the finger during each trial from this source: analog inputs of a
    /// National Instruments card (daq:Dev1/ai0:5), a recording that is replayed in each trial
    /// (file:rec.csv), or another source in `htex device list`
    #[arg(long, value_name = "NAME:TARGET", help_heading = "Source")]
    source: Option<String>,

    /// A setting of the source, e.g. rate_hz=20000; may be given several times
    #[arg(
        long = "source-set",
        value_name = "NAME=VALUE",
        help_heading = "Source",
        requires = "source"
    )]
    source_settings: Vec<String>,

    #[command(flatten)]
    input: InputArgs,
}

impl FeltArgs {
    /// Refuses a combination that cannot work.
    pub(super) fn check(&self, asking: &AskingArgs, is_simulated: bool) -> Result<()> {
        let problem = if self.source.is_none() && self.input.is_given() {
            "--map, --calibration, --quantity, --tracker and --format need --source; add it"
        } else if self.input.tracks_stdin() && asking.reads_stdin(is_simulated) {
            "--tracker lines:-: standard input cannot be both the tracker and the answers or the motion; give the tracker's port"
        } else {
            return Ok(());
        };
        Err(Failure::Usage(problem.to_owned()))
    }

    /// Opens a recorder for a participant, if there is a source.
    pub(super) fn open(
        &self,
        study: &Study,
        folder: &Path,
        participant: &str,
        devices: &DeviceArgs,
        is_fast: bool,
    ) -> Result<Option<Felt>> {
        let Some(name) = self.source.clone() else {
            return Ok(None);
        };
        let asked = pairs("--source-set", &self.source_settings)?;
        let given = paced(&name, asked.clone(), is_fast);
        let devices = devices.devices_quietly()?;
        // The source is opened here once, so that a wrong source or map is found before the
        // session.
        let source = devices.open_input(&name, None, &given)?;
        let signals = self.input.signals(&name, &*source)?;
        warn(signals.warnings());
        let rate_hz = source.stream().rate_hz;
        // Each trial opens it again.
        drop(source);
        let setup = FeltSetup {
            folder: folder.to_owned(),
            participant: participant.to_owned(),
            source: name.clone(),
            settings: asked,
            map: self.input.map.clone(),
            quantity: self.input.quantity(),
            target: target(study),
            format: self.input.format.unwrap_or(Format::Npy),
            tool: tool(),
            is_fast,
        };
        let open = Box::new(move || devices.open_input(&name, None, &given));
        let tracker = self.input.tracker()?;
        Ok(Some(Felt::new(setup, open, rate_hz, signals, tracker)?))
    }
}

/// Returns the study's speed and force if its motion is constant.
pub(super) fn target(study: &Study) -> Exploration {
    match &study.motion {
        Motion::Constant(motion) => {
            Exploration { speed_mm_s: Some(motion.speed_mm_s.abs()), force_n: Some(motion.force_n) }
        }
        _ => Exploration::default(),
    }
}
