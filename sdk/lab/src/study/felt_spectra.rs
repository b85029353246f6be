//! Exports the spectra of the felt forces as a table, for analyses.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::{Path, PathBuf};

use htex_author::recording::read_recording;
use htex_author::{
    Exploration, SegmentSpectra, SpectrumOptions, Take, TextureSpectrum, segment_take,
};
use htex_base::files::{AtFile, FileError};
use htex_base::finding::as_text;
use htex_dsp::Band;
use htex_format::{Asset, Condition, Quantity};

use crate::error::LabError;
use crate::record::{TakeHeader, header_beside, settings_of};
use crate::study::export::{OffTarget, sessions_of};
use crate::study::lines::FeltFile;
use crate::study::log::file_hash;

/// In the lines of real textures, the columns participant and model contain this text.
const RECORDED: &str = "recorded";

/// The recorded spectrum of a real texture.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    pub quantity: Quantity,
    /// Magnitudes at 20, 25, …, 1000 Hz.
    pub magnitude: Vec<f64>,
}

/// The table of spectra.
#[derive(Debug, Clone, PartialEq)]
pub struct FeltSpectra {
    /// The table as CSV: participant, texture, model, then a magnitude at 20, 25, …, 1000 Hz. The
    /// last lines contain the spectra of the real textures, one line for each texture.
    pub csv: String,
    /// Number of recordings that were read.
    pub recordings: usize,
    /// Number of recordings that come from trials whose motion left the study's target.
    /// [`OffTarget`] determines whether they were read.
    pub off_target: usize,
    /// Warnings that an analysis must consider, as sentences.
    pub warnings: Vec<String>,
}

impl Reference {
    /// Reads the spectrum of a recording of a real texture. If `strict` is true, any problem of the
    /// recording's signals is an error.
    ///
    /// # Errors
    /// Returns [`LabError::File`] if no texture spectrum from 20 to 1000 Hz can be read from the
    /// recording.
    pub fn from_recording(
        take: &Take,
        file: &Path,
        options: &SpectrumOptions,
        strict: bool,
    ) -> Result<Self, LabError> {
        let reading = segment_take(take, options, strict).map_err(FileError::in_file(file))?;
        Ok(Self::average(&[reading.spectra], options).map_err(FileError::in_file(file))?)
    }

    /// Returns the recorded spectrum that an asset stores, at the condition nearest to a motion. If
    /// the motion is unknown, returns the spectrum at the first condition.
    ///
    /// # Errors
    /// Returns [`LabError::File`] if the asset cannot be read or does not have the spectrum.
    pub fn from_asset(file: &Path, motion: Exploration) -> Result<Self, LabError> {
        let asset = Asset::open(file).map_err(FileError::in_file(file))?;
        let conditions = asset.manifest.conditions.iter().enumerate();
        let off = |condition: &Condition| {
            let off = |own: Option<f64>, wanted: Option<f64>| match own.zip(wanted) {
                Some((own, wanted)) if wanted != 0.0 => ((own - wanted) / wanted).abs(),
                _ => 0.0,
            };
            off(condition.speed_mm_s, motion.speed_mm_s) + off(condition.force_n, motion.force_n)
        };
        let nearest = conditions.min_by(|(_, a), (_, b)| off(a).total_cmp(&off(b)));
        let spectra = asset.reference.as_ref();
        let spectrum = nearest.and_then(|(at, _)| spectra?.get(at));
        let spectrum = spectrum.ok_or("the asset has no recorded spectrum; make it with `htex fit --keep-reference`, or name the recording of the texture (--recorded TEXTURE=FILE)").map_err(FileError::in_file(file))?;
        let magnitude = spectrum.iter().map(|m| f64::from(*m)).collect();
        let whole = Self::whole(asset.manifest.band, asset.manifest.quantity, magnitude);
        Ok(whole.map_err(FileError::in_file(file))?)
    }

    fn average(
        parts: &[SegmentSpectra],
        options: &SpectrumOptions,
    ) -> Result<Self, Box<dyn Error>> {
        let spectrum = TextureSpectrum::average(parts, options.averaging)?;
        Ok(Self::whole(spectrum.band, spectrum.quantity, spectrum.magnitude)?)
    }

    fn whole(band: Band, quantity: Quantity, magnitude: Vec<f64>) -> Result<Self, String> {
        if band == Band::TACTILE {
            Ok(Self { quantity, magnitude })
        } else {
            Err(format!(
                "its spectrum is one of {} to {} Hz, and the table has 20 to 1000 Hz; record at 2000 Hz or more",
                band.low_hz, band.high_hz
            ))
        }
    }
}

