//! A leaf page: entries with consecutive names, stored column by column.
//!
//! Columns help compression: hashes take most of a page and cannot be compressed, but the other
//! columns can. The writer fills a page up to a fixed unpacked size. To fill a page up to a
//! compressed size, the writer would have to compress the page several times.

use crate::{Contact, Exponent, ExponentSource, Law, MOST_EXPONENT, Quantity};

use crate::library::entry::{Conditions, Cut, Entry, Interval, TexturePlace};
use crate::library::facts::MOST_WORDS;
use crate::library::fault::{Fault, entry_place, leaf_place};
use crate::library::header::{Header, MINOR};
use crate::library::limits::Limits;
use crate::library::name::check_name;
use crate::library::root::Root;
use crate::library::rules as rule;
use crate::library::wire::{Cursor, WireError};

/// Smallest size of an entry, bytes: its hash, three exponents, and one byte in most columns.
// A name has two lengths. The other columns that have at least one byte per entry are tags, models,
// conditions, law, own length and number of cuts.
const LEAST_ENTRY_BYTES: usize = 32 + 3 * 8 + 2 + 6;
/// Largest number of shared objects in a texture: the largest number of entries in its archive.
pub(crate) const MOST_CUTS: usize = 256;

/// Bits in the column of conditions: whether speed and force are known, and whether each is a
/// single number.
pub(crate) const SPEED: u8 = 1;
pub(crate) const FORCE: u8 = 2;
pub(crate) const ONE_SPEED: u8 = 4;
pub(crate) const ONE_FORCE: u8 = 8;

/// The contacts and the sources of exponents. The column of laws stores their indices in these
/// lists.
pub(crate) const CONTACTS: [Contact; 3] = [Contact::Finger, Contact::Tool, Contact::Unknown];
pub(crate) const SOURCES: [ExponentSource; 3] =
    [ExponentSource::Measured, ExponentSource::Given, ExponentSource::Assumed];

/// The quantities, in the order of their numbers in the index.
pub(crate) const QUANTITIES: [Quantity; 5] = [
    Quantity::LateralForce,
    Quantity::NormalForce,
    Quantity::Acceleration,
    Quantity::Velocity,
    Quantity::Displacement,
];
/// Largest error in the index, hundredths of a decibel.
pub(crate) const LARGEST_ERROR: u64 = 100_000;

pub(crate) struct LeafReader<'a> {
    pub leaf: usize,
    pub root: &'a Root,
    pub header: &'a Header,
    pub limits: &'a Limits,
}

/// The columns of a leaf. They have not yet been compared with the rest of the file.
struct Columns {
    names: Vec<String>,
    tags: Vec<Vec<String>>,
    models: Vec<Vec<String>>,
    conditions: Vec<Conditions>,
    laws: Vec<(Contact, Law)>,
    places: Vec<TexturePlace>,
    hashes: Vec<[u8; 32]>,
    newer: Vec<Newer>,
}

/// The values of an entry that the index contains since version 1.1.
#[derive(Clone, Default)]
struct Newer {
    license: Option<String>,
    author: Option<String>,
    quantity: Option<Quantity>,
    felt_error_rms_db: Option<f64>,
    held_out_error_db: Option<f64>,
}

