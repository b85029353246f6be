//! Plugins that one person publishes and another one installs, in two homes with two keys.

use std::path::Path;

use serde_json::json;

use crate::common::{Place, Run};

/// A person with keys and plugins of their own, at a place that both see.
struct Person<'a> {
    place: &'a Place,
    name: &'static str,
}

impl Person<'_> {
    fn run(&self, arguments: &[&str]) -> Run {
        let mut command = self.place.command(arguments);
        let home = self.place.path(self.name);
        command
            .env("HTEX_CONFIG_DIR", home.join("settings"))
            .env("XDG_DATA_HOME", home.join("data"));
        Run::of(command.output().unwrap())
    }

    #[track_caller]
    fn does(&self, arguments: &[&str]) -> String {
        let run = self.run(arguments);
        assert_eq!(run.code(), 0, "{arguments:?}: {}{}", run.text(), run.error());
        run.text()
    }

    /// Runs a command that must fail, and returns its error.
    #[track_caller]
    fn cannot(&self, arguments: &[&str]) -> String {
        let run = self.run(arguments);
        assert_eq!(run.code(), 1, "{arguments:?}: {}{}", run.text(), run.error());
        run.error()
    }

    /// Returns the files of the folder of installed models.
    fn installed(&self) -> Vec<String> {
        let folder = self.place.path(self.name).join("data/htex/plugins");
        let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
        let name = |entry: std::io::Result<std::fs::DirEntry>| {
            entry.unwrap().file_name().into_string().unwrap()
        };
        let mut names: Vec<String> = entries.map(name).collect();
        names.sort();
        names
    }
}

/// Builds the example in C with changes of its text; false without a compiler for it.
fn build(place: &Place, to: &str, changes: &[(&str, &str)]) -> bool {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/model-c-bursts");
    let mut text = std::fs::read_to_string(source.join("bursts.c")).unwrap();
    for (old, new) in changes {
        assert_eq!(text.matches(old).count(), 1, "{old}");
        text = text.replace(old, new);
    }
    place.write("bursts.c", text);
    place.write("rhythm.h", std::fs::read(source.join("rhythm.h")).unwrap());
    let file = place.path("bursts.c");
    let built = xtask::c_module::build(file.to_str().unwrap(), place.path(to).as_ref());
    xtask::needs::WASM_CLANG.met(built.is_ok())
}

