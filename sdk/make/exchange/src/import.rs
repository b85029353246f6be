//! Imports files of other formats as assets.
//!
//! How a file is imported depends on its format. A HaTT file contains units, speeds and forces, so
//! it is converted to an asset without a fit. A glTF file contains an asset. An image is converted
//! to an asset with the full scale and the condition that the user gives. All other files contain a
//! signal between -1 and 1, and state no unit, speed or force. Such a signal becomes a recording
//! with the full scale and the condition that the user gives. Models are then fitted to this
//! recording. A signal that is shorter than a few seconds is repeated before the fit.

use htex_author::recording::RecordedFile;
use htex_author::settings::{FitSettings, Metadata, ReadingSettings};
use htex_author::{
    AssetRequest, AuthorError, Averaging, Coding, Exploration, FeltError, FittedAsset, Level,
    Recording, SegmentChoice, Take, fit_asset,
};
use htex_base::finding::{Hint, Notice};
use htex_format::Rights;
use htex_host::Registry;

use crate::error::{ExchangeError, Fault, in_file};
use crate::format::{Format, Naming, RATE_HZ, Reads};
use crate::map;
use crate::physical::{PITCH, Physical};
use crate::profile::Profile;
use crate::rights::FileRights;

/// A shorter signal is repeated until it has this length, seconds.
const LEAST_S: f64 = 4.0;

/// The note about an asset without a licence.
const UNLICENSED: &str = "It states no licence, and without one nobody may pass it on; give the licence of the imported file.";

/// Settings of an import.
#[derive(Debug, Clone, Default)]
pub struct Import<'a> {
    /// The asset's name, used if the file contains no name.
    pub name: &'a str,
    pub physical: Physical,
    /// The actuator, for files that give frequencies as positions in an actuator's range. If
    /// `None`, the format's default actuator is used.
    pub profile: Option<&'a Profile>,
    pub fit: FitSettings,
    pub metadata: Metadata,
    /// The text of the file `NAME.license` next to the imported file, if there is one
    /// ([`htex_format::license_file`]).
    pub license_file: Option<&'a str>,
    /// Program and version, stored in the provenance.
    pub tool: &'a str,
}

/// An imported asset, with results of the import that the asset's file does not store.
#[derive(Debug)]
#[non_exhaustive]
pub struct ImportedAsset {
    pub asset: htex_format::Asset,
    /// The bytes of the asset's file. `None` if the imported file does not contain the asset, or if
    /// the given metadata changes the asset.
    file: Option<Vec<u8>>,
    /// Difference between each fitted model and the signal, as a finger would feel it: one list for
    /// each representation, with one value for each condition. Empty if the import needs no fit.
    pub felt: Vec<Vec<Option<FeltError>>>,
    /// Ids of models that could not be fitted, each with the reason. Empty if the import needs no
    /// fit.
    pub skipped: Vec<(String, String)>,
    /// Warnings: problems that the user should know about.
    pub warnings: Vec<Notice>,
    /// Notes that are less important than warnings, e.g. that a licence is missing.
    pub notes: Vec<Notice>,
}

