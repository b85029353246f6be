use std::process::ExitCode;

use clap::Args;
use htex_check::{BLOCKS, Cost, Timing, bench};

use crate::commands::plugin::named::named;
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::plugins::PluginArgs;

/// Measure what models cost: nanoseconds a sample, median and spread.
///
/// All models are timed in one interleaved run, at their own rates, in blocks of 16 to 1024 samples.
/// Name a model and its files to see what a loader costs: `htex plugin bench sbeta libhtex_sbeta.so`.
#[derive(Args)]
pub(crate) struct Bench {
    /// Models by short name, id or file
    #[arg(required = true, value_name = "FILE|ID")]
    models: Vec<String>,

    #[command(flatten)]
    plugins: PluginArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Bench {
    pub(crate) fn run(self) -> Result<ExitCode, Failure> {
        let mut models = Vec::new();
        for name in self.models {
            let model = named(&name, &self.plugins)?;
            models.push((name, model));
        }
        let costs = bench(&models).map_err(Failure::Other)?;
        if self.json {
            print_json(&costs)?;
        } else {
            print(&table(&costs))?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn table(costs: &[Cost]) -> String {
    let width = costs
        .iter()
        .map(|c| c.model.len())
        .max()
        .unwrap_or(0)
        .max(5);
    let mut text = format!("  {:width$}  rate/Hz", "model");
    for block in BLOCKS {
        text += &format!("  {:>15}", format!("blocks of {block}"));
    }
    text += &format!("  {:>15}\n", "call for one");
    for cost in costs {
        text += &format!("  {:width$}  {:>7.0}", cost.model, cost.rate_hz);
        for timing in cost.per_sample.iter().chain([&cost.per_call]) {
            let Timing {
                median_ns,
                spread_ns,
            } = timing;
            text += &format!("  {:>15}", format!("{median_ns:.1} ± {spread_ns:.1}"));
        }
        text += "\n";
    }
    text + "ns a sample, and ns a call: median ± half the distance between the quartiles\n"
}
