//! Metadata are edited by writing the asset again. An asset with parts that this version would not write again, such as
//! entries that nothing refers to, is refused.

use std::path::PathBuf;

use clap::Args;
use htex_format::Limits;
use serde_json::Value;

use crate::assets::AssetSummary;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::metadata::{MetadataArgs, checked};
use crate::output::{print, print_json, write_file};
use crate::outputs::check_outputs;
use crate::shown::shown;

/// Change an asset's metadata without a new fit.
///
/// Metadata that is not given is kept; an empty text (--author "") removes the entry, and --tag replaces all tags.
/// Parameters, recorded spectra and embedded models, with their signatures, are kept byte by byte.
#[derive(Args)]
pub(crate) struct Edit {
    /// The asset
    #[arg(value_parser = located::ASSET)]
    asset: PathBuf,

    /// The asset to write [default: the asset itself]
    #[arg(short, long, value_name = "HTEX", value_parser = located::OUTPUT)]
    output: Option<PathBuf>,

    #[command(flatten)]
    metadata: MetadataArgs,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl Edit {
    pub(crate) fn run(mut self) -> Result<Exit, Failure> {
        let metadata = std::mem::take(&mut self.metadata).given();
        if metadata.is_empty() {
            let sentence = "nothing to change: give at least one of the metadata, such as --author";
            return Err(Failure::Usage(sentence.to_owned()));
        }
        if self.output.is_none() && located::is_copy(&self.asset) {
            let file = located::named(&shown(&self.asset));
            return Err(Failure::Usage(format!(
                "{file}: an asset elsewhere is not replaced; name another file to write by -o FILE"
            )));
        }
        check_outputs(self.output.as_deref(), [self.asset.as_path()])?;
        checked(&metadata)?;
        let mut asset = htex_format::Asset::open(&self.asset)
            .map_err(|error| Failure::asset(&self.asset, error))?;
        self.check_kept(&asset)?;
        metadata.apply(&mut asset.manifest);
        let output = self.output.as_ref().unwrap_or(&self.asset);
        let bytes = asset.to_bytes().map_err(htex_author::AuthorError::from)?;
        write_file(output, &bytes)?;
        let summary = AssetSummary::new(output, bytes.len() as u64, &asset);
        if self.json {
            print_json(&summary)?;
        } else {
            print(&summary.to_text())?;
        }
        Ok(Exit::SUCCESS)
    }

    /// Refuses an asset that would lose data: entries that its manifest does not name, and keys inside it
    /// that this program does not know.
    fn check_kept(&self, asset: &htex_format::Asset) -> Result<(), Failure> {
        let bytes = std::fs::read(&self.asset).map_err(|e| Failure::read(&self.asset, e))?;
        let limits = Limits::default();
        let report = htex_format::validate(&bytes, &limits);
        let unnamed = report.findings.iter();
        let unnamed = unnamed.filter(|finding| finding.code == "ENTRY_UNREFERENCED");
        let mut lost: Vec<String> = unnamed.map(|finding| finding.message.clone()).collect();
        let written = serde_json::to_value(&asset.manifest).unwrap_or_default();
        if let Some(read) = htex_format::manifest_json(&bytes, &limits) {
            lost_keys(&read, &written, "", &mut lost);
        }
        if lost.is_empty() {
            return Ok(());
        }
        let (file, lost) = (shown(&self.asset), lost.join("; "));
        Err(Failure::Other(format!(
            "{file}: an edit would not keep all of it: {lost}; edit it with the program that wrote it"
        )))
    }
}

/// Adds the pointers of keys that were read and are not written. Empty values and defaults are left out on purpose.
fn lost_keys(read: &Value, written: &Value, pointer: &str, lost: &mut Vec<String>) {
    match (read, written) {
        (Value::Object(read), Value::Object(written)) => {
            for (key, value) in read {
                let at = format!("{pointer}/{key}");
                match written.get(key) {
                    Some(kept) => lost_keys(value, kept, &at, lost),
                    None if is_left_out(value) => {}
                    None => lost.push(format!("the key {at}")),
                }
            }
        }
        (Value::Array(read), Value::Array(written)) => {
            for (i, (value, kept)) in read.iter().zip(written).enumerate() {
                lost_keys(value, kept, &format!("{pointer}/{i}"), lost);
            }
        }
        _ => {}
    }
}

fn is_left_out(value: &Value) -> bool {
    match value {
        Value::Object(map) => map.values().all(is_left_out),
        Value::Array(list) => list.is_empty(),
        Value::String(text) => text.is_empty() || text == "f64",
        Value::Bool(is) => !is,
        _ => false,
    }
}
