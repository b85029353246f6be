//! Reads the spectrum of an accepted take from its files.

use std::path::Path;

use htex_author::recording::read_recording;
use htex_author::{Averaging, Exploration, SpectrumOptions, Take, TextureSpectrum, segment_take};
use htex_base::files::read_regular;
use htex_format::Quantity;
use serde::Deserialize;

use crate::record::beside::{MOST_BYTES, settings as settings_of};
use crate::record::data::TakeHeader;
use crate::record::format::Outcome;
use crate::record::live::LiveSpectrum;
use crate::record::names;

/// The parts of the JSON next to a recording that are needed here.
#[derive(Deserialize)]
struct Beside {
    outcome: Outcome,
    take: TakeHeader,
}

/// Returns the texture spectrum of the newest accepted take with this name, as `htex fit` would
/// read it. `None` if the folder has no such take of this quantity, or if its files can no longer
/// be read.
#[must_use]
pub fn kept_spectrum(folder: &Path, name: &str, quantity: Quantity) -> Option<LiveSpectrum> {
    let number = names::kept_number(folder, name)?;
    let stem = names::stem(name, number);
    let beside = folder.join(format!("{stem}.json"));
    let beside = read_regular(&beside, MOST_BYTES).ok()?;
    let Beside { outcome, take } = serde_json::from_slice(&beside).ok()?;
    if outcome != Outcome::Kept || take.quantity != quantity {
        return None;
    }
    let file = folder.join(format!("{stem}.{}", take.format.extension()));
    let options = settings_of(&file, &take).read_options(1).ok()?.pop()?;
    let take =
        Take { recording: read_recording(&file, &options).ok()?, given: Exploration::default() };
    let reading = segment_take(&take, &SpectrumOptions::default(), false).ok()?;
    let texture = TextureSpectrum::average(&[reading.spectra], Averaging::Rms).ok()?;
    Some(LiveSpectrum::of(&texture))
}
