//! MFCC model (`org.htex.mfcc`): mel-frequency cepstral coefficients. The coefficients are the
//! first terms of the cosine transform of the logarithmic energies in mel bands. These coefficients
//! describe a smoothed spectrum, because the higher terms are left out (section "Mel Frequency
//! Cepstral Coefficients" of the paper).
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![no_std]

#[macro_use]
extern crate alloc;

mod inverse;

use alloc::sync::Arc;
use alloc::vec::Vec;

use htex_dsp::dct::dct_ii;
use htex_dsp::decibel_fit::DecibelFit;
use htex_dsp::grid::{Band, GRID_HZ, level_rms};
use htex_dsp::mel::MelBank;
use htex_dsp::non_negative::Scratch;
use htex_dsp::shaped_noise::ComponentsKey;
use htex_model::shaped::{Curve, Places, ShapedModel};
use htex_model::{
    Error, Fit, FitInput, Numbers, StaticDescriptor, StaticField, StaticOption, Store, UsualRange,
    Values, mix,
};

use inverse::Inverse;

const CEPSTRUM: usize = 0;
const BANDS: usize = 1;
const INVERSE: usize = 2;

const COEFFICIENTS_OPTION: usize = 0;
const BANDS_OPTION: usize = 1;
const INVERSE_OPTION: usize = 2;
const FIT_OPTION: usize = 3;

/// Value of the option `fit`.
const DECIBEL: u32 = 1;

const MAX_BANDS: u32 = 128;
/// Lower limit of band energies, the asset's unit squared (numeric definitions: MFCC).
const FLOOR: f64 = 1e-20;

const WHOLE: Store = Store::U8 { scale: 1.0, offset: 0.0, log: false };

pub(crate) struct MelCepstrum;

htex_model::export_model!(MelCepstrum, symbols: "plugin");