/// Imports a file as an asset. `file` is the file's name; its extension determines the format.
///
/// # Errors
/// Returns an error if no format has the extension, if the format does not accept a given setting,
/// if neither the file nor the settings contain a necessary value, if the file is invalid (the
/// error names the place), or if no model can be fitted.
///
/// ```
/// use htex_author::settings::FitSettings;
/// use htex_exchange::{Import, Physical, import};
/// let file = br#"{"version": {"major": 1}, "signals": {"continuous": {"envelopes": {
///     "amplitude": [{"time": 0, "amplitude": 0.5}, {"time": 1, "amplitude": 0.5}]}}}}"#;
/// let registry = htex_play::Registry::builtin();
/// let mut how = Import { name: "buzz", ..Import::default() };
/// let error = import("buzz.haptic", file, &how, &registry).unwrap_err();
/// assert!(error.to_string().contains("`full_scale`"));
/// how.physical = Physical { full_scale: Some(0.2), speed_mm_s: Some(80.0), force_n: Some(0.5), ..Physical::default() };
/// how.fit = FitSettings { models: Some(vec!["bands".to_owned()]), ..FitSettings::default() };
/// assert_eq!(import("buzz.haptic", file, &how, &registry)?.asset.manifest.name, "buzz");
/// # Ok::<(), htex_exchange::ExchangeError>(())
/// ```
pub fn import(
    file: &str,
    bytes: &[u8],
    how: &Import<'_>,
    registry: &Registry,
) -> Result<ImportedAsset, ExchangeError> {
    let format = Format::of_file(file)?;
    format.check_import(how.given())?;
    let mut imported = match format.reads {
        Some(Reads::Asset(read)) => read(bytes, &how.naming()).map_err(in_file(file))?,
        Some(Reads::Map) => mapped(format, file, bytes, how)?,
        _ => {
            let recording = recording_of(file, bytes, &how.physical, how.profile)?;
            fitted(recording, how, registry)?
        }
    };
    let given = Rights::new(how.metadata.license.as_deref(), how.metadata.author.as_deref());
    let stated = FileRights::read(format, bytes, how.license_file, &given)?;
    let own = Rights::from_manifest(&imported.asset.manifest);
    stated.check(&own, &given)?;
    let mut metadata = how.metadata.clone();
    // Statements of the asset itself are kept. The bytes of an asset inside the file also stay the
    // same.
    let missing = |own: &Option<String>, stated| if own.is_none() { stated } else { None };
    metadata.license = metadata.license.or(missing(&own.license, stated.rights.license));
    metadata.author = metadata.author.or(missing(&own.author, stated.rights.author));
    imported.warnings.extend(stated.left_out.into_iter().map(Into::into));
    imported.apply(&metadata);
    if imported.asset.manifest.license.is_none() {
        let asked = Notice::new(UNLICENSED, Hint::new(&["license"]));
        imported.notes.push(asked);
    }
    Ok(imported)
}

impl Import<'_> {
    const fn naming(&self) -> Naming<'_> {
        Naming { name: self.name, tool: self.tool }
    }

    /// Returns the keywords of the settings that were set.
    fn given(&self) -> Vec<&'static str> {
        let (physical, fit) = (&self.physical, &self.fit);
        // `all` is the default of the command line, and does not count as given.
        let is_all = |models: &Vec<String>| models[..] == ["all"];
        let all = [
            ("full_scale", physical.full_scale.is_some()),
            ("quantity", physical.quantity != htex_format::Quantity::default()),
            ("speed", physical.speed_mm_s.is_some()),
            ("force", physical.force_n.is_some()),
            ("pitch", physical.pitch_mm.is_some()),
            ("profile", self.profile.is_some()),
            ("model", fit.models.as_ref().is_some_and(|m| !is_all(m))),
            ("option", !fit.options.is_empty()),
            ("level", fit.level.is_some_and(|l| l != Level::default())),
            ("keep_reference", fit.keep_reference == Some(true)),
            ("storage", fit.storage.is_some_and(|c| c != Coding::default())),
            ("grid", fit.grid.is_some()),
        ];
        let given = all.into_iter().filter(|(_, is_given)| *is_given);
        given.map(|(setting, _)| setting).collect()
    }
}

impl ImportedAsset {
    /// Makes the result for an asset to which no model was fitted. `file` has the bytes of the
    /// asset, if the imported file contains them.
    pub(crate) fn new(
        asset: htex_format::Asset,
        file: Option<Vec<u8>>,
        warnings: Vec<String>,
    ) -> Self {
        Self {
            asset,
            file,
            felt: Vec::new(),
            skipped: Vec::new(),
            warnings: warnings.into_iter().map(Into::into).collect(),
            notes: Vec::new(),
        }
    }

    fn apply(&mut self, metadata: &Metadata) {
        let before = self.asset.manifest.clone();
        metadata.apply(&mut self.asset.manifest);
        if self.asset.manifest != before {
            // The bytes of the file no longer match the manifest. If nothing changed, they are
            // kept.
            self.file = None;
        }
    }

    /// Returns the bytes of the asset's file. If the imported file contains an asset, the bytes of
    /// this asset are returned unchanged. If not, the imported asset is encoded.
    ///
    /// # Errors
    /// Returns an error if the asset breaks a rule of its format.
    pub fn to_bytes(&self) -> Result<Vec<u8>, htex_format::WriteError> {
        match &self.file {
            Some(bytes) => Ok(bytes.clone()),
            None => self.asset.to_bytes(),
        }
    }
}

