//! Registries of plugins: a folder, or a place on the web, with one TOML file for each plugin.

use htex_format::signing::PublicKey;
use schemars::JsonSchema;
use semver::Version as SemanticVersion;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A plugin in a registry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Reverse-DNS id, as in the plugin's descriptor. The file has the name ID.toml
    pub id: String,
    /// What the plugin is
    pub kind: PluginKind,
    /// What it does, in one sentence
    pub summary: String,
    /// Licence, as an SPDX expression
    pub license: String,
    /// Address of its source code
    pub source: String,
    /// The public key that signs its versions, 64 hexadecimal digits
    #[schemars(with = "String", regex(pattern = "^[0-9a-f]{64}$"))]
    pub key: PublicKey,
    /// A sound or a picture of it: a path in the registry
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preview: Option<String>,
    /// Its versions, at least one
    #[schemars(length(min = 1))]
    pub versions: Vec<Version>,
}

/// What a plugin is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PluginKind {
    Model,
    Device,
}

impl PluginKind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Device => "device",
        }
    }

    /// Returns the kind of a plugin file, without running the file. Every model exports a function
    /// with one fixed name, and every device exports a function with another fixed name. The kind
    /// follows from the name that the file contains.
    pub fn of(file: &[u8]) -> Option<Self> {
        let has = |name: &[u8]| file.windows(name.len()).any(|part| part == name);
        if has(b"htex_model_abi_version") {
            Some(Self::Model)
        } else if has(b"htex_device_adapter") {
            Some(Self::Device)
        } else {
            None
        }
    }
}

/// A version of a plugin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Version {
    /// Semantic version, as in the plugin's descriptor
    #[schemars(with = "String")]
    pub version: SemanticVersion,
    /// Its files, one for each platform
    #[schemars(length(min = 1))]
    pub files: Vec<PlatformFile>,
}

/// A file of a version. The signature of the file is at the same place, under the file's name with
/// `.sig` appended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlatformFile {
    /// `wasm` for a module, which runs everywhere, or `SYSTEM-PROCESSOR` for a native library, e.g.
    /// `linux-x86_64`
    pub platform: String,
    /// A path in the registry, or an `https://` address
    pub file: String,
    /// BLAKE3 of the file, 64 hexadecimal digits
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub blake3: String,
}

/// The platform of a module.
pub const MODULE: &str = "wasm";

/// Returns the platform of this program, for native libraries.
pub fn own_platform() -> String {
    format!("{}-{}", std::env::consts::OS, std::env::consts::ARCH)
}

impl Entry {
    /// Parses an entry, and checks everything except the entry's files.
    ///
    /// # Errors
    /// Returns an error that says which rule the entry breaks.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let text = std::str::from_utf8(bytes).map_err(|error| error.to_string())?;
        let entry: Self =
            htex_base::files::toml::from_str(text).map_err(|error| error.to_string())?;
        entry.check()?;
        Ok(entry)
    }

    fn check(&self) -> Result<(), String> {
        if !htex_format::is_model_id(&self.id) {
            return Err(format!("`{}` is not a reverse-DNS id", self.id));
        }
        htex_format::check_license(&self.license).map_err(|error| error.to_string())?;
        if self.versions.is_empty() {
            return Err("it has no version".to_owned());
        }
        for (i, version) in self.versions.iter().enumerate() {
            if self.versions[..i].iter().any(|other| other.version == version.version) {
                return Err(format!("version {} is there twice", version.version));
            }
            if version.files.is_empty() {
                return Err(format!("version {} has no file", version.version));
            }
            for PlatformFile { file, .. } in &version.files {
                let is_inside = file.split('/').all(|part| !matches!(part, "" | "." | ".."))
                    && !file.contains(['\\', ':']);
                if !is_inside && !file.starts_with("https://") {
                    return Err(format!(
                        "`{file}` is neither a path in the registry nor an https:// address"
                    ));
                }
            }
        }
        Ok(())
    }

    /// Returns the newest version that `fits` accepts and that has a file for this machine,
    /// together with this file. The file is a module if the version has one, and otherwise a native
    /// library.
    pub fn newest(
        &self,
        fits: impl Fn(&SemanticVersion) -> bool,
    ) -> Option<(&Version, &PlatformFile)> {
        let own = own_platform();
        let file = |version: &'_ Version| {
            let of =
                |platform: &str| version.files.iter().position(|file| file.platform == platform);
            of(MODULE).or_else(|| of(&own))
        };
        let fitting = self.versions.iter().filter(|version| fits(&version.version));
        let usable = fitting.filter_map(|version| Some((version, file(version)?)));
        let newest = usable.max_by(|(a, _), (b, _)| a.version.cmp(&b.version));
        newest.map(|(version, at)| (version, &version.files[at]))
    }
}

/// Returns the JSON Schema of an entry: `spec/schemas/registry-entry-1.json`.
pub fn entry_schema() -> Value {
    htex_base::schema::document::<Entry>("registry-entry-1.json", "plugin in a registry")
}