/// One publishes a model, and another one installs it by its id, updates it, and plays an asset
/// with it. A broken version, another key and changed bytes are refused with one sentence, and
/// change nothing.
#[test]
fn a_model_is_published_and_installed_by_its_id() {
    let place = Place::new();
    let version = |number: &'static str| ("\\\"2.0.0\\\"", number);
    let sound = ("0xd1342543de82ef95u + 1", "0xd1342543de82ef95u + 3");
    if !build(&place, "first.wasm", &[]) {
        return;
    }
    assert!(build(&place, "broken.wasm", &[version("\\\"2.1.0\\\""), sound]));
    assert!(build(&place, "second.wasm", &[version("\\\"2.1.0\\\"")]));
    assert!(build(&place, "major.wasm", &[version("\\\"3.0.0\\\""), sound]));
    let (author, user) =
        (Person { place: &place, name: "author" }, Person { place: &place, name: "user" });
    author.does(&["key", "new", "alice"]);
    author.does(&["key", "new", "mallory"]);
    let key = author.does(&["key", "show", "alice"]).trim().to_owned();
    user.does(&["key", "trust", "alice", &key]);
    for file in ["first.wasm", "broken.wasm"] {
        author.does(&["plugin", "export", file]);
        author.does(&["sign", file, "--key", "alice"]);
    }
    // What its author sees before it is published.
    let against = ["--against", "first.wasm", "--only", "successor"];
    for (file, code) in [("second.wasm", 0), ("major.wasm", 0), ("broken.wasm", 1)] {
        let run = author.run(&[&["plugin", "check", file][..], &against].concat());
        assert_eq!(run.code(), code, "{file}: {}", run.text());
    }
    let add = |file| ["registry", "add", "registry", file];
    let texts = ["--license", "MIT", "--source", "https://example.org/bursts"];
    let error = author.run(&add("first.wasm")).error();
    assert!(error.contains("new in this registry; give --license"), "{error}");
    assert!(!place.path("registry").exists());
    let said = author.does(&[&add("first.wasm")[..], &texts].concat());
    assert!(said.contains("org.example.bursts 2.0.0 for wasm"), "{said}");
    author.does(&["registry", "check", "registry", "--only", "org.example.none"]);

    let install = ["plugin", "install", "org.example.bursts", "--registry", "registry"];
    let said = user.does(&[&install[..], &["--only-signed-by", "alice"]].concat());
    assert!(said.contains("signed by alice; it may do nothing outside its sandbox"), "{said}");
    let first = user.installed();
    assert_eq!(first.len(), 3, "{first:?}");
    let listed = user.does(&["plugin", "list", "--json"]);
    let listed: serde_json::Value = serde_json::from_str(&listed).unwrap();
    assert_eq!(listed["models"][0]["signer"]["name"], json!("alice"));

    // An asset that does not bring the model along plays as it does for the author.
    author.does(&["simulate", "--surface", "vinyl", "--seconds", "2", "-o", "vinyl.csv"]);
    author.does(&[
        "fit",
        "vinyl.csv",
        "--plugin",
        "first.wasm",
        "--model",
        "bursts",
        "-o",
        "a.htex",
    ]);
    let synth = ["synth", "a.htex", "--model", "org.example.bursts", "--seconds", "1", "-o"];
    author.does(&[&synth[..], &["author.wav", "--plugin", "first.wasm"]].concat());
    assert_ne!(author.run(&[&synth[..], &["none.wav"]].concat()).code(), 0);
    user.does(&[&synth[..], &["user.wav"]].concat());
    let samples = |file| std::fs::read(place.path(file)).unwrap();
    assert_eq!(samples("author.wav"), samples("user.wav"));

    // A new version that sounds different.
    author.does(&add("broken.wasm"));
    let error = author.cannot(&add("broken.wasm"));
    assert!(error.contains("already has version 2.1.0 for wasm"), "{error}");
    let error = user.cannot(&["plugin", "update", "--registry", "registry"]);
    assert!(error.contains("2.1.0 does not play what 2.0.0 plays"), "{error}");
    assert_eq!(user.installed(), first);

    // The same with another key, in a file and in the registry.
    author.does(&["sign", "broken.wasm", "--key", "mallory"]);
    let error = user.cannot(&["plugin", "install", "broken.wasm"]);
    assert!(error.contains("not signed with the key of the installed version 2.0.0"), "{error}");
    author.does(&["sign", "major.wasm", "--key", "mallory"]);
    let error = author.cannot(&add("major.wasm"));
    assert!(error.contains("signed with another key than the entry's"), "{error}");
    let published = |version: &str| format!("registry/files/org.example.bursts-{version}.wasm");
    let signature = std::fs::read(place.path("broken.wasm.sig")).unwrap();
    place.write(&format!("{}.sig", published("2.1.0")), signature);
    let error = user.cannot(&install);
    assert!(error.contains("not signed with the key that the registry lists"), "{error}");
    let run = author.run(&["registry", "check", "registry"]);
    assert_eq!(run.code(), 1);
    assert!(run.text().contains("signed with another key"), "{}", run.text());

    // Bytes that were changed, with and without the registry's hash.
    let mut changed = std::fs::read(place.path("first.wasm")).unwrap();
    changed.push(0);
    place.write(&published("2.0.0"), &changed);
    let error = user.cannot(&[&install[..], &["--version", "2.0.0"]].concat());
    assert!(error.contains("changed after it was signed"), "{error}");
    assert_eq!(user.installed(), first);

    // A module that carries the descriptor of another one, which lists would believe.
    let first_module = std::fs::read(place.path("first.wasm")).unwrap();
    let other = r#"{"id":"org.htex.ar","version":"9.0.0"}"#;
    let liar = htex_base::native::description::with_section(&first_module, other).unwrap();
    place.write("liar.wasm", liar);
    let error = user.cannot(&["plugin", "install", "liar.wasm"]);
    assert!(error.contains("carries the descriptor of org.htex.ar 9.0.0"), "{error}");
    assert_eq!(user.installed(), first);

    // The user no longer trusts the key.
    user.does(&["key", "revoke", "alice"]);
    let error = user.cannot(&["plugin", "install", "first.wasm"]);
    assert!(error.contains("whose key you revoked"), "{error}");
    assert!(user.does(&["plugin", "list"]).contains("whose key you revoked"));
    user.does(&["plugin", "remove", "org.example.bursts"]);
    assert!(user.installed().is_empty());
}

/// A native library is loaded by no list, and installed only if its user agrees.
#[cfg(target_os = "linux")]
#[test]
fn no_list_loads_a_native_library() {
    let place = Place::new();
    let user = Person { place: &place, name: "user" };
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/device-c-strip/strip.c");
    let mut text = std::fs::read_to_string(source).unwrap();
    text += "\n#include <stdio.h>\n__attribute__((constructor)) static void loaded(void) {\n\
             FILE *f = fopen(\"loaded\", \"w\"); if (f) fclose(f); }\n";
    place.write("strip.c", text);
    let include = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/include");
    let mut compiler = std::process::Command::new("cc");
    compiler.args([
        "-std=c11", "-O1", "-shared", "-fPIC", "-I", include, "-o", "strip.so", "strip.c", "-lm",
    ]);
    let built = compiler.current_dir(place.path("")).status();
    if !xtask::needs::CC.met(built.is_ok_and(|status| status.success())) {
        return;
    }
    let loaded = place.path("loaded");
    // A signature that calls the library an asset.
    let key = htex_format::signing::SecretKey::from_bytes(&[7; 32]);
    let mut content = htex_format::signing::SignedContent::plugin(
        htex_format::signing::SignedKind::Asset,
        "Oak",
        "",
        b"",
    );
    content.blake3 = "0".repeat(64);
    place.write("strip.so.sig", content.sign(&key).to_json());
    assert_eq!(user.run(&["verify", "strip.so"]).code(), 1);
    assert!(!loaded.exists(), "`verify` loaded a library");
    std::fs::remove_file(place.path("strip.so.sig")).unwrap();
    let error = user.cannot(&["plugin", "install", "strip.so"]);
    assert!(error.contains("can do everything that you can"), "{error}");
    assert!(!loaded.exists(), "the library was loaded before its user agreed");
    let said = user.does(&["plugin", "install", "strip.so", "--yes"]);
    assert!(said.contains("device org.example.strip"), "{said}");
    assert!(loaded.exists());
    std::fs::remove_file(&loaded).unwrap();
    assert!(user.does(&["device", "list"]).contains("org.example.strip"));
    assert!(!loaded.exists(), "`device list` loaded a library");
    // The same for a library whose descriptor is not beside it, which is named instead.
    let folder = place.path("user/data/htex/devices");
    std::fs::copy(place.path("strip.so"), folder.join("bare.so")).unwrap();
    let listed = user.does(&["device", "list"]);
    assert!(listed.contains("`htex plugin export"), "{listed}");
    assert!(!loaded.exists(), "`device list` loaded a library");
}

