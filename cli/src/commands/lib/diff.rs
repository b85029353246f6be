use std::fmt::{Display, Formatter};
use std::path::Path;

use clap::Args;
use htex_author::TextureDifference;
use htex_base::finding::plain;
use htex_format::Asset;
use htex_format::library::{Entry, Library, LibraryDifference, LibraryFile};
use serde::Serialize;

use super::LibraryArg;
use crate::differences;
use crate::failure::{Exit, Failure, Result, for_file};
use crate::output::{print, show};
use crate::progress::bar;

/// Compare the textures of two libraries by name and hash; exit status 1 if they differ.
///
/// Prints `-` before a texture that only the first library has, `+` before a texture that only the
/// second library has, and `~` before a texture that differs between the two libraries. With
/// --details, the command also prints `>` before a texture that differs only in its name, and says
/// what differs in each changed texture.
#[derive(Args)]
pub(crate) struct Diff {
    /// Path or URI of the first library
    #[arg(value_parser = LibraryArg::parser())]
    a: LibraryArg,

    /// Path or URI of the second library
    #[arg(value_parser = LibraryArg::parser())]
    b: LibraryArg,

    /// Also say what differs: metadata, conditions, models, and the spectra of the models
    #[arg(long)]
    details: bool,

    /// Print the details as Markdown, e.g. for a changelog
    #[arg(long, requires = "details", conflicts_with = "json")]
    markdown: bool,

    /// With --details, fail only if the felt difference of a texture is above this limit, in
    /// decibels, in a third-octave band or in all bands together
    #[arg(long, value_name = "felt=DB", requires = "details", value_parser = felt_limit)]
    fail_on: Option<f64>,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The names of textures that differ.
#[derive(Default, Serialize)]
struct Differences {
    only_in_a: Vec<String>,
    only_in_b: Vec<String>,
    changed: Vec<String>,
}

/// What differs.
#[derive(Default, Serialize)]
struct Details {
    removed: Vec<String>,
    added: Vec<String>,
    /// Textures with another name.
    renamed: Vec<Renamed>,
    changed: Vec<Changed>,
}

#[derive(Serialize)]
struct Renamed {
    from: String,
    to: String,
}

/// A texture that differs, and how.
#[derive(Serialize)]
struct Changed {
    name: String,
    #[serde(flatten)]
    difference: TextureDifference,
}

impl Diff {
    pub(crate) fn run(self) -> Result {
        let (a, b) = (self.a.open()?, self.b.open()?);
        let (file_a, file_b) = (self.a.shown(), self.b.shown());
        let of = |file: &Path| {
            let file = file.to_owned();
            move |error| Failure::from(error).in_file(&file)
        };
        let found = LibraryDifference::between(&a, &b, of(&file_a), of(&file_b))?;
        if !self.details {
            let differences = Differences::new(found);
            show(&differences, self.json)?;
            return Ok(Exit::ok_if(differences.is_empty()));
        }
        let details = self.details(&a, &b, found)?;
        if self.markdown {
            print(&details.markdown())?;
        } else {
            show(&details, self.json)?;
        }
        Ok(Exit::ok_if(match self.fail_on {
            None => details.is_empty(),
            Some(limit) => !details.changed.iter().any(|changed| changed.is_above(limit)),
        }))
    }

