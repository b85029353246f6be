//! Merges the results of several builds: their libraries, textures, sounds, reports and pages.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::assemble::{MOST_REPORT_BYTES, REPORT_FILE, put_report};
use crate::catalogue::catalogue;
use crate::dist::Dist;
use crate::error::at_place;
use crate::findings::shares;
use crate::library_merge::LibraryMerge;
use crate::report::{LibraryReport, REPORT, Report, Status, TextureReport, felt_shares};
use crate::{BuildError, OnConflict};

/// Largest texture and largest sound that is copied, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// The results folders of several builds to merge. Use this if several machines each build a part
/// of a library.
///
/// ```no_run
/// use htex_build::{BuildsMerge, OnConflict};
/// let merge = BuildsMerge {
///     folders: vec![("dist-a".into(), String::new()), ("dist-b".into(), String::new())],
///     ..BuildsMerge::default()
/// };
/// let report = merge.run("dist".as_ref(), "surfaces")?;
/// println!("{} textures", report.library.textures);
/// # Ok::<(), htex_build::BuildError>(())
/// ```
#[derive(Debug, Default)]
pub struct BuildsMerge {
    /// The folders, each with a prefix for the names of its textures.
    pub folders: Vec<(PathBuf, String)>,
    pub on_conflict: OnConflict,
    /// Metadata of the merged library itself, such as its version.
    pub metadata: htex_format::library::LibraryMetadata,
}

/// A folder of a build, with its report.
struct Built {
    dist: Dist,
    library: PathBuf,
    prefix: String,
    report: Report,
}

impl BuildsMerge {
    /// Merges the folders into `output`. The library is called `name`.
    ///
    /// # Errors
    /// - Returns an error if a folder has no report, or if a file cannot be read or written.
    /// - Returns the errors of [`LibraryMerge::run`].
    pub fn run(&self, output: &Path, name: &str) -> Result<Report, BuildError> {
        let builds = self.folders.iter().map(|(folder, prefix)| Built::open(folder, prefix));
        let builds = builds.collect::<Result<Vec<_>, _>>()?;
        let dist = Dist::new(output);
        let parts = dist.empty_parts()?;
        let file = format!("{name}.htexlib");
        let part = parts.join(&file);
        let merge = LibraryMerge {
            libraries: builds.iter().map(|b| (b.library.clone(), b.prefix.clone())).collect(),
            on_conflict: self.on_conflict,
            metadata: self.metadata.clone(),
        };
        let packed = merge.run(&dist.path_of(&part)?, name)?;
        let programs: BTreeSet<&str> =
            builds.iter().map(|build| &build.report.program[..]).collect();
        let mut builds: Vec<&Built> = builds.iter().collect();
        // Of several textures of one name, the first one is taken, as in the library.
        if self.on_conflict == OnConflict::Last {
            builds.reverse();
        }
        let (mut textures, mut kept) = (BTreeMap::new(), BTreeSet::new());
        for build in builds {
            for texture in &build.report.textures {
                let name = format!("{}{}", build.prefix, texture.name);
                let is_built = texture.status == Status::Built;
                let there = textures.get(&name).map(|there: &TextureReport| there.status);
                // A texture that one build left out may be in another build.
                if there == Some(Status::Built) || there.is_some() && !is_built {
                    continue;
                }
                if is_built {
                    build.copy(&texture.name, &name, &dist)?;
                }
                textures.insert(name.clone(), TextureReport { name, ..texture.clone() });
            }
            for texture in &build.report.kept {
                let name = format!("{}{texture}", build.prefix);
                build.copy(texture, &name, &dist)?;
                kept.insert(name);
            }
        }
        dist.rename(&part, Path::new(&file))?;
        let textures: Vec<TextureReport> = textures.into_values().collect();
        let entries = usize::try_from(packed.entries).unwrap_or(usize::MAX);
        let left_out = textures.iter().filter(|t| t.status == Status::LeftOut).count();
        let report = Report {
            report: REPORT.to_owned(),
            program: programs.into_iter().collect::<Vec<_>>().join(", "),
            error: Vec::new(),
            library: LibraryReport {
                name: name.to_owned(),
                file,
                bytes: packed.bytes,
                blake3: blake3::Hash::from_bytes(packed.blake3).to_hex().to_string(),
                textures: entries,
                left_out,
            },
            removed: Vec::new(),
            kept: kept.into_iter().collect(),
            felt_shares: felt_shares(&textures),
            findings: shares(&textures),
            textures,
        };
        dist.put(Path::new("index.html"), catalogue(&report, false).as_bytes())?;
        put_report(&dist, &report)?;
        Ok(report)
    }
}

impl Built {
    fn open(folder: &Path, prefix: &str) -> Result<Self, BuildError> {
        let dist = Dist::new(folder);
        let place = folder.join(REPORT_FILE);
        let bytes = dist.get(Path::new(REPORT_FILE), MOST_REPORT_BYTES).ok_or_else(|| {
            BuildError::at_place(place.display(), "no build has written this folder; name one")
        })?;
        let report: Report = serde_json::from_slice(&bytes).map_err(at_place(place.display()))?;
        // The report may come from somebody else, so the file that it names must lie in the folder.
        let file = &report.library.file;
        if file.contains(['/', '\\']) || !file.ends_with(".htexlib") {
            let problem = format!("{file:?} is no name of a library");
            return Err(BuildError::at_place(place.display(), problem));
        }
        let library = dist.path_of(Path::new(file))?;
        Ok(Self { dist, library, prefix: prefix.to_owned(), report })
    }

    /// Copies the files of a texture under a new name.
    fn copy(&self, texture: &str, name: &str, to: &Dist) -> Result<(), BuildError> {
        for checked in [texture, name] {
            htex_format::library::check_name(checked).map_err(at_place(checked))?;
        }
        for file in [Dist::texture, Dist::sound] {
            if let Some(bytes) = self.dist.get(&file(texture), MOST_BYTES) {
                to.put(&file(name), &bytes)?;
            }
        }
        Ok(())
    }
}
