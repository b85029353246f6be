//! A texture's metadata.

use htex_format::{Manifest, Severity, check_doi, check_license};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::SettingsError;

/// What a texture is, who made it, and how it was recorded. An absent entry leaves what is there; an empty text removes it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Metadata {
    /// Name of the texture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Who made it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub author: Option<String>,
    /// SPDX licence expression.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub license: Option<String>,
    /// What the surface is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Search terms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tags: Option<Vec<String>>,
    /// Where the recordings come from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// DOI of the recordings or of the paper that describes them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doi: Option<String>,
    /// What measured the signal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
    /// What slid over the surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finger: Option<String>,
}

impl Metadata {
    /// Returns these entries, and where they are absent those of `under`.
    #[must_use]
    pub fn over(self, under: Self) -> Self {
        Self {
            name: self.name.or(under.name),
            author: self.author.or(under.author),
            license: self.license.or(under.license),
            description: self.description.or(under.description),
            tags: self.tags.or(under.tags),
            source: self.source.or(under.source),
            doi: self.doi.or(under.doi),
            sensor: self.sensor.or(under.sensor),
            finger: self.finger.or(under.finger),
        }
    }

    /// Whether no entry is given.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Checks what the asset's validation would find; returns warnings, `FIELD: SENTENCE`.
    ///
    /// # Errors
    /// When an entry would make the asset invalid.
    pub fn check(&self) -> Result<Vec<String>, SettingsError> {
        let refuse = |field, problem: String| Err(SettingsError::Metadata { field, problem });
        if self
            .name
            .as_deref()
            .is_some_and(|name| name.trim().is_empty())
        {
            return refuse("name", "the name is empty; give one".to_owned());
        }
        let doi = self.doi.as_deref().filter(|doi| !doi.is_empty());
        if let Some(Err(error)) = doi.map(check_doi) {
            return refuse("doi", error.to_string());
        }
        let license = self
            .license
            .as_deref()
            .filter(|license| !license.is_empty());
        match license.map(check_license) {
            Some(Err(error)) if error.rule().severity == Severity::Error => {
                refuse("license", error.to_string())
            }
            Some(Err(error)) => Ok(vec![format!("license: {error}")]),
            _ => Ok(Vec::new()),
        }
    }

    /// Writes the entries into a manifest.
    pub fn apply(&self, manifest: &mut Manifest) {
        if let Some(name) = &self.name {
            manifest.name.clone_from(name);
        }
        if let Some(tags) = &self.tags {
            manifest.tags = tags.iter().filter(|tag| !tag.is_empty()).cloned().collect();
        }
        let texts = [
            (&self.author, &mut manifest.author),
            (&self.license, &mut manifest.license),
            (&self.description, &mut manifest.description),
            (&self.source, &mut manifest.source),
            (&self.doi, &mut manifest.doi),
            (&self.sensor, &mut manifest.sensor),
            (&self.finger, &mut manifest.finger),
        ];
        for (given, kept) in texts {
            if let Some(text) = given {
                *kept = Some(text.clone()).filter(|text| !text.is_empty());
            }
        }
        manifest.declare_version();
    }
}
