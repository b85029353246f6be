//! Self-contained HTML pages. A page is one file that contains its style sheet and uses no scripts
//! and no external resources.

use crate::report::markup::{Element, escape};

const STYLE: &str = include_str!("page.css");

/// A self-contained HTML page, written from top to bottom.
#[derive(Debug, Clone)]
pub struct Page {
    title: String,
    body: String,
}

impl Page {
    /// Creates a page with `title` as its heading.
    pub fn new(title: &str) -> Self {
        let heading = Element::new("h1").text(title);
        Self { title: title.to_owned(), body: heading.render() }
    }

    /// Starts a section with the heading `text`.
    pub fn heading(&mut self, text: &str) {
        self.html(&Element::new("h2").text(text).render());
    }

    /// Appends HTML without escaping, such as the result of
    /// [`Plot::to_svg`](crate::report::Plot::to_svg),
    /// [`Table::to_html`](crate::report::Table::to_html) or [`paragraph`].
    pub fn html(&mut self, html: &str) {
        self.body.push('\n');
        self.body.push_str(html);
    }

    /// Returns the page as text, which must be stored as UTF-8.
    pub fn render(&self) -> String {
        let (title, body) = (escape(&self.title), &self.body);
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light\">\n<title>{title}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n{body}\n</body>\n</html>\n"
        )
    }
}

/// Returns `text` as a paragraph.
pub fn paragraph(text: &str) -> String {
    Element::new("p").text(text).render()
}

/// Returns `items` as an HTML list, or an empty string if there are no items.
pub fn list(items: &[impl ToString]) -> String {
    if items.is_empty() {
        return String::new();
    }
    let items = items.iter().map(|item| Element::new("li").text(&item.to_string()));
    Element::new("ul").children(items).render()
}

/// Returns `text` as preformatted text.
pub fn code_block(text: &str) -> String {
    let code = Element::new("code").text(text);
    Element::new("pre").child(&code).render()
}

/// Returns a link if the text is an `https://` address, and otherwise a paragraph with the text.
pub fn link(address: &str) -> String {
    if !address.starts_with("https://") {
        return paragraph(address);
    }
    let link = Element::new("a").set("href", address).text(address);
    Element::new("p").child(&link).render()
}

/// Returns an audio player or a picture for a file beside the page, depending on the file's type.
pub fn preview(path: &str) -> String {
    let is_sound = [".wav", ".flac", ".mp3", ".ogg"].iter().any(|end| path.ends_with(end));
    if is_sound {
        let player = Element::new("audio").set("controls", "").set("preload", "none");
        player.set("src", path).render()
    } else {
        Element::new("img").set("alt", "").set("height", "160").set("src", path).render()
    }
}

/// Places SVG pictures side by side, or below one another if the page is narrow.
pub fn figures(pictures: &[String]) -> String {
    let one = |svg: &String| Element::new("figure").set("class", "wide").raw(svg);
    let figures = Element::new("div").set("class", "figures");
    figures.children(pictures.iter().map(one)).render()
}

/// Returns an element that shows `summary`. A click on the summary shows `html` below it.
pub fn details(summary: &str, html: &str) -> String {
    let details = Element::new("details").child(&Element::new("summary").text(summary));
    details.raw(html).render()
}
