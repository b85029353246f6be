//! `cargo xtask book`: makes an HTML book from the pages of the repository.
//!
//! Copies the pages into the same folders as in the repository, so that their links work as on the
//! web. A page that another page links to becomes part of the book. Other linked files are copied
//! unchanged. mdBook makes the HTML. Then every link in the HTML is checked.

mod links;
mod pages;

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};
use fs_err as fs;

use crate::places::{target, version};
use crate::programs::run;

/// How to install mdBook, in the version with which the book was tested.
const INSTALL: &str = "cargo install mdbook --version 0.5.4 --locked --root target/release-tools";

/// mdBook's settings. Pages have no `{{#include}}`. A README keeps its name, because links use it.
const SETTINGS: &str = r#"[book]
title = "htex @version@"
description = "Textures of touch: a file format, models, players, devices, studies"
language = "en"
src = "source"

[build]
build-dir = "html"
create-missing = false
use-default-preprocessors = false

[output.html]
no-section-label = true
input-404 = ""
additional-css = ["book.css"]

[output.html.print]
enable = false

[output.html.fold]
enable = true
level = 1
"#;

/// mdBook would copy the first page to the top of the book, where its relative links would break.
/// The top redirects to the page instead.
const TOP: &str = r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="refresh" content="0; url=docs/README.html">
<title>htex</title>
</head>
<body><a href="docs/README.html">htex</a></body>
</html>
"#;

/// Makes the book in a folder: `source` contains its pages, `html` the result.
///
/// # Errors
/// If mdBook is not installed or fails, or if a link is broken. The message names the page and the
/// link.
pub fn book(out: &Path) -> Result<()> {
    let out = std::path::absolute(out)?;
    // Only these two folders, because `out` may contain other files.
    for part in ["source", "html"] {
        if out.join(part).exists() {
            fs::remove_dir_all(out.join(part))?;
        }
    }
    let count = pages::assemble(&out.join("source"))?;
    fs::write(out.join("book.toml"), SETTINGS.replace("@version@", &version()?))?;
    fs::write(out.join("book.css"), include_str!("book.css"))?;
    let installed = target().join("release-tools/bin/mdbook");
    let program = if installed.exists() { installed.as_path() } else { Path::new("mdbook") };
    let mut mdbook = Command::new(program);
    run(mdbook.arg("build").arg(&out))
        .with_context(|| format!("mdBook makes the book: {INSTALL}"))?;
    fs::write(out.join("html/index.html"), TOP)?;
    let followed = links::follow(&out.join("html"))?;
    println!("{}: {count} pages, {followed} links", out.join("html/index.html").display());
    Ok(())
}
