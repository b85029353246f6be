//! The texture spectrum of a recording (paper, Texture processing).

use std::borrow::Cow;

use htex_dsp::fft::RealFft;
use htex_dsp::grid::{Band, GRID_HZ};
use htex_dsp::spectrum::{Complex, SegmentAnalyzer, dft321, magnitude};
use htex_format::Quantity;
use htex_host::{FitCondition, FitInput};
use htex_recording::{hertz, raised};
use serde::{Deserialize, Serialize};

use crate::blocks::{Repeatability, Span, repeatability};
use crate::segments::{SegmentChoice, Segments, choose_segments, segment_len};
use crate::{AuthorError, Recording, SetupResponse};

/// Floor of the setup's response relative to its largest value in the band: -40 dB.
const RESPONSE_FLOOR: f64 = 0.01;
/// Smallest valid maximum of a response in the band. The inverse of a smaller one would overflow.
const SMALLEST_RESPONSE: f64 = 1e-200;
/// Fewest bins of a texture spectrum.
const FEWEST_BINS: usize = 3;
/// Relative error of the grid's frequencies above which a warning is given.
const GRID_TOLERANCE: f64 = 1e-3;

/// Method of averaging segments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Averaging {
    /// Mean of the magnitudes. This is one interpretation of "averaged the FFTs" (paper, Texture
    /// processing). For noise, the mean is 1.05 dB below the RMS (a factor of √π/2, Rayleigh
    /// distribution).
    Magnitude,
    /// Root of the mean power. For noise and for tones, the result is the RMS.
    #[default]
    Rms,
    /// Magnitude of the mean of the complex spectra. Only signals with the same phase in all
    /// segments remain.
    Complex,
}

impl Averaging {
    /// All methods, in the order of the command line's help.
    pub const ALL: &[Self] = &[Self::Magnitude, Self::Rms, Self::Complex];

    /// Returns the name used in recipes and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Magnitude => "magnitude",
            Self::Rms => "rms",
            Self::Complex => "complex",
        }
    }
}

#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct SpectrumOptions {
    pub segments: SegmentChoice,
    pub averaging: Averaging,
    /// Frequency response of the recording setup. Spectra are divided by this response.
    pub response: Option<SetupResponse>,
}

impl SpectrumOptions {
    #[must_use]
    pub fn with_segments(mut self, segments: SegmentChoice) -> Self {
        self.segments = segments;
        self
    }

    #[must_use]
    pub fn with_averaging(mut self, averaging: Averaging) -> Self {
        self.averaging = averaging;
        self
    }

    /// Sets the response of the recording setup.
    #[must_use]
    pub fn with_response(mut self, response: impl Into<Option<SetupResponse>>) -> Self {
        self.response = response.into();
        self
    }
}

/// The spectra of a recording's segments in the band. The spectra are compensated for the setup's
/// response. The axes of a recording are combined into one spectrum.
#[derive(Debug, Clone)]
pub struct SegmentSpectra {
    pub quantity: Quantity,
    /// The band: 20 to 1000 Hz, or up to half the sample rate.
    pub band: Band,
    /// One spectrum for each segment, on the band's grid. A sinusoid of amplitude A at a grid
    /// frequency has magnitude A.
    pub spectra: Vec<Vec<Complex<f64>>>,
    pub segments: Segments,
    /// Warnings, as sentences.
    pub warnings: Vec<String>,
}

