use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use clap::Args;
use htex_base::files::AtFile;
use htex_device::Quantity;
use htex_scene::{Gain as StoredGain, Gains, Renderer, START_DB, factor_of_db};

use crate::commands::play;
use crate::failure::{Exit, Failure, Result, for_file};
use crate::gains::{FeltArgs, gains, hash, key, recordings};
use crate::located;
use crate::output::{print, shown};
use crate::playing::Output;
use crate::scenes::{ChoiceArgs, Ready, SceneArgs, costs};
use crate::signals::{self, interrupted};

/// Step of the level, decibels.
const STEP_DB: f64 = 1.0;
const LARGE_STEP_DB: f64 = 4.0;

/// Find a participant's preferred gain
///
/// The participant touches the display and adjusts the gain, i.e. how strong the texture is. htex
/// stores the gain, and `htex play --person` plays with the stored gain.
///
/// The texture plays until you accept a gain. Type `+` or `-` and press Enter to make the texture 1
/// dB stronger or weaker. Type `++` or `--` and press Enter to make it 4 dB stronger or weaker.
/// Press only Enter to accept the gain, or Ctrl-C to leave without storing a gain. By default, the
/// texture starts 20 dB below the device's limit, and becomes stronger only when you type `+`. (In
/// the paper, participants start at the limit.)
///
/// htex stores one gain for each combination of a person, a texture, and a device with its profile.
/// All models of a texture share this gain. htex identifies a texture by its name and author, so
/// the gain stays valid if you fit the texture again. In the paper, participants found their gain
/// with the model AR (`--model ar`), and felt all models with this gain.
#[derive(Args)]
pub(crate) struct Gain {
    /// The asset or the scene
    #[arg(value_parser = located::ASSET)]
    file: PathBuf,

    /// Name of the participant, under which htex stores the gain
    #[arg(long, value_name = "NAME")]
    person: String,

    /// Peak voltage at which the texture starts, V [default: a tenth of the device's limit]
    #[arg(long, value_name = "V")]
    start: Option<f64>,

    /// Store the gain under this name, e.g. because another texture has the same name and author
    /// [default: the texture's name and author]
    #[arg(long, value_name = "NAME")]
    texture: Option<String>,

    #[command(flatten)]
    felt: FeltArgs,

    #[command(flatten)]
    choice: ChoiceArgs,

    #[command(flatten)]
    with: SceneArgs,
}

/// The accepted drive, volts, and the RMS that was played with this drive, in the assets' unit.
struct MatchedGain {
    drive_v: f64,
    reference_rms: f64,
}

/// What an input line asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Wish {
    Change(f64),
    Keep,
}

impl Gain {
    pub(crate) fn run(self) -> Result {
        let device = self.choice.to_override(None, false)?;
        if self.choice.device.is_none() && crate::scenes::is_asset(&self.file) {
            return Err(Failure::usage("--device is missing: a gain is for one device"));
        }
        let mut ready = play::open(&self.with, &self.file, false, device)?;
        let limit_v = limit(&ready)?;
        let weak_v = limit_v * factor_of_db(START_DB);
        let start_v = self.start.unwrap_or(weak_v);
        if !(start_v > 0.0 && start_v <= limit_v) {
            return Err(Failure::Usage(format!(
                "--start {start_v}: more than 0, at most {limit_v} V"
            )));
        }
        // The participant may take any time, so the scene's duration does not apply.
        ready.scene.file.duration_s = None;
        self.felt.apply(&mut ready)?;
        let key = key(&self.person, self.texture.as_deref(), &ready);
        let (_, file) = gains()?;
        let Some(found) = adjust(&mut ready, start_v, limit_v)? else {
            return Err(Failure::other("ended without a match; nothing was kept"));
        };
        // The text is made here, before `key` is moved, but printed only after the gain is stored.
        let text = format!(
            "kept for {} and `{}`: {} ({})\n",
            self.person,
            key.texture,
            volts(found.drive_v),
            shown(&file)
        );
        let kept = StoredGain {
            key,
            file: self.file.display().to_string(),
            drive_v: found.drive_v,
            reference_rms: Some(found.reference_rms),
            recordings: recordings(&ready),
            blake3: None,
        };
        let hash = hash(&ready)?;
        Gains::update(&file, |gains| gains.put(kept, &hash)).writing(&file)?;
        print(&text)?;
        Ok(Exit::SUCCESS)
    }
}

