//! The author module of the npm package (`htex-author.wasm`): libhtex, and one more C function, [`htex_author_call`], for what makes
//! textures. JavaScript (`sdk/web/src/author.js`) is its only caller.
//!
//! A call has a name, a document of JSON, and the bytes of files; so has its result. One function for all keeps the layout of structs out of
//! JavaScript, and costs microseconds beside what the calls do. Names, documents and results are those of `sdk/web/src/author.d.ts`.

mod call;
mod describe;
mod document;
mod felt;
mod fit;
mod libraries;
mod made;
mod models;
mod process;
mod progress;
mod recordings;
mod refusal;
mod validate;

pub use call::{htex_author_call, htex_author_result};

// All functions of libhtex are exported with this one.
pub use htex_c::htex_status;

/// Program and version, for an asset's provenance: those of the command.
const TOOL: &str = concat!("htex ", env!("CARGO_PKG_VERSION"));
