//! Values by category: a dot for each value, a violin, the mean, and brackets between categories that differ.

use crate::axis::Axis;
use crate::brackets::{Bracket, levels};
use crate::markup::Element;
use crate::number::{brief, px};
use crate::plot::{FONT, INK};
use crate::projection::Projection;
use crate::svg::{self, TEXT_PX, fit_text, text_width};
use crate::violin::{offsets, outline};

const BRACKET_PX: f64 = 17.0;

/// A plot of values by category.
///
/// ```
/// use htex_report::{Axis, Bracket, Category, Groups};
/// let mut groups = Groups::new("Vinyl", Axis::linear("rating").with_range(0.0, 6.0));
/// groups.categories.push(Category::new("ar", "#0072b2", vec![3.0, 4.0, 3.5]));
/// groups.categories.push(Category::new("sbeta", "#7d1f6b", vec![5.0, 4.5, 5.5]));
/// groups.brackets.push(Bracket { from: 0, to: 1, label: "*".into(), note: "p = 0.01".into() });
/// assert!(groups.to_svg().starts_with("<svg "));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Groups {
    /// Title above the plot, and its name for screen readers.
    pub title: String,
    /// The vertical axis.
    pub y: Axis,
    /// The categories, from the left.
    pub categories: Vec<Category>,
    /// Brackets above the plot.
    pub brackets: Vec<Bracket>,
    /// Width of the whole picture, pixels.
    pub width: f64,
    /// Height without the brackets, pixels.
    pub height: f64,
}

/// Values of a category.
#[derive(Debug, Clone, PartialEq)]
pub struct Category {
    /// Name below its values.
    pub name: String,
    /// A CSS colour.
    pub color: String,
    /// The values; those that are not finite are left out.
    pub values: Vec<f64>,
    /// Hover texts, one per value; missing ones show the value.
    pub notes: Vec<String>,
}

impl Category {
    /// Creates a category without hover texts.
    pub fn new(name: &str, color: &str, values: Vec<f64>) -> Self {
        Self {
            name: name.to_owned(),
            color: color.to_owned(),
            values,
            notes: Vec::new(),
        }
    }

    fn shown(&self) -> impl Iterator<Item = (usize, f64)> {
        let values = self.values.iter().copied().enumerate();
        values.filter(|(_, value)| value.is_finite())
    }

    fn mean(&self) -> Option<f64> {
        let count = self.shown().count();
        (count > 0).then(|| self.shown().map(|(_, value)| value).sum::<f64>() / count as f64)
    }
}

impl Groups {
    /// Creates an empty plot of 480 by 300 pixels.
    pub fn new(title: &str, y: Axis) -> Self {
        Self {
            title: title.to_owned(),
            y,
            categories: Vec::new(),
            brackets: Vec::new(),
            width: 480.0,
            height: 300.0,
        }
    }

    /// Draws the plot as an `<svg>` element, usable alone or in a page.
    pub fn to_svg(&self) -> String {
        let layout = Layout::new(self);
        let (width, height) = (layout.width, layout.height);
        let categories = self.categories.iter().enumerate();
        Element::new("svg")
            .set("xmlns", "http://www.w3.org/2000/svg")
            .set("viewBox", &format!("0 0 {} {}", px(width), px(height)))
            .set("width", &px(width))
            .set("height", &px(height))
            .set("role", "img")
            .set("aria-label", &self.title)
            .set("font-family", FONT)
            .set("font-size", &px(TEXT_PX))
            .set("fill", INK)
            .set("style", "color-scheme:light")
            .child(&svg::rect(0.0, 0.0, width, height).set("fill", "#fff"))
            .children(layout.frame())
            .children(categories.map(|(index, category)| layout.category(index, category)))
            .children(layout.brackets())
            .render()
    }
}

/// A plot with its layout, pixels.
struct Layout<'a> {
    groups: &'a Groups,
    y: Projection,
    levels: Vec<usize>,
    width: f64,
    height: f64,
    left: f64,
    top: f64,
    area_width: f64,
    area_height: f64,
}

impl<'a> Layout<'a> {
    fn new(groups: &'a Groups) -> Self {
        let all = groups
            .categories
            .iter()
            .flat_map(|c| c.shown().map(|(_, value)| value));
        let y = Projection::new(&groups.y, all);
        let levels = levels(&groups.brackets);
        let above = levels
            .iter()
            .max()
            .map_or(0.0, |level| (level + 1) as f64 * BRACKET_PX + 6.0);
        let (width, height) = (
            size(groups.width, 480.0),
            size(groups.height, 300.0) + above,
        );
        let top = 24.0 + above;
        let area_height = height - top - 24.0;
        let ticks = y.ticks((area_height / 26.0) as usize);
        let labels = ticks
            .iter()
            .map(|(_, tick)| text_width(&tick.label, TEXT_PX));
        let left = 24.0 + labels.fold(0.0, f64::max);
        Self {
            groups,
            y,
            levels,
            width,
            height,
            left,
            top,
            area_width: width - left - 10.0,
            area_height,
        }
    }

