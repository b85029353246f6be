//! The tokens of a column map.

use std::fmt;

/// A column, by name or by number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnRef {
    /// The name in the header, compared without regard to case.
    Name(String),
    /// The column's number, counted from 1 and written `#3`.
    Number(usize),
}

impl fmt::Display for ColumnRef {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => write!(f, "{name:?}"),
            Self::Number(number) => write!(f, "#{number}"),
        }
    }
}

/// A token, and the bytes of the text that it covers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Token {
    pub(crate) kind: TokenKind,
    pub(crate) start: usize,
    pub(crate) end: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum TokenKind {
    Number(f64),
    Column(ColumnRef),
    Plus,
    Minus,
    Times,
    Over,
    Open,
    Close,
    Comma,
    Colon,
    Equals,
}

/// What is wrong with a text, and the byte at which it is wrong.
#[derive(Debug)]
pub(crate) struct Problem {
    pub(crate) at: Option<usize>,
    pub(crate) what: String,
}

impl Problem {
    pub(crate) fn at_token(token: &Token, what: impl Into<String>) -> Self {
        Self { at: Some(token.start), what: what.into() }
    }

    pub(crate) fn at_end(what: impl Into<String>) -> Self {
        Self { at: None, what: what.into() }
    }

    /// Returns a sentence that states the place in the text, in characters counted from 1.
    pub(crate) fn in_text(self, text: &str) -> String {
        match self.at.and_then(|at| text.get(..at)) {
            Some(before) => format!("character {}: {}", before.chars().count() + 1, self.what),
            None => self.what,
        }
    }
}

/// Splits a column map into tokens.
pub(crate) fn tokens(text: &str) -> Result<Vec<Token>, Problem> {
    let mut tokens: Vec<Token> = Vec::new();
    let mut at = 0;
    while let Some(next) = text[at..].chars().next() {
        if next.is_whitespace() {
            at += next.len_utf8();
            continue;
        }
        let before = tokens.last().map(|token| &token.kind);
        let ends_operand =
            matches!(before, Some(TokenKind::Number(_) | TokenKind::Column(_) | TokenKind::Close));
        let (kind, length) = token(&text[at..], next, ends_operand)
            .map_err(|what| Problem { at: Some(at), what })?;
        tokens.push(Token { kind, start: at, end: at + length });
        at += length;
    }
    Ok(tokens)
}

/// Returns the token at the start of a text, and its length in bytes. `ends_operand` means that an
/// operator may come next.
fn token(text: &str, first: char, ends_operand: bool) -> Result<(TokenKind, usize), String> {
    if let Some(operator) = operator(first)
        // After an operand, a slash is a division. Before an operand, it begins a path.
        && (first != '/' || ends_operand || !path_follows(text))
    {
        return Ok((operator, 1));
    }
    match first {
        '/' => {
            let length = text
                .find(|c: char| c.is_whitespace() || "+-*():,=".contains(c))
                .unwrap_or(text.len());
            Ok((name(&text[..length]), length))
        }
        '#' => numbered(text),
        '"' | '\'' => {
            let inner = &text[1..];
            let length =
                inner.find(first).ok_or_else(|| format!("the quote {first} is not closed"))?;
            Ok((name(&inner[..length]), length + 2))
        }
        _ => match number(text) {
            Some((value, _)) if !value.is_finite() => {
                Err("the number is larger than any that can be computed with".into())
            }
            Some((value, length)) => Ok((TokenKind::Number(value), length)),
            None => {
                let bare = text[..name_length(text)].trim_end();
                Ok((name(bare), bare.len()))
            }
        },
    }
}

fn operator(c: char) -> Option<TokenKind> {
    Some(match c {
        '+' => TokenKind::Plus,
        '-' => TokenKind::Minus,
        '*' => TokenKind::Times,
        '/' => TokenKind::Over,
        '(' => TokenKind::Open,
        ')' => TokenKind::Close,
        ',' => TokenKind::Comma,
        ':' => TokenKind::Colon,
        '=' => TokenKind::Equals,
        _ => return None,
    })
}

fn name(text: &str) -> TokenKind {
    TokenKind::Column(ColumnRef::Name(text.to_owned()))
}

/// Whether the `/` at the start begins a path.
fn path_follows(text: &str) -> bool {
    let next = text.chars().nth(1);
    next.is_some_and(|c| !c.is_whitespace() && !"+-*():,=/".contains(c))
}

fn numbered(text: &str) -> Result<(TokenKind, usize), String> {
    let length = 1 + text[1..].find(|c: char| !c.is_alphanumeric()).unwrap_or(text.len() - 1);
    match text[1..length].parse() {
        Ok(number) if number > 0 => Ok((TokenKind::Column(ColumnRef::Number(number)), length)),
        _ => Err(format!("{:?} is not a column number; the first column is #1", &text[..length])),
    }
}

/// Returns the number at the start and its length. `None` if a name begins with digits, as in
/// `5V_supply`.
fn number(text: &str) -> Option<(f64, usize)> {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        let rest = bytes.get(from..).unwrap_or_default();
        rest.iter().take_while(|b| b.is_ascii_digit()).count()
    };
    let integer = digits(0);
    let mut length = integer;
    let mut decimals = 0;
    if bytes.get(length) == Some(&b'.') {
        decimals = digits(length + 1);
        length += 1 + decimals;
    }
    if integer + decimals == 0 {
        return None;
    }
    if let Some(b'e' | b'E') = bytes.get(length) {
        let sign = matches!(bytes.get(length + 1), Some(b'+' | b'-'));
        let exponent = digits(length + 1 + usize::from(sign));
        if exponent > 0 {
            length += 1 + usize::from(sign) + exponent;
        }
    }
    let next = text[length..].chars().next();
    let ends = next.is_none_or(|c| c.is_whitespace() || operator(c).is_some());
    ends.then(|| text[..length].parse().ok())?.map(|value| (value, length))
}

/// Returns the length of the name at the start; it ends at an operator outside brackets.
fn name_length(text: &str) -> usize {
    let mut closing: Option<char> = None;
    for (at, c) in text.char_indices() {
        match (closing, c) {
            (Some(end), _) if c == end => closing = None,
            (Some(_), _) => {}
            (None, '[') => closing = closes(&text[at..], ']'),
            // An opening bracket without a closing one belongs to the expression, as in `a*(b`, and
            // ends the name.
            (None, '(') => match closes(&text[at..], ')') {
                None => return at,
                end => closing = end,
            },
            (None, _) if operator(c).is_some() => return at,
            _ => {}
        }
    }
    text.len()
}

/// Returns the closing bracket, for example of a unit, if it comes before the next comma.
fn closes(text: &str, end: char) -> Option<char> {
    let here = text.find([end, ','])?;
    text[here..].starts_with(end).then_some(end)
}
