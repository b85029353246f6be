//! Limits how deep the parser can recurse, by counting tokens before the parser runs.

use toml_parser::Source;
use toml_parser::lexer::{Token, TokenKind};

use super::{TomlError, place};

/// Largest nesting depth of a TOML text. Each enclosing bracket and each dot in a key counts as one
/// level of nesting. Recipes and studies have at most 8 levels.
pub const MOST_LEVELS: usize = 24;

/// An open bracket.
struct Open {
    kind: TokenKind,
    start: usize,
    /// Largest number of dots in one key since the bracket was opened.
    dots: usize,
}

/// Counts the levels of a text, which may contain any errors.
///
/// The parser recurses at an opening bracket, and returns at the closing bracket of the same kind
/// or at the end. So in a text whose brackets match, each recursive call of the parser corresponds
/// to an open bracket in this count. The parser puts a value below the last key that it read. After
/// an error, this may be any key since the bracket was opened, so the longest one counts.
#[derive(Default)]
struct Nesting {
    open: Vec<Open>,
    /// Levels of all open brackets together, including the dots of their keys.
    inside: usize,
    /// Largest number of dots in one key outside all brackets, or in the name of a table.
    outside: usize,
    /// Number of dots in the key that is being read.
    run: usize,
    /// Whether the last token, not counting blanks, is a dot.
    after_dot: bool,
}

/// Refuses a text that is nested deeper than [`MOST_LEVELS`], or in which a bracket is closed by a
/// bracket of another kind.
pub(super) fn check_nesting(text: &str) -> Result<(), TomlError> {
    let mut nesting = Nesting::default();
    let source = Source::new(text);
    source.lex().try_for_each(|token| {
        let refused = |message| TomlError::at_byte(text, token.span().start(), message);
        nesting.count(&token, text).map_err(refused)?;
        if nesting.levels() > MOST_LEVELS { Err(refused(nesting.too_deep(text))) } else { Ok(()) }
    })
}

impl Nesting {
    fn count(&mut self, token: &Token, text: &str) -> Result<(), String> {
        use TokenKind as Kind;
        let start = token.span().start();
        match token.kind() {
            Kind::Whitespace => return Ok(()),
            Kind::Dot => self.dot(),
            Kind::Atom
            | Kind::LiteralString
            | Kind::BasicString
            | Kind::MlLiteralString
            | Kind::MlBasicString
                if self.after_dot => {}
            Kind::LeftSquareBracket | Kind::LeftCurlyBracket => self.enter(token.kind(), start),
            Kind::RightSquareBracket | Kind::RightCurlyBracket => self.leave(token.kind(), text)?,
            _ => self.run = 0,
        }
        self.after_dot = token.kind() == Kind::Dot;
        Ok(())
    }

    /// Counts a dot of a key, or of a number.
    fn dot(&mut self) {
        self.run += 1;
        let most = match self.open.last_mut() {
            Some(open) => &mut open.dots,
            None => &mut self.outside,
        };
        if self.run > *most {
            *most = self.run;
            // Outside brackets, `levels` adds the dots from `outside`.
            self.inside += usize::from(!self.open.is_empty());
        }
    }

    fn enter(&mut self, kind: TokenKind, start: usize) {
        self.run = 0;
        self.inside += 1;
        self.open.push(Open { kind, start, dots: 0 });
    }

    fn leave(&mut self, kind: TokenKind, text: &str) -> Result<(), String> {
        self.run = 0;
        let Some(open) = self.open.pop() else {
            // The parser reports this error itself, and does not recurse there.
            return Ok(());
        };
        let (opened, closing) = match open.kind {
            TokenKind::LeftSquareBracket => ('[', ']'),
            _ => ('{', '}'),
        };
        let same = (kind == TokenKind::RightSquareBracket) == (closing == ']');
        if !same {
            let (line, column) = place(text, open.start);
            return Err(format!(
                "expected `{closing}`, which closes the `{opened}` of line {line}, column {column}"
            ));
        }
        self.inside -= 1 + open.dots;
        // The name of a table is written in brackets, and applies to all keys that follow.
        if self.open.is_empty() {
            self.outside = self.outside.max(open.dots);
        }
        Ok(())
    }

    /// Returns the number of levels at this token. A table's name and a key outside brackets may
    /// each have the most dots, so they count twice.
    fn levels(&self) -> usize {
        2 * self.outside + self.inside
    }

    fn too_deep(&self, text: &str) -> String {
        let mut message =
            format!("tables and arrays are nested deeper than {MOST_LEVELS} levels here");
        if let Some(first) = self.open.first() {
            let (line, column) = place(text, first.start);
            message += &format!("; the first open bracket is in line {line}, column {column}");
        }
        message
    }
}
