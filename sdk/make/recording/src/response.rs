//! The frequency response of a recording setup to a lateral force.

use std::path::Path;
use std::{fmt, io};

use htex_dsp::grid::Band;

use crate::error::{Fault, ReadError, ReadProblem};
use crate::formats::csv::Csv;
use crate::input::{InputFile, file_name};
use crate::sheet::{Columns, Sheet};
use crate::value_limit::ValueLimit;

/// Limits for the numbers of a response: frequency (hertz), magnitude above 0, and phase (radians).
const SMALLEST: f64 = 1e-9;
const LARGEST: f64 = 1e9;
/// Gain above which a warning is given, decibels. The setup attenuated such frequencies to a third
/// or less, so that their signal is mostly noise.
const RAISED_DB: f64 = 10.0;

/// Frequency response of a recording setup, given at a list of frequencies.
///
/// The three vectors have equal lengths of at least 2; the frequencies increase strictly.
#[derive(Debug, Clone, PartialEq)]
pub struct SetupResponse {
    /// Frequencies, hertz, strictly increasing, not negative.
    pub frequency_hz: Vec<f64>,
    /// Ratio of output to input at each frequency, unitless, not negative.
    pub magnitude: Vec<f64>,
    /// Phase at each frequency, radians, unwrapped.
    pub phase_rad: Vec<f64>,
}

impl SetupResponse {
    /// Returns the real and the imaginary part of the response at a frequency in hertz. Magnitude
    /// and unwrapped phase are interpolated linearly in frequency. Below the first frequency and
    /// above the last frequency, they are constant.
    ///
    /// ```
    /// # use htex_recording::SetupResponse;
    /// let response = SetupResponse {
    ///     frequency_hz: vec![20.0, 1000.0],
    ///     magnitude: vec![1.0, 2.0],
    ///     phase_rad: vec![0.0, 0.0],
    /// };
    /// assert_eq!(response.value_at(510.0), (1.5, 0.0));
    /// assert_eq!(response.value_at(5000.0), (2.0, 0.0));
    /// ```
    #[must_use]
    pub fn value_at(&self, frequency_hz: f64) -> (f64, f64) {
        // Magnitude and phase are interpolated instead of the complex numbers, whose mean is too
        // small if the phase changes between two points.
        let above = self.frequency_hz.partition_point(|f| *f <= frequency_hz);
        let last = self.frequency_hz.len().saturating_sub(1);
        let (low, high) = (above.saturating_sub(1), above.min(last));
        let weight = if low == high {
            0.0
        } else {
            let (f0, f1) = (self.frequency_hz[low], self.frequency_hz[high]);
            (frequency_hz - f0) / (f1 - f0)
        };
        let between = |values: &[f64]| values[low] + weight * (values[high] - values[low]);
        let (magnitude, phase) = (between(&self.magnitude), between(&self.phase_rad));
        (magnitude * libm::cos(phase), magnitude * libm::sin(phase))
    }

    /// Returns the largest magnitude in a band, edges included.
    #[must_use]
    pub fn largest_in(&self, band: Band) -> f64 {
        let edges = [band.low_hz, band.high_hz].map(|hz| self.value_at(hz));
        let inside = |hz: &f64| band.contains(*hz);
        let both = self.frequency_hz.iter().zip(&self.magnitude);
        let sampled = both.filter(|(hz, _)| inside(hz)).map(|(_, m)| *m);
        let at_edges = edges.into_iter().map(|(re, im)| libm::hypot(re, im));
        sampled.chain(at_edges).fold(0.0, f64::max)
    }
}

impl SetupResponse {
    /// Writes the columns `frequency_hz,magnitude,phase_rad`. Writes each number with the fewest
    /// digits that read back as the same floating-point number.
    ///
    /// # Errors
    /// Returns an error if the writer fails.
    pub fn write_csv(&self, out: &mut impl io::Write) -> io::Result<()> {
        writeln!(out, "frequency_hz,magnitude,phase_rad")?;
        let numbers = self.magnitude.iter().zip(&self.phase_rad);
        for (hz, (magnitude, phase_rad)) in self.frequency_hz.iter().zip(numbers) {
            writeln!(out, "{hz},{magnitude},{phase_rad}")?;
        }
        Ok(())
    }
}

/// The frequency ranges in which the setup's response is weak: dividing a spectrum by the response
/// raises the spectrum by more than 10 dB.
#[derive(Debug, Clone, PartialEq)]
pub struct RaisedRanges {
    /// For each range, its lowest and highest frequency in hertz, and its largest gain in decibels.
    pub stretches: Vec<(f64, f64, f64)>,
}

/// Returns the frequency ranges in which gains exceed 10 dB, or `None` if no gain does. `gains`
/// contains one factor (not decibels) for each frequency in `frequency_hz`.
pub fn raised(frequency_hz: &[f64], gains: impl Iterator<Item = f64>) -> Option<RaisedRanges> {
    let mut stretches: Vec<(f64, f64, f64)> = Vec::new();
    let mut goes_on = false;
    for (&hz, gain) in frequency_hz.iter().zip(gains) {
        let gain_db = 20.0 * libm::log10(gain);
        let is_raised = gain_db > RAISED_DB;
        match stretches.last_mut().filter(|_| goes_on) {
            Some(last) if is_raised => *last = (last.0, hz, last.2.max(gain_db)),
            None if is_raised => stretches.push((hz, hz, gain_db)),
            _ => {}
        }
        goes_on = is_raised;
    }
    (!stretches.is_empty()).then_some(RaisedRanges { stretches })
}

