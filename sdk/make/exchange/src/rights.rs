//! Reads the licence and the author of a texture (its rights) from the files of each format.

use htex_format::{Rights, check_license};
use serde::Deserialize;
use serde_json::Value;

use crate::error::{ExchangeError, list};
use crate::format::Format;
use crate::gltf;
use crate::map;

/// The place in a format's files where the rights are stored, and the function that reads them.
#[derive(Debug, Clone, Copy)]
pub struct RightsPlace {
    /// Description of the place.
    pub place: &'static str,
    pub(crate) read: fn(&[u8]) -> Rights,
}

impl RightsPlace {
    /// Returns a sentence about the licence and the author that a file with these rights states.
    pub(crate) fn sentence(&self, rights: &Rights) -> String {
        let place = self.place;
        match (&rights.license, &rights.author) {
            (Some(license), Some(author)) => {
                format!("It states the licence {license} and the author {author} ({place}).")
            }
            (Some(license), None) => format!("It states the licence {license} ({place})."),
            (None, Some(author)) => {
                format!("It states the author {author} ({place}). {UNLICENSED}")
            }
            (None, None) => UNLICENSED.to_owned(),
        }
    }
}

/// The place for a format whose files cannot state rights: the separate file `NAME.license`.
pub(crate) const BESIDE: RightsPlace =
    RightsPlace { place: "FILE.license", read: |_| Rights::default() };
pub(crate) const HAPTIC: RightsPlace = RightsPlace {
    place: "metadata.description, metadata.author",
    read: |bytes| {
        let author = text(bytes, "metadata", "author");
        from_text(text(bytes, "metadata", "description")).or(Rights::new(None, author.as_deref()))
    },
};
pub(crate) const AHAP: RightsPlace = RightsPlace {
    place: "Metadata.Description",
    read: |bytes| from_text(text(bytes, "metadata", "Description")),
};
pub(crate) const ANDROID: RightsPlace = RightsPlace {
    place: "rights (JSON), a comment (Kotlin)",
    read: |bytes| Rights::from_text(&String::from_utf8_lossy(bytes)),
};
pub(crate) const HJIF: RightsPlace =
    RightsPlace { place: "description", read: |bytes| from_text(text(bytes, "description", "")) };
pub(crate) const WAV: RightsPlace =
    RightsPlace { place: "LIST INFO: ICOP, IART", read: |_| Rights::default() };
pub(crate) const PNG: RightsPlace = RightsPlace { place: "iTXt: Copyright", read: map::rights };
pub(crate) const GLTF: RightsPlace = RightsPlace {
    place: "asset.copyright, and the asset",
    read: |bytes| from_text(gltf::copyright(bytes)),
};

/// The sentence for an exported file without a licence.
const UNLICENSED: &str =
    "It states no licence, and without one nobody may pass it on; give the texture a licence.";

fn from_text(text: Option<String>) -> Rights {
    text.map(|text| Rights::from_text(&text)).unwrap_or_default()
}

/// The parts of a JSON file that may contain text for readers. All other parts are ignored.
#[derive(Deserialize)]
struct Head {
    #[serde(default, alias = "Metadata")]
    metadata: Value,
    #[serde(default)]
    description: Value,
    #[serde(default)]
    asset: Value,
}

/// Returns a string of a JSON file: `description`, or a key inside `metadata` or `asset`. Returns
/// `None` if it is missing.
pub(crate) fn text(bytes: &[u8], part: &str, key: &str) -> Option<String> {
    let head: Head = serde_json::from_slice(bytes).ok()?;
    let part = match part {
        "metadata" => head.metadata.get(key)?.clone(),
        "asset" => head.asset.get(key)?.clone(),
        _ => head.description,
    };
    part.as_str().map(str::to_owned)
}

/// The rights that a file and the file `NAME.license` next to it state.
pub(crate) struct FileRights {
    pub(crate) rights: Rights,
    /// What was not accepted, as a list of sentences.
    pub(crate) left_out: Vec<String>,
}

impl FileRights {
    /// Combines the rights that the file and the `.license` file next to it state. A conflict does
    /// not matter if the user gives the value.
    ///
    /// # Errors
    /// When both state different licences or authors, and the user gives none.
    pub(crate) fn read(
        format: &Format,
        bytes: &[u8],
        beside: Option<&str>,
        given: &Rights,
    ) -> Result<Self, ExchangeError> {
        let inside = (format.rights.read)(bytes);
        let beside = beside.map(Rights::from_text).unwrap_or_default();
        agree("license", &inside.license, &beside.license, &given.license)?;
        agree("author", &inside.author, &beside.author, &given.author)?;
        let mut stated = Self { rights: inside.or(beside), left_out: Vec::new() };
        if let Some(license) = &stated.rights.license
            && given.license.is_none()
            && matches!(check_license(license), Err(error) if error.rule().code == "LICENSE_INVALID")
        {
            stated.left_out.push(format!(
                "The licence {license:?} that the file states is no SPDX expression, and is left out."
            ));
            stated.rights.license = None;
        }
        Ok(stated)
    }

    /// Checks that an asset inside the file states the same rights, or none.
    ///
    /// # Errors
    /// When the asset states another licence or author, and the user gives none.
    pub(crate) fn check(&self, own: &Rights, given: &Rights) -> Result<(), ExchangeError> {
        agree("license", &own.license, &self.rights.license, &given.license)?;
        agree("author", &own.author, &self.rights.author, &given.author)
    }
}

fn agree(
    setting: &'static str,
    one: &Option<String>,
    other: &Option<String>,
    given: &Option<String>,
) -> Result<(), ExchangeError> {
    match (one, other, given) {
        (Some(one), Some(other), None) if one != other => Err(ExchangeError::Rights {
            setting,
            stated: list([one, other].map(|words| format!("{words:?}")).into_iter()),
        }),
        _ => Ok(()),
    }
}
