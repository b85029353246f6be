use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};

use crate::failure::Failure;
use crate::output::{print, write_file};

/// The folder `sdk` of the sources this program was built from.
const SDK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../sdk");

const RUST: &[(&str, &str)] = &[
    (
        "Cargo.toml",
        include_str!("../../../../sdk/check/templates/rust/Cargo.toml.in"),
    ),
    (
        "src/lib.rs",
        include_str!("../../../../sdk/check/templates/rust/src/lib.rs"),
    ),
];

const C: &[(&str, &str)] = &[
    (
        "model.c",
        include_str!("../../../../sdk/check/templates/c/model.c"),
    ),
    (
        "build.sh",
        include_str!("../../../../sdk/check/templates/c/build.sh"),
    ),
    (
        "htex_model.h",
        include_str!("../../../../spec/include/htex_model.h"),
    ),
    (
        "htex_model_wasm.h",
        include_str!("../../../../spec/include/htex_model_wasm.h"),
    ),
];

/// Write the project of a new model: one that builds with one command and passes `check`.
#[derive(Args)]
pub(crate) struct New {
    /// Name of the model: lower-case letters, digits and hyphens
    name: String,

    /// Language of the project
    #[arg(long, value_enum)]
    lang: Lang,

    /// Folder to write it to; it must not exist [default: the name]
    #[arg(long, value_name = "DIR")]
    dir: Option<PathBuf>,

    /// Folder of the htex sources' `sdk`, for Rust [default: of those this program was built from]
    #[arg(long, value_name = "DIR")]
    sdk: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Lang {
    Rust,
    C,
}

impl New {
    pub(crate) fn run(self) -> Result<ExitCode, Failure> {
        let name = &self.name;
        let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-';
        if !name.bytes().all(plain) || !name.starts_with(|c: char| c.is_ascii_lowercase()) {
            let rule = "lower-case letters, digits and hyphens, a letter first";
            return Err(Failure::Usage(format!(
                "`{name}` is no name of a model: {rule}"
            )));
        }
        let dir = self.dir.clone().unwrap_or_else(|| name.into());
        if dir.exists() {
            let dir = dir.display();
            return Err(Failure::Usage(format!(
                "{dir} is there already; --dir names another"
            )));
        }
        let (files, next) = match self.lang {
            Lang::Rust => (
                RUST,
                format!("cargo build --release  (in {})", dir.display()),
            ),
            Lang::C => (C, format!("sh {}/build.sh", dir.display())),
        };
        let sdk = self.sdk_path()?;
        for (file, template) in files {
            let text = template
                .replace("{{NAME}}", name)
                .replace("{{ID}}", &format!("org.example.{name}"))
                .replace("{{SDK_PATH}}", &sdk);
            write(&dir.join(file), &text)?;
        }
        print(&format!(
            "{}\nbuild: {next}\ncheck: htex plugin check FILE\n",
            dir.display()
        ))?;
        Ok(ExitCode::SUCCESS)
    }

    /// The folder `sdk`, from which a project in Rust takes its dependencies.
    fn sdk_path(&self) -> Result<String, Failure> {
        if self.lang == Lang::C {
            return Ok(String::new());
        }
        let sdk = self.sdk.as_deref().unwrap_or(Path::new(SDK));
        let found = sdk.canonicalize().map_err(|error| {
            let sdk = sdk.display();
            Failure::Usage(format!(
                "{sdk}: {error}; --sdk names the folder `sdk` of the sources"
            ))
        })?;
        Ok(found.display().to_string())
    }
}

fn write(file: &Path, text: &str) -> Result<(), Failure> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder).map_err(|error| Failure::write(folder, error))?;
    }
    write_file(file, text.as_bytes())
}
