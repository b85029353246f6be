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
    /// A listed licence. `gnu` is true for a GNU licence, whose id itself states whether later
    /// versions are allowed (`-only`, `-or-later`).
    License {
        gnu: bool,
    },
    LicenseRef,
    Exception,
    AdditionRef,
    Unlisted,
    Plus,
    Open,
    Close,
    With,
    And,
    Or,
}

/// Returns whether the name of a licence, including its exception if it has one, may end at this
/// token.
const fn ends_term(token: Option<Token>) -> bool {
    use Token::{AdditionRef, Close, Exception, License, LicenseRef, Plus, Unlisted};
    matches!(
        token,
        Some(License { .. } | LicenseRef | Exception | AdditionRef | Close | Plus | Unlisted)
    )
}

/// Returns whether a licence or an opening parenthesis may follow this token.
const fn begins_term(token: Option<Token>) -> bool {
    matches!(token, None | Some(Token::And | Token::Or | Token::Open))
}

/// Says what may follow a token, for error messages.
const fn unexpected(last: Option<Token>) -> &'static str {
    use Token::{
        AdditionRef, And, Close, Exception, License, LicenseRef, Open, Or, Plus, Unlisted, With,
    };
    match last {
        None | Some(And | Or | Open) => "expected one of `<license>`, `(` here",
        Some(Close) => "expected one of `AND`, `OR` here",
        Some(Exception | AdditionRef) => "expected one of `AND`, `OR`, `)` here",
        Some(License { .. } | Unlisted) => "expected one of `AND`, `OR`, `WITH`, `)`, `+` here",
        Some(LicenseRef | Plus) => "expected one of `AND`, `OR`, `WITH`, `)` here",
        Some(With) => "expected a `<addition>` here",
    }
}

/// Checks an expression against the grammar. Returns the first unlisted id, if there is one.
///
/// # Errors
/// If the expression breaks the grammar. The text says what is wrong.
pub(super) fn check(expression: &str) -> Result<Option<&str>, &'static str> {
    let (mut rest, mut last, mut open, mut unlisted) = (expression, None, 0_usize, None);
    loop {
        let text = rest.trim_start();
        let follows_space = text.len() < rest.len();
        let Some(first) = text.chars().next() else {
            break;
        };
        let (token, len) = token(first, text, follows_space)?;
        let fits = match token {
            Token::License { .. } | Token::LicenseRef | Token::Open => begins_term(last),
            Token::Plus => matches!(last, Some(Token::License { .. })),
            Token::With => matches!(
                last,
                Some(Token::License { .. } | Token::LicenseRef | Token::Plus | Token::Unlisted)
            ),
            Token::And | Token::Or | Token::Close => ends_term(last),
            Token::Exception | Token::AdditionRef => last == Some(Token::With),
            // An id that is in neither list may be a newer licence or a newer exception, so it fits
            // in both places.
            Token::Unlisted => begins_term(last) || last == Some(Token::With),
        };
        if !fits {
            return Err(unexpected(last));
        }
        match token {
            Token::Plus if last == Some(Token::License { gnu: true }) => {
                return Err("a GNU license was followed by a `+`");
            }
            Token::Open => open += 1,
            Token::Close => open = open.checked_sub(1).ok_or("unopened parens")?,
            Token::Unlisted => unlisted = unlisted.or(text.get(..len)),
            _ => {}
        }
        last = Some(token);
        rest = text.get(len..).unwrap_or_default();
    }
    match (last, open) {
        (None, _) => Err("empty expression"),
        (last, _) if !ends_term(last) => Err(unexpected(last)),
        (_, 0) => Ok(unlisted),
        _ => Err("unclosed parens"),
    }
}

