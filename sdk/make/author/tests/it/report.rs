//! Properties of all pictures and pages, for any data.

use htex_author::report::{
    Axis, Cell, HeatScale, Line, Measure, ModelResult, Plot, Row, Series, Share, Table, Texture,
    TextureReport, texture_report,
};
use proptest::prelude::*;

const HOSTILE: &str = "<script>alert('x')</script> & \"quoted\" \u{1}";

/// Parses markup as XML; fails if it is not well formed.
fn parse(markup: &str) -> roxmltree::Document<'_> {
    roxmltree::Document::parse(markup).unwrap()
}

/// Returns the page's body as XML. The head is left out because it has elements that HTML does not
/// close.
fn body(page: &str) -> &str {
    let start = page.find("<body>").unwrap();
    &page[start..page.find("</body>").unwrap() + "</body>".len()]
}

fn strange_value() -> impl Strategy<Value = f64> {
    let special = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, 1e308, -1e308, 5e-324];
    prop_oneof![-1e3f64..1e3, proptest::sample::select(special.to_vec()), any::<f64>()]
}

fn strange_values() -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(strange_value(), 0..12)
}

fn hostile_model(values: &[f64], lines: bool) -> ModelResult {
    ModelResult {
        model: HOSTILE.to_owned(),
        short_name: HOSTILE.to_owned(),
        color: HOSTILE.to_owned(),
        magnitude: values.to_vec(),
        measured: values.iter().map(|v| (v % 2.0 < 1.0).then_some(*v)).collect(),
        note: HOSTILE.to_owned(),
        band_error_db: values.to_vec(),
        payload_bytes: values.len(),
        lines: lines.then(|| values.iter().map(|v| (*v, *v)).collect()),
    }
}

fn measure(is_correlation: bool, repeats: bool) -> Measure {
    Measure { caption: HOSTILE.to_owned(), is_correlation, repeats }
}

fn hostile_report(values: &[f64]) -> TextureReport {
    let texture = Texture {
        name: HOSTILE.to_owned(),
        simulated: values.len().is_multiple_of(2),
        unit: HOSTILE.to_owned(),
        condition: HOSTILE.to_owned(),
        law: HOSTILE.to_owned(),
        repeatability_rms_db: values.first().copied(),
        frequency_hz: values.iter().map(|v| v.abs()).collect(),
        recorded: values.to_vec(),
        models: vec![hostile_model(values, false), hostile_model(values, true)],
        warnings: vec![HOSTILE.to_owned()],
        ..Texture::default()
    };
    TextureReport {
        title: HOSTILE.to_owned(),
        intro: vec![HOSTILE.to_owned()],
        measures: vec![measure(true, false), measure(false, true), measure(false, false)],
        textures: vec![texture, Texture::default()],
        shares: vec![Share { short_name: HOSTILE.to_owned(), ..Share::default() }],
        pictures: vec![Plot::new(HOSTILE, Axis::log(HOSTILE), Axis::log(HOSTILE)).to_svg()],
        command: HOSTILE.to_owned(),
    }
}

proptest! {
    #[test]
    fn any_plot_is_well_formed_and_finite(
        x in strange_values(), y in strange_values(), size in strange_value(), log in any::<bool>(),
    ) {
        let points: Vec<_> = x.iter().copied().zip(y.iter().copied()).collect();
        let axis = if log { Axis::log(HOSTILE) } else { Axis::linear(HOSTILE) };
        let mut plot = Plot::new(HOSTILE, axis.clone(), axis.with_range(size, 2.0));
        for line in [Line::None, Line::Solid, Line::Dashed, Line::Stems] {
            let series = Series::scatter(HOSTILE, points.clone()).colored(HOSTILE);
            plot.series.push(Series { line, ..series });
        }
        (plot.width, plot.height) = (size, size);
        let svg = plot.to_svg();
        let document = parse(&svg);
        let attributes = document.descendants().flat_map(|node| node.attributes());
        let numbers = attributes.filter(|a| a.name() != "stroke" && a.name() != "aria-label");
        let finite = |text: &str| !text.contains("NaN") && !text.contains("inf");
        let all_finite = numbers.map(|a| a.value()).all(finite);
        prop_assert!(all_finite, "{}", svg);
    }

    #[test]
    fn any_page_is_well_formed_and_the_same_again(values in strange_values()) {
        let report = hostile_report(&values);
        let page = texture_report(&report);
        parse(body(&page));
        prop_assert!(!page.contains("<script"));
        prop_assert_eq!(page, texture_report(&report));
    }
}

