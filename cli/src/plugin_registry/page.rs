//! The page of a registry.

use htex_author::report::{Page, code_block, link, list, paragraph, preview};
use htex_build::registry::Entry;

/// Returns a page with all entries. It loads nothing but the previews.
pub(crate) fn page(entries: &[Entry]) -> String {
    let mut page = Page::new("Plugins of htex");
    page.html(&paragraph("This command installs one of them:"));
    page.html(&code_block("htex plugin install ID --registry ADDRESS"));
    for entry in entries {
        let newest = entry.versions.iter().max_by(|a, b| a.version.cmp(&b.version));
        let Some(newest) = newest else { continue };
        page.heading(&format!("{} {}", entry.id, newest.version));
        page.html(&paragraph(&entry.summary));
        if let Some(path) = &entry.preview {
            page.html(&preview(path));
        }
        let platforms: Vec<&str> = newest.files.iter().map(|file| &*file.platform).collect();
        page.html(&list(&[
            format!("kind: {}", entry.kind.name()),
            format!("platforms: {}", platforms.join(", ")),
            format!("licence: {}", entry.license),
            format!("key: {}", entry.key),
        ]));
        page.html(&link(&entry.source));
    }
    page.render()
}
