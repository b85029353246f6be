//! The WASM modules of the npm package, except the player. Each module is libhtex with one
//! additional C function, [`htex_author_call`]. There are three builds. `htex-author.wasm` makes
//! textures (feature `make`). `htex-import.wasm` makes textures from recordings and also from files
//! of other haptic formats, and writes such files (feature `import`). `htex-scene.wasm` plays
//! scenes (feature `scene`).
//! Only the JavaScript in `sdk/bindings/web/src` calls the function: `author.js`, `import.js` and
//! `scene.js`.
//!
//! JavaScript passes the name of a function, a JSON document and the bytes of files. The call
//! returns a JSON document and bytes. Because this function passes only JSON and bytes, JavaScript
//! need not know the layout of C structs. The overhead is some microseconds per call, which is
//! little compared with the work of a call. `sdk/bindings/web/src/author.d.ts` and `import.d.ts`
//! define the names, documents and results.

mod answer;
mod call;
mod document;
#[cfg(feature = "make")]
mod making;
mod refusal;
#[cfg(feature = "scene")]
mod scene;

pub use call::{htex_author_call, htex_author_result};

// Exports all functions of libhtex together with this module's function.
pub use htex_c::htex_status;
