use std::path::PathBuf;

use clap::Args;
use htex_author::Exploration;
use htex_author::by_hand::{ByHand, make};
use htex_author::settings::{GivenFluctuation, Metadata};
use htex_format::{Condition, Quantity, UnknownName};

use crate::assets::{check_metadata, write_and_show};
use crate::failure::{Failure, Result};
use crate::invocation::tool;
use crate::located;
use crate::outputs::check_outputs;
use crate::plugins::PluginArgs;
use crate::recordings::parse_condition;

/// Make a texture from parameters
///
/// The asset states that its parameters were set by hand. `htex plugin info MODEL` lists a model's
/// parameters with their units and ranges.
#[derive(Args)]
pub(crate) struct Make {
    /// The model, by short name or id
    #[arg(long, value_name = "ID")]
    model: String,

    /// The model's parameters, e.g. alpha=2 beta=5. Separate the values of a list with commas:
    /// cepstrum=-12,3.1,0.4
    #[arg(long, value_name = "NAME=NUMBER", num_args = 1.., required = true)]
    set: Vec<String>,

    /// RMS of the samples, in the unit of --quantity (newtons for a force)
    #[arg(long, value_name = "RMS")]
    level: f64,

    /// Speed and normal force for which the parameters are valid, e.g. speed=80,force=0.4 [default:
    /// unknown]
    #[arg(long, value_name = "speed=MM_S,force=N")]
    at: Option<String>,

    /// Physical quantity of the samples
    #[arg(long, default_value = "lateral_force", value_parser = quantity)]
    quantity: Quantity,

    /// How much the strength of the texture varies over time: two standard deviations in decibels,
    /// for variations at 0.5 to 8 Hz and at 8 to 32 Hz, each from 0 to 7.97, e.g. 3,1.5 [default:
    /// 0,0]
    #[arg(long, value_name = "SLOW,FAST", allow_hyphen_values = true)]
    fluctuation: Option<GivenFluctuation>,

    /// The asset to write
    #[arg(short, long, value_name = "HTEX", value_parser = located::OUTPUT)]
    output: PathBuf,

    #[command(flatten)]
    metadata: Metadata,

    #[command(flatten)]
    plugins: PluginArgs,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl Make {
    pub(crate) fn run(self) -> Result {
        let files = self.plugins.files().iter().map(PathBuf::as_path);
        check_outputs([self.output.as_path()], files)?;
        check_metadata(&self.metadata)?;
        let registry = self.plugins.registry()?;
        let model = registry.find(&self.model)?;
        let at = self
            .at
            .as_deref()
            .map(|text| parse_condition(text, Exploration::default()))
            .transpose()?
            .unwrap_or_default();
        let stem = self.output.file_stem().unwrap_or_default();
        let mut texture = ByHand::new(stem.to_string_lossy(), self.level, tool())
            .with_condition(Condition {
                speed_mm_s: at.speed_mm_s,
                force_n: at.force_n,
                ..Condition::default()
            })
            .with_quantity(self.quantity);
        for text in &self.set {
            let (name, values) = parameter(text)?;
            if texture.values.insert(name.clone(), values).is_some() {
                return Err(Failure::Usage(format!(
                    "--set {text}: {name} is given twice; leave one out"
                )));
            }
        }
        let mut asset = make(model, &texture).map_err(Failure::usage)?;
        self.metadata.apply(&mut asset.manifest);
        if let Some(fluctuation) = self.fluctuation {
            fluctuation.apply(&mut asset.manifest);
        }
        write_and_show(&self.output, &asset, self.json)
    }
}

/// Reads `NAME=NUMBER,…`.
fn parameter(text: &str) -> Result<(String, Vec<f64>)> {
    let wrong = |what: &str| {
        Failure::Usage(format!("--set {text}: {what}; it looks like alpha=2 or cepstrum=-12,3.1"))
    };
    let (name, numbers) = text.split_once('=').ok_or_else(|| wrong("there is no `=`"))?;
    let numbers = numbers.split(',').map(|number| number.trim().parse().ok());
    let numbers: Option<Vec<f64>> = numbers.collect();
    let numbers = numbers
        .filter(|all| all.iter().all(|x| x.is_finite()))
        .ok_or_else(|| wrong("what follows is not a number"))?;
    Ok((name.trim().to_owned(), numbers))
}

fn quantity(text: &str) -> Result<Quantity, String> {
    text.parse()
        .map_err(|unknown: UnknownName| format!("it is one of {}", unknown.known.join(", ")))
}