fn limit(ready: &Ready) -> Result<f64> {
    let able = &ready.capabilities;
    match (able.quantity, able.limit) {
        (Quantity::DisplayVoltage, Some(limit_v)) => Ok(limit_v),
        _ => Err(Failure::Other(format!(
            "{} is not an electrovibration display; a gain is the voltage of one",
            ready.device.descriptor().name
        ))),
    }
}

/// Plays until the participant accepts the gain. Returns `None` if the input ends or is interrupted
/// before that.
fn adjust(ready: &mut Ready, start_v: f64, limit_v: f64) -> Result<Option<MatchedGain>> {
    // Called before the device is opened: from then on, a signal must bring the output to zero
    // before the program ends.
    signals::ask();
    let wishes = wishes();
    let (mut drive_v, mut output, mut kept) = (start_v, None, None);
    let mut goes_on = true;
    while goes_on {
        ready.scene.file.device.drive_v = Some(drive_v);
        let plan = ready.plan(&costs())?;
        let mut renderer = Renderer::new(&ready.scene, &plan).map_err(for_file(&ready.file))?;
        // The first plan opens the device, which stays open while the gain changes.
        let output = match &mut output {
            Some(output) => output,
            none => none.insert(opened(ready, &plan)?),
        };
        crate::output::tell!("{}   + stronger, - weaker, Enter: it matches", volts(drive_v));
        let wish = play_until_wish(&mut renderer, output, &wishes)?;
        match wish {
            Some(Wish::Change(db)) => drive_v = (drive_v * factor_of_db(db)).min(limit_v),
            Some(Wish::Keep) => {
                let reference_rms = plan.reference_rms;
                kept = Some(MatchedGain { drive_v, reference_rms });
                goes_on = false;
            }
            None => goes_on = false,
        }
    }
    if let Some(output) = output {
        output.finish()?;
    }
    Ok(kept)
}

fn opened(ready: &Ready, plan: &htex_scene::Plan) -> Result<Output> {
    let output = Output::open(ready, plan)?;
    Ok(if ready.capabilities.paced { output } else { output.paced() })
}

/// Plays until an input line makes a request, then fades to silence.
fn play_until_wish(
    renderer: &mut Renderer,
    output: &mut Output,
    wishes: &Receiver<Wish>,
) -> Result<Option<Wish>> {
    let mut answer = None;
    let mut stopped = false;
    while output.step(renderer)? {
        // Continues with further blocks until the fade to silence is written.
        if stopped {
            continue;
        }
        let wish = wishes.try_recv();
        stopped = interrupted() || !matches!(wish, Err(TryRecvError::Empty));
        answer = wish.ok().filter(|_| !interrupted());
        if stopped {
            renderer.stop();
        }
    }
    Ok(answer)
}

/// Reads requests from the lines of standard input. Reports an invalid line on standard error.
fn wishes() -> Receiver<Wish> {
    let (sender, receiver) = channel();
    // A read cannot be interrupted, so the thread runs until the process ends.
    std::thread::spawn(move || {
        for line in std::io::stdin().lines().map_while(Result::ok) {
            let sent = wish(&line).map(|wish| sender.send(wish));
            match sent {
                None => crate::output::tell!("{line:?} is not +, -, ++, -- or an empty line"),
                Some(Err(_)) => return,
                Some(Ok(())) => {}
            }
        }
    });
    receiver
}

fn wish(line: &str) -> Option<Wish> {
    Some(match line.trim() {
        "+" => Wish::Change(STEP_DB),
        "-" => Wish::Change(-STEP_DB),
        "++" => Wish::Change(LARGE_STEP_DB),
        "--" => Wish::Change(-LARGE_STEP_DB),
        "" => Wish::Keep,
        _ => return None,
    })
}

/// Formats the drive as its largest voltage, and as V_g (the largest voltage divided by √2).
fn volts(drive_v: f64) -> String {
    format!("{drive_v:.1} V at most, V_g {:.2} V", drive_v / std::f64::consts::SQRT_2)
}
