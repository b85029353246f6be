use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use htex_base::files::{AtFile, OwnFolder};
use htex_check::model::templates;

use crate::failure::{Exit, Failure, Result};
use crate::output::print;

/// The folder `sdk` of the sources from which this program was built; `None` in a released program.
const SDK: Option<&str> = option_env!("HTEX_SDK");

/// Write a project for a new model. The project builds with one command, and its model passes
/// `htex plugin check`.
#[derive(Args)]
pub(crate) struct New {
    /// Name of the model: lower-case letters, digits and hyphens
    name: String,

    /// Language of the project
    #[arg(long, value_enum)]
    lang: Lang,

    /// Folder to write to; it must not exist yet [default: the model's name]
    #[arg(long, value_name = "DIR")]
    dir: Option<PathBuf>,

    /// For --lang rust: path of the folder `sdk` in the sources of htex [default: the sources from
    /// which this program was built; a released program has no default]
    #[arg(long, value_name = "DIR")]
    sdk: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Lang {
    Rust,
    C,
}

impl Lang {
    /// Returns the files of a project with their templates.
    fn files(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Rust => templates::RUST,
            Self::C => templates::C,
        }
    }
}

impl New {
    pub(crate) fn run(self) -> Result {
        let dir = self.dir.clone().unwrap_or_else(|| (&self.name).into());
        self.check(&dir)?;
        // Before the folder is made, so that a wrong --sdk leaves nothing behind.
        let sdk = (self.lang == Lang::Rust).then(|| self.sdk()).transpose()?;
        let own = OwnFolder::new(&dir);
        own.make_folder(Path::new("")).writing(&dir)?;
        // The folder has to exist, because only then its path can be made canonical.
        let values = self.values(&sdk_from(&dir, sdk)?);
        for (file, template) in self.lang.files() {
            let fill = |text: String, (key, value): &(&str, String)| text.replace(key, value);
            let text = values.iter().fold((*template).to_owned(), fill);
            let write = |into: &mut std::fs::File| into.write_all(text.as_bytes());
            let written = own.replace(Path::new(file), write);
            written.writing(dir.join(file))?;
        }
        let dir = dir.display();
        print(&match self.lang {
            Lang::Rust => format!("{dir}\nbuild: cargo build --release  (in {dir})\n"),
            Lang::C => format!("{dir}\nbuild: sh {dir}/build.sh\n"),
        })?;
        print(&format!("then:  {dir}/README.md\n"))?;
        Ok(Exit::SUCCESS)
    }

    /// Refuses an invalid name and an existing folder.
    fn check(&self, dir: &Path) -> Result<()> {
        let name = &self.name;
        let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-';
        if !name.bytes().all(plain) || !name.starts_with(|c: char| c.is_ascii_lowercase()) {
            let rule = "lower-case letters, digits and hyphens, a letter first";
            return Err(Failure::Usage(format!("`{name}` is not a valid name: {rule}")));
        }
        if dir.exists() {
            let dir = dir.display();
            return Err(Failure::Usage(format!("{dir} exists; name another with --dir")));
        }
        Ok(())
    }

    /// Returns the placeholders of the templates (`sdk/check/templates/README.md`) with their
    /// values.
    fn values(&self, sdk: &str) -> [(&'static str, String); 7] {
        let name = &self.name;
        let crate_name = name.replace('-', "_");
        let library =
            std::env::consts::DLL_PREFIX.to_owned() + &crate_name + std::env::consts::DLL_SUFFIX;
        [
            ("{{ID}}", format!("org.example.{name}")),
            ("{{NAME}}", name.clone()),
            ("{{LABEL}}", capital(&name.replace('-', " "))),
            ("{{TYPE}}", name.split('-').map(capital).collect()),
            ("{{CRATE}}", crate_name),
            ("{{LIBRARY}}", library),
            ("{{SDK_PATH}}", sdk.to_owned()),
        ]
    }

    /// Returns the folder `sdk` that a Rust project depends on.
    fn sdk(&self) -> Result<PathBuf> {
        let sdk = self.sdk.as_deref().or(SDK.map(Path::new));
        let sdk = sdk.ok_or_else(|| {
            Failure::usage("--sdk names the folder `sdk` of the sources of htex, whose crates a model in Rust takes by path")
        })?;
        sdk.canonicalize().map_err(|error| {
            let sdk = sdk.display();
            Failure::Usage(format!("{sdk}: {error}; --sdk names the folder `sdk` of the sources"))
        })
    }
}

/// Capitalises the first letter of a word.
fn capital(word: &str) -> String {
    // The name is ASCII, so the first byte is the first letter.
    let (first, rest) = word.split_at(word.len().min(1));
    first.to_uppercase() + rest
}

/// Returns the path from a project to the SDK. It is relative if both are on the same drive, and
/// empty if the project does not need the SDK.
fn sdk_from(dir: &Path, sdk: Option<PathBuf>) -> Result<String> {
    let Some(sdk) = sdk else {
        return Ok(String::new());
    };
    let dir = dir.canonicalize().reading(dir)?;
    // Compares the parts of the paths as they are written, so both have to be canonical.
    let path = pathdiff::diff_paths(&sdk, dir).unwrap_or(sdk);
    // Cargo accepts slashes on every system. A backslash would begin an escape sequence.
    Ok(path.display().to_string().replace('\\', "/"))
}
