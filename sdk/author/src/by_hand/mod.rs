//! Textures made without a recording: from parameters written by hand, or by mixing two textures.
//! The paper names both as uses of a representation by few numbers (Balasubramanian & Vardar 2026,
//! Discussion).
//!
//! Such an asset stores how it was made ([`htex_format::Made`]). It has no quality, since there is
//! no recording to compare it with.

mod error;
mod mix;
mod parameters;

pub use error::ByHandError;
pub use mix::{MixedAsset, mix};
pub use parameters::{ByHand, ByHandAt, ByHandModel, ByHandModels, make, make_all};

use htex_format::{
    Asset, Condition, Contact, Law, Made, Manifest, Provenance, Quantity, Representation, VERSION,
};
use htex_host::Band;

/// The parts of a made asset that do not depend on its models.
struct Frame {
    name: String,
    quantity: Quantity,
    band: Band,
    tool: String,
    made: Made,
    conditions: Vec<Condition>,
    contact: Contact,
    law: Law,
}

impl Frame {
    /// Puts an asset together.
    fn asset(self, made: Vec<(Representation, Vec<Vec<f64>>)>) -> Asset {
        let (representations, parameters) = made.into_iter().unzip();
        let manifest = Manifest {
            htex: VERSION.to_owned(),
            name: self.name,
            license: None,
            author: None,
            tags: Vec::new(),
            description: None,
            source: None,
            doi: None,
            sensor: None,
            finger: None,
            contact: self.contact,
            quantity: self.quantity,
            unit: self.quantity.unit().to_owned(),
            band: self.band,
            provenance: Provenance {
                tool: self.tool,
                made: Some(self.made),
                ..Provenance::default()
            },
            conditions: self.conditions,
            law: Some(self.law),
            representations,
            reference: None,
            plugins: Vec::new(),
            extensions: Default::default(),
            extensions_required: Vec::new(),
            other: Default::default(),
        };
        Asset { manifest, parameters, reference: None, plugins: Vec::new(), notes: Vec::new() }
    }
}
