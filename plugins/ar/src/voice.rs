//! The voice, which sends white noise through the all-pole filter.

use htex_dsp::all_pole::{AllPole, Group};
use htex_dsp::band_limit::PassedPower;
use htex_dsp::grid::Band;
use htex_dsp::linear_prediction::step_down_in_place;
use htex_model::filtered::{FilteredVoice, MovingFilter, finite_level, unstable};
use htex_model::{Error, Values, Voice};

use crate::{COEFFICIENTS, Filter, MAX_ORDER, MODEL_RATE, together};

/// An all-pole filter whose reflection coefficients move linearly to target values. A filter is
/// stable if all its reflection coefficients are inside (-1, 1). Therefore, if the filters before
/// and after the change are stable, every filter in between is also stable.
pub struct MovingPoles {
    pub(crate) poles: AllPole,
    target: [f64; MAX_ORDER],
    step: [f64; MAX_ORDER],
}

impl MovingFilter for MovingPoles {
    const RATE_FIELD: usize = MODEL_RATE;

    fn new(
        parameters: &Values<'_>,
        band: Band,
        passed: &PassedPower,
    ) -> Result<(Self, f64), Error> {
        // The level is checked without the filters at the band's edges, because a filter without
        // energy in the band may have energy just outside it.
        Filter::new(parameters)?.level(band)?;
        let (target, level) = target(parameters, passed)?;
        let poles = AllPole::with_max_order(parameters.list(COEFFICIENTS), MAX_ORDER);
        let poles = poles.ok_or_else(unstable)?;
        Ok((Self { poles, target, step: [0.0; MAX_ORDER] }, level))
    }

    fn set_target(
        &mut self,
        parameters: &Values<'_>,
        passed: &PassedPower,
        steps: u32,
    ) -> Result<f64, Error> {
        let level;
        (self.target, level) = target(parameters, passed)?;
        self.poles.raise_order(parameters.list(COEFFICIENTS).len());
        let scale = 1.0 / f64::from(steps);
        for (i, k) in self.poles.reflection_mut().iter().enumerate() {
            self.step[i] = (self.target[i] - k) * scale;
        }
        Ok(level)
    }

    fn step(&mut self, is_last: bool) {
        for (i, k) in self.poles.reflection_mut().iter_mut().enumerate() {
            *k = if is_last { self.target[i] } else { *k + self.step[i] };
        }
    }

    fn tick(&mut self, x: f64) -> f64 {
        self.poles.tick(x)
    }

    fn process(&mut self, block: &mut [Group]) {
        self.poles.process(block);
    }

    fn render_together(voices: &mut [&mut FilteredVoice<Self>], frames: usize, out: &mut [f32]) {
        let mut rows = out.chunks_exact_mut(frames.max(1));
        let (fours, others) = voices.as_chunks_mut();
        for four in fours {
            if let [Some(a), Some(b), Some(c), Some(d)] = [(); 4].map(|()| rows.next()) {
                together::render(four, [a, b, c, d]);
            }
        }
        for (voice, row) in others.iter_mut().zip(rows) {
            voice.render(row);
        }
    }
}

/// Returns the reflection coefficients of a parameter set, and the level after the filters at the
/// band's edges.
fn target(parameters: &Values<'_>, passed: &PassedPower) -> Result<([f64; MAX_ORDER], f64), Error> {
    let coefficients = parameters.list(COEFFICIENTS);
    let mut reflection = [0.0; MAX_ORDER];
    let used = &mut reflection[..coefficients.len()];
    used.copy_from_slice(coefficients);
    if !step_down_in_place(used) {
        return Err(unstable());
    }
    let level = finite_level(passed.all_pole_level_rms(coefficients))?;
    Ok((reflection, level))
}
