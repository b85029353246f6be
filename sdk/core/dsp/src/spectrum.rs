//! Complex spectra of recorded segments, before they are averaged to a texture spectrum.

use alloc::vec::Vec;

pub use num_complex::Complex;

use crate::fft::RealFft;
use crate::window::hann_periodic;

/// Error: a buffer does not have the length that the analyser needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WrongLength {
    /// Name of the buffer with the wrong length.
    pub what: &'static str,
    /// Length needed.
    pub expected: usize,
    /// Length given.
    pub got: usize,
}

impl core::fmt::Display for WrongLength {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { what, expected, got } = self;
        write!(f, "{what} has {got} elements, but {expected} are needed")
    }
}

impl core::error::Error for WrongLength {}

/// Computes the spectra of segments of one length with a real FFT. [`Self::analyze`] first removes
/// the mean and applies the periodic Hann window; [`Self::transform`] does neither.
///
/// ```
/// use htex_dsp::spectrum::SegmentAnalyzer;
/// let mut analyzer = SegmentAnalyzer::new(8);
/// let mut bins = analyzer.make_bins();
/// analyzer.analyze(&[1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0], &mut bins)?;
/// // A cosine of amplitude 1 on bin 2.
/// assert!((bins[2].norm() * analyzer.amplitude_scale() - 1.0).abs() < 1e-12);
/// # Ok::<(), htex_dsp::spectrum::WrongLength>(())
/// ```
#[derive(Debug, Clone)]
pub struct SegmentAnalyzer {
    window: Vec<f64>,
    fft: RealFft,
    input: Vec<f64>,
}

impl SegmentAnalyzer {
    /// Makes an analyser for segments of `len` samples.
    pub fn new(len: usize) -> Self {
        Self { window: hann_periodic(len), fft: RealFft::new(len), input: alloc::vec![0.0; len] }
    }

    /// Makes a buffer for one spectrum: `len / 2 + 1` bins, from 0 Hz to the Nyquist frequency.
    pub fn make_bins(&self) -> Vec<Complex<f64>> {
        self.fft.make_bins()
    }

    /// Factor that converts the magnitude of a windowed bin to the amplitude of a sinusoid: `2 /
    /// Σw`, which is `4 / len`. The factor 2 is needed because half of the amplitude is at the
    /// negative frequency.
    pub fn amplitude_scale(&self) -> f64 {
        2.0 / self.window.iter().sum::<f64>()
    }

    /// Removes the mean of the segment, applies the window, and transforms. Bins are unscaled DFT
    /// sums. Does not allocate.
    ///
    /// # Errors
    /// Returns an error if `segment` or `bins` does not have the length of the analyser.
    pub fn analyze(
        &mut self,
        segment: &[f64],
        bins: &mut [Complex<f64>],
    ) -> Result<(), WrongLength> {
        self.check("segment", self.window.len(), segment.len())?;
        self.check("spectrum buffer", self.window.len() / 2 + 1, bins.len())?;
        // The mean is removed first, because otherwise the window would spread it into the bin next
        // to 0 Hz.
        let mean = segment.iter().sum::<f64>() / segment.len() as f64;
        for ((input, sample), weight) in self.input.iter_mut().zip(segment).zip(&self.window) {
            *input = (sample - mean) * weight;
        }
        self.fft.forward(&self.input, bins);
        Ok(())
    }

    /// Transforms the segment as [`Self::analyze`] does, but does not remove the mean and applies
    /// no window.
    ///
    /// # Errors
    /// Returns an error if `segment` or `bins` does not have the length of the analyser.
    pub fn transform(
        &mut self,
        segment: &[f64],
        bins: &mut [Complex<f64>],
    ) -> Result<(), WrongLength> {
        self.check("segment", self.window.len(), segment.len())?;
        self.check("spectrum buffer", self.window.len() / 2 + 1, bins.len())?;
        self.fft.forward(segment, bins);
        Ok(())
    }

    fn check(&self, what: &'static str, expected: usize, got: usize) -> Result<(), WrongLength> {
        if expected == got { Ok(()) } else { Err(WrongLength { what, expected, got }) }
    }
}

/// Combines the spectra of several axes into one: magnitude `sqrt(|X|² + |Y|² + …)`, phase of `X +
/// Y + …` (DFT321, Landin et al. 2010). Where the sum is zero, the phase is 0. If there is only one
/// axis, its spectrum is returned unchanged. The shortest axis determines the length.
pub fn dft321(axes: &[Vec<Complex<f64>>]) -> Vec<Complex<f64>> {
    let bins = axes.iter().map(Vec::len).min().unwrap_or(0);
    match axes {
        [axis] => axis.clone(),
        axes => (0..bins).map(|k| fold_bin(axes.iter().map(|axis| axis[k]))).collect(),
    }
}

fn fold_bin(axes: impl Iterator<Item = Complex<f64>> + Clone) -> Complex<f64> {
    let folded = axes.clone().map(magnitude).fold(0.0, libm::hypot);
    let sum: Complex<f64> = axes.sum();
    let length = magnitude(sum);
    if length > 0.0 { sum / length * folded } else { Complex::new(folded, 0.0) }
}

/// Magnitude of a complex number. Unlike the result of `Complex::norm`, the result has the same
/// bits on every machine.
pub fn magnitude(z: Complex<f64>) -> f64 {
    libm::hypot(z.re, z.im)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_lengths_are_refused_and_offsets_removed() {
        let mut analyzer = SegmentAnalyzer::new(16);
        let mut bins = analyzer.make_bins();
        assert!(analyzer.analyze(&[1.0; 15], &mut bins).is_err());
        assert!(analyzer.analyze(&[1.0; 16], &mut bins[..3]).is_err());
        assert!(analyzer.analyze(&[7.0; 16], &mut bins).is_ok());
        assert!(bins.iter().all(|bin| bin.norm() < 1e-12));
    }

    #[test]
    fn the_shortest_segments_are_harmless() {
        for len in 0..4 {
            let mut analyzer = SegmentAnalyzer::new(len);
            let mut bins = analyzer.make_bins();
            assert!(analyzer.analyze(&[1.0; 4][..len], &mut bins).is_ok());
        }
    }

    #[test]
    fn opposite_axes_keep_their_power() {
        let x = Complex::new(3.0, 4.0);
        let folded = dft321(&[vec![x], vec![-x]]);
        assert!((folded[0].norm() - 50_f64.sqrt()).abs() < 1e-12);
        assert_eq!(folded[0].im, 0.0);
        let folded = dft321(&[vec![x], vec![x], vec![Complex::new(0.0, 0.0); 2]]);
        assert_eq!(folded.len(), 1);
        assert!((folded[0] - x * 2_f64.sqrt()).norm() < 1e-12);
    }
}
