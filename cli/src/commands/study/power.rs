use clap::Args;
use htex_statistics::{Power as Plan, PowerResult};
use serde::Serialize;

use crate::exit::Exit;
use crate::failure::Failure;
use crate::output::{print, print_json};

/// Find out how many participants a study needs, or what it finds with a given number.
///
/// The F-test of repeated measures within factors of G*Power 3.1, for one group: lambda = f² N m ε / (1 - ρ), with (m - 1) ε and
/// (N - 1) (m - 1) ε degrees of freedom.
#[derive(Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct Power {
    /// Effect size: Cohen's f; 0.1 is small, 0.25 medium, 0.4 large
    #[arg(long, value_name = "F")]
    effect: f64,

    /// Measurements of each participant: textures times models
    #[arg(long, value_name = "M")]
    measurements: usize,

    /// Power to reach: the probability of finding the effect [default: 0.8]
    #[arg(long, value_name = "P")]
    power: Option<f64>,

    /// Compute the power of this many participants instead
    #[arg(long, value_name = "N", conflicts_with = "power")]
    participants: Option<usize>,

    /// Significance level
    #[arg(long, value_name = "A", default_value_t = 0.05)]
    alpha: f64,

    /// Correlation among the measurements of a participant
    #[arg(long, value_name = "R", default_value_t = 0.5)]
    correlation: f64,

    /// Correction for nonsphericity, 1 / (M - 1) to 1
    #[arg(long, value_name = "E", default_value_t = 1.0)]
    epsilon: f64,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The result, as JSON.
#[derive(Serialize)]
struct Summary<'a> {
    participants: usize,
    power: f64,
    effect_f: f64,
    measurements: usize,
    alpha: f64,
    correlation: f64,
    epsilon: f64,
    lambda: f64,
    df: [f64; 2],
    critical_f: f64,
    method: &'a str,
}

const METHOD: &str = "F-test of repeated measures within factors, one group, as G*Power 3.1: lambda = f^2 N m epsilon / (1 - rho), degrees of freedom \
     (m - 1) epsilon and (N - 1) (m - 1) epsilon";

impl Power {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let plan = Plan {
            effect_f: self.effect,
            measurements: self.measurements,
            alpha: self.alpha,
            correlation: self.correlation,
            epsilon: self.epsilon,
        };
        let found = match self.participants {
            Some(participants) => plan.with_participants(participants),
            None => plan.participants_for(self.power.unwrap_or(0.8)),
        };
        let found = found.map_err(of_error)?;
        if self.json {
            print_json(&summary(&plan, &found))?;
        } else {
            print(&text(&found))?;
        }
        Ok(Exit::SUCCESS)
    }
}

/// A setting out of range is wrong usage.
fn of_error(error: htex_statistics::StatisticsError) -> Failure {
    match error {
        htex_statistics::StatisticsError::Setting { .. } => Failure::Usage(error.to_string()),
        _ => Failure::Other(error.to_string()),
    }
}

fn summary(plan: &Plan, found: &PowerResult) -> Summary<'static> {
    Summary {
        participants: found.participants,
        power: found.power,
        effect_f: plan.effect_f,
        measurements: plan.measurements,
        alpha: plan.alpha,
        correlation: plan.correlation,
        epsilon: plan.epsilon,
        lambda: found.lambda,
        df: found.df,
        critical_f: found.critical_f,
        method: METHOD,
    }
}

fn text(found: &PowerResult) -> String {
    let [df1, df2] = found.df;
    format!(
        "{} participants: power {:.4}\nF({df1}, {df2}) above {:.4}, lambda {:.4}\n{METHOD}\n",
        found.participants, found.power, found.critical_f, found.lambda
    )
}
