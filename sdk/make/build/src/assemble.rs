//! Assembles the results of a build: the textures, the library, the report and the catalogue.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Cursor;
use std::path::Path;

use htex_author::{FeltError, describe, played_model};
use htex_base::files::AtFile;
use htex_format::library::{Library, LibraryError, PackSummary, PreparedTexture, Writer};
use htex_format::{Asset, Rights};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use walkdir::WalkDir;

use crate::BuildError;
use crate::catalogue::catalogue;
use crate::dist::Dist;
use crate::error::at_place;
use crate::findings::shares;
use crate::gates::missed;
use crate::hashes::Stamp;
use crate::job::Job;
use crate::job_result::JobResult;
use crate::library_build::BuildOptions;
use crate::plan::{Plan, PlannedTexture};
use crate::removed::{built, library_before, named_briefly};
use crate::report::{LibraryReport, REPORT, Report, Status, TextureReport, felt_shares};
use crate::state::StateFolder;

pub(crate) const REPORT_FILE: &str = "build-report.json";
/// Largest size of a report that is read, bytes: a few hundred thousand textures.
pub(crate) const MOST_REPORT_BYTES: u64 = 1 << 30;

/// File with facts about the library that was written last, in the folder of stored data.
const KEPT_LIBRARY: &str = "library.json";

/// Writes all results of the build and returns the report. `made` returns the result of the job
/// with a key.
pub(crate) fn assemble(
    plan: &Plan,
    jobs: &[(String, Job)],
    made: &(dyn Fn(&str) -> Option<JobResult> + Sync),
    (dist, kept): (&Dist, &StateFolder),
    options: &BuildOptions,
    textures_before: &BTreeSet<String>,
) -> Result<Report, BuildError> {
    let file = format!("{}.htexlib", plan.library);
    let path = dist.path_of(Path::new(&file))?;
    let found = |key: &str, texture: &PlannedTexture| {
        made(key).ok_or_else(|| {
            BuildError::Damaged(format!("{}: it was kept and is gone", texture.name))
        })
    };
    let asset = |job: &Job, made: &JobResult| match &made.asset[..] {
        [] => Ok(Vec::new()),
        bytes => job.apply_metadata(bytes),
    };
    let library = path.display();
    // All textures are judged before anything is written, so that a refused build changes nothing.
    let most_removed = options.most_removed(plan);
    if most_removed < usize::MAX {
        let judge = |((key, job), texture): (&(String, Job), &PlannedTexture)| {
            let mut made = found(key, texture)?;
            made.asset = asset(job, &made)?;
            judged(texture, key, job, &made)
        };
        let planned = jobs.par_iter().zip(&plan.textures);
        let textures = planned.map(judge).collect::<Result<Vec<_>, BuildError>>()?;
        let left_out = textures.iter().filter(|t| t.status == Status::LeftOut);
        let lost = left_out.filter(|t| textures_before.contains(&t.name));
        let mut lost: Vec<String> = lost.map(|t| t.name.clone()).collect();
        lost.extend(plan.removed(textures_before));
        BuildError::refuse_removals(lost, most_removed)?;
    }
    let kept_textures = KeptTextures::new(plan, dist, textures_before)?;
    let parts = dist.empty_parts()?;
    // Read before the new report replaces it.
    let before = previous(dist);
    let report = |((key, job), texture): (&(String, Job), &PlannedTexture)| {
        let mut made = found(key, texture)?;
        made.asset = asset(job, &made)?;
        let report = judged(texture, key, job, &made)?;
        if report.status == Status::Built {
            dist.put(&Dist::texture(&texture.name), &made.asset)?;
            if options.browser_package.is_none() {
                dist.put(&Dist::sound(&texture.name), &with_rights(made.sound, &report)?)?;
            }
        }
        Ok(report)
    };
    let planned = jobs.par_iter().zip(&plan.textures);
    let textures: Vec<TextureReport> = planned.map(report).collect::<Result<_, BuildError>>()?;
    // Only the reports stay in memory. The library reads each asset again, because all assets
    // together may not fit into memory.
    let contents = contents(plan, &textures, &kept_textures);
    let kept_names = kept_textures.names();
    let packed = match kept_library(kept, &path, &contents) {
        Some(packed) => packed,
        None => {
            // Written in the folder of parts. In the folder of results, a killed build would leave
            // the writer's files behind.
            let part = parts.join(&file);
            let mut writer =
                Writer::create(&dist.path_of(&part)?, &plan.library).map_err(at_place(&library))?;
            // The recipe's gate has already decided about licences.
            writer.allow_unlicensed();
            writer.set_metadata(plan.metadata.clone());
            let planned = jobs.iter().zip(&plan.textures).zip(&textures);
            let planned: Vec<_> = planned
                .filter(|(_, report)| report.status == Status::Built)
                .map(|(planned, _)| planned)
                .collect();
            for batch in planned.chunks(BATCH) {
                let prepared: Vec<_> = batch
                    .par_iter()
                    .map(|((key, job), texture)| {
                        let made = found(key, texture)?;
                        prepared(asset(job, &made)?, &made.record.felt)
                    })
                    .collect();
                for ((_, texture), prepared) in batch.iter().zip(prepared) {
                    writer.add_prepared(&texture.name, prepared?).map_err(at_place(&library))?;
                }
            }
            kept_textures.add_to(&mut writer).map_err(at_place(&library))?;
            let packed = writer.finish().map_err(at_place(&library))?;
            dist.rename(&part, Path::new(&file))?;
            keep_library(kept, &path, contents, &packed)?
        }
    };
    if let Some(package) = &options.browser_package {
        copy_package(package, dist)?;
    }
    let report = Report {
        report: REPORT.to_owned(),
        program: options.program.clone(),
        error: Vec::new(),
        library: library_report(plan, file, &packed, &textures, kept_names.len()),
        removed: plan.removed(textures_before),
        kept: kept_names,
        felt_shares: felt_shares(&textures),
        findings: shares(&textures),
        textures,
    };
    let page = catalogue(&report, options.browser_package.is_some());
    dist.put(Path::new("index.html"), page.as_bytes())?;
    put_report(dist, &report)?;
    remove_stale(before, &report, dist, options)?;
    Ok(report)
}