impl LeafReader<'_> {
    /// Decodes the unpacked page.
    pub(crate) fn read(&self, page: &[u8]) -> Result<Vec<Entry>, Fault> {
        let mut cursor = Cursor::new(page);
        let columns =
            self.columns(&mut cursor).map_err(|m| Fault::page(&leaf_place(self.leaf), m))?;
        self.check_names(&columns.names)?;
        let rows = columns
            .names
            .into_iter()
            .zip(columns.tags)
            .zip(columns.models.into_iter().zip(columns.conditions))
            .zip(columns.laws)
            .zip(columns.places.into_iter().zip(columns.hashes))
            .zip(columns.newer);
        let entries = rows.enumerate().map(|(i, (row, newer))| {
            let ((((name, tags), (models, conditions)), law), (place, blake3)) = row;
            let (contact, law) = law;
            let bytes = self.check_place(i, &name, &place)?;
            let place = TexturePlace { leaf: self.leaf, row: i, ..place };
            let Newer { license, author, quantity, felt_error_rms_db, held_out_error_db } = newer;
            Ok(Entry {
                name,
                tags,
                conditions,
                contact,
                law,
                models,
                license,
                author,
                quantity,
                felt_error_rms_db,
                held_out_error_db,
                bytes,
                blake3,
                place,
            })
        });
        entries.collect()
    }

    fn columns(&self, cursor: &mut Cursor<'_>) -> Result<Columns, WireError> {
        let count = cursor.count(LEAST_ENTRY_BYTES)?;
        if count == 0 {
            return Err(cursor.malformed("a leaf has no entry"));
        }
        let words = words(cursor)?;
        let columns = Columns {
            names: names(cursor, count)?,
            tags: column(cursor, count, |c| chosen(c, &words))?,
            models: column(cursor, count, |c| chosen(c, &words))?,
            conditions: column(cursor, count, conditions)?,
            laws: column(cursor, count, law)?,
            places: places(cursor, count)?,
            hashes: column(cursor, count, Cursor::array)?,
            newer: if self.header.minor > 0 {
                newer(cursor, count)?
            } else {
                vec![Newer::default(); count]
            },
        };
        // A newer minor version may append values, which are ignored.
        if self.header.minor <= MINOR && cursor.rest() > 0 {
            return Err(cursor.malformed("bytes follow the last value"));
        }
        Ok(columns)
    }

    fn check_names(&self, names: &[String]) -> Result<(), Fault> {
        let (low, high) = self.root.bounds(self.leaf);
        let mut before: Option<&str> = None;
        for (i, name) in names.iter().enumerate() {
            let place = || entry_place(self.leaf, i);
            if let Err(problem) = check_name(name) {
                let message = format!("{name:?} is not allowed: {problem}");
                return Err(Fault::new(rule::LIBRARY_NAME_INVALID, place(), message));
            }
            // A texture with a name outside these bounds would be listed, but a search for its name
            // would not find it.
            let inside = name.as_bytes() >= low && high.is_none_or(|high| name.as_bytes() < high);
            if !inside || before.is_some_and(|before| name.as_str() <= before) {
                let message = format!(
                    "{name} is not above the name before it, or belongs in another leaf; pack the library again"
                );
                return Err(Fault::new(rule::LIBRARY_ORDER_INVALID, place(), message));
            }
            before = Some(name);
        }
        Ok(())
    }

    /// Checks that a texture's bytes lie within the file. Returns the texture's size in bytes.
    fn check_place(&self, entry: usize, name: &str, place: &TexturePlace) -> Result<u64, Fault> {
        let payload = length(&self.header.payload);
        // The spectra come after the objects.
        let shared = self.root.spectra_start().saturating_sub(self.header.shared.start);
        let own = length(&place.own);
        let outside = |what: &str| {
            let message = format!("{name}: {what}; pack the library again");
            let place = entry_place(self.leaf, entry);
            Fault::new(rule::LIBRARY_RANGE_INVALID, place, message)
        };
        if place.own.end > payload {
            return Err(outside("its bytes end behind those of the library"));
        }
        let mut total = own;
        for cut in &place.cuts {
            if cut.at > own || cut.object.end > shared {
                return Err(outside("a shared object is outside of it or of the shared part"));
            }
            total = total.saturating_add(length(&cut.object));
        }
        let limit = self.limits.asset_bytes;
        if total <= limit {
            return Ok(total);
        }
        let message = format!(
            "{name} has {total} bytes and the limit is {limit}; raise it if you trust the file"
        );
        let place = entry_place(self.leaf, entry);
        Err(Fault::new(rule::LIBRARY_ASSET_TOO_LARGE, place, message))
    }
}

