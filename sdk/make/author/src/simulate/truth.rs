//! The true spectrum of a free motion over a surface, as a closed-form function of speed and force.
//!
//! The relief is a stationary process along the path, with a known spectral density over spatial
//! frequency. The speed converts spatial frequency to hertz. The force scales the density, and skin
//! and rig filter it. A spectrum is computed with a periodic Hann window of 0.2 s. To get the
//! expected power of this spectrum at a multiple of 5 Hz, the module multiplies the filtered
//! density by the window's power transfer function and integrates the product.

use std::f64::consts::PI;
use std::io::{self, Write};

use htex_dsp::biquad::Biquad;
use htex_dsp::grid::{Band, GRID_HZ};
use serde::Serialize;

use super::contact::{ACROSS, Rig, SKIN, noise_density};
use super::filters::{OnePole, low_pass};
use super::relief::{POINTS_PER_MM, contact_kernel, cubic_weights};
use super::surface::{Grain, Parameters};
use super::{Motion, SimulationOptions, check_range};
use crate::AuthorError;

/// Number of cells in each step of the grid. Densities are constant within a cell.
const CELLS: usize = 32;
/// The window takes power from this number of bins on either side of a multiple of 5 Hz.
const WINDOW_BINS: usize = 4;
/// Largest ratio of neighbouring speeds in a written truth.
const SPEED_RATIO: f64 = 1.02;

/// The true spectra of a simulated surface and rig.
///
/// ```
/// use htex_author::simulate::{FreeMotion, SimulationOptions, Surface};
///
/// let options = SimulationOptions::new(Surface::Vinyl).with_free_motion(FreeMotion::default());
/// let truth = options.truth()?;
/// let (light, firm) = (truth.magnitude(80.0, 0.4)?, truth.magnitude(80.0, 0.8)?);
/// assert_eq!(light.len(), 197);
/// // The texture is proportional to the force; the sensor's noise is not.
/// assert!((firm[4] / light[4] - 2.0).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Truth {
    options: SimulationOptions,
    band: Band,
    cell_hz: f64,
    /// Squared magnitude of skin and rig in each cell, starting at 0 Hz.
    filters: Vec<f64>,
    noise_power: f64,
}

impl SimulationOptions {
    /// Returns the true spectrum of a steady part of a free motion as a function of speed and
    /// force.
    ///
    /// # Errors
    /// Returns an error if an option is out of range, if the motion is not free, or if the level
    /// drifts or the finger lifts. Sweeps have no closed-form spectrum because they run over one
    /// fixed piece of the material.
    pub fn truth(&self) -> Result<Truth, AuthorError> {
        self.check()?;
        if !self.departures.is_steady() {
            return Err(AuthorError::UnsteadyTruth);
        }
        if !matches!(self.motion, Motion::Free(_)) {
            return Err(AuthorError::NoTruth);
        }
        let band = Band { high_hz: Band::TACTILE.high_hz.min(0.5 * self.rate_hz), ..Band::TACTILE };
        let cell_hz = GRID_HZ / CELLS as f64;
        // The window of the last bin takes power from above the band.
        let cells = (band.last_bin() + WINDOW_BINS + 1) * CELLS;
        let rate_hz = self.inner_hz();
        let mut sections: Vec<Biquad> = Rig::new(rate_hz, self.rate_hz).lateral().to_vec();
        sections.push(low_pass(SKIN.1, SKIN.0, rate_hz));
        let gain = |cell: usize| {
            let hz = (cell as f64 + 0.5) * cell_hz;
            let magnitudes = sections.iter().map(|s| s.magnitude(hz, rate_hz));
            magnitudes.product::<f64>().powi(2)
        };
        Ok(Truth {
            filters: (0..cells).map(gain).collect(),
            // A sine of amplitude A has the power A²/2, and a Hann window is 1.5 bins wide.
            noise_power: 3.0 * GRID_HZ * noise_density(self.rate_hz),
            options: self.clone(),
            band,
            cell_hz,
        })
    }
}

impl Truth {
    /// Returns the frequencies, hertz: the multiples of 5 Hz in the band.
    #[must_use]
    pub fn frequency_hz(&self) -> Vec<f64> {
        self.band.grid_hz()
    }

