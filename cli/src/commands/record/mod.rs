mod guide;
mod screen;

use std::cell::RefCell;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use htex_author::Exploration;
use htex_base::finding::plain;
use htex_device::Input;
use htex_lab::LabError;
use htex_lab::record::{
    Moment, Next, Outcome, Requirements, Session, Setup, TakeReport, Tare, recover,
};
use serde_json::json;

use crate::devices::{DeviceArgs, SettingArgs};
use crate::failure::{Exit, Failure, Result};
use crate::inputs::{InputArgs, paced};
use crate::invocation::tool;
use crate::output::{print, print_json, shown, tell, warn};
use crate::signals;

use guide::{Guide, GuideArgs};

/// Record a finger on a surface, with guidance
///
/// A take is one recording with the duration --seconds. If the speed or the force of a take leaves
/// its target, or if the finger slides for too short a time, htex rejects the take and records
/// another take. The command ends after the first good take.
///
/// htex stores takes as DIR/NAME-001.csv and so on. A JSON file next to each take contains all
/// settings, and DIR/tracker contains the positions that the tracker measured. DIR/rejected
/// contains the rejected takes, and DIR/incomplete the incomplete takes. During a take, htex writes
/// the recorded samples to disk every second. After a crash, the next run of the command recovers
/// the data on disk.
#[derive(Args)]
pub(crate) struct Record {
    /// Source of the signals: a recording to replay (file:rec.csv), analog inputs of a National
    /// Instruments card (daq:Dev1/ai0:5), or another source in `htex device list`
    #[arg(long, value_name = "NAME:TARGET", help_heading = "Source")]
    source: String,

    #[command(flatten)]
    settings: SettingArgs,

    /// Replay a recording (file:…) as fast as possible instead of in real time
    #[arg(long, help_heading = "Source")]
    fast: bool,

    #[command(flatten)]
    devices: DeviceArgs,

    #[command(flatten)]
    input: InputArgs,

    /// Name of the takes; the names of their files begin with this name
    #[arg(long, value_name = "NAME", default_value = "take")]
    take: String,

    /// Duration of a take, s
    #[arg(long, value_name = "S", default_value_t = 10.0)]
    seconds: f64,

    /// Countdown before each take, s, during which the finger starts to move [default: 3, or 0 with
    /// --fast]
    #[arg(long, value_name = "S")]
    countdown: Option<f64>,

    /// Subtract from each signal its offset, i.e. its mean while no finger is on the surface.
    /// Positions and speeds are not changed. htex measures the offsets for one second before the
    /// first take (once) or before each take (each)
    #[arg(
        long,
        value_enum,
        value_name = "WHEN",
        num_args = 0..=1,
        default_missing_value = "once"
    )]
    tare: Option<TareArg>,

    /// Target speed, mm/s; needs a source or tracker that measures the finger's motion
    #[arg(long, value_name = "MM_S")]
    target_speed: Option<f64>,

    /// Target normal force, N
    #[arg(long, value_name = "N")]
    target_force: Option<f64>,

    /// Allowed difference from the target speed and force, as a fraction of the target. In the
    /// middle of each sweep, the mean, the minimum and the maximum of speed and force must be
    /// within this tolerance
    #[arg(long, value_name = "PART", default_value_t = 0.1)]
    tolerance: f64,

    /// Accept a take only if the finger slides on target for at least this fraction of the take.
    /// The finger is on target if its force is within the tolerance and its speed is in the allowed
    /// range. This range goes from half of the target speed to the upper limit of the tolerance.
    /// Without a target, htex counts all sliding. No take reaches a fraction of 1, because the
    /// finger turns between sweeps. 0 turns this test off
    #[arg(long, value_name = "PART", default_value_t = Requirements::USUAL_ON_TARGET)]
    min_on_target: f64,

    /// Accept a take only if it has at least this number of complete sweeps. 0 turns this test off
    /// [default: half of the strokes that the guidance shows in a take, without the first and the
    /// last stroke, e.g. 4 for 10 s at 80 mm/s; 0 without a target speed]
    #[arg(long, value_name = "N")]
    min_sweeps: Option<u32>,

    /// Maximum number of takes; if all of them are rejected, the command fails
    #[arg(long, value_name = "N", default_value_t = 10)]
    attempts: u32,

    #[command(flatten)]
    guide: GuideArgs,

    /// Folder for the takes
    #[arg(short, long, value_name = "DIR", default_value = "recordings")]
    output: PathBuf,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum TareArg {
    Once,
    Each,
}

