//! Every rule of validation, in one table.

use crate::Severity;

/// A rule that validation applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rule {
    /// Stable name; never changes its meaning.
    pub code: &'static str,
    /// How bad it is when the rule is broken.
    pub severity: Severity,
    /// What was found, in a line.
    pub summary: &'static str,
    /// Why it matters.
    pub explanation: &'static str,
    /// What to do about it.
    pub fix: &'static str,
}

/// The rule of a code, such as `BAND_INVALID`; none when no rule has it.
pub fn explain(code: &str) -> Option<&'static Rule> {
    RULES.iter().find(|rule| rule.code == code)
}

/// Makes a table of rules: a constant for each, and `RULES` with all of them in their order.
///
/// ```
/// htex_format::rule_table! {
///     CLOTH_TORN Error: "The cloth is torn.", "Torn cloth snags.", "Mend it.";
/// }
/// assert_eq!(RULES[0].code, "CLOTH_TORN");
/// assert_eq!(*CLOTH_TORN, RULES[0]);
/// ```
#[macro_export]
macro_rules! rule_table {
    ($($name:ident $severity:ident: $summary:literal, $explanation:literal, $fix:literal;)*) => {
        $(pub(crate) const $name: &$crate::Rule = &$crate::Rule {
            code: stringify!($name),
            severity: $crate::Severity::$severity,
            summary: $summary,
            explanation: $explanation,
            fix: $fix,
        };)*

        /// All rules, in the order validation comes to them.
        pub const RULES: &[$crate::Rule] = &[$(*$name),*];
    };
}

