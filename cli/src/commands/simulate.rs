use std::io::BufWriter;
use std::path::{Path, PathBuf};

use clap::Args;
use htex_author::SetupResponse;
use htex_author::simulate::{SimulationError, SimulationOptions, Surface, simulate};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::outputs::check_outputs;

/// Write a simulated recording of a finger sliding over a surface.
///
/// A physically motivated signal for experiments: to-and-fro sweeps, friction, a texture read
/// at the finger's position, setup resonance, sensor noise. It is not a measurement, and is labelled so.
#[derive(Args)]
pub(crate) struct Simulate {
    /// The surface: sandpaper, fine-fabric, coarse-fabric, corrugated-paper or vinyl
    #[arg(long)]
    surface: Surface,

    /// The same seed gives the same recording
    #[arg(long, default_value_t = 0)]
    seed: u64,

    /// Where to write it: CSV with columns t_s,fx_n,fy_n,fz_n,x_mm,y_mm
    #[arg(short, long, value_name = "CSV")]
    output: PathBuf,

    /// Where to write the simulated rig's response as well: CSV with columns
    /// frequency_hz,magnitude,phase_rad, for `htex fit --frf`
    #[arg(long, value_name = "CSV")]
    frf: Option<PathBuf>,

    /// Length, s
    #[arg(long, default_value_t = 10.0, value_name = "S")]
    seconds: f64,

    /// Sampling rate, Hz
    #[arg(long, default_value_t = 20_000.0, value_name = "HZ")]
    rate: f64,

    /// Scanning speed, mm/s
    #[arg(long, default_value_t = 80.0, value_name = "MM_S")]
    speed: f64,

    /// Normal force, N
    #[arg(long, default_value_t = 0.4, value_name = "N")]
    force: f64,
}

impl Simulate {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let outputs = [self.output.as_path()]
            .into_iter()
            .chain(self.frf.as_deref());
        check_outputs(outputs, [])?;
        let options = SimulationOptions::new(self.surface)
            .with_seed(self.seed)
            .with_rate_hz(self.rate)
            .with_duration_s(self.seconds)
            .with_speed_mm_s(self.speed)
            .with_force_n(self.force);
        let usage = |error: SimulationError| Failure::Usage(error.to_string());
        let simulation = simulate(&options).map_err(usage)?;
        let write = |file: &mut std::fs::File| simulation.write_csv(&mut BufWriter::new(file));
        htex_format::replace_file(&self.output, write)
            .map_err(|error| Failure::write(&self.output, error))?;
        if let Some(frf) = &self.frf {
            write_response(&options.setup_response().map_err(usage)?, frf)?;
        }
        Ok(Exit::SUCCESS)
    }
}

/// Writes a setup response for `--frf`.
pub(super) fn write_response(response: &SetupResponse, path: &Path) -> Result<(), Failure> {
    let write = |file: &mut std::fs::File| response.write_csv(&mut BufWriter::new(file));
    htex_format::replace_file(path, write).map_err(|error| Failure::write(path, error))
}
