//! Makes the result of a job. A job fits models to recordings or signals, or imports a texture from
//! a file of another format.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::PathBuf;

use htex_author::recording::{ReadError, ReadProblem, Recording, read_recording};
use htex_author::settings::{Metadata, ReadingSettings};
use htex_author::{
    AssetRequest, AuthorError, Exploration, FeltError, FittedAsset, Take, embed_plugins, fit_asset,
};
use htex_base::files::{AtFile, FileError, read_regular};
use htex_exchange::{Import, MOST_BYTES, Physical, Profile, fit_signals};
use htex_format::Asset;
use htex_host::Registry;

use crate::BuildError;
use crate::findings::by_code;
use crate::imports::{FileKind, refused};
use crate::job::{Job, JobFile, JobRecording};
use crate::job_result::{JobResult, Outcome, Record};
use crate::sound::sound;
use crate::thumbnail::{Thumbnail, of_magnitudes, thumbnail};

/// The name of a texture until it is assembled.
const UNNAMED: &str = "texture";

impl Job {
    /// Makes the texture.
    pub(crate) fn make(&self, registry: &Registry) -> Result<JobResult, Box<dyn Error>> {
        let (mut asset, record) = match self.kind {
            FileKind::Asset => self.imported(registry)?,
            FileKind::Recording | FileKind::Signal => self.fitted(registry)?,
        };
        let plays = Metadata {
            contact: self.metadata.contact,
            law: self.metadata.law,
            ..Metadata::default()
        };
        plays.apply(&mut asset.manifest);
        // The job may come from another process, so its numbers may not fit together.
        let travelling = self.plugins.len() - self.embedded.min(self.plugins.len());
        let files: Vec<PathBuf> =
            self.plugins[travelling..].iter().map(|f| f.path.clone()).collect();
        embed_plugins(&mut asset, registry, &files, None)?;
        let bytes = asset.to_bytes()?;
        let sound = sound(&bytes, registry)?;
        Ok(JobResult { record, asset: bytes, sound })
    }

    /// Imports the texture that a file of another format contains.
    fn imported(&self, registry: &Registry) -> Result<Unfinished, Box<dyn Error>> {
        let [recording] = &self.recordings[..] else {
            return Err("a texture that is stated has one file".into());
        };
        let bytes = recording.bytes()?;
        let how = Import {
            name: UNNAMED,
            tool: &self.program,
            physical: self.physical(recording),
            ..Import::default()
        };
        let imported = htex_exchange::import(&recording.name, &bytes, &how, registry);
        let asset = imported.map_err(refused)?.asset;
        let record = Record {
            outcome: Outcome::Fitted,
            segments: Vec::new(),
            felt: BTreeMap::new(),
            findings: Vec::new(),
            thumbnail: played(&asset, registry)?,
        };
        Ok((asset, record))
    }

    fn fitted(&self, registry: &Registry) -> Result<Unfinished, Box<dyn Error>> {
        let takes = self.recordings.iter().map(|recording| self.read_take(recording));
        let request = self.request(registry)?.with_law_of(&self.metadata);
        let takes = takes.collect::<Result<Vec<Take>, _>>()?;
        let mut fitted = match self.kind {
            FileKind::Signal => fit_signals(&takes, request, self.signal.full_scale)?,
            FileKind::Asset | FileKind::Recording => fit_asset(&takes, &request)?,
        };
        for source in &mut fitted.asset.manifest.provenance.recordings {
            let mut recordings = self.recordings.iter();
            if let Some(recording) = recordings.find(|recording| recording.name == source.file) {
                // A folder has no meaning on other machines, so only the name is stored. The hash
                // tells apart recordings of the same name.
                source.file = recording.file.name();
                source.blake3 = Some(recording.file.hash.blake3.clone());
            }
        }
        let record = Record {
            outcome: Outcome::Fitted,
            segments: fitted
                .spectra
                .iter()
                .filter(|spectrum| spectrum.is_recorded())
                .map(|spectrum| spectrum.segments)
                .collect(),
            felt: felt(&fitted),
            findings: by_code(&fitted.findings),
            thumbnail: fitted.spectra.first().map(thumbnail).unwrap_or_default(),
        };
        Ok((fitted.asset, record))
    }

