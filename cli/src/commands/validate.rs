use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use htex_base::files::open_regular;
use htex_base::finding::{FileReport, Findings, Report, Severity, plain};
use htex_device::DeviceError;
use htex_format::library::{EXTENSION, MAGIC};
use htex_format::{DESCRIPTOR_INVALID, Limits, PLUGIN_UNUSABLE, Representation, validate_with};
use htex_host::{Registry, Search, WasmLimits};
use serde_json::Value;

use super::lib::check;
use crate::assets::read_asset;
use crate::failure::{Exit, Failure, Result, for_file, with_hint};
use crate::findings_format::{FindingsFormat, formatted};
use crate::located;
use crate::output::{print, print_json, shown, warn, write};
use crate::recordings::RecordingArgs;
use crate::scenes::SceneArgs;
use crate::schemas::{ABSENT, ExtensionSchema, SchemaFile};
use crate::wasm_limits::WasmLimit;

/// Check files against their formats
///
/// Checks assets, libraries, scenes, descriptors of models and devices, recipes and recordings
/// against their formats and JSON Schemas. The exit status is 1 if a file is invalid.
///
/// Each finding has a stable code (`htex explain CODE`), a severity, and a JSON pointer to its
/// place in the document or the recording. If a rule is also in a JSON Schema, the finding names
/// the rule's place in the schema. If htex has the model that an asset uses, it also compares the
/// asset's fields with the fields in the descriptor of the model. In a recipe, htex checks the
/// keys, files, plugins, options and gates (requirements for the textures).
///
/// htex recognises a file by its name: *.htex is an asset, *.htexlib a library, *.json a scene or a
/// descriptor, *.toml a recipe. For a file with another name, the first bytes decide: a ZIP archive
/// is an asset, a file with the first bytes of a library is a library, and any other file is a
/// recording.
#[derive(Args)]
pub(crate) struct Validate {
    /// The files
    #[arg(required = true, value_parser = located::FILES)]
    files: Vec<PathBuf>,

    /// Check the extension com.vendor.NAME/1 of assets against the JSON Schema in FILE (draft
    /// 2020-12). htex does not download schemas to which FILE refers. May be given several times
    #[arg(long, value_name = "com.vendor.NAME/1=FILE")]
    extension_schema: Vec<String>,

    /// Also load the models that are embedded in assets, including the assets of scenes. htex then
    /// compares the models' descriptors with the fields of the assets. The models run in a sandbox.
    /// By default, htex runs no embedded model
    #[arg(long)]
    embedded_plugins: bool,

    /// Limit the resources of WASM models; `htex fit --help` lists the names
    #[arg(long, value_name = "NAME=N", value_parser = WasmLimit::parse, requires = "embedded_plugins")]
    wasm_limit: Vec<WasmLimit>,

    #[command(flatten)]
    reading: RecordingArgs,