pub(crate) fn length(range: &std::ops::Range<u64>) -> u64 {
    range.end - range.start
}

fn column<'a, T>(
    cursor: &mut Cursor<'a>,
    count: usize,
    mut read: impl FnMut(&mut Cursor<'a>) -> Result<T, WireError>,
) -> Result<Vec<T>, WireError> {
    (0..count).map(|_| read(cursor)).collect()
}

/// Reads the tags and models that the leaf's entries use.
fn words<'a>(cursor: &mut Cursor<'a>) -> Result<Vec<&'a str>, WireError> {
    let count = cursor.count(1)?;
    let words = column(cursor, count, Cursor::text)?;
    if words.is_sorted_by(|a, b| a < b) {
        return Ok(words);
    }
    Err(cursor.malformed("the words are not sorted"))
}

fn names(cursor: &mut Cursor<'_>, count: usize) -> Result<Vec<String>, WireError> {
    let mut text = Vec::new();
    column(cursor, count, |cursor| {
        cursor.following(&mut text)?;
        let name = std::str::from_utf8(&text);
        name.map(str::to_owned).map_err(|_| cursor.malformed("a name is not UTF-8"))
    })
}

/// Reads a list of words, stored as indices into `words`.
fn chosen(cursor: &mut Cursor<'_>, words: &[&str]) -> Result<Vec<String>, WireError> {
    let count = cursor.count(1)?;
    if count > MOST_WORDS {
        return Err(cursor.malformed("a texture has more than 64 tags or models"));
    }
    column(cursor, count, |cursor| {
        let index = usize::try_from(cursor.varint()?).ok();
        let word = index.and_then(|index| words.get(index));
        word.map(|word| (*word).to_owned()).ok_or(cursor.malformed("a word does not exist"))
    })
}

fn conditions(cursor: &mut Cursor<'_>) -> Result<Conditions, WireError> {
    let bits = cursor.byte()?;
    let known = |bit, one| (bits & bit != 0, bits & one != 0);
    let (speed, force) = (known(SPEED, ONE_SPEED), known(FORCE, ONE_FORCE));
    let is_sound = bits < 16 && (speed.0 || !speed.1) && (force.0 || !force.1);
    if !is_sound {
        return Err(cursor.malformed("the bits of conditions contradict each other"));
    }
    Ok(Conditions { speed_mm_s: interval(cursor, speed)?, force_n: interval(cursor, force)? })
}

/// Reads a contact and a law. The first byte has two bits for the contact, and two bits for the
/// source of each of the three exponents. The exponents follow.
fn law(cursor: &mut Cursor<'_>) -> Result<(Contact, Law), WireError> {
    let bits = usize::from(cursor.byte()?);
    let unknown = |cursor: &Cursor<'_>| cursor.malformed("a contact or a source does not exist");
    let contact = CONTACTS.get(bits & 3).copied().ok_or_else(|| unknown(cursor))?;
    let mut exponents = [Exponent::assumed(0.0); 3];
    let in_range = |x: f64| (-MOST_EXPONENT..=MOST_EXPONENT).contains(&x);
    for (i, one) in exponents.iter_mut().enumerate() {
        let source = SOURCES.get((bits >> (2 * i + 2)) & 3).copied();
        one.source = source.ok_or_else(|| unknown(cursor))?;
        one.exponent = f64::from_le_bytes(cursor.array()?);
        // -0 is refused, so that zero has only one form.
        let is_zero = one.exponent == 0.0 && one.exponent.is_sign_negative();
        if !in_range(one.exponent) || is_zero {
            return Err(cursor.malformed("an exponent is not a number from -4 to 4"));
        }
    }
    let [frequency_speed, level_speed, level_force] = exponents;
    Ok((contact, Law { frequency_speed, level_speed, level_force }))
}

