use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fmt::{Display, Formatter};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use clap::Args;
use htex_author::FeltShare;
use htex_base::finding::{FileReport, Finding, Hint, Severity, plain};
use htex_build::{
    Build as Recipe, BuildError, BuildOptions, Destination, FindingShare, Job, Report, Status,
    TextureReport, Why, named_briefly, report_failure,
};
use serde::{Serialize, Serializer};
use serde_json::json;

use crate::assets::short_name;
use crate::failure::{Exit, Failure, Result, for_file};
use crate::findings_format::{FindingsFormat, formatted};
use crate::invocation::tool;
use crate::located::Anywhere;
use crate::output::{print_json, show, write};
use crate::progress::byte_bar;
use crate::wasm_limits::WasmLimit;

/// Build a library of textures from a recipe
///
/// Fits models to the recordings that the recipe names. Also imports files of other formats that
/// the recipe names, as `htex import` does. Writes the library (DIR/NAME.htexlib), each texture as
/// a file (in DIR/textures), a report (DIR/build-report.json) and a catalogue (DIR/index.html). If
/// the build fails, the report contains the error. A recipe may name its recordings and other files
/// by URI.
///
/// Finished fits stay in DIR/.htex-build. If a build was killed, run the same command again: the
/// new build reuses the fits that the killed build had finished. A repeated build fits only the
/// textures that have changed.
///
/// Exit status: 0 if every texture was made; 1 if no texture was made or the build failed; 2 for
/// wrong usage; 3 if some textures were made and others were left out.
///
/// A recipe may contain gates, i.e. requirements such as a maximum error. htex leaves out a texture
/// that does not meet a gate. With --keep-going, htex also leaves out a texture that cannot be
/// made.
#[derive(Args)]
pub(crate) struct Build {
    /// Path or URI of the recipe, e.g. library.toml. `htex schema recipe` prints its JSON Schema
    recipe: Anywhere,

    /// Folder for the results, or a URI (s3://, gs://, az://). For a URI, htex makes the results in
    /// the folder --work, and uploads the complete results
    #[arg(short, long, value_name = "DIR|URI")]
    output: OsString,

    /// Local folder in which htex makes the results if --output is a URI. Do not delete this
    /// folder, because the next build continues from its contents [default: a folder in the user's
    /// cache]
    #[arg(long, value_name = "DIR")]
    work: Option<PathBuf>,

    /// Number of textures to fit at the same time [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,

    /// Leave out a texture that cannot be made, and continue with the other textures
    #[arg(long)]
    keep_going: bool,

    /// Change nothing and exit with status 1 if textures of the existing library are missing from
    /// the new one, e.g. because a folder of recordings was moved
    #[arg(long)]
    no_removals: bool,

    /// Check the recipe with its files, plugins, options and gates, and print what a build would
    /// fit and why, but fit nothing
    #[arg(long)]
    dry_run: bool,

    /// Make the model in this plugin available to the recipe; may be given several times. A plugin
    /// that is a WASM module runs in a sandbox. A native library runs with all your rights, so load
    /// only a library that you trust. A recipe itself can name only WASM modules
    #[arg(long, value_name = "FILE")]
    plugin: Vec<PathBuf>,

    /// Remove unused fits at once. By default, unused fits stay for 30 days: if you undo a change
    /// of a setting in this time, htex uses the earlier fits again
    #[arg(long)]
    prune: bool,

    /// Make a catalogue that plays the textures themselves instead of short recorded sounds. DIR is
    /// the folder of the browser package, which htex copies into the catalogue
    #[arg(long, value_name = "DIR")]
    browser_package: Option<PathBuf>,

    /// Limit the resources of WASM models; `htex fit --help` lists the names
    #[arg(long, value_name = "NAME=N", value_parser = WasmLimit::parse)]
    wasm_limit: Vec<WasmLimit>,

    /// Print the findings and the textures that were left out in a format for continuous
    /// integration
    #[arg(long, value_enum, value_name = "FORMAT", conflicts_with_all = ["json", "dry_run"])]
    format: Option<FindingsFormat>,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// The result of a build, as JSON.
#[derive(Serialize)]
struct Summary<'a> {
    library: String,
    library_bytes: u64,
    textures: usize,
    fitted: usize,
    unchanged: usize,
    recordings: usize,
    recording_bytes: u64,
    seconds: f64,
    felt_shares: &'a BTreeMap<String, FeltShare>,
    findings: &'a BTreeMap<String, FindingShare>,
    /// Number of textures with a warning that is not a finding about a recording.
    other_warnings: usize,
    left_out: Vec<&'a TextureReport>,
    /// Names of textures in the previous library that the recipe no longer asks for.
    removed: &'a [String],
    /// Names of textures that stay in the library although the recipe no longer makes them.
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    kept: &'a [String],
    #[serde(skip)]
    catalogue: String,
}

/// The fits that a build has to do.
struct Work {
    textures: usize,
    /// Number of textures that an earlier build has already made in the same way.
    unchanged: usize,
    recordings: usize,
    bytes: u64,
}

