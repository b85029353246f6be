//! Recording sessions that read files as fast as possible.

use std::fs;
use std::path::{Path, PathBuf};

use htex_author::Exploration;
use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_format::Quantity;
use htex_lab::LabError;
use htex_lab::record::{
    Format, Moment, Next, Replay, Requirements, Session, Setup, Signals, TakeReport, Tare,
    TrackerRows,
};

/// Sample rate of the recordings, hertz.
pub const RATE_HZ: f64 = 2_000.0;

/// What differs between sessions.
pub struct Settings {
    pub name: &'static str,
    pub seconds: f64,
    pub tare: Tare,
    pub target: Exploration,
    pub required: Requirements,
    pub attempts: u32,
    pub format: Format,
    pub stop_after: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            name: "take",
            seconds: 4.0,
            tare: Tare::Never,
            target: Exploration::default(),
            required: Requirements::NOTHING,
            attempts: 3,
            format: Format::Csv,
            stop_after: usize::MAX,
        }
    }
}

/// Writes a file with simulated takes of 4 s one after the other, each with its force (N) and at 80
/// mm/s.
pub fn sweeps(folder: &Path, forces_n: &[f64]) -> PathBuf {
    let takes = forces_n.iter().map(|force_n| take(*force_n, 4.0));
    source(folder, &takes.collect::<Vec<_>>().concat())
}

/// Writes a file to be recorded, with rows of forces (N) and positions (mm).
pub fn source(folder: &Path, rows: &[String]) -> PathBuf {
    let path = folder.join("source.csv");
    let text = format!("fx_n,fy_n,fz_n,x_mm,y_mm\n{}\n", rows.join("\n"));
    fs::write(&path, text).unwrap();
    path
}

/// Returns the rows of a simulated take with this force (N) and length (s), at 80 mm/s.
pub fn take(force_n: f64, seconds: f64) -> Vec<String> {
    let options = SimulationOptions::new(Surface::Vinyl)
        .with_rate_hz(RATE_HZ)
        .with_duration_s(seconds)
        .with_force_n(force_n);
    rows(&options)
}

/// Returns the rows of a simulated take.
pub fn rows(options: &SimulationOptions) -> Vec<String> {
    let mut csv = Vec::new();
    simulate(options).unwrap().write_csv(&mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let row = |line: &str| line.split_once(',').unwrap().1.to_owned();
    csv.lines().skip(2).map(row).collect()
}

pub fn record(folder: &Path, source: &Path, settings: &Settings) -> Result<TakeReport, LabError> {
    record_with(folder, source, settings, None)
}

/// Creates a session that records a file.
pub fn session(
    folder: &Path,
    source: &Path,
    settings: &Settings,
    tracker: Option<Box<dyn TrackerRows>>,
) -> Result<Session, LabError> {
    let source = open(source);
    let channels = &source.stream().channels;
    let signals = Signals::new("source.csv", channels, Vec::new(), None, Quantity::LateralForce)?;
    let setup = Setup {
        folder: folder.to_owned(),
        name: settings.name.to_owned(),
        seconds: settings.seconds,
        countdown_s: 0.0,
        tare: settings.tare,
        quantity: Quantity::LateralForce,
        target: settings.target,
        tolerance: 0.1,
        required: settings.required,
        attempts: settings.attempts,
        format: settings.format,
        tool: "test".to_owned(),
        source: "file:source.csv".to_owned(),
        map: None,
    };
    Session::new(setup, source, signals, tracker)
}

/// Records from a file, with a tracker.
pub fn record_with(
    folder: &Path,
    source: &Path,
    settings: &Settings,
    tracker: Option<Box<dyn TrackerRows>>,
) -> Result<TakeReport, LabError> {
    let mut session = session(folder, source, settings, tracker)?;
    let mut moments = 0;
    let mut watch = |_: &Moment<'_>| {
        moments += 1;
        if moments > settings.stop_after { Next::Stop } else { Next::Go }
    };
    session.record(&mut watch, &mut |_| ())
}

/// Opens a file as a source. A CSV without times gets the sample rate of the tests.
fn open(path: &Path) -> Box<dyn htex_device::Input> {
    use htex_device::{Adapter, Settings};
    let given = [("path", path.to_str().unwrap()), ("pace", "fast"), ("rate_hz", "2000")]
        .map(|(name, value)| (name.to_owned(), value.to_owned()));
    let settings = Settings::resolve(Replay.descriptor(), None, &given.into()).unwrap();
    Replay.open_input(&settings).unwrap()
}
