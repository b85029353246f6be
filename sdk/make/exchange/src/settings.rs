//! Settings for importing files with signals and images. Each setting is a flag of the command and
//! a key of recipes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

#[cfg(feature = "clap")]
use crate::profile_names;

/// Settings for importing signals (`.haptic`, `.ahap`, `.hjif`) and images. Quantity, speed and
/// force are not among these settings; they are set in the same way as for recordings.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct SignalSettings {
    /// The physical value of the number 1 in a haptic signal, or of white in an image, in the
    /// quantity's unit.
    #[schemars(range(max = 1e6), extend("exclusiveMinimum" = 0))]
    #[cfg_attr(
        feature = "clap",
        arg(
            long,
            value_name = "UNIT",
            display_order = 1,
            help = "Value for which full scale stands (1 in a signal, white in an image), in the \
                    unit of --quantity, e.g. newtons for a force"
        )
    )]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full_scale: Option<f64>,

    /// Distance between the pixels of an image, mm.
    #[schemars(range(max = 64), extend("exclusiveMinimum" = 0))]
    #[cfg_attr(
        feature = "clap",
        arg(
            id = "pitch",
            long = "pitch",
            value_name = "MM",
            display_order = 1,
            help = "Distance between neighbouring pixels of an image, mm [default: the distance \
                    that the file states]"
        )
    )]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitch_mm: Option<f64>,

    /// Name of the actuator, for files that give frequencies as positions in an actuator's range.
    /// If missing, the format's default actuator is used.
    #[cfg_attr(feature = "clap", arg(
        long,
        value_name = "NAME",
        value_parser = profile_names(),
        display_order = 1,
        help = "Actuator for which the file was made, for formats that state frequencies as \
                positions in the range of an actuator [default: depends on the format]"
    ))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
}

impl SignalSettings {
    /// Returns these settings. Settings that are missing here are taken from `under`.
    ///
    /// ```
    /// use htex_exchange::SignalSettings;
    /// let own = SignalSettings { full_scale: Some(0.2), ..SignalSettings::default() };
    /// let under = SignalSettings { full_scale: Some(1.0), profile: Some("quest".to_owned()), ..SignalSettings::default() };
    /// let both = own.over(under);
    /// assert_eq!((both.full_scale, both.profile.as_deref()), (Some(0.2), Some("quest")));
    /// ```
    #[must_use]
    pub fn over(self, under: Self) -> Self {
        Self {
            full_scale: self.full_scale.or(under.full_scale),
            pitch_mm: self.pitch_mm.or(under.pitch_mm),
            profile: self.profile.or(under.profile),
        }
    }
}
