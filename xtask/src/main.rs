//! Tasks of developers: `cargo xtask`.

use std::process::{Command, ExitCode};

use xtask::dist::Dist;
use xtask::{fuzz, plugins};

const TASKS: &str = "\
cargo xtask ci        runs all steps of continuous integration
cargo xtask plugins   builds the models as plugins into target/htex-plugins, native and WASM;
                      --native-only or --wasm-only builds the one kind; --wasm-toolchain WAY (or
                      HTEX_WASM_TOOLCHAIN) builds modules with the toolchain that is installed, with debian's own
                      compiler, or auto: the first that is there
cargo xtask bench     measures htex beside plain loops in C and NumPy, SciPy, librosa, in one run;
                      --json FILE writes the numbers too
cargo xtask fuzz      fuzzes the TARGETS named, or all of fuzz/fuzz_targets, each for --seconds N (60)
                      or --executions N, --jobs N (2) at a time; with --address under the address
                      sanitizer, which needs a nightly toolchain; see fuzz/README.md
cargo xtask dist --prefix DIR [--small]  builds and installs libhtex for C, C++ and C#
cargo xtask bindings  tests the bindings to other languages and on other processors, all or those named: c, web,
                      python, processors; says what is missing
cargo xtask web --out DIR  builds the npm package `htex` for browsers and Node.js
cargo xtask prove [NAME]  runs a proof that takes long; lists them without a name
cargo xtask generate  writes the generated files of spec/: schemas, pages, conformance files; and
                      the seeds of the fuzz targets";

fn main() -> ExitCode {
    let tasks: Vec<String> = std::env::args().skip(1).collect();
    match tasks.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["plugins", ref options @ ..] => build_plugins(options),
        ["bench", ref options @ ..] => xtask::bench::run(options),
        ["fuzz", ref options @ ..] => fuzz_targets(options),
        ["dist", ref options @ ..] => dist(options),
        ["bindings", ref names @ ..] => done(xtask::bindings::test(names)),
        ["prove", ref arguments @ ..] => done(xtask::prove::prove(arguments)),
        ["web", "--out", out] => done(xtask::web::web(out.as_ref())),
        ["ci"] => run("bash", &[".ci/run"]),
        ["generate"] => xtask::generated::generate(),
        _ => usage(),
    }
}

fn usage() -> ExitCode {
    eprintln!("{TASKS}");
    ExitCode::from(2)
}

/// Fuzzes; fails when something was found.
fn fuzz_targets(options: &[&str]) -> ExitCode {
    let options = match fuzz::Options::parse(options) {
        Ok(options) => options,
        Err(error) => {
            eprintln!("xtask: {error}");
            return usage();
        }
    };
    match fuzz::fuzz(&options) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("xtask: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Builds the models as the options say, and prints their folder.
fn build_plugins(options: &[&str]) -> ExitCode {
    let (options, way) = match options {
        [rest @ .., "--wasm-toolchain", way] => (rest, Some(*way)),
        ["--wasm-toolchain", way, rest @ ..] => (rest, Some(*way)),
        all => (all, None),
    };
    if let Some(Err(error)) = way.map(plugins::check_way) {
        eprintln!("xtask: {error}");
        return ExitCode::from(2);
    }
    let wasm = || way.map_or_else(plugins::wasm, plugins::wasm_by);
    let built = match options {
        [] => plugins::native().and_then(|_| wasm()),
        ["--native-only"] if way.is_none() => plugins::native(),
        ["--wasm-only"] => wasm(),
        _ => return usage(),
    };
    match built {
        Ok(folder) => {
            println!("{}", folder.display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("xtask: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Installs libhtex.
fn dist(options: &[&str]) -> ExitCode {
    let (prefix, small) = match *options {
        ["--prefix", prefix] => (prefix, false),
        ["--prefix", prefix, "--small"] | ["--small", "--prefix", prefix] => (prefix, true),
        _ => return usage(),
    };
    let options = Dist {
        prefix: prefix.into(),
        small,
    };
    done(xtask::dist::dist(&options))
}

fn done(result: Result<(), String>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Runs a program in the workspace's folder.
fn run(program: &str, arguments: &[&str]) -> ExitCode {
    let workspace = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    match Command::new(program)
        .args(arguments)
        .current_dir(workspace)
        .status()
    {
        Ok(status) if status.success() => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("xtask: cannot run {program}: {error}");
            ExitCode::FAILURE
        }
    }
}
