//! Input sources, which deliver samples of several channels at one rate: their traits, their ABI,
//! and native libraries of sources.
//!
//! Sources have an ABI of their own, because the ABI of devices is frozen. Both follow the same
//! conventions. They share one shim, loader, handle table, settings and registry, and codes with
//! the same meaning have the same number. A built-in source is trusted. For a source of a library,
//! every rate, channel, count and sample is checked ([`NativeSource`]), because a recording must
//! not be wrong silently.

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