rule_table! {
    FILE_TOO_LARGE Error:
        "The file is larger than the limit.",
        "A reader caps what it takes from a file it does not trust, before it reads it.",
        "Split the asset, leave the reference out, or raise `file_bytes` if you trust the file.";
    ARCHIVE_INVALID Error:
        "The file is not a ZIP archive, or a damaged one.",
        "The end record or the directory is missing, cut off or does not add up.",
        "Get the file again from where it came from, or write it anew.";
    ARCHIVE_EXTRA_DATA Error:
        "There are bytes that belong to no entry.",
        "Data before, between or after the entries lets two programs see two different archives.",
        "Write the asset anew, without a comment, a prefix or gaps.";
    ARCHIVE_ZIP64 Error:
        "The archive uses ZIP64.",
        "No asset comes near the sizes ZIP64 is for, and its second set of sizes invites disagreement.",
        "Write the archive without ZIP64 records.";
    ARCHIVE_TOO_MANY_ENTRIES Error:
        "The archive has more entries than the limit.",
        "A reader caps what it takes from a file it does not trust.",
        "Leave entries out, or raise `entries` if you trust the file.";
    ARCHIVE_TOO_LARGE Error:
        "The entries together unpack to more than the limit.",
        "A reader caps what it takes from a file it does not trust, before it unpacks it.",
        "Split the asset, or raise `total_bytes` if you trust the file.";
    ENTRY_NAME_UNSAFE Error:
        "An entry's name could lead out of the archive.",
        "A name with `..`, an empty part, a leading slash, a backslash, a drive letter, a control \
         character or a character outside ASCII means different files to different programs.",
        "Use relative names of ASCII characters with `/` between their parts.";
    ENTRY_NAME_DUPLICATE Error:
        "Two entries have the same name.",
        "Programs differ in which of the two they take. Names that differ in case only count as the same.",
        "Keep one of them, or rename one.";
    ENTRY_ENCRYPTED Error:
        "An entry is encrypted.",
        "An asset is readable by everyone it is given to.",
        "Write the archive without a password.";
    ENTRY_COMPRESSION_UNKNOWN Error:
        "An entry is compressed by a method other than deflate.",
        "Every reader knows stored and deflated entries, and no others are needed.",
        "Store or deflate the entry.";
    ENTRY_DATA_DESCRIPTOR Error:
        "An entry's sizes stand behind its data.",
        "With a data descriptor the local header does not say where the entry ends.",
        "Write the archive to a file or buffer that can be rewound, not to a stream.";
    ENTRY_EXTRA_FIELD Error:
        "An entry has an extra field or a comment.",
        "Extra fields can rename an entry or change its sizes, and assets need none.",
        "Write the archive without them (`zip -X`).";
    ENTRY_HEADER_MISMATCH Error:
        "An entry's local header and the directory disagree.",
        "Programs differ in which of the two they believe.",
        "Write the archive anew.";
    ENTRY_TOO_LARGE Error:
        "An entry unpacks to more than the limit.",
        "A reader caps what it takes from a file it does not trust, before it unpacks it.",
        "Split the asset, or raise `entry_bytes` if you trust the file.";
    ENTRY_RATIO Error:
        "An entry is packed more tightly than the limit.",
        "A small file that unpacks to a huge one is an attack, hardly ever an asset.",
        "Store the entry uncompressed, or raise `ratio` if you trust the file.";
    MIMETYPE_MISSING Error:
        "There is no entry `mimetype`.",
        "It is how an asset is told from any other ZIP archive.",
        "Add it as the first entry, stored: `application/vnd.htex+zip`.";
    MIMETYPE_NOT_FIRST Error:
        "`mimetype` is not the first entry.",
        "As the first entry, stored, its text stands at byte 38 of every asset, where programs look for it.",
        "Write it first.";
    MIMETYPE_COMPRESSED Error:
        "`mimetype` is compressed.",
        "As the first entry, stored, its text stands at byte 38 of every asset, where programs look for it.",
        "Store it (`zip -0`).";
    MIMETYPE_WRONG Error:
        "`mimetype` says something else.",
        "The archive is something other than an asset.",
        "It is `application/vnd.htex+zip`, without a line end.";
    MANIFEST_MISSING Error:
        "There is no entry `manifest.json`.",
        "Everything else is found through it.",
        "Write the asset anew.";
    ENTRY_MISSING Error:
        "The manifest names an entry that is not there.",
        "What it should hold is lost.",
        "Add the entry or remove what names it.";
    ENTRY_CORRUPT Error:
        "An entry does not unpack to what its checksum says.",
        "The file was damaged, or changed by hand.",
        "Get the file again from where it came from, or write it anew.";
    ENTRY_UNREFERENCED Warning:
        "Nothing in the manifest names this entry.",
        "It costs bytes and is lost when the asset is written again.",
        "Remove it, or name it.";
    JSON_SYNTAX Error:
        "The manifest is not JSON.",
        "It must be one JSON object in UTF-8 (RFC 8259), without a byte order mark.",
        "Correct it at the place the message names.";
    JSON_TOO_DEEP Error:
        "The manifest nests deeper than the limit.",
        "Deep nesting exhausts a parser's stack.",
        "Flatten the extension, or raise `json_depth` if you trust the file.";
    JSON_TYPE Error:
        "A key is missing, stands twice, or has a value of the wrong type.",
        "The manifest does not follow `schemas/manifest-1.json`.",
        "Correct it at the place the pointer names.";
    JSON_UNKNOWN_KEY Warning:
        "A key is not of this version.",
        "A misspelt key does nothing. Data of your own belong in `extensions`.",
        "Correct its spelling, or move it into an extension.";
    VERSION_MISSING Error:
        "The manifest has no `htex`.",
        "Without the version a reader would have to guess what the rest means.",
        "Add `\"htex\": \"1.0\"`.";
    VERSION_INVALID Error:
        "`htex` is not a version.",
        "It is a string of two whole numbers without leading zeros, `MAJOR.MINOR`.",
        "Write `\"htex\": \"1.0\"`.";
    VERSION_UNSUPPORTED Error:
        "The asset is of another major version.",
        "Another major version may mean other things by the same words.",
        "Read it with a program of that version, or write it anew as version 1.";
    VERSION_NEWER Info:
        "The asset is of a newer minor version.",
        "It can be used; what is new in it is kept, and otherwise left alone.",
        "Update the program to see all of it.";
    NAME_EMPTY Error:
        "The texture has no name.",
        "People find it by its name.",
        "Give it one.";
    LICENSE_INVALID Error:
        "`license` is not an SPDX licence expression.",
        "Programs sort assets by it, and people rely on it. The form is fixed, so it is an error.",
        "Write an expression such as `CC-BY-4.0` or `MIT OR Apache-2.0`; a licence of your own is `LicenseRef-NAME`.";
    DOI_INVALID Error:
        "`doi` is not a DOI.",
        "Programs make a link of it. The form is fixed, so it is an error.",
        "Write `10.`, the registrant's digits, a slash and the name, such as `10.5281/zenodo.1234567`, without `https://doi.org/`.";
    LICENSE_UNKNOWN Warning:
        "`license` names a licence that is not in the reader's SPDX list.",
        "It may be misspelt, upper and lower case included. The list grows, so it is a warning.",
        "Correct it by https://spdx.org/licenses, or write `LicenseRef-NAME` for a licence of your own.";
    LICENSE_MISSING Warning:
        "There is no licence.",
        "Without one nobody else may use the asset.",
        "Add `license` with an SPDX expression, such as `CC-BY-4.0`.";
    QUANTITY_UNKNOWN Error:
        "`quantity` is not one of this version.",
        "A player that mistakes what the samples mean may drive a device too hard.",
        "Version 1 has `lateral_force`, `normal_force`, `acceleration`, `velocity` and `displacement`.";
    UNIT_UNKNOWN Error:
        "`unit` is not the quantity's unit.",
        "A player that mistakes the unit is wrong by orders of magnitude.",
        "Forces are in `N`, accelerations in `m/s2`, velocities in `m/s`, displacements in `m`.";
    BAND_INVALID Error:
        "The band is empty, upside down or out of range.",
        "It must be 0 < low_hz < high_hz <= 20000 and hold a multiple of 5 Hz.",
        "Write the edges in hertz; touch feels about 20 to 1000.";
    SOURCE_INVALID Error:
        "A recording's sampling rate is not a positive number.",
        "What the asset was made from cannot be reproduced.",
        "Write the rate in hertz.";
    SOURCE_PATH Warning:
        "A recording is named with its folder.",
        "Folders mean nothing elsewhere, and may tell who made the asset.",
        "Write the file name alone.";
    CONDITIONS_EMPTY Error:
        "There is no exploration condition.",
        "Every representation is fitted at a condition, even when nothing is known of it.",
        "Add one; `{}` when speed and force are not known.";
    CONDITION_INVALID Error:
        "A condition has an impossible number.",
        "Speed, force and repeatability are finite and not negative.",
        "Correct it, or leave it out when it is not known.";
    CONDITION_DUPLICATE Error:
        "Two conditions have the same speed and force.",
        "A player could not tell which of them to take.",
        "Average them, or leave one out.";
    REPRESENTATIONS_EMPTY Error:
        "There is no representation.",
        "There is nothing to play.",
        "Fit at least one model.";
    MODEL_ID_INVALID Error:
        "A model's id is not in reverse-DNS form.",
        "It must have three or more parts of lower-case letters, digits, `-` and `_`.",
        "Use a domain you own: `org.example.mymodel`.";
    MODEL_DUPLICATE Error:
        "Two representations are of the same model.",
        "A player could not tell which of them to take.",
        "Merge their conditions into one representation.";
    MODEL_VERSION_INVALID Error:
        "A model's version is not a semantic version.",
        "It tells a player whether its model understands the parameters.",
        "Write `MAJOR.MINOR.PATCH`.";
    FIELD_NAME_EMPTY Error:
        "A parameter field has no name.",
        "Fields are matched to the model's by name.",
        "Use the name in the model's descriptor.";
    FIELD_DUPLICATE Error:
        "Two fields of a representation have the same name.",
        "Fields are matched to the model's by name.",
        "Use the names in the model's descriptor.";
    FIELD_UNKNOWN Error:
        "The model has no field of this name.",
        "Fields are matched to the model's by name. Of a model in a newer version than the reader's, fields it does not know are not judged.",
        "Use the name in the model's descriptor (`htex schema models`), or take the field out.";
    FIELD_KIND_WRONG Error:
        "A list is stored where the model takes one number, or the other way round.",
        "The model would read lengths as values.",
        "Correct `list`, and fit again.";
    FIELD_UNIT_WRONG Error:
        "A field's unit is not the model's.",
        "The model would be wrong by a factor.",
        "Correct `unit`, and the numbers with it.";
    FIELD_MISSING Error:
        "A field of the model is not stored.",
        "Only fields with a default in the model's descriptor may be absent: a later minor version added them.",
        "Fit again.";
    STORE_INVALID Error:
        "A store has steps that do not work.",
        "`scale` must be finite and above 0, the values of all steps finite and, in the logarithm, at least 2^-1022, and `scale` at least 2^-50 of the largest magnitude of o + s q (of 1, in the logarithm, if that is larger).",
        "Correct `scale` and `offset`.";
    AT_EMPTY Error:
        "A representation is fitted at no condition.",
        "There is nothing to play.",
        "Fit it, or leave it out.";
    CONDITION_INDEX_INVALID Error:
        "A representation names a condition that is not there.",
        "`condition` is a place in `conditions`, counted from 0.",
        "Correct the index, or add the condition.";
    CONDITION_INDEX_DUPLICATE Error:
        "A representation is fitted twice at a condition.",
        "A player could not tell which of them to take.",
        "Keep one.";
    LEVEL_INVALID Error:
        "A level is negative or beyond its quantity's largest.",
        "It is the RMS of the texture in the band, in the asset's unit: up to 1,000,000 N or m/s2, 10,000 m/s or 100 m.",
        "Correct it; a smooth surface has a level of 0.";
    QUALITY_INVALID Error:
        "A number of `quality` is out of range.",
        "There are nine band errors; correlations lie in -1 to 1; an RMS is finite and not negative.",
        "Measure anew, or leave `quality` out.";
    PARAMETERS_ENTRY_INVALID Error:
        "Two parts of the asset share an entry, or one claims an entry of the container.",
        "Every block has its own entry, other than `mimetype` and `manifest.json`.",
        "Give it an entry of its own, such as `parameters/NAME.bin`.";
    PARAMETERS_INVALID Error:
        "A parameter block does not follow the fields.",
        "It ends too early, goes on too long, or has a list length in a longer form than needed.",
        "Write the asset anew; fields, conditions and block must be of the same fit.";
    PARAMETERS_NOT_FINITE Error:
        "A parameter is not a finite number.",
        "A model would render silence, noise or nothing.",
        "Fit again; look into the recording when it happens again.";
    VALUES_TOO_MANY Error:
        "Blocks and reference hold more numbers than the limit.",
        "A reader caps what it takes from a file it does not trust.",
        "Split the asset, or raise `values` if you trust the file.";
    REFERENCE_LENGTH Error:
        "The reference does not fit the band and the conditions.",
        "It has four bytes for each multiple of 5 Hz in the band, edges included, times the conditions.",
        "Write the asset anew, or leave `reference` out.";
    REFERENCE_INVALID Error:
        "A magnitude of the reference is negative or not finite.",
        "A magnitude is a size in the asset's unit.",
        "Write the asset anew, or leave `reference` out.";
    PLUGIN_INVALID Error:
        "A plugin's model, version, file or hash is not of its form.",
        "Players find an embedded model by these words.",
        "Embed the module anew.";
    PLUGIN_DUPLICATE Error:
        "Two plugins are of one model.",
        "Players could not tell which to use.",
        "Keep one of them.";
    PLUGIN_UNUSED Warning:
        "A plugin's model has no representation in the asset.",
        "It takes room and is never played.",
        "Leave the module out.";
    PLUGIN_NOT_WASM Error:
        "A plugin's entry is not a WASM module.",
        "Only sandboxed modules may come out of an asset, never native libraries.",
        "Embed the model's `.wasm` file.";
    PLUGIN_HASH_MISMATCH Error:
        "A plugin's module does not have the hash the manifest gives.",
        "The module is another than the one that was embedded.",
        "Get the asset again from where it came from, or embed the module anew.";
    PLUGIN_SIGNATURE_INVALID Error:
        "A plugin's signature does not hold.",
        "The module, its version or its id is not what the holder of the key signed.",
        "Do not trust the module; get the asset again from its maker.";
    PLUGIN_UNUSABLE Error:
        "A plugin's module cannot be loaded, or is of another model or version than the asset says.",
        "`htex validate --embedded-plugins` loads what an asset brings along, in its sandbox; players find the same when they want it.",
        "Get the asset again from its maker, or play a representation of a model that you have.";
    EXTENSION_NAME_INVALID Warning:
        "An extension's name is not of the form `com.vendor.NAME/REVISION`.",
        "Names of another form may clash with someone else's.",
        "Use a domain you own, and a revision number from 1.";
    EXTENSION_REQUIRED_UNKNOWN Error:
        "The asset needs an extension this reader does not have.",
        "Its author says it cannot be used without.",
        "Use a program that knows the extension.";
    SCHEMA_BROKEN Error:
        "The document breaks a rule of its JSON Schema that no other finding names.",
        "`htex validate` holds documents to the schemas in `spec/schemas` too, and finds what stands behind the first wrong value.",
        "Correct it at the place the pointer names; `schema_rule` says which keyword does not hold.";
    EXTENSION_SCHEMA_BROKEN Error:
        "An extension breaks a rule of the schema its author gave.",
        "`htex validate --extension-schema NAME=FILE` holds the extension of that name to the schema.",
        "Correct the extension, or its schema.";
    DESCRIPTOR_INVALID Error:
        "A model's or device's descriptor describes nothing that can be called.",
        "Hosts refuse it when they load the model or device.",
        "Correct what the message names.";
    FINDINGS_TRUNCATED Info:
        "There are more findings than are shown.",
        "The first hundred are enough to start from.",
        "Mend those and validate again.";
}
