//! Averaged auto and cross spectra.

use htex_dsp::fft::RealFft;
use num_complex::Complex;

/// Averaged auto and cross spectra of input and output at each bin. A common factor is left out,
/// because only ratios are used (Bendat & Piersol, section 11.5).
#[derive(Debug)]
pub(crate) struct Spectra {
    fft: RealFft,
    bins: [Vec<Complex<f64>>; 2],
    /// Auto spectrum of the input.
    pub(crate) gxx: Vec<f64>,
    /// Auto spectrum of the output.
    pub(crate) gyy: Vec<f64>,
    /// Cross spectrum: the mean of the conjugate of the input times the output.
    pub(crate) gxy: Vec<Complex<f64>>,
}

impl Spectra {
    /// Creates empty sums for windows of `len` samples.
    pub(crate) fn new(len: usize) -> Self {
        let fft = RealFft::new(len);
        let bins = [fft.make_bins(), fft.make_bins()];
        let count = bins[0].len();
        Self {
            fft,
            bins,
            gxx: vec![0.0; count],
            gyy: vec![0.0; count],
            gxy: vec![Complex::ZERO; count],
        }
    }

    /// Adds a window.
    pub(crate) fn add(&mut self, input: &[f64], output: &[f64]) {
        let [x, y] = &mut self.bins;
        self.fft.forward(input, x);
        self.fft.forward(output, y);
        for (bin, (x, y)) in x.iter().zip(y.iter()).enumerate() {
            self.gxx[bin] += x.norm_sqr();
            self.gyy[bin] += y.norm_sqr();
            self.gxy[bin] += x.conj() * y;
        }
    }
}
