//! Sources: inputs that deliver samples of several channels at one rate. Their traits, their ABI, libraries of them.

pub mod abi;
mod adapter;
mod export;
mod native;
pub mod shim;
mod sources;
mod stream;

pub use adapter::{Channel, Delivered, Source, SourceAdapter};
pub use native::{NativeSource, NativeSourceAdapter};
pub use sources::{KnownSource, Sources};
pub use stream::{SourceDescriptor, SourceStream, SourceStreamError};