    /// Title, axis and border.
    fn frame(&self) -> Vec<Element> {
        let (right, bottom) = (self.left + self.area_width, self.top + self.area_height);
        let title = fit_text(&self.groups.title, 13.0, self.width - 16.0);
        let title = svg::label(self.width / 2.0, 15.0, "middle", &title);
        let mut out = vec![title.set("font-size", "12").set("font-weight", "600")];
        for (fraction, tick) in self.y.ticks((self.area_height / 26.0) as usize) {
            let y = self.top + (1.0 - fraction) * self.area_height;
            out.push(svg::line(self.left, y, right, y).set("stroke", "#e3e3e3"));
            out.push(svg::label(self.left - 5.0, y + 4.0, "end", &tick.label));
        }
        let middle = self.top + self.area_height / 2.0;
        let turned = format!("rotate(-90 12 {})", px(middle));
        let label = fit_text(&self.groups.y.label, TEXT_PX, self.area_height + 40.0);
        out.push(svg::label(12.0, middle, "middle", &label).set("transform", &turned));
        let border = svg::rect(self.left, self.top, self.area_width, self.area_height);
        out.push(border.set("fill", "none").set("stroke", "#8a8a8a"));
        for (index, category) in self.groups.categories.iter().enumerate() {
            let name = fit_text(&category.name, TEXT_PX, self.step());
            out.push(svg::label(self.x(index), bottom + 16.0, "middle", &name));
        }
        out
    }

    fn category(&self, index: usize, category: &Category) -> Element {
        let values: Vec<f64> = category.shown().map(|(_, value)| value).collect();
        let middle = self.x(index);
        let half = (0.42 * self.step()).min(46.0);
        let mut group = Element::new("g").set("fill", &category.color);
        let outline = outline(&values, half);
        if !outline.is_empty() {
            let points = |side: f64| outline.iter().map(move |(v, w)| (middle + side * w, *v));
            let ring: Vec<_> = points(1.0).chain(points(-1.0).rev()).collect();
            let ring: Vec<_> = ring
                .into_iter()
                .map(|(x, v)| (x, self.height_of(v)))
                .collect();
            group = group.child(
                &polygon(&ring)
                    .set("fill-opacity", "0.16")
                    .set("stroke", "none"),
            );
        }
        let heights: Vec<f64> = values.iter().map(|v| self.height_of(*v)).collect();
        let dots = offsets(&heights, 2.8, 0.7 * half);
        for (((at, value), y), offset) in category.shown().zip(&heights).zip(dots) {
            let note = category.notes.get(at).cloned();
            let note = note.unwrap_or_else(|| format!("{}: {}", category.name, brief(value)));
            let title = Element::new("title").text(&note);
            let dot = svg::circle(middle + offset, *y, 2.8).set("fill-opacity", "0.75");
            group = group.child(&dot.child(&title));
        }
        match category.mean() {
            Some(mean) => group.child(&self.diamond(middle, mean, &category.name)),
            None => group,
        }
    }

    fn diamond(&self, x: f64, mean: f64, name: &str) -> Element {
        let (y, r) = (self.height_of(mean), 6.0);
        let title = Element::new("title").text(&format!("{name}: mean {}", brief(mean)));
        polygon(&[(x, y - r), (x + r, y), (x, y + r), (x - r, y)])
            .set("stroke", "#fff")
            .set("stroke-width", "1.5")
            .set("fill", "#111")
            .child(&title)
    }

    fn brackets(&self) -> Vec<Element> {
        let count = self.groups.categories.len();
        let placed = self.groups.brackets.iter().zip(&self.levels);
        let known = placed.filter(|(b, _)| b.from.max(b.to) < count);
        known.map(|(b, level)| self.bracket(b, *level)).collect()
    }

    fn bracket(&self, bracket: &Bracket, level: usize) -> Element {
        let y = self.top - 6.0 - level as f64 * BRACKET_PX;
        let (a, b) = (self.x(bracket.from) + 3.0, self.x(bracket.to) - 3.0);
        let line = svg::polyline(&[(a, y + 4.0), (a, y), (b, y), (b, y + 4.0)]);
        let label = svg::label((a + b) / 2.0, y - 1.0, "middle", &bracket.label);
        Element::new("g")
            .child(&Element::new("title").text(&bracket.note))
            .child(&line.set("fill", "none").set("stroke", "#333"))
            .child(&label)
    }

    fn step(&self) -> f64 {
        self.area_width / self.groups.categories.len().max(1) as f64
    }

    /// The middle of a category.
    fn x(&self, index: usize) -> f64 {
        self.left + (index as f64 + 0.5) * self.step()
    }

    fn height_of(&self, value: f64) -> f64 {
        let fraction = self.y.fraction(value).unwrap_or(0.0).clamp(0.0, 1.0);
        self.top + (1.0 - fraction) * self.area_height
    }
}

fn polygon(points: &[(f64, f64)]) -> Element {
    let pairs: Vec<String> = points
        .iter()
        .map(|(x, y)| format!("{},{}", px(*x), px(*y)))
        .collect();
    Element::new("polygon").set("points", &pairs.join(" "))
}

fn size(given: f64, otherwise: f64) -> f64 {
    if given.is_finite() {
        given.clamp(120.0, 10_000.0)
    } else {
        otherwise
    }
}
