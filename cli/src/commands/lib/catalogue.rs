use std::fmt::{Display, Formatter};
use std::fs::File;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use clap::Args;
use htex_base::files::{AtFile, OwnFolder, read_regular};
use htex_build::{Report, Status};
use htex_format::library::Library;
use serde::Serialize;

use crate::failure::{Failure, Result, for_file};
use crate::located;
use crate::output::{OutputFile, show, shown};
use crate::shared;

/// The template of the catalogue's page, a file in the folder of the studio.
const PAGE: &str = "catalogue.html";
/// Largest page that is read, bytes.
const MOST_PAGE_BYTES: u64 = 64 << 20;
/// Largest report of a build that is read, bytes.
const MOST_REPORT_BYTES: u64 = 1 << 30;
/// Largest library that is put into the page itself, bytes.
const MOST_EMBEDDED: u64 = 2 << 20;
/// Number of textures that the page lists as left out of a build.
const MOST_LEFT_OUT: usize = 1000;

/// Make a catalogue of a library: a web page on which people search, see and play its textures
///
/// Writes the web page (DIR/index.html), and a copy of the library beside it. Each texture has its
/// own web address. The page reads only the parts of the library that it needs (HTTP range
/// requests). The web server must support such requests, and nearly all web servers do. If the
/// library is at most 2 MiB in size, the page also contains the library, so you can open the page
/// as a local file, without a web server.
///
/// The command fills a template of the page with the data of the library. `cargo xtask studio --out
/// DIR` builds this template.
#[derive(Args)]
pub(crate) struct Catalogue {
    /// The library
    #[arg(value_name = "LIBRARY", value_parser = located::RECORDING)]
    library: PathBuf,

    /// Folder for the catalogue
    #[arg(short, long, value_name = "DIR", value_parser = located::LOCAL_OUTPUT)]
    output: PathBuf,

    /// Address at which the library is published. The page then reads the library from there, and
    /// the library is not copied
    #[arg(long, value_name = "URL")]
    url: Option<String>,

    /// Report of the build that made the library (build-report.json). The catalogue then also lists
    /// the textures that the build left out, and the findings about recordings
    #[arg(long, value_name = "JSON", value_parser = located::RECORDING)]
    report: Option<PathBuf>,

    /// Folder of the template of the page [default: $HTEX_STUDIO, or ../share/htex/studio relative
    /// to the command]
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// What the page is told.
#[derive(Serialize)]
struct Options<'a> {
    library: &'a str,
    report: Option<BuildPage>,
}

/// The report of a build, as the page shows it.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct BuildPage {
    program: String,
    planned: usize,
    missing: usize,
    left_out: Vec<LeftOut>,
    findings: Vec<Finding>,
}

#[derive(Serialize)]
struct LeftOut {
    name: String,
    reasons: Vec<String>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Finding {
    code: String,
    severity: String,
    textures: usize,
    in_library: usize,
    first: Vec<String>,
}

/// The catalogue that was written.
#[derive(Serialize)]
struct Written {
    page: String,
    library: String,
    textures: u64,
    /// Whether the page contains the library. Such a page also works without a web server.
    embedded: bool,
}

impl Display for Written {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let textures = if self.textures == 1 { "texture" } else { "textures" };
        writeln!(f, "{}: {} {textures} of {}", self.page, self.textures, self.library)?;
        if self.embedded {
            return Ok(());
        }
        writeln!(f, "  a web server shows the page; from a disk, a browser cannot read the library")
    }
}

impl Catalogue {
    pub(crate) fn run(self) -> Result {
        let opened = Library::open(&self.library).map_err(for_file(&self.library))?;
        let bytes = opened.index().file_bytes();
        let report = self.report.as_deref().map(build_page).transpose()?;
        let find = |folder: &Path| Some(folder.join(PAGE)).filter(|page| page.is_file());
        let page = shared::page(self.folder.as_deref(), "the page of catalogues", find)?;
        let template = read_regular(&page, MOST_PAGE_BYTES).reading(&page)?;
        let template = String::from_utf8(template)
            .map_err(|_| Failure::Other(format!("{}: it is not UTF-8", shown(&page))))?;
        let (address, origin) = match &self.url {
            Some(url) => (url.clone(), Some(origin(url)?)),
            None => (encoded(&file_name(&self.library)), None),
        };
        let is_embedded = origin.is_none() && bytes <= MOST_EMBEDDED;
        let textures = if is_embedded {
            let bytes = read_regular(&self.library, MOST_EMBEDDED).reading(&self.library)?;
            STANDARD.encode(bytes)
        } else {
            String::new()
        };
        let title = if opened.name().is_empty() { "Textures" } else { opened.name() };
        let options = serde_json::to_string(&Options { library: &address, report })
            .map_err(|error| Failure::Other(error.to_string()))?;
        let filled =
            filled(&template, title, &options, &textures, origin.as_deref()).ok_or_else(|| {
                Failure::Other(format!(
                    "{}: it is not the page of catalogues of this version; build it again",
                    shown(&page)
                ))
            })?;
        let folder = OwnFolder::new(&self.output);
        // The page is written last, so that it never names a missing library.
        if origin.is_none() {
            copy(&self.library, &folder, Path::new(&file_name(&self.library)))?;
        }
        let page = OutputFile::Inside(&folder, Path::new("index.html"));
        page.write(filled.as_bytes())?;
        let written = Written {
            page: page.path().display().to_string(),
            library: title.to_owned(),
            textures: opened.len(),
            embedded: is_embedded,
        };
        show(&written, self.json)
    }
}

