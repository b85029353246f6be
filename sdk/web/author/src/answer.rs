//! What functions are given, and what they return.

use serde::Serialize;

use crate::document::Document;
use crate::refusal::Refusal;

/// What a function returns: a document, and bytes.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) json: Vec<u8>,
    pub(crate) bytes: Vec<u8>,
}

impl Answer {
    pub(crate) fn new(document: &impl Serialize, bytes: Vec<u8>) -> Result<Self, Refusal> {
        let json = serde_json::to_vec(document).map_err(Refusal::internal)?;
        Ok(Self { json, bytes })
    }
}

/// The files that a call is given.
pub(crate) type Files<'a> = &'a [&'a [u8]];

pub(crate) type Function = fn(Document, Files<'_>) -> Result<Answer, Refusal>;
