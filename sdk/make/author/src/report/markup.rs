//! Markup elements and escaping. This is the only module that writes markup.

use std::fmt::Write;

/// Escapes `text` for element content
/// and for double-quoted attributes. Characters that XML forbids become U+FFFD.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' => out.push(c),
            _ if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            _ => out.push(c),
        }
    }
    out
}

/// An element with attributes and content, valid both as XML and in HTML.
#[derive(Debug, Clone)]
pub(crate) struct Element {
    name: &'static str,
    head: String,
    content: String,
}

impl Element {
    pub(crate) fn new(name: &'static str) -> Self {
        Self { name, head: String::new(), content: String::new() }
    }

    /// Adds an attribute; the value is escaped.
    pub(crate) fn set(mut self, name: &str, value: &str) -> Self {
        // Writing to a string cannot fail.
        let _ = write!(self.head, " {name}=\"{}\"", escape(value));
        self
    }

    /// Appends `text` to the content, escaped.
    pub(crate) fn text(mut self, text: &str) -> Self {
        self.content.push_str(&escape(text));
        self
    }

    /// Appends `child` to the content.
    pub(crate) fn child(mut self, child: &Element) -> Self {
        child.write_to(&mut self.content);
        self
    }

    /// Appends `children` to the content.
    pub(crate) fn children(self, children: impl IntoIterator<Item = Element>) -> Self {
        children.into_iter().fold(self, |all, one| all.child(&one))
    }

    /// Appends markup to the content without escaping.
    pub(crate) fn raw(mut self, markup: &str) -> Self {
        self.content.push_str(markup);
        self
    }

    /// Returns the element as text.
    pub(crate) fn render(&self) -> String {
        let mut out = String::new();
        self.write_to(&mut out);
        out
    }

    fn write_to(&self, out: &mut String) {
        let Self { name, head, content } = self;
        let _ = write!(out, "<{name}{head}>{content}</{name}>");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_content_and_attributes() {
        let element = Element::new("b").set("title", "\"<&").text("a<'\u{0}");
        assert_eq!(element.render(), "<b title=\"&quot;&lt;&amp;\">a&lt;&#39;\u{fffd}</b>");
    }
}
