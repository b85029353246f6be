//! Measures a response from records.

use htex_base::finding::Hint;

use super::average::{average, count_used, cut, scale_of};
use super::error::{Channel, ResponseError};
use super::estimator::Bin;
use super::measured::MeasuredResponse;
use super::notices::{notices, without_hits};
use super::options::ResponseOptions;
use super::pieces::Cut;
use super::record::Record;
use super::spectra::Spectra;

/// Measures the frequency response of a setup from records of its input and output.
///
/// # Errors
/// - An option is out of range.
/// - There are no records, they have different sample rates, or a record is shorter than a window.
/// - There are no hits, or fewer than two usable ones.
/// - A magnitude is out of the range that a response file may hold.
pub fn measure(
    records: &[Record],
    options: &ResponseOptions,
) -> Result<MeasuredResponse, ResponseError> {
    let rate_hz = common_rate(records)?;
    let len = options.check(rate_hz)?;
    let cuts: Vec<Vec<Cut>> =
        records.iter().map(|record| cut(record, len, options)).collect::<Result<_, _>>()?;
    let without_hits = without_hits(records, &cuts);
    let used = count_used(records, &cuts, options)?;
    let (spectra, outlasting) = average(records, &cuts, len, options);
    let resolution_hz = rate_hz / len as f64;
    let bins = band(options, resolution_hz, spectra.gxx.len())?;
    // `average` has divided both channels by their scales. This factor undoes it.
    let scale = scale_of(records, Channel::Output) / scale_of(records, Channel::Input);
    let in_band = in_band(&spectra, &bins);
    let mut measured = MeasuredResponse {
        estimator: options.estimator,
        rate_hz,
        window_s: len as f64 / rate_hz,
        resolution_hz,
        averages: used,
        pieces: cuts.into_iter().flatten().map(|cut| cut.piece).collect(),
        frequency_hz: bins.clone().map(|bin| bin as f64 * resolution_hz).collect(),
        magnitude: in_band.iter().map(|bin| scale * bin.magnitude(options.estimator)).collect(),
        phase_rad: unwrapped(in_band.iter().map(Bin::phase_rad)),
        coherence: in_band.iter().map(Bin::coherence).collect(),
        relative_error: Vec::new(),
        peak: None,
        warnings: Vec::new(),
    };
    measured.finish(options)?;
    measured.warnings = notices(&measured, options, outlasting);
    measured.warnings.extend(without_hits);
    Ok(measured)
}

fn common_rate(records: &[Record]) -> Result<f64, ResponseError> {
    let first = records.first().ok_or(ResponseError::Nothing)?;
    match records.iter().find(|record| record.rate_hz() != first.rate_hz()) {
        None => Ok(first.rate_hz()),
        Some(other) => Err(ResponseError::Rates {
            first: first.file().to_owned(),
            first_hz: first.rate_hz(),
            file: other.file().to_owned(),
            rate_hz: other.rate_hz(),
        }),
    }
}

/// Returns the range of frequency bins in the band.
fn band(
    options: &ResponseOptions,
    resolution_hz: f64,
    bins: usize,
) -> Result<std::ops::Range<usize>, ResponseError> {
    // A bin at an edge of the band belongs to it even if the quotient was rounded.
    let low = (options.low_hz / resolution_hz * (1.0 - 1e-12)).ceil() as usize;
    let high = (options.high_hz / resolution_hz * (1.0 + 1e-12)).floor() as usize;
    let range = low..high.saturating_add(1).min(bins);
    if range.len() < 2 {
        return Err(ResponseError::Option {
            option: "the highest frequency (Hz)",
            hint: Hint::new(&["high"]),
            value: options.high_hz,
            problem: format!(
                "there must be two points of the grid of {resolution_hz} Hz from {} Hz to it; widen the band or lengthen the window",
                options.low_hz
            ),
        });
    }
    Ok(range)
}

fn in_band(spectra: &Spectra, bins: &std::ops::Range<usize>) -> Vec<Bin> {
    let power = |values: &[f64]| values[bins.clone()].iter().sum::<f64>();
    let (input_power, output_power) = (power(&spectra.gxx), power(&spectra.gyy));
    let bin = |bin: usize| Bin {
        gxx: spectra.gxx[bin],
        gyy: spectra.gyy[bin],
        gxy: spectra.gxy[bin],
        input_power,
        output_power,
    };
    bins.clone().map(bin).collect()
}

/// Removes jumps of more than half a turn from phases.
fn unwrapped(phases: impl Iterator<Item = f64>) -> Vec<f64> {
    let turn = 2.0 * std::f64::consts::PI;
    let mut previous = None;
    let mut follow = |phase: f64| {
        let before = *previous.get_or_insert(phase);
        let phase = phase - turn * libm::round((phase - before) / turn);
        previous = Some(phase);
        phase
    };
    phases.map(&mut follow).collect()
}
