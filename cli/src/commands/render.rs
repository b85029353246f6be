use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};
use std::fs::File;
use std::path::{Path, PathBuf};

use clap::Args;
use htex_base::files::AtFile;
use htex_base::finding::plain;
use htex_device::{Capabilities, Quantity, Settings, StreamFormat};
use htex_scene::file::Motion;
use htex_scene::{Renderer, output_name};
use serde::Serialize;
use serde_json::Value;

use crate::failure::{Failure, Result, for_file};
use crate::located;
use crate::output::{OutputFile, note, show, shown, warn};
use crate::playing::{Output, limited_text};
use crate::progress::bar;
use crate::scenes::{ChoiceArgs, Ready, SceneArgs, costs};
use crate::signals::{self, interrupted};
use crate::wav::silence;

/// Block size, frames.
const BLOCK: usize = 4096;

/// Render a scene to a file
///
/// Writes exactly the samples that the scene's device would get. The command renders as fast as the
/// machine can, not in real time.
///
/// The extension of the file selects the format: WAV, CSV, NPY or raw samples. The samples have the
/// quantity and the unit of the scene's device: for example, they are forces in newtons, voltages
/// in volts, or sound.
#[derive(Args)]
pub(crate) struct Render {
    /// The scene
    #[arg(value_parser = located::ASSET)]
    scene: PathBuf,

    /// The file to write. A file that you name is replaced if it exists [default: the scene's name
    /// with .wav, if no such file exists]
    #[arg(short, long, value_name = "FILE", value_parser = located::OUTPUT)]
    output: Option<PathBuf>,

    /// Duration, s [default: the duration of the scene]
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,

    /// Print JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    choice: ChoiceArgs,

    #[command(flatten)]
    with: SceneArgs,
}

impl Render {
    pub(crate) fn run(self) -> Result {
        let mut ready = self.with.open(&self.scene, &self.choice.to_override(None, true)?)?;
        self.check_length(&mut ready)?;
        let plan = ready.plan(&costs())?;
        note(&plan.notes);
        let rights = ready.rights();
        let mut renderer = Renderer::new(&ready.scene, &plan).map_err(for_file(&self.scene))?;
        if self.json {
            // The renderer measures times only for JSON output, because this slows it down.
            renderer = renderer.timed();
        }
        signals::ask();
        let RenderTarget { path, aside, mut output } = self.open(&ready, plan.rate_hz)?;
        let length_s = plan.frames.unwrap_or(0) as f64 / plan.rate_hz;
        let bar = bar(length_s.ceil() as u64);
        while output.step(&mut renderer)? {
            if interrupted() {
                // Dropping the device without `finish` leaves no file behind.
                return Err(Failure::other("interrupted; nothing was written"));
            }
            bar.set_position((output.frames() as f64 / plan.rate_hz) as u64);
        }
        bar.finish_and_clear();
        let frames = output.frames();
        output.finish()?;
        aside.map_or(Ok(()), |aside| aside.move_to(&path))?;
        rights.add_to_file(&path).writing(&path)?;
        if renderer.peak() == 0.0 {
            warn(&[silence(&path)]);
        }
        let unit = ready.capabilities.quantity.unit();
        show(
            &Rendering {
                file: path.display().to_string(),
                frames,
                limited_samples: renderer.limited_samples(),
                peak: renderer.peak(),
                rate_hz: plan.rate_hz,
                stages_run: serde_json::to_value(renderer.stages_run())?,
                unit,
            },
            self.json,
        )
    }

    /// Sets the requested length, and refuses a scene without an end.
    fn check_length(&self, ready: &mut Ready) -> Result<()> {
        let scene = &mut ready.scene.file;
        if let Some(seconds) = self.seconds {
            if !(seconds > 0.0 && seconds <= 1e9) {
                return Err(Failure::Usage(format!(
                    "--seconds {seconds}: more than 0, at most 1e9"
                )));
            }
            scene.duration_s = Some(seconds);
        }
        let sentence = match scene.motion {
            Motion::Live => "its motion is live; play it with `htex play --motion -`",
            Motion::Constant(_) if scene.duration_s.is_none() => {
                "it has no end; add duration_s, or give --seconds"
            }
            _ => return Ok(()),
        };
        let file = shown(&self.scene);
        Err(Failure::Other(format!("{file}: {sentence}")))
    }

