//! What all settings have in common. A setting may be missing. One set of settings can override
//! another set. An asset's provenance stores some of the settings.

use std::collections::BTreeMap;
use std::path::PathBuf;

use htex_format::{Contact, Quantity};

use super::{GivenLaw, OptionSetting, Preset};
use crate::{Averaging, Coding, Level, SegmentChoice};

/// A setting, which may be missing.
pub(super) trait Setting {
    /// Returns this setting, or the setting `under` if this one is missing.
    fn over(self, under: Self) -> Self;

    fn is_absent(&self) -> bool;

    /// Returns the text to store in the provenance; `None` for a default, which is not stored.
    fn recorded(&self) -> Option<String>;
}

/// The value of a setting, as the provenance stores it.
pub(super) trait Recorded {
    fn recorded(&self) -> Option<String>;
}

impl<T: Recorded> Setting for Option<T> {
    fn over(self, under: Self) -> Self {
        self.or(under)
    }

    fn is_absent(&self) -> bool {
        self.is_none()
    }

    fn recorded(&self) -> Option<String> {
        self.as_ref().and_then(T::recorded)
    }
}

/// Each option of a model is overridden separately.
impl Setting for BTreeMap<String, OptionSetting> {
    fn over(self, mut under: Self) -> Self {
        under.extend(self);
        under
    }

    fn is_absent(&self) -> bool {
        self.is_empty()
    }

    fn recorded(&self) -> Option<String> {
        None
    }
}

impl Recorded for Vec<String> {
    fn recorded(&self) -> Option<String> {
        (!self.is_empty()).then(|| self.join(" "))
    }
}

/// Only the name of a file is stored, because folders differ from machine to machine.
impl Recorded for PathBuf {
    fn recorded(&self) -> Option<String> {
        Some(self.file_name()?.to_string_lossy().into_owned())
    }
}

impl Recorded for Vec<PathBuf> {
    fn recorded(&self) -> Option<String> {
        let names: Vec<String> = self.iter().filter_map(Recorded::recorded).collect();
        (!names.is_empty()).then(|| names.join(", "))
    }
}

/// Values that are stored as a text, unless they are the default.
macro_rules! recorded {
    ($($type:ty: |$value:ident| $text:expr;)*) => {$(
        impl Recorded for $type {
            fn recorded(&self) -> Option<String> {
                let $value = self;
                $text
            }
        }
    )*};
}

recorded! {
    f64: |number| Some(number.to_string());
    usize: |number| Some(number.to_string());
    bool: |is| is.then(|| is.to_string());
    String: |text| Some(text.clone());
    Quantity: |quantity| unless_default(quantity, &quantity.name().replace('_', "-"));
    SegmentChoice: |choice| unless_default(choice, choice.name());
    Averaging: |averaging| unless_default(averaging, averaging.name());
    Contact: |_contact| None;
    GivenLaw: |_law| None;
    Preset: |preset| Some(preset.name().to_owned());
    Coding: |_coding| None;
    Level: |level| unless_default(level, level.name());
}

fn unless_default<T: Default + PartialEq>(value: &T, text: &str) -> Option<String> {
    (*value != T::default()).then(|| text.to_owned())
}

/// Defines a struct of settings once for all its uses: recipes and keywords (serde), the command's
/// flags (clap), and the provenance.
///
/// `= "NAME"` after a setting is the name of its flag. The provenance stores the setting under this
/// name. A setting whose flag has another form declares the flag in its attributes.
macro_rules! settings {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $($(#[$attribute:meta])* pub $field:ident: $type:ty $(= $flag:tt)?,)*
        }
    ) => {
        #[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
        #[cfg_attr(feature = "clap", derive(clap::Args))]
        #[serde(default, deny_unknown_fields)]
        $(#[$meta])*
        pub struct $name {$(
            $(#[$attribute])*
            $(#[cfg_attr(feature = "clap", arg(long = $flag))])?
            #[serde(skip_serializing_if = "crate::settings::setting::Setting::is_absent")]
            pub $field: $type,
        )*}

        impl $name {
            /// The names of the settings, as used in recipes and as Python keywords.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($field),)*];

            /// Returns these settings. Settings that are missing here are taken from `under`.
            #[must_use]
            pub fn over(self, under: Self) -> Self {
                use crate::settings::setting::Setting;
                Self { $($field: self.$field.over(under.$field),)* }
            }

            /// Returns the settings that an asset's provenance stores: all settings that differ
            /// from their defaults. Each setting has the name of the command's flag.
            pub fn recorded(&self) -> std::collections::BTreeMap<String, String> {
                #[allow(unused_imports)]
                use crate::settings::setting::Setting;
                let entries: &[(&str, Option<String>)] = &[$($(($flag, self.$field.recorded()),)?)*];
                let said = entries.iter().filter_map(|(flag, text)| Some(((*flag).to_owned(), text.clone()?)));
                // Inserted one by one: `collect` into a `BTreeMap` sorts with a sort function of
                // its own.
                let mut recorded = std::collections::BTreeMap::new();
                recorded.extend(said);
                recorded
            }
        }
    };
}
pub(super) use settings;
