//! Tests that no text makes the parser overflow a small stack.

use serde_json::Value;

use super::*;

/// Stack size of a thread, bytes: an eighth of what a thread usually has.
const STACK: usize = 256 << 10;

/// Reads a text as a table of any values, on a small stack.
fn read(text: &str) -> Result<Value, TomlError> {
    let text = text.to_owned();
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(move || {
        lines_of_keys(&text, [&["a".to_owned()][..]]);
        from_str::<Value>(&text)
    });
    thread.unwrap().join().unwrap()
}

/// Tests all lines of up to three of these pieces, repeated: brackets, keys, values, quotes,
/// comments, and errors of each.
#[test]
fn no_text_overflows_a_small_stack() {
    let pieces = [
        "[",
        "]",
        "{",
        "}",
        "[[",
        "]]",
        "a",
        "a.b.c",
        "=",
        "a={",
        "a=[",
        "'",
        "\"",
        ",",
        "\n",
        "#",
        ".",
        "1.5",
        "'x'",
        "{a=",
        "motion = { const']",
        "phases = ['testing']",
        "\r",
        "\"\"\"",
    ];
    for one in pieces {
        for two in pieces {
            for three in pieces {
                let line = format!("{one}{two}\n{three}");
                let _ = read(&line.repeat(400));
            }
        }
    }
}

#[test]
fn what_is_nested_too_deeply_is_named_with_its_place() {
    let unclosed = "motion = { const']\nphases = ['testing']\n".repeat(7_200);
    let deep = |open: &str, close: &str, levels: usize| {
        format!("a = {}1{}", open.repeat(levels), close.repeat(levels))
    };
    let names = |dots: usize| "a.".repeat(dots) + "a";
    let both = format!("[{}]\n{} = 1", names(8), names(13));
    let crossed = "a = [\n  { b = 1 ],\n]".to_owned();
    for (text, error) in [
        (unclosed, "line 1, column 18: expected `}`, which closes the `{` of line 1, column 10"),
        (
            "x = { y\n".repeat(7_200),
            "line 25, column 5: tables and arrays are nested deeper than 24 levels here; the first open bracket is in line 1, column 5",
        ),
        (
            deep("[", "]", 25),
            "line 1, column 29: tables and arrays are nested deeper than 24 levels here; the first open bracket is in line 1, column 5",
        ),
        (
            deep("{a.b=", "}", 13),
            "line 1, column 65: tables and arrays are nested deeper than 24 levels here; the first open bracket is in line 1, column 5",
        ),
        (
            format!("{} = 1", names(100_000)),
            "line 1, column 26: tables and arrays are nested deeper than 24 levels here",
        ),
        (both, "line 2, column 26: tables and arrays are nested deeper than 24 levels here"),
        (crossed, "line 2, column 11: expected `}`, which closes the `{` of line 2, column 3"),
    ] {
        let refused = read(&text).map_err(|error| error.to_string());
        assert_eq!(refused, Err(error.to_owned()), "{:.60}", text);
    }
}

#[test]
fn the_deepest_texts_are_read() {
    let deep = |open: &str, close: &str, levels: usize| {
        read(&format!("a = {}1{}", open.repeat(levels), close.repeat(levels)))
    };
    assert!(deep("[", "]", MOST_LEVELS).is_ok());
    assert!(deep("{a=", "}", MOST_LEVELS).is_ok());
    assert!(deep("{a.b=", "}", MOST_LEVELS / 2).is_ok());
    let numbers = "[".to_owned() + &"1.5, ".repeat(10_000) + "]";
    assert!(read(&format!("a = {numbers}")).is_ok());
    let names = "a.".repeat(MOST_LEVELS / 2) + "a";
    assert!(read(&format!("[b.{names}]")).is_err() && read(&format!("{names} = 1")).is_ok());
}

#[test]
fn errors_of_the_parser_keep_their_place() {
    let error = read("name = 'a'\nlist = [1, 2\n").unwrap_err();
    assert_eq!((error.line, error.column), (2, 13));
    let error = from_str::<std::collections::BTreeMap<String, u8>>("é = 1\né2 = 1").unwrap_err();
    assert_eq!((error.line, error.column), (1, 1));
}
