//! Reads XML into elements with names, texts and line numbers. The reader does not support document
//! type definitions, so a file can use only the five predefined entities of XML. The size limits
//! are far above the size of the toolkit's model files, about 0.2 MB.

use quick_xml::Reader;
use quick_xml::events::{BytesRef, BytesStart, Event};

use super::element::{Element, place, short};
use crate::error::Fault;

/// Largest file that is read, bytes.
pub const MOST_BYTES: usize = 16 << 20;
/// Largest number of elements in a file.
const MOST_ELEMENTS: usize = 200_000;
/// Deepest nesting of elements.
const MOST_DEPTH: usize = 16;
/// Longest text of an element, bytes, without blanks at its start and end.
const MOST_TEXT: usize = 4096;
/// Largest number of attributes of an element. It is limited because the reader compares each
/// attribute with all earlier ones.
const MOST_ATTRIBUTES: usize = 64;

/// Reads the root element.
pub(super) fn root(bytes: &[u8]) -> Result<Element, Fault> {
    if bytes.len() > MOST_BYTES {
        let words = format!("{} bytes are more than {MOST_BYTES}, the most", bytes.len());
        return Err(Fault::whole(words));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = line_of(bytes, error.valid_up_to());
        Fault::new(place(line, None), "this is no UTF-8; save the file as UTF-8")
    })?;
    // Some editors write a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    Builder::new(text).build()
}

fn line_of(bytes: &[u8], at: usize) -> usize {
    let before = bytes.get(..at).unwrap_or(bytes);
    1 + before.iter().filter(|byte| **byte == b'\n').count()
}

struct Builder<'a> {
    text: &'a str,
    reader: Reader<&'a [u8]>,
    /// Elements that are still open, the outermost first.
    open: Vec<Element>,
    /// Length, bytes, of the innermost open element's text up to its last non-blank character. It
    /// is stored so that the reader looks at each blank only once.
    filled: usize,
    root: Option<Element>,
    count: usize,
    /// The last position whose line number was computed, and this line number.
    known: (usize, usize),
}

impl<'a> Builder<'a> {
    fn new(text: &'a str) -> Self {
        Self {
            text,
            reader: Reader::from_str(text),
            open: Vec::new(),
            filled: 0,
            root: None,
            count: 0,
            known: (0, 1),
        }
    }

    fn build(mut self) -> Result<Element, Fault> {
        loop {
            let event = self.reader.read_event().map_err(|error| {
                let at = self.reader.error_position();
                self.here(at, format!("this is no XML: {}", short(&error.to_string())))
            })?;
            if !self.process(event)? {
                break;
            }
        }
        if let Some(left) = self.open.pop() {
            return Err(left.fault("it is not closed; the file seems cut off"));
        }
        let root = self.root.take();
        root.ok_or_else(|| Fault::whole("it holds no element; give a model file of the toolkit"))
    }

    /// Processes an event of the XML parser. Returns false at the end of the file.
    fn process(&mut self, event: Event<'a>) -> Result<bool, Fault> {
        match event {
            Event::Start(start) => self.start(&start)?,
            Event::Empty(start) => {
                self.start(&start)?;
                self.close();
            }
            Event::End(_) => self.close(),
            Event::Text(text) => self.words(&decoded(text.decode()))?,
            Event::CData(text) => self.words(&decoded(text.decode()))?,
            // A file cannot define entities, so no entity can expand to a text that is longer than
            // the file.
            Event::GeneralRef(reference) => {
                let word = self.resolved(&reference)?;
                self.words(&word)?;
            }
            Event::DocType(_) => {
                let words = "a document type definition, which could name entities and other files; remove it";
                return Err(self.fault(words));
            }
            Event::Eof => return Ok(false),
            Event::Comment(_) | Event::Decl(_) | Event::PI(_) => {}
        }
        Ok(true)
    }

