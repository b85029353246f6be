//! The project templates of `htex plugin new` and `htex device new`. The files of a template
//! contain placeholders (`templates/README.md`), which [`Template::files`] fills in.

/// A project template for a model or a device in one programming language. The project builds and
/// passes its checker.
pub struct Template {
    /// Paths relative to the project's folder, and file contents.
    files: &'static [(&'static str, &'static str)],
    /// The command that builds the project in the project's folder.
    build: &'static str,
    /// The steps of the project's CI file after the installation of htex.
    steps: &'static [&'static str],
    /// The crates of htex that the project depends on: names, and paths in the sources.
    crates: &'static [(&'static str, &'static str)],
}

/// The files that all projects have.
const SHARED: [(&str, &str); 3] = [
    (".gitignore", include_str!("../templates/shared/gitignore.in")),
    ("LICENSE", include_str!("../templates/shared/LICENSE.in")),
    (".github/workflows/ci.yml", include_str!("../templates/shared/ci.yml.in")),
];

/// A model in Rust.
pub const MODEL_RUST: Template = Template {
    files: &[
        ("README.md", include_str!("../templates/model-rust/README.md.in")),
        ("Cargo.toml", include_str!("../templates/model-rust/Cargo.toml.in")),
        (".cargo/config.toml", include_str!("../templates/model-rust/config.toml.in")),
        ("src/lib.rs", include_str!("../templates/model-rust/src/lib.rs")),
        ("src/follow.rs", include_str!("../templates/model-rust/src/follow.rs")),
    ],
    build: CARGO_BUILD,
    steps: &[
        CARGO_BUILD,
        "htex plugin check target/release/lib{{CRATE}}.so --fuzz 60",
        "rustup target add wasm32-unknown-unknown",
        "cargo module",
        "htex plugin check target/wasm32-unknown-unknown/module/{{CRATE}}.wasm \
         --against target/release/lib{{CRATE}}.so",
    ],
    crates: &[("htex-dsp", "sdk/core/dsp"), ("htex-model", "sdk/core/model")],
};

/// A model in C.
pub const MODEL_C: Template = Template {
    files: &[
        ("README.md", include_str!("../templates/model-c/README.md.in")),
        ("model.c", include_str!("../templates/model-c/model.c")),
        ("resonance.h", include_str!("../templates/model-c/resonance.h")),
        ("build.sh", include_str!("../templates/model-c/build.sh")),
        ("htex_model.h", include_str!("../templates/include/htex_model.h")),
        ("htex_model_parts.h", include_str!("../templates/include/htex_model_parts.h")),
        ("htex_model_wasm.h", include_str!("../templates/include/htex_model_wasm.h")),
        ("htex_motion_1.h", include_str!("../templates/include/htex_motion_1.h")),
    ],
    build: SCRIPT,
    steps: &[
        SCRIPT,
        "htex plugin check {{NAME}}.so --fuzz 60",
        "sudo apt-get install -y clang lld",
        "sh build.sh wasm",
        "htex plugin check {{NAME}}.wasm --against {{NAME}}.so",
    ],
    crates: &[],
};

/// A model in Zig.
pub const MODEL_ZIG: Template = Template {
    files: &[
        ("README.md", include_str!("../templates/model-zig/README.md.in")),
        ("model.zig", include_str!("../templates/model-zig/model.zig")),
        ("resonance.zig", include_str!("../templates/model-zig/resonance.zig")),
        ("parts.zig", include_str!("../templates/model-zig/parts.zig")),
        ("build.sh", include_str!("../templates/model-zig/build.sh")),
        ("htex_model.h", include_str!("../templates/include/htex_model.h")),
    ],
    build: SCRIPT,
    steps: &[
        "python3 -m venv .zig && .zig/bin/pip install ziglang==0.15.1 \
         && echo \"ZIG=$PWD/.zig/bin/python -m ziglang\" >> \"$GITHUB_ENV\"",
        SCRIPT,
        "htex plugin check {{NAME}}.so --fuzz 60",
        "sh build.sh wasm",
        "htex plugin check {{NAME}}.wasm --against {{NAME}}.so",
    ],
    crates: &[],
};

/// A device in Rust.
pub const DEVICE_RUST: Template = Template {
    files: &[
        ("README.md", include_str!("../templates/device-rust/README.md.in")),
        ("Cargo.toml", include_str!("../templates/device-rust/Cargo.toml.in")),
        ("src/lib.rs", include_str!("../templates/device-rust/src/lib.rs")),
    ],
    build: CARGO_BUILD,
    steps: &[CARGO_BUILD, "htex device check target/release/lib{{CRATE}}.so"],
    crates: &[("htex-device", "renderer-adapters/device")],
};

