//! Report on fitted textures: spectra, errors and sizes.

mod data;
mod matrices;
mod picture;
mod shares;
mod sizes;
mod spectra;

pub use data::{Measure, ModelResult, Share, Texture, TextureReport};
pub use picture::spectra_picture;

use crate::report::markup::Element;
use crate::report::page::{Page, code_block, figures, list, paragraph};

/// Returns the report as a self-contained HTML page.
pub fn texture_report(report: &TextureReport) -> String {
    let mut page = Page::new(&report.title);
    for text in &report.intro {
        page.html(&paragraph(text));
    }
    page.html(&simulation_notice(report));
    how_to_read(&mut page);
    if !report.pictures.is_empty() {
        page.heading("Conditions");
        page.html(&figures(&report.pictures));
    }
    page.heading("Spectra");
    page.html(&spectra::section(report));
    page.heading("How close the models come");
    page.html(&matrices::summary(report));
    page.html(&shares::table(report));
    page.heading("Error in each band");
    page.html(&matrices::bands(report));
    page.heading("Sizes");
    page.html(&sizes::table(report));
    warnings(&mut page, report);
    if !report.command.is_empty() {
        page.heading("How this page was made");
        page.html(&code_block(&report.command));
    }
    page.render()
}

fn simulation_notice(report: &TextureReport) -> String {
    let all = &report.textures;
    let names: Vec<&str> = all.iter().filter(|t| t.simulated).map(|t| t.name.as_str()).collect();
    let text = match (names.len(), names.len() == all.len()) {
        (0, _) => return String::new(),
        (_, true) => "All textures on this page are simulated: computed, not recorded from a finger on a surface.".to_owned(),
        _ => format!("Simulated, not recorded from a finger on a surface: {}.", names.join(", ")),
    };
    Element::new("p").set("class", "notice").text(&text).render()
}

fn how_to_read(page: &mut Page) {
    page.heading("How to read this page");
    page.html(&paragraph(
        "Each row of spectra is one texture: first the recording (dark grey), then each model in \
         its own colour over the same recording (light grey). The horizontal axis is frequency \
         from 20 to 1000 Hz, logarithmic; the vertical axis is the magnitude, of a force in \
         millinewtons, from zero; its range is the same within a row but differs between rows. A model that is a \
         sum of sinusoids is drawn as vertical lines, one for each. Point at a curve to see its values.",
    ));
    page.html(&paragraph(
        "Spectral correlation (r) is Pearson's correlation of the model's and the recording's \
         magnitudes, bin by bin: it measures whether every ripple is matched, and 1 is the best. The \
         nine-band error compares the energy in nine overlapping bands, evenly spaced in log \
         frequency, in decibels: it measures whether the right amount of vibration is in the right \
         region, and 0 is the best. Third-octave bands do not overlap and are about twice as fine, \
         and the log-spectral distance compares every bin in decibels; no model is fitted to either. What is felt of a difference is what is above a fingertip's detection \
         threshold, in third octaves, after forces have become displacements of the skin. \
         The measures can disagree, and none of them is a rating by a participant.",
    ));
}

fn warnings(page: &mut Page, report: &TextureReport) {
    page.heading("Warnings");
    let named = |texture: &Texture| {
        let name = texture.header();
        let all = texture.warnings.iter().map(|text| format!("{name}: {text}"));
        all.collect::<Vec<_>>()
    };
    let all: Vec<String> = report.textures.iter().flat_map(named).collect();
    page.html(&if all.is_empty() { paragraph("None.") } else { list(&all) });
}
