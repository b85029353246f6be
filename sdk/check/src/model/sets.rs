//! Parameter sets for testing a model, in addition to the sets that are fitted to reference
//! spectra.

use htex_host::{Band, Field, FitCondition, HostError, Kind, Status, Store};
use htex_model::{Values, flatten};

use crate::harness::Finding;
use crate::model::case::{Case, RATE_HZ, is_cannot_fit};
use crate::model::random::Random;
use crate::model::spectra::{REFERENCES, Reference};

/// Number of random sets in a check. They are determined by a seed.
pub(crate) const SEEDED: usize = 16;
/// Number of attempts to find a random set that the model accepts. Parameters within their ranges
/// need not describe a spectrum.
const TRIES: usize = 20;
/// Maximum length of a list in a random set.
const LONGEST: usize = 32;
/// Duration of the signals that are made from a spectrum, seconds.
const SIGNAL_S: f64 = 0.5;
/// Rate at which a modulated signal changes between loud and quiet, hertz.
const MODULATION_HZ: f64 = 8.0;

/// A parameter set with a description.
#[derive(Debug, Clone)]
pub(crate) struct Set {
    pub(crate) name: String,
    pub(crate) parameters: Vec<f64>,
}

/// A set with one field at an end of its range, and the same set with the field slightly inside.
pub(crate) struct AtBound {
    pub(crate) set: Set,
    /// The same set, with the field a thousandth of the range further inside.
    pub(crate) inside: Vec<f64>,
    /// Whether this end of the range is 0, which may mean silence.
    pub(crate) is_zero: bool,
}

impl Case {
    /// Splits parameters into the numbers of each field.
    pub(crate) fn lists(&self, parameters: &[f64]) -> Result<Vec<Vec<f64>>, Finding> {
        let descriptor = self.model.descriptor();
        let values =
            Values::read(descriptor, parameters).map_err(|e| Finding::failed(e.message))?;
        let fields = 0..descriptor.fields.len();
        Ok(fields.map(|i| values.list(i).to_vec()).collect())
    }

    pub(crate) fn flat(&self, lists: &[Vec<f64>]) -> Vec<f64> {
        let lists: Vec<&[f64]> = lists.iter().map(Vec::as_slice).collect();
        flatten(self.model.descriptor(), &lists)
    }

    /// For each field and both ends of its range, returns a set in which the field is at this end.
    /// The numbers are rounded as a file would store them. If the field is a list, all its numbers
    /// are at the end.
    pub(crate) fn at_bounds(&self, parameters: &[f64]) -> Result<Vec<AtBound>, Finding> {
        let lists = self.lists(parameters)?;
        let mut sets = Vec::new();
        for (i, field) in self.model.descriptor().fields.iter().enumerate() {
            // Halves are subtracted, because the whole range may be infinite.
            let step = 1e-3 * (0.5 * field.max - 0.5 * field.min);
            for (bound, inner) in [(field.min, field.min + step), (field.max, field.max - step)] {
                let with = |number: f64| {
                    let mut lists = lists.clone();
                    lists[i].iter_mut().for_each(|x| *x = number);
                    self.flat(&lists)
                };
                sets.push(AtBound {
                    set: Set {
                        name: format!("`{}` = {bound}", field.name),
                        parameters: with(bound),
                    },
                    inside: with(inner),
                    is_zero: bound == 0.0,
                });
            }
        }
        Ok(sets)
    }

    /// Returns a random set within the ranges. Each field is either random or has the value of
    /// `near`.
    pub(crate) fn drawn(&self, near: &[f64], random: &mut Random) -> Result<Vec<f64>, Finding> {
        let mut lists = self.lists(near)?;
        for (list, field) in lists.iter_mut().zip(&self.model.descriptor().fields) {
            if let Kind::List { max_len } = field.kind
                && random.below(2) == 0
            {
                let most = LONGEST.min(max_len as usize);
                list.resize(random.below(most + 1), field.min);
            }
            let is_kept = random.below(2) == 0;
            for x in list.iter_mut() {
                if !is_kept || random.below(4) == 0 {
                    *x = random.within(field.min, field.max);
                }
            }
        }
        Ok(self.flat(&lists))
    }

    /// Returns a random set within the ranges that the model accepts, or `None` if it refuses all
    /// attempts.
    pub(crate) fn seeded(&self, near: &[f64], seed: u64) -> Result<Option<Set>, Finding> {
        let mut random = Random::new(seed);
        for _ in 0..TRIES {
            let parameters = self.drawn(near, &mut random)?;
            if self.takes(&parameters, Band::TACTILE)? {
                let name = format!("seeded parameters {parameters:?}");
                return Ok(Some(Set { name, parameters }));
            }
        }
        Ok(None)
    }

