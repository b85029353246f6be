//! Reader of MATLAB version 5 files (`save -v6` and `-v7`): numeric matrices, including matrices
//! inside structs.
//!
//! Layout: "MAT-File Format", MathWorks. A header of 128 bytes is followed by elements. Each
//! element has a tag (its type and size), followed by its data. A compressed element is a zlib
//! stream that contains one element. Streams are decompressed piece by piece, so that a
//! decompressed element is never in memory as a whole. The reader first reads the names of all
//! variables. It then reads the values of the variables that are used.
//!
//! This reader was written for this project because the crate `matfile` does not read structs and
//! reads the whole file into memory.

use std::fmt::Display;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};

use flate2::read::ZlibDecoder;

use crate::error::{Fault, ReadProblem};
use crate::formats::bytes::{ByteReader, Endian, NumberType};
use crate::formats::mat_element::{
    COMPRESSED, INT32, MATRIX, MOST_BYTES, MOST_DEEP, MOST_NAME, MOST_NAMES, Tag, UINT32,
    number_type, text, unexpected, up_to_nul, words,
};
use crate::formats::matrix::{Arrays, MOST_COLUMNS, Shape};
use crate::input::{InputFile, Random};
use crate::sheet::{Columns, Numbers, Sheet};
use crate::value_limit::ValueLimit;

/// Length of the file's header.
const HEADER: u64 = 128;
const NOT_MATLAB: &str = "this is no MATLAB 5 header (nor HDF5, which version 7.3 uses); in MATLAB: save('out.mat', '-v7')";

/// An opened file.
pub(crate) struct Mat {
    columns: Columns,
    arrays: Arrays<Data>,
    limit: ValueLimit,
    endian: Endian,
    input: Random,
}

/// Where a matrix's values are.
#[derive(Debug)]
struct Data {
    /// The variable that contains them, as an element of the file.
    element: Element,
    /// Number of bytes, decompressed, from the start of the element to the values.
    before: u64,
    kind: NumberType,
}

/// An element of the file: the bytes after its tag.
#[derive(Debug, Clone, Copy)]
struct Element {
    at: u64,
    bytes: u64,
    is_compressed: bool,
}

impl Mat {
    /// Finds the names of all variables.
    pub(crate) fn open(opened: InputFile<'_>, limit: ValueLimit) -> Result<Self, Fault> {
        let endian = match opened.front.get(126..128) {
            Some(b"IM") => Endian::Little,
            Some(b"MI") => Endian::Big,
            _ => return Err(ReadProblem::Invalid(NOT_MATLAB.to_owned()).at_place("byte 126")),
        };
        let input = opened.random()?;
        let mut scan = Scan {
            arrays: Arrays::new('.'),
            element: Element { at: HEADER, bytes: 0, is_compressed: false },
            scanned: 0,
        };
        let mut mat =
            Self { columns: Columns::default(), arrays: Arrays::new('.'), limit, endian, input };
        let scanned = mat.scan(&mut scan);
        scanned.map_err(|problem| damaged(scan.element.at, &problem))?;
        mat.columns = scan.arrays.columns();
        mat.arrays = scan.arrays;
        Ok(mat)
    }

    fn scan(&mut self, scan: &mut Scan) -> Result<(), ReadProblem> {
        let (length, endian) = (self.input.len()?, self.endian);
        while scan.element.at + 8 <= length {
            self.input.seek(SeekFrom::Start(scan.element.at))?;
            let mut tag = ByteReader::new(&mut self.input, self.endian);
            let (kind, bytes) = (tag.u32()?, u64::from(tag.u32()?));
            scan.element =
                Element { at: scan.element.at + 8, bytes, is_compressed: kind == COMPRESSED };
            if scan.element.at + bytes > length {
                let left = length - scan.element.at;
                return Err(wrong_size(format_args!("{bytes} bytes where {left} are left")));
            }
            match kind {
                COMPRESSED => {
                    let mut inside = ByteReader::new(self.inside(scan.element)?, endian);
                    let tag = Tag::read(&mut inside)?;
                    scan.expect_matrix(&tag)?;
                    scan.matrix(&mut inside, u64::from(tag.bytes), None, 0)?;
                }
                MATRIX => {
                    let mut inside = ByteReader::new(self.inside(scan.element)?, endian);
                    scan.matrix(&mut inside, bytes, None, 0)?;
                }
                // Other top-level elements are not variables.
                _ => {}
            }
            // MATLAB aligns elements to eight bytes, except compressed ones.
            let padding = if kind == COMPRESSED { 0 } else { bytes.wrapping_neg() % 8 };
            scan.element.at += bytes + padding;
        }
        Ok(())
    }