    fn open(&self, ready: &Ready, rate_hz: f64) -> Result<RenderTarget> {
        let known = ready.devices.find_output("org.htex.file")?;
        let is_file = ready.device.descriptor().id == known.descriptor().id;
        let mut given = if is_file {
            ready.scene.settings.iter().map(|(k, v)| (k.to_owned(), v.to_owned())).collect()
        } else {
            like(&ready.capabilities, &self.scene)
        };
        let aside = match &self.output {
            Some(output) => Aside::for_output(output)?,
            None => None,
        };
        if let Some(output) = &self.output {
            let written = aside.as_ref().map_or(output, |aside| &aside.path);
            given.insert("path".to_owned(), written.display().to_string());
        }
        let settings = Settings::resolve(known.descriptor(), None, &given)?;
        let format = StreamFormat { rate_hz, block_frames: BLOCK as u32 };
        let path = match &self.output {
            Some(output) => output.clone(),
            None => settings.text("path").into(),
        };
        ready.check_output(&path)?;
        if let Some(beside) = ready.rights().beside(&path) {
            ready.check_output(&beside)?;
        }
        let is_named = self.output.is_some() || self.choice.settings.given()?.contains_key("path");
        // `exists` would follow a link, and so overlook a link whose target does not exist.
        if !is_named && path.symlink_metadata().is_ok() {
            let path = shown(&path);
            return Err(Failure::Usage(format!(
                "{path} exists; name the file to write, or to replace, by -o FILE"
            )));
        }
        let device = known.adapter.open_output(&settings, &format)?;
        Ok(RenderTarget { path, aside, output: Output::new(device, BLOCK, rate_hz) })
    }
}

/// The file that receives the samples.
struct RenderTarget {
    path: PathBuf,
    aside: Option<Aside>,
    output: Output,
}

/// A temporary file for an output whose name is not Unicode. It is needed because devices take
/// their settings as text. The file is in a new folder, to which only this user may write.
struct Aside {
    path: PathBuf,
    _folder: tempfile::TempDir,
}

impl Aside {
    /// Creates a temporary file for an output of this name, if it needs one. The file keeps the
    /// extension, which determines the format.
    fn for_output(path: &Path) -> Result<Option<Self>> {
        if path.to_str().is_some() {
            return Ok(None);
        }
        let folder = tempfile::tempdir()
            .map_err(|error| Failure::Other(format!("no temporary folder: {error}")))?;
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("wav");
        Ok(Some(Self { path: folder.path().join(format!("render.{extension}")), _folder: folder }))
    }

    fn move_to(self, path: &Path) -> Result<()> {
        let copy = |file: &mut File| std::io::copy(&mut File::open(&self.path)?, file).map(drop);
        Ok(OutputFile::Named(path).replace(copy)?)
    }
}

/// Returns settings for a file that receives the same samples as a device with these capabilities.
fn like(able: &Capabilities, scene: &Path) -> BTreeMap<String, String> {
    let mut given = vec![("path", output_name(scene, "wav"))];
    match able.quantity {
        Quantity::DisplayVoltage => {
            given.push(("quantity", "display_voltage".to_owned()));
            given.extend(able.limit.map(|limit| ("limit_v", limit.to_string())));
        }
        other => given.push(("quantity", other.name().to_owned())),
    }
    given.into_iter().map(|(k, v)| (k.to_owned(), v)).collect()
}

/// What was rendered.
#[derive(Serialize)]
struct Rendering {
    file: String,
    frames: u64,
    limited_samples: u64,
    peak: f64,
    rate_hz: f64,
    stages_run: Value,
    unit: &'static str,
}

impl Display for Rendering {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { file, peak, rate_hz, unit, .. } = self;
        let seconds = self.frames as f64 / rate_hz;
        writeln!(f, "{}: {seconds:.3} s at {rate_hz} Hz, peak {peak:.4} {unit}", plain(file))?;
        f.write_str(&limited_text(self.limited_samples))
    }
}