    fn start(&mut self, start: &BytesStart<'_>) -> Result<(), Fault> {
        self.count += 1;
        if self.count > MOST_ELEMENTS {
            return Err(self.fault(format!("more than {MOST_ELEMENTS} elements")));
        }
        if self.open.len() >= MOST_DEPTH {
            return Err(self.fault(format!("more than {MOST_DEPTH} elements in each other")));
        }
        if self.open.is_empty() && self.root.is_some() {
            return Err(self.fault("a second element beside the first; a document has one"));
        }
        let mut attributes = Vec::new();
        for attribute in start.attributes() {
            if attributes.len() >= MOST_ATTRIBUTES {
                return Err(self.fault(format!("more than {MOST_ATTRIBUTES} attributes")));
            }
            let attribute = attribute.map_err(|error| self.fault(short(&error.to_string())))?;
            attributes.push((lossy(attribute.key.as_ref()), lossy(attribute.value.as_ref())));
        }
        let line = self.line();
        self.filled = 0;
        self.open.push(Element {
            name: lossy(start.name().as_ref()),
            attributes,
            text: String::new(),
            children: Vec::new(),
            line,
        });
        Ok(())
    }

    fn close(&mut self) {
        let Some(closed) = self.open.pop() else {
            return;
        };
        match self.open.last_mut() {
            Some(parent) => {
                self.filled = parent.text.trim_end().len();
                // Otherwise, in a long list, the blanks before each child would add up.
                parent.text.truncate(self.filled);
                parent.children.push(closed);
            }
            None => self.root = Some(closed),
        }
    }

    fn words(&mut self, words: &str) -> Result<(), Fault> {
        let filled = words.trim_end().len();
        let is_blank = filled == 0;
        let Some(open) = self.open.last_mut() else {
            return if is_blank {
                Ok(())
            } else {
                Err(self.fault("a text outside of all elements"))
            };
        };
        // Blanks between elements do not count as text.
        let skipped = if open.text.is_empty() { words.len() - words.trim_start().len() } else { 0 };
        if !is_blank {
            self.filled = open.text.len() + filled - skipped;
        }
        open.text.push_str(words.get(skipped..).unwrap_or_default());
        if self.filled > MOST_TEXT {
            Err(open.fault(format!("a text of more than {MOST_TEXT} bytes")))
        } else {
            Ok(())
        }
    }

    fn resolved(&mut self, reference: &BytesRef<'_>) -> Result<String, Fault> {
        let name = decoded(reference.decode());
        if let Ok(Some(character)) = reference.resolve_char_ref() {
            return Ok(character.to_string());
        }
        match &name[..] {
            "lt" => Ok("<".to_owned()),
            "gt" => Ok(">".to_owned()),
            "amp" => Ok("&".to_owned()),
            "apos" => Ok("'".to_owned()),
            "quot" => Ok("\"".to_owned()),
            _ => {
                let words =
                    format!("the entity {}, which is none of the five of XML", short(&name));
                Err(self.fault(words))
            }
        }
    }

    /// Returns the line at which the last event ended.
    fn line(&mut self) -> usize {
        self.line_at(self.reader.buffer_position())
    }

    fn line_at(&mut self, position: u64) -> usize {
        let at = usize::try_from(position).unwrap_or(usize::MAX).min(self.text.len());
        let (from, line) = self.known;
        let passed = self.text.as_bytes().get(from..at).unwrap_or_default();
        self.known = (from.max(at), line + passed.iter().filter(|byte| **byte == b'\n').count());
        self.known.1
    }

    fn fault(&mut self, problem: impl AsRef<str>) -> Fault {
        self.here(self.reader.buffer_position(), problem)
    }

    fn here(&mut self, position: u64, problem: impl AsRef<str>) -> Fault {
        let line = self.line_at(position);
        Fault::new(place(line, self.open.last().map(|open| &open.name[..])), problem)
    }
}

/// Returns bytes as text. They are valid UTF-8, because the whole file is.
fn decoded<E>(text: Result<std::borrow::Cow<'_, str>, E>) -> String {
    text.map(std::borrow::Cow::into_owned).unwrap_or_default()
}

fn lossy(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
