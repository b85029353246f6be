//! Reader of Parquet files. It reads numeric columns that are not lists.
//!
//! On some damaged files, the crate `parquet` panics (in three places of its code). This module
//! checks a file for such damage before the crate reads it.

use std::io::{BufReader, Read};

use bytes::Bytes;
use parquet::basic::{Compression, ConvertedType, Encoding, PageType, Type as Physical};
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{ChunkReader, FileReader, Length, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use crate::error::{Fault, ReadProblem};
use crate::formats::shared::SharedInput;
use crate::formats::thrift::struct_len;
use crate::input::InputFile;
use crate::sheet::{Columns, Numbers, Sheet};
use crate::value_limit::ValueLimit;

/// Number of rows that are read at once.
const AT_ONCE: usize = 8 << 10;

/// Length of the end of a file, bytes: the footer's length, and `PAR1`.
const END: u64 = 8;
/// Longest header of a page of numbers, bytes.
const LONGEST_HEADER: u64 = 4 << 10;

/// An opened file.
pub(crate) struct Parquet {
    columns: Columns,
    /// For each column, its index in the file.
    leaves: Vec<usize>,
    limit: ValueLimit,
    reader: SerializedFileReader<SharedFile>,
}

struct SharedFile(SharedInput);

impl Length for SharedFile {
    fn len(&self) -> u64 {
        self.0.length()
    }
}

impl ChunkReader for SharedFile {
    type T = BufReader<From>;

    /// Returns a reader of the file from `start` on. The library uses it to read a page's header,
    /// or the end of the file.
    fn get_read(&self, start: u64) -> Result<Self::T> {
        let left = self.0.length().saturating_sub(start);
        if left != END {
            let header = self.0.read(start, left.min(LONGEST_HEADER))?;
            struct_len(&header).map_err(|problem| ParquetError::General(problem.to_owned()))?;
        }
        Ok(BufReader::new(From { source: self.0.clone(), at: start }))
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        Ok(self.0.read(start, length as u64)?.into())
    }
}

/// Reads the input from a place on.
struct From {
    source: SharedInput,
    at: u64,
}

impl Read for From {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let left = self.source.length().saturating_sub(self.at);
        let bytes = self.source.read(self.at, left.min(buffer.len() as u64))?;
        buffer[..bytes.len()].copy_from_slice(&bytes);
        self.at += bytes.len() as u64;
        Ok(bytes.len())
    }
}

impl Parquet {
    /// Reads the schema.
    pub(crate) fn open(
        opened: InputFile<'_>,
        limit: ValueLimit,
    ) -> std::result::Result<Self, Fault> {
        let shared = SharedInput::new(opened.random()?)?;
        check_footer(&shared).map_err(|error| damaged("footer", &error))?;
        let reader = SerializedFileReader::new(SharedFile(shared))
            .map_err(|error| damaged("footer", &error))?;
        let schema = reader.metadata().file_metadata().schema_descr();
        let leaves = schema.columns().iter().enumerate();
        let (names, leaves) = leaves
            .filter(|(_, column)| is_number(column))
            .map(|(leaf, column)| (name(column), leaf))
            .unzip();
        Ok(Self { columns: Columns::with_parts(names), leaves, limit, reader })
    }

    fn read(&self, column: usize) -> std::result::Result<Vec<f64>, Fault> {
        let leaf = self.leaves.get(column).copied().unwrap_or(0);
        let broken = |error| damaged(&self.columns.name(column), &error);
        let mut values = Vec::new();
        for group in 0..self.reader.num_row_groups() {
            let group = self.reader.get_row_group(group).map_err(broken)?;
            let chunk = group.metadata().column(leaf);
            check(chunk).map_err(|problem| {
                ReadProblem::Invalid(problem).at_place(self.columns.name(column))
            })?;
            let pages = group.get_column_page_reader(leaf).map_err(broken)?;
            let descriptor = chunk.column_descr_ptr();
            let mut append = Append {
                limit: self.limit,
                levels: descriptor.max_def_level(),
                values: &mut values,
            };
            // Smaller unsigned numbers need no conversion, because 32 signed bits hold them.
            let is_unsigned = matches!(
                descriptor.converted_type(),
                ConvertedType::UINT_32 | ConvertedType::UINT_64
            );
            let appended = match get_column_reader(descriptor, Box::new(CheckedPages::new(pages))) {
                ColumnReader::DoubleColumnReader(reader) => append.all(reader, |x| x),
                ColumnReader::FloatColumnReader(reader) => append.all(reader, f64::from),
                ColumnReader::Int32ColumnReader(reader) if is_unsigned => {
                    append.all(reader, |x| f64::from(x as u32))
                }
                ColumnReader::Int32ColumnReader(reader) => append.all(reader, f64::from),
                ColumnReader::Int64ColumnReader(reader) if is_unsigned => {
                    append.all(reader, |x| x as u64 as f64)
                }
                ColumnReader::Int64ColumnReader(reader) => append.all(reader, |x| x as f64),
                _ => Ok(Ok(())),
            };
            appended.map_err(broken)??;
        }
        Ok(values)
    }
}