/// An averaged texture spectrum.
#[derive(Debug, Clone)]
pub struct TextureSpectrum {
    /// The recorded quantity; magnitudes and the signal are in its unit.
    pub quantity: Quantity,
    pub band: Band,
    /// The frequencies of the band's grid, hertz.
    pub frequency_hz: Vec<f64>,
    /// Magnitude at each frequency of the grid, in the quantity's unit.
    pub magnitude: Vec<f64>,
    /// Number of averaged segments; 0 if the spectrum was computed between two recorded speeds.
    pub segments: usize,
    /// Repeatability: the expected difference between the spectra of two recordings of this texture
    /// at this condition.
    ///
    /// To compute the repeatability, htex divides the read parts of the recordings into blocks of
    /// 0.2 to 1 s, which share no sample. A segment in the middle of a sweep is one block. `None`
    /// if there are fewer than four blocks, or if half of the blocks are silent.
    pub repeatability: Option<Repeatability>,
    /// The segments, windowed and overlap-added to one signal in the band.
    pub signal: Vec<f64>,
    /// Sample rate of `signal`, hertz.
    pub signal_rate_hz: f64,
}

/// Band, frequencies and magnitudes of a spectrum. Fits and error measures use only these parts of
/// a spectrum.
#[derive(Debug, Clone, Copy)]
pub struct SpectrumRef<'a> {
    pub band: Band,
    pub frequency_hz: &'a [f64],
    pub magnitude: &'a [f64],
}

impl TextureSpectrum {
    /// Returns whether the spectrum was recorded. Otherwise, the texture's law computed it from two
    /// recorded spectra.
    pub fn is_recorded(&self) -> bool {
        self.segments > 0
    }

    /// Returns the repeatability in nine bands, decibels.
    pub fn repeatability_rms_db(&self) -> Option<f64> {
        self.repeatability.map(|of| of.band_rms_db)
    }

    /// Averages the segment spectra of one or more recordings of one texture at one condition.
    ///
    /// # Errors
    /// Returns an error if there are no segments, or if the quantities or bands of the recordings
    /// differ.
    pub fn average(parts: &[SegmentSpectra], averaging: Averaging) -> Result<Self, AuthorError> {
        let first = parts.first().ok_or(AuthorError::NoSegments { source_name: String::new() })?;
        if parts.iter().any(|part| part.quantity != first.quantity) {
            return Err(AuthorError::QuantitiesDiffer);
        }
        if parts.iter().any(|part| part.band != first.band) {
            return Err(AuthorError::BandsDiffer);
        }
        let all: Vec<&[Complex<f64>]> =
            parts.iter().flat_map(|part| part.spectra.iter().map(Vec::as_slice)).collect();
        let spans: Vec<Span> = parts.iter().enumerate().flat_map(spans_of).collect();
        let (quantity, band) = (first.quantity, first.band);
        Ok(Self::from_segments(quantity, band, &all, &spans, averaging))
    }

    /// Averages spectra on the grid of a band. `spans` contains, for each spectrum, the part of the
    /// recording from which the spectrum was computed.
    pub(crate) fn from_segments(
        quantity: Quantity,
        band: Band,
        all: &[&[Complex<f64>]],
        spans: &[Span],
        averaging: Averaging,
    ) -> Self {
        let frequency_hz = band.grid_hz();
        let (signal, signal_rate_hz) = overlap_add(band, all);
        Self {
            quantity,
            band,
            magnitude: average(all, frequency_hz.len(), averaging),
            segments: all.len(),
            repeatability: repeatability(band, all, spans, averaging),
            frequency_hz,
            signal,
            signal_rate_hz,
        }
    }

    /// Returns the input for fitting a model to this spectrum. `options` has one value for each of
    /// the model's options, and `condition` is the motion of the recording.
    pub fn fit_input<'a>(&'a self, options: &'a [f64], condition: FitCondition) -> FitInput<'a> {
        FitInput {
            band: self.band,
            frequency_hz: &self.frequency_hz,
            magnitude: &self.magnitude,
            signal: &self.signal,
            signal_rate_hz: self.signal_rate_hz,
            options,
            condition,
        }
    }

    /// Returns band and magnitudes.
    pub fn as_ref(&self) -> SpectrumRef<'_> {
        SpectrumRef {
            band: self.band,
            frequency_hz: &self.frequency_hz,
            magnitude: &self.magnitude,
        }
    }
}

