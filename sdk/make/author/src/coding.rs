//! Selects whether a fitted asset is stored in the coded form. A coded asset has the same texture
//! in fewer bytes, but readers of version 1.0 refuse it.

use htex_format::Asset;
use serde::{Deserialize, Serialize};

/// Number of conditions up to which an asset is not coded unless the user asks for it. Such an
/// asset has only a few kilobytes, so it is more important that every reader can open it.
const MOST_PLAIN: usize = 8;

/// Selects whether an asset is coded, i.e. stores the same texture in fewer bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Coding {
    /// Coded if the asset has more than eight conditions and coding makes the file smaller.
    #[default]
    Auto,
    /// Always coded.
    Coded,
    /// Never coded, so that readers of version 1.0 can open the asset.
    Plain,
}

impl Coding {
    /// All choices, in the order of the command line's help.
    pub const ALL: &[Self] = &[Self::Auto, Self::Coded, Self::Plain];

    /// Returns the name used in recipes and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Coded => "coded",
            Self::Plain => "plain",
        }
    }

    /// Converts the asset to the coded or the uncoded form, as this choice requires. Parameters and
    /// levels stay the same.
    #[must_use]
    pub fn of(self, asset: Asset) -> Asset {
        match self {
            Self::Coded => asset.coded(),
            Self::Plain => asset.plain(),
            Self::Auto => {
                let plain = asset.plain();
                if plain.manifest.conditions.len() <= MOST_PLAIN {
                    return plain;
                }
                let coded = plain.clone().coded();
                match (plain.to_bytes(), coded.to_bytes()) {
                    (Ok(bytes), Ok(fewer)) if fewer.len() < bytes.len() => coded,
                    _ => plain,
                }
            }
        }
    }
}
