//! Elements and escaping: the only place that writes angle brackets.

use std::fmt::Write;

/// `text` with everything that markup would read as its own replaced, fit for element content
/// and for a double-quoted attribute. Characters that XML forbids become U+FFFD.
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

/// One element, its attributes and its content; valid both as XML and inside HTML.
#[derive(Debug, Clone)]
pub(crate) struct Element {
    name: &'static str,
    head: String,
    content: String,
}

impl Element {
    /// An empty element.
    pub(crate) fn new(name: &'static str) -> Self {
        Self {
            name,
            head: String::new(),
            content: String::new(),
        }
    }

    /// With one more attribute; the value is escaped.
    pub(crate) fn set(mut self, name: &str, value: &str) -> Self {
        // Writing to a string cannot fail.
        let _ = write!(self.head, " {name}=\"{}\"", escape(value));
        self
    }

    /// With `text` appended to its content, escaped.
    pub(crate) fn text(mut self, text: &str) -> Self {
        self.content.push_str(&escape(text));
        self
    }

    /// With `child` appended to its content.
    pub(crate) fn child(mut self, child: &Element) -> Self {
        child.write_to(&mut self.content);
        self
    }

    /// With each of `children` appended to its content.
    pub(crate) fn children(self, children: impl IntoIterator<Item = Element>) -> Self {
        children.into_iter().fold(self, |all, one| all.child(&one))
    }

    /// With finished markup appended to its content as it is.
    pub(crate) fn raw(mut self, markup: &str) -> Self {
        self.content.push_str(markup);
        self
    }

    /// The element as text.
    pub(crate) fn render(&self) -> String {
        let mut out = String::new();
        self.write_to(&mut out);
        out
    }

    fn write_to(&self, out: &mut String) {
        let Self {
            name,
            head,
            content,
        } = self;
        let _ = write!(out, "<{name}{head}>{content}</{name}>");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_content_and_attributes() {
        let element = Element::new("b").set("title", "\"<&").text("a<'\u{0}");
        assert_eq!(
            element.render(),
            "<b title=\"&quot;&lt;&amp;\">a&lt;&#39;\u{fffd}</b>"
        );
    }
}
