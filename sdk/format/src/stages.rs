//! The stages of reading: in which order findings are made, and where reading stops.

/// A stage of reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stage {
    /// What the stage checks.
    pub of: &'static str,
    /// The codes of its findings; a few belong to several stages.
    pub codes: &'static [&'static str],
    /// Whether reading ends after the stage if it found an error.
    pub ends: bool,
}

/// All stages of reading an asset, in order.
pub const STAGES: &[Stage] = &[
    Stage {
        of: "the file, and the end record; the first finding only",
        codes: &[
            "FILE_TOO_LARGE",
            "ARCHIVE_INVALID",
            "ARCHIVE_ZIP64",
            "ARCHIVE_EXTRA_DATA",
            "ARCHIVE_TOO_MANY_ENTRIES",
        ],
        ends: true,
    },
    Stage {
        of: "the entries' headers, in the directory's order, and then all of them together; after a \
             record or a local header at a wrong position, no further one is checked",
        codes: &[
            "ENTRY_NAME_UNSAFE",
            "ENTRY_NAME_DUPLICATE",
            "ENTRY_ENCRYPTED",
            "ENTRY_COMPRESSION_UNKNOWN",
            "ENTRY_DATA_DESCRIPTOR",
            "ARCHIVE_ZIP64",
            "ENTRY_EXTRA_FIELD",
            "ENTRY_TOO_LARGE",
            "ENTRY_RATIO",
            "ARCHIVE_INVALID",
            "ARCHIVE_EXTRA_DATA",
            "ENTRY_HEADER_MISMATCH",
            "ARCHIVE_TOO_LARGE",
        ],
        ends: true,
    },
    Stage {
        of: "the entries' data, unpacked, in the directory's order",
        codes: &["ENTRY_CORRUPT"],
        ends: true,
    },
    Stage {
        of: "`mimetype`",
        codes: &[
            "MIMETYPE_MISSING",
            "MIMETYPE_NOT_FIRST",
            "MIMETYPE_COMPRESSED",
            "MIMETYPE_WRONG",
        ],
        ends: false,
    },
    Stage {
        of: "the manifest as JSON, its version and its quantity; the first error only",
        codes: &[
            "MANIFEST_MISSING",
            "JSON_TOO_DEEP",
            "JSON_SYNTAX",
            "JSON_TYPE",
            "VERSION_MISSING",
            "VERSION_INVALID",
            "VERSION_UNSUPPORTED",
            "VERSION_NEWER",
            "QUANTITY_UNKNOWN",
        ],
        ends: true,
    },
    Stage {
        of: "unknown keys, sorted by pointer",
        codes: &["JSON_UNKNOWN_KEY"],
        ends: false,
    },
    Stage {
        of: "the whole texture",
        codes: &[
            "NAME_EMPTY",
            "LICENSE_MISSING",
            "LICENSE_INVALID",
            "LICENSE_UNKNOWN",
            "DOI_INVALID",
            "UNIT_UNKNOWN",
            "BAND_INVALID",
        ],
        ends: false,
    },
    Stage {
        of: "recordings, in their order",
        codes: &["SOURCE_INVALID", "SOURCE_PATH", "MADE_INVALID"],
        ends: false,
    },
    Stage {
        of: "conditions, in their order",
        codes: &[
            "CONDITIONS_EMPTY",
            "CONDITION_INVALID",
            "CONDITION_DUPLICATE",
        ],
        ends: false,
    },
    Stage {
        of: "representations, in their order: the model, each field, each condition",
        codes: &[
            "REPRESENTATIONS_EMPTY",
            "MODEL_DUPLICATE",
            "MODEL_ID_INVALID",
            "MODEL_VERSION_INVALID",
            "FIELD_NAME_EMPTY",
            "FIELD_DUPLICATE",
            "STORE_INVALID",
            "AT_EMPTY",
            "CONDITION_INDEX_INVALID",
            "CONDITION_INDEX_DUPLICATE",
            "LEVEL_INVALID",
            "QUALITY_INVALID",
        ],
        ends: false,
    },
    Stage {
        of: "plugins, in their order",
        codes: &[
            "PLUGIN_INVALID",
            "PLUGIN_DUPLICATE",
            "PLUGIN_UNUSED",
            "PLUGIN_SIGNATURE_INVALID",
        ],
        ends: false,
    },
    Stage {
        of: "extensions by name, and those required in their order",
        codes: &["EXTENSION_NAME_INVALID", "EXTENSION_REQUIRED_UNKNOWN"],
        ends: false,
    },
    Stage {
        of: "fields, compared with those of models that the reader has: stored fields, then absent ones",
        codes: &[
            "FIELD_UNKNOWN",
            "FIELD_KIND_WRONG",
            "FIELD_UNIT_WRONG",
            "FIELD_MISSING",
        ],
        ends: false,
    },
    Stage {
        of: "parameter blocks, in the order of representations; the first finding of each",
        codes: &[
            "ENTRY_MISSING",
            "PARAMETERS_ENTRY_INVALID",
            "PARAMETERS_INVALID",
            "PARAMETERS_NOT_FINITE",
            "VALUES_TOO_MANY",
        ],
        ends: false,
    },
    Stage {
        of: "the reference; the first finding only",
        codes: &[
            "ENTRY_MISSING",
            "PARAMETERS_ENTRY_INVALID",
            "REFERENCE_LENGTH",
            "VALUES_TOO_MANY",
            "REFERENCE_INVALID",
        ],
        ends: false,
    },
    Stage {
        of: "the plugins' modules, in their order",
        codes: &[
            "ENTRY_MISSING",
            "PARAMETERS_ENTRY_INVALID",
            "PLUGIN_NOT_WASM",
            "PLUGIN_HASH_MISMATCH",
        ],
        ends: false,
    },
    Stage {
        of: "unreferenced entries, in the directory's order",
        codes: &["ENTRY_UNREFERENCED"],
        ends: false,
    },
    Stage {
        of: "JSON Schemas, in validators that check documents against them",
        codes: &[
            "SCHEMA_BROKEN",
            "EXTENSION_SCHEMA_BROKEN",
            "DESCRIPTOR_INVALID",
            "PLUGIN_UNUSABLE",
        ],
        ends: false,
    },
    Stage {
        of: "the count of findings beyond the first hundred",
        codes: &["FINDINGS_TRUNCATED"],
        ends: false,
    },
];
