//! Validates documents against JSON Schemas, and adds the violations to the findings of the rules.

use std::path::{Path, PathBuf};

use htex_base::files::AtFile;
use htex_base::finding::{FINDINGS_TRUNCATED, Finding, Report, Rule, Severity};
use htex_base::schema::{Schema, Violation};
use htex_device::SettingKind;
use htex_format::{EXTENSION_SCHEMA_BROKEN, SCHEMA_BROKEN};
use serde_json::{Map, Value, json};

use crate::failure::{Failure, Result};

/// The note for builds that cannot validate documents against schemas. This build can.
pub(crate) const ABSENT: Option<&str> = None;

/// Maximum number of findings in a report.
const KEPT: usize = 100;

/// A schema of this project, named by its file in `spec/schemas`.
pub(crate) struct SchemaFile {
    file: String,
    schema: Schema,
}

impl SchemaFile {
    pub(crate) fn manifest() -> Result<Self> {
        Self::new("manifest-1.json", &htex_format::manifest_schema())
    }

    pub(crate) fn scene() -> Result<Self> {
        Self::new("scene-1.json", &htex_scene::scene_schema())
    }

    /// Returns the schema of a model's descriptor.
    pub(crate) fn model() -> Result<Self> {
        Self::new("descriptor-1.json", &htex_model::descriptor_schema())
    }

    /// Returns the schema of a device's descriptor.
    pub(crate) fn device() -> Result<Self> {
        let [(file, schema), ..] = htex_device::schemas();
        Self::new(file, &schema)
    }

    fn new(file: &str, schema: &Value) -> Result<Self> {
        let schema =
            Schema::new(schema).map_err(|error| Failure::Other(format!("{file}: {error}")))?;
        let file = file.to_owned();
        Ok(Self { file, schema })
    }

    /// Adds the schema's violations to a report. If a finding is about the same place, it gets the
    /// name of the violated rule. Otherwise the violation becomes a finding.
    pub(crate) fn check(&self, document: &Value, report: &mut Report) {
        for violation in self.schema.violations(document) {
            let rule = format!("{}#{}", self.file, violation.rule);
            let same = |f: &&mut Finding| {
                f.severity == Severity::Error && covers(&f.pointer, &violation.pointer)
            };
            match report.findings.iter_mut().find(same) {
                Some(finding) => drop(finding.schema_rule.get_or_insert(rule)),
                None => add(report, SCHEMA_BROKEN, violation, rule, ""),
            }
        }
    }
}

/// Whether a finding and a violation are about the same place: their pointers are equal, or one is
/// inside the other.
fn covers(finding: &str, violation: &str) -> bool {
    let inside = |inner: &str, outer: &str| {
        let rest = inner.strip_prefix(outer);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
    };
    // An empty pointer means the whole document, which contains every violation.
    inside(finding, violation) || (!finding.is_empty() && inside(violation, finding))
}

/// Adds a violation, unless there are already a hundred findings.
fn add(report: &mut Report, broken: &Rule, violation: Violation, rule: String, at: &str) {
    report.valid = false;
    let shown = report.findings.len();
    if shown < KEPT {
        let message = format!("{}; correct it", violation.message);
        let pointer = format!("{at}{}", violation.pointer);
        report
            .findings
            .push(Finding { schema_rule: Some(rule), ..Finding::new(broken, pointer, &message) });
    // The note itself makes the list longer than `KEPT`, so it is added only once.
    } else if shown == KEPT {
        let message = "more findings are not shown";
        let finding = Finding::new(FINDINGS_TRUNCATED, "", message);
        report.findings.push(finding);
    }
}

/// A schema from an extension's author: `com.vendor.NAME/REVISION=FILE`.
pub(crate) struct ExtensionSchema {
    name: String,
    file: PathBuf,
    schema: Schema,
}

impl ExtensionSchema {
    pub(crate) fn read(argument: &str) -> Result<Self> {
        let wrong = |what: String| Failure::Usage(format!("--extension-schema {argument}: {what}"));
        let form = || wrong("it looks like com.vendor.NAME/1=FILE".to_owned());
        let (name, file) = argument.split_once('=').ok_or_else(form)?;
        htex_format::check_extension_name(name).map_err(|error| wrong(error.to_string()))?;
        let file = PathBuf::from(file);
        let bytes = std::fs::read(&file).reading(&file)?;
        let schema = htex_format::parse_json(&bytes).map_err(|error| wrong(error.to_string()))?;
        let schema = Schema::new(&schema).map_err(|error| wrong(error.to_string()))?;
        let name = name.to_owned();
        Ok(Self { name, file, schema })
    }

    /// Adds a finding for each rule that the extension in the manifest breaks.
    pub(crate) fn check(&self, manifest: &Value, report: &mut Report) {
        let Some(extension) = manifest.get("extensions").and_then(|all| all.get(&self.name)) else {
            return;
        };
        let at = format!("/extensions/{}", htex_base::finding::escape(&self.name));
        for violation in self.schema.violations(extension) {
            let rule = format!("{}#{}", file_name(&self.file), violation.rule);
            add(report, EXTENSION_SCHEMA_BROKEN, violation, rule, &at);
        }
    }
}

fn file_name(file: &Path) -> String {
    let name = file.file_name().unwrap_or(file.as_os_str());
    name.to_string_lossy().into_owned()
}

/// Returns the schema for a device's settings in a scene: strings, numbers and booleans.
pub(crate) fn settings(device: &htex_device::Descriptor) -> Result<SchemaFile> {
    let mut properties = Map::new();
    for setting in &device.settings {
        let schema = match &setting.kind {
            SettingKind::Number { min, max } => {
                // A scene may write a number as text. `minimum` applies only to numbers; the rules
                // check texts.
                json!({ "type": ["number", "string"], "minimum": min, "maximum": max })
            }
            SettingKind::Choice { values } => {
                // A scene may write the choice `2` as a number.
                let numbers = values.iter().filter_map(|v| serde_json::from_str(v).ok());
                let texts = values.iter().map(|v| json!(v));
                json!({ "enum": texts.chain(numbers).collect::<Vec<Value>>() })
            }
            SettingKind::Path | SettingKind::Text => {
                json!({ "type": ["string", "number", "boolean"] })
            }
        };
        properties.insert(setting.name.clone(), schema);
    }
    let schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "type": "object",
        "properties": { "device": { "properties": { "settings": {
            "properties": properties,
            "additionalProperties": false,
        } } } },
    });
    SchemaFile::new(&format!("settings of {}", device.id), &schema)
}
