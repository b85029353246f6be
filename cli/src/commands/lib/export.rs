use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use htex::{Motion, Texture};
use htex_base::files::{AtFile, Batch, OwnFolder};
use htex_base::finding::plain;
use htex_build::Filter;
use htex_exchange::{Export, ExportedFile, Format, Path as ExportPath, Profile};
use htex_format::Asset;
use htex_format::library::Entry;
use serde::Serialize;

use super::{LibraryArg, check_free};
use crate::failure::{Exit, Failure, Result, for_file};
use crate::output::{print, print_json, shown};
use crate::progress::bar;
use crate::signers::SignerArgs;

/// Name of the table.
const TABLE: &str = "exported.csv";

/// Export the textures of a library to files of other haptic formats
///
/// For each texture and each format, the command writes a file NAME.EXTENSION into a folder. It
/// also writes a table exported.csv, which lists for each file the parts of the texture that the
/// file lacks. If a texture cannot be exported to a format, the table says why. The exit status is
/// then 3, or 1 if no file was written.
#[derive(Args)]
pub(crate) struct ExportAll {
    /// Path or URI of the library
    #[arg(value_parser = LibraryArg::parser())]
    library: LibraryArg,

    /// The formats to write; `htex formats` describes all formats
    #[arg(long, value_name = "FORMAT,…", required = true, value_delimiter = ',', value_parser = format)]
    to: Vec<&'static Format>,

    /// Folder to write to; created if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,

    /// Export only textures with this property: name, tag, model, contact, license, author or
    /// quantity, e.g. tag=rough. May be given several times; then a texture must have all
    /// properties
    #[arg(long = "where", value_name = "FIELD=GLOB")]
    filters: Vec<Filter>,

    /// Condition to export, e.g. speed=80,force=0.4 (mm/s, N), or `strongest` of the recorded ones
    /// [default: the first condition, or the strongest condition if the first is silent]
    #[arg(long, value_name = "CONDITION")]
    at: Option<At>,

    /// Profile of the actuator that will play the files [default: depends on the format]
    #[arg(long, value_name = "NAME")]
    profile: Option<String>,

    /// Duration, s
    #[arg(long, value_name = "S", default_value_t = 2.0)]
    seconds: f64,

    /// Overwrite existing files
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    signers: SignerArgs,

    /// Print JSON: a list with an object for each file
    #[arg(long)]
    json: bool,
}

/// The condition to export.
#[derive(Debug, Clone, Copy)]
enum At {
    Strongest,
    Motion { speed_mm_s: Option<f64>, force_n: Option<f64> },
}

impl FromStr for At {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "strongest" {
            return Ok(Self::Strongest);
        }
        let (mut speed_mm_s, mut force_n) = (None, None);
        for part in text.split(',') {
            let wrong = || format!("{part}: give strongest, or speed=80,force=0.4");
            let (name, number) = part.split_once('=').ok_or_else(wrong)?;
            let number = number.parse().ok().filter(|x: &f64| x.is_finite() && *x > 0.0);
            let to = match name {
                "speed" => &mut speed_mm_s,
                "force" => &mut force_n,
                _ => return Err(wrong()),
            };
            *to = Some(number.ok_or_else(wrong)?);
        }
        Ok(Self::Motion { speed_mm_s, force_n })
    }
}

fn format(name: &str) -> Result<&'static Format, String> {
    Format::find_for_export(name).map_err(|error| error.to_string())
}

/// A row of the table.
#[derive(Serialize)]
struct Row {
    texture: String,
    format: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bytes: Option<usize>,
    /// What the file states, and which parts of the texture it lacks.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    exported: Option<ExportedFile>,
    /// Why there is no file.
    #[serde(skip_serializing_if = "Option::is_none")]
    problem: Option<String>,
}

impl ExportAll {
    pub(crate) fn run(self) -> Result {
        let file = self.library.shown();
        let library = self.library.open_signed(&self.signers)?;
        let profile = self.profile.as_deref().map(Profile::find).transpose()?;
        let bar = bar(library.len());
        let (mut batch, mut rows) = (Batch::default(), Vec::new());
        for entry in library.entries() {
            let entry = entry.map_err(for_file(&file))?;
            bar.inc(1);
            let bytes = library.read(&entry).map_err(for_file(&file))?;
            let asset = Asset::from_bytes(&bytes)
                .map_err(|error| Failure::from(error).in_file(Path::new(&entry.name)))?;
            if !self.filters.iter().all(|f| f.matches_manifest(&entry.name, &asset.manifest)) {
                continue;
            }
            let texture = Texture::new(asset).with_embedded();
            for format in &self.to {
                let row = self.export(&entry, &texture, &bytes, format, profile, &mut batch)?;
                rows.push(row);
            }
        }
        bar.finish_and_clear();
        if rows.is_empty() {
            let problem = "no texture matches; `htex lib ls` lists them";
            return Err(Failure::Other(format!("{}: {problem}", shown(&file))));
        }
        let table = table(&rows).map_err(Failure::other)?;
        self.write(&mut batch, TABLE, &table)?;
        batch.finish().writing(&self.output)?;
        let written = rows.iter().filter(|row| row.file.is_some()).count();
        if self.json {
            print_json(&rows)?;
        } else {
            print(&Summary { rows: &rows, folder: &self.output }.to_string())?;
        }
        Ok(match written {
            0 => Exit::FAILURE,
            _ if written < rows.len() => Exit::PART,
            _ => Exit::SUCCESS,
        })
    }

