use std::cmp::Ordering;
use std::fmt::{Display, Formatter};

use clap::Args;
use htex_format::library::{Entry, Library, LibraryFile};
use serde::Serialize;

use super::LibraryArg;
use crate::failure::{Exit, Result, for_file};
use crate::output::show;

/// Compare the textures of two libraries by name and hash; exit status 1 if they differ.
///
/// Prints `-` before a texture that only the first library has, `+` before a texture that only the
/// second library has, and `~` before a texture that differs between the two libraries.
#[derive(Args)]
pub(crate) struct Diff {
    /// Path or URI of the first library
    #[arg(value_parser = LibraryArg::parser())]
    a: LibraryArg,

    /// Path or URI of the second library
    #[arg(value_parser = LibraryArg::parser())]
    b: LibraryArg,

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

/// An iterator over a library's entries that also shows the next entry before it is taken.
struct Walk<'a> {
    library: &'a LibraryArg,
    entries: htex_format::library::Entries<'a, LibraryFile>,
    next: Option<Entry>,
}

impl Diff {
    pub(crate) fn run(self) -> Result {
        let (a, b) = (self.a.open()?, self.b.open()?);
        let differences = compare(Walk::new(&self.a, &a)?, Walk::new(&self.b, &b)?)?;
        show(&differences, self.json)?;
        Ok(Exit::ok_if(differences.is_empty()))
    }
}

impl<'a> Walk<'a> {
    fn new(argument: &'a LibraryArg, library: &'a Library<LibraryFile>) -> Result<Self> {
        let mut walk = Self { library: argument, entries: library.entries(), next: None };
        walk.step()?;
        Ok(walk)
    }

    /// Takes the next entry.
    fn step(&mut self) -> Result<Option<Entry>> {
        let next = self.entries.next().transpose().map_err(for_file(&self.library.shown()))?;
        Ok(std::mem::replace(&mut self.next, next))
    }
}

/// Compares two libraries by walking through both in the order of the names.
fn compare(mut a: Walk<'_>, mut b: Walk<'_>) -> Result<Differences> {
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
}

impl Display for Differences {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        for (sign, names) in [('-', &self.only_in_a), ('+', &self.only_in_b), ('~', &self.changed)]
        {
            names.iter().try_for_each(|name| writeln!(f, "{sign} {name}"))?;
        }
        Ok(())
    }
}