    /// Print findings for continuous integration
    #[arg(long, value_enum, value_name = "FORMAT", conflicts_with = "json")]
    format: Option<FindingsFormat>,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Validate {
    pub(crate) fn run(mut self) -> Result {
        self.files = located::each(&self.files);
        let schemas = self
            .extension_schema
            .iter()
            .map(|a| ExtensionSchema::read(a))
            .collect::<Result<Vec<_>, _>>()?;
        let kinds: Vec<Kind> = self.files.iter().map(|path| kind(path)).collect();
        if self.reading.is_given() && !kinds.contains(&Kind::Recording) {
            return Err(Failure::usage(
                "the options for reading recordings go with a recording, and none is given",
            ));
        }
        let by_schema = |kind| matches!(kind, Kind::Asset | Kind::Document);
        if let (Some(absent), true) = (ABSENT, kinds.iter().copied().any(by_schema)) {
            warn(&[format!("documents are held to their rules alone: {absent}")]);
        }
        let mut refused = false;
        let reports = self.files.iter().zip(kinds).map(|(path, kind)| {
            let report = match kind {
                Kind::Asset => self.validate_asset(path, &schemas),
                Kind::Library => check(path),
                Kind::Document => self.validate_json(path),
                Kind::Recipe => validate_recipe(path),
                Kind::Recording => self.reading.validate(path),
            }?;
            refused |= self.reading.strict() && kind == Kind::Recording && !is_clean(&report);
            Ok((path.as_path(), report))
        });
        // `show_reports` consumes the iterator, so `refused` is complete afterwards.
        let exit = show_reports(reports, self.json, self.format)?;
        Ok(if refused { Exit::FAILURE } else { exit })
    }

    fn validate_asset(&self, path: &Path, schemas: &[ExtensionSchema]) -> Result<Report> {
        let mut report = validate_asset(path, schemas)?;
        // An invalid asset may be impossible to open.
        if self.embedded_plugins && report.valid {
            check_plugins(path, &WasmLimit::all(&self.wasm_limit), &mut report)?;
        }
        Ok(report)
    }

    fn validate_json(&self, path: &Path) -> Result<Report> {
        let bytes = read_asset(path)?;
        // A file that is not JSON counts as a scene here. The reader of scenes reports where the
        // JSON is wrong.
        let document = htex_format::parse_json(&bytes).unwrap_or_default();
        let text = || String::from_utf8_lossy(&bytes);
        let has = |key: &str| document.get(key).is_some();
        if has("id") && has("fields") {
            let refused = htex_host::read_descriptor(&text()).err();
            let problem = refused.map(|error| error.to_string());
            return descriptor(&document, problem, SchemaFile::model()?);
        }
        if has("id") && has("settings") {
            let read = serde_json::from_str::<htex_device::Descriptor>(&text());
            let problem = match read {
                Ok(descriptor) => descriptor.check().err().map(|error| match error {
                    DeviceError::Invalid { what, .. } => what,
                    other => other.to_string(),
                }),
                Err(error) => Some(error.to_string()),
            };
            return descriptor(&document, problem, SchemaFile::device()?);
        }
        let embedded = self.embedded_plugins.then(|| WasmLimit::all(&self.wasm_limit));
        let mut report = SceneArgs::validate(path, embedded)?;
        if document.get("htex_scene").is_some_and(|v| v == htex_scene::file::VERSION) {
            SchemaFile::scene()?.check(&document, &mut report);
            if let Some(settings) = SceneArgs::settings_schema(&document)? {
                settings.check(&document, &mut report);
            }
        }
        Ok(report)
    }
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    Asset,
    Library,
    /// A scene or a descriptor.
    Document,
    /// A recipe of a library.
    Recipe,
    Recording,
}

/// Returns the kind of a file by its name, or else by its first bytes.
pub(crate) fn kind(path: &Path) -> Kind {
    let called = |name: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(name));
    let mut first = Vec::new();
    let most = MAGIC.len() as u64;
    // A file that cannot be read causes an error later, where its contents are read. The first
    // bytes of a pipe are part of its contents and must not be consumed here.
    let _ = open_regular(path).and_then(|file| file.take(most).read_to_end(&mut first));
    let begins = |start: &[u8]| first.starts_with(start);
    match () {
        () if called("json") => Kind::Document,
        () if called("toml") => Kind::Recipe,
        () if called(EXTENSION) || begins(&MAGIC) => Kind::Library,
        // A damaged asset may not begin as an archive, so the name is also checked.
        () if called("htex") || begins(b"PK") => Kind::Asset,
        () => Kind::Recording,
    }
}

/// Whether a file is a library.
pub(crate) fn is_library(path: &Path) -> bool {
    kind(path) == Kind::Library
}

/// Refuses a library for a command that takes one asset, and says what to do.
pub(crate) fn refuse_library(path: &Path) -> Result<()> {
    if !is_library(path) {
        return Ok(());
    }
    let file = shown(path);
    Err(Failure::Usage(format!(
        "{file}: it is a library, which holds many textures: name one, as in {file}#NAME; `htex lib ls` lists the names"
    )))
}

/// Prints each report as soon as it is there, or all reports together as JSON or in another format. The exit status is 1
/// if a report is not valid.
pub(crate) fn show_reports<'a>(
    reports: impl Iterator<Item = Result<(&'a Path, Report)>>,
    is_json: bool,
    format: Option<FindingsFormat>,
) -> Result {
    let (mut all_valid, mut reported) = (true, Vec::new());
    for report in reports {
        let (path, report) = report?;
        all_valid &= report.valid;
        let report = report.of_file(&path.display().to_string());
        if is_json || format.is_some() {
            reported.push(report);
        } else {
            print(&report_text(&report))?;
        }
    }
    match format {
        Some(format) => write(&formatted(format, "htex", &reported))?,
        None if is_json => print_json(&reported)?,
        None => {}
    }
    Ok(Exit::ok_if(all_valid))
}

