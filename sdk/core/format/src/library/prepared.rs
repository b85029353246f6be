//! A texture that is ready to be added to a library.

use crate::library::description::Description;
use crate::library::facts::Facts;
use crate::{Asset, ReadError};

/// A function that computes a texture's description: values for searches, in addition to the facts
/// in the texture's manifest.
pub type Describe = fn(&Asset) -> Description;

/// A checked texture that is ready to be added to a library. Several threads can prepare textures
/// at the same time.
///
/// ```no_run
/// use htex_format::library::{PreparedTexture, Writer};
/// let mut writer = Writer::create("cloth.htexlib".as_ref(), "Cloth")?;
/// let cotton = PreparedTexture::new(std::fs::read("cotton.htex")?, None)?;
/// writer.add_prepared("woven/cotton", cotton)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PreparedTexture {
    pub(crate) bytes: Vec<u8>,
    pub(crate) blake3: [u8; 32],
    pub(crate) facts: Facts,
    /// Values for searches, in addition to the facts in the texture's manifest.
    pub description: Description,
}

impl PreparedTexture {
    /// Checks the bytes of a `.htex` file. `describe` computes the texture's description. If
    /// `describe` is `None`, the description is empty.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a valid asset.
    pub fn new(bytes: Vec<u8>, describe: Option<Describe>) -> Result<Self, ReadError> {
        let asset = Asset::from_bytes(&bytes)?;
        let description = describe.map_or(Description::default(), |describe| describe(&asset));
        Ok(Self::of_asset(&asset, bytes, description))
    }

    /// Creates a prepared texture from an asset, the bytes that were written from this asset, and a
    /// description.
    pub fn of_asset(asset: &Asset, bytes: Vec<u8>, description: Description) -> Self {
        let blake3 = *blake3::hash(&bytes).as_bytes();
        Self { blake3, facts: Facts::new(&asset.manifest), bytes, description }
    }
}