/// Adds the licence and author of a texture to its sound. The stored sound does not contain them,
/// so that a change of metadata does not require a new sound.
fn with_rights(sound: Vec<u8>, report: &TextureReport) -> Result<Vec<u8>, BuildError> {
    let asset = report.asset.as_ref();
    let license = asset.and_then(|asset| asset.license.as_deref());
    let author = asset.and_then(|asset| asset.author.as_deref());
    let mut wav = Cursor::new(sound);
    Rights::new(license, author).add_to_wav(&mut wav).map_err(at_place(&report.name))?;
    Ok(wav.into_inner())
}

/// Reports a texture together with the gates that it misses.
fn judged(
    texture: &PlannedTexture,
    key: &str,
    job: &Job,
    made: &JobResult,
) -> Result<TextureReport, BuildError> {
    let asset = match &made.asset[..] {
        [] => None,
        bytes => Some(
            Asset::from_bytes(bytes)
                .map_err(|error| BuildError::Damaged(format!("{}: {error}", texture.name)))?,
        ),
    };
    let mut report = TextureReport::new(job, key, made, asset.as_ref());
    if let Some(asset) = &report.asset {
        report.missed.extend(missed(&texture.gates, asset));
    }
    if !report.missed.is_empty() {
        report.status = Status::LeftOut;
    }
    Ok(report)
}

/// Number of textures that are prepared for the library at once, on all processors.
const BATCH: usize = 256;

/// Prepares a texture for the library. Assets seldom keep their recorded spectra, but the build
/// knows the felt differences of their models.
fn prepared(
    bytes: Vec<u8>,
    felt: &BTreeMap<String, FeltError>,
) -> Result<PreparedTexture, BuildError> {
    let asset =
        Asset::from_bytes(&bytes).map_err(|error| BuildError::Damaged(error.to_string()))?;
    let mut description = describe(&asset);
    if description.felt_error_rms_db.is_none() {
        let model = played_model(&asset);
        let felt = model.and_then(|model| felt.get(&model));
        description.felt_error_rms_db = felt.map(|felt| felt.error_rms_db);
    }
    Ok(PreparedTexture::of_asset(&asset, bytes, description))
}

/// Facts about the library file that was written last.
#[derive(Serialize, Deserialize)]
struct KeptLibrary {
    /// Hash of the library's name, and of the names and hashes of its textures.
    contents: String,
    stamp: Stamp,
    bytes: u64,
    blake3: String,
}

/// Textures that were in the library before this build and stay in it.
struct KeptTextures {
    library: Option<Library>,
    /// Hashes by name.
    hashes: BTreeMap<String, [u8; 32]>,
}

impl KeptTextures {
    fn new(plan: &Plan, dist: &Dist, before: &BTreeSet<String>) -> Result<Self, BuildError> {
        let names = plan.kept(before);
        if names.is_empty() {
            return Ok(Self { library: None, hashes: BTreeMap::new() });
        }
        let library = library_before(dist, &plan.library);
        let entries = library.iter().flat_map(Library::entries).map_while(Result::ok);
        let hashes: BTreeMap<String, [u8; 32]> = entries
            .filter(|entry| names.binary_search(&entry.name).is_ok())
            .map(|entry| (entry.name, entry.blake3))
            .collect();
        let lost: Vec<String> =
            names.into_iter().filter(|name| !hashes.contains_key(name)).collect();
        if lost.is_empty() {
            return Ok(Self { library, hashes });
        }
        let problem = format!(
            "{} textures ({}) are to be kept, and the library in this folder does not have them; copy the library that has them here",
            lost.len(),
            named_briefly(&lost)
        );
        Err(BuildError::at_place("library.missing", problem))
    }