fn report_text(report: &FileReport) -> String {
    let verdict = if report.valid { "valid" } else { "NOT VALID" };
    let mut text = format!("{}: {verdict}\n", plain(&report.file));
    for finding in &report.findings {
        let place = match plain(&finding.pointer) {
            pointer if pointer.is_empty() => String::new(),
            pointer => format!(" at {pointer}"),
        };
        text += &format!(
            "  {} {}{place}: {}\n",
            finding.severity,
            finding.code,
            with_hint(&finding.message, finding.hint)
        );
        if let Some(rule) = &finding.schema_rule {
            text += &format!("    schema: {}\n", plain(rule));
        }
    }
    text
}

/// Whether `--strict` accepts the findings.
fn is_clean(report: &Report) -> bool {
    report.findings.iter().all(|f| f.severity == Severity::Info)
}

/// Validates an asset. If it is too large, it is not read to its end.
fn validate_asset(path: &Path, extensions: &[ExtensionSchema]) -> Result<Report> {
    let limits = Limits::default();
    let bytes = read_asset(path)?;
    let models = Registry::builtin();
    let known = |r: &Representation| {
        let model = htex::play::model_of(&models, r).ok()?;
        Some(model.descriptor())
    };
    let mut report = validate_with(&bytes, &limits, &known);
    if let Some(manifest) = htex_format::manifest_json(&bytes, &limits) {
        if is_of_major_1(&manifest, "htex") {
            SchemaFile::manifest()?.check(&manifest, &mut report);
        }
        for extension in extensions {
            extension.check(&manifest, &mut report);
        }
    }
    Ok(report)
}

/// Loads the embedded models of an asset. Adds a finding for each model that cannot be loaded.
fn check_plugins(path: &Path, limits: &WasmLimits, report: &mut Report) -> Result<()> {
    let data = htex_format::Asset::open(path).map_err(for_file(path))?;
    let registry = Registry::search(&Search::builtin().with_limits(limits.clone()))?;
    let asset = htex::Texture::with_registry(data, registry).with_embedded();
    let mut findings = Findings::default();
    for (i, plugin) in asset.manifest().plugins.iter().enumerate() {
        if let Err(error) = asset.load_embedded(&plugin.model) {
            findings.add(PLUGIN_UNUSABLE, format!("/plugins/{i}"), error.to_string());
        }
    }
    report.valid &= !findings.has_errors();
    report.findings.extend(findings.into_list());
    Ok(())
}

/// Whether the version under `key` is 1.x, so that the rules of version 1 apply.
fn is_of_major_1(document: &Value, key: &str) -> bool {
    let version = document.get(key).and_then(Value::as_str);
    version.is_some_and(|version| version.starts_with("1."))
}

/// Maximum size of a TOML file that is read to find out whether it is a study, bytes. It is the
/// maximum size of a recipe.
#[cfg(feature = "build")]
const MOST_TOML_BYTES: u64 = 1 << 20;

/// Validates a recipe. Its first error becomes a finding.
#[cfg(feature = "build")]
fn validate_recipe(path: &Path) -> Result<Report> {
    use htex_build::{BuildError, BuildOptions, RECIPE_INVALID, check};
    let limits = WasmLimit::all(&[]);
    let options = BuildOptions { limits, ..BuildOptions::new(crate::invocation::tool()) };
    // If it cannot be read, `check` says why.
    let text = htex_base::files::read_regular_text(path, MOST_TOML_BYTES).unwrap_or_default();
    let is_study = |line: &str| line.trim_start().starts_with("htex_study");
    if text.lines().any(is_study) {
        let file = shown(path);
        return Err(Failure::Usage(format!(
            "{file}: it is a study; check it by `htex study validate`"
        )));
    }
    let mut findings = Findings::default();
    match check(path, &options) {
        Ok(_) => {}
        // The recipe itself cannot be read.
        Err(BuildError::File(error)) if error.file == path => return Err(error.into()),
        Err(error) => {
            let text = error.to_string();
            let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
            findings.add(RECIPE_INVALID, "", lines.join("; "));
        }
    }
    Ok(findings.into_report())
}

#[cfg(not(feature = "build"))]
fn validate_recipe(path: &Path) -> Result<Report> {
    let file = shown(path);
    let words = "this program was built without recipes; build it with the feature `build`";
    Err(Failure::Usage(format!("{file}: {words}")))
}

/// Returns the report on a descriptor. It contains the problem that the descriptor's reader found,
/// and the findings of the JSON Schema.
fn descriptor(document: &Value, problem: Option<String>, schema: SchemaFile) -> Result<Report> {
    let mut findings = Findings::default();
    if let Some(problem) = problem {
        findings.add(DESCRIPTOR_INVALID, "", format!("{problem}; correct it"));
    }
    let mut report = findings.into_report();
    schema.check(document, &mut report);
    Ok(report)
}
