//! The extension module of the Python package `htex`. The package's Python files contain the data
//! classes, the exceptions and the command. The extension module opens, plays and fits textures,
//! and measures trade-offs between the accuracy, size and computing time of models. During this
//! work the module releases the global interpreter lock, so that other Python threads can run.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod author;
mod by_hand;
mod causes;
mod command;
mod compare;
mod device;
mod errors;
mod exchange;
mod library;
mod library_build;
mod models;
mod path;
mod python;
mod python_model;
mod python_voice;
mod reading;
mod response;
mod scene;
mod signed;
mod simulate;
mod texture;
mod tradeoff;
mod voice;

use pyo3::prelude::*;

/// The functions and classes of the package that are written in Rust.
#[pymodule]
mod _htex {
    use super::*;

    #[pymodule_export]
    use crate::author::{agreement, fit, process};
    #[pymodule_export]
    use crate::by_hand::{edit, make, mix};
    #[pymodule_export]
    use crate::command::run;
    #[pymodule_export]
    use crate::compare::compare;
    #[pymodule_export]
    use crate::device::{Device, listed};
    #[pymodule_export]
    use crate::exchange::{export, formats, import_file};
    #[pymodule_export]
    use crate::library::{Library, pack};
    #[pymodule_export]
    use crate::library_build::{Build, hash_file, remember, run_job, unhashed, work_folder};
    #[pymodule_export]
    use crate::models::models;
    #[pymodule_export]
    use crate::python_model::{register_model, unregister_model};
    #[pymodule_export]
    use crate::response::{response, response_csv};
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::simulate::simulate;
    #[pymodule_export]
    use crate::texture::{Texture, open, write_content};
    #[pymodule_export]
    use crate::tradeoff::tradeoff;
    #[pymodule_export]
    use crate::voice::Voice;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
