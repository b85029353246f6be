use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};

use clap::Args;
use htex_base::finding::plain;
use htex_format::library::LibrarySummary;
use htex_format::signing::SignedContent;
use serde::Serialize;

use super::LibraryArg;
use super::listing::range;
use crate::assets::short_name;
use crate::failure::{Result, for_file};
use crate::keys::{Signer, signer_at};
use crate::output::show;

/// Show what a library says about itself, and summarize its textures
///
/// The command reads only the index of the library.
#[derive(Args)]
pub(crate) struct Info {
    /// Path or URI of the library
    #[arg(value_parser = LibraryArg::parser())]
    library: LibraryArg,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// A library, summarized.
#[derive(Serialize)]
struct LibraryInfo {
    file: String,
    #[serde(flatten)]
    summary: LibrarySummary,
    /// Who signed the library; left out if there is no signature beside it.
    #[serde(skip_serializing_if = "Option::is_none")]
    signer: Option<Signer>,
}

impl Info {
    pub(crate) fn run(self) -> Result {
        let file = self.library.shown();
        let _waiting = self.library.waiting()?;
        let library = self.library.open()?;
        let content = |_: &_| SignedContent::library(&library).map_err(for_file(&file));
        let signer = signer_at(&self.library.0, content)?;
        let summary = library.summary().map_err(for_file(&file))?;
        show(&LibraryInfo { file: file.display().to_string(), summary, signer }, self.json)
    }
}

/// Largest number of words in a line of text.
const MOST_WORDS: usize = 12;

impl Display for LibraryInfo {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let summary = &self.summary;
        let metadata = &summary.metadata;
        let version = metadata.version.as_deref().map(|version| format!(" {}", plain(version)));
        let date = metadata.date.as_deref().map(|date| format!(", {date}"));
        writeln!(
            f,
            "{}{}{}",
            plain(&summary.name),
            version.unwrap_or_default(),
            date.unwrap_or_default()
        )?;
        for line in metadata.description.as_deref().unwrap_or_default().lines() {
            writeln!(f, "  {}", plain(line))?;
        }
        let mut line = |name: &str, text: &str| match text {
            "" => Ok(()),
            text => writeln!(f, "{name:12} {}", plain(text)),
        };
        line("signature", &self.signer.as_ref().map(ToString::to_string).unwrap_or_default())?;
        line("authors", &metadata.authors.join(", "))?;
        line("homepage", metadata.homepage.as_deref().unwrap_or_default())?;
        line("source", metadata.source.as_deref().unwrap_or_default())?;
        let changelog = metadata.changelog.as_deref().unwrap_or_default();
        line("changelog", changelog.lines().next().unwrap_or_default())?;
        line(
            "textures",
            &format!(
                "{}, {} bytes; {} bytes in the library",
                summary.textures, summary.texture_bytes, summary.bytes
            ),
        )?;
        line("licences", &counted(&summary.licenses, str::to_owned))?;
        line("quantities", &counted(&summary.quantities, str::to_owned))?;
        line("models", &counted(&summary.models, |id| short_name(id).to_owned()))?;
        line("contacts", &counted(&summary.contacts, str::to_owned))?;
        line("tags", &counted(&summary.tags, str::to_owned))?;
        line("speeds", &range(summary.conditions.speed_mm_s, "mm/s"))?;
        line("forces", &range(summary.conditions.force_n, "N"))?;
        line("BLAKE3", &summary.blake3)
    }
}

/// Returns words with their counts, the most frequent one first.
fn counted(counts: &BTreeMap<String, u64>, shown: impl Fn(&str) -> String) -> String {
    let mut all: Vec<(&String, &u64)> = counts.iter().collect();
    all.sort_by_key(|(word, count)| (std::cmp::Reverse(**count), (*word).clone()));
    let words = all.iter().take(MOST_WORDS);
    let mut words: Vec<String> =
        words.map(|(word, count)| format!("{} {count}", shown(word))).collect();
    if all.len() > MOST_WORDS {
        words.push(format!("and {} more", all.len() - MOST_WORDS));
    }
    words.join(", ")
}
