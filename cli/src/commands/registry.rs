use std::fmt::{Display, Formatter};
use std::path::PathBuf;

use clap::Args;
use htex_base::finding::plain;
use htex_build::registry::{Entry, PluginKind};
use serde::Serialize;

use super::plugin::first_bad;
use super::subcommands;
use crate::failure::{Exit, Failure, Result};
use crate::located;
use crate::output::{print, print_json, show, shown, write_file};
use crate::plugin_registry::add::{Added, Texts, add};
use crate::plugin_registry::check::{entries, local_files, owners, problems};
use crate::plugin_registry::page::page;

/// Make or check a registry of plugins
///
/// A registry is a folder, in a repository or on a web server, from which `htex plugin install ID
/// --registry DIR` installs plugins. It has a file plugins/ID.toml for each plugin.
#[derive(Args)]
pub(crate) struct Registry {
    #[command(subcommand)]
    command: Command,
}

subcommands! {
    Command {
        Add(Add),
        Check(Check),
        Page(Page),
    }
}

impl Registry {
    pub(crate) fn run(self) -> Result {
        self.command.run()
    }
}

/// Add a signed plugin to a registry
///
/// Copies the plugin and its signature into the registry, and writes the plugin's entry or adds the
/// version to it. The id and the version come from the signature (`htex sign`), and the summary
/// comes from the plugin's descriptor (`htex plugin export`). If the registry already has an entry
/// of this id, the plugin must be signed with the key of this entry.
#[derive(Args)]
pub(crate) struct Add {
    /// Folder of the registry
    #[arg(value_name = "DIR")]
    registry: PathBuf,

    /// The plugin: a model or a device, with its signature FILE.sig beside it
    #[arg(value_name = "FILE")]
    plugin: PathBuf,

    /// What the plugin does, in one sentence [default: the summary of its descriptor]
    #[arg(long, value_name = "TEXT")]
    summary: Option<String>,

    /// Licence of the plugin, as an SPDX expression; for a new entry
    #[arg(long, value_name = "SPDX")]
    license: Option<String>,

    /// Address of the plugin's source code; for a new entry
    #[arg(long, value_name = "URL")]
    source: Option<String>,
}

impl Add {
    pub(crate) fn run(self) -> Result {
        let Self { registry, plugin, summary, license, source } = self;
        let added = add(&registry, &plugin, &Texts { summary, license, source })?;
        let Added { entry, id, version, platform } = added;
        print(&format!("{}: {id} {version} for {platform}\n", shown(&entry)))?;
        Ok(Exit::SUCCESS)
    }
}

/// Check the entries of a registry, and the files in it
///
/// Checks each entry's keys and licence, and the BLAKE3 hash and the signature of each file in the
/// registry. Also runs the checks of `htex plugin check` on each model that is a WASM module. The
/// exit status is 1 if something is wrong.
#[derive(Args)]
pub(crate) struct Check {
    /// Folder of the registry
    #[arg(value_name = "DIR")]
    registry: PathBuf,

    /// Folder with an earlier state of the registry. Each id must have the same key as in this
    /// earlier state
    #[arg(long, value_name = "DIR")]
    since: Option<PathBuf>,

    /// Check only these ids
    #[arg(long, value_name = "ID")]
    only: Vec<String>,

    /// Also run the checker on native libraries for this machine. A native library can do
    /// everything that you can
    #[arg(long)]
    run_native: bool,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct RegistryReport {
    ok: bool,
    entries: Vec<EntryReport>,
}

#[derive(Serialize)]
struct EntryReport {
    file: PathBuf,
    id: Option<String>,
    problems: Vec<String>,
}

impl Check {
    pub(crate) fn run(self) -> Result {
        let earlier = self.since.as_deref().map(owners).transpose()?;
        let mut reports = Vec::new();
        for (file, entry) in entries(&self.registry)? {
            let (id, problems) = match entry {
                Err(problem) => (None, vec![problem]),
                Ok(entry) if !self.only.is_empty() && !self.only.contains(&entry.id) => continue,
                Ok(entry) => {
                    let mut found = problems(&self.registry, &entry, earlier.as_ref());
                    if found.is_empty() {
                        found = self.run_checker(&entry)?;
                    }
                    (Some(entry.id), found)
                }
            };
            reports.push(EntryReport { file, id, problems });
        }
        let ok = reports.iter().all(|report| report.problems.is_empty());
        let report = RegistryReport { ok, entries: reports };
        if self.json {
            print_json(&report)?;
        } else {
            print(&report.to_string())?;
        }
        Ok(Exit::ok_if(ok))
    }

    /// Runs the checker on the files of an entry, and says what it finds.
    fn run_checker(&self, entry: &Entry) -> Result<Vec<String>> {
        let own = htex_build::registry::own_platform();
        let mut problems = Vec::new();
        for version in &entry.versions {
            for file in local_files(&version.files) {
                let runs = match &*file.platform {
                    "wasm" => entry.kind == PluginKind::Model,
                    platform => self.run_native && platform == own,
                };
                if !runs {
                    continue;
                }
                let path = self.registry.join(&file.file);
                if let Some(problem) = first_bad(entry.kind, &path, None)? {
                    problems.push(format!("{}, {}: {problem}", version.version, file.file));
                }
            }
        }
        Ok(problems)
    }
}

impl Display for RegistryReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        for EntryReport { file, id, problems } in &self.entries {
            let name = id.as_deref().map_or_else(|| shown(file), str::to_owned);
            if problems.is_empty() {
                writeln!(f, "{}: ok", plain(&name))?;
            }
            for problem in problems {
                writeln!(f, "{}: {}", plain(&name), plain(problem))?;
            }
        }
        let bad = self.entries.iter().filter(|entry| !entry.problems.is_empty()).count();
        writeln!(f, "{} plugins, {bad} with problems", self.entries.len())
    }
}

/// Write the page that lists all plugins of a registry
#[derive(Args)]
pub(crate) struct Page {
    /// Folder of the registry
    #[arg(value_name = "DIR")]
    registry: PathBuf,

    /// The page to write
    #[arg(short, long, value_name = "HTML", value_parser = located::OUTPUT)]
    output: PathBuf,
}

impl Page {
    pub(crate) fn run(self) -> Result {
        let mut all = Vec::new();
        for (file, entry) in entries(&self.registry)? {
            all.push(
                entry.map_err(|problem| Failure::Other(format!("{}: {problem}", shown(&file))))?,
            );
        }
        write_file(&self.output, page(&all).as_bytes())?;
        show(&Written { plugins: all.len(), page: self.output }, false)
    }
}

#[derive(Serialize)]
struct Written {
    page: PathBuf,
    plugins: usize,
}

impl Display for Written {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}: {} plugins", shown(&self.page), self.plugins)
    }
}