impl Record {
    pub(crate) fn run(self) -> Result {
        let mut setup = self.setup();
        let guidance = self.guide.guidance(&setup)?;
        setup.required.sweeps =
            self.min_sweeps.unwrap_or_else(|| Requirements::usual_sweeps(&guidance, setup.seconds));
        let recovered = recover(&self.output)?;
        for take in &recovered {
            tell!("htex: recovered {}", said(take));
        }
        let source = self.open()?;
        let rate_hz = source.stream().rate_hz;
        let signals = self.input.signals(&self.source, &*source)?;
        warn(signals.warnings());
        let tracker = self.input.tracker()?;
        let mut session = Session::new(setup.clone(), source, signals, tracker)?;
        signals::ask();
        let mut guide = self.guide.open(&setup, guidance, rate_hz)?;
        let mut takes = Vec::new();
        let recorded = record(&mut session, &mut guide, &mut takes);
        guide.end(&recorded);
        // Printed even after an error, because the complete takes are on disk.
        if self.json {
            print_json(&json!({
                "recovered": recovered,
                "takes": takes,
                "kept": recorded.as_ref().ok(),
            }))?;
        }
        let recorded = recorded?;
        if !self.json {
            print(&format!("htex fit {}\n", recorded.fit.join(" ")))?;
        }
        Ok(Exit::SUCCESS)
    }

    fn open(&self) -> Result<Box<dyn Input>> {
        if self.fast && !self.source.starts_with("file:") {
            return Err(Failure::usage(
                "--fast replays files; other sources come at their own pace",
            ));
        }
        let given = paced(&self.source, self.settings.given()?, self.fast);
        self.devices.open_input(&self.source, self.settings.profile(), &given)
    }

    fn setup(&self) -> Setup {
        Setup {
            folder: self.output.clone(),
            name: self.take.clone(),
            seconds: self.seconds,
            countdown_s: match (self.countdown, self.fast) {
                (Some(countdown_s), _) => countdown_s,
                (None, true) => 0.0,
                (None, false) => 3.0,
            },
            tare: match self.tare {
                None => Tare::Never,
                Some(TareArg::Once) => Tare::Once,
                Some(TareArg::Each) => Tare::Each,
            },
            quantity: self.input.quantity(),
            target: Exploration { speed_mm_s: self.target_speed, force_n: self.target_force },
            tolerance: self.tolerance,
            required: Requirements { on_target: self.min_on_target, ..Requirements::NOTHING },
            attempts: self.attempts,
            format: self.input.format.unwrap_or_default(),
            tool: tool(),
            source: self.source.clone(),
            map: self.input.map.clone(),
        }
    }
}

/// Records with guidance until a take is accepted. Adds each recorded take to `takes`, also a
/// rejected one.
fn record(
    session: &mut Session,
    guide: &mut Guide,
    takes: &mut Vec<TakeReport>,
) -> Result<TakeReport, LabError> {
    if guide.wait_for_start() == Next::Stop {
        return Err(LabError::Left { kept: None });
    }
    // Both closures use the guide, and the session holds both closures at the same time.
    let guide = RefCell::new(guide);
    let mut watch = |moment: &Moment<'_>| guide.borrow_mut().show(moment);
    session.record(&mut watch, &mut |take| {
        guide.borrow_mut().told(take);
        tell!("{}", said(take));
        takes.push(take.clone());
    })
}

/// Describes a take in one line, and each of its findings in another line.
fn said(take: &TakeReport) -> String {
    let file = shown(&take.file);
    let what = match take.outcome {
        Outcome::Kept => "kept".to_owned(),
        Outcome::Rejected => format!("rejected, {}", plain(&take.verdict.reasons.join("; "))),
        Outcome::Incomplete => format!("incomplete, {:.2} s", take.recorded_s),
    };
    let measured = |what: &str, unit: &str, measured: Option<htex_lab::record::MeanRange>| {
        measured.map_or(String::new(), |m| {
            format!("; {what} {:.3} {unit} ({:.3} to {:.3})", m.mean, m.min, m.max)
        })
    };
    let verdict = &take.verdict;
    let coverage = verdict.coverage.map_or(String::new(), |coverage| {
        format!(
            "; on target {:.0} %, complete sweeps {}",
            100.0 * coverage.on_target,
            coverage.sweeps
        )
    });
    format!(
        "{file}: {what}{}{}{coverage}; {} segments{}",
        measured("speed", "mm/s", verdict.speed_mm_s),
        measured("force", "N", verdict.force_n),
        verdict.segments,
        verdict.findings.iter().map(|f| format!("\n  {}", plain(f))).collect::<String>(),
    )
}
