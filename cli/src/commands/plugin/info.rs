use std::fmt::{Display, Formatter};

use clap::Args;
use htex_host::{Descriptor, Field, FitOption, Kind, Scale};
use serde::Serialize;

use crate::failure::Result;
use crate::output::{show, tamed};
use crate::plugins::PluginArgs;

/// Show a model's descriptor: parameters and fit options, with units and ranges.
#[derive(Args)]
pub(crate) struct Info {
    /// The model, by short name, id or file
    #[arg(value_name = "FILE|ID")]
    model: String,

    #[command(flatten)]
    plugins: PluginArgs,

    /// Print the descriptor as JSON
    #[arg(long)]
    json: bool,
}

impl Info {
    pub(crate) fn run(self) -> Result {
        show(&ModelInfo(self.plugins.find(&self.model)?.descriptor().clone()), self.json)
    }
}

/// A model's descriptor, in the form in which the command prints it.
#[derive(Serialize)]
#[serde(transparent)]
struct ModelInfo(Descriptor);

impl Display for ModelInfo {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Descriptor { id, name, version, summary, fields, options, only_named, .. } =
            tamed(&self.0);
        let fields: String = fields.iter().map(field).collect();
        let mut options: String = options.iter().map(option).collect();
        if options.is_empty() {
            options += "  none\n";
        }
        let used = if only_named { "Used only if you name it.\n" } else { "" };
        write!(
            f,
            "{name} ({id} {version})\n{summary}\n{used}\nparameters\n{fields}\nfit options\n{options}"
        )
    }
}

fn field(field: &Field) -> String {
    let many = match field.kind {
        Kind::Scalar => String::new(),
        Kind::List { max_len } => format!(", up to {max_len}"),
    };
    let (range, name) = (range(field.min, field.max, &field.unit), &field.name);
    let usual = field.usual.map_or_else(String::new, |usual| {
        let range = self::range(usual.min, usual.max, &field.unit);
        let scale = if usual.scale == Scale::Log { ", logarithmic" } else { "" };
        format!("      usually {range}{scale}\n")
    });
    format!("  {name}: {range}{many}\n      {}\n{usual}", field.description)
}

fn option(option: &FitOption) -> String {
    let FitOption { name, default, .. } = option;
    let values = if option.choices.is_empty() {
        let range = range(option.min, option.max, &option.unit);
        format!("{range} [{default}]")
    } else {
        let first = option.choices.get(*default as usize).map(String::as_str).unwrap_or_default();
        format!("{} [{first}]", option.choices.join(" or "))
    };
    let above = option.not_above.as_ref();
    let above = above.map_or_else(String::new, |other| format!(", none above `{other}`"));
    let swept = |values: &[f64], how: &str| {
        let texts: Vec<String> = values.iter().filter_map(|value| option.text(*value)).collect();
        if texts.is_empty() {
            return String::new();
        }
        format!("      swept{how}: {}{above}\n", texts.join(", "))
    };
    let (together, alone) = (swept(&option.sweep, ""), swept(&option.sweep_alone, " alone"));
    format!("  {name}: {values}\n      {}\n{together}{alone}", option.description)
}

/// Formats a range with its unit. A plain number has no unit.
fn range(min: f64, max: f64, unit: &str) -> String {
    match unit {
        "1" => format!("{min} to {max}"),
        unit => format!("{min} to {max} {unit}"),
    }
}