    fn export(
        &self,
        entry: &Entry,
        texture: &Texture,
        bytes: &[u8],
        format: &'static Format,
        profile: Option<&Profile>,
        batch: &mut Batch,
    ) -> Result<Row> {
        let mut export = Export::new(format);
        // A format that is not made for an actuator ignores the profile.
        export.profile = profile.filter(|_| format.check_export(["profile"]).is_ok());
        export.seconds = self.seconds;
        export.file = Some(bytes);
        let exported = self.motion(texture).and_then(|motion| {
            export.path = ExportPath::Condition(motion);
            Ok(htex_exchange::export(texture, &export)?)
        });
        let row = |exported| Row {
            texture: entry.name.clone(),
            format: format.name,
            file: None,
            bytes: None,
            exported,
            problem: None,
        };
        match exported {
            Ok(exported) => {
                let extension = format.extensions.first().copied().unwrap_or(format.name);
                let name = format!("{}.{extension}", entry.name);
                self.write(batch, &name, &exported.bytes)?;
                let bytes = Some(exported.bytes.len());
                Ok(Row { file: Some(name), bytes, ..row(Some(exported)) })
            }
            Err(problem) => Ok(Row { problem: Some(problem.to_string()), ..row(None) }),
        }
    }

    /// Returns the motion to export; `None` for the default condition.
    fn motion(&self, texture: &Texture) -> Result<Option<Motion>> {
        let representation = texture.representation(None)?;
        Ok(match self.at {
            None => None,
            Some(At::Motion { speed_mm_s, force_n }) => {
                Some(representation.motion(speed_mm_s, force_n))
            }
            Some(At::Strongest) => {
                let manifest = texture.manifest();
                let own = manifest.representations.iter().find(|r| r.model == representation.id());
                let all = own.into_iter().flat_map(|own| &own.at);
                let all = all
                    .filter_map(|at| Some((at.level_rms, manifest.conditions.get(at.condition)?)));
                let recorded = all.filter(|(_, condition)| condition.is_recorded());
                let strongest = recorded.max_by(|(a, _), (b, _)| a.total_cmp(b));
                strongest.map(|(_, at)| representation.motion(at.speed_mm_s, at.force_n))
            }
        })
    }

    fn write(&self, batch: &mut Batch, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.output.join(name);
        check_free(&path, self.force)?;
        Ok(OwnFolder::new(&self.output).write_with(batch, Path::new(name), bytes).writing(&path)?)
    }
}

/// Returns the table, CSV.
fn table(rows: &[Row]) -> Result<Vec<u8>, csv::Error> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record([
        "texture",
        "format",
        "file",
        "bytes",
        "level_db",
        "felt_rms_db",
        "felt_largest_db",
        "felt_total_db",
        "too_weak",
        "always_loses",
        "rights",
        "problem",
    ])?;
    for row in rows {
        let exported = row.exported.as_ref();
        let lost = exported.and_then(|exported| exported.lost.as_ref());
        let felt = lost.map(|lost| &lost.difference.felt.error);
        let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:.3}"));
        let played = exported.and_then(|exported| exported.played.as_ref());
        table.write_record([
            row.texture.clone(),
            row.format.to_owned(),
            row.file.clone().unwrap_or_default(),
            row.bytes.map_or(String::new(), |bytes| bytes.to_string()),
            number(lost.map(|lost| lost.level_db)),
            number(felt.map(|felt| felt.error_rms_db)),
            number(felt.map(|felt| felt.largest_error_db)),
            number(felt.map(|felt| felt.total_error_db)),
            number(played.map(|played| played.limited)),
            exported.map_or("", |exported| exported.loses).to_owned(),
            exported.map_or(String::new(), |exported| exported.rights.clone()),
            row.problem.clone().unwrap_or_default(),
        ])?;
    }
    table.into_inner().map_err(|error| error.into_error().into())
}

/// What is printed.
struct Summary<'a> {
    rows: &'a [Row],
    folder: &'a Path,
}

impl Display for Summary<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let failed = self.rows.iter().filter_map(|row| Some((row, row.problem.as_ref()?)));
        for (row, problem) in failed {
            writeln!(f, "{} to {}: {}", plain(&row.texture), row.format, plain(problem))?;
        }
        let written = self.rows.iter().filter(|row| row.file.is_some()).count();
        let folder = shown(self.folder);
        writeln!(f, "{folder}: {written} of {} files, and {TABLE}", self.rows.len())
    }
}