/// Assets and libraries: who signed them, and what a signature covers.
#[test]
fn a_signature_names_its_signer_and_covers_every_texture() {
    let place = Place::new();
    let (author, user) =
        (Person { place: &place, name: "author" }, Person { place: &place, name: "user" });
    let conformance = Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec/conformance");
    let asset = std::fs::read(conformance.join("valid_five_models.htex")).unwrap();
    place.write("a.htex", &asset);
    author.does(&["lib", "pack", "l.htexlib", "a.htex"]);
    author.does(&["key", "new", "alice"]);
    author.does(&["sign", "a.htex", "l.htexlib"]);
    let key = author.does(&["key", "show", "alice"]).trim().to_owned();

    // Before the user trusts the key, with its digits, and after.
    let run = user.run(&["verify", "a.htex"]);
    assert_eq!(run.code(), 1);
    assert!(run.text().contains("a key that you do not know"), "{}", run.text());
    user.does(&["verify", "a.htex", "--signed-by", &key]);
    user.does(&["key", "trust", "the-author", &key]);
    for file in ["a.htex", "l.htexlib", "l.htexlib#a"] {
        let said = user.does(&["verify", file, "--signed-by", "the-author"]);
        assert!(said.contains("signed by the-author"), "{said}");
    }
    assert!(user.does(&["info", "a.htex"]).contains("signed by the-author"));
    assert!(user.does(&["lib", "info", "l.htexlib"]).contains("signed by the-author"));

    // A texture that was changed in the library: its signature covers the index alone.
    let mut library = std::fs::read(place.path("l.htexlib")).unwrap();
    let last = library.len() - 1;
    library[last] ^= 1;
    place.write("l.htexlib", library);
    user.does(&["verify", "l.htexlib"]);
    assert_eq!(user.run(&["verify", "l.htexlib#a"]).code(), 1);

    // A signature of another file, one that is cut off, and none.
    std::fs::copy(place.path("l.htexlib.sig"), place.path("a.htex.sig")).unwrap();
    assert_eq!(user.run(&["verify", "a.htex"]).code(), 1);
    place.write("a.htex.sig", "{");
    let run = user.run(&["verify", "a.htex"]);
    assert!(run.code() == 1 && run.text().contains("no signature of htex"), "{}", run.text());
    std::fs::remove_file(place.path("a.htex.sig")).unwrap();
    let run = user.run(&["verify", "a.htex"]);
    assert!(run.code() == 1 && run.text().contains("not signed"), "{}", run.text());
}

/// Makes the example registry, which lists the built-in models, an output and an input, and
/// installs a model and the input from it.
#[cfg(target_os = "linux")]
#[test]
fn the_example_registry_is_valid_and_installs() {
    let place = Place::new();
    if xtask::plugins::wasm_if_there().is_none() {
        return;
    }
    let htex = Path::new(env!("CARGO_BIN_EXE_htex"));
    xtask::registry::registry(&place.path("registry"), htex).unwrap();
    let author = Person { place: &place, name: "author" };
    let ids = ["org.htex.sslope", "org.example.strip", "org.example.ridges"];
    let only = ids.map(|id| ["--only", id]).concat();
    let checked =
        author.does(&[&["registry", "check", "registry", "--run-native"][..], &only].concat());
    assert!(checked.ends_with("3 plugins, 0 with problems\n"), "{checked}");
    author.does(&["registry", "page", "registry", "-o", "index.html"]);
    let page = std::fs::read_to_string(place.path("index.html")).unwrap();
    for model in xtask::plugins::models().unwrap() {
        assert!(page.contains(&format!("org.htex.{model}")), "{model}");
    }
    let from = ["--registry", "registry", "--accept-key", "--yes"];
    for id in [ids[0], ids[2]] {
        author.does(&[&["plugin", "install", id][..], &from].concat());
    }
    let listed = author.does(&["device", "list", "--json"]);
    assert!(listed.contains(ids[2]), "{listed}");
}
