//! The voice, which sends white noise through the zeros, then through the poles.
//!
//! When parameters change, the coefficients of the zeros and the reflection coefficients of the
//! poles move linearly to their new values. During the change, the reflection coefficients stay
//! inside (-1, 1), so every filter is stable.

use alloc::boxed::Box;

use htex_dsp::all_pole::{AllPole, Group};
use htex_dsp::all_zero::AllZero;
use htex_dsp::band_limit::PassedPower;
use htex_dsp::grid::Band;
use htex_model::filtered::{MovingFilter, unstable};
use htex_model::{Error, Values};

use crate::filter::Filter;
use crate::{MAX_ORDER, MODEL_RATE};

/// A filter whose zeros and poles move to target values.
pub struct MovingZerosAndPoles {
    zeros: AllZero,
    poles: AllPole,
    target: Box<Filter>,
    /// Working memory in which the next target is made. If the parameters are valid, it replaces
    /// the target.
    spare: Box<Filter>,
    zeros_step: [f64; MAX_ORDER],
    reflection_step: [f64; MAX_ORDER],
}

impl MovingFilter for MovingZerosAndPoles {
    const RATE_FIELD: usize = MODEL_RATE;

    fn new(
        parameters: &Values<'_>,
        band: Band,
        passed: &PassedPower,
    ) -> Result<(Self, f64), Error> {
        let filter = Filter::new(parameters)?;
        // The level is checked without the filters at the band's edges, because a filter without
        // energy in the band may have energy just outside it.
        filter.level(band)?;
        let level = filter.passed_level(passed)?;
        let moving = Self {
            zeros: AllZero::new(filter.zeros()).ok_or_else(unstable)?,
            poles: AllPole::with_max_order(filter.poles(), MAX_ORDER).ok_or_else(unstable)?,
            target: Box::new(filter),
            spare: Box::new(Filter::one(parameters.scalar(MODEL_RATE))),
            zeros_step: [0.0; MAX_ORDER],
            reflection_step: [0.0; MAX_ORDER],
        };
        Ok((moving, level))
    }

    fn set_target(
        &mut self,
        parameters: &Values<'_>,
        passed: &PassedPower,
        steps: u32,
    ) -> Result<f64, Error> {
        self.spare.set(parameters)?;
        let level = self.spare.passed_level(passed)?;
        core::mem::swap(&mut self.target, &mut self.spare);
        let target = &*self.target;
        self.zeros.raise_order(target.zeros().len());
        self.poles.raise_order(target.poles().len());
        let scale = 1.0 / f64::from(steps);
        let zeros = (&*self.zeros.coefficients_mut(), target.zeros_of_any_order());
        spread(&mut self.zeros_step, zeros, scale);
        let reflection = (&*self.poles.reflection_mut(), target.reflection());
        spread(&mut self.reflection_step, reflection, scale);
        Ok(level)
    }

    fn step(&mut self, is_last: bool) {
        let (zeros, reflection) = (self.zeros.coefficients_mut(), self.poles.reflection_mut());
        if is_last {
            let orders = [zeros.len(), reflection.len()];
            zeros.copy_from_slice(&self.target.zeros_of_any_order()[..orders[0]]);
            reflection.copy_from_slice(&self.target.reflection()[..orders[1]]);
            return;
        }
        add(zeros, &self.zeros_step);
        add(reflection, &self.reflection_step);
    }

    fn tick(&mut self, x: f64) -> f64 {
        let driven = self.zeros.tick(x);
        self.poles.tick(driven)
    }

    fn process(&mut self, block: &mut [Group]) {
        self.zeros.process(block.as_flattened_mut());
        self.poles.process(block);
    }
}

fn add(to: &mut [f64], step: &[f64; MAX_ORDER]) {
    to.iter_mut().zip(step).for_each(|(x, step)| *x += step);
}

/// Writes the steps per sample from the current coefficients to other coefficients.
fn spread(step: &mut [f64; MAX_ORDER], (now, to): (&[f64], &[f64; MAX_ORDER]), scale: f64) {
    for ((step, now), to) in step.iter_mut().zip(now).zip(to) {
        *step = (to - now) * scale;
    }
}
