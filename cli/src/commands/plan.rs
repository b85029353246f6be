use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use htex_author::report::{Chain, ChainStage};
use htex_base::files::AtFile;
use htex_scene::{Costs, Plan as Planned};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::output::{print, print_json, warn, write_file};
use crate::scenes::{ChoiceArgs, SceneArgs, costs, costs_file};

/// Show which stages a scene needs, and why
///
/// Nothing is played. Costs are in nanoseconds per sample of the device.
#[derive(Args)]
pub(crate) struct Plan {
    /// The scene
    #[arg(value_parser = located::ASSET)]
    scene: PathBuf,

    /// Measure the costs on this machine first, and keep them for later plans
    #[arg(long)]
    measure: bool,

    /// Draw the chain
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
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let ready = self.with.open(&self.scene, &self.choice.to_override(None, true)?)?;
        let costs = if self.measure { self.measured()? } else { costs() };
        let plan = ready.plan(&costs)?;
        if let Some(file) = &self.svg {
            ready.check_output(file)?;
            write_file(file, drawing(&self.scene.display().to_string(), &plan).as_bytes())?;
        }
        if self.json {
            print_json(&plan)?;
        } else {
            print(&text(&plan))?;
        }
        Ok(Exit::SUCCESS)
    }

    fn measured(&self) -> Result<Costs, Failure> {
        let machine = format!("{} {}", std::env::consts::ARCH, std::env::consts::OS);
        let costs = Costs::measure(&self.with.models()?, &machine)?;
        match costs_file() {
            Some(file) => costs.save(&file).writing(&file)?,
            None => warn(&["no cache folder was found to keep the costs in".to_owned()]),
        }
        Ok(costs)
    }
}

/// Returns a stage's name, with the index of its surface if it belongs to one.
fn name(name: &str, surface: Option<usize>) -> String {
    surface.map_or_else(|| name.to_owned(), |i| format!("{name} [{i}]"))
}

fn text(plan: &Planned) -> String {
    let moves =
        if plan.constant { "nothing changes while it plays" } else { "it follows the finger" };
    let mut text = format!("{} Hz, {moves}\n\n  ns/sample  stage\n", plan.rate_hz);
    for stage in &plan.stages {
        let (name, reason) = (name(stage.name, stage.surface), &stage.reason);
        let _ = writeln!(text, "  {:9.2}  {name:18} {reason}", stage.ns_per_sample);
    }
    let _ = writeln!(text, "  {:9.2}  the renderer itself", plan.renderer_ns);
    let _ = writeln!(text, "  {:9.2}  in all", plan.ns_per_sample_total);
    if !plan.left_out.is_empty() {
        text += "\nleft out\n";
    }
    for out in &plan.left_out {
        let name = name(out.name, out.surface);
        let _ = writeln!(text, "             {name:18} {}", out.reason);
    }
    text += "\n";
    for chosen in &plan.representation {
        let (surface, model, why) = (chosen.surface, &chosen.model, &chosen.why);
        let _ = writeln!(text, "surface {surface} is played by {model}: {why}");
    }
    let _ = writeln!(text, "costs: {}", plan.costs);
    for note in &plan.notes {
        let _ = writeln!(text, "note: {note}");
    }
    text
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
