//! The figures of the paper, of an analysis.

use htex_report::{Axis, Bracket, Category, Groups, Line, Plot, Series, model_color, series_color};

use super::analysis::{Analysis, Mean};
use super::results::{BandResult, PairResult};
use super::text::significant;
use super::words::{p, stars};

/// Figure 3B and S5: ratings by model, for all textures and for each.
pub(super) fn ratings(analysis: &Analysis) -> Vec<String> {
    let values = analysis.means_model.iter().chain(&analysis.means);
    let values = values.flat_map(|mean| &mean.by_participant).copied();
    let range = range(values);
    let plot = |title: &str, means: Vec<&Mean>, pairs: &[PairResult]| {
        let mut groups = groups(analysis, title, "mean rating", range, means);
        groups.brackets = brackets(&analysis.models, pairs);
        groups.to_svg()
    };
    let all = plot(
        "All textures",
        analysis.means_model.iter().collect(),
        &analysis.pairs_model,
    );
    let each = analysis.textures.iter().map(|texture| {
        let pairs = analysis
            .pairs_by_texture
            .get(texture)
            .map_or(&[][..], |list| list);
        plot(texture, of_texture(&analysis.means, texture), pairs)
    });
    std::iter::once(all).chain(each).collect()
}

/// Figure 3A: correlation of felt with recorded spectra.
pub(super) fn correlations(analysis: &Analysis) -> Vec<String> {
    let Some(found) = &analysis.spectral_correlation else {
        return Vec::new();
    };
    let values = found.means_model.iter().chain(&found.means);
    let values = values.flat_map(|mean| &mean.by_participant).copied();
    let range = range(values);
    let plot = |title: &str, means: Vec<&Mean>| {
        groups(analysis, title, "spectral correlation", range, means).to_svg()
    };
    let all = plot("All textures", found.means_model.iter().collect());
    let each = analysis
        .textures
        .iter()
        .map(|t| plot(t, of_texture(&found.means, t)));
    std::iter::once(all).chain(each).collect()
}

/// Figure 3C: the metrics of the regressions over the number of bands, with what shows overfitting, and the bands of the best bank.
pub(super) fn bands(analysis: &Analysis) -> Vec<String> {
    let (bands, Some(best)) = (&analysis.bands, &analysis.best_bands) else {
        return Vec::new();
    };
    let series = |name: &str, of: fn(&BandResult) -> Option<f64>| {
        let points = bands
            .iter()
            .filter_map(|b| Some((b.filters as f64, of(b)?)));
        let mut series = Series::line(name, points.collect());
        series.marker_radius_px = Some(3.0);
        series
    };
    let plot = |title: &str, y: Axis, lines: Vec<Series>| {
        let mut plot = Plot::new(title, Axis::linear("number of bands"), y);
        let values = lines
            .iter()
            .flat_map(|line| line.points.iter().map(|point| point.1));
        let (low, high) = extremes(values);
        plot.series = lines;
        plot.series.push(marker(best.bic as f64, low, high));
        plot.to_svg()
    };
    // p-values below the smallest double are 0, which a logarithmic axis cannot show.
    let p_value = series("p", |b| Some(b.p.max(1e-300)));
    let r2 = vec![
        series("r\u{b2}", |b| Some(b.r2)),
        series("adjusted", |b| Some(b.adjusted_r2)).colored(series_color(0)),
        series("cross-validated", |b| b.cross_validated_r2).colored(series_color(2)),
    ];
    let criteria = vec![
        series("AIC", |b| Some(b.aic)).colored(series_color(0)),
        series("BIC", |b| Some(b.bic)).colored(series_color(2)),
    ];
    let mut out = vec![
        plot("p-value", Axis::log("p-value"), vec![p_value]),
        plot("Explained variance", Axis::linear("r\u{b2}"), r2),
        plot(
            "F ratio",
            Axis::linear("F"),
            vec![series("F", |b| Some(b.f))],
        ),
        plot(
            "Error",
            Axis::linear("RMSE / z-score"),
            vec![series("RMSE", |b| Some(b.rmse))],
        ),
        plot("Information criteria", Axis::linear("AIC, BIC"), criteria),
    ];
    out.extend(bands.iter().find(|b| b.filters == best.bic).map(bank));
    out
}

/// The triangles of a bank.
fn bank(result: &BandResult) -> String {
    let title = format!("The {} bands with the lowest BIC", result.filters);
    let mut plot = Plot::new(&title, Axis::log("frequency / Hz"), Axis::linear("weight"));
    plot.legend = false;
    for (index, edges) in result.edges_hz.windows(3).enumerate() {
        let points = vec![(edges[0], 0.0), (edges[1], 1.0), (edges[2], 0.0)];
        let name = format!("band {}", index + 1);
        plot.series
            .push(Series::line(&name, points).colored(series_color(index)));
    }
    plot.to_svg()
}

/// A dashed line at the best number of bands.
fn marker(at: f64, low: f64, high: f64) -> Series {
    let mut series = Series::line("lowest BIC", vec![(at, low), (at, high)]).colored("#b00020");
    series.line = Line::Dashed;
    series.hover = false;
    series
}

fn groups(
    analysis: &Analysis,
    title: &str,
    label: &str,
    (low, high): (f64, f64),
    means: Vec<&Mean>,
) -> Groups {
    let mut groups = Groups::new(title, Axis::linear(label).with_range(low, high));
    groups.width = 420.0;
    groups.height = 280.0;
    groups.categories = means
        .into_iter()
        .map(|mean| category(analysis, mean))
        .collect();
    groups
}

fn category(analysis: &Analysis, mean: &Mean) -> Category {
    let color = model_color(&mean.model);
    let mut category = Category::new(&mean.model, color, mean.by_participant.clone());
    // A participant without a value has none in the list, and the names no longer fit.
    if mean.by_participant.len() == analysis.participants.len() {
        let named = analysis.participants.iter().zip(&mean.by_participant);
        let note = |(name, value): (&String, &f64)| format!("{name}, {}: {value:.3}", mean.model);
        category.notes = named.map(note).collect();
    }
    category
}

/// Brackets over the models that differ, the nearest first.
fn brackets(models: &[String], pairs: &[PairResult]) -> Vec<Bracket> {
    let index = |name: &str| models.iter().position(|model| model == name);
    let bracket = |pair: &PairResult| {
        let test = pair.test.as_ref()?;
        Some(Bracket {
            from: index(&pair.a)?,
            to: index(&pair.b)?,
            label: stars(test.p_bonferroni).to_owned(),
            note: format!(
                "{} \u{2013} {}: {}, Bonferroni",
                pair.a,
                pair.b,
                p(test.p_bonferroni)
            ),
        })
    };
    let found = pairs
        .iter()
        .filter(|pair| significant(pair))
        .filter_map(bracket);
    let mut found: Vec<Bracket> = found.collect();
    found.sort_by_key(|bracket| (bracket.to - bracket.from, bracket.from));
    found
}

fn of_texture<'a>(means: &'a [Mean], texture: &str) -> Vec<&'a Mean> {
    means
        .iter()
        .filter(|mean| mean.texture.as_deref() == Some(texture))
        .collect()
}

/// The range of an axis that all plots of a figure share.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = extremes(values);
    let margin = 0.05 * (high - low).max(1e-9);
    (low - margin, high + margin)
}

fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let widen = |(low, high): (f64, f64), v: f64| (low.min(v), high.max(v));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), widen);
    if low <= high { (low, high) } else { (0.0, 1.0) }
}
