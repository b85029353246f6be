//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::unwrap_used, reason = "a failed test may panic")]

#[cfg(feature = "bake")]
mod bake_board;
#[cfg(feature = "bake")]
mod bake_common;
#[cfg(feature = "bake")]
mod bake_costs;
#[cfg(feature = "bake")]
mod bake_firmware;
#[cfg(feature = "bake")]
mod bake_sizes;
#[cfg(feature = "bake")]
mod bake_voices;
#[cfg(feature = "bake")]
#[allow(dead_code)]
#[path = "../../../player/tests/it/common/compilers.rs"]
mod compilers;
mod output;
mod rates;
#[cfg(feature = "bake")]
#[path = "../../../player/tests/it/common/script.rs"]
mod script;
mod spectrum;
#[cfg(feature = "bake")]
#[path = "../../../player/tests/it/common/stream.rs"]
mod stream;