    /// Returns whether the model has a magnitude for parameters within the ranges. Such parameters
    /// need not describe a spectrum in the band.
    ///
    /// # Errors
    /// When the magnitude is not finite, or the call fails in another way.
    pub(crate) fn takes(&self, parameters: &[f64], band: Band) -> Result<bool, Finding> {
        match self.model.magnitude(parameters, band, &band.grid_hz()) {
            Ok(_) => Ok(true),
            Err(error) if describes_nothing(&error) => Ok(false),
            Err(error) => Err(Finding::failed(format!("parameters {parameters:?}: {error}"))),
        }
    }

    /// Fits the reference spectra together with stationary and modulated signals. Leaves out
    /// spectra to which the model cannot be fitted.
    pub(crate) fn fitted_to_signals(&self) -> Result<Vec<Set>, Finding> {
        let mut sets = Vec::new();
        for reference in [&REFERENCES[0], &REFERENCES[4]] {
            for (kind, depth) in [("stationary", 0.0), ("modulated", 0.9)] {
                let name = format!("spectrum `{}` with a {kind} signal", reference.name);
                let signal = signal(reference, depth);
                let fit = || self.fit_signal(reference, &signal, FitCondition::default());
                match (fit(), fit()) {
                    (Ok(fit), Ok(again)) if fit == again => {
                        sets.push(Set { name, parameters: fit.parameters })
                    }
                    (Err(error), Err(_)) if is_cannot_fit(&error) => {}
                    (Err(error), _) | (_, Err(error)) => {
                        return Err(Finding::failed(format!("{name}: {error}")));
                    }
                    _ => {
                        let message = format!("{name}: a second fit returns other numbers");
                        return Err(Finding::failed(message));
                    }
                }
            }
        }
        Ok(sets)
    }
}

/// Returns whether a model may return this error for valid parameters. Parameters can be within
/// their ranges and still describe no spectrum in a band.
pub(crate) fn describes_nothing(error: &HostError) -> bool {
    matches!(
        error,
        HostError::Call {
            status: Status::InvalidParameters | Status::InvalidArgument | Status::CannotFit,
            ..
        }
    )
}

/// Returns a signal with a spectrum: one sine for each bin, with a level that changes by `depth` at
/// [`MODULATION_HZ`].
fn signal(reference: &Reference, depth: f64) -> Vec<f64> {
    let mut random = Random::new(1);
    let turn = std::f64::consts::TAU / RATE_HZ;
    let sines: Vec<(f64, f64, f64)> = Band::TACTILE
        .grid_hz()
        .into_iter()
        // The power of a bin is magnitude² / 3, and also half of amplitude².
        .map(|hz| {
            let amplitude = (reference.curve)(hz) * (2.0f64 / 3.0).sqrt();
            (turn * hz, amplitude, std::f64::consts::TAU * random.unit())
        })
        .collect();
    let sample = |i: usize| -> f64 {
        let t = i as f64;
        let sum: f64 = sines.iter().map(|(w, a, p)| a * (w * t + p).sin()).sum();
        let is_loud = (turn * MODULATION_HZ * t).sin() > 0.0;
        sum * if is_loud { 1.0 } else { 1.0 - depth }
    };
    (0..(SIGNAL_S * RATE_HZ) as usize).map(sample).collect()
}

/// Returns numbers as a file stores them. A value in its range stays in the range: if the nearest
/// value that can be stored is outside, the next one towards the range is used. The writer of
/// assets does the same.
pub(crate) fn stored(field: &Field, numbers: &[f64]) -> Vec<f64> {
    let Field { min, max, .. } = *field;
    let keep = |&x: &f64| {
        let nearest = nearest_stored(field.store, x, 0);
        let towards = match nearest {
            low if low < min => 1,
            high if high > max => -1,
            _ => return nearest,
        };
        match nearest_stored(field.store, x, towards) {
            next if (min..=max).contains(&next) && (min..=max).contains(&x) => next,
            _ => nearest,
        }
    };
    numbers.iter().map(keep).collect()
}

/// Returns the stored value nearest to a number, or the one above it (1) or below it (-1).
fn nearest_stored(store: Store, x: f64, towards: i8) -> f64 {
    let step = |scale: f64, offset: f64, log: bool, most: f64| {
        let y = if log { x.ln() } else { x };
        let step = ((y - offset) / scale).round() + f64::from(towards);
        let value = offset + scale * step.clamp(0.0, most);
        if log { value.exp() } else { value }
    };
    match (store, towards) {
        (Store::F64, _) => x,
        (Store::F32, 0) => f64::from(x as f32),
        (Store::F32, 1..) => f64::from((x as f32).next_up()),
        (Store::F32, _) => f64::from((x as f32).next_down()),
        (Store::U16 { scale, offset, log }, _) => step(scale, offset, log, 65_535.0),
        (Store::U8 { scale, offset, log } | Store::Packed { scale, offset, log }, _) => {
            step(scale, offset, log, 255.0)
        }
    }
}
