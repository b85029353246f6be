//! Reads Markdown pages, as far as tasks and tests need it: fenced blocks and links.

use std::ops::Range;

/// A fenced block of a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// The first word after the fence: `sh`, `text`, `c`, …
    pub language: String,
    /// The lines between the fences, each with its line break.
    pub text: String,
    /// The number of the first line in the page, starting at 1.
    pub line: usize,
    /// The position of the text in the page, bytes.
    pub range: Range<usize>,
}

/// Returns the fenced blocks of a page, in order.
///
/// ```
/// let [block] = &xtask::markdown::blocks("So:\n\n```sh\nls\n```\n")[..] else { panic!() };
/// assert_eq!((&*block.language, &*block.text, block.line), ("sh", "ls\n", 4));
/// ```
pub fn blocks(page: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<(&str, Block)> = None;
    let mut at = 0;
    for (number, line) in page.split_inclusive('\n').enumerate() {
        let end = at + line.len();
        match &mut open {
            Some((fence, block)) if line.trim() == *fence => {
                block.range.end = at;
                block.text = page[block.range.clone()].to_owned();
                blocks.extend(open.take().map(|(_, block)| block));
            }
            Some(_) => {}
            None => open = fence(line).map(|fence| (fence, begun(line, fence, number + 2, end))),
        }
        at = end;
    }
    blocks
}

/// Returns the backticks at the start of a line, if there are three or more.
fn fence(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let ticks = line.len() - line.trim_start_matches('`').len();
    (ticks >= 3).then(|| &line[..ticks])
}

fn begun(line: &str, fence: &str, number: usize, at: usize) -> Block {
    let words = line.trim_start().trim_start_matches(fence);
    let language = words.split([',', ' ', '\n']).next().unwrap_or_default();
    Block { language: language.to_owned(), text: String::new(), line: number, range: at..at }
}

/// Returns the positions of the targets of a page's links and pictures, without titles. Ignores
/// links in code.
///
/// ```
/// let page = "[a](b.md#c), ![d](e.svg \"f\")\n\n```c\nx[0](1);\n```\n`[g](h)`\n";
/// let links: Vec<&str> = xtask::markdown::links(page).into_iter().map(|range| &page[range]).collect();
/// assert_eq!(links, ["b.md#c", "e.svg"]);
/// ```
pub fn links(page: &str) -> Vec<Range<usize>> {
    let code: Vec<Range<usize>> = blocks(page).into_iter().map(|block| block.range).collect();
    let mut links = Vec::new();
    let mut at = 0;
    for line in page.split_inclusive('\n') {
        if !code.iter().any(|range| range.contains(&at)) {
            links.extend(links_of_line(line, at));
        }
        at += line.len();
    }
    links
}

/// Returns the positions of the link targets in a line that begins at `start`.
fn links_of_line(line: &str, start: usize) -> Vec<Range<usize>> {
    let mut links = Vec::new();
    for (at, _) in line.match_indices("](") {
        let is_code = line[..at].matches('`').count() % 2 == 1;
        let target = &line[at + 2..];
        let length = target.find([')', ' ', '\n']).unwrap_or(target.len());
        if !is_code && length > 0 {
            links.push(start + at + 2..start + at + 2 + length);
        }
    }
    links
}

/// Whether a link leads to a web address instead of another page.
///
/// ```
/// assert!(xtask::markdown::is_address("https://example.org"));
/// assert!(!xtask::markdown::is_address("docs/paper.md#models"));
/// ```
pub fn is_address(link: &str) -> bool {
    link.contains("://") || link.starts_with("mailto:") || link.starts_with("data:")
}

/// Returns the anchor of a heading, the same in the book as on GitHub.
///
/// ```
/// assert_eq!(xtask::markdown::anchor("What `htex fit` does, and why"), "what-htex-fit-does-and-why");
/// ```
pub fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter_map(|c| match c {
        c if c.is_alphanumeric() || c == '_' || c == '-' => Some(c.to_lowercase().to_string()),
        ' ' => Some("-".to_owned()),
        _ => None,
    });
    kept.collect()
}

/// Returns the anchors of a page's headings, and the anchors that the page defines with
/// `<a id="…">`.
pub fn anchors(page: &str) -> Vec<String> {
    let code = blocks(page);
    let mut anchors: Vec<String> = Vec::new();
    let mut at = 0;
    for line in page.split_inclusive('\n') {
        let is_code = code.iter().any(|block| block.range.contains(&at));
        if let (false, Some(heading)) = (is_code, heading(line)) {
            let anchor = anchor(&without_links(heading));
            let same = anchors.iter().filter(|other| without_number(other) == anchor);
            let anchor = match same.count() {
                0 => anchor,
                n => format!("{anchor}-{n}"),
            };
            anchors.push(anchor);
        }
        at += line.len();
    }
    let stated = page.split("<a id=\"").skip(1);
    anchors.extend(stated.filter_map(|rest| Some(rest.split_once('"')?.0.to_owned())));
    anchors
}

/// Returns the text after the signs of a heading.
fn heading(line: &str) -> Option<&str> {
    let text = line.trim_start_matches('#');
    let is_heading = text.len() < line.len() && text.starts_with(' ');
    is_heading.then(|| text.trim())
}

/// Removes the number at the end of the anchor of a repeated heading.
fn without_number(anchor: &str) -> &str {
    match anchor.rsplit_once('-') {
        Some((before, number)) if number.parse::<usize>().is_ok() => before,
        _ => anchor,
    }
}

/// Replaces the links in a text by their words.
fn without_links(text: &str) -> String {
    let mut words = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("](") {
        words += &before.replacen('[', "", 1);
        rest = after.split_once(')').map_or("", |(_, after)| after);
    }
    words + rest
}