/// Computes the spectra of the felt forces in a folder of answers. For each combination of
/// participant, texture and model, reads the recordings of all trials and averages their spectra,
/// in the same way as `htex fit` does for several recordings of one condition. `off_target` states
/// how to treat trials whose motion left the study's target. `recorded` contains the spectra of the
/// real textures by name.
///
/// # Errors
/// Returns the errors of [`crate::study::export()`]. Returns [`LabError::NotRecorded`] if there are
/// no recordings. Returns [`LabError::File`] if a recording does not belong to its trial or has no
/// spectrum, or if the spectrum of a real texture is missing.
pub fn felt_spectra(
    folder: &Path,
    recorded: &BTreeMap<String, Reference>,
    options: &SpectrumOptions,
    off_target: OffTarget,
) -> Result<FeltSpectra, LabError> {
    let mut rows = Vec::new();
    let (mut textures, mut quantities) = (BTreeSet::new(), BTreeSet::new());
    let (mut recordings, mut off, mut warnings) = (0, 0, Vec::new());
    for session in sessions_of(folder)? {
        let participant = &session.header.participant;
        // A trial with several questions has only one recording. The last answer of the trial names
        // it.
        let mut conditions: BTreeMap<(String, String), BTreeMap<u32, FeltFile>> = BTreeMap::new();
        for answer in session.answers {
            let Some(felt) = answer.felt else { continue };
            let condition = conditions.entry((answer.texture, answer.model));
            condition.or_default().insert(answer.number, felt);
        }
        if conditions.is_empty() {
            warnings.push(format!("{participant} has no recordings of what was felt"));
        }
        for ((texture, model), mut trials) in conditions {
            let all = trials.len();
            let is_off = |felt: &FeltFile| !felt.off_target.is_empty();
            let own_off = trials.values().filter(|felt| is_off(felt)).count();
            off += own_off;
            if off_target == OffTarget::LeaveOut {
                trials.retain(|_, felt| !is_off(felt));
            }
            if own_off > 0 {
                warnings.push(format!(
                    "{participant}, {texture}, {model}: {own_off} of {all} recordings are off the study's target and {}",
                    match (off_target, trials.is_empty()) {
                        (OffTarget::Keep, _) => "kept",
                        (OffTarget::LeaveOut, false) => "left out",
                        (OffTarget::LeaveOut, true) => "left out: there is no spectrum",
                    }
                ));
            }
            if trials.is_empty() {
                continue;
            }
            let mut parts = Vec::new();
            for felt in trials.values() {
                parts.push(part(folder, felt, options)?);
                recordings += 1;
            }
            let felt = Reference::average(&parts, options)
                .map_err(FileError::in_file(folder.join(participant)))?;
            quantities.insert(felt.quantity);
            rows.push(row(participant, &texture, &model, &felt));
            textures.insert(texture);
        }
    }
    if recordings + off == 0 {
        return Err(LabError::NotRecorded { folder: folder.to_owned() });
    }
    for texture in &textures {
        let Some(reference) = recorded.get(texture) else {
            let problem = format!(
                "the spectrum of the real texture {texture} is missing; name its recording (--recorded {texture}=FILE) or the study \
                 whose asset has it (--study)"
            );
            return Err(FileError::content(folder, problem).into());
        };
        quantities.insert(reference.quantity);
        rows.push(row(RECORDED, texture, RECORDED, reference));
    }
    if quantities.len() > 1 {
        let names: Vec<&str> = quantities.iter().map(|quantity| quantity.name()).collect();
        warnings.push(format!("the spectra are of several quantities: {}", names.join(", ")));
    }
    Ok(FeltSpectra { csv: table(folder, &rows)?, recordings, off_target: off, warnings })
}

/// Reads a recording, and checks that it belongs to its trial.
fn part(
    folder: &Path,
    felt: &FeltFile,
    options: &SpectrumOptions,
) -> Result<SegmentSpectra, LabError> {
    let file: PathBuf = felt.file.split('/').fold(folder.to_owned(), |path, part| path.join(part));
    let other = |problem: &str| {
        let problem = format!(
            "it is not the recording that was made in the trial ({problem}); restore it from a copy"
        );
        LabError::from(FileError::content(&file, problem))
    };
    // The name comes from the answers, which may come from another person.
    if felt.file.split('/').any(|part| matches!(part, "" | "." | "..")) {
        return Err(other("its name leaves the folder of answers"));
    }
    if file_hash(&file)? != felt.blake3 {
        return Err(other("its hash is another one"));
    }
    let beside = file.with_extension("json");
    let header = header_beside(&beside)
        .reading(&beside)?
        .ok_or("it does not describe a recording")
        .map_err(FileError::in_file(&beside))?;
    let take = open_take(&file, &header).map_err(FileError::in_file(&file))?;
    Ok(segment_take(&take, options, false).map_err(FileError::in_file(&file))?.spectra)
}

fn open_take(file: &Path, header: &TakeHeader) -> Result<Take, Box<dyn Error>> {
    let options = settings_of(file, header).read_options(1)?.into_iter().next().unwrap_or_default();
    // The recording is read at every motion of the participant. The tolerance of 10 % applies only
    // to recordings of real textures.
    Ok(Take { recording: read_recording(file, &options)?, given: Exploration::default() })
}

fn row(participant: &str, texture: &str, model: &str, spectrum: &Reference) -> Vec<String> {
    let names = [participant, texture, model].map(|name| as_text(name).into_owned());
    let magnitudes = spectrum.magnitude.iter().map(|m| format!("{m}"));
    names.into_iter().chain(magnitudes).collect()
}

fn table(folder: &Path, rows: &[Vec<String>]) -> Result<String, LabError> {
    let mut csv = csv::WriterBuilder::new().from_writer(Vec::new());
    let names = ["participant", "texture", "model"].map(str::to_owned);
    let grid = Band::TACTILE.grid_hz();
    let head = names.into_iter().chain(grid.iter().map(|f| format!("{f}")));
    let head: Vec<String> = head.collect();
    for row in std::iter::once(&head).chain(rows) {
        csv.write_record(row).writing(folder)?;
    }
    let bytes = csv.into_inner().unwrap_or_default();
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
