//! The asset extension that states how the surface looks. Programs that show textures use it.
//! Players do not need it.

use serde::{Deserialize, Serialize};

use crate::Manifest;

/// The name of the extension that contains the [`Appearance`] of a surface.
pub const APPEARANCE: &str = "org.htex.appearance/1";

/// How a surface looks: its colour, gloss and relief.
///
/// ```no_run
/// # use htex_format::{Appearance, Asset};
/// let asset = Asset::open("oak.htex".as_ref())?;
/// let look = Appearance::of(&asset.manifest);
/// println!("{}", look.map_or("no colour".to_owned(), |look| format!("hue {}°", look.hue_deg)));
/// # Ok::<(), htex_format::ReadError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Appearance {
    /// Hue of the colour, degrees. Hue, saturation and lightness have the same meaning as in
    /// `hsl()` of CSS, in the sRGB colour space.
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 360)))]
    pub hue_deg: f64,
    /// Saturation of the colour: 0 is grey.
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 1)))]
    pub saturation: f64,
    /// Lightness of the colour: 0 is black, 1 is white.
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 1)))]
    pub lightness: f64,
    /// Gloss: 0 is matt, 1 reflects like a mirror.
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 1)))]
    pub gloss: f64,
    /// Depth of the relief: 0 is flat, 1 is the deepest relief that a program draws.
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 1)))]
    pub relief: f64,
    /// Pattern of the relief. The spectrum of the texture determines how fine the pattern is.
    pub pattern: Pattern,
}

/// The pattern of a relief.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Pattern {
    /// The same in all directions, e.g. stone or paper.
    Grain,
    /// Parallel ridges across the direction in which the finger slides, e.g. corduroy.
    Ridges,
    /// Long fibres, e.g. wood or brushed metal.
    Fibres,
    /// Threads over and under each other, e.g. linen.
    Weave,
    /// Rounded bumps with grooves between them, e.g. leather or gravel.
    Bumps,
}

impl Appearance {
    /// Returns the appearance that an asset states. Returns `None` if the asset states no
    /// appearance, or an appearance that breaks the extension's schema.
    pub fn of(manifest: &Manifest) -> Option<Self> {
        let look: Self =
            serde_json::from_value(manifest.extensions.get(APPEARANCE)?.clone()).ok()?;
        let parts = [look.saturation, look.lightness, look.gloss, look.relief];
        let is_valid = (0.0..=360.0).contains(&look.hue_deg)
            && parts.iter().all(|part| (0.0..=1.0).contains(part));
        is_valid.then_some(look)
    }
}