/// Imports an image of grey values over a surface.
fn mapped(
    format: &'static Format,
    file: &str,
    bytes: &[u8],
    how: &Import<'_>,
) -> Result<ImportedAsset, ExchangeError> {
    let physical = &how.physical;
    let values = physical.values(format)?;
    let image = map::read(bytes).map_err(in_file(file))?;
    let Some(pitch_mm) = physical.pitch_mm.or(image.pitch_mm) else {
        return Err(ExchangeError::Missing { format: format.title, missing: vec![PITCH] });
    };
    map::import(&image, pitch_mm, values, physical.quantity, how.naming()).map_err(in_file(file))
}

/// Reads a file as a recording. [`import`] does this before it fits models.
///
/// # Errors
/// Returns the errors of [`import`]. Also returns an error if the file does not contain a signal.
pub fn recording_of(
    file: &str,
    bytes: &[u8],
    physical: &Physical,
    profile: Option<&Profile>,
) -> Result<Recording, ExchangeError> {
    let format = Format::of_file(file)?;
    let values = physical.values(format)?;
    let signal = format.signal(file, bytes, values.speed_mm_s, profile)?;
    let mut samples: Vec<f64> = signal.samples.iter().map(|x| values.full_scale * x).collect();
    let mut warnings = signal.left_out;
    // Checked before samples are repeated, so that an empty signal is also refused.
    if !samples.iter().any(|x| *x != 0.0) {
        let silent = Fault::whole("it is silent, and nothing can be fitted to it");
        return Err(in_file(file)(silent));
    }
    let least = (LEAST_S * RATE_HZ) as usize;
    if samples.len() < least {
        let times = least.div_ceil(samples.len().max(1));
        let seconds = samples.len() as f64 / RATE_HZ;
        warnings.push(format!("Its {seconds:.3} s are repeated {times} times."));
        samples = samples.repeat(times);
    }
    let recording = Recording::from_axes(physical.quantity, file, RATE_HZ, vec![samples]);
    let mut recording = recording.map_err(AuthorError::from)?;
    recording.file = RecordedFile::of_bytes(bytes);
    recording.warnings = warnings.into_iter().map(Into::into).collect();
    Ok(recording)
}

/// Fits models to signals that [`recording_of`] returned, and makes an asset. Spectra are computed
/// from evenly spaced time windows. The full scale is stored in the provenance. The conditions
/// state no repeatability (how much two touches differ), because a signal that is rendered from a
/// file and repeated does not contain two touches.
///
/// # Errors
/// Returns the errors of [`fit_asset`].
pub fn fit_signals(
    takes: &[Take],
    mut request: AssetRequest,
    full_scale: Option<f64>,
) -> Result<FittedAsset, AuthorError> {
    request.spectrum =
        request.spectrum.with_segments(SegmentChoice::Windows).with_averaging(Averaging::Rms);
    if let Some(full_scale) = full_scale {
        let options = &mut request.recorded_options;
        options.insert("full-scale".to_owned(), full_scale.to_string());
    }
    // A signal of another program was not recorded at a speed.
    request.recorded_only = true;
    let mut fitted = fit_asset(takes, &request)?;
    // Repeated samples agree with themselves, so repeatability and held-out error would be those of
    // a perfect recording.
    let manifest = &mut fitted.asset.manifest;
    for condition in &mut manifest.conditions {
        condition.repeatability_rms_db = None;
        condition.repeatability_third_octave_rms_db = None;
    }
    for at in manifest.representations.iter_mut().flat_map(|r| &mut r.at) {
        at.left_out = None;
    }
    Ok(fitted)
}

/// Fits models to a recording, and makes an asset.
fn fitted(
    recording: Recording,
    how: &Import<'_>,
    registry: &Registry,
) -> Result<ImportedAsset, ExchangeError> {
    let reading = ReadingSettings::default();
    let request = how.fit.request(registry, &reading, how.name, how.tool)?;
    let request = request.with_law_of(&how.metadata);
    let given = Exploration { speed_mm_s: how.physical.speed_mm_s, force_n: how.physical.force_n };
    let takes = [Take { recording, given }];
    let fitted = fit_signals(&takes, request, how.physical.full_scale)?;
    Ok(ImportedAsset {
        asset: fitted.asset,
        file: None,
        felt: fitted.felt,
        skipped: fitted.skipped,
        warnings: fitted.warnings,
        notes: fitted.notes,
    })
}
