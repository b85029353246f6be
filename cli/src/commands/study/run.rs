use std::fmt::{Display, Formatter};
use std::path::PathBuf;

use clap::Args;
use htex_base::files::{AtFile, OwnFolder};
use htex_base::finding::Severity;
use htex_lab::LabError;
use htex_lab::study::{
    Clock, Felt, Header, Plan, Session, SessionEnd, SimulatedParticipant, Study, check_files, run,
};
use htex_scene::file::Motion;
use serde::Serialize;
use serde_json::Value;

use super::asker::AskingArgs;
use super::clock::{FastClock, WallClock};
use super::felt::FeltArgs;
use super::rig::StudyRig;
use super::{cannot_run, open};
use crate::failure::{Exit, Failure, Result};
use crate::invocation::tool;
use crate::output::{print, print_json, shown, tell};
use crate::scenes::{ChoiceArgs, SceneArgs};
use crate::signals;

/// Run the session of a participant: play each trial on the device, ask for the rating, and store
/// the answer.
///
/// Each answer is a line of the file DIR/PARTICIPANT.jsonl. htex writes the line to disk before the
/// next trial begins. To continue a session that you left (q, Ctrl-C) or that was killed, run the
/// same command again. If the study, one of its assets or the device has changed since the session
/// began, htex refuses to continue. Therefore, all answers in a file belong to the same version of
/// the study.
#[derive(Args)]
pub(crate) struct Run {
    /// The study: study.toml
    study: PathBuf,

    /// Name of the participant [default with --simulated: all participants]
    #[arg(long, value_name = "NAME", required_unless_present = "simulated")]
    participant: Option<String>,

    /// Folder for the answers
    #[arg(short, long, value_name = "DIR", default_value = "answers")]
    output: PathBuf,

    #[command(flatten)]
    asking: AskingArgs,

    /// Simulate the participant's answers, with this seed of random numbers. Every file of answers
    /// then states that its answers are simulated
    #[arg(long, value_name = "SEED")]
    simulated: Option<u64>,

    /// Do not wait during rests, and play trials as fast as possible on devices without a clock,
    /// such as files
    #[arg(long, requires = "simulated")]
    fast: bool,

    /// Print JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    felt: FeltArgs,

    #[command(flatten)]
    choice: ChoiceArgs,

    #[command(flatten)]
    with: SceneArgs,
}

impl Run {
    pub(crate) fn run(self) -> Result {
        let study = open(&self.study)?;
        self.asking.check(&study, self.simulated.is_some())?;
        self.felt.check(&self.asking, self.simulated.is_some())?;
        let plan = Plan::new(&study);
        let participants = self.participants(&plan)?;
        self.check_files(&study)?;
        signals::ask();
        let mut sessions = Vec::new();
        for participant in &participants {
            let session = self.session(&study, &plan, participant)?;
            if !self.json {
                print(&session.to_string())?;
            }
            let is_done = session.done;
            sessions.push(session);
            if !is_done {
                tell!("note: {participant} is not done; run the same command to go on");
                break;
            }
        }
        if self.json {
            print_json(&sessions)?;
        }
        Ok(Exit::SUCCESS)
    }

    /// Refuses a study that would fail in the middle of a session.
    fn check_files(&self, study: &Study) -> Result<()> {
        let mut findings = Vec::new();
        // This path stands for the files of the trials. Their names are not known yet.
        let device = self.choice.to_override(Some(&self.output.join("trial.wav")), false)?;
        let loader = self.with.loader()?;
        check_files(study, &self.study, &loader.around(), &device, &mut findings)?;
        findings.retain(|finding| finding.severity == Severity::Error);
        if findings.is_empty() { Ok(()) } else { Err(cannot_run(&self.study, findings)) }
    }

    fn participants(&self, plan: &Plan) -> Result<Vec<String>> {
        let names = plan.participants.iter().map(|p| p.participant.clone());
        let names: Vec<String> = names.collect();
        match &self.participant {
            None => Ok(names),
            Some(name) if names.contains(name) => Ok(vec![name.clone()]),
            Some(name) => Err(LabError::NoParticipant {
                name: name.clone(),
                known: match &names[..] {
                    [first, .., last] if names.len() > 20 => format!("{first} to {last}"),
                    _ => names.join(", "),
                },
            }
            .into()),
        }
    }

    fn session(&self, study: &Study, plan: &Plan, participant: &str) -> Result<SessionReport> {
        let mut rig = self.rig(study, participant)?;
        let simulated = self.simulated.map(|seed| SimulatedParticipant::new(seed, participant));
        let Some(own) = plan.participant(participant) else {
            return Err(Failure::other(format_args!("{participant} has no plan")));
        };
        rig.felt =
            self.felt.open(study, &self.output, participant, &self.with.devices, self.fast)?;
        let device = rig.device_used()?;
        let mut clock: Box<dyn Clock> =
            if self.fast { Box::new(FastClock::default()) } else { Box::new(WallClock::new()) };
        let header = Header {
            begun: clock.date(),
            source: rig.felt.as_ref().and_then(Felt::used),
            simulated: simulated.as_ref().map(SimulatedParticipant::header),
            ..Header::new(study, &self.study, own, device, tool())?
        };
        let mut session = Session::open(study, own, &self.output, &header)?;
        // The page opens only after `Session::open` has accepted the session.
        let mut asking = match self.simulated {
            Some(_) => self.asking.nobody(),
            None => self.asking.open(study, participant)?,
        };
        rig.motions = asking.motions.take();
        let ended =
            run(&mut session, &mut rig, &mut *asking.asker, &mut *clock, simulated.as_ref())?;
        let (trials, all) = session.trials();
        Ok(SessionReport {
            done: ended == SessionEnd::Done,
            file: shown(session.file()),
            of: all,
            participant: participant.to_owned(),
            simulated: session.is_simulated(),
            trials,
        })
    }

    fn rig<'a>(&self, study: &'a Study, participant: &str) -> Result<StudyRig<'a>> {
        let mut device = self.choice.to_override(None, false)?;
        device.live = study.motion == Motion::Live;
        let asked = study.device.settings.get("format").and_then(Value::as_str);
        let format =
            device.settings.get("format").map(String::as_str).or(asked).unwrap_or("wav").to_owned();
        let folder = self.output.join(participant);
        let mut rig = StudyRig {
            study,
            path: self.study.clone(),
            loader: self.with.loader()?,
            device,
            format,
            motions: None,
            is_fast: self.fast,
            folder,
            answers: None,
            told: Default::default(),
            errors_db: Default::default(),
            ended: false,
            felt: None,
            playing: None,
        };
        if rig.plays_to_files()? {
            let answers = OwnFolder::private(&self.output);
            let made = answers.make_folder(participant.as_ref());
            made.writing(&rig.folder)?;
            rig.answers = Some(answers);
        }
        Ok(rig)
    }
}

/// How a session ended.
#[derive(Serialize)]
struct SessionReport {
    done: bool,
    file: String,
    of: usize,
    participant: String,
    simulated: bool,
    trials: usize,
}

impl Display for SessionReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { file, of, participant, trials, .. } = self;
        let who = if self.simulated { " (simulated)" } else { "" };
        writeln!(f, "{participant}{who}: {trials} of {of} trials, {file}")
    }
}
