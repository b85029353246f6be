//! The grammar of SPDX expressions.
//!
//! The lists of ids come from the crate `spdx`. This module does not use the crate itself, because
//! the crate also contains the full names of all licences and is four times as large. A test
//! compares this module with the crate.

use core::cmp::Ordering;

/// Licence ids, one per line, spelled as in the standard.
const LICENSES: &str = include_str!("licenses.txt");
/// Ids of exceptions, one per line.
const EXCEPTIONS: &str = include_str!("exceptions.txt");

#[derive(Clone, Copy, PartialEq, Eq)]
enum Token {
    /// A licence: a listed id, or `LicenseRef-NAME`.
    License,
    Exception,
    AdditionRef,
    /// An id in neither list. The id may be a newer licence or a newer exception.
    Unlisted,
    Open,
    Close,
    With,
    And,
    Or,
}

/// Returns whether the name of a licence, including its exception if it has one, may end at this
/// token.
const fn ends_term(token: Option<Token>) -> bool {
    use Token::{AdditionRef, Close, Exception, License, Unlisted};
    matches!(token, Some(License | Exception | AdditionRef | Close | Unlisted))
}

/// Returns whether a licence or an opening parenthesis may follow this token.
const fn begins_term(token: Option<Token>) -> bool {
    matches!(token, None | Some(Token::And | Token::Or | Token::Open))
}

/// Says what may follow a token, for error messages.
const fn unexpected(last: Option<Token>, has_addition: bool) -> &'static str {
    match last {
        None | Some(Token::And | Token::Or | Token::Open) => {
            "expected one of `<license>`, `(` here"
        }
        Some(Token::With) => "expected a `<addition>` here",
        Some(Token::Close) => "expected one of `AND`, `OR`, `)` here",
        Some(_) if has_addition => "expected one of `AND`, `OR`, `)` here",
        Some(_) => "expected one of `AND`, `OR`, `WITH`, `)` here",
    }
}

/// Checks an expression against the grammar. Returns the first unlisted id, if there is one.
///
/// # Errors
/// If the expression breaks the grammar. The text says what is wrong.
pub(super) fn check(expression: &str) -> Result<Option<&str>, &'static str> {
    let (mut rest, mut last, mut open, mut unlisted) = (expression, None, 0_usize, None);
    // Whether the previous licence already has an exception. A second exception is not allowed.
    let mut has_addition = false;
    loop {
        let text = rest.trim_start_matches(is_space);
        if text.is_empty() {
            break;
        }
        let (token, len) = token(text, last == Some(Token::With))?;
        let fits = match token {
            Token::License | Token::Open => begins_term(last),
            Token::With => matches!(last, Some(Token::License | Token::Unlisted)) && !has_addition,
            Token::And | Token::Or | Token::Close => ends_term(last),
            Token::Exception | Token::AdditionRef => last == Some(Token::With),
            Token::Unlisted => begins_term(last) || last == Some(Token::With),
        };
        if !fits {
            return Err(unexpected(last, has_addition));
        }
        match token {
            Token::Open => open += 1,
            Token::Close => open = open.checked_sub(1).ok_or("unopened parens")?,
            Token::Unlisted => unlisted = unlisted.or(text.get(..len)),
            _ => {}
        }
        has_addition = last == Some(Token::With);
        last = Some(token);
        rest = text.get(len..).unwrap_or_default();
    }
    match (last, open) {
        (None, _) => Err("empty expression"),
        (last, _) if !ends_term(last) => Err(unexpected(last, has_addition)),
        (_, 0) => Ok(unlisted),
        _ => Err("unclosed parens"),
    }
}

/// The white space of ASCII. White space of Unicode outside ASCII does not separate words.
const fn is_space(c: char) -> bool {
    matches!(c, '\t'..='\r' | ' ')
}

/// Returns the token at the start of a text, and its length. After `WITH`, a word is the name of an
/// exception. Elsewhere it is the name of a licence.
fn token(text: &str, is_addition: bool) -> Result<(Token, usize), &'static str> {
    if text.starts_with('(') {
        return Ok((Token::Open, 1));
    }
    if text.starts_with(')') {
        return Ok((Token::Close, 1));
    }
    let is_of_word = |c: char| is_of_id(c) || matches!(c, ':' | '+');
    let end = text.find(|c: char| !is_of_word(c));
    let word = text.get(..end.unwrap_or(text.len())).unwrap_or_default();
    if word.is_empty() {
        return Err("invalid character(s)");
    }
    let token = match word {
        "AND" | "and" => Token::And,
        "OR" | "or" => Token::Or,
        "WITH" | "with" => Token::With,
        _ if is_addition && is_listed(EXCEPTIONS, word) => Token::Exception,
        _ if !is_addition && is_listed(LICENSES, word) => Token::License,
        _ => match (reference(word), word.strip_suffix('+')) {
            (Some(token), _) => token?,
            (None, Some("")) => return Err("`+` must not follow whitespace"),
            (None, Some(id)) if !is_listed(LICENSES, id) => {
                return Err("`+` must follow a listed license");
            }
            (None, Some(id)) if is_gnu(id) => {
                return Err("a GNU license was followed by a `+`");
            }
            (None, Some(_)) => Token::License,
            (None, None) if word.chars().all(is_of_id) => Token::Unlisted,
            (None, None) => return Err("invalid character(s)"),
        },
    };
    Ok((token, word.len()))
}

