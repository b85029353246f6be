//! Experiments with textures: guided recordings, responses of a setup, studies and their analysis.
#![forbid(unsafe_code)]

pub mod response;