impl ShapedModel for MelCepstrum {
    type Curve = Spectrum;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "org.htex.mfcc",
        "MFCC",
        env!("CARGO_PKG_VERSION"),
        "Logarithms of the energies in mel bands, stored as the first terms of their cosine transform.",
    )
    .fields(&[
        StaticField::list(
            "cepstrum",
            "1",
            (-1e5, 1e5),
            MAX_BANDS,
            "Terms c_0 to c_(n-1) of the orthonormal DCT-II of the natural logarithms of the \
             bands' energies.",
        )
        // The fits to 15 simulated recordings of five surfaces have values from -80 to 18. The
        // first coefficient, a sum of logarithms, is by far the lowest.
        .usual(UsualRange::linear(-80.0, 20.0)),
        StaticField::scalar("bands", "1", (2.0, MAX_BANDS as f64), "Number of mel bands.")
            .stored(WHOLE)
            .usual(UsualRange::linear(20.0, 64.0)),
        StaticField::scalar(
            "inverse",
            "1",
            (0.0, 3.0),
            "How the spectrum is computed from the energies. 0: pseudo-inverse. 1: non-negative \
             least squares. 2: interpolation between the bands' apexes. 3: interpolation of the \
             logarithm of power over the logarithm of frequency, continued to the band's edges.",
        )
        .stored(WHOLE)
        .usual(UsualRange::linear(0.0, 3.0)),
    ])
    .options(&[
        StaticOption::integer(
            "coefficients",
            (1, MAX_BANDS),
            10,
            "Number of coefficients to store. The paper uses ten.",
        )
        .sweep(&[4.0, 5.0, 6.0, 8.0, 10.0, 13.0, 16.0, 20.0, 26.0, 32.0, 40.0])
        .not_above("bands"),
        StaticOption::integer(
            "bands",
            (2, MAX_BANDS),
            26,
            "Number of mel bands, between the edges of the frequency band.",
        )
        .sweep(&[26.0, 40.0])
        .sweep_alone(&[20.0, 32.0, 64.0]),
        StaticOption::choice(
            "inverse",
            &["pinv", "nnls", "interpolate", "log-log"],
            "How the spectrum is computed from the energies: `pinv` uses the pseudo-inverse of the \
             filter bank, clipped at zero; `nnls` uses non-negative least squares; `interpolate` \
             interpolates between the bands' apexes; `log-log` interpolates the logarithm of power \
             over the logarithm of frequency, and continues the lines to the band's edges.",
        )
        .sweep(&[0.0, 1.0, 2.0])
        .sweep_alone(&[3.0]),
        StaticOption::choice(
            "fit",
            &["transform", "decibel"],
            "How the coefficients are found: `transform` keeps the first terms of the cosine \
             transform, as in the paper; `decibel` minimises the squared differences, in decibels, \
             between the spectra that the model plays and that was recorded, in 30 bands.",
        )
        .sweep_alone(&[0.0, 1.0]),
    ]);

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        if input.magnitude.iter().all(|&m| m == 0.0) {
            return Err(Error::cannot_fit("the spectrum is silent: all band energies are zero"));
        }
        let band: Band = input.band;
        let bands = input.options[BANDS_OPTION] as usize;
        let kept = (input.options[COEFFICIENTS_OPTION] as usize).min(bands);
        let inverse = Inverse::shared(bands, input.options[INVERSE_OPTION] as u8, band);
        let power: Vec<f64> = input.magnitude.iter().map(|m| m * m).collect();
        let bank = MelBank::new(bands, band, input.frequency_hz);
        let mut log_energy = bank.energies(&power);
        log_energy.iter_mut().for_each(|e| *e = libm::log(e.max(FLOOR)));
        let mut cepstrum = vec![0.0; kept];
        dct_ii(&log_energy, &mut cepstrum);
        if input.options[FIT_OPTION] as u32 == DECIBEL {
            fit_decibels(&inverse, input, &power, &mut cepstrum);
        }
        let spectrum = Spectrum::with_cepstrum(inverse, band, &cepstrum)?;
        let count = [cepstrum.len() as f64];
        let rest = [bands as f64, input.options[INVERSE_OPTION]];
        Ok(Fit { parameters: [&count[..], &cepstrum, &rest].concat(), level_rms: spectrum.level })
    }

    /// Interpolates cepstra, i.e. logarithms of energies.
    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        let kind = |set: &Values<'_>| (set.scalar(BANDS), set.scalar(INVERSE));
        if sets.iter().any(|set| kind(set) != kind(&sets[0])) {
            return Err(Error::argument(
                "cepstra of different mel banks or inverses cannot be mixed",
            ));
        }
        mix::linear(sets, weights, out)
    }
}

/// Changes the coefficients so that `inverse` converts them to a spectrum that is as near to
/// `power` as possible, in decibels, and has the same energy.
///
/// The first terms of the transform describe the bands' levels as smoothly as possible. But the
/// inverse also has to guess two parts of the spectrum: the edges of the band, where the filters
/// have no weight, and the details within the wide filters. If all coefficients are fitted
/// together, they can correct errors in both parts.
fn fit_decibels(inverse: &Inverse, input: &FitInput<'_>, power: &[f64], cepstrum: &mut [f64]) {
    let mut energy = vec![0.0; inverse.bands()];
    let mut scratch = Scratch::new(inverse.bands());
    let mut whole = cepstrum.to_vec();
    let Some((level, shape)) = cepstrum.split_first_mut() else {
        return;
    };
    let levels = DecibelFit::new(input.band, input.frequency_hz, power);
    levels.run(shape, |shape, power| {
        whole[1..].copy_from_slice(shape);
        inverse.power(&whole, &mut energy, &mut scratch, power);
    });
    let mut fitted = vec![0.0; power.len()];
    whole[1..].copy_from_slice(shape);
    inverse.power(&whole, &mut energy, &mut scratch, &mut fitted);
    let gain = power.iter().sum::<f64>() / fitted.iter().sum::<f64>();
    // The first coefficient is the mean logarithm of energy, times the square root of the number of
    // bands.
    let raise = libm::log(gain) * htex_dsp::root::sqrt(inverse.bands() as f64);
    // The coefficient stays unchanged if the spectrum has no power or too much power. The caller
    // reports this error.
    if raise.is_finite() {
        *level += raise;
    }
}

