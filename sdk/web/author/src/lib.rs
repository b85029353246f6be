//! Modules of the npm package beside the player: libhtex, and one more C function,
//! [`htex_author_call`], for what makes textures (the feature `make`, `htex-author.wasm`), of files
//! of other haptic formats, too (`import`, `htex-import.wasm`), or for what plays scenes (`scene`,
//! `htex-scene.wasm`). JavaScript is its only caller: `sdk/web/src/author.js`, `import.js` and
//! `scene.js`.
//!
//! A call has a name, a document of JSON, and the bytes of files; so has its result. One function
//! for all keeps the layout of structs out of JavaScript, and costs microseconds beside what the
//! calls do. Names, documents and results are those of `sdk/web/src/author.d.ts` and `import.d.ts`.

mod answer;
mod call;
mod document;
#[cfg(feature = "make")]
mod making;
mod refusal;
#[cfg(feature = "scene")]
mod scene;

pub use call::{htex_author_call, htex_author_result};

// All functions of libhtex are exported with this one.
pub use htex_c::htex_status;