/// Fills in the template; `None` if the template lacks one of the places to fill in.
fn filled(
    template: &str,
    title: &str,
    options: &str,
    textures: &str,
    origin: Option<&str>,
) -> Option<String> {
    let title = title.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    // Inside a script element, only `<` could end the data.
    let options = options.replace('<', "\\u003c");
    let connects = format!("connect-src 'self' {}", origin.unwrap_or_default());
    let mut page = template.to_owned();
    let own = "connect-src 'self'";
    // The places are filled in from the last to the first. If a filled-in text contains the name of
    // another place, `find` still finds the real place, because it comes earlier.
    for (place, text) in [
        ("__OPTIONS__", &options[..]),
        ("__TEXTURES__", textures),
        ("__TITLE__", &title),
        (own, connects.trim_end()),
    ] {
        let at = page.find(place)?;
        page.replace_range(at..at + place.len(), text);
    }
    Some(page)
}

/// Copies a file into a folder, unless the file is already in this folder.
fn copy(from: &Path, folder: &OwnFolder, name: &Path) -> Result<()> {
    let to = OutputFile::Inside(folder, name);
    if let (Ok(a), Ok(b)) = (from.canonicalize(), to.path().canonicalize())
        && a == b
    {
        return Ok(());
    }
    let mut source = File::open(from).reading(from)?;
    Ok(to.replace(|file| std::io::copy(&mut source, file).map(|_| ()))?)
}

fn file_name(library: &Path) -> String {
    // A library that was downloaded keeps the name that it has at its URI.
    let shown = located::with_uris(&library.display().to_string());
    let path = shown
        .split_once("://")
        .map_or(&shown[..], |(_, path)| path.split(['?', '#']).next().unwrap_or_default());
    let name = Path::new(path).file_name().unwrap_or_default().to_string_lossy().into_owned();
    if name.to_ascii_lowercase().ends_with(".htexlib") { name } else { format!("{name}.htexlib") }
}

/// Returns a file name as a relative address.
fn encoded(name: &str) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte);
    name.bytes()
        .map(|byte| match byte {
            byte if is_plain(byte) => char::from(byte).to_string(),
            byte => format!("%{byte:02X}"),
        })
        .collect()
}

/// Returns the origin of the address of a library.
fn origin(url: &str) -> Result<String> {
    let wrong = || {
        Failure::Usage(format!("--url {url}: give the address of the library, http:// or https://"))
    };
    let (scheme, rest) = url.split_once("://").ok_or_else(wrong)?;
    let host = rest.split(['/', '?', '#']).next().unwrap_or_default();
    let is_host = |c: char| c.is_ascii_alphanumeric() || "-._:[]".contains(c);
    if !matches!(scheme, "http" | "https") || host.is_empty() || !host.chars().all(is_host) {
        return Err(wrong());
    }
    Ok(format!("{scheme}://{host}"))
}

fn build_page(path: &Path) -> Result<BuildPage> {
    let bytes = read_regular(path, MOST_REPORT_BYTES).reading(path)?;
    let report: Report = serde_json::from_slice(&bytes)
        .map_err(|error| Failure::Other(format!("{}: {error}", shown(path))))?;
    let missing: Vec<_> = report.textures.iter().filter(|t| t.status == Status::LeftOut).collect();
    let mut findings: Vec<_> = report.findings.iter().collect();
    findings.sort_by_key(|(code, share)| (share.severity, *code));
    Ok(BuildPage {
        program: report.program.clone(),
        planned: report.textures.len(),
        missing: missing.len(),
        left_out: missing
            .iter()
            .take(MOST_LEFT_OUT)
            .map(|texture| LeftOut {
                name: texture.name.clone(),
                reasons: texture.missed.iter().map(|missed| missed.reason.clone()).collect(),
            })
            .collect(),
        findings: findings
            .into_iter()
            .map(|(code, share)| Finding {
                code: code.clone(),
                severity: share.severity.to_string(),
                textures: share.textures,
                in_library: share.in_library,
                first: share.first.clone(),
            })
            .collect(),
    })
}