    /// Returns the true magnitudes at the frequencies [`Self::frequency_hz`], newtons. A magnitude
    /// is the root of the expected power in a segment of 0.2 s. The magnitude combines both lateral
    /// axes, and includes the rig's response and the sensor's noise.
    ///
    /// # Errors
    /// Returns an error if the speed or the force is out of the simulator's range.
    pub fn magnitude(&self, speed_mm_s: f64, force_n: f64) -> Result<Vec<f64>, AuthorError> {
        check_range("speed_mm_s", speed_mm_s, 1.0, 500.0)?;
        check_range("force_n", force_n, 0.01, 10.0)?;
        let per_newton = self.per_newton(speed_mm_s);
        let force = self.force_power(force_n);
        let magnitude = |one: f64| libm::sqrt((force * one).powi(2) + self.noise_power);
        Ok(per_newton.into_iter().map(magnitude).collect())
    }

    /// Returns the factor of the texture at a force, relative to a force of 1 N.
    fn force_power(&self, force_n: f64) -> f64 {
        match self.options.departures.level_force {
            1.0 => force_n,
            exponent => libm::pow(force_n, exponent),
        }
    }

    /// Returns the magnitudes of the texture at a force of 1 N, without sensor noise.
    fn per_newton(&self, speed_mm_s: f64) -> Vec<f64> {
        let power = self.cell_powers(speed_mm_s);
        let window = window_powers();
        let at = |bin: usize| {
            let middle = bin * CELLS;
            let taken = window.iter().enumerate().map(|(i, transfer)| {
                // A cell above the frequency and the mirrored cell below it. The middles of the
                // first two cells are half a cell away from the frequency.
                let above = power.get(middle + i).copied().unwrap_or(0.0);
                let below = (middle > i).then(|| power[middle - 1 - i]);
                transfer * (above + below.unwrap_or(0.0))
            });
            // The spectrum holds amplitudes, and a sine of amplitude A has the power A²/2.
            libm::sqrt(2.0 * taken.sum::<f64>())
        };
        (self.band.first_bin()..=self.band.last_bin()).map(at).collect()
    }

    /// Returns the texture's power in each cell at a force of 1 N, newtons squared.
    fn cell_powers(&self, speed_mm_s: f64) -> Vec<f64> {
        let parameters = self.options.surface.parameters();
        let unit = parameters.unit();
        let departures = self.options.departures;
        let width = self.cell_hz / departures.pace_mm_s(speed_mm_s);
        let level = departures.level(speed_mm_s, 1.0);
        let kernel = contact_kernel();
        let noise: Vec<f64> = parameters.grains.iter().map(Grain::noise_power).collect();
        let both_axes = 1.0 + ACROSS.0 * ACROSS.0;
        let power = |(cell, filter): (usize, &f64)| {
            let per_mm = (cell as f64 + 0.5) * width;
            // The points of the relief cannot represent shorter waves.
            if per_mm >= 0.5 * POINTS_PER_MM {
                return 0.0;
            }
            let relief = unit * unit * relief_power(parameters, &noise, per_mm, width);
            level * level * relief * reading(&kernel, per_mm).powi(2) * filter * both_axes
        };
        self.filters.iter().enumerate().map(power).collect()
    }

    /// Writes the true magnitudes as a JSON object. The object contains the texture's magnitudes at
    /// 1 N, for speeds in steps of at most 2 % over the range of the motion. It also contains the
    /// sensor's noise, and the rule for combining noise and texture.
    ///
    /// # Errors
    /// When the writer fails.
    pub fn write_json(&self, out: impl Write) -> io::Result<()> {
        let [low, high] = match &self.options.motion {
            Motion::Free(free) => free.speed_mm_s,
            Motion::Sweeps => [self.options.speed_mm_s; 2],
        };
        let steps = libm::ceil(libm::log(high / low) / libm::log(SPEED_RATIO)).max(1.0);
        let speed = |step: usize| low * libm::exp(libm::log(high / low) * step as f64 / steps);
        let speeds: Vec<f64> = (0..=steps as usize).map(speed).collect();
        let text = TruthText {
            simulated: true,
            surface: self.options.surface.name(),
            rate_hz: self.options.rate_hz,
            unit: "N",
            rule: self.rule(),
            noise: libm::sqrt(self.noise_power),
            frequency_hz: self.frequency_hz(),
            per_newton: speeds.iter().map(|v| self.per_newton(*v)).collect(),
            speed_mm_s: speeds,
        };
        serde_json::to_writer(out, &text).map_err(io::Error::from)
    }
}

