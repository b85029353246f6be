use std::cmp::Ordering;

use clap::Args;
use htex_format::library::{Entry, Library, LibraryFile};
use serde::Serialize;

use super::given::Given;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::of_file::of_file;
use crate::output::{print, print_json};

/// Compare the textures of two libraries by name and hash; exit status 1 if they differ.
#[derive(Args)]
pub(crate) struct Diff {
    /// A library, a path or URI
    #[arg(value_parser = Given::parser())]
    a: Given,

    /// Another library
    #[arg(value_parser = Given::parser())]
    b: Given,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The names of textures that differ.
#[derive(Default, Serialize)]
struct Differences {
    only_in_a: Vec<String>,
    only_in_b: Vec<String>,
    changed: Vec<String>,
}

/// An iterator over a library's entries that knows the next one.
struct Walk<'a> {
    given: &'a Given,
    entries: htex_format::library::Entries<'a, LibraryFile>,
    next: Option<Entry>,
}

impl Diff {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let (a, b) = (self.a.open()?, self.b.open()?);
        let differences = compare(Walk::new(&self.a, &a)?, Walk::new(&self.b, &b)?)?;
        if self.json {
            print_json(&differences)?;
        } else {
            print(&differences.to_text())?;
        }
        Ok(if differences.is_empty() { Exit::SUCCESS } else { Exit::FAILURE })
    }
}

impl<'a> Walk<'a> {
    fn new(given: &'a Given, library: &'a Library<LibraryFile>) -> Result<Self, Failure> {
        let entries = library.entries();
        let mut walk = Self { given, entries, next: None };
        walk.step()?;
        Ok(walk)
    }

    /// Takes the next entry.
    fn step(&mut self) -> Result<Option<Entry>, Failure> {
        let next = self.entries.next().transpose().map_err(of_file(&self.given.shown()))?;
        Ok(std::mem::replace(&mut self.next, next))
    }
}

/// Walks through both libraries in the order of the names.
fn compare(mut a: Walk<'_>, mut b: Walk<'_>) -> Result<Differences, Failure> {
    let mut differences = Differences::default();
    loop {
        let order = match (&a.next, &b.next) {
            (None, None) => return Ok(differences),
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (Some(a), Some(b)) => a.name.cmp(&b.name),
        };
        // Only one entry of each library is in memory, because a library may have any number of
        // them.
        let ours = if order.is_le() { a.step()? } else { None };
        let theirs = if order.is_ge() { b.step()? } else { None };
        match (ours, theirs) {
            (Some(a), Some(b)) if a.blake3 != b.blake3 => differences.changed.push(a.name),
            (Some(a), None) => differences.only_in_a.push(a.name),
            (None, Some(b)) => differences.only_in_b.push(b.name),
            _ => {}
        }
    }
}

impl Differences {
    fn is_empty(&self) -> bool {
        self.only_in_a.is_empty() && self.only_in_b.is_empty() && self.changed.is_empty()
    }

    fn to_text(&self) -> String {
        let lines = |sign: char, names: &[String]| -> String {
            names.iter().map(|name| format!("{sign} {name}\n")).collect()
        };
        lines('-', &self.only_in_a) + &lines('+', &self.only_in_b) + &lines('~', &self.changed)
    }
}