impl Build {
    /// Runs the build. Also writes an error to the report, and with `--json` to standard output,
    /// for programs that read the report or the output.
    pub(crate) fn run(self) -> Result {
        let built = self.build();
        if let Err(failure) = &built {
            self.failed(failure)?;
        }
        built
    }

    /// Writes an error to the report, except for a build that changes nothing.
    fn failed(&self, failure: &Failure) -> Result<()> {
        let lines = failure.to_lines();
        let to = Destination::parse(&self.output, self.work.as_deref());
        let changes_nothing =
            self.dry_run || matches!(failure.cause(), Failure::Build(BuildError::Removes { .. }));
        // Wrong usage is not written, because no build has begun.
        if let (Ok(to), false, Exit::FAILURE) = (to, changes_nothing, failure.exit()) {
            // If the report cannot be written either, `failure` already states the reason.
            let _ = report_failure(to.folder(), &tool(), &lines);
        }
        if self.json { print_json(&json!({ "textures": 0, "error": lines })) } else { Ok(()) }
    }

    fn build(&self) -> Result {
        let start = Instant::now();
        let to = Destination::parse(&self.output, self.work.as_deref())
            .map_err(for_file(&self.recipe))?;
        if to.remote().is_none() && self.work.is_some() {
            return Err(Failure::usage(
                "--work goes with a URI after -o; a build of this machine works in its own folder",
            ));
        }
        let options = BuildOptions {
            jobs: self.jobs.map_or(0, usize::from),
            keep_going: self.keep_going,
            limits: WasmLimit::all(&self.wasm_limit),
            plugins: self.plugin.clone(),
            prune: self.prune,
            no_removals: self.no_removals,
            browser_package: self.browser_package.clone(),
            published: to.remote().cloned(),
            ..BuildOptions::new(tool())
        };
        let mut build =
            Recipe::open(&self.recipe, to.folder(), options).map_err(for_file(&self.recipe))?;
        let work = Work::new(&build);
        if self.dry_run {
            return self.announce(&build, &work);
        }
        if work.textures > 0 {
            // Checks that the remote storage accepts files. Otherwise this error would appear only
            // after hours of fitting.
            to.try_out().map_err(for_file(&self.recipe))?;
        }
        fit(&mut build, &work).map_err(for_file(&self.recipe))?;
        let built = build.finish().map_err(for_file(&self.recipe))?;
        to.publish().map_err(for_file(&self.recipe))?;
        self.report(&built, &to, &work, start.elapsed().as_secs_f64())
    }

    /// Checks the recipe, and prints what would be fitted and why.
    fn announce(&self, build: &Recipe, work: &Work) -> Result {
        build.check().map_err(for_file(&self.recipe))?;
        show(&DryRun { build, work }, self.json)
    }

    fn report(&self, report: &Report, to: &Destination, work: &Work, seconds: f64) -> Result {
        if let Some(format) = self.format {
            write(&formatted(format, "htex build", &file_reports(report)))?;
        }
        let results = to.results();
        let left_out: Vec<&TextureReport> =
            report.textures.iter().filter(|texture| texture.status == Status::LeftOut).collect();
        let exit = match (report.library.textures, left_out.len()) {
            (_, 0) => Exit::SUCCESS,
            (0, _) => Exit::FAILURE,
            _ => Exit::PART,
        };
        let summary = Summary {
            library: results.inside(&report.library.file).to_string(),
            library_bytes: report.library.bytes,
            textures: report.library.textures,
            fitted: work.textures,
            unchanged: work.unchanged,
            recordings: work.recordings,
            recording_bytes: work.bytes,
            seconds,
            felt_shares: &report.felt_shares,
            findings: &report.findings,
            other_warnings: other_warnings(report),
            left_out,
            removed: &report.removed,
            kept: &report.kept,
            catalogue: results.inside("index.html").to_string(),
        };
        if self.format.is_none() {
            show(&summary, self.json)?;
        }
        Ok(exit)
    }
}

/// Returns the findings of each texture. A gate that a texture misses is an error.
fn file_reports(report: &Report) -> Vec<FileReport> {
    let reports = report.textures.iter().map(|texture| {
        let missed = texture.missed.iter().map(|missed| Finding {
            code: missed.gate.to_ascii_uppercase(),
            severity: Severity::Error,
            pointer: String::new(),
            message: missed.reason.clone(),
            schema_rule: None,
            hint: Hint::default(),
        });
        let found = texture.asset.iter().flat_map(|asset| &asset.findings);
        let found = found.map(|finding| Finding {
            code: finding.code.clone(),
            // A finding is at most a warning here, because only a missed gate is an error.
            severity: finding.severity.max(Severity::Warning),
            pointer: String::new(),
            message: format!("{}: {}", finding.recordings.join(", "), finding.message),
            schema_rule: None,
            hint: Hint::default(),
        });
        htex_base::finding::Report::new(missed.chain(found).collect()).of_file(&texture.name)
    });
    reports.collect()
}

/// What a build would do.
struct DryRun<'a> {
    build: &'a Recipe,
    work: &'a Work,
}