/// A device in C.
pub const DEVICE_C: Template = Template {
    files: &[
        ("README.md", include_str!("../templates/device-c/README.md.in")),
        ("device.c", include_str!("../templates/device-c/device.c")),
        ("build.sh", include_str!("../templates/device-c/build.sh")),
        ("htex_device.h", include_str!("../templates/include/htex_device.h")),
    ],
    build: SCRIPT,
    steps: &[SCRIPT, "htex device check {{NAME}}.so"],
    crates: &[],
};

const CARGO_BUILD: &str = "cargo build --release";
const SCRIPT: &str = "sh build.sh";

impl Template {
    /// The command that builds the project in the project's folder.
    pub fn build(&self) -> &'static str {
        self.build
    }

    /// The crates of htex that the project depends on: names, and paths in the sources.
    pub fn crates(&self) -> &'static [(&'static str, &'static str)] {
        self.crates
    }

    /// Returns the files of a project with this name: paths relative to the project's folder, and
    /// contents. The name has only lower-case letters, digits and hyphens. `sources` is the path
    /// from the project to the sources of htex. With this path, cargo takes the crates of htex from
    /// the sources; without it, cargo takes them from the registry.
    pub fn files(&self, name: &str, sources: Option<&str>) -> Vec<(&'static str, String)> {
        let values = self.values(name, sources);
        let fill = |text: String, (key, value): &(&str, String)| text.replace(key, value);
        let files = SHARED.iter().chain(self.files);
        files.map(|(file, text)| (*file, values.iter().fold((*text).to_owned(), fill))).collect()
    }

    /// Returns the placeholders with their values. The first values contain other placeholders.
    fn values(&self, name: &str, sources: Option<&str>) -> [(&'static str, String); 10] {
        let crate_name = name.replace('-', "_");
        let library =
            std::env::consts::DLL_PREFIX.to_owned() + &crate_name + std::env::consts::DLL_SUFFIX;
        let steps: Vec<String> =
            self.steps.iter().map(|step| format!("      - run: {step}")).collect();
        [
            ("{{STEPS}}", steps.join("\n")),
            ("{{CRATES}}", include_str!("../templates/shared/crates.md.in").trim_end().to_owned()),
            ("{{PATCH}}", sources.map_or_else(String::new, |sources| self.patch(sources))),
            ("{{VERSION}}", version()),
            ("{{ID}}", format!("org.example.{name}")),
            ("{{NAME}}", name.to_owned()),
            ("{{LABEL}}", capital(&name.replace('-', " "))),
            ("{{TYPE}}", name.split('-').map(capital).collect()),
            ("{{CRATE}}", crate_name),
            ("{{LIBRARY}}", library),
        ]
    }

    /// Returns the section of `Cargo.toml` that replaces the published crates by the sources.
    fn patch(&self, sources: &str) -> String {
        // In TOML, a backslash begins an escape sequence.
        let sources = sources.replace('\\', "\\\\").replace('"', "\\\"");
        let lines = self
            .crates
            .iter()
            .map(|(name, path)| format!("{name} = {{ path = \"{sources}/{path}\" }}\n"));
        let lines: String = lines.collect();
        format!(
            "\n# Uses the sources of htex instead of the crates on crates.io. Delete this section once the\n\
             # crates are published.\n[patch.crates-io]\n{lines}"
        )
    }
}

/// Returns the version of the crates that a project depends on: major and minor.
fn version() -> String {
    [env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR")].join(".")
}

/// Capitalises the first letter of a word.
fn capital(word: &str) -> String {
    // The name is ASCII, so the first byte is the first letter.
    let (first, rest) = word.split_at(word.len().min(1));
    first.to_uppercase() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without the sources, a project depends only on versions. With them, it takes every crate of
    /// htex that it depends on from the sources.
    #[test]
    fn crates_come_from_the_registry_or_from_the_sources() {
        for template in [&MODEL_RUST, &DEVICE_RUST] {
            let manifest = |sources: Option<&str>| {
                let files = template.files("my-own", sources);
                files.into_iter().find(|(file, _)| *file == "Cargo.toml").map(|(_, text)| text)
            };
            let published = manifest(None).unwrap_or_default();
            assert!(!published.contains("path") && !published.contains("[patch"), "{published}");
            let patched = manifest(Some("a \"b\" \\c")).unwrap_or_default();
            for (name, path) in template.crates() {
                assert!(published.contains(&format!("\n{name} = ")), "{published}");
                let line = format!("\n{name} = {{ path = \"a \\\"b\\\" \\\\c/{path}\" }}\n");
                assert!(patched.contains(&line), "{patched}");
            }
        }
    }
}
