use std::io::BufWriter;
use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use htex_author::SetupResponse;
use htex_author::settings::GivenLaw;
use htex_author::simulate::{Departures, FreeMotion, SimulationOptions, Surface, simulate};

use crate::failure::{Exit, Failure, Result};
use crate::located;
use crate::output::OutputFile;
use crate::outputs::check_outputs;

/// Simulate a recording of a surface
///
/// Use the recording to try out htex. The signal imitates a finger that slides over a surface: it
/// is the sum of friction, the texture at the finger's position, the resonance of a rig, and sensor
/// noise. The recording is not a measurement, and its file states that it is simulated.
#[derive(Args)]
pub(crate) struct Simulate {
    /// The surface: sandpaper, fine-fabric, coarse-fabric, corrugated-paper or vinyl
    #[arg(long)]
    surface: Surface,

    /// Seed of the random numbers: the same seed gives the same recording
    #[arg(long, default_value_t = 0)]
    seed: u64,

    /// Where to write the recording: CSV with columns t_s,fx_n,fy_n,fz_n,x_mm,y_mm
    #[arg(short, long, value_name = "CSV", value_parser = located::OUTPUT)]
    output: PathBuf,

    /// Where to write the simulated rig's frequency response, for `htex fit --frf`: CSV with
    /// columns frequency_hz,magnitude,phase_rad
    #[arg(long, value_name = "CSV", value_parser = located::OUTPUT)]
    frf: Option<PathBuf>,

    /// Duration, s
    #[arg(long, default_value_t = 10.0, value_name = "S")]
    seconds: f64,

    /// Sample rate, Hz
    #[arg(long, default_value_t = 20_000.0, value_name = "HZ")]
    rate: f64,

    /// How the finger moves: in back-and-forth sweeps at one speed and force, or in free strokes of
    /// random speed and force
    #[arg(long, value_enum, default_value = "sweeps")]
    motion: MotionArg,

    /// Scanning speed, mm/s [default: 80]. For --motion free, give the lowest and the highest speed
    /// [default: 36:280]
    #[arg(long, value_name = "MM_S")]
    speed: Option<Range>,

    /// Normal force, N [default: 0.4]. For --motion free, give the lowest and the highest force
    /// [default: 0.15:3.8]
    #[arg(long, value_name = "N")]
    force: Option<Range>,

    /// Exponents of the power laws by which frequencies and level depend on speed and force:
    /// frequency-speed=X,level-speed=X,level-force=X. At 80 mm/s and 0.4 N, the exponents have no
    /// effect. The default exponents 1, 0 and 1 describe a rigid relief
    #[arg(long, value_name = "LAW")]
    law: Option<GivenLaw>,

    /// Change of the texture's level during the recording, dB per minute
    #[arg(long, value_name = "DB", default_value_t = 0.0, allow_negative_numbers = true)]
    drift: f64,

    /// Fraction of the time in which the finger is off the surface, 0 to 0.8. Each lift takes 50 to
    /// 250 ms
    #[arg(long, value_name = "PART", default_value_t = 0.0)]
    lifted: f64,

    /// Write the true spectra of the surface to this JSON file (only with --motion free). The file
    /// contains the magnitudes over the range of speeds, and the rule by which the magnitudes
    /// depend on the force
    #[arg(long, value_name = "JSON")]
    truth: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum MotionArg {
    Sweeps,
    Free,
}

/// One number, or the lowest and the highest: `80`, `36:280`.
#[derive(Clone, Copy)]
struct Range([f64; 2]);

impl FromStr for Range {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |part: &str| {
            let number = part.trim().parse::<f64>();
            number.map_err(|_| format!("{part:?} is not a number; write 80, or 36:280"))
        };
        let (low, high) = text.split_once(':').unwrap_or((text, text));
        Ok(Self([number(low)?, number(high)?]))
    }
}

impl Simulate {
    pub(crate) fn run(self) -> Result {
        let outputs = [self.output.as_path()]
            .into_iter()
            .chain(self.frf.as_deref())
            .chain(self.truth.as_deref());
        check_outputs(outputs, [])?;
        let options = self.options()?;
        // The spectra are computed first, so that errors are found before anything is written.
        let truth = self
            .truth
            .as_ref()
            .map(|file| Ok::<_, Failure>((file, options.truth().map_err(Failure::usage)?)));
        let truth = truth.transpose()?;
        let simulation = simulate(&options).map_err(Failure::usage)?;
        let write = |file: &mut std::fs::File| simulation.write_csv(&mut BufWriter::new(file));
        OutputFile::Named(&self.output).replace(write)?;
        if let Some((file, truth)) = truth {
            let write = |file: &mut std::fs::File| truth.write_json(&mut BufWriter::new(file));
            OutputFile::Named(file).replace(write)?;
        }
        if let Some(frf) = &self.frf {
            let response = options.setup_response().map_err(Failure::usage)?;
            write_response(&response, OutputFile::Named(frf))?;
        }
        Ok(Exit::SUCCESS)
    }

    fn departures(&self) -> Departures {
        let (usual, law) = (Departures::default(), self.law.unwrap_or_default());
        usual
            .with_frequency_speed(law.frequency_speed.unwrap_or(usual.frequency_speed))
            .with_level_speed(law.level_speed.unwrap_or(usual.level_speed))
            .with_level_force(law.level_force.unwrap_or(usual.level_force))
            .with_drift_db_per_min(self.drift)
            .with_lifted(self.lifted)
    }

    fn options(&self) -> Result<SimulationOptions> {
        let options = SimulationOptions::new(self.surface)
            .with_seed(self.seed)
            .with_rate_hz(self.rate)
            .with_duration_s(self.seconds)
            .with_departures(self.departures());
        if self.motion == MotionArg::Free {
            let mut free = FreeMotion::default();
            if let Some(Range(speed_mm_s)) = self.speed {
                free = free.with_speed_mm_s(speed_mm_s);
            }
            if let Some(Range(force_n)) = self.force {
                free = free.with_force_n(force_n);
            }
            return Ok(options.with_free_motion(free));
        }
        if self.truth.is_some() {
            return Err(Failure::Usage(
                "--truth: the true spectrum is known for --motion free only".to_owned(),
            ));
        }
        let one = |range: Option<Range>, name: &str, otherwise: f64| match range {
            None => Ok(otherwise),
            Some(Range([low, high])) if low == high => Ok(low),
            Some(_) => Err(Failure::Usage(format!(
                "--{name}: sweeps have one value; a range needs --motion free"
            ))),
        };
        Ok(options
            // The defaults are the paper's condition, as in `htex demo`.
            .with_speed_mm_s(one(self.speed, "speed", 80.0)?)
            .with_force_n(one(self.force, "force", 0.4)?))
    }
}

/// Writes a setup response for `--frf`.
pub(super) fn write_response(response: &SetupResponse, to: OutputFile<'_>) -> Result<()> {
    let write = |file: &mut std::fs::File| response.write_csv(&mut BufWriter::new(file));
    Ok(to.replace(write)?)
}
