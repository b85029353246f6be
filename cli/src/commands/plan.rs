use std::fmt::{Display, Formatter};
use std::path::PathBuf;

use clap::Args;
use htex_author::report::{Chain, ChainStage};
use htex_base::files::AtFile;
use htex_scene::{Costs, Plan as Planned};
use serde::Serialize;

use crate::failure::Result;
use crate::located;
use crate::output::{show, warn, write_file};
use crate::scenes::{ChoiceArgs, SceneArgs, costs, costs_file};

/// Show which stages a scene needs, and why
///
/// Prints the processing stages with which htex would play the scene, and why each stage is needed
/// or left out. Also prints the time that each stage takes, in nanoseconds per sample of the
/// device. The command plays nothing.
#[derive(Args)]
pub(crate) struct Plan {
    /// The scene
    #[arg(value_parser = located::ASSET)]
    scene: PathBuf,

    /// Measure the times of the stages on this machine first, and store these times for later plans
    #[arg(long)]
    measure: bool,

    /// Draw the chain of stages as an SVG picture
    #[arg(long, value_name = "SVG", value_parser = located::OUTPUT)]
    svg: Option<PathBuf>,

    /// Print JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    choice: ChoiceArgs,

    #[command(flatten)]
    with: SceneArgs,
}

impl Plan {
    pub(crate) fn run(self) -> Result {
        let ready = self.with.open(&self.scene, &self.choice.to_override(None, true)?)?;
        let costs = if self.measure { self.measured()? } else { costs() };
        let plan = ready.plan(&costs)?;
        if let Some(file) = &self.svg {
            ready.check_output(file)?;
            write_file(file, drawing(&self.scene.display().to_string(), &plan).as_bytes())?;
        }
        show(&PlanReport(plan), self.json)
    }

    fn measured(&self) -> Result<Costs> {
        let machine = format!("{} {}", std::env::consts::ARCH, std::env::consts::OS);
        let costs = Costs::measure(&self.with.models()?, &machine)?;
        match costs_file() {
            Some(file) => costs.save(&file).writing(&file)?,
            None => warn(&["no cache folder was found to keep the costs in"]),
        }
        Ok(costs)
    }
}

/// Returns a stage's name, with the index of its surface if it belongs to one.
fn name(name: &str, surface: Option<usize>) -> String {
    surface.map_or_else(|| name.to_owned(), |i| format!("{name} [{i}]"))
}

/// A plan, in the form in which the command prints it.
#[derive(Serialize)]
#[serde(transparent)]
struct PlanReport(Planned);

impl Display for PlanReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let plan = &self.0;
        let moves =
            if plan.constant { "nothing changes while it plays" } else { "it follows the finger" };
        writeln!(f, "{} Hz, {moves}\n\n  ns/sample  stage", plan.rate_hz)?;
        for stage in &plan.stages {
            let (name, reason) = (name(stage.name, stage.surface), &stage.reason);
            writeln!(f, "  {:9.2}  {name:18} {reason}", stage.ns_per_sample)?;
        }
        writeln!(f, "  {:9.2}  the renderer itself", plan.renderer_ns)?;
        writeln!(f, "  {:9.2}  in all", plan.ns_per_sample_total)?;
        if !plan.left_out.is_empty() {
            writeln!(f, "\nleft out")?;
        }
        for out in &plan.left_out {
            writeln!(f, "             {:18} {}", name(out.name, out.surface), out.reason)?;
        }
        writeln!(f)?;
        for chosen in &plan.representation {
            let (surface, model, why) = (chosen.surface, &chosen.model, &chosen.why);
            writeln!(f, "surface {surface} is played by {model}: {why}")?;
        }
        writeln!(f, "costs: {}", plan.costs)?;
        plan.notes.iter().try_for_each(|note| writeln!(f, "note: {note}"))
    }
}

fn drawing(title: &str, plan: &Planned) -> String {
    let stage = |stage: &htex_scene::PlannedStage| ChainStage {
        name: name(stage.name, stage.surface),
        reason: stage.reason.clone(),
        rate_hz: stage.rate_hz,
        ns_per_sample: stage.ns_per_sample,
    };
    let out = |out: &htex_scene::OmittedEffect| (name(out.name, out.surface), out.reason.clone());
    let chain = Chain {
        title: title.to_owned(),
        stages: plan.stages.iter().map(stage).collect(),
        left_out: plan.left_out.iter().map(out).collect(),
    };
    chain.to_svg()
}
