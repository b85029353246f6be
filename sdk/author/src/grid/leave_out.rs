//! Leave-one-out error: each condition predicted from its neighbours, as a player interpolates.

use htex_format::{Condition, LeftOut, Measure};
use htex_host::LoadedModel;
use htex_play::Mesh;

use crate::conditions::Group;
use crate::{agreement, read_spectrum};

/// Returns the error at each condition of the model's interpolation between the others, against the recorded spectrum
/// there; `None` where the others do not surround the condition, or the model cannot mix its neighbours.
pub(crate) fn left_out(
    model: &LoadedModel,
    conditions: &[Condition],
    groups: &[Group],
    parameters: &[Vec<f64>],
    level_rms: &[f64],
) -> Vec<Option<LeftOut>> {
    let points: Vec<[f64; 2]> = conditions.iter().map(motion).collect();
    let one = |i: usize| {
        let others: Vec<usize> = (0..points.len()).filter(|k| *k != i).collect();
        let places: Vec<[f64; 2]> = others.iter().map(|k| points[*k]).collect();
        let [speed, force] = points[i];
        let mesh = (!places.is_empty()).then(|| Mesh::new(&places))?;
        if !mesh.surrounds(speed, force) {
            return None;
        }
        let weights: Vec<(usize, f64)> = mesh.weights(speed, force).iter().collect();
        let of = |k: &(usize, f64)| others[k.0];
        let sets: Vec<&[f64]> = weights.iter().map(|k| &parameters[of(k)][..]).collect();
        let parts: Vec<f64> = weights.iter().map(|k| k.1).collect();
        let level: f64 = weights.iter().map(|k| k.1 * level_rms[of(k)]).sum();
        let reference = groups.get(i)?.spectrum.as_ref();
        let mixed = match &sets[..] {
            [only] => only.to_vec(),
            _ => model.interpolate(&sets, &parts).ok()?,
        };
        let magnitude = read_spectrum(model, &mixed, level, reference).ok()?;
        let error = agreement(reference, &magnitude);
        let finite = error.get(Measure::NineBand).is_some_and(f64::is_finite);
        finite.then(|| LeftOut(error.measures.only(LeftOut::measures())))
    };
    (0..points.len()).map(one).collect()
}

/// Returns speed and force of a condition, as a player reads them.
pub(super) fn motion(condition: &Condition) -> [f64; 2] {
    [condition.speed_mm_s, condition.force_n].map(|value| value.unwrap_or(0.0))
}
