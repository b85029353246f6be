//! Arguments and results of the functions that JavaScript calls.

use serde::Serialize;

use crate::document::Document;
use crate::refusal::Refusal;

/// The result of a function: a JSON document, and bytes.
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

/// The files passed to a call.
pub(crate) type Files<'a> = &'a [&'a [u8]];

pub(crate) type Function = fn(Document, Files<'_>) -> Result<Answer, Refusal>;