/// Returns the average in each of the first `bins` bins.
pub(crate) fn average(all: &[&[Complex<f64>]], bins: usize, averaging: Averaging) -> Vec<f64> {
    let n = all.len() as f64;
    (0..bins)
        .map(|k| {
            let column = all.iter().map(|spectrum| spectrum[k]);
            match averaging {
                Averaging::Magnitude => column.map(magnitude).sum::<f64>() / n,
                Averaging::Rms => (column.map(|x| x.norm_sqr()).sum::<f64>() / n).sqrt(),
                Averaging::Complex => magnitude(column.sum::<Complex<f64>>() / n),
            }
        })
        .collect()
}

/// Returns where each segment lies in its recording. The recording's index is `take`.
pub(crate) fn spans_of((take, part): (usize, &SegmentSpectra)) -> impl Iterator<Item = Span> {
    let len = part.segments.len as f64;
    let starts = part.segments.starts.iter().take(part.spectra.len());
    starts.map(move |&start| Span { take, from: start as f64 / len, to: start as f64 / len + 1.0 })
}

/// Cuts a recording into segments and computes their spectra.
///
/// # Errors
/// Returns an error if the sample rate leaves no useful band, if no segment is found, or if the
/// setup's response is zero or not finite in the band.
pub fn segment_spectra(
    recording: &Recording,
    options: &SpectrumOptions,
) -> Result<SegmentSpectra, AuthorError> {
    let segments = choose_segments(recording, options.segments);
    spectra_of_segments(recording, segments, options.response.as_ref())
}

/// Computes the spectra of the given segments of a recording.
pub(crate) fn spectra_of_segments(
    recording: &Recording,
    segments: Segments,
    response: Option<&SetupResponse>,
) -> Result<SegmentSpectra, AuthorError> {
    let CheckedBand { band, inverse, warnings } = CheckedBand::new(recording, &segments, response)?;
    let mut spectra = Vec::with_capacity(segments.starts.len());
    let mut reader = SegmentReader::new(segments.len, band, Trend::Mean);
    for &start in &segments.starts {
        let mut bins = reader.read(&recording.axes, start)?;
        if let Some(inverse) = &inverse {
            bins.iter_mut().zip(inverse).for_each(|(bin, h)| *bin *= h);
        }
        spectra.push(bins);
    }
    Ok(SegmentSpectra { quantity: recording.quantity, band, spectra, segments, warnings })
}

/// The trend removed from a segment before it is windowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Trend {
    Mean,
    /// The least-squares straight line.
    Linear,
}

/// The band in which a recording can be read, after the checks that reading needs.
pub(crate) struct CheckedBand {
    pub(crate) band: Band,
    /// `1 / H` of the setup's response on the band's grid.
    inverse: Option<Vec<Complex<f64>>>,
    /// Warnings, as sentences.
    pub(crate) warnings: Vec<String>,
}

impl CheckedBand {
    /// # Errors
    /// When the sample rate leaves no useful band, when there is no segment, or when the setup's
    /// response is zero or not finite in the band.
    pub(crate) fn new(
        recording: &Recording,
        segments: &Segments,
        response: Option<&SetupResponse>,
    ) -> Result<Self, AuthorError> {
        let mut warnings = Vec::new();
        let band = usable_band(recording, &mut warnings)?;
        check_segments(recording, segments, &mut warnings)?;
        let inverse = response.map(|r| inverse_response(r, band, &mut warnings)).transpose()?;
        Ok(Self { band, inverse, warnings })
    }
}

