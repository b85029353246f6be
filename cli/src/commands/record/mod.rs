mod screen;

use std::path::PathBuf;

use clap::Args;
use htex_author::Exploration;
use htex_device::Source;
use htex_format::plain;
use htex_lab::record::{Guidance, Moment, Next, Outcome, Recorded, Session, Setup, recover};
use serde_json::json;

use crate::exit::Exit;
use crate::failure::Failure;
use crate::inputs::{self, InputArgs};
use crate::models::tool;
use crate::output::{print, print_json, tell, warn};
use crate::shown::shown;
use crate::signals;
use crate::sources;

use screen::Screen;

/// Record a finger on a surface under guidance: takes that leave their target are set aside and repeated.
///
/// Takes are DIR/NAME-001.csv and so on, with all settings in JSON beside them and the tracker's rows in DIR/tracker; takes that left
/// their target are in DIR/rejected, those that were cut short in DIR/incomplete. Each second is on disk before the next: a take that a
/// crash cut short is recovered when the command is run again.
#[derive(Args)]
pub(crate) struct Record {
    /// Where the signals come from: a recording that is replayed (file:rec.csv), or analog inputs of a National Instruments card
    /// (daq:Dev1/ai0:5)
    #[arg(long, value_name = "NAME:TARGET", help_heading = "Source")]
    source: String,

    /// A setting of the source, such as rate_hz=20000; may be given several times
    #[arg(long = "set", value_name = "NAME=VALUE", help_heading = "Source")]
    settings: Vec<String>,

    /// Replay files without waiting
    #[arg(long, help_heading = "Source")]
    fast: bool,

    #[command(flatten)]
    input: InputArgs,

    /// Name of the takes
    #[arg(long, value_name = "NAME", default_value = "take")]
    take: String,

    /// Length of a take
    #[arg(long, value_name = "S", default_value_t = 10.0)]
    seconds: f64,

    /// Time before each take, to find the motion [default: 3, with --fast 0]
    #[arg(long, value_name = "S")]
    countdown: Option<f64>,

    /// Subtract the means of the forces over the first second, without a finger on the surface
    #[arg(long)]
    tare: bool,

    /// Target speed, mm/s; needs the finger's motion
    #[arg(long, value_name = "MM_S")]
    target_speed: Option<f64>,

    /// Target normal force
    #[arg(long, value_name = "N")]
    target_force: Option<f64>,

    /// How far mean, minimum and maximum of a sweep's speed and force may be from the target, as a part of it
    #[arg(long, value_name = "PART", default_value_t = 0.1)]
    tolerance: f64,

    /// Most takes that are tried until one keeps to its target
    #[arg(long, value_name = "N", default_value_t = 10)]
    attempts: u32,

    /// Length of the strokes that the guidance shows
    #[arg(long, value_name = "MM", default_value_t = 80.0)]
    stroke: f64,

    /// The folder of the takes
    #[arg(short, long, value_name = "DIR", default_value = "recordings")]
    output: PathBuf,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Record {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let guidance = self.guidance()?;
        let recovered = recover(&self.output)?;
        for take in &recovered {
            tell!("htex: recovered {}", said(take));
        }
        let source = self.open()?;
        let signals = self.input.signals(&self.source, &*source)?;
        warn(signals.warnings());
        let tracker = self.input.tracker()?;
        let mut session = Session::new(self.setup(), source, signals, tracker)?;
        signals::ask();
        let mut screen = Screen::new(guidance);
        let mut takes = Vec::new();
        let mut watch = |moment: &Moment| {
            screen.show(moment);
            match signals::interrupted() {
                true => Next::Stop,
                false => Next::Go,
            }
        };
        let recorded = session.record(&mut watch, &mut |take| {
            tell!("{}", said(take));
            takes.push(take.clone());
        });
        screen.end();
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

    fn open(&self) -> Result<Box<dyn Source>, Failure> {
        if self.fast && !self.source.starts_with("file:") {
            let sentence = "--fast replays files; other sources come at their own pace";
            return Err(Failure::Usage(sentence.to_owned()));
        }
        let given = inputs::settings(&self.source, "--set", &self.settings, self.fast)?;
        Ok(sources::open(&self.source, &given)?)
    }

    fn guidance(&self) -> Result<Guidance, Failure> {
        if !(self.stroke > 0.0 && self.stroke <= 1e4) {
            let sentence = format!("--stroke {}: above 0 and at most 10,000 mm", self.stroke);
            return Err(Failure::Usage(sentence));
        }
        Ok(Guidance {
            speed_mm_s: self.target_speed,
            force_n: self.target_force,
            tolerance: self.tolerance,
            stroke_mm: self.stroke,
        })
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
            tare: self.tare,
            quantity: self.input.quantity(),
            target: Exploration {
                speed_mm_s: self.target_speed,
                force_n: self.target_force,
            },
            tolerance: self.tolerance,
            attempts: self.attempts,
            format: self.input.format().unwrap_or_default(),
            tool: tool(),
            source: self.source.clone(),
            map: self.input.map.clone(),
        }
    }
}

/// A take in a line, and its findings in a line each.
fn said(take: &Recorded) -> String {
    let file = shown(&take.file);
    let what = match take.outcome {
        Outcome::Kept => "kept".to_owned(),
        Outcome::Rejected => format!("rejected, {}", plain(&take.verdict.reasons.join("; "))),
        Outcome::Incomplete => format!("incomplete, {:.2} s", take.recorded_s),
    };
    let measured = |what: &str, unit: &str, measured: Option<htex_lab::record::Measured>| {
        measured.map_or(String::new(), |m| {
            format!(
                "; {what} {:.3} {unit} ({:.3} to {:.3})",
                m.mean, m.min, m.max
            )
        })
    };
    let verdict = &take.verdict;
    format!(
        "{file}: {what}{}{}; {} segments{}",
        measured("speed", "mm/s", verdict.speed_mm_s),
        measured("force", "N", verdict.force_n),
        verdict.segments,
        verdict
            .findings
            .iter()
            .map(|f| format!("\n  {}", plain(f)))
            .collect::<String>(),
    )
}