    fn details(
        &self,
        a: &Library<LibraryFile>,
        b: &Library<LibraryFile>,
        found: LibraryDifference,
    ) -> Result<Details> {
        let LibraryDifference { removed, added, renamed, changed } = found.find_renamed();
        let named = |entries: Vec<Entry>| entries.into_iter().map(|entry| entry.name).collect();
        let renamed = renamed.into_iter();
        let mut details = Details {
            removed: named(removed),
            added: named(added),
            renamed: renamed.map(|(a, b)| Renamed { from: a.name, to: b.name }).collect(),
            changed: Vec::new(),
        };
        let bar = bar(changed.len() as u64);
        for (of_a, of_b) in changed {
            let open = |library: &Library<LibraryFile>, argument: &LibraryArg, entry: &Entry| {
                let bytes = library.read(entry).map_err(for_file(&argument.shown()))?;
                let asset = Asset::from_bytes(&bytes);
                let asset =
                    asset.map_err(|error| Failure::from(error).in_file(&argument.shown()))?;
                Ok::<_, Failure>(htex::Texture::new(asset).with_embedded())
            };
            let (first, second) = (open(a, &self.a, &of_a)?, open(b, &self.b, &of_b)?);
            let difference = TextureDifference::new(&first, &second)
                .map_err(|error| Failure::Other(format!("{}: {error}", plain(&of_a.name))))?;
            details.changed.push(Changed { name: of_a.name, difference });
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(details)
    }
}

/// Reads `felt=DB`.
fn felt_limit(text: &str) -> Result<f64, String> {
    let number = text.strip_prefix("felt=").and_then(|text| text.parse().ok());
    let number = number.filter(|limit: &f64| limit.is_finite() && *limit >= 0.0);
    number.ok_or_else(|| "give felt= and decibels, such as felt=1.6".to_owned())
}

impl Differences {
    fn new(found: LibraryDifference) -> Self {
        let named = |entries: Vec<Entry>| entries.into_iter().map(|entry| entry.name).collect();
        Self {
            only_in_a: named(found.removed),
            only_in_b: named(found.added),
            changed: found.changed.into_iter().map(|(a, _)| a.name).collect(),
        }
    }

    fn is_empty(&self) -> bool {
        self.only_in_a.is_empty() && self.only_in_b.is_empty() && self.changed.is_empty()
    }
}

impl Display for Differences {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        for (sign, names) in [('-', &self.only_in_a), ('+', &self.only_in_b), ('~', &self.changed)]
        {
            names.iter().try_for_each(|name| writeln!(f, "{sign} {name}"))?;
        }
        Ok(())
    }
}

impl Changed {
    fn is_above(&self, limit_db: f64) -> bool {
        self.difference.felt().is_some_and(|felt| {
            felt.largest_error_db.abs() > limit_db || felt.total_error_db.abs() > limit_db
        })
    }

    /// Returns one line for each difference.
    fn lines(&self) -> Vec<String> {
        let lines = differences::lines(&self.difference);
        // Such as another compression, or another provenance.
        if lines.is_empty() { vec!["only its bytes".to_owned()] } else { lines }
    }
}

impl Details {
    fn is_empty(&self) -> bool {
        self.removed.is_empty()
            && self.added.is_empty()
            && self.renamed.is_empty()
            && self.changed.is_empty()
    }

    fn markdown(&self) -> String {
        let mut parts = Vec::new();
        let mut part = |title: &str, lines: Vec<String>| {
            if !lines.is_empty() {
                parts.push(format!("### {title}\n\n{}\n", lines.join("\n")));
            }
        };
        let named = |names: &[String]| names.iter().map(|name| format!("- `{name}`")).collect();
        part("Added", named(&self.added));
        part("Removed", named(&self.removed));
        let renamed = self.renamed.iter();
        part(
            "Renamed",
            renamed.map(|Renamed { from, to }| format!("- `{from}` → `{to}`")).collect(),
        );
        let changed = self.changed.iter().flat_map(|changed| {
            let lines = changed.lines().into_iter().map(|line| format!("  - {line}"));
            std::iter::once(format!("- `{}`", changed.name)).chain(lines)
        });
        part("Changed", changed.collect());
        parts.join("\n")
    }
}

impl Display for Details {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        for (sign, names) in [('-', &self.removed), ('+', &self.added)] {
            names.iter().try_for_each(|name| writeln!(f, "{sign} {name}"))?;
        }
        for Renamed { from, to } in &self.renamed {
            writeln!(f, "> {from} → {to}")?;
        }
        for changed in &self.changed {
            writeln!(f, "~ {}", changed.name)?;
            changed.lines().iter().try_for_each(|line| writeln!(f, "    {line}"))?;
        }
        Ok(())
    }
}