/// Refuses a footer that is not a whole structure. A footer whose stated length does not fit
/// into the file is left to the library.
fn check_footer(source: &SharedInput) -> Result<()> {
    let Some(end) = source.length().checked_sub(END) else {
        return Ok(());
    };
    let tail = source.read(end, END)?;
    let [a, b, c, d, ..] = tail[..] else {
        return Ok(());
    };
    let length = u64::from(u32::from_le_bytes([a, b, c, d]));
    let Some(start) = end.checked_sub(length) else {
        return Ok(());
    };
    let footer = source.read(start, length)?;
    let whole = struct_len(&footer);
    whole.map(drop).map_err(|problem| ParquetError::General(problem.to_owned()))
}

/// Refuses a column chunk that the library cannot read or does not check.
fn check(chunk: &ColumnChunkMetaData) -> std::result::Result<(), String> {
    if !is_known(chunk.compression()) {
        let compression = chunk.compression().to_string();
        let name = compression.split('(').next().unwrap_or_default();
        return Err(format!(
            "it is compressed by {name}, which is not read; write it with snappy (in pyarrow: compression='snappy')"
        ));
    }
    let start = chunk.dictionary_page_offset().unwrap_or(chunk.data_page_offset());
    if start < 0 || chunk.compressed_size() < 0 {
        return Err(
            "its place in the file is negative; the footer is damaged, copy the file again"
                .to_owned(),
        );
    }
    Ok(())
}

/// Passes on only pages whose order and encoding the library reads without a panic.
struct CheckedPages {
    pages: Box<dyn PageReader>,
    has_dictionary: bool,
}

impl CheckedPages {
    fn new(pages: Box<dyn PageReader>) -> Self {
        Self { pages, has_dictionary: false }
    }
}

impl PageReader for CheckedPages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let Some(page) = self.pages.get_next_page()? else {
            return Ok(None);
        };
        let problem = match (page.page_type(), page.encoding()) {
            (PageType::DICTIONARY_PAGE, _) => {
                self.has_dictionary = true;
                None
            }
            (_, Encoding::PLAIN_DICTIONARY | Encoding::RLE_DICTIONARY) if !self.has_dictionary => {
                Some("a page refers to a dictionary that is not there")
            }
            (_, Encoding::BYTE_STREAM_SPLIT) => Some("the encoding BYTE_STREAM_SPLIT is not read"),
            _ => None,
        };
        match problem {
            None => Ok(Some(page)),
            Some(problem) => Err(ParquetError::General(problem.to_owned())),
        }
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.pages.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.pages.skip_next_page()
    }

    fn at_record_boundary(&mut self) -> Result<bool> {
        self.pages.at_record_boundary()
    }
}

impl Iterator for CheckedPages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

/// Appends values to a column.
struct Append<'a> {
    limit: ValueLimit,
    /// The definition level of a value that is not missing.
    levels: i16,
    values: &'a mut Vec<f64>,
}

impl Append<'_> {
    /// Appends all values of a chunk, with NaN for missing values. The inner error means that the
    /// limit on numbers is exceeded.
    fn all<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        to_f64: impl Fn(T::T) -> f64,
    ) -> Result<std::result::Result<(), ReadProblem>>
    where
        T::T: Copy,
    {
        let (mut levels, mut read) = (Vec::new(), Vec::new());
        loop {
            levels.clear();
            read.clear();
            let (records, values, _) =
                reader.read_records(AT_ONCE, Some(&mut levels), None, &mut read)?;
            if records == 0 {
                return Ok(Ok(()));
            }
            let mut present = read.iter().take(values);
            for row in 0..records {
                let is_there = levels.get(row).is_none_or(|level| *level == self.levels);
                let value = if is_there { present.next() } else { None };
                self.values.push(value.map_or(f64::NAN, |value| to_f64(*value)));
            }
            // The footer's number of rows was checked before, but the pages may hold more.
            if let Err(error) = self.limit.check(self.values.len() as u64) {
                return Ok(Err(error));
            }
        }
    }
}

impl Sheet for Parquet {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn numbers(&mut self, wanted: &[usize]) -> std::result::Result<Numbers, Fault> {
        let rows = self.reader.metadata().file_metadata().num_rows();
        let rows = u64::try_from(rows).unwrap_or(u64::MAX);
        let values = rows.saturating_mul(wanted.len() as u64);
        self.limit.check(values)?;
        let columns = wanted.iter().map(|column| self.read(*column));
        Ok(Numbers {
            columns: columns.collect::<std::result::Result<_, _>>()?,
            ..Numbers::default()
        })
    }
}

fn is_number(column: &ColumnDescriptor) -> bool {
    let is_plain = !matches!(column.converted_type(), ConvertedType::DECIMAL);
    let physical = column.physical_type();
    let is_number =
        matches!(physical, Physical::INT32 | Physical::INT64 | Physical::FLOAT | Physical::DOUBLE);
    is_number && is_plain && column.max_rep_level() == 0
}

/// Returns the column's path, and the byte at which its own name begins.
fn name(column: &ColumnDescriptor) -> (String, usize) {
    let whole = column.path().string();
    let part = whole.len().saturating_sub(column.name().len());
    (whole, part)
}

fn is_known(compression: Compression) -> bool {
    matches!(
        compression,
        Compression::UNCOMPRESSED
            | Compression::SNAPPY
            | Compression::GZIP(_)
            | Compression::LZ4
            | Compression::LZ4_RAW
    )
}

fn damaged(place: &str, error: &ParquetError) -> Fault {
    let error = error.to_string();
    let problem = format!(
        "not readable Parquet: {}; copy the file again, or write it again",
        htex_base::finding::plain(error.trim_end())
    );
    ReadProblem::Invalid(problem).at_place(place)
}
