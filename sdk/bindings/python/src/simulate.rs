//! Simulated recordings.

use htex_author::settings::GivenLaw;
use htex_author::simulate::{Departures, FreeMotion, Simulation, SimulationOptions, Surface};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::{option, raised};

/// A column of a recording: its name and its values.
type Column<'py> = (&'static str, Bound<'py, PyArray1<f64>>);

/// Frequencies (hertz), magnitudes and phases (radians) of a response.
type Response = [Vec<f64>; 3];

/// A speed or force of the simulated finger: one value, or the lowest and highest value.
#[derive(FromPyObject)]
pub(crate) enum Range {
    Between(f64, f64),
    #[pyo3(transparent)]
    One(f64),
}

/// Simulates a recording. Returns its columns, the same columns as a CSV file, and the response of
/// the simulated recording setup.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    surface: &str,
    seed: u64,
    seconds: f64,
    rate_hz: f64,
    free: bool,
    speed_mm_s: Option<Range>,
    force_n: Option<Range>,
    departures: (&str, f64, f64),
) -> PyResult<(Vec<Column<'py>>, Bound<'py, PyBytes>, Response)> {
    let surface = surface.parse::<Surface>().map_err(raised)?;
    let options = SimulationOptions::new(surface)
        .with_seed(seed)
        .with_rate_hz(rate_hz)
        .with_duration_s(seconds)
        .with_departures(departing(departures)?);
    let options = moved(options, free, speed_mm_s, force_n)?;
    let (simulation, csv) = py.detach(|| written(&options))?;
    let response = options.setup_response().map_err(raised)?;
    let columns = [
        ("t_s", simulation.t_s),
        ("fx_n", simulation.fx_n),
        ("fy_n", simulation.fy_n),
        ("fz_n", simulation.fz_n),
        ("x_mm", simulation.x_mm),
        ("y_mm", simulation.y_mm),
    ]
    .map(|(name, values)| (name, values.into_pyarray(py)));
    let response = [response.frequency_hz, response.magnitude, response.phase_rad];
    Ok((columns.into(), PyBytes::new(py, &csv), response))
}

/// Combines the exponents of a law (as JSON), the drift of the level in decibels per minute, and
/// the fraction of time during which the finger is off the surface.
fn departing((law, drift_db_per_min, lifted): (&str, f64, f64)) -> PyResult<Departures> {
    let law: GivenLaw =
        serde_json::from_str(law).map_err(|error| option(format!("law: {error}")))?;
    let usual = Departures::default();
    Ok(usual
        .with_frequency_speed(law.frequency_speed.unwrap_or(usual.frequency_speed))
        .with_level_speed(law.level_speed.unwrap_or(usual.level_speed))
        .with_level_force(law.level_force.unwrap_or(usual.level_force))
        .with_drift_db_per_min(drift_db_per_min)
        .with_lifted(lifted))
}

fn moved(
    options: SimulationOptions,
    free: bool,
    speed_mm_s: Option<Range>,
    force_n: Option<Range>,
) -> PyResult<SimulationOptions> {
    if free {
        let usual = FreeMotion::default();
        let both = |range: Option<Range>, usual| match range {
            None => usual,
            Some(Range::One(value)) => [value, value],
            Some(Range::Between(low, high)) => [low, high],
        };
        let free = usual
            .with_speed_mm_s(both(speed_mm_s, usual.speed_mm_s))
            .with_force_n(both(force_n, usual.force_n));
        return Ok(options.with_free_motion(free));
    }
    let one = |range: Option<Range>, name: &str, usual| match range {
        None => Ok(usual),
        Some(Range::One(value)) => Ok(value),
        Some(Range::Between(..)) => {
            Err(option(format!("{name}: sweeps have one value; a range needs motion=\"free\"")))
        }
    };
    let speed = one(speed_mm_s, "speed_mm_s", options.speed_mm_s)?;
    let force = one(force_n, "force_n", options.force_n)?;
    Ok(options.with_speed_mm_s(speed).with_force_n(force))
}

fn written(options: &SimulationOptions) -> PyResult<(Simulation, Vec<u8>)> {
    let simulation = htex_author::simulate::simulate(options).map_err(raised)?;
    let mut csv = Vec::new();
    simulation.write_csv(&mut csv)?;
    Ok((simulation, csv))
}
