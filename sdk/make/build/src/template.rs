//! Texts with placeholders, such as `{stem}` or `{material} at {speed} mm/s`.

use std::collections::BTreeMap;

/// The values of placeholders, by name.
pub(crate) type Fields = BTreeMap<String, String>;

/// Largest length of a filled text up to its last placeholder, bytes.
const MOST_BYTES: usize = 65_536;

/// Fills the placeholders of a text. `{{` and `}}` stand for literal braces.
pub(crate) fn fill(text: &str, fields: &Fields) -> Result<String, String> {
    let (mut filled, mut rest) = (String::new(), text);
    while let Some(at) = rest.find(['{', '}']) {
        filled.push_str(&rest[..at]);
        if filled.len() > MOST_BYTES {
            return Err(format!(
                "it has more than {MOST_BYTES} bytes when it is filled; shorten it"
            ));
        }
        let brace = &rest[at..=at];
        rest = &rest[at + 1..];
        if let Some(after) = rest.strip_prefix(brace) {
            filled.push_str(brace);
            rest = after;
        } else if brace == "{" {
            let (name, after) = rest
                .split_once('}')
                .ok_or_else(|| format!("`{text}`: a `{{` without `}}`; write {{{{ for a brace"))?;
            filled.push_str(value(text, name, fields)?);
            rest = after;
        } else {
            return Err(format!("`{text}`: a `}}` without `{{`; write }}}} for a brace"));
        }
    }
    filled.push_str(rest);
    Ok(filled)
}

fn value<'a>(text: &str, name: &str, fields: &'a Fields) -> Result<&'a str, String> {
    let value = fields.get(name).map(String::as_str);
    value.ok_or_else(|| {
        let known: Vec<&str> = fields.keys().map(String::as_str).collect();
        format!("`{text}`: nothing is called `{name}`; there are {}", known.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn placeholders_are_filled_and_unknown_ones_are_named() {
        let fields = Fields::from([("stem".to_owned(), "vinyl_80".to_owned())]);
        let fill = |text| fill(text, &fields);
        assert_eq!(fill("a {stem} {{x}}").as_deref(), Ok("a vinyl_80 {x}"));
        assert_eq!(fill("plain").as_deref(), Ok("plain"));
        assert!(fill("{speed}").is_err_and(|e| e.contains("there are stem")));
        assert!(fill("{stem").is_err());
        assert!(fill("stem}").is_err());
    }
}
