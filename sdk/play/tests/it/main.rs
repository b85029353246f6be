//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::unwrap_used, reason = "a failed test may panic")]

mod bake_board;
mod bake_common;
mod bake_costs;
mod bake_firmware;
mod bake_sizes;
mod bake_voices;
#[allow(dead_code)]
#[path = "../../../player/tests/it/common/compilers.rs"]
mod compilers;
mod output;
mod rates;
#[path = "../../../player/tests/it/common/script.rs"]
mod script;
mod spectrum;
#[path = "../../../player/tests/it/common/stream.rs"]
mod stream;
