//! The report of a sweep as an HTML page.

use crate::report::{Cell, HeatScale, Page, Row, Table, figures, list, paragraph};
use htex_format::{By, ErrorMeasure, Measure, MeasureKind};

use crate::tradeoff::against::Cost;
use crate::tradeoff::error_axis::ErrorAxis;
use crate::tradeoff::figure::{above, figure};
use crate::tradeoff::knee::{Knee, along_front};
use crate::tradeoff::point::{errors, others};
use crate::tradeoff::{Point, QUANTISED, RECORDING, Tradeoff};

/// Returns the report as self-contained HTML. The summary comes first, followed by a section for
/// every recording.
pub fn page(tradeoff: &Tradeoff, command: &str) -> String {
    let mut page = Page::new("Accuracy against bytes and time");
    let summary = tradeoff.summary();
    if let Some(answer) = answer(tradeoff, &summary) {
        page.html(&paragraph(&answer));
    }
    page.html(&paragraph(&made_of(tradeoff)));
    page.html(&paragraph(&reading(tradeoff)));
    let name = summary.first().map_or(String::new(), |p| p.recording.clone());
    section(&mut page, tradeoff, &name, &summary);
    page.heading("How it is played");
    page.html(&paragraph(PLAYING));
    for model in tradeoff.models.iter().map(String::as_str).chain([QUANTISED, RECORDING]) {
        page.html(&crate::report::details(model, &playing(&summary, model).to_html()));
    }
    if !tradeoff.medians.is_empty() {
        for recording in &tradeoff.recordings {
            section(&mut page, tradeoff, &recording.name, &tradeoff.points_of(&recording.name));
        }
    }
    page.heading("Warnings");
    page.html(&if tradeoff.warnings.is_empty() {
        paragraph("None.")
    } else {
        list(&tradeoff.warnings)
    });
    page.heading("How this page was made");
    page.html(&crate::report::code_block(command));
    page.html(&paragraph(&machine(tradeoff)));
    page.render()
}

/// A setting is nearly as good as a second recording if its error is at most this many times as
/// large as the error of the second recording.
const NEARLY: f64 = 1.2;

/// Returns the answer in one sentence: the smallest setting that is nearly as good as a second
/// recording.
fn answer(tradeoff: &Tradeoff, summary: &[&Point]) -> Option<String> {
    let against = tradeoff.against(Cost::Bytes);
    let recording = summary.iter().find(|p| p.model == RECORDING)?;
    let floor = against.place(recording).1;
    let models = summary.iter().copied().filter(|p| p.model != RECORDING);
    let shown: Vec<&Point> = models.filter(|p| Cost::Bytes.compares(p)).collect();
    let front = along_front(&shown, against);
    let near = front.iter().find(|p| against.place(p).1 <= NEARLY * floor);
    let best = near.or(front.last())?;
    let which = match near {
        Some(_) => "The smallest setting that is nearly as good as a second recording is",
        None => "No setting is nearly as good as a second recording. The best one is",
    };
    let mut answer = format!(
        "{which} {}: it needs {} bytes and {:.1} ns a sample, and its {} is {}",
        best.name(),
        best.bytes,
        best.ns_per_sample,
        against.error,
        against.error.amount(against.place(best).1)
    );
    if against.error != ErrorAxis::HeldOut {
        answer += &format!(" (a second recording: {})", against.error.amount(floor));
    }
    Some(answer + ".")
}

fn reading(tradeoff: &Tradeoff) -> String {
    let error = match tradeoff.error {
        ErrorAxis::HeldOut => {
            "held out: the setting is fitted to the odd blocks of what is read of the recording, stored and played, and compared with the \
             even blocks in third octaves. 1 is as good as a second recording: the error of the odd blocks themselves, the dashed line"
                .to_owned()
        }
        ErrorAxis::Fitted(measure) => {
            let own = match measure {
                ErrorMeasure::NineBand => "`bands` stores what it is made of",
                _ => "no model is fitted to it",
            };
            format!(
                "the {measure} of what the setting was fitted to, in decibels ({own}): against bytes by the model's own magnitudes, against \
                 time by rendered samples. The dashed line is the difference between odd and even blocks of the recording"
            )
        }
    };
    format!(
        "Each dot is a setting of a model; large dots are the model's own front, where no other of its \
         settings has less error at the same or a lower cost. The grey line is the front of all models; times that differ by no more than \
         their spreads are one point of it. Point at a large dot to see all its numbers. In the pictures and knees the error is {error}. \
         Errors below the dashed line do not distinguish models. The tables have the held-out error, and against \
         what was fitted to the nine-band error, third-octave error and log-spectral distance, and what is felt of the difference: forces become \
         displacements of the skin, of which what is above the detection threshold counts, in third octaves. Below threshold is the share of \
         the recordings that can be felt and whose difference is below the difference threshold in every band; apart from that, repeats is the share whose \
         nine-band error is at most 3.5 times the recording's own repeatability, which says how well a recording repeats and not what is felt. Two \
         baselines are in every picture: the spectrum at one byte per bin, and the recording, whose error is the difference \
         between its odd and even blocks."
    )
}

