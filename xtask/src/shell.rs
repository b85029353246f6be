//! Parses the part of the shell language that pages use: words, quotes, comments, continued lines,
//! pipes, loops.

/// Returns the simple commands of a script, each as its words. Redirections are left out. A loop's
/// variable is replaced only by its first value.
///
/// ```
/// let script = "# a loop\nfor s in vinyl sand; do\n  htex fit $s.csv \\\n    --name 'A b' | tail -n 1 >log   # fits\ndone\n";
/// assert_eq!(xtask::shell::commands(script)[1], ["htex", "fit", "vinyl.csv", "--name", "A b"]);
/// ```
pub fn commands(script: &str) -> Vec<Vec<String>> {
    let mut reader = Reader::default();
    let mut rest = script.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '\\' => match rest.next() {
                Some('\n') | None => {}
                Some(c) => reader.push(c),
            },
            '\'' | '"' => {
                reader.word.get_or_insert_default();
                let quoted: String = rest.by_ref().take_while(|other| *other != c).collect();
                quoted.chars().for_each(|c| reader.push(c));
            }
            '$' if rest.peek() == Some(&'(') => {
                substituted(&mut rest).chars().for_each(|c| reader.push(c))
            }
            '#' if reader.word.is_none() => while rest.next_if(|c| *c != '\n').is_some() {},
            '>' | '<' => reader.redirect(),
            '\n' | ';' | '|' | '&' | '(' | ')' => reader.end_command(),
            c if c.is_whitespace() => reader.end_word(),
            c => reader.push(c),
        }
    }
    reader.end_command();
    with_loops(reader.commands)
}

/// The state of the parser.
#[derive(Default)]
struct Reader {
    commands: Vec<Vec<String>>,
    words: Vec<String>,
    word: Option<String>,
    /// Whether the next word names a file that is written or read.
    is_redirected: bool,
}

impl Reader {
    fn push(&mut self, c: char) {
        self.word.get_or_insert_default().push(c);
    }

    fn end_word(&mut self) {
        let Some(word) = self.word.take() else {
            return;
        };
        if !std::mem::take(&mut self.is_redirected) {
            self.words.push(word);
        }
    }

    /// Handles `<` or `>`. A digit before the sign is the number of a stream, as in `2>log`.
    fn redirect(&mut self) {
        if self.word.as_deref().is_some_and(|word| word.parse::<u8>().is_ok()) {
            self.word = None;
        }
        self.end_word();
        self.is_redirected = true;
    }

    fn end_command(&mut self) {
        self.end_word();
        self.is_redirected = false;
        if !self.words.is_empty() {
            self.commands.push(std::mem::take(&mut self.words));
        }
    }
}

/// Returns the rest of `$(…)` as one word of the command that contains it.
fn substituted(rest: &mut std::iter::Peekable<std::str::Chars>) -> String {
    let mut depth = 0;
    let inner = rest.take_while(|c| {
        depth += i32::from(*c == '(') - i32::from(*c == ')');
        depth > 0
    });
    format!("${}", inner.filter(|c| c.is_alphanumeric()).collect::<String>())
}

/// Returns the commands without the words of loops, and with values for their variables.
fn with_loops(commands: Vec<Vec<String>>) -> Vec<Vec<String>> {
    let mut values: Vec<(String, String)> = Vec::new();
    let mut filled = Vec::new();
    for mut words in commands {
        if let [first, name, _, value, ..] = &words[..]
            && first == "for"
        {
            values.push((format!("${name}"), value.clone()));
        }
        if words.first().is_some_and(|word| word == "do") {
            words.remove(0);
        }
        for (name, value) in &values {
            for word in &mut words {
                *word = word.replace(name, value);
            }
        }
        if !words.is_empty() {
            filled.push(words);
        }
    }
    filled
}

#[cfg(test)]
mod tests {
    use super::commands;

    #[test]
    fn operators_end_commands_and_signs_in_quotes_do_not() {
        let script = "(printf '80 0.4\\n'; sleep 3) | htex play a.json --motion -   # a.wav\nhtex x \"a | b\" 'c > d' 2>log && htex y #3\n";
        let all = commands(script);
        assert_eq!(all[2], ["htex", "play", "a.json", "--motion", "-"]);
        assert_eq!(all[3], ["htex", "x", "a | b", "c > d"]);
        assert_eq!(all[4], ["htex", "y"]);
    }

    #[test]
    fn a_sign_within_a_word_is_no_comment() {
        assert_eq!(commands("htex fit --map lateral=#2:0.5 -o a")[0][3], "lateral=#2:0.5");
        assert_eq!(commands("cc $(pkg-config --libs htex) -lm")[0].len(), 3);
    }
}