impl fmt::Display for RaisedRanges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (low_hz, high_hz, most_db)) in self.stretches.iter().enumerate() {
            let comma = if i > 0 { ", " } else { "" };
            write!(f, "{comma}{low_hz} to {high_hz} Hz by up to {most_db:.1} dB")?;
        }
        Ok(())
    }
}

/// Reads a setup response from a CSV with the columns `frequency_hz`, `magnitude` and optionally
/// `phase_rad` (default zero).
///
/// # Errors
/// Returns the same errors as [`read_recording`](crate::read_recording) for a CSV. Also returns an
/// error if a number is out of range. Frequencies must be from 0 to 1e9 Hz and increase from row to
/// row. Magnitudes must be 0 or from 1e-9 to 1e9. Phases must be from -1e9 to 1e9 radians. The
/// error names the line.
pub fn read_response(path: &Path) -> Result<SetupResponse, ReadError> {
    let read = InputFile::file(path).and_then(response);
    read.map_err(|fault| fault.in_file(&file_name(path)))
}

/// Reads a setup response from bytes in memory; `file` is the file's name in messages.
///
/// # Errors
/// Returns the same errors as [`read_response`].
pub fn response_from_bytes(file: &str, bytes: &[u8]) -> Result<SetupResponse, ReadError> {
    let read = InputFile::bytes(Path::new(file), bytes).and_then(response);
    read.map_err(|fault| fault.in_file(file))
}

fn response(opened: InputFile<'_>) -> Result<SetupResponse, Fault> {
    let mut csv = Csv::open(opened, ValueLimit::default())?;
    let columns = csv.columns();
    let mut wanted = vec![column(columns, "frequency_hz")?, column(columns, "magnitude")?];
    wanted.extend(column(columns, "phase_rad").ok());
    let mut columns = csv.numbers(&wanted)?.columns.into_iter();
    let frequency_hz = columns.next().unwrap_or_default();
    let magnitude = columns.next().unwrap_or_default();
    check(&csv, &frequency_hz, &magnitude)?;
    let phase_rad = columns.next().unwrap_or_else(|| vec![0.0; frequency_hz.len()]);
    if let Some(row) = phase_rad.iter().position(|phase| phase.abs() > LARGEST) {
        let problem = format!("the phase {} rad is beyond {LARGEST}", phase_rad[row]);
        return Err(ReadProblem::Invalid(problem).at_place(csv.place(row)));
    }
    Ok(SetupResponse { frequency_hz, magnitude, phase_rad: unwrapped(phase_rad) })
}

fn column(columns: &Columns, name: &str) -> Result<usize, ReadProblem> {
    let is_named = |column: &usize| columns.name(*column).eq_ignore_ascii_case(name);
    let found = (0..columns.width()).find(is_named);
    found.ok_or_else(|| {
        columns.refuse(format!(
            "a setup response needs a column {name:?}; its header is frequency_hz,magnitude[,phase_rad]"
        ))
    })
}

fn check(csv: &Csv<'_>, frequency_hz: &[f64], magnitude: &[f64]) -> Result<(), Fault> {
    let refuse =
        |row: usize, problem: String| Err(ReadProblem::Invalid(problem).at_place(csv.place(row)));
    for (row, (frequency, magnitude)) in frequency_hz.iter().zip(magnitude).enumerate() {
        if *frequency < 0.0 {
            return refuse(row, format!("the frequency {frequency} Hz is negative"));
        }
        if row > 0 && *frequency <= frequency_hz[row - 1] {
            return refuse(
                row,
                format!(
                    "the frequency {frequency} Hz follows {} Hz; frequencies must increase on every row",
                    frequency_hz[row - 1]
                ),
            );
        }
        if *frequency > LARGEST
            || !(*magnitude == 0.0 || (SMALLEST..=LARGEST).contains(&magnitude.abs()))
        {
            return refuse(
                row,
                format!(
                    "the magnitude {magnitude} at {frequency} Hz is out of range; write 0, or {SMALLEST} to {LARGEST}"
                ),
            );
        }
        if *magnitude < 0.0 {
            return refuse(
                row,
                format!(
                    "the magnitude {magnitude} is negative; write the sign as a phase_rad of pi"
                ),
            );
        }
    }
    Ok(())
}

/// Removes jumps of more than half a turn from the phase.
fn unwrapped(mut phase_rad: Vec<f64>) -> Vec<f64> {
    let turn = 2.0 * std::f64::consts::PI;
    let mut previous = phase_rad.first().copied().unwrap_or(0.0);
    for phase in &mut phase_rad {
        *phase -= turn * libm::round((*phase - previous) / turn);
        previous = *phase;
    }
    phase_rad
}