fn usable_band(recording: &Recording, warnings: &mut Vec<String>) -> Result<Band, AuthorError> {
    let (source, rate_hz) = (&recording.source, recording.rate_hz);
    let nyquist_hz = 0.5 * rate_hz;
    let band = Band { high_hz: Band::TACTILE.high_hz.min(nyquist_hz), ..Band::TACTILE };
    if nyquist_hz <= band.low_hz || band.bins() < FEWEST_BINS {
        return Err(AuthorError::RateTooLow { source_name: source.clone(), rate_hz, nyquist_hz });
    }
    if band.high_hz < Band::TACTILE.high_hz {
        warnings.push(format!(
            "{source}: sampled at {}, so the spectrum ends at {} instead of 1000 Hz; higher frequencies of the texture are \
             not in the recording",
            hertz(rate_hz),
            hertz(nyquist_hz)
        ));
    }
    let spacing_hz = rate_hz / segment_len(rate_hz) as f64;
    if (spacing_hz / GRID_HZ - 1.0).abs() > GRID_TOLERANCE {
        warnings.push(format!(
            "{source}: {} is not a multiple of 5 Hz: bins are {spacing_hz:.3} Hz apart and are treated as 5 Hz apart",
            hertz(rate_hz)
        ));
    }
    Ok(band)
}

fn check_segments(
    recording: &Recording,
    segments: &Segments,
    warnings: &mut Vec<String>,
) -> Result<(), AuthorError> {
    let source = &recording.source;
    if recording.samples() < segments.len {
        return Err(AuthorError::TooShort {
            source_name: source.clone(),
            samples: recording.samples(),
            needed: segments.len,
        });
    }
    match segments.starts.len() {
        0 => Err(AuthorError::NoSegments { source_name: source.clone() }),
        n @ 1..=2 => {
            warnings.push(format!(
                "{source}: {n} segment{} of 0.2 s: an average of so few is noisy; record for 10 s",
                if n == 1 { "" } else { "s" }
            ));
            Ok(())
        }
        _ => Ok(()),
    }
}

/// Returns `1 / H` on the band's grid, with `|H|` limited by the floor.
fn inverse_response(
    response: &SetupResponse,
    band: Band,
    warnings: &mut Vec<String>,
) -> Result<Vec<Complex<f64>>, AuthorError> {
    let values: Vec<Complex<f64>> = band
        .grid_hz()
        .iter()
        .map(|&f| response.value_at(f))
        .map(|(re, im)| Complex::new(re, im))
        .collect();
    let largest = response.largest_in(band);
    // If a value is not finite, this value is reported, because the largest value may hide it.
    let broken = values.iter().map(|h| magnitude(*h)).find(|h| !h.is_finite());
    if let Some(largest) = broken.or(Some(largest).filter(|l| *l < SMALLEST_RESPONSE)) {
        return Err(AuthorError::Response { largest });
    }
    let floor = RESPONSE_FLOOR * largest;
    let gains = values.iter().map(|h| 1.0 / magnitude(*h).max(floor));
    if let Some(raised) = raised(&band.grid_hz(), gains) {
        warnings.push(format!(
            "setup response: dividing by it raises {raised}; noise is raised equally"
        ));
    }
    let floored = values.iter().filter(|h| magnitude(**h) < floor).count();
    if floored > 0 {
        warnings.push(format!(
            "setup response: {floored} of {} bins lie more than 40 dB below its maximum in the \
             band and are divided by no less than that",
            values.len()
        ));
    }
    Ok(values.iter().map(|h| inverse(*h, floor)).collect())
}

/// Returns `1 / H` at frequencies in hertz, with `|H|` limited by its floor in the band.
pub(crate) fn inverse_at(
    response: &SetupResponse,
    band: Band,
    frequency_hz: impl Iterator<Item = f64>,
) -> Vec<Complex<f64>> {
    let floor = RESPONSE_FLOOR * response.largest_in(band);
    let at = |hz: f64| {
        let (re, im) = response.value_at(hz);
        inverse(Complex::new(re, im), floor)
    };
    frequency_hz.map(at).collect()
}

fn inverse(h: Complex<f64>, floor: f64) -> Complex<f64> {
    let norm = magnitude(h);
    if norm == 0.0 {
        // A response of zero has no phase that could be reversed.
        return Complex::new(1.0 / floor, 0.0);
    }
    // The floor limits the magnitude. The phase is always reversed.
    h.conj() / (norm * norm.max(floor))
}

