use std::path::Path;

use clap::Args;
use htex_check::model::{BLOCKS, Cost, Subject, bench};
use htex_host::{LoadedModel, Origin, Registry, WasmLimits};

use crate::commands::plugin::named::named;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::plugins::PluginArgs;

/// Measure what models cost: nanoseconds a sample, built in, as native plugins and as WASM.
///
/// Each model is timed in every way in which it can be loaded, at its own rate. All runs are
/// interleaved, so that other load on the machine affects all of them equally. WASM modules are
/// timed twice: with the default limits, which use deadlines, and with counted instructions.
#[derive(Args)]
pub(crate) struct Bench {
    /// Models by short name, id or file [default: all built-in models]
    #[arg(value_name = "FILE|ID")]
    models: Vec<String>,

    #[command(flatten)]
    plugins: PluginArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Bench {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let costs = bench(&self.subjects()?).map_err(Failure::other)?;
        if self.json {
            print_json(&costs)?;
        } else {
            print(&table(&costs))?;
        }
        Ok(Exit::SUCCESS)
    }

    fn subjects(&self) -> Result<Vec<Subject>, Failure> {
        let registry = self.plugins.registry_quietly()?;
        let builtin = Registry::builtin();
        let mut names = self.models.clone();
        if names.is_empty() {
            let all = builtin.models().iter();
            names.extend(all.map(|model| model.short_name().to_owned()));
        }
        let mut subjects = Vec::new();
        for name in &names {
            let mut models = vec![];
            if Path::new(name).is_file() {
                models.push(named(name, &self.plugins)?);
            } else {
                let id = registry.find(name)?.id().to_owned();
                models.extend(registry.all(&id).cloned());
                models.sort_by_key(|model| order(model.origin()));
            }
            for model in models {
                add(&mut subjects, &model, &self.plugins.limits())?;
            }
        }
        Ok(subjects)
    }
}

/// Sorts the built-in model first, because the others are compared with it.
fn order(origin: &Origin) -> u8 {
    match origin {
        Origin::Builtin => 0,
        Origin::Native(_) => 1,
        _ => 2,
    }
}

/// Adds a model. A WASM module is added a second time with counted instructions.
fn add(
    subjects: &mut Vec<Subject>,
    loaded: &LoadedModel,
    limits: &WasmLimits,
) -> Result<(), Failure> {
    let subject = |way: &str, loaded: &LoadedModel| Subject {
        model: loaded.short_name().to_owned(),
        way: way.to_owned(),
        loaded: loaded.clone(),
    };
    match loaded.origin() {
        Origin::Wasm(file) => {
            subjects.push(subject("wasm", loaded));
            let counted = limits.clone().with_fuel(limits.fuel.unwrap_or(u64::MAX / 2));
            let counted = LoadedModel::from_file_within(file, &counted)?;
            subjects.push(subject("wasm, counted", &counted));
        }
        Origin::Builtin => subjects.push(subject("built in", loaded)),
        _ => subjects.push(subject("native", loaded)),
    }
    Ok(())
}

fn table(costs: &[Cost]) -> String {
    let width = costs.iter().map(|c| c.model.len()).max().unwrap_or(0).max(5);
    let mut text = format!("  {:width$}  {:13}", "model", "way");
    for block in BLOCKS {
        text += &format!("  {:>22}", format!("blocks of {block}"));
    }
    text += &format!("  {:>7}  {:>13}\n", "a call", "start/ms");
    for cost in costs {
        text += &format!("  {:width$}  {:13}", cost.model, cost.way);
        for block in &cost.blocks {
            let t = block.per_sample;
            let times = format!("{:.1} {:.1}±{:.1}", t.min_ns, t.median_ns, t.spread_ns);
            text += &format!("  {times:>16} {:4.2}x", block.ratio);
        }
        let start = cost
            .start
            .map_or(String::new(), |start| format!("{:.0} -> {:.1}", start.cold_ms, start.warm_ms));
        text += &format!("  {:>7.0}  {start:>13}\n", cost.per_call_ns);
    }
    text + "ns a sample: least, median ± half the distance between the quartiles, and the least over \
            that of the first line of the model; ns a call; from the file to the first sample, \
            compiled and from the cache\n"
}
