//! Sources: inputs that deliver samples of several channels at one rate. Their traits, their ABI,
//! libraries of them.
//!
//! Their ABI stands beside that of devices, which is frozen. Both have the same conventions: the
//! shim, the loader, handles, settings and the registry exist once, and codes with the same meaning
//! have the same number. A built-in source is trusted; of a library's source each rate, channel,
//! count and sample is checked ([`NativeSource`]), since a recording must not be wrong silently.

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