/// Returns the token at the start of a text, and its length.
fn token(first: char, text: &str, follows_space: bool) -> Result<(Token, usize), &'static str> {
    match first {
        '+' if follows_space => return Err("`+` must not follow whitespace"),
        '+' => return Ok((Token::Plus, 1)),
        '(' => return Ok((Token::Open, 1)),
        ')' => return Ok((Token::Close, 1)),
        _ => {}
    }
    let end = text.find(|c: char| !(is_of_id(c) || c == ':'));
    let word = text.get(..end.unwrap_or(text.len())).unwrap_or_default();
    if word.is_empty() {
        return Err("invalid character(s)");
    }
    let token = match word {
        "AND" | "and" => Token::And,
        "OR" | "or" => Token::Or,
        "WITH" | "with" => Token::With,
        _ if is_listed(LICENSES, word) => Token::License { gnu: is_gnu(word) },
        _ if is_listed(EXCEPTIONS, word) => Token::Exception,
        _ => return Ok(reference(word).unwrap_or((Token::Unlisted, word.len()))),
    };
    Ok((token, word.len()))
}

/// Parses `LicenseRef-NAME` or `AdditionRef-NAME`, after `DocumentRef-NAME:` if it is in another
/// document.
fn reference(word: &str) -> Option<(Token, usize)> {
    let document =
        word.split_once(':').filter(|(document, _)| document.starts_with("DocumentRef-"));
    let (before, own) = match document {
        Some((document, own)) => (document.len() + 1, own),
        None => (0, word),
    };
    let token = match own {
        _ if own.starts_with("LicenseRef-") => Token::LicenseRef,
        _ if own.starts_with("AdditionRef-") => Token::AdditionRef,
        _ => return None,
    };
    Some((token, before + own.find(':').unwrap_or(own.len())))
}

fn is_of_id(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '-' || c == '.'
}

/// Returns whether an id is a line of a list. The lists are sorted by their bytes, so a binary
/// search finds the id. The search is fast because opening any asset with a licence needs it.
fn is_listed(mut list: &str, id: &str) -> bool {
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
    use std::string::ToString;

    use proptest::prelude::*;
    use spdx::identifiers::{EXCEPTIONS as ALL_EXCEPTIONS, LICENSES as ALL};
    use spdx::{Expression, ParseMode};

    use super::*;

    /// The standard's grammar and list. Deprecated ids still count as licences.
    const LISTED: ParseMode = ParseMode { allow_deprecated: true, ..ParseMode::STRICT };

    /// Returns what the crate `spdx` says about an expression.
    fn expected(license: &str) -> Result<Option<String>, String> {
        let Err(unlisted) = Expression::parse_mode(license, LISTED) else {
            return Ok(None);
        };
        let any_id = ParseMode { allow_unknown: true, ..LISTED };
        match Expression::parse_mode(license, any_id) {
            Ok(_) => Ok(license.get(unlisted.span).map(str::to_owned)),
            Err(error) => Err(error.reason.to_string()),
        }
    }

    fn found(license: &str) -> Result<Option<String>, String> {
        let checked = check(license).map(|id| id.map(str::to_owned));
        checked.map_err(str::to_owned)
    }

    #[test]
    fn the_lists_are_those_of_the_standard() {
        let ids: Vec<&str> = ALL.iter().map(|license| license.name).collect();
        assert_eq!(LICENSES.lines().collect::<Vec<_>>(), ids);
        let ids: Vec<&str> = ALL_EXCEPTIONS.iter().map(|one| one.name).collect();
        assert_eq!(EXCEPTIONS.lines().collect::<Vec<_>>(), ids);
        for license in ALL {
            for expression in [license.name.to_owned(), format!("{}+", license.name)] {
                assert_eq!(found(&expression), expected(&expression), "{expression}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn any_expression_is_judged_as_by_the_crate(words in prop::collection::vec(prop::sample::select(vec![
            "MIT", "GPL-2.0", "GPL-3.0-only", "CC-BY-4.0", "LLVM-exception", "LicenseRef-a", "LicenseRef-", "LicenseRef-a:b",
            "DocumentRef-b:LicenseRef-c", "DocumentRef-:AdditionRef-d", "DocumentRef-b:e", "AdditionRef-f", "mit", "none", "AND", "and",
            "OR", "or", "WITH", "with", "And", "+", "(", ")", " ", " ", "\u{a0}", "\t", "/", "ä", ":", "",
        ]), 0..9), spaced: bool) {
            let expression = words.join(if spaced { " " } else { "" });
            prop_assert_eq!(found(&expression), expected(&expression), "{:?}", expression);
        }
    }
}
