//! The rows of the table, by kind.

mod arma;
mod autoregression;
mod beta;
mod cepstrum;
#[cfg(feature = "pipeline")]
mod files;
mod map;
mod mixing;
#[cfg(feature = "pipeline")]
mod motion;
mod prediction;
mod recordings;
mod slope;
mod sound;
mod voices;

use crate::Section;

pub(crate) fn sections() -> Vec<Section> {
    vec![
        recordings::SECTION,
        prediction::SECTION,
        autoregression::SECTION,
        arma::SECTION,
        map::SECTION,
        mixing::SECTION,
        beta::SECTION,
        slope::SECTION,
        cepstrum::SECTION,
        voices::SECTION,
        sound::SECTION,
        #[cfg(feature = "pipeline")]
        files::SECTION,
        #[cfg(feature = "pipeline")]
        motion::SECTION,
    ]
}
