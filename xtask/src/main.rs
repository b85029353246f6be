//! Developer tasks: `cargo xtask`.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;
use clap::{Args, Parser};
use xtask::dist::{Dist, dist};
use xtask::fuzz;
use xtask::platform::Build;
use xtask::plugins::{self, Way};
use xtask::programs::run;
use xtask::prove::{self, Proof};
use xtask::release::Release;

/// Developer tasks
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", disable_help_subcommand = true)]
enum Task {
    /// Run all steps of continuous integration
    Ci,
    Plugins(Plugins),
    /// Measure htex against plain loops in C and against NumPy, SciPy and librosa, in one run
    Bench {
        /// Write the numbers to a file
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
    },
    /// Build and run the fuzz targets in fuzz/fuzz_targets; see fuzz/README.md
    Fuzz(fuzz::Options),
    /// Build and install libhtex for C, C++ and C#
    Dist {
        #[arg(long, value_name = "DIR")]
        prefix: PathBuf,
        /// Also install the whole libhtex in lib/whole: with scenes, libraries of textures and the
        /// engine of WASM modules
        #[arg(long)]
        whole: bool,
    },
    /// Build archives, wheels and the npm package
    Release(Release),
    /// Make an HTML book from the pages in docs and spec with mdBook, and check its links
    Book(Out),
    /// Package the C player for Arduino, ESP-IDF and Zephyr
    Firmware(Out),
    /// Test the bindings to other languages, and the command on other processors; names missing
    /// programs
    Bindings {
        /// Bindings to test: c, web, studio, python or processors [default: all]
        names: Vec<String>,
    },
    /// Build the npm package `htex` for browsers and Node.js
    Web(Out),
    /// Build the studio as one file (DIR/studio.html) and as a folder for a web server (DIR/static)
    Studio(Out),
    /// Rebuild the library of textures that comes with the studio and with releases:
    /// sdk/bindings/studio/shelf/shelf.htexlib
    StudioShelf,
    /// Make an example registry of plugins, and check it: the built-in models as modules, an output
    /// and an input
    Registry(Out),
    /// Run a proof in full; continuous integration runs only a sample of it
    #[command(subcommand, arg_required_else_help = true)]
    Prove(Proof),
    /// Write the generated files of spec (schemas, pages, conformance files) and the fuzz seeds
    Generate,
    /// Measure the size of the sources
    Census {
        /// Also print the names that were counted
        #[arg(long)]
        list: bool,
    },
}

/// Build the models as plugins into target/htex-plugins, native and WASM
#[derive(Args)]
struct Plugins {
    /// Build only native libraries
    #[arg(long, conflicts_with_all = ["wasm_only", "wasm_toolchain"])]
    native_only: bool,
    /// Build only WASM modules
    #[arg(long)]
    wasm_only: bool,
    /// How to choose the toolchain that builds WASM modules [default: HTEX_WASM_TOOLCHAIN, or auto]
    #[arg(long, value_name = "WAY", verbatim_doc_comment)]
    wasm_toolchain: Option<Way>,
}

#[derive(Args)]
struct Out {
    /// The folder to write to
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

fn main() -> Result<()> {
    match Task::parse() {
        Task::Ci => {
            let workspace = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
            run(Command::new("bash").arg(".ci/run").current_dir(workspace))
        }
        Task::Plugins(plugins) => plugins.build(),
        Task::Bench { json } => xtask::bench::bench(json.as_deref()),
        Task::Fuzz(options) => fuzz::fuzz(&options),
        Task::Dist { prefix, whole } => dist(&Dist { prefix, whole, build: Build::here()? }),
        Task::Release(release) => xtask::release::release(&release),
        Task::Book(to) => xtask::book::book(&to.out),
        Task::Firmware(to) => xtask::firmware::firmware(&to.out),
        Task::Bindings { names } => xtask::bindings::test(&names),
        Task::Web(to) => xtask::web::web(&to.out),
        Task::Studio(to) => xtask::studio::studio(&to.out),
        Task::StudioShelf => xtask::shelf::shelf(),
        Task::Registry(to) => example_registry(&to.out),
        Task::Prove(proof) => prove::prove(&proof),
        Task::Generate => xtask::generated::generate(),
        Task::Census { list } => xtask::census::census(list),
    }
}

/// Makes the example registry, checks it, and writes its page.
fn example_registry(out: &Path) -> Result<()> {
    let htex = xtask::bindings::command()?;
    xtask::registry::registry(out, &htex)?;
    run(Command::new(&htex).args(["registry", "check", "--run-native"]).arg(out))?;
    run(Command::new(&htex)
        .args(["registry", "page"])
        .arg(out)
        .arg("-o")
        .arg(out.join("index.html")))
}

impl Plugins {
    /// Builds the models and prints their folder.
    fn build(&self) -> Result<()> {
        let mut folder = PathBuf::new();
        if !self.wasm_only {
            folder = plugins::native()?;
        }
        if !self.native_only {
            folder = self.wasm_toolchain.map_or_else(plugins::wasm, plugins::wasm_by)?;
        }
        println!("{}", folder.display());
        Ok(())
    }
}
