//! An entry of the index: the facts about a texture that a library knows without opening the
//! texture.

use std::ops::Range;

use crate::{Contact, Law, Quantity};
use serde::{Serialize, Serializer};

/// An entry of the index: a texture's name, search terms, recorded conditions, models, size and
/// hash.
///
/// ```no_run
/// let library = htex_format::library::Library::open("cloth.htexlib".as_ref())?;
/// if let Some(entry) = library.entry("woven/cotton")? {
///     println!("{} bytes, recorded at {:?} mm/s", entry.bytes, entry.conditions.speed_mm_s);
/// }
/// # Ok::<(), htex_format::library::LibraryError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Entry {
    /// Name in the library, with `/` between its parts ([`crate::library::check_name`]).
    pub name: String,
    /// Search terms, in the texture's own order.
    pub tags: Vec<String>,
    /// Range of the conditions at which the texture was recorded.
    pub conditions: Conditions,
    /// Kind of contact: what slid over the surface.
    pub contact: Contact,
    /// The motion law: how frequencies and level change at a speed or force outside these
    /// conditions. The index does not store the measurements of the law's exponents.
    pub law: Law,
    /// Ids of the models that describe the texture, in the texture's own order.
    pub models: Vec<String>,
    /// Licence of the texture; `None` if the texture states no licence. The index stores only the
    /// first 255 bytes. This field and the next four fields are `None` in a library of version 1.0,
    /// because its index does not store them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub license: Option<String>,
    /// Who made the texture; `None` if the texture does not state it. The index stores only the
    /// first 255 bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub author: Option<String>,
    /// Physical quantity of the texture's samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quantity: Option<Quantity>,
    /// Felt difference between the texture and its recordings at the worst condition: RMS over
    /// third-octave bands, decibels. `None` if the writer did not know it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub felt_error_rms_db: Option<f64>,
    /// Held-out error at the worst recorded condition: RMS over third-octave bands, decibels.
    /// `None` if the texture does not state it. To measure this error, the texture is fitted to one
    /// half of its recordings and compared with the other half.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held_out_error_db: Option<f64>,
    /// Size of the texture's `.htex` file, bytes.
    pub bytes: u64,
    /// BLAKE3 of the texture's `.htex` file; hexadecimal in JSON.
    #[serde(serialize_with = "hexadecimal")]
    pub blake3: [u8; 32],
    #[serde(skip)]
    pub(crate) place: TexturePlace,
}

/// Range of the recorded conditions: the smallest and the greatest known speed and force.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Conditions {
    /// Range of the finger's speeds, mm/s; `None` if no speed is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_mm_s: Option<Interval>,
    /// Range of the normal forces, newtons; `None` if no force is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_n: Option<Interval>,
}

/// A closed interval. Both ends are finite and not negative.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    pub min: f64,
    pub max: f64,
}

/// Place of a texture's bytes in the file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct TexturePlace {
    /// Range of the bytes that only this texture has, counted from the start of the payload.
    pub own: Range<u64>,
    /// Objects that the texture shares with other textures. A reader inserts them into the bytes of
    /// `own` in this order.
    pub cuts: Vec<Cut>,
    /// The leaf page of the entry, and the entry's number in it.
    pub leaf: usize,
    pub row: usize,
}

/// A shared object inside a texture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Cut {
    /// Position of the object in the texture: the number of the texture's own bytes (bytes that it
    /// does not share with other textures) before the object.
    pub at: u64,
    /// Range of the object, counted from the start of the shared part.
    pub object: Range<u64>,
}

impl Entry {
    /// Returns the BLAKE3 of the texture as 64 hexadecimal digits.
    pub fn blake3_hex(&self) -> String {
        blake3::Hash::from_bytes(self.blake3).to_hex().to_string()
    }
}

impl Interval {
    /// Returns the smallest interval that contains all numbers; `None` if there are no numbers.
    pub(crate) fn around(numbers: impl IntoIterator<Item = f64>) -> Option<Self> {
        numbers.into_iter().fold(None, |interval, x| {
            let Self { min, max } = interval.unwrap_or(Self { min: x, max: x });
            Some(Self { min: min.min(x), max: max.max(x) })
        })
    }
}

fn hexadecimal<S: Serializer>(hash: &[u8; 32], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&blake3::Hash::from_bytes(*hash).to_hex())
}
