use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};

use clap::Args;
use htex_base::finding::plain;
use htex_format::library::{Conditions, Interval, LibraryMetadata};
use serde::Serialize;

use super::LibraryArg;
use super::listing::range;
use crate::assets::short_name;
use crate::failure::{Result, for_file};
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
    name: String,
    #[serde(flatten)]
    metadata: LibraryMetadata,
    /// Version of the library's format.
    format: String,
    /// Hash of the index, which names the library.
    blake3: String,
    textures: u64,
    bytes: u64,
    /// Bytes of all textures together, if they were files.
    texture_bytes: u64,
    #[serde(flatten)]
    conditions: Conditions,
    #[serde(flatten)]
    counts: Counts,
}

/// Number of textures of each licence, quantity, model, contact and tag.
#[derive(Default, Serialize)]
struct Counts {
    licenses: BTreeMap<String, u64>,
    quantities: BTreeMap<String, u64>,
    models: BTreeMap<String, u64>,
    contacts: BTreeMap<String, u64>,
    tags: BTreeMap<String, u64>,
}

impl Info {
    pub(crate) fn run(self) -> Result {
        let file = self.library.shown();
        let _waiting = self.library.waiting()?;
        let library = self.library.open()?;
        let index = library.index();
        let mut info = LibraryInfo {
            file: file.display().to_string(),
            name: library.name().to_owned(),
            metadata: library.metadata().clone(),
            format: format!("1.{}", index.minor_version()),
            blake3: blake3::Hash::from_bytes(index.blake3()).to_string(),
            textures: library.len(),
            bytes: index.file_bytes(),
            texture_bytes: 0,
            conditions: Conditions::default(),
            counts: Counts::default(),
        };
        for entry in library.entries() {
            let entry = entry.map_err(for_file(&file))?;
            info.texture_bytes += entry.bytes;
            info.conditions.speed_mm_s =
                widest(info.conditions.speed_mm_s, entry.conditions.speed_mm_s);
            info.conditions.force_n = widest(info.conditions.force_n, entry.conditions.force_n);
            let counts = &mut info.counts;
            if let Some(quantity) = entry.quantity {
                let license = entry.license.unwrap_or_else(|| "none".to_owned());
                *counts.licenses.entry(license).or_default() += 1;
                *counts.quantities.entry(quantity.name().to_owned()).or_default() += 1;
            }
            *counts.contacts.entry(entry.contact.name().to_owned()).or_default() += 1;
            for (texts, all) in [(entry.models, &mut counts.models), (entry.tags, &mut counts.tags)]
            {
                for text in texts {
                    *all.entry(text).or_default() += 1;
                }
            }
        }
        show(&info, self.json)
    }
}

/// Returns the smallest interval that contains both.
fn widest(a: Option<Interval>, b: Option<Interval>) -> Option<Interval> {
    match (a, b) {
        (Some(a), Some(b)) => Some(Interval { min: a.min.min(b.min), max: a.max.max(b.max) }),
        (a, b) => a.or(b),
    }
}

/// Largest number of words in a line of text.
const MOST_WORDS: usize = 12;

impl Display for LibraryInfo {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { metadata, counts, .. } = self;
        let version = metadata.version.as_deref().map(|version| format!(" {}", plain(version)));
        let date = metadata.date.as_deref().map(|date| format!(", {date}"));
        writeln!(
            f,
            "{}{}{}",
            plain(&self.name),
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
        line("authors", &metadata.authors.join(", "))?;
        line("homepage", metadata.homepage.as_deref().unwrap_or_default())?;
        line("source", metadata.source.as_deref().unwrap_or_default())?;
        let changelog = metadata.changelog.as_deref().unwrap_or_default();
        line("changelog", changelog.lines().next().unwrap_or_default())?;
        line(
            "textures",
            &format!(
                "{}, {} bytes; {} bytes in the library",
                self.textures, self.texture_bytes, self.bytes
            ),
        )?;
        line("licences", &counted(&counts.licenses, str::to_owned))?;
        line("quantities", &counted(&counts.quantities, str::to_owned))?;
        line("models", &counted(&counts.models, |id| short_name(id).to_owned()))?;
        line("contacts", &counted(&counts.contacts, str::to_owned))?;
        line("tags", &counted(&counts.tags, str::to_owned))?;
        line("speeds", &range(self.conditions.speed_mm_s, "mm/s"))?;
        line("forces", &range(self.conditions.force_n, "N"))?;
        line("BLAKE3", &self.blake3)
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
