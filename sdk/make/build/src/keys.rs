//! Finds keys in a recipe that the recipe's schema does not define. Without this check, a misspelt
//! key would silently have no effect.

use htex_base::files::toml::lines_of_keys;
use serde_json::Value;

use crate::{BuildError, recipe_schema};

/// Largest number of keys in one message.
const MOST_NAMED: usize = 20;

/// Refuses unknown keys in a recipe. Reports each with its line and the most similar known key.
pub(crate) fn check_keys(text: &str, recipe: &Value) -> Result<(), BuildError> {
    let unknown = htex_base::schema::unknown_keys(&recipe_schema(), recipe);
    let named = &unknown[..unknown.len().min(MOST_NAMED)];
    let lines = lines_of_keys(text, named.iter().map(|key| &key.path[..]));
    let sentence = |(key, line): (&htex_base::schema::UnknownKey, Option<usize>)| match line {
        Some(line) => format!("line {line}: {key}"),
        None => key.to_string(),
    };
    let mut sentences: Vec<String> = named.iter().zip(lines).map(sentence).collect();
    if unknown.len() > named.len() {
        let more = unknown.len() - named.len();
        sentences.push(format!("and {more} more keys that recipes do not have"));
    }
    if sentences.is_empty() { Ok(()) } else { Err(BuildError::Recipe(sentences.join("\n"))) }
}

#[cfg(test)]
mod tests {
    use crate::Recipe;

    /// A misspelt key in any table of a recipe is reported with its line and the intended key.
    #[test]
    fn unknown_keys_are_refused() {
        let texts = [
            (
                "[defaults]\nlicence = 'CC-BY-4.0'",
                "line 5: there is no key `defaults.licence`; did you mean `license`?",
            ),
            (
                "[defaults]\nstrict = true",
                "line 5: there is no key `defaults.strict`; correct it, or leave it out",
            ),
            (
                "[defaults]\nname = 'a'",
                "line 5: there is no key `defaults.name`; correct it, or leave it out",
            ),
            (
                "[defaults]\nmost_values = 9",
                "line 5: there is no key `defaults.most_values`; correct it, or leave it out",
            ),
            (
                "[defaults.gates]\nmin_segmens = 9",
                "line 5: there is no key `defaults.gates.min_segmens`; did you mean `min_segments`?",
            ),
            (
                "[[textures]]\n\n'licence' = 'MIT'",
                "line 6: there is no key `textures[1].licence`; did you mean `license`?",
            ),
            (
                "[[textures]]\nat = { speed = 80 }",
                "line 5: there is no key `textures[1].at.speed`; did you mean `speed_mm_s`?",
            ),
            (
                "[[overrides]]\ntextures = ['a']\nlicence = 'MIT'",
                "line 6: there is no key `overrides[0].licence`; did you mean `license`?",
            ),
            ("[librarie]", "line 4: there is no key `librarie`; did you mean `library`?"),
        ];
        for (added, expected) in texts {
            let text = format!("library.name = 'a'\n[[textures]]\nrecordings = '*.csv'\n{added}");
            let refused = Recipe::parse(&text).map_err(|error| error.to_string());
            assert_eq!(refused, Err(expected.to_owned()), "{added}");
        }
    }

    #[test]
    fn options_and_lists_are_read_as_they_were() {
        let text = "library.name = 'a'\n[[textures]]\nrecordings = ['a', 'b']\nname = '{stem}'\ngrid = 'auto'\n\
                    tracker = '{stem}.trk'\noptions.ar.order = 6\noptions.'org.htex.mfcc'.inverse = 'nnls'";
        let recipe = Recipe::parse(text)
            .map_err(|error| error.to_string())
            .unwrap_or_else(|e| panic!("{e}"));
        let textures = &recipe.textures[0];
        assert_eq!(
            (&textures.recordings[..], textures.name.as_deref()),
            (&["a".to_owned(), "b".to_owned()][..], Some("{stem}"))
        );
        assert_eq!(textures.settings.metadata.name, None);
        let fit = textures.settings.fit();
        assert_eq!(fit.grid, Some(vec!["auto".to_owned()]));
        let options: Vec<String> =
            fit.options.iter().map(|(name, value)| format!("{name}={value}")).collect();
        assert_eq!(options, ["ar.order=6", "org.htex.mfcc.inverse=nnls"]);
        assert_eq!(textures.settings.reading.tracker, Some(vec!["{stem}.trk".into()]));
    }
}