    /// Returns the request for the fit.
    fn request(&self, registry: &Registry) -> Result<AssetRequest, AuthorError> {
        if self.kind == FileKind::Signal {
            let reading = ReadingSettings::default();
            return self.fit.request(registry, &reading, UNNAMED, &self.program);
        }
        let reading = ReadingSettings {
            tracker: Some(self.trackers().map(|file| file.path.clone()).collect()),
            ..self.reading.clone()
        };
        self.fit.request(registry, &reading, UNNAMED, &self.program)
    }

    /// Reads a recording, or a signal.
    fn read_take(&self, recording: &JobRecording) -> Result<Take, Box<dyn Error>> {
        if self.kind == FileKind::Signal {
            return self.signal(recording);
        }
        let reading = ReadingSettings {
            tracker: recording.tracker.as_ref().map(|file| vec![file.path.clone()]),
            ..self.reading.clone()
        };
        let options = reading.read_options(1)?.pop().unwrap_or_default();
        let given = Exploration { speed_mm_s: recording.speed_mm_s, force_n: recording.force_n };
        let file = &recording.file.path;
        match read_recording(file, &options) {
            Ok(read) => {
                Ok(Take { recording: Recording { source: recording.name.clone(), ..read }, given })
            }
            Err(ReadError { problem: ReadProblem::Io(error), .. }) => {
                Err(Box::new(BuildError::from(FileError::reading(file, error))))
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Returns the settings for the values that a file of another format does not contain.
    fn physical(&self, recording: &JobRecording) -> Physical {
        Physical {
            full_scale: self.signal.full_scale,
            quantity: self.reading.quantity.unwrap_or_default(),
            speed_mm_s: recording.speed_mm_s,
            force_n: recording.force_n,
            pitch_mm: self.signal.pitch_mm,
        }
    }

    /// Reads a signal of another format.
    fn signal(&self, recording: &JobRecording) -> Result<Take, Box<dyn Error>> {
        let bytes = recording.bytes()?;
        let physical = self.physical(recording);
        let profile = self.signal.profile.as_deref().map(Profile::find).transpose()?;
        let read = htex_exchange::recording_of(&recording.name, &bytes, &physical, profile)?;
        Ok(Take {
            recording: read,
            given: Exploration { speed_mm_s: recording.speed_mm_s, force_n: recording.force_n },
        })
    }

    fn trackers(&self) -> impl Iterator<Item = &JobFile> {
        self.recordings.iter().filter_map(|recording| recording.tracker.as_ref())
    }
}

impl JobRecording {
    /// Reads a file of another format.
    fn bytes(&self) -> Result<Vec<u8>, BuildError> {
        let path = &self.file.path;
        Ok(read_regular(path, MOST_BYTES).reading(path)?)
    }
}

/// An asset without plugins, with its record.
type Unfinished = (Asset, Record);

/// Returns the spectrum that an asset plays at its default condition.
fn played(asset: &Asset, registry: &Registry) -> Result<Thumbnail, htex_play::Error> {
    let frequency_hz = asset.manifest.band.grid_hz();
    let asset = htex_play::Texture::with_registry(asset.clone(), registry.clone());
    let magnitude = asset.magnitude(None, &frequency_hz)?;
    Ok(of_magnitudes(&frequency_hz, &magnitude))
}

/// Returns how much of the difference from the recordings is felt, for each model at its worst
/// recorded condition.
fn felt(fitted: &FittedAsset) -> BTreeMap<String, FeltError> {
    let models = fitted.asset.manifest.representations.iter();
    let worst = models.zip(&fitted.felt).filter_map(|(representation, felt)| {
        let worst = felt.iter().copied().flatten().reduce(FeltError::worse)?;
        Some((representation.model.clone(), worst))
    });
    worst.collect()
}
