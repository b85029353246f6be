use std::fmt::{Display, Formatter};
use std::path::Path;

use clap::Args;
use htex_check::model::{BLOCKS, Cost, Subject, bench};
use htex_host::{LoadedModel, Origin, Registry, WasmLimits};
use serde::Serialize;

use crate::failure::{Failure, Result};
use crate::output::show;
use crate::plugins::{PluginArgs, way};

/// Measure the time per sample of built-in models, native plugins and WASM modules.
///
/// Times each model at the model's own sample rate, in every form that htex finds (built in, native
/// library, WASM module). The runs of all models are interleaved, so that other load on the machine
/// affects all models equally. A WASM module is timed twice: once with the limits that are set (by
/// default, on the time of a call), and once with counted instructions, as with --wasm-limit
/// fuel=N.
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
    pub(crate) fn run(self) -> Result {
        let costs = bench(&self.subjects()?).map_err(Failure::other)?;
        show(&CostTable(costs), self.json)
    }

    fn subjects(&self) -> Result<Vec<Subject>> {
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
                models.push(self.plugins.find(name)?);
            } else {
                let id = registry.find(name)?.id().to_owned();
                models.extend(registry.all(&id).cloned());
                models.sort_by_key(|model| way(model.origin()).0);
            }
            for model in models {
                add(&mut subjects, &model, &self.plugins.limits())?;
            }
        }
        Ok(subjects)
    }
}

/// Adds a model. A WASM module is added a second time with counted instructions.
fn add(subjects: &mut Vec<Subject>, loaded: &LoadedModel, limits: &WasmLimits) -> Result<()> {
    let subject = |way: &str, loaded: &LoadedModel| Subject {
        model: loaded.short_name().to_owned(),
        way: way.to_owned(),
        loaded: loaded.clone(),
    };
    subjects.push(subject(way(loaded.origin()).1, loaded));
    if let Origin::Wasm(file) = loaded.origin() {
        let counted = limits.clone().with_fuel(limits.fuel.unwrap_or(u64::MAX / 2));
        let counted = LoadedModel::from_file_within(file, &counted)?;
        subjects.push(subject("wasm, counted", &counted));
    }
    Ok(())
}

/// The times of models.
#[derive(Serialize)]
#[serde(transparent)]
struct CostTable(Vec<Cost>);

impl Display for CostTable {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let costs = &self.0;
        let width = costs.iter().map(|c| c.model.len()).max().unwrap_or(0).max(5);
        write!(f, "  {:width$}  {:13}", "model", "way")?;
        for block in BLOCKS {
            write!(f, "  {:>22}", format!("blocks of {block}"))?;
        }
        writeln!(f, "  {:>7}  {:>13}", "a call", "start/ms")?;
        for cost in costs {
            write!(f, "  {:width$}  {:13}", cost.model, cost.way)?;
            for block in &cost.blocks {
                let t = block.per_sample;
                let times = format!("{:.1} {:.1}±{:.1}", t.min_ns, t.median_ns, t.spread_ns);
                write!(f, "  {times:>16} {:4.2}x", block.ratio)?;
            }
            let start = cost.start.map_or(String::new(), |start| {
                format!("{:.0} -> {:.1}", start.cold_ms, start.warm_ms)
            });
            writeln!(f, "  {:>7.0}  {start:>13}", cost.per_call_ns)?;
        }
        writeln!(
            f,
            "nanoseconds a sample: minimum, median ± half the interquartile range, and the minimum relative to \
             the model's first line; nanoseconds a call; milliseconds from the file to the first sample, \
             compiled and from the cache"
        )
    }
}
