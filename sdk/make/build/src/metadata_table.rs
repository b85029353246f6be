//! Tables of metadata: a CSV file with a row for each texture.

use std::collections::BTreeMap;
use std::path::Path;

use htex_author::settings::{GivenLaw, Metadata};
use htex_base::files::{AtFile, read_regular};
use serde_json::{Map, Value};

use crate::BuildError;
use crate::error::at_place;

/// Largest table, bytes.
const MOST_BYTES: u64 = 64 << 20;
/// The column with the names of the textures.
const TEXTURE: &str = "texture";

/// Metadata by the names of textures.
#[derive(Debug, Default)]
pub(crate) struct MetadataTable {
    rows: BTreeMap<String, Metadata>,
}

impl MetadataTable {
    /// Reads a table. An empty cell leaves the texture as it is. Several tags in a cell are
    /// separated by `;`.
    pub(crate) fn read(file: &Path) -> Result<Self, BuildError> {
        let text = read_regular(file, MOST_BYTES).reading(file)?;
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(&text[..]);
        let headers = reader.headers().map_err(at_place(file.display()))?.clone();
        let wrong = |problem: String| BuildError::at_place(file.display(), problem);
        if !headers.iter().any(|name| name == TEXTURE) {
            return Err(wrong(format!("it has no column `{TEXTURE}` with the names of textures")));
        }
        let is_known = |name: &&str| *name == TEXTURE || Metadata::NAMES.contains(name);
        if let Some(name) = headers.iter().find(|name| !is_known(name)) {
            let names = Metadata::NAMES.join(", ");
            return Err(wrong(format!(
                "there is no column `{name}`; there are {TEXTURE}, {names}"
            )));
        }
        let mut rows = BTreeMap::new();
        for row in reader.records() {
            let row = row.map_err(at_place(file.display()))?;
            let line = row.position().map_or(0, csv::Position::line);
            let place = format!("{}, line {line}", file.display());
            let cells = headers
                .iter()
                .zip(&row)
                .filter(|(name, cell)| *name != TEXTURE && !cell.is_empty());
            let values: Map<String, Value> = cells
                .map(|(name, cell)| Ok((name.to_owned(), metadata_value(name, cell)?)))
                .collect::<Result<_, String>>()
                .map_err(at_place(&place))?;
            let metadata: Metadata =
                serde_json::from_value(Value::Object(values)).map_err(at_place(&place))?;
            metadata.check().map_err(at_place(&place))?;
            let name = headers.iter().zip(&row).find(|(name, _)| *name == TEXTURE);
            let name = name.map_or("", |(_, name)| name).to_owned();
            if rows.insert(name.clone(), metadata).is_some() {
                return Err(BuildError::at_place(place, format!("{name} has another row already")));
            }
        }
        Ok(Self { rows })
    }

    /// Takes out the row of a texture.
    pub(crate) fn take(&mut self, name: &str) -> Option<Metadata> {
        self.rows.remove(name)
    }

    /// Returns the name of a row that was not taken out.
    pub(crate) fn unused(&self) -> Option<&str> {
        self.rows.keys().next().map(String::as_str)
    }
}

/// Parses the text of one metadata entry. Several tags are separated by `;` or `,`.
///
/// # Errors
/// Returns an error if the text of a law is malformed.
pub fn metadata_value(name: &str, text: &str) -> Result<Value, String> {
    match name {
        "tags" => Ok(text.split([';', ',']).map(|tag| Value::from(tag.trim())).collect()),
        "law" => {
            let law: GivenLaw = text.parse()?;
            serde_json::to_value(law).map_err(|error| error.to_string())
        }
        _ => Ok(Value::from(text)),
    }
}
