pub mod builds;
pub mod playing;
