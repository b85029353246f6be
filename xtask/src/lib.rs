//! Tasks that tests use too.

<<<<<<< HEAD
pub mod fuzz;
=======
pub mod bench;
>>>>>>> 61d6cfb (Measure beside plain loops in C and the libraries people use)
pub mod plugins;
mod wasm;
