//! A texture's metadata.

use super::GivenLaw;
use super::setting::settings;
use crate::AuthorError;
use htex_base::finding::Severity;
use htex_format::{Contact, Law, Manifest, check_doi, check_license};

settings! {
    /// What a texture is, who made it, and how it was recorded. A missing entry keeps the existing
    /// value; an empty text removes it.
    #[cfg_attr(feature = "clap", command(next_help_heading = "Metadata"))]
    pub struct Metadata {
        /// Name of the texture. In a recipe, `name` is not a key of the metadata. Instead, it is a
        /// key at the same level as `recordings`.
        #[cfg_attr(feature = "schemars", schemars(skip))]
        #[cfg_attr(feature = "clap", arg(long, help = "Name of the texture"))]
        pub name: Option<String>,

        /// Who made the texture.
        #[cfg_attr(feature = "clap", arg(long, help = "Who made the texture"))]
        pub author: Option<String>,

        /// SPDX licence expression.
        #[cfg_attr(feature = "clap", arg(
            long,
            value_name = "SPDX",
            help = "Licence of the asset, as an SPDX expression, e.g. CC-BY-4.0"
        ))]
        pub license: Option<String>,

        /// What the surface is, in words.
        #[cfg_attr(feature = "clap", arg(long, value_name = "TEXT", help = "What the surface is, in words"))]
        pub description: Option<String>,

        /// Search terms.
        #[cfg_attr(feature = "clap", arg(
            long = "tag",
            visible_alias = "tags",
            value_delimiter = ',',
            value_name = "WORD,…",
            help = "Search terms (tags), comma-separated; may be given several times"
        ))]
        pub tags: Option<Vec<String>>,

        /// Where the recordings come from.
        #[cfg_attr(feature = "clap", arg(
            long,
            value_name = "TEXT",
            help = "Where the recordings come from, e.g. a dataset, a laboratory or a web address"
        ))]
        pub source: Option<String>,

        /// DOI of the recordings or of the paper that describes them.
        #[cfg_attr(feature = "clap", arg(
            long,
            help = "DOI of the recordings or of the paper that describes them, e.g. 10.5281/zenodo.1234567"
        ))]
        pub doi: Option<String>,

        /// The sensor that measured the signal.
        #[cfg_attr(feature = "clap", arg(
            long,
            value_name = "TEXT",
            help = "Sensor that measured the signal, e.g. \"six-axis force sensor, ATI Nano17\""
        ))]
        pub sensor: Option<String>,

        /// What slid over the surface, in words, such as `bare index finger`.
        #[cfg_attr(feature = "clap", arg(
            long,
            value_name = "TEXT",
            help = "What slid over the surface, e.g. \"bare index finger\""
        ))]
        pub finger: Option<String>,

        /// Whether a finger or a tool slid over the surface. The contact decides which law is
        /// assumed for motions that were not recorded.
        #[cfg_attr(feature = "clap", arg(
            long,
            value_enum,
            help = "Whether a finger or a tool slid over the surface. From this, htex assumes how \
                    frequencies and level change at speeds and forces that were not recorded, \
                    unless the recordings show it or --law states it"
        ))]
        pub contact: Option<Contact>,

        /// Exponents of the law that predicts frequencies and level for motions that were not
        /// recorded.
        #[cfg_attr(feature = "clap", arg(
            long,
            value_name = "NAME=X,…",
            help = "Exponents by which frequencies and level change at speeds and forces that were \
                    not recorded: frequency-speed, level-speed and level-force, e.g. \
                    frequency-speed=0,level-speed=0.4. They replace measured or assumed exponents"
        ))]
        pub law: Option<GivenLaw>,
    }
}

impl Metadata {
    /// Returns whether all entries are missing.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Checks the entries by the rules that also apply when an asset is validated. Returns warnings
    /// of the form `FIELD: SENTENCE`.
    ///
    /// # Errors
    /// Returns an error if an entry would make the asset invalid.
    pub fn check(&self) -> Result<Vec<String>, AuthorError> {
        let refuse = |field, problem: String| Err(AuthorError::Metadata { field, problem });
        if self.name.as_deref().is_some_and(|name| name.trim().is_empty()) {
            return refuse("name", "the name is empty; give one".to_owned());
        }
        let doi = self.doi.as_deref().filter(|doi| !doi.is_empty());
        if let Some(Err(error)) = doi.map(check_doi) {
            return refuse("doi", error.to_string());
        }
        let license = self.license.as_deref().filter(|license| !license.is_empty());
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
        self.apply_law(manifest);
    }

    /// Writes contact and law into a manifest. If the contact changes, assumed exponents are
    /// replaced by the assumptions for the new contact, and measured exponents are combined with
    /// these assumptions.
    fn apply_law(&self, manifest: &mut Manifest) {
        let (law, contact) = (manifest.law(), self.contact.unwrap_or(manifest.contact));
        let of_contact = |law: Law| law.reassumed(manifest.quantity, contact);
        let law = of_contact(law);
        let given = self.law.map(|given| of_contact(given.over(law)));
        if self.contact.is_some() || given.is_some() {
            manifest.contact = contact;
            manifest.law = Some(given.unwrap_or(law));
        }
    }
}