    fn names(&self) -> Vec<String> {
        self.hashes.keys().cloned().collect()
    }

    fn add_to(self, writer: &mut Writer) -> Result<(), LibraryError> {
        let Some(library) = self.library else { return Ok(()) };
        let hashes = self.hashes;
        writer.add_library(library, |entry| {
            hashes.contains_key(&entry.name).then(|| entry.name.clone())
        })
    }
}

fn contents(plan: &Plan, textures: &[TextureReport], kept: &KeptTextures) -> String {
    let built = textures.iter().filter(|t| t.status == Status::Built);
    let named = built.map(|t| (&t.name, t.asset.as_ref().map(|asset| &asset.blake3)));
    let named: Vec<_> = named.collect();
    let parts = serde_json::json!([plan.library, plan.metadata, named, kept.hashes]);
    blake3::hash(parts.to_string().as_bytes()).to_hex().to_string()
}

/// Returns the existing library if it has these contents and nobody has written to it since the
/// last build.
fn kept_library(kept: &StateFolder, path: &Path, contents: &str) -> Option<KeptLibrary> {
    let bytes = kept.get(KEPT_LIBRARY, MOST_REPORT_BYTES)?;
    let kept: KeptLibrary = serde_json::from_slice(&bytes).ok()?;
    let same = kept.contents == contents && Stamp::read(path).ok()? == kept.stamp;
    same.then_some(kept)
}

fn keep_library(
    kept: &StateFolder,
    path: &Path,
    contents: String,
    packed: &PackSummary,
) -> Result<KeptLibrary, BuildError> {
    let library = KeptLibrary {
        contents,
        stamp: Stamp::read(path).reading(path)?,
        bytes: packed.bytes,
        blake3: blake3::Hash::from_bytes(packed.blake3).to_hex().to_string(),
    };
    kept.put(KEPT_LIBRARY, &serde_json::to_vec(&library)?)?;
    Ok(library)
}

fn library_report(
    plan: &Plan,
    file: String,
    packed: &KeptLibrary,
    textures: &[TextureReport],
    kept: usize,
) -> LibraryReport {
    let built = textures.iter().filter(|t| t.status == Status::Built).count();
    LibraryReport {
        name: plan.library.clone(),
        file,
        bytes: packed.bytes,
        blake3: packed.blake3.clone(),
        textures: built + kept,
        left_out: textures.len() - built,
    }
}

/// Copies the browser package next to the catalogue.
fn copy_package(package: &Path, dist: &Dist) -> Result<(), BuildError> {
    let entry = package.join("index.js");
    if !entry.is_file() {
        let problem = "there is no index.js; give the folder of the browser package";
        return Err(BuildError::at_place(package.display(), problem));
    }
    for file in WalkDir::new(package).follow_links(true) {
        let file = file.reading(package)?;
        if file.file_type().is_file() {
            let bytes = fs::read(file.path()).reading(file.path())?;
            let inside = file.path().strip_prefix(package).unwrap_or(file.path());
            dist.put(&Path::new("browser").join(inside), &bytes)?;
        }
    }
    Ok(())
}

pub(crate) fn put_report(dist: &Dist, report: &Report) -> Result<(), BuildError> {
    let text = serde_json::to_string_pretty(report)? + "\n";
    dist.put(Path::new(REPORT_FILE), text.as_bytes())
}

/// Returns the report of the previous build, if there is one.
pub(crate) fn previous(dist: &Dist) -> Option<Report> {
    let bytes = dist.get(Path::new(REPORT_FILE), MOST_REPORT_BYTES)?;
    serde_json::from_slice(&bytes).ok()
}

/// Removes files that an earlier build wrote and this build did not.
fn remove_stale(
    before: Option<Report>,
    now: &Report,
    dist: &Dist,
    options: &BuildOptions,
) -> Result<(), BuildError> {
    let Some(before) = before else {
        return Ok(());
    };
    let kept: BTreeSet<String> = built(now).collect();
    let before_built: BTreeSet<String> =
        built(&before).chain(now.removed.iter().cloned()).collect();
    // The earlier report may come from somebody else. Its names are checked because they become
    // paths.
    for name in before_built.iter().filter(|name| htex_format::library::check_name(name).is_ok()) {
        if !kept.contains(name) {
            dist.remove(&Dist::texture(name))?;
        }
        if !kept.contains(name) || options.browser_package.is_some() {
            dist.remove(&Dist::sound(name))?;
        }
    }
    let is_file =
        !before.library.file.contains(['/', '\\']) && before.library.file.ends_with(".htexlib");
    if is_file && before.library.file != now.library.file {
        dist.remove(Path::new(&before.library.file))?;
    }
    Ok(())
}
