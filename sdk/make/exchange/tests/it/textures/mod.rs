//! Textures of the simulated surfaces at 80 mm/s and 0.4 N.

use htex_author::settings::{FitSettings, ReadingSettings};
use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{Exploration, Take, fit_asset};
use htex_play::{Registry, Texture};

/// The representation by Bands of a surface.
pub fn texture(surface: Surface) -> Texture {
    let options = SimulationOptions::new(surface).with_duration_s(4.0);
    let recording = simulate(&options).unwrap().to_recording("simulated").unwrap();
    let settings = FitSettings { models: Some(vec!["bands".to_owned()]), ..FitSettings::default() };
    let registry = Registry::builtin();
    let reading = ReadingSettings::default();
    let request = settings.request(&registry, &reading, surface.name(), "tests").unwrap();
    let given = Exploration { speed_mm_s: Some(80.0), force_n: Some(0.4) };
    Texture::new(fit_asset(&[Take { recording, given }], &request).unwrap().asset)
}
