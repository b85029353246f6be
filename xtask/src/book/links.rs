//! Checks the links in the built pages.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use fs_err as fs;

use crate::markdown::is_address;

/// Checks every link, and checks that no page loads anything from a network. Returns the number of
/// links.
pub(super) fn follow(html: &Path) -> Result<usize> {
    let mut pages = BTreeMap::new();
    collect(html, &mut pages)?;
    let anchors: BTreeMap<&Path, BTreeSet<String>> = pages
        .iter()
        .map(|(page, text)| (page.as_path(), values(text, "id").map(unescaped).collect()))
        .collect();
    let (mut followed, mut wrong) = (0, Vec::new());
    for (page, text) in &pages {
        for loaded in loaded(text).filter(|address| is_network(address)) {
            wrong.push(format!("{}: loads {loaded}", page.display()));
        }
        for link in values(text, "href").chain(values(text, "src")).map(unescaped) {
            if is_address(&link) || link.starts_with("javascript:") {
                continue;
            }
            followed += 1;
            if !leads(page, &link, &anchors) {
                wrong.push(format!("{}: {link}", page.display()));
            }
        }
    }
    if !wrong.is_empty() {
        bail!("links that lead nowhere:\n{}", wrong.join("\n"));
    }
    Ok(followed)
}

/// Collects the HTML pages in a folder and its subfolders, with their texts.
fn collect(folder: &Path, pages: &mut BTreeMap<PathBuf, String>) -> Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, pages)?;
        } else if path.extension().is_some_and(|extension| extension == "html") {
            let text = fs::read_to_string(&path)?;
            pages.insert(path, text);
        }
    }
    Ok(())
}

/// Whether a page's link leads to an existing file, and to an existing anchor in it.
fn leads(page: &Path, link: &str, anchors: &BTreeMap<&Path, BTreeSet<String>>) -> bool {
    let (path, fragment) = link.split_once('#').unwrap_or((link, ""));
    let path = path.split('?').next().unwrap_or_default();
    let file = match path {
        "" => page.to_owned(),
        // mdBook's own "not found" page is opened at any address.
        _ => page.parent().unwrap_or(Path::new("")).join(unquoted(path)),
    };
    let Ok(file) = fs::canonicalize(&file) else {
        return false;
    };
    let known = anchors.get(file.as_path());
    file.is_file()
        // Only pages have known anchors. A fragment of another file is not checked.
        && (fragment.is_empty() || known.is_none_or(|known| known.contains(&unquoted(fragment))))
}

/// Returns the values of an attribute.
fn values<'a>(text: &'a str, attribute: &str) -> impl Iterator<Item = &'a str> {
    let begin = format!(" {attribute}=\"");
    let ends = text.match_indices(&begin).map(|(at, begin)| at + begin.len()).collect::<Vec<_>>();
    ends.into_iter().filter_map(|at| Some(text[at..].split_once('"')?.0))
}

/// Returns the addresses of the scripts, pictures and style sheets that a page loads.
fn loaded(text: &str) -> impl Iterator<Item = &str> {
    let sheets = text.split("<link ").skip(1).filter_map(|rest| rest.split_once('>'));
    values(text, "src").chain(sheets.flat_map(|(tag, _)| {
        let start = tag.find("href=\"").map(|at| at + 6);
        start.and_then(|start| Some(tag[start..].split_once('"')?.0))
    }))
}

fn is_network(address: &str) -> bool {
    address.starts_with("//") || (address.contains("://") && !address.starts_with("data:"))
}

/// Replaces the HTML entities in a text.
fn unescaped(text: &str) -> String {
    let text = text.replace("&quot;", "\"").replace("&#39;", "'").replace("&#x27;", "'");
    text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
}

/// Decodes `%20` and similar codes in a path or fragment.
fn unquoted(text: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = text.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = after
            .get(..2)
            .and_then(|digits| std::str::from_utf8(digits).ok())
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        match (first, code) {
            (b'%', Some(code)) => {
                bytes.push(code);
                rest = &after[2..];
            }
            _ => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_wrong_file_a_wrong_fragment_and_a_network_are_found() {
        let folder = std::env::temp_dir().join(format!("htex-book-links-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let with = |body: &str| {
            fs::write(folder.join("a.html"), body).unwrap();
            follow(&fs::canonicalize(&folder).unwrap())
        };
        assert_eq!(
            with("<h1 id=\"a b\"></h1><a href=\"a.html#a%20b\"></a><a href=\"#a b\"></a>").unwrap(),
            2
        );
        for wrong in [
            "<a href=\"b.html\"></a>",
            "<a href=\"#c\"></a>",
            "<img src=\"https://example.org/x.png\">",
            "<link rel=\"stylesheet\" href=\"//example.org/x.css\">",
        ] {
            assert!(with(wrong).is_err(), "{wrong}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }
}