impl Serialize for DryRun<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { build, work } = self;
        let why =
            |(texture, why): (&str, Why)| json!({ "texture": texture, "why": why.to_string() });
        json!({
            "to_fit": build.reasons().into_iter().map(why).collect::<Vec<_>>(),
            "textures": build.plan().textures.len(),
            "as_they_were": work.unchanged,
            "removed": build.removed(),
            "recordings": work.recordings,
            "recording_bytes": work.bytes,
        })
        .serialize(serializer)
    }
}

impl Display for DryRun<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { build, work } = self;
        for (texture, why) in build.reasons() {
            writeln!(f, "{}: {why}", plain(texture))?;
        }
        let megabytes = work.bytes as f64 / 1e6;
        writeln!(
            f,
            "{} textures: {} to fit from {} recordings ({megabytes:.1} MB), {} as they were",
            build.plan().textures.len(),
            work.textures,
            work.recordings,
            work.unchanged
        )?;
        f.write_str(&removed(&build.removed()))
    }
}

impl Work {
    fn new(build: &Recipe) -> Self {
        let jobs = || build.pending().map(|(_, job)| job);
        Self {
            textures: build.pending().len(),
            unchanged: build.plan().textures.len() - build.pending().len() - build.unreadable(),
            recordings: jobs().map(|job| job.recordings.len()).sum(),
            bytes: jobs().map(Job::recording_bytes).sum(),
        }
    }
}

/// Runs the pending fits with a progress bar.
fn fit(build: &mut Recipe, work: &Work) -> Result<(), BuildError> {
    let bar = byte_bar(work.bytes);
    let (count, all) = (AtomicUsize::new(0), work.textures);
    let done = |job: &Job| {
        // Relaxed, because only a number on the screen depends on the order.
        let count = count.fetch_add(1, Ordering::Relaxed) + 1;
        bar.set_message(format!("{count}/{all} textures"));
        bar.inc(job.recording_bytes());
    };
    let ended = build.run(&done);
    bar.finish_and_clear();
    ended
}

/// Returns a line with the removed textures, if there are any.
fn removed(names: &[String]) -> String {
    named("removed", names)
}

/// Returns a line with textures, if there are any. `what` says what happens to them.
fn named(what: &str, names: &[String]) -> String {
    match names.len() {
        0 => String::new(),
        count => format!(
            "{what}: {count} texture{} ({})\n",
            if count == 1 { "" } else { "s" },
            plain(&named_briefly(names))
        ),
    }
}

/// Counts the textures with a warning that is not a finding about a recording.
fn other_warnings(report: &Report) -> usize {
    let assets = report.textures.iter().flat_map(|texture| &texture.asset);
    assets.filter(|asset| asset.has_other_warnings()).count()
}

impl Display for Summary<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        writeln!(
            f,
            "{}: {} textures, {} bytes; {} fitted, {} as they were",
            plain(&self.library),
            self.textures,
            self.library_bytes,
            self.fitted,
            self.unchanged
        )?;
        if self.fitted > 0 {
            let megabytes = self.recording_bytes as f64 / 1e6;
            writeln!(
                f,
                "{} recordings, {megabytes:.1} MB in {:.1} s: {:.1} recordings/s, {:.1} MB/s",
                self.recordings,
                self.seconds,
                self.recordings as f64 / self.seconds,
                megabytes / self.seconds
            )?;
        }
        for (model, share) in self.felt_shares {
            writeln!(
                f,
                "{}: {} of {} textures below the difference threshold ({} of a sensitive finger's); {} within the recording's \
                 repeatability",
                short_name(model),
                share.below_difference_threshold,
                share.textures,
                share.below_if_sensitive,
                share.within_repeatability
            )?;
            if share.below_detection_threshold > 0 {
                writeln!(
                    f,
                    "{}: {} of {} textures cannot be felt at all",
                    short_name(model),
                    share.below_detection_threshold,
                    share.textures
                )?;
            }
        }
        f.write_str(&removed(self.removed))?;
        f.write_str(&named("kept", self.kept))?;
        self.findings(f)?;
        writeln!(f, "catalogue: {}", plain(&self.catalogue))?;
        for texture in &self.left_out {
            for missed in &texture.missed {
                let (name, reason) = (plain(&texture.name), plain(&missed.reason));
                writeln!(f, "left out: {name}: {}: {reason}", missed.gate)?;
            }
        }
        Ok(())
    }
}

impl Summary<'_> {
    /// Writes one line for each code of an error or a warning, errors first.
    fn findings(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let mut all: Vec<(&String, &FindingShare)> = self.findings.iter().collect();
        all.retain(|(_, share)| share.severity != Severity::Info);
        all.sort_by_key(|(code, share)| (share.severity, *code));
        for (code, share) in all {
            let more = if share.textures > share.first.len() { ", …" } else { "" };
            let noun = if share.textures == 1 { "texture" } else { "textures" };
            writeln!(
                f,
                "{code} ({}): {} {noun}, {} in the library: {}{more}",
                share.severity,
                share.textures,
                share.in_library,
                plain(&share.first.join(", "))
            )?;
        }
        match self.other_warnings {
            0 => Ok(()),
            count => writeln!(f, "other warnings: {count} textures; build-report.json has them"),
        }
    }
}
