//! What the pages say of the command is so: each line of it parses, and links lead to files and
//! headings.

use std::path::{Path, PathBuf};

use xtask::markdown::{anchors, blocks, is_address, links};
use xtask::shell::commands;

fn workspace() -> PathBuf {
    std::fs::canonicalize(Path::new(env!("CARGO_MANIFEST_DIR")).join("..")).unwrap()
}

/// The pages of the repository: all files in Markdown outside folders that are built or hidden.
fn pages() -> Vec<PathBuf> {
    let mut pages = Vec::new();
    let mut folders = vec![workspace()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let is_built = ["target", "node_modules", "out", "book"].contains(&&*name);
            if path.is_dir() && !is_built && !name.starts_with('.') {
                folders.push(path);
            } else if name.ends_with(".md") {
                pages.push(path);
            }
        }
    }
    pages.sort();
    pages
}

/// The lines of a block that are commands: in `console` those after the prompt.
fn script(language: &str, text: &str) -> String {
    match language {
        "console" => {
            let lines = text.lines().map(|line| line.strip_prefix("$ ").unwrap_or(line));
            lines.map(|line| format!("{line}\n")).collect()
        }
        _ => text.to_owned(),
    }
}

#[test]
fn the_lines_of_the_command_on_pages_parse() {
    let (mut wrong, mut seen) = (Vec::new(), 0);
    for page in pages() {
        let text = std::fs::read_to_string(&page).unwrap();
        let shown = page.strip_prefix(workspace()).unwrap().display();
        let shells = blocks(&text).into_iter();
        for block in shells.filter(|block| ["sh", "console"].contains(&&*block.language)) {
            for words in commands(&script(&block.language, &block.text)) {
                if words[0] != "htex" || !is_built_in(&words) {
                    continue;
                }
                seen += 1;
                if let Err(error) = htex_cli::check_usage(words.iter().map(Into::into)) {
                    wrong.push(format!("{shown}:{}: {}: {error}", block.line, words.join(" ")));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // A build without features has fewer subcommands.
    assert!(seen > 100, "{seen} lines");
}

/// Whether this build has the subcommand.
fn is_built_in(words: &[String]) -> bool {
    match words.get(1).map(String::as_str) {
        Some("record" | "response" | "study" | "studio") => cfg!(feature = "lab"),
        Some("build") => cfg!(feature = "build"),
        _ => true,
    }
}

#[test]
fn links_lead_to_files_and_headings() {
    let mut wrong = Vec::new();
    for page in pages() {
        let text = std::fs::read_to_string(&page).unwrap();
        for link in links(&text).into_iter().map(|range| &text[range]) {
            if !is_address(link) && !leads(&page, link) {
                wrong
                    .push(format!("{}: {link}", page.strip_prefix(workspace()).unwrap().display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Whether a link leads to a file or folder, and if it names a heading of a page, to that.
fn leads(page: &Path, link: &str) -> bool {
    let (path, heading) = link.split_once('#').unwrap_or((link, ""));
    let file = match path {
        "" => page.to_owned(),
        _ => page.parent().unwrap().join(path.replace("%20", " ")),
    };
    if heading.is_empty() || !file.is_file() || file.extension() != Some("md".as_ref()) {
        return file.exists();
    }
    anchors(&std::fs::read_to_string(file).unwrap()).iter().any(|anchor| anchor == heading)
}

/// The blocks of a language on a page.
fn texts(page: &str, language: &str) -> Vec<String> {
    let page = std::fs::read_to_string(workspace().join(page)).unwrap();
    let all = blocks(&page).into_iter();
    all.filter(|block| block.language == language).map(|block| block.text).collect()
}

/// Each block is a recipe, or goes into one.
#[cfg(feature = "build")]
#[test]
fn recipes_on_pages_are_read() {
    let recipes = texts("docs/libraries.md", "toml");
    assert_eq!(recipes.len(), 4);
    for block in recipes {
        let library =
            if block.contains("[library]") { "" } else { "[library]\nname = \"vinyls\"\n" };
        let textures = if block.contains("[[textures]]") {
            ""
        } else {
            "[[textures]]\nrecordings = \"rec/*.csv\"\n"
        };
        let recipe = format!("{library}{block}{textures}");
        htex_build::Recipe::parse(&recipe).unwrap_or_else(|error| panic!("{recipe}\n{error}"));
    }
}

/// The shortest study, and with all that the page's second block says.
#[cfg(feature = "lab")]
#[test]
fn studies_on_pages_are_read() {
    let studies = texts("docs/studies.md", "toml");
    let [short, more] = &studies[..] else { panic!("{studies:?}") };
    let (keys, textures) = short.split_once("[[textures]]").unwrap();
    for study in [short.clone(), format!("{keys}{more}\n[[textures]]{textures}")] {
        let mut findings = htex_base::finding::Findings::default();
        let read = htex_lab::study::read_study(study.as_bytes(), &mut findings);
        assert!(read.is_some(), "{study}\n{findings:?}");
    }
}

/// What pages import from the npm package is there.
#[test]
fn imports_on_pages_exist() {
    let types =
        std::fs::read_to_string(workspace().join("sdk/bindings/web/src/index.d.ts")).unwrap();
    let scripts = texts("docs/devices.md", "js");
    assert_eq!(scripts.len(), 1);
    for script in scripts {
        let (_, names) = script.split_once("import {").unwrap();
        let (names, _) = names.split_once("} from \"htex\"").unwrap();
        for name in names.split(',').map(str::trim) {
            let declared =
                ["function", "class", "const"].map(|kind| format!("export {kind} {name}"));
            assert!(declared.iter().any(|line| types.contains(line)), "{name}");
        }
    }
}

/// A flag that does not exist is found, and so is a command.
#[test]
fn wrong_lines_are_refused() {
    for (line, is_right) in [
        ("htex fit rec.csv -o a.htex", true),
        ("htex help fit", true),
        ("htex fit rec.csv -o a.htex --no-such-flag", false),
        ("htex no-such-command", false),
    ] {
        let words = line.split(' ').map(Into::into);
        assert_eq!(htex_cli::check_usage(words).is_ok(), is_right, "{line}");
    }
}