    /// Returns a reader of an element's bytes, decompressed.
    fn inside(&mut self, element: Element) -> io::Result<Box<dyn Read + '_>> {
        self.input.seek(SeekFrom::Start(element.at))?;
        let bytes = BufReader::new((&mut self.input).take(element.bytes));
        Ok(if element.is_compressed {
            Box::new(BufReader::new(ZlibDecoder::new(bytes)))
        } else {
            Box::new(bytes)
        })
    }
}

impl Sheet for Mat {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn rate_hz(&self, wanted: &[usize]) -> Result<Option<f64>, Fault> {
        self.arrays.rate_hz(&self.columns, wanted)
    }

    fn numbers(&mut self, wanted: &[usize]) -> Result<Numbers, Fault> {
        // Taken out for the time of reading, because the closure needs the input of the same
        // struct.
        let arrays = std::mem::replace(&mut self.arrays, Arrays::new('.'));
        let (limit, endian) = (self.limit, self.endian);
        let columns = arrays.numbers(limit, wanted, |data, shape, keep| {
            let mut read = || {
                let mut inside = ByteReader::new(self.inside(data.element)?, endian);
                inside.skip(data.before)?;
                inside.values(data.kind, shape.samples * shape.channels, &mut *keep)
            };
            read().map_err(|error| damaged(data.element.at, &error.into()))
        });
        self.arrays = arrays;
        Ok(Numbers { columns: columns?, ..Numbers::default() })
    }
}

/// The variables found so far.
struct Scan {
    arrays: Arrays<Data>,
    element: Element,
    /// Total decompressed size of all variables, bytes.
    scanned: u64,
}

impl Scan {
    fn expect_matrix(&self, tag: &Tag) -> Result<(), ReadProblem> {
        match tag.kind {
            MATRIX => Ok(()),
            kind => Err(unexpected(kind, "a matrix")),
        }
    }

    /// Reads a matrix of `bytes` bytes to its end. If it is a struct's field, `field` is the
    /// field's name.
    fn matrix(
        &mut self,
        inside: &mut ByteReader<impl Read>,
        bytes: u64,
        field: Option<String>,
        depth: usize,
    ) -> Result<(), ReadProblem> {
        let end = inside.at + bytes;
        // A field is counted again as a part of its struct, so the sum is too large by a factor of
        // at most the depth.
        self.scanned = self.scanned.saturating_add(bytes);
        if self.scanned > MOST_BYTES {
            return Err(ReadProblem::Invalid(format!(
                "more than {MOST_BYTES} bytes when decompressed; save only the variables of the recording"
            )));
        }
        // A struct's field without a value.
        if bytes == 0 {
            return Ok(());
        }
        let flags = words(inside, UINT32, 8, "the flags")?;
        let sizes = words(inside, INT32, 128, "the dimensions")?;
        let own = text(inside, MOST_NAME, "a name")?;
        let name = field.unwrap_or_else(|| String::from_utf8_lossy(&own).into_owned());
        let flags = flags.first().copied().unwrap_or(0);
        let is_complex = flags & 0x800 != 0;
        match flags & 0xff {
            2 => self.fields(inside, &name, &sizes, depth)?,
            6..=15 if !is_complex => self.numeric(inside, &name, &sizes)?,
            _ => {}
        }
        match end.checked_sub(inside.at) {
            Some(left) => Ok(inside.skip(left)?),
            None => Err(wrong_size(format_args!(
                "{} ends inside its values",
                htex_base::finding::plain(&name)
            ))),
        }
    }