/// Returns a scalar parameter, rounded to a whole number.
pub(crate) fn whole(parameters: &Values<'_>, field: usize) -> usize {
    libm::round(parameters.scalar(field)) as usize
}

/// The magnitude that a cepstrum describes, on the frequency grid.
pub struct Spectrum {
    inverse: Arc<Inverse>,
    band: Band,
    cepstrum: Vec<f64>,
    energy: Vec<f64>,
    scratch: Scratch,
    magnitude: Vec<f64>,
    /// RMS of `magnitude`.
    level: f64,
    /// Positions of a voice's frequencies between the bins.
    places: Option<Arc<Places>>,
}

impl Spectrum {
    fn with_cepstrum(inverse: Arc<Inverse>, band: Band, cepstrum: &[f64]) -> Result<Self, Error> {
        let mut spectrum = Self {
            band,
            cepstrum: cepstrum.to_vec(),
            energy: vec![0.0; inverse.bands()],
            scratch: Scratch::new(inverse.bands()),
            magnitude: vec![0.0; band.bins()],
            level: 0.0,
            places: None,
            inverse,
        };
        spectrum.make();
        spectrum.level = level_rms(&spectrum.magnitude);
        if spectrum.level > 0.0 && spectrum.level.is_finite() {
            return Ok(spectrum);
        }
        Err(Error::parameters("the cepstrum's band energies are not finite, or all zero"))
    }

    /// Computes the magnitudes from the cepstrum. Does not allocate.
    fn make(&mut self) {
        self.inverse.power(
            &self.cepstrum,
            &mut self.energy,
            &mut self.scratch,
            &mut self.magnitude,
        );
        self.magnitude.iter_mut().for_each(|m| *m = htex_dsp::root::sqrt(*m));
    }
}

impl Curve for Spectrum {
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error> {
        let bands = whole(parameters, BANDS);
        let inverse = Inverse::shared(bands, whole(parameters, INVERSE) as u8, band);
        Self::with_cepstrum(inverse, band, parameters.list(CEPSTRUM))
    }

    fn band(&self) -> Band {
        self.band
    }

    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        if !self.inverse.is(parameters) {
            return Err(Error::argument("a voice cannot change its mel bank or its inverse"));
        }
        let cepstrum = parameters.list(CEPSTRUM);
        if cepstrum.len() > self.energy.len() {
            return Err(Error::argument(
                "a cepstrum has at most one coefficient for each mel band",
            ));
        }
        self.cepstrum.clear();
        self.cepstrum.extend_from_slice(cepstrum);
        Ok(())
    }

    /// Interpolates linearly between bins.
    fn magnitude_at(&self, frequency_hz: f64) -> f64 {
        let last = self.magnitude.len() - 1;
        let place = (frequency_hz / GRID_HZ - self.band.first_bin() as f64).clamp(0.0, last as f64);
        let below = place as usize;
        let above = (below + 1).min(last);
        let (a, b) = (self.magnitude[below], self.magnitude[above]);
        a + (place - below as f64) * (b - a)
    }

    fn level(&self) -> f64 {
        self.level
    }

    fn prepare(&mut self, frequency_hz: &[f64], key: ComponentsKey) {
        // The memory is reserved here, so that `set` never allocates on the render thread.
        self.cepstrum.reserve(self.inverse.bands());
        self.places = Some(Places::shared(frequency_hz, key, self.band));
    }

    fn fill(&mut self, _: &[f64], magnitude: &mut [f64]) {
        self.make();
        if let Some(places) = &self.places {
            places.read(&self.magnitude, magnitude);
        }
    }
}
