//! The kind of a field, and its encoding in files.

/// One number, or a list of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "host", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "host", serde(tag = "type", rename_all = "kebab-case"))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub enum Kind {
    /// One number.
    Scalar,
    /// 0 to `max_len` numbers.
    List {
        /// Most numbers allowed, at most 65,535.
        #[cfg_attr(feature = "schemars", schemars(range(max = 65535)))]
        max_len: u32,
    },
}

/// How a file stores a field's values: `offset + scale·q`, or `exp(offset + scale·q)` when
/// `log` is set, for the integer kinds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "host", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "host", serde(tag = "type", rename_all = "kebab-case"))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub enum Store {
    /// 64-bit float.
    F64,
    /// 32-bit float.
    F32,
    /// Unsigned 16-bit steps.
    U16 {
        /// Step.
        #[cfg_attr(feature = "schemars", schemars(extend("exclusiveMinimum" = 0)))]
        scale: f64,
        /// Value at zero.
        offset: f64,
        /// Steps in the logarithm.
        #[cfg_attr(feature = "host", serde(default))]
        log: bool,
    },
    /// Unsigned 8-bit steps.
    U8 {
        /// Step.
        #[cfg_attr(feature = "schemars", schemars(extend("exclusiveMinimum" = 0)))]
        scale: f64,
        /// Value at zero.
        offset: f64,
        /// Steps in the logarithm.
        #[cfg_attr(feature = "host", serde(default))]
        log: bool,
    },
    /// Unsigned 8-bit steps of a list, packed by their differences.
    Packed {
        /// Step.
        scale: f64,
        /// Value at zero.
        offset: f64,
        /// Steps in the logarithm.
        #[cfg_attr(feature = "host", serde(default))]
        log: bool,
    },
}
