//! The validation rules for assets, in one table.

use crate::stages::*;

htex_base::finding::rule_table! {
    FILE_TOO_LARGE Error [FILE]:
        "The file is larger than the limit.",
        "A reader limits what it reads from an untrusted file, before it reads it.",
        "Split the asset, leave the reference out, or raise `file_bytes` if you trust the file.";
    ARCHIVE_INVALID Error [FILE, HEADERS]:
        "The file is not a valid ZIP archive.",
        "The end record or the directory is missing, truncated or inconsistent.",
        "Get the file again from its source, or write it again.";
    ARCHIVE_EXTRA_DATA Error [FILE, HEADERS]:
        "The file has bytes that belong to no entry.",
        "With data before, between or after the entries two programs can see different archives.",
        "Write the asset again, without a comment, a prefix or gaps.";
    ARCHIVE_ZIP64 Error [FILE, HEADERS]:
        "The archive uses ZIP64.",
        "No asset needs sizes above 4 GiB, and a second set of sizes can contradict the first.",
        "Write the archive without ZIP64 records.";
    ARCHIVE_TOO_MANY_ENTRIES Error [FILE]:
        "The archive has more entries than the limit.",
        "A reader limits what it reads from an untrusted file.",
        "Leave entries out, or raise `entries` if you trust the file.";
    ARCHIVE_TOO_LARGE Error [HEADERS]:
        "The entries together unpack to more than the limit.",
        "A reader limits what it unpacks from an untrusted file, before it unpacks it.",
        "Split the asset, or raise `total_bytes` if you trust the file.";
    ENTRY_NAME_UNSAFE Error [HEADERS]:
        "An entry's name could refer to a file outside the archive.",
        "A name with `..`, an empty part, a leading slash, a backslash, a drive letter, a control \
         character or a character outside ASCII means different files to different programs.",
        "Use relative names of ASCII characters with `/` between their parts.";
    ENTRY_NAME_DUPLICATE Error [HEADERS]:
        "Two entries have the same name.",
        "Programs differ in which of the two they read. Names that differ only in case count as the same.",
        "Keep one of them, or rename one.";
    ENTRY_ENCRYPTED Error [HEADERS]:
        "An entry is encrypted.",
        "Everyone who has an asset can read it.",
        "Write the archive without a password.";
    ENTRY_COMPRESSION_UNKNOWN Error [HEADERS]:
        "An entry is compressed by a method other than deflate.",
        "Every reader knows stored and deflated entries, and no others are needed.",
        "Store or deflate the entry.";
    ENTRY_DATA_DESCRIPTOR Error [HEADERS]:
        "An entry's sizes follow its data.",
        "With a data descriptor the local header does not say where the entry ends.",
        "Write the archive to a seekable file or buffer, not to a stream.";
    ENTRY_EXTRA_FIELD Error [HEADERS]:
        "An entry has an extra field or a comment.",
        "Extra fields can rename an entry or change its sizes, and assets do not need them.",
        "Write the archive without them (`zip -X`).";
    ENTRY_HEADER_MISMATCH Error [HEADERS]:
        "An entry's local header and the directory disagree.",
        "Programs differ in which of the two they use.",
        "Write the archive again.";
    ENTRY_TOO_LARGE Error [HEADERS]:
        "An entry unpacks to more than the limit.",
        "A reader limits what it unpacks from an untrusted file, before it unpacks it.",
        "Split the asset, or raise `entry_bytes` if you trust the file.";
    ENTRY_RATIO Error [HEADERS]:
        "An entry's compression ratio exceeds the limit.",
        "A small entry that unpacks to a huge one is usually an attack.",
        "Store the entry uncompressed, or raise `ratio` if you trust the file.";
    MIMETYPE_MISSING Error [MIMETYPE]:
        "There is no entry `mimetype`.",
        "It distinguishes an asset from other ZIP archives.",
        "Add it as the first entry, stored: `application/vnd.htex+zip`.";
    MIMETYPE_NOT_FIRST Error [MIMETYPE]:
        "`mimetype` is not the first entry.",
        "As the first entry, stored, its text is at byte 38 of every asset, where programs look for it.",
        "Write it first.";
    MIMETYPE_COMPRESSED Error [MIMETYPE]:
        "`mimetype` is compressed.",
        "As the first entry, stored, its text is at byte 38 of every asset, where programs look for it.",
        "Store it (`zip -0`).";
    MIMETYPE_WRONG Error [MIMETYPE]:
        "`mimetype` has other contents.",
        "The archive is not an asset.",
        "Write `application/vnd.htex+zip`, without a line end.";
    MANIFEST_MISSING Error [MANIFEST]:
        "There is no entry `manifest.json`.",
        "It names all other entries.",
        "Write the asset again.";
    ENTRY_MISSING Error [BLOCKS, REFERENCE, MODULES]:
        "The manifest names an entry that does not exist.",
        "The contents of the entry are missing.",
        "Add the entry or remove the reference to it.";
    ENTRY_CORRUPT Error [DATA]:
        "An entry's data do not match its checksum.",
        "The file was damaged, or changed by hand.",
        "Get the file again from its source, or write it again.";
    ENTRY_UNREFERENCED Warning [UNREFERENCED]:
        "Nothing in the manifest names this entry.",
        "It takes space and is lost when the asset is written again.",
        "Remove the entry, or refer to it in the manifest.";
    JSON_SYNTAX Error [MANIFEST]:
        "The manifest is not JSON.",
        "It must be one JSON object in UTF-8 (RFC 8259), without a byte order mark.",
        "Correct it at the position in the message.";
    JSON_TOO_DEEP Error [MANIFEST]:
        "The manifest nests deeper than the limit.",
        "Deep nesting exhausts a parser's stack.",
        "Flatten the extension, or raise `json_depth` if you trust the file.";
    JSON_TOO_LARGE Error [MANIFEST]:
        "The manifest has more values than the limit.",
        "A value takes far more memory than its bytes in the file.",
        "Shorten the manifest, or raise `json_nodes` if you trust the file.";
    JSON_TYPE Error [MANIFEST]:
        "A key is missing, appears twice, or has a value of the wrong type.",
        "The manifest does not follow `schemas/manifest-1.json`, or a table of a coded asset stands for no array.",
        "Correct it at the pointer.";
    JSON_UNKNOWN_KEY Warning [UNKNOWN_KEYS]:
        "A key does not exist in this version.",
        "A misspelt key has no effect. Custom data belong in `extensions`.",
        "Correct its spelling, or move it into an extension.";
    VERSION_MISSING Error [MANIFEST]:
        "The manifest has no key `htex`.",
        "Without the version a reader has to guess the meaning of the other keys.",
        "Add `\"htex\": \"1.0\"`.";
    VERSION_INVALID Error [MANIFEST]:
        "`htex` is not a version.",
        "It is a string of two whole numbers up to 4294967295 without leading zeros, `MAJOR.MINOR`.",
        "Write `\"htex\": \"1.0\"`.";
    VERSION_UNSUPPORTED Error [MANIFEST]:
        "The reader does not support the asset's major version.",
        "The same keys may have another meaning in another major version.",
        "Read it with a program that supports that version, or write it again as version 1.";
    VERSION_NEWER Info [MANIFEST]:
        "The asset has a newer minor version.",
        "It can be used; new keys are kept and have no effect.",
        "Update the program to use the new keys.";
    NAME_EMPTY Error [TEXTURE]:
        "The texture has no name.",
        "People find it by its name.",
        "Write a name.";
    LICENSE_INVALID Error [TEXTURE]:
        "`license` is not an SPDX licence expression.",
        "Programs filter assets by it, and people rely on it. The grammar is fixed, so this is an error.",
        "Write an expression such as `CC-BY-4.0` or `MIT OR Apache-2.0`; for another licence write `LicenseRef-NAME`.";
    DOI_INVALID Error [TEXTURE]:
        "`doi` is not a DOI.",
        "Programs make a link of it. The syntax is fixed, so this is an error.",
        "Write `10.`, the registrant's digits, a slash and the name, such as `10.5281/zenodo.1234567`, without `https://doi.org/`.";
    LICENSE_UNKNOWN Warning [TEXTURE]:
        "`license` names a licence that is not in the reader's SPDX list.",
        "It may be misspelt, or in the wrong case. The list grows, so this is a warning.",
        "Correct it (see https://spdx.org/licenses), or write `LicenseRef-NAME` for another licence.";
    LICENSE_MISSING Warning [TEXTURE]:
        "There is no licence.",
        "Without a licence nobody else may use the asset.",
        "Add `license` with an SPDX expression, such as `CC-BY-4.0`.";
    QUANTITY_UNKNOWN Error [MANIFEST]:
        "`quantity` is not a quantity of this version.",
        "A player that takes the samples for another quantity may overdrive a device.",
        "Version 1 has `lateral_force`, `normal_force`, `acceleration`, `velocity` and `displacement`.";
    UNIT_UNKNOWN Error [TEXTURE]:
        "`unit` is not the quantity's unit.",
        "A player that assumes another unit is wrong by orders of magnitude.",
        "Forces are in `N`, accelerations in `m/s2`, velocities in `m/s`, displacements in `m`.";
    BAND_INVALID Error [TEXTURE]:
        "The band is empty, reversed or out of range.",
        "It must satisfy 0 < low_hz < high_hz <= 20000 and contain a multiple of 5 Hz.",
        "Write the edges in hertz; touch perceives about 20 to 1000.";
    SOURCE_INVALID Error [RECORDINGS]:
        "A recording's sampling rate is not a positive number, or its hash is none.",
        "Without them the asset cannot be reproduced.",
        "Write the rate in hertz, and the 64 hexadecimal digits of the file's BLAKE3 or nothing.";
    MADE_INVALID Error [RECORDINGS]:
        "An ingredient of a mixture has a wrong weight or hash.",
        "`weight` is from 0 to 1, and `blake3` the hash of the mixed asset's file.",
        "Correct it, or mix the assets again.";
    SOURCE_PATH Warning [RECORDINGS]:
        "A recording's file name contains a folder.",
        "Folders have no meaning on other machines, and may reveal who made the asset.",
        "Write only the file name.";
    CONDITIONS_TOO_MANY Error [MANIFEST]:
        "There are more conditions than the limit.",
        "A player finds the triangles between them, which takes more than proportional time.",
        "Average neighbouring conditions, or raise `conditions` if you trust the file.";
    CONDITIONS_EMPTY Error [CONDITIONS]:
        "There is no exploration condition.",
        "Every representation is fitted at a condition, even if its speed and force are not known.",
        "Add a condition; write `{}` when speed and force are not known.";
    CONDITION_INVALID Error [CONDITIONS]:
        "A condition has a number out of range.",
        "Speed, force and repeatability must be finite and not negative.",
        "Correct it, or remove it when it is not known.";
    CONDITION_DUPLICATE Error [CONDITIONS]:
        "Two conditions have the same speed and force.",
        "A player cannot know which of them to use.",
        "Average them, or remove one.";
    LAW_INVALID Error [CONDITIONS]:
        "An exponent of the law is out of range.",
        "Exponents are from -4 to 4, and standard errors are not negative.",
        "Correct it, or remove `law`: then what is usual for the contact and the quantity applies.";
    FLUCTUATION_INVALID Error [CONDITIONS]:
        "An error of the fluctuation is out of range.",
        "Errors are from 0 to 100 dB.",
        "Correct it, or remove it when it is not known.";
    REPRESENTATIONS_EMPTY Error [REPRESENTATIONS]:
        "There is no representation.",
        "Without it there is nothing to play.",
        "Fit at least one model.";
    MODEL_ID_INVALID Error [REPRESENTATIONS]:
        "A model's id is not in reverse-DNS form.",
        "It must have three or more parts of lower-case letters, digits, `-` and `_`.",
        "Use a domain you own: `org.example.mymodel`.";
    MODEL_DUPLICATE Error [REPRESENTATIONS]:
        "Two representations have the same model.",
        "A player cannot know which of them to use.",
        "Merge their conditions into one representation.";
    MODEL_VERSION_INVALID Error [REPRESENTATIONS]:
        "A model's version is not a semantic version.",
        "A player uses it to decide whether its model supports the parameters.",
        "Write `MAJOR.MINOR.PATCH`.";
    FIELD_NAME_EMPTY Error [REPRESENTATIONS]:
        "A parameter field has no name.",
        "Fields are matched to the model's by name.",
        "Use the name in the model's descriptor.";
    FIELD_DUPLICATE Error [REPRESENTATIONS]:
        "Two fields of a representation have the same name.",
        "Fields are matched to the model's by name.",
        "Use the names in the model's descriptor.";
    FIELD_UNKNOWN Error [FIELDS]:
        "The model has no field of this name.",
        "Fields are matched to the model's by name. If the asset was fitted by a newer version of the model than the reader has, unknown fields are accepted.",
        "Use the name in the model's descriptor (`htex schema models`), or remove the field.";
    FIELD_KIND_WRONG Error [FIELDS]:
        "A list is stored where the model has a scalar, or the reverse.",
        "The model would read lengths as values.",
        "Correct `list`, and fit again.";
    FIELD_UNIT_WRONG Error [FIELDS]:
        "A field's unit is not the model's.",
        "The model would play wrong values.",
        "Correct `unit` and the values.";
    FIELD_MISSING Error [FIELDS]:
        "A field of the model is not stored.",
        "Only fields with a default in the model's descriptor, which a later minor version added, may be absent.",
        "Fit again.";
    STORE_INVALID Error [REPRESENTATIONS]:
        "A store has invalid steps, or is not possible here.",
        "`scale` must be finite and above 0, the values of all steps finite and, in the logarithm, at least 2^-1022, and `scale` at least 2^-50 of the largest magnitude of o + s q (of 1, in the logarithm, if that is larger). Only a list can be packed, and only a coded asset has coded fields.",
        "Correct `scale` and `offset`, or choose another store.";
    AT_EMPTY Error [REPRESENTATIONS]:
        "A representation is not fitted at any condition.",
        "Without it there is nothing to play.",
        "Fit it, or remove it.";
    CONDITION_INDEX_INVALID Error [REPRESENTATIONS]:
        "A representation refers to a condition that does not exist.",
        "`condition` is an index into `conditions`, counted from 0.",
        "Correct the index, or add the condition.";
    CONDITION_INDEX_DUPLICATE Error [REPRESENTATIONS]:
        "A representation is fitted twice at a condition.",
        "A player cannot know which of them to use.",
        "Keep one.";
    LEVEL_INVALID Error [REPRESENTATIONS]:
        "A level is negative or above the largest level of its quantity.",
        "It is the RMS of the texture in the band, in the asset's unit: up to 1,000,000 N or m/s2, 10,000 m/s or 100 m.",
        "Correct it; a smooth surface has a level of 0.";
    QUALITY_INVALID Error [REPRESENTATIONS]:
        "A number of `quality` or `left_out` is out of range.",
        "There must be nine band errors; correlations are from -1 to 1; an RMS is finite and not negative.",
        "Measure again, or remove `quality` or `left_out`.";
    TRIANGLES_INVALID Error [REPRESENTATIONS]:
        "The triangles of a representation cannot be interpolated in.",
        "A player has one mix at each motion, and it does not jump, only if they cover the hull of the representation's conditions once, without gaps and overlaps. Of each representation the first fault is reported.",
        "Correct them at the pointer, or remove `triangles`: then a player finds triangles itself.";
    PARAMETERS_ENTRY_INVALID Error [BLOCKS, REFERENCE, MODULES]:
        "Two parts of the asset use the same entry, or one uses an entry of the container.",
        "Every block needs its own entry, other than `mimetype` and `manifest.json`.",
        "Use a separate entry, such as `parameters/NAME.bin`.";
    PARAMETERS_INVALID Error [BLOCKS]:
        "A parameter block does not match the fields.",
        "It is too short, too long, or has a list length that is not in its shortest form, or a packed list or a code that a writer would not write.",
        "Write the asset again; fields, conditions and block must come from the same fit.";
    PARAMETERS_NOT_FINITE Error [BLOCKS]:
        "A parameter is not a finite number.",
        "A model could render silence or noise, or fail.",
        "Fit again; check the recording if the error remains.";
    VALUES_TOO_MANY Error [BLOCKS, REFERENCE]:
        "Parameter blocks and reference hold more numbers than the limit.",
        "A reader limits what it reads from an untrusted file.",
        "Split the asset, or raise `values` if you trust the file.";
    REFERENCE_LENGTH Error [REFERENCE]:
        "The reference's size does not match the band and the conditions.",
        "It must have four bytes per condition for each multiple of 5 Hz in the band, edges included.",
        "Write the asset again, or remove `reference`.";
    REFERENCE_INVALID Error [REFERENCE]:
        "A magnitude of the reference is negative or not finite.",
        "Magnitudes are not negative, in the asset's unit.",
        "Write the asset again, or remove `reference`.";
    PLUGIN_INVALID Error [PLUGINS]:
        "A plugin's model, version, file or hash is malformed.",
        "Players find an embedded model by these keys.",
        "Embed the module again.";
    PLUGIN_DUPLICATE Error [PLUGINS]:
        "Two plugins have the same model.",
        "A player cannot know which of them to use.",
        "Keep one of them.";
    PLUGIN_UNUSED Warning [PLUGINS]:
        "A plugin's model has no representation in the asset.",
        "It takes space and is never used.",
        "Remove the module.";
    PLUGIN_NOT_WASM Error [MODULES]:
        "A plugin's entry is not a WASM module.",
        "An asset may contain only sandboxed modules, never native libraries.",
        "Embed the model's `.wasm` file.";
    PLUGIN_HASH_MISMATCH Error [MODULES]:
        "A plugin's module does not have the hash in the manifest.",
        "The module is not the one that was embedded.",
        "Get the asset again from its source, or embed the module again.";
    PLUGIN_SIGNATURE_INVALID Error [PLUGINS]:
        "A plugin's signature is invalid.",
        "The module, its version or its id differs from what the holder of the key signed.",
        "Do not trust the module; get the asset again from its author.";
    PLUGIN_UNUSABLE Error [SCHEMAS] by "embedded_plugins":
        "A plugin's module cannot be loaded, or has another model id or version than the manifest states.",
        "A validator that may load embedded modules, in the sandbox, reports it; players find the same error when they load the module.",
        "Get the asset again from its author, or play a representation whose model you have.";
    EXTENSION_NAME_INVALID Warning [EXTENSIONS]:
        "An extension's name is not of the form `com.vendor.NAME/REVISION`.",
        "Other names may collide with those of other authors.",
        "Use a domain you own, and a revision number from 1.";
    EXTENSION_REQUIRED_UNKNOWN Error [EXTENSIONS]:
        "The asset needs an extension that this reader does not support.",
        "Its author states that it cannot be used without the extension.",
        "Use a program that supports the extension.";
    SCHEMA_BROKEN Error [SCHEMAS]:
        "The document breaks a rule of its JSON Schema that no other finding covers.",
        "`htex validate` also checks documents against the schemas in `spec/schemas`, and finds errors after the first wrong value.",
        "Correct it at the place the pointer names; `schema_rule` names the keyword.";
    EXTENSION_SCHEMA_BROKEN Error [SCHEMAS] by "extension_schema":
        "An extension breaks a rule of its author's schema.",
        "A validator that has the schema of that extension checks it.",
        "Correct the extension, or its schema.";
    DESCRIPTOR_INVALID Error [SCHEMAS]:
        "A model's or device's descriptor is invalid.",
        "Hosts refuse it when they load the model or device.",
        "Correct what the message names.";
    + htex_base::finding::FINDINGS_TRUNCATED;
}
