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
/// A take is a recording of --seconds. If the speed or the force of a take leaves its target, or if
/// the finger slides too little, htex sets the take aside and records another one. The command ends
/// with the first good take.
///
/// htex stores takes as DIR/NAME-001.csv and so on. A JSON file next to each take contains all
/// settings, and DIR/tracker contains the rows of the tracker. Takes that were set aside are in
/// DIR/rejected, and incomplete takes in DIR/incomplete. During a take, htex writes to disk every
/// second. If a crash interrupts a take, the next run of the command recovers what was written.
#[derive(Args)]
pub(crate) struct Record {
    /// Source of the signals: a recording to replay (file:rec.csv), analog inputs of a National
    /// Instruments card (daq:Dev1/ai0:5), or another source in `htex device list`
    #[arg(long, value_name = "NAME:TARGET", help_heading = "Source")]
    source: String,

    #[command(flatten)]
    settings: SettingArgs,

    /// Replay a file as fast as possible, without waiting
    #[arg(long, help_heading = "Source")]
    fast: bool,

    #[command(flatten)]
    devices: DeviceArgs,

    #[command(flatten)]
    input: InputArgs,

    /// Name of the takes, with which their file names begin
    #[arg(long, value_name = "NAME", default_value = "take")]
    take: String,

    /// Duration of a take, s
    #[arg(long, value_name = "S", default_value_t = 10.0)]
    seconds: f64,

    /// Countdown before each take, s, during which the finger starts to move [default: 3, or 0 with
    /// --fast]
    #[arg(long, value_name = "S")]
    countdown: Option<f64>,

    /// Subtract from each signal its offset: its mean while no finger is on the surface. Positions
    /// and speeds stay as they are. htex measures the offsets for one second, before the first take
    /// (once) or before each take (each)
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
    /// middles of the sweeps, the mean, the minimum and the maximum of speed and force must be
    /// within this tolerance
    #[arg(long, value_name = "PART", default_value_t = 0.1)]
    tolerance: f64,

    /// Accept a take only if the finger slides on target for at least this fraction of the take. On
    /// target means: with the target force, and with a speed from half of the target to the
    /// tolerance above the target. Without a target, any sliding counts. 0 turns this test off. The
    /// fraction is never 1, because the finger turns between sweeps
    #[arg(long, value_name = "PART", default_value_t = Requirements::USUAL_ON_TARGET)]
    min_on_target: f64,

    /// Accept a take only if it has at least this number of complete sweeps. 0 turns this test off
    /// [default: half of the strokes that the guidance shows in a take, not counting the first and
    /// the last stroke, e.g. 4 for 10 s at 80 mm/s; 0 without a target speed]
    #[arg(long, value_name = "N")]
    min_sweeps: Option<u32>,

    /// Give up after this many takes
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
