//! The stages of reading an asset. The stages determine in which order findings are reported, and
//! where reading stops after an error.

pub(crate) use htex_base::finding::COUNT;
use htex_base::finding::{Rule, Stage};

use crate::RULES;

const fn stage(of: &'static str, ends: bool) -> Stage {
    Stage { of, ends }
}

pub(crate) const FILE: Stage = stage("the file, and the end record; the first finding only", true);
pub(crate) const HEADERS: Stage = stage(
    "the entries' headers, in the directory's order, and then all of them together; after a \
             record or a local header at a wrong position, no further one is checked",
    true,
);
pub(crate) const DATA: Stage = stage("the entries' data, unpacked, in the directory's order", true);
pub(crate) const MIMETYPE: Stage = stage("`mimetype`", false);
pub(crate) const MANIFEST: Stage = stage(
    "the manifest as JSON, its version, its quantity, its types and the number of conditions; the first error only",
    true,
);
pub(crate) const UNKNOWN_KEYS: Stage = stage("unknown keys, sorted by pointer", false);
pub(crate) const TEXTURE: Stage =
    stage("the whole texture: its name, licence (one finding), DOI, unit and band", false);
pub(crate) const RECORDINGS: Stage = stage(
    "recordings, in their order, of each its rate, its hash and then its name; then the parts of a mixture",
    false,
);
pub(crate) const CONDITIONS: Stage = stage("conditions, in their order", false);
pub(crate) const REPRESENTATIONS: Stage = stage(
    "representations, in their order: the model, each field, each condition, the triangles",
    false,
);
pub(crate) const PLUGINS: Stage = stage("plugins, in their order", false);
pub(crate) const EXTENSIONS: Stage =
    stage("extensions by name, and those required in their order", false);
pub(crate) const FIELDS: Stage = stage(
    "fields, compared with those of models that the reader has: stored fields, then absent ones",
    false,
);
pub(crate) const BLOCKS: Stage = stage(
    "parameter blocks, in the order of representations; the first finding of each block, which is read from its beginning, a code or a packed list as a whole before its values: whether there is the entry, and then \
             whether it is the container's own or was named before",
    false,
);
pub(crate) const REFERENCE: Stage = stage(
    "the reference; the first finding only, its entry as above, its length before the number of its values; nothing but its \
             entry if the band is invalid",
    false,
);
pub(crate) const MODULES: Stage =
    stage("the plugins' modules, in their order, their entries as above", false);
pub(crate) const UNREFERENCED: Stage =
    stage("unreferenced entries, in the directory's order", false);
pub(crate) const SCHEMAS: Stage =
    stage("JSON Schemas, in validators that check documents against them", false);

/// All stages of reading an asset, in order.
pub const STAGES: &[Stage] = &[
    FILE,
    HEADERS,
    DATA,
    MIMETYPE,
    MANIFEST,
    UNKNOWN_KEYS,
    TEXTURE,
    RECORDINGS,
    CONDITIONS,
    REPRESENTATIONS,
    PLUGINS,
    EXTENSIONS,
    FIELDS,
    BLOCKS,
    REFERENCE,
    MODULES,
    UNREFERENCED,
    SCHEMAS,
    COUNT,
];

/// Returns the rules of a stage. A few rules belong to several stages.
pub fn rules_of(stage: Stage) -> impl Iterator<Item = &'static Rule> {
    RULES.iter().filter(move |rule| rule.stages.contains(&stage))
}