fn interval(
    cursor: &mut Cursor<'_>,
    (is_known, is_one): (bool, bool),
) -> Result<Option<Interval>, WireError> {
    if !is_known {
        return Ok(None);
    }
    let min = f64::from_le_bytes(cursor.array()?);
    let max = if is_one { min } else { f64::from_le_bytes(cursor.array()?) };
    // The sign is tested, and not whether the number is below 0, so that -0 is also refused: each
    // number has only one form.
    let is_number = min.is_finite() && max.is_finite() && min.is_sign_positive();
    if !is_number || (!is_one && min >= max) {
        return Err(cursor.malformed("a range of conditions is not finite, negative or reversed"));
    }
    Ok(Some(Interval { min, max }))
}

/// Reads where the textures are. The textures' own bytes follow each other, and shared objects are
/// inserted into them.
fn places(cursor: &mut Cursor<'_>, count: usize) -> Result<Vec<TexturePlace>, WireError> {
    let mut at = cursor.varint()?;
    let owns = column(cursor, count, |cursor| {
        let start = at;
        at = sum(cursor, start, "own bytes end beyond 64 bits")?;
        Ok(start..at)
    })?;
    let cuts = column(cursor, count, cuts)?;
    let places = owns.into_iter().zip(cuts);
    Ok(places.map(|(own, cuts)| TexturePlace { own, cuts, ..TexturePlace::default() }).collect())
}

/// Reads the columns that the index contains since version 1.1.
fn newer(cursor: &mut Cursor<'_>, count: usize) -> Result<Vec<Newer>, WireError> {
    let words = words(cursor)?;
    let one = |cursor: &mut Cursor<'_>| {
        let number = cursor.varint()?;
        let Some(index) = number.checked_sub(1) else { return Ok(None) };
        let word = usize::try_from(index).ok().and_then(|index| words.get(index));
        let word = word.ok_or(cursor.malformed("a licence or an author does not exist"))?;
        Ok(Some((*word).to_owned()))
    };
    let licenses = column(cursor, count, one)?;
    let authors = column(cursor, count, one)?;
    let quantities = column(cursor, count, |cursor| {
        let quantity = QUANTITIES.get(usize::from(cursor.byte()?));
        quantity.copied().ok_or(cursor.malformed("a quantity does not exist"))
    })?;
    let felt = column(cursor, count, error_db)?;
    let held_out = column(cursor, count, error_db)?;
    let errors = felt.into_iter().zip(held_out);
    let rows = licenses.into_iter().zip(authors).zip(quantities.into_iter().zip(errors));
    let rows = rows.map(|((license, author), (quantity, errors))| Newer {
        license,
        author,
        quantity: Some(quantity),
        felt_error_rms_db: errors.0,
        held_out_error_db: errors.1,
    });
    Ok(rows.collect())
}

/// Reads an error in decibels; `None` if it is not known.
fn error_db(cursor: &mut Cursor<'_>) -> Result<Option<f64>, WireError> {
    let number = cursor.varint()?;
    if number > LARGEST_ERROR + 1 {
        return Err(cursor.malformed("an error exceeds 1000 dB"));
    }
    Ok(number.checked_sub(1).map(|hundredths| hundredths as f64 / 100.0))
}

fn cuts(cursor: &mut Cursor<'_>) -> Result<Vec<Cut>, WireError> {
    // A cut consists of three integers.
    let count = cursor.count(3)?;
    if count > MOST_CUTS {
        return Err(cursor.malformed("a texture has more than 256 shared objects"));
    }
    let mut at = 0;
    column(cursor, count, |cursor| {
        at = sum(cursor, at, "a shared object is beyond 64 bits")?;
        let start = cursor.varint()?;
        let end = sum(cursor, start, "a shared object ends beyond 64 bits")?;
        if start == end {
            return Err(cursor.malformed("a shared object is empty"));
        }
        Ok(Cut { at, object: start..end })
    })
}

/// Reads a number, adds it to `to`, and returns the sum.
fn sum(cursor: &mut Cursor<'_>, to: u64, problem: &'static str) -> Result<u64, WireError> {
    let more = cursor.varint()?;
    to.checked_add(more).ok_or(cursor.malformed(problem))
}