/// Computes spectra of segments: removes the mean, applies a Hann window and an FFT, and combines
/// the axes into one (Landin 2010).
pub(crate) struct SegmentReader {
    analyzer: SegmentAnalyzer,
    len: usize,
    band: Band,
    trend: Trend,
}

impl SegmentReader {
    pub(crate) fn new(len: usize, band: Band, trend: Trend) -> Self {
        Self { analyzer: SegmentAnalyzer::new(len), len, band, trend }
    }

    pub(crate) fn read(
        &mut self,
        axes: &[Vec<f64>],
        start: usize,
    ) -> Result<Vec<Complex<f64>>, AuthorError> {
        let scale = self.analyzer.amplitude_scale();
        let mut spectra = Vec::with_capacity(axes.len());
        for axis in axes {
            let mut bins = self.analyzer.make_bins();
            let segment = axis.get(start..start + self.len).unwrap_or_default();
            let level = match self.trend {
                Trend::Mean => Cow::Borrowed(segment),
                Trend::Linear => Cow::Owned(without_line(segment)),
            };
            self.analyzer.analyze(&level, &mut bins).map_err(|_| AuthorError::BandsDiffer)?;
            // The band is selected by the numbers of bins and not by hertz: at a rate that is not a
            // multiple of 5 Hz, bins are not exactly 5 Hz apart.
            let in_band = self.band.first_bin()..=self.band.last_bin();
            let bin = |k: usize| bins.get(k).copied().unwrap_or_default();
            spectra.push(in_band.map(bin).collect::<Vec<_>>());
        }
        let mut folded = dft321(&spectra);
        folded.iter_mut().for_each(|bin| *bin *= scale);
        Ok(folded)
    }
}

/// Subtracts the slope of the least-squares line through equally spaced samples; the mean stays.
fn without_line(segment: &[f64]) -> Vec<f64> {
    let middle = 0.5 * (segment.len() as f64 - 1.0);
    // Positions around the middle have the mean 0, so that the slope does not depend on the mean.
    let place = |i: usize| i as f64 - middle;
    let samples = || segment.iter().enumerate();
    let both: f64 = samples().map(|(i, x)| place(i) * x).sum();
    let own: f64 = samples().map(|(i, _)| place(i) * place(i)).sum();
    let slope = if own > 0.0 { both / own } else { 0.0 };
    samples().map(|(i, x)| x - slope * place(i)).collect()
}

/// Overlap-adds the half-overlapping windowed segments to one signal at four times the band's upper
/// end.
fn overlap_add(band: Band, all: &[&[Complex<f64>]]) -> (Vec<f64>, f64) {
    // A multiple of four, so that half a segment is a whole number of samples.
    let len = 4 * band.last_bin();
    let mut signal = vec![0.0; (all.len() + 1) * (len / 2)];
    each_frame(band, all, len, |i, frame| {
        let place = &mut signal[i * (len / 2)..];
        place.iter_mut().zip(frame).for_each(|(s, x)| *s += x);
    });
    (signal, len as f64 * GRID_HZ)
}

/// Calls `add` with the index and the `len` samples of each windowed segment.
pub(crate) fn each_frame(
    band: Band,
    all: &[&[Complex<f64>]],
    len: usize,
    mut add: impl FnMut(usize, &[f64]),
) {
    let mut fft = RealFft::new(len);
    let (mut bins, mut frame) = (fft.make_bins(), vec![0.0; len]);
    for (i, spectrum) in all.iter().enumerate() {
        bins.fill(Complex::new(0.0, 0.0));
        for (bin, x) in bins[band.first_bin()..].iter_mut().zip(*spectrum) {
            // The windowed sinusoid of amplitude A must have magnitude A; the window's mean is one
            // half.
            *bin = x * 0.25;
        }
        fft.inverse(&bins, &mut frame);
        add(i, &frame);
    }
}
