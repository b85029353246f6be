//! The npm package's modules apart from the player. Each module is libhtex with one more C
//! function, [`htex_author_call`]. It makes textures (the feature `make`, `htex-author.wasm`), also
//! from files of other haptic formats (`import`, `htex-import.wasm`), or it plays scenes (`scene`,
//! `htex-scene.wasm`). JavaScript is its only caller: `sdk/bindings/web/src/author.js`, `import.js` and
//! `scene.js`.
//!
//! A call has a name, a JSON document and the bytes of files. Its result has the same parts. A
//! single function keeps struct layouts out of JavaScript, and its overhead is microseconds, little
//! compared with what the calls do. `sdk/bindings/web/src/author.d.ts` and `import.d.ts` define names,
//! documents and results.

mod answer;
mod call;
mod document;
#[cfg(feature = "make")]
mod making;
mod refusal;
#[cfg(feature = "scene")]
mod scene;

pub use call::{htex_author_call, htex_author_result};

// Exports all functions of libhtex together with this one.
pub use htex_c::htex_status;
