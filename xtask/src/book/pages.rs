//! The pages of the book: the pages in `docs/SUMMARY.md`, and the pages to which they link.

use std::collections::{BTreeSet, VecDeque};
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result, ensure};
use fs_err as fs;

use crate::markdown::{is_address, links};
use crate::places::workspace;

/// The file that defines the order of the pages.
const SUMMARY: &str = "docs/SUMMARY.md";

/// Copies the pages, and the files to which they link, into a folder. They keep their paths in the
/// repository. Returns the number of pages.
pub(super) fn assemble(source: &Path) -> Result<usize> {
    let root = fs::canonicalize(workspace())?;
    let summary = fs::read_to_string(root.join(SUMMARY))?;
    let mut assembly = Assembly::new(root, source.to_owned());
    let (text, _) = assembly.with_links(Path::new(SUMMARY), &summary)?;
    let listed = assembly.waiting.len();
    while let Some(page) = assembly.waiting.pop_front() {
        assembly.copy_page(&page)?;
    }
    let further = assembly.pages[listed..].iter();
    let further: Vec<String> = further.map(|page| assembly.entry(page)).collect::<Result<_>>()?;
    let more = format!("\n# Beside these\n\n{}", further.concat());
    fs::write(source.join("SUMMARY.md"), text + &more)?;
    Ok(assembly.pages.len())
}

/// The pages that were found so far. Paths are relative to the repository.
struct Assembly {
    root: PathBuf,
    source: PathBuf,
    /// The pages in the order in which they were found.
    pages: Vec<PathBuf>,
    /// Pages that have not been copied yet.
    waiting: VecDeque<PathBuf>,
    /// Linked folders that have no page. Each gets a page that lists its files.
    folders: BTreeSet<PathBuf>,
}

impl Assembly {
    fn new(root: PathBuf, source: PathBuf) -> Self {
        Self { root, source, pages: Vec::new(), waiting: VecDeque::new(), folders: BTreeSet::new() }
    }

    fn copy_page(&mut self, page: &Path) -> Result<()> {
        let text = match page.parent().filter(|folder| self.folders.contains(*folder)) {
            Some(folder) if page.ends_with("README.md") => self.list(folder)?,
            _ => fs::read_to_string(self.root.join(page))?,
        };
        let (_, text) = self.with_links(page, &text)?;
        self.write(page, text.as_bytes())
    }

    /// Adds the files to which a page links. Returns the text of the page twice: with links
    /// relative to the top of the book, and with links relative to the page's own folder.
    fn with_links(&mut self, page: &Path, text: &str) -> Result<(String, String)> {
        let mut found = Vec::new();
        for range in links(text) {
            let link = &text[range.clone()];
            let path = link.split('#').next().unwrap_or_default();
            if !is_address(link) && !path.is_empty() {
                let path = range.start..range.start + path.len();
                found.push((path.clone(), self.found(page, &text[path])?));
            }
        }
        let (mut from_top, mut in_folder) = (text.to_owned(), text.to_owned());
        // Replaced from the end, so that the ranges before the replaced one stay valid.
        for (range, linked) in found.into_iter().rev() {
            from_top.replace_range(range.clone(), &linked.display().to_string());
            let path = text[range.clone()].trim_end_matches('/');
            if self.root.join(parent(page)).join(path).is_dir() {
                in_folder.replace_range(range, &format!("{path}/README.md"));
            }
        }
        Ok((from_top, in_folder))
    }

    /// Adds the file that a page links to, and returns its path. For a folder it returns the
    /// folder's page.
    fn found(&mut self, page: &Path, link: &str) -> Result<PathBuf> {
        let place = || format!("{}: {link}", page.display());
        let mut linked =
            normal(&parent(page).join(link.replace("%20", " "))).with_context(place)?;
        let is_folder = self.root.join(&linked).is_dir();
        if is_folder {
            if !self.root.join(&linked).join("README.md").exists() {
                self.folders.insert(linked.clone());
            }
            linked = linked.join("README.md");
        } else {
            ensure!(self.root.join(&linked).is_file(), "{}: there is no such file", place());
        }
        if linked.extension().is_some_and(|extension| extension == "md") {
            if !self.pages.contains(&linked) {
                self.pages.push(linked.clone());
                self.waiting.push_back(linked.clone());
            }
        } else {
            let bytes = fs::read(self.root.join(&linked))?;
            self.write(&linked, &bytes)?;
        }
        Ok(linked)
    }

    /// Returns a page that lists the files in a folder.
    fn list(&self, folder: &Path) -> Result<String> {
        let mut names = Vec::new();
        for entry in fs::read_dir(self.root.join(folder))? {
            let entry = entry?;
            if entry.path().is_file() {
                names.push(entry.file_name().to_string_lossy().into_owned());
            }
        }
        names.sort();
        let lines = names.iter().map(|name| format!("- [{name}]({})\n", name.replace(' ', "%20")));
        Ok(format!("# {}\n\n{}", folder.display(), lines.collect::<String>()))
    }

    /// Returns the summary line for a page that the summary does not list.
    fn entry(&self, page: &Path) -> Result<String> {
        let text = fs::read_to_string(self.source.join(page))?;
        let title = text.lines().find_map(|line| line.strip_prefix("# "));
        let title = title
            .map_or_else(|| page.display().to_string(), |title| title.replace(['[', ']', '`'], ""));
        Ok(format!("- [{title}]({})\n", page.display()))
    }

    fn write(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        let to = self.source.join(path);
        fs::create_dir_all(parent(&to))?;
        Ok(fs::write(to, bytes)?)
    }
}

fn parent(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Resolves `.` and `..` in a path. A path outside the repository is an error.
fn normal(path: &Path) -> Result<PathBuf> {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => ensure!(normal.pop(), "it leads out of the repository"),
            part => normal.push(part),
        }
    }
    Ok(normal)
}
