//! The kind of a field, and its encoding in files.

/// The kind of a field: one number, or a list of numbers.
///
/// ```
/// use htex_model::{Kind, StaticField};
/// let amplitudes = StaticField::list("amplitude", "1", (0.0, 1.0), 16, "Amplitudes.");
/// assert_eq!(amplitudes.kind, Kind::List { max_len: 16 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "host", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "host", serde(tag = "type", rename_all = "kebab-case"))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(description = "One number, or a list of them."))]
pub enum Kind {
    /// One number.
    Scalar,
    /// A list of 0 to `max_len` numbers.
    List {
        /// Largest number of values in the list; at most 65,535.
        #[cfg_attr(feature = "schemars", schemars(range(max = 65535)))]
        max_len: u32,
    },
}

/// Encoding of a field's values in a file. The integer encodings store whole numbers `q`. A number
/// `q` stands for the value `offset + scale·q`, or for `exp(offset + scale·q)` if `log` is set.
///
/// ```
/// use htex_model::{StaticField, Store};
/// // One byte: 20 to 1040 Hz in steps of 4 Hz.
/// let steps = Store::U8 { scale: 4.0, offset: 20.0, log: false };
/// let peak = StaticField::scalar("peak_hz", "Hz", (20.0, 1040.0), "Peak.").stored(steps);
/// assert_eq!(peak.store, steps);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "host", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "host", serde(tag = "type", rename_all = "kebab-case"))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(
    feature = "schemars",
    schemars(
        description = "Encoding of a field's values in a file: `offset + scale·q`, or `exp(offset + scale·q)` when\n`log` is set, for the integer kinds."
    )
)]
pub enum Store {
    /// 64-bit float.
    F64,
    /// 32-bit float.
    F32,
    /// Unsigned 16-bit integers.
    U16 {
        /// Size of one step: the factor of the stored integer. If `log` is set, it is a step of the
        /// value's natural logarithm.
        #[cfg_attr(feature = "schemars", schemars(extend("exclusiveMinimum" = 0)))]
        scale: f64,
        /// Value for the stored integer 0. If `log` is set, it is that value's natural logarithm.
        offset: f64,
        /// Whether `scale` and `offset` refer to the natural logarithm of the value.
        #[cfg_attr(feature = "host", serde(default))]
        log: bool,
    },
    /// Unsigned 8-bit integers.
    U8 {
        /// Size of one step: the factor of the stored integer. If `log` is set, it is a step of the
        /// value's natural logarithm.
        #[cfg_attr(feature = "schemars", schemars(extend("exclusiveMinimum" = 0)))]
        scale: f64,
        /// Value for the stored integer 0. If `log` is set, it is that value's natural logarithm.
        offset: f64,
        /// Whether `scale` and `offset` refer to the natural logarithm of the value.
        #[cfg_attr(feature = "host", serde(default))]
        log: bool,
    },
    /// A list of unsigned 8-bit integers, stored as the differences between neighbours. Small
    /// differences take fewer bits.
    Packed {
        /// Size of one step: the factor of the stored integer. If `log` is set, it is a step of the
        /// value's natural logarithm.
        #[cfg_attr(feature = "schemars", schemars(extend("exclusiveMinimum" = 0)))]
        scale: f64,
        /// Value for the stored integer 0. If `log` is set, it is that value's natural logarithm.
        offset: f64,
        /// Whether `scale` and `offset` refer to the natural logarithm of the value.
        #[cfg_attr(feature = "host", serde(default))]
        log: bool,
    },
}
