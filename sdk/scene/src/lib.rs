//! Scenes: surfaces, a motion, a device. The planner finds the shortest chain of stages that the
//! scene calls for and says why each is in or out; the renderer runs just that chain.
#![forbid(unsafe_code)]

pub mod file;
