//! The five models as native libraries.

use std::path::Path;
use std::process::ExitCode;

use crate::run;

const MODELS: [&str; 5] = ["ar", "mfcc", "speak", "sbeta", "sslope"];

/// Builds every model and copies what came out to `target/htex-plugins`.
pub(crate) fn build() -> ExitCode {
    let target = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../target"));
    let out = target.join("htex-plugins");
    for model in MODELS {
        let package = format!("htex-{model}");
        let arguments = ["rustc", "--release", "--lib", "--package", &package];
        let kind = ["--features", "plugin", "--crate-type", "cdylib"];
        let code = run("cargo", &[&arguments[..], &kind].concat());
        if code != ExitCode::SUCCESS {
            return code;
        }
        let library = format!(
            "{}htex_{model}{}",
            std::env::consts::DLL_PREFIX,
            std::env::consts::DLL_SUFFIX
        );
        let copied = std::fs::create_dir_all(&out).and_then(|()| {
            std::fs::copy(target.join("release").join(&library), out.join(&library))
        });
        if let Err(error) = copied {
            eprintln!("xtask: cannot copy {library}: {error}");
            return ExitCode::FAILURE;
        }
    }
    println!("{}", out.display());
    ExitCode::SUCCESS
}