const PLAYING: &str = "The fit at the defaults, stored and played with one other option at a time. A \
    loop takes memory and repeats one piece of noise; a filter's resolution increases with its number of \
    taps. Times at another output rate are per sample at that rate.";

fn made_of(tradeoff: &Tradeoff) -> String {
    let names: Vec<String> = tradeoff.recordings.iter().map(|r| r.name.clone()).collect();
    let simulated = tradeoff.recordings.iter().filter(|r| r.simulated).count();
    let made = match simulated {
        0 => String::new(),
        n if n == names.len() => " All of them are simulated: computed, not recorded.".to_owned(),
        n => format!(" {n} of them are simulated: computed, not recorded."),
    };
    let (points, several) = (tradeoff.points.len(), names.len() > 1);
    let median = if several { " The first pictures show medians over the recordings." } else { "" };
    format!("{points} settings, measured on {}.{made}{median}", names.join(", "))
}

fn machine(tradeoff: &Tradeoff) -> String {
    let m = &tradeoff.machine;
    format!(
        "{} on {} ({} cores, {}). Times are medians of interleaved runs on one core, with warm caches; a \
         spread is half the interquartile range.",
        tradeoff.tool, m.processor, m.cores, m.system
    )
}

/// Adds two plots and the knees of a recording.
fn section(page: &mut Page, tradeoff: &Tradeoff, name: &str, points: &[&Point]) {
    page.heading(name);
    let pictures = [Cost::Bytes, Cost::Time].map(|cost| {
        let title = match cost {
            Cost::Bytes => "Error against bytes",
            Cost::Time => "Error against time",
        };
        figure(title, points, &tradeoff.models, tradeoff.against(cost)).to_svg()
    });
    page.html(&figures(&pictures));
    let outside = [Cost::Bytes, Cost::Time]
        .map(|cost| above(points, &tradeoff.models, tradeoff.against(cost)));
    for sentence in outside.into_iter().flatten() {
        page.html(&paragraph(&sentence));
    }
    for (against, what) in [("bytes", "bytes"), ("time", "time")] {
        let own = |k: &&Knee| k.recording == name && k.against == against;
        let words = |k: &Knee| format!("{}: {}", k.of, k.words);
        let knees: Vec<String> = tradeoff.knees.iter().filter(own).map(words).collect();
        page.html(&crate::report::details(&format!("Knees against {what}"), &list(&knees)));
    }
    let along = along_front(
        &points.iter().copied().filter(|p| Cost::Bytes.compares(p)).collect::<Vec<_>>(),
        tradeoff.against(Cost::Bytes),
    );
    let table = table("The front of all against bytes", &along);
    page.html(&crate::report::details("The front against bytes, in numbers", &table.to_html()));
}

fn columns() -> Vec<String> {
    let names = |these: &[&str]| these.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
    let mut columns = names(&["bytes", "held out"]);
    columns.extend(errors().map(Measure::heading));
    columns.extend(names(&["below threshold / %", "repeats / %", "played / dB"]));
    columns.extend(others().map(Measure::heading));
    columns.extend(names(&["ns a sample", "first sample / µs", "fit / ms"]));
    columns
}

fn cells(p: &Point) -> Vec<Cell> {
    let text = |text: String| Cell::Text(text, String::new());
    let own = |measure| p.get(By::Magnitude, measure);
    let mut cells = vec![text(p.bytes.to_string())];
    cells.push(Cell::Plain(p.held_out_error.unwrap_or(f64::NAN)));
    cells.extend(errors().map(|error| Cell::Plain(own(error))));
    let shares = [p.shares.below_threshold, p.shares.within_repeatability];
    cells.extend(shares.map(|share| text(format!("{:.0}", 100.0 * share))));
    cells.push(Cell::Text(
        format!("{:.2}", p.get(By::Samples, Measure::NineBand)),
        format!("± {:.2}", p.by_samples.band_error_spread_db),
    ));
    cells.extend(others().map(|other| match other.row().judged {
        MeasureKind::Correlation => text(format!("{:.4}", own(other))),
        _ => Cell::Plain(own(other)),
    }));
    cells.push(timed(p.ns_per_sample, p.spread));
    cells.push(timed(p.first_sample_us, p.first_sample_spread));
    cells.push(timed(p.fit_ms, p.fit_spread));
    cells
}

fn table(caption: &str, points: &[&Point]) -> Table {
    let row = |p: &&Point| Row { header: p.name(), cells: cells(p) };
    Table {
        caption: caption.to_owned(),
        corner: "setting".to_owned(),
        columns: columns(),
        rows: points.iter().map(row).collect(),
        scale: HeatScale::None,
        decimals: 2,
    }
}

fn timed(median: f64, spread: f64) -> Cell {
    Cell::Text(format!("{median:.2}"), format!("± {:.0} %", 100.0 * spread))
}

/// Returns the table of a model's default fit, stored and played in every way.
fn playing(points: &[&Point], model: &str) -> Table {
    let is_own = |p: &&Point| p.how.options.is_empty() && p.model == model;
    let own: Vec<&Point> = points.iter().copied().filter(is_own).collect();
    table("Fitted at its defaults", &own)
}
