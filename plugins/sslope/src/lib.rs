//! sSlope model (`org.htex.sslope`): an asymmetric band-pass around the dominant peak, with three
//! parameters (section "Spectral slope" of the paper).
//!
//! With the paper's rounding to 20 dB per decade, the filter orders are integers. With finer
//! rounding, or between two conditions, orders can be fractional, whereas a recursive filter must
//! have an integer order. Therefore, the voice shapes white noise in the frequency domain with the
//! Butterworth magnitude, which is also defined for fractional orders.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![no_std]

#[macro_use]
extern crate alloc;

mod fit;

use alloc::sync::Arc;

use htex_dsp::butterworth::analog_low_pass_magnitude;
use htex_dsp::exponential::exponentials;
use htex_dsp::grid::{Band, curve_level_rms};
use htex_dsp::shaped_noise::ComponentsKey;
use htex_dsp::shared::Shared;
use htex_model::shaped::{Curve, ShapedModel};
use htex_model::{
    Error, Fit, FitInput, StaticDescriptor, StaticField, StaticOption, Store, UsualRange, Values,
    text,
};

const PEAK: usize = 0;
const HIGH_PASS: usize = 1;
const LOW_PASS: usize = 2;

/// Files store an order in steps of 1/20: 1 dB per decade.
const ORDER_STEP: f64 = 0.05;
/// Highest filter order. This order gives a slope of 400 dB per decade.
pub const MAX_ORDER: f64 = 20.0;

const fn steps(scale: f64) -> Store {
    Store::U16 { scale, offset: 0.0, log: false }
}

pub(crate) struct SpectralSlope;

htex_model::export_model!(SpectralSlope, symbols: "plugin");

impl ShapedModel for SpectralSlope {
    type Curve = Shape;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "org.htex.sslope",
        "sSlope",
        env!("CARGO_PKG_VERSION"),
        "An asymmetric band-pass around the dominant peak. The parameters are the peak's frequency \
         and two filter orders.",
    )
    .fields(&[
        StaticField::scalar(
            "peak_hz",
            "Hz",
            (1.0, 2000.0),
            "Frequency of the dominant peak, which is the cut-off frequency of both filters.",
        )
        .stored(steps(0.03125))
        // The band of textures.
        .usual(UsualRange::log(20.0, 1000.0)),
        StaticField::scalar(
            "order_high_pass",
            "1",
            (0.05, MAX_ORDER),
            "Order r_a of the Butterworth high-pass.",
        )
        .stored(steps(ORDER_STEP))
        // The fits to 15 simulated recordings of five surfaces have orders of about 1 to 5.
        .usual(UsualRange::linear(0.5, 6.0)),
        StaticField::scalar(
            "order_low_pass",
            "1",
            (0.05, MAX_ORDER),
            "Order r_b of the Butterworth low-pass.",
        )
        .stored(steps(ORDER_STEP))
        .usual(UsualRange::linear(0.5, 6.0)),
    ])
    .options(&[
        StaticOption::number(
            "rounding_db_per_decade",
            "dB/decade",
            (1.0, 20.0),
            5.0,
            "Step to whose multiples the slopes are rounded. The paper uses 20.",
        )
        .sweep(&[20.0, 10.0, 5.0, 1.0]),
        StaticOption::choice(
            "slopes",
            &["least-squares", "end-points", "anchored"],
            "How the slope on each side of the peak is measured. `least-squares`: by a line fitted \
             to all bins. `end-points`: by the line through the first and the last bin. \
             `anchored`: by a line fitted to all bins that passes through the peak.",
        )
        .sweep(&[0.0, 1.0, 2.0]),
    ]);

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        fit::fit(input)
    }
}

/// A Butterworth high-pass times a Butterworth low-pass, with one cut-off frequency.
pub struct Shape {
    peak_hz: f64,
    high_pass: f64,
    low_pass: f64,
    band: Band,
    level: f64,
    /// Logarithms of a voice's frequencies in hertz.
    logs: Option<Arc<[f64]>>,
}

/// Number of frequencies whose magnitudes are computed at a time.
const AT_ONCE: usize = 64;

impl Shape {
    fn with_orders(peak_hz: f64, orders: (f64, f64), band: Band) -> Result<Self, Error> {
        let mut shape =
            Self { peak_hz, high_pass: orders.0, low_pass: orders.1, band, level: 1.0, logs: None };
        shape.measure()?;
        Ok(shape)
    }

    fn measure(&mut self) -> Result<(), Error> {
        self.level = curve_level_rms(self.band, |f| self.magnitude_at(f));
        if self.level > 0.0 {
            return Ok(());
        }
        Err(Error::parameters(text![
            "a peak at ",
            self.peak_hz,
            " Hz leaves nothing in the band ",
            self.band.low_hz,
            " to ",
            self.band.high_hz,
            " Hz",
        ]))
    }
}

impl Curve for Shape {
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error> {
        let orders = (parameters.scalar(HIGH_PASS), parameters.scalar(LOW_PASS));
        Self::with_orders(parameters.scalar(PEAK), orders, band)
    }

    fn band(&self) -> Band {
        self.band
    }

    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        self.peak_hz = parameters.scalar(PEAK);
        self.high_pass = parameters.scalar(HIGH_PASS);
        self.low_pass = parameters.scalar(LOW_PASS);
        Ok(())
    }

    /// Returns the magnitude at a frequency. At the peak, it is one half.
    fn magnitude_at(&self, frequency_hz: f64) -> f64 {
        let above = frequency_hz / self.peak_hz;
        analog_low_pass_magnitude(above, self.low_pass)
            * analog_low_pass_magnitude(1.0 / above, self.high_pass)
    }

    fn level(&self) -> f64 {
        self.level
    }

    fn prepare(&mut self, frequency_hz: &[f64], key: ComponentsKey) {
        static LOGS: Shared<ComponentsKey, [f64]> = Shared::new();
        let logs = || frequency_hz.iter().map(|hz| libm::log(*hz)).collect();
        self.logs = Some(LOGS.get(key, logs));
    }

    fn fill(&mut self, _: &[f64], magnitude: &mut [f64]) {
        let Some(logs) = &self.logs else {
            return;
        };
        let peak = libm::log(self.peak_hz);
        let (low_pass, high_pass) = (2.0 * self.low_pass, -2.0 * self.high_pass);
        let mut passed = [0.0; AT_ONCE];
        for (magnitude, logs) in magnitude.chunks_mut(AT_ONCE).zip(logs.chunks(AT_ONCE)) {
            let passed = &mut passed[..logs.len()];
            for ((low, high), log) in magnitude.iter_mut().zip(&mut *passed).zip(logs) {
                let above = log - peak;
                (*low, *high) = (low_pass * above, high_pass * above);
            }
            exponentials(magnitude);
            exponentials(passed);
            for (m, high) in magnitude.iter_mut().zip(&*passed) {
                // One of the two factors is at most 2, so the product does not overflow.
                *m = 1.0 / htex_dsp::root::sqrt((1.0 + *m) * (1.0 + high));
            }
        }
    }
}