#[test]
fn text_comes_back_as_it_went_in() {
    let plot = Plot::new(HOSTILE, Axis::linear("x / m"), Axis::linear("y / N"));
    let svg = plot.to_svg();
    let label = parse(&svg).root_element().attribute("aria-label").unwrap().to_owned();
    assert_eq!(label, HOSTILE.replace('\u{1}', "\u{fffd}"));
}

#[test]
fn a_page_fetches_nothing_and_says_what_is_simulated() {
    let page = texture_report(&hostile_report(&[0.1, 0.2]));
    let document = body(&page).to_owned();
    let elements = parse(&document);
    let fetches = ["href", "src", "srcset", "data", "action"];
    let found = elements.descendants().flat_map(|n| n.attributes());
    assert!(found.filter(|a| fetches.contains(&a.name())).count() == 0);
    assert!(!page.contains("url(") && !page.contains("@import"));
    assert!(page.matches("simulated").count() >= 5);
}

#[test]
fn values_off_a_log_axis_break_the_line() {
    let points = vec![(1.0, 1.0), (2.0, 2.0), (0.0, 3.0), (3.0, 1.0), (f64::NAN, 1.0), (4.0, 2.0)];
    let mut plot = Plot::new("", Axis::log("x"), Axis::linear("y"));
    plot.series.push(Series::line("s", points));
    let svg = plot.to_svg();
    let document = parse(&svg);
    let runs = document
        .descendants()
        .filter(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "polyline")));
    let lengths: Vec<usize> =
        runs.map(|n| n.attribute("points").unwrap().split(' ').count()).collect();
    assert_eq!(lengths, [2, 1, 1]);
}

#[test]
fn a_table_keeps_its_shape() {
    let row = |header: &str, cells| Row { header: header.to_owned(), cells };
    let table = Table {
        caption: "error / dB".to_owned(),
        corner: "texture".to_owned(),
        columns: vec!["a".to_owned(), "b".to_owned()],
        rows: vec![
            row("short", vec![Cell::Shaded(-2.0, "*")]),
            row("long", vec![Cell::Plain(1.0), Cell::Shaded(f64::NAN, ""), Cell::Missing]),
        ],
        scale: HeatScale::Diverging { extent: 4.0 },
        decimals: 1,
    };
    let html = table.to_html();
    let document = parse(&html);
    let rows = document.descendants().filter(|n| n.has_tag_name("tr"));
    let texts: Vec<Vec<&str>> =
        rows.map(|row| row.children().filter_map(|cell| cell.text()).collect()).collect();
    assert_eq!(texts[1], ["short", "\u{2212}2.0*", "\u{2013}"]);
    assert_eq!(texts[2], ["long", "1.0", "\u{2013}"]);
}

#[test]
fn a_chain_shows_what_runs_by_its_cost_and_what_was_left_out_pale() {
    let stage = |name: &str, ns_per_sample: f64| htex_author::report::ChainStage {
        name: name.to_owned(),
        reason: format!("{name} <is> needed"),
        rate_hz: 10_000.0,
        ns_per_sample,
    };
    let chain = htex_author::report::Chain {
        title: "a & b".to_owned(),
        stages: vec![stage("synthesis", 30.0), stage("gain", 10.0)],
        left_out: vec![("carrier".to_owned(), "none is wanted".to_owned())],
    };
    let svg = chain.to_svg();
    for text in ["40 ns a sample in all", "&lt;is&gt;", "a &amp; b", "none is wanted", "Left out"] {
        assert!(svg.contains(text), "{text}");
    }
    // Bars with lengths proportional to the costs, and one grey box.
    assert!(svg.contains("width=\"105\"") && svg.contains("width=\"35\""), "{svg}");
    assert_eq!(svg.matches("stroke-dasharray").count(), 1);
}