impl Truth {
    /// Returns the rule for combining the parts of a written truth.
    fn rule(&self) -> String {
        let force = match self.options.departures.level_force {
            1.0 => "force_n".to_owned(),
            exponent => format!("force_n^{exponent}"),
        };
        format!(
            "magnitude = sqrt(({force} * per_newton)^2 + noise^2); per_newton is one list per speed, linear in \
             ln(speed_mm_s) between them"
        )
    }
}

#[derive(Serialize)]
struct TruthText {
    simulated: bool,
    surface: &'static str,
    rate_hz: f64,
    unit: &'static str,
    rule: String,
    noise: f64,
    frequency_hz: Vec<f64>,
    speed_mm_s: Vec<f64>,
    per_newton: Vec<Vec<f64>>,
}

/// Returns the power of the relief in a cell of spatial frequency, relative to the square of
/// [`Parameters::unit`]. `noise` contains each grain's [`Grain::noise_power`].
fn relief_power(parameters: &Parameters, noise: &[f64], per_mm: f64, width: f64) -> f64 {
    let lines = parameters.lines.iter().map(|line| {
        // A phase that walks randomly gives a Lorentzian line. Its part below 0 is reflected.
        let half_width = line.wander * line.wander / (4.0 * PI);
        let below = |x: f64| libm::atan((x - line.per_mm) / half_width) / PI;
        let within = |from: f64, to: f64| below(to) - below(from);
        let (from, to) = (per_mm - 0.5 * width, per_mm + 0.5 * width);
        line.weight * line.weight * (within(from, to) + within(-to, -from))
    });
    let grains = parameters.grains.iter().zip(noise).map(|(grain, noise)| {
        let density = 2.0 / POINTS_PER_MM * grain.gain(per_mm) / noise;
        grain.weight * grain.weight * density * width
    });
    lines.chain(grains).sum()
}

/// Returns the gain, at a spatial frequency, of smoothing by the contact and of interpolating
/// between points.
fn reading(kernel: &[f64], per_mm: f64) -> f64 {
    // The kernel is symmetric, so its transform has only cosines.
    let turn = 2.0 * PI * per_mm / POINTS_PER_MM;
    let middle = (kernel.len() / 2) as f64;
    let smoothing =
        kernel.iter().enumerate().map(|(i, w)| w * libm::cos(turn * (i as f64 - middle)));
    smoothing.sum::<f64>() * cubic_gain(turn)
}

/// Returns the gain of the cubic interpolation for `turn` radians per point: the transform of its
/// kernel, by Simpson's rule.
fn cubic_gain(turn: f64) -> f64 {
    const STEPS: usize = 16;
    let at = |t: f64| {
        let terms = cubic_weights(t)
            .into_iter()
            .enumerate()
            .map(|(i, w)| w * libm::cos(turn * (t + 1.0 - i as f64)));
        terms.sum::<f64>()
    };
    let simpson = |i: usize| {
        let weight = match i {
            0 | STEPS => 1.0,
            i if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        weight * at(i as f64 / STEPS as f64)
    };
    (0..=STEPS).map(simpson).sum::<f64>() / (3.0 * STEPS as f64)
}

/// Returns the power transfer of the periodic Hann window at the middles of the cells above its
/// frequency.
fn window_powers() -> Vec<f64> {
    let power = |cell: usize| {
        let x = (cell as f64 + 0.5) / CELLS as f64;
        // Middles of cells are never at 0 or 1, where this would divide by zero.
        let sinc = libm::sin(PI * x) / (PI * x);
        (sinc / (1.0 - x * x)).powi(2)
    };
    (0..WINDOW_BINS * CELLS).map(power).collect()
}

impl Grain {
    /// Returns the squared gain of the grain's filters at a spatial frequency, periods per
    /// millimetre.
    pub(super) fn gain(&self, per_mm: f64) -> f64 {
        let high =
            OnePole::new(self.from_per_mm, POINTS_PER_MM).high_pass_power(per_mm, POINTS_PER_MM);
        let low = OnePole::new(self.to_per_mm, POINTS_PER_MM).low_pass_power(per_mm, POINTS_PER_MM);
        high * low * low
    }

    /// Returns the power of the grain's filtered noise when the white noise has power 1.
    pub(super) fn noise_power(&self) -> f64 {
        const CELLS: usize = 4096;
        let at = |cell: usize| self.gain((cell as f64 + 0.5) / CELLS as f64 * 0.5 * POINTS_PER_MM);
        (0..CELLS).map(at).sum::<f64>() / CELLS as f64
    }
}
