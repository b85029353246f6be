pub mod blocks;
pub mod cases;
pub mod compilers;
pub mod mutated;
pub mod stream;