    fn numeric(
        &mut self,
        inside: &mut ByteReader<impl Read>,
        name: &str,
        sizes: &[u32],
    ) -> Result<(), ReadProblem> {
        let tag = Tag::read(inside)?;
        let Some(kind) = number_type(tag.kind) else {
            return Err(unexpected(tag.kind, "a type of numbers"));
        };
        let (&[rows, columns], size) = (sizes, kind.size() as u64) else {
            return Ok(());
        };
        let (rows, columns) = (u64::from(rows), u64::from(columns));
        if rows.saturating_mul(columns).saturating_mul(size) != u64::from(tag.bytes) {
            return Err(wrong_size(format_args!(
                "{} is {rows} by {columns} and has {} bytes of numbers",
                htex_base::finding::plain(name),
                tag.bytes
            )));
        }
        // MATLAB stores column after column.
        if let Some(shape) = Shape::of_array(columns, rows) {
            let data = Data { element: self.element, before: inside.at, kind };
            if !self.arrays.add(name, shape, data) {
                return Err(too_many());
            }
        } else if rows * columns == 1 {
            let mut scalar = f64::NAN;
            inside.values(kind, 1, |_, value| scalar = value)?;
            self.arrays.add_scalar(name, scalar);
        }
        Ok(())
    }

    /// Reads the fields of a struct (`s.fx`) or of an array of structs (`s(2).fx`).
    fn fields(
        &mut self,
        inside: &mut ByteReader<impl Read>,
        name: &str,
        sizes: &[u32],
        depth: usize,
    ) -> Result<(), ReadProblem> {
        if depth == MOST_DEEP {
            return Err(ReadProblem::Invalid(format!(
                "structs are nested more than {MOST_DEEP} deep; save only the variables of the recording"
            )));
        }
        let width = words(inside, INT32, 8, "the length of field names")?;
        let width = width.first().copied().unwrap_or(0) as usize;
        let names = text(inside, MOST_NAMES, "the field names")?;
        if width == 0 && !names.is_empty() {
            return Err(wrong_size("field names of length 0"));
        }
        let fields: Vec<String> = names.chunks(width.max(1)).map(up_to_nul).collect();
        let count = sizes.iter().try_fold(1_u64, |n, size| n.checked_mul((*size).into()));
        let count = count
            // A struct array without fields holds nothing, however large it claims to be.
            .filter(|count| fields.is_empty() || *count <= MOST_COLUMNS as u64)
            .ok_or_else(too_many)?;
        if fields.is_empty() {
            return Ok(());
        }
        for number in 1..=count {
            for field in &fields {
                let path = match count {
                    1 => format!("{name}.{field}"),
                    _ => format!("{name}({number}).{field}"),
                };
                if path.len() > MOST_NAME as usize {
                    return Err(wrong_size("a name of more than 1024 bytes"));
                }
                let tag = Tag::read(inside)?;
                self.expect_matrix(&tag)?;
                self.matrix(inside, tag.bytes.into(), Some(path), depth + 1)?;
            }
        }
        Ok(())
    }
}

fn wrong_size(what: impl Display) -> ReadProblem {
    ReadProblem::Invalid(format!("a size in the file is wrong ({what}); save it again"))
}

fn too_many() -> ReadProblem {
    ReadProblem::Invalid(format!(
        "more than {MOST_COLUMNS} variables; save only the variables of the recording"
    ))
}

fn damaged(at: u64, problem: &ReadProblem) -> Fault {
    let problem = match problem {
        ReadProblem::Io(error) if error.kind() == ErrorKind::UnexpectedEof => {
            "the variable that begins here ends too early; copy the file again".to_owned()
        }
        ReadProblem::Io(error) => {
            format!("the file ends or cannot be decompressed here: {error}; copy it again")
        }
        other => other.to_string(),
    };
    ReadProblem::Invalid(problem).at_place(format!("byte {at}"))
}
