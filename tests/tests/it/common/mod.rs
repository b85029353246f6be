pub mod builds;
pub mod node;
pub mod playing;
