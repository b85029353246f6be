//! `cargo xtask book`: the pages of the repository as a book of HTML.
//!
//! The pages are copied with the repository's folders, so that their links lead where they lead on
//! the web. Every page that one of them links to is a page of the book; other files that are linked
//! to are copied as they are. mdBook makes the HTML, in which every link is then followed.

mod links;
mod pages;

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};
use fs_err as fs;

use crate::places::{target, version};
use crate::programs::run;

/// The version that the book was made with, and how it is installed.
const INSTALL: &str = "cargo install mdbook --version 0.5.4 --locked --root target/release-tools";

/// What mdBook is told. Pages have no `{{#include}}`, and a README is a page of that name, since
/// links say so.
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

/// mdBook copies the first page to the top of the book, where its links lead elsewhere: the top
/// leads to the page instead.
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

/// Makes the book in a folder: `source` has its pages, `html` what is read.
///
/// # Errors
/// When mdBook is not installed or fails, and when a link leads nowhere: with the page and the
/// link.
pub fn book(out: &Path) -> Result<()> {
    let out = std::path::absolute(out)?;
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
