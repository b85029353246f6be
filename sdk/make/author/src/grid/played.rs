//! Spectra at motions other than the recorded ones. A player would play these spectra if a model
//! reproduced the recorded spectra without an error.

use htex_format::{AtCondition, Condition, Contact, Law};
use htex_play::exploration::CEILING;
use htex_play::{Conditions, Mesh, Motion};

use super::slopes::third_octaves;
use crate::TextureSpectrum;
use crate::conditions::ConditionSpectrum;
use crate::law::law;

/// Conditions with their spectra, interpolated and scaled as a player does it.
pub(super) struct PlayedSpectra {
    mesh: Mesh,
    conditions: Conditions,
    spectra: Vec<TextureSpectrum>,
    level_rms: Vec<f64>,
}

impl PlayedSpectra {
    /// `None` if there is no condition.
    pub(super) fn new(all: Vec<ConditionSpectrum>, contact: Contact) -> Option<Self> {
        let level = |one: &ConditionSpectrum| htex_dsp::grid::level_rms(&one.spectrum.magnitude);
        let level_rms: Vec<f64> = all.iter().map(level).collect();
        let (mesh, conditions) = mesh_of(&all, &level_rms, law(&all, contact))?;
        let spectra = all.into_iter().map(|one| one.spectrum).collect();
        Some(Self { mesh, conditions, spectra, level_rms })
    }

    /// Returns the energies in third octaves at a motion, decibels.
    pub(super) fn third_octaves_db(&self, [speed, force]: [f64; 2]) -> Vec<f64> {
        let scaling = self.conditions.scaling(Motion::new(speed, force), CEILING);
        let weights: Vec<(usize, f64)> = self.mesh.weights(speed, force).iter().collect();
        let level: f64 = weights.iter().map(|(i, w)| w * self.level_rms[*i]).sum();
        let gain = level * scaling.level;
        let shapes: Vec<Vec<f64>> = weights
            .iter()
            .map(|(i, _)| levels_db(&self.spectra[*i], scaling.frequency, self.level_rms[*i]))
            .collect();
        let bands = shapes.first().map_or(0, Vec::len);
        let mixed = |band: usize| {
            let parts = weights.iter().zip(&shapes);
            let shape: f64 = parts.map(|((_, weight), db)| weight * db[band]).sum();
            shape + 20.0 * libm::log10(gain)
        };
        (0..bands).map(mixed).collect()
    }
}

/// Multiplies the frequencies of a noise by `ratio`, and returns its energies in third octaves, in
/// decibels relative to a level.
pub(super) fn levels_db(spectrum: &TextureSpectrum, ratio: f64, level_rms: f64) -> Vec<f64> {
    let first = spectrum.band.first_bin() as f64;
    let power = |bin: usize| {
        let place = (first + bin as f64) / ratio - first;
        let below = libm::floor(place);
        let at = |k: f64| {
            let inside = k >= 0.0;
            let m = inside.then(|| spectrum.magnitude.get(k as usize)).flatten();
            m.map_or(0.0, |m| m * m)
        };
        let part = place - below;
        let above = if part > 0.0 { part * at(below + 1.0) } else { 0.0 };
        ((1.0 - part) * at(below) + above) / ratio
    };
    let energy = |bins: std::ops::Range<usize>| {
        let sum: f64 = bins.map(power).sum();
        10.0 * libm::log10(sum / (level_rms * level_rms))
    };
    third_octaves(spectrum.band).into_iter().map(energy).collect()
}

/// Returns the mesh and the motions with which a player interpolates between conditions with these
/// levels; `None` if there is no condition.
pub(super) fn mesh_of(
    all: &[ConditionSpectrum],
    level_rms: &[f64],
    law: Law,
) -> Option<(Mesh, Conditions)> {
    let conditions: Vec<Condition> = all.iter().map(|one| one.condition).collect();
    let at = |(condition, level_rms): (usize, &f64)| AtCondition {
        condition,
        level_rms: *level_rms,
        quality: None,
        left_out: None,
    };
    let at: Vec<AtCondition> = level_rms.iter().enumerate().map(at).collect();
    let points: Vec<[f64; 2]> = conditions.iter().map(motion).collect();
    let is_any = !points.is_empty();
    is_any.then(|| (Mesh::new(&points), Conditions::new(&at, &conditions, law)))
}

/// Returns speed and force of a condition, as a player uses them.
pub(super) fn motion(condition: &Condition) -> [f64; 2] {
    [condition.speed_mm_s, condition.force_n].map(|value| value.unwrap_or(0.0))
}