/// Parses `LicenseRef-NAME` or `AdditionRef-NAME`. If the text is in another document,
/// `DocumentRef-NAME:` precedes it. Returns `None` for a word that begins with none of these.
fn reference(word: &str) -> Option<Result<Token, &'static str>> {
    let is_name = |name: &str| !name.is_empty() && name.chars().all(is_of_id);
    let (own, is_document) = match word.strip_prefix("DocumentRef-") {
        Some(rest) => match rest.split_once(':') {
            Some((document, own)) if is_name(document) => (own, true),
            _ => return Some(Err("expected `DocumentRef-NAME:`")),
        },
        None => (word, false),
    };
    let named = |name: &str, token| {
        Some(if is_name(name) { Ok(token) } else { Err("a reference has no valid name") })
    };
    if let Some(name) = own.strip_prefix("LicenseRef-") {
        return named(name, Token::License);
    }
    if let Some(name) = own.strip_prefix("AdditionRef-") {
        return named(name, Token::AdditionRef);
    }
    is_document.then_some(Err("expected `LicenseRef-NAME` or `AdditionRef-NAME`"))
}

fn is_of_id(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '-' || c == '.'
}

/// Returns whether an id is a line of a list. The lists are sorted by their bytes, so a binary
/// search finds the id. The search is fast because opening any asset with a licence needs it.
fn is_listed(mut list: &str, id: &str) -> bool {
    // Some deprecated ids end in `+`, but here `+` is not a character of an id.
    if !id.chars().all(is_of_id) {
        return false;
    }
    while !list.is_empty() {
        let (before, after) = list.split_at_checked(list.len() / 2).unwrap_or_default();
        let begin = before.rfind('\n').map_or(0, |end| end + 1);
        let length = after.find('\n').map_or(list.len(), |end| before.len() + end) - begin;
        let listed = list.get(begin..begin + length).unwrap_or_default();
        list = match listed.cmp(id) {
            Ordering::Equal => return true,
            Ordering::Less => list.get(begin + length + 1..).unwrap_or_default(),
            Ordering::Greater => list.get(..begin).unwrap_or_default(),
        };
    }
    false
}

fn is_gnu(id: &str) -> bool {
    ["AGPL-", "GFDL-", "GPL-", "LGPL-"].iter().any(|family| id.starts_with(family))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use spdx::identifiers::{EXCEPTIONS as ALL_EXCEPTIONS, LICENSES as ALL};
    use spdx::{Expression, ParseMode};

    use super::*;

    /// The standard's grammar and list. Deprecated ids still count as licences.
    const LISTED: ParseMode = ParseMode { allow_deprecated: true, ..ParseMode::STRICT };

    /// Returns what the crate `spdx` says about an expression. The result for a wrong expression
    /// contains no text, because the crate has its own error texts.
    fn expected(license: &str) -> Result<Option<String>, ()> {
        let Err(unlisted) = Expression::parse_mode(license, LISTED) else {
            return Ok(None);
        };
        let any_id = ParseMode { allow_unknown: true, ..LISTED };
        match Expression::parse_mode(license, any_id) {
            Ok(_) => Ok(license.get(unlisted.span).map(str::to_owned)),
            Err(_) => Err(()),
        }
    }

    fn found(license: &str) -> Result<Option<String>, ()> {
        let checked = check(license).map(|id| id.map(str::to_owned));
        checked.map_err(drop)
    }

    #[test]
    fn the_lists_are_those_of_the_standard() {
        // The crate also lists a word for "no statement", which is not a licence.
        let licenses = || ALL.iter().filter(|license| license.name != "NOASSERTION");
        let ids: Vec<&str> = licenses().map(|license| license.name).collect();
        assert_eq!(LICENSES.lines().collect::<Vec<_>>(), ids);
        let ids: Vec<&str> = ALL_EXCEPTIONS.iter().map(|one| one.name).collect();
        assert_eq!(EXCEPTIONS.lines().collect::<Vec<_>>(), ids);
        for license in licenses() {
            for expression in [license.name.to_owned(), format!("{}+", license.name)] {
                assert_eq!(found(&expression), expected(&expression), "{expression}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        /// The crate is stricter if an id is from the wrong list, and less strict about references
        /// and white space. Therefore, in this test exceptions occur only after `WITH`, and all
        /// words are separated.
        #[test]
        fn any_expression_is_judged_as_by_the_crate(words in prop::collection::vec(prop::sample::select(vec![
            "MIT", "GPL-2.0", "GPL-3.0-only", "CC-BY-4.0", "LicenseRef-a", "DocumentRef-b:LicenseRef-c", "mit", "none",
            "MIT+", "GPL-2.0+", "mit+", "LicenseRef-a+", "WITH LLVM-exception", "with AdditionRef-f",
            "WITH DocumentRef-d:AdditionRef-e", "WITH LLVM-exception+", "AND", "and", "OR", "or", "And", "+",
            "(", ")", "/", "ä", "",
        ]), 0..9)) {
            let expression = words.join(" ");
            prop_assert_eq!(found(&expression), expected(&expression), "{:?}", expression);
        }
    }
}
