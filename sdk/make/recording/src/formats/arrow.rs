//! Reader of Arrow IPC files (Feather version 2) and streams. It reads numeric columns and skips
//! the values of all other columns.
//!
//! Layout: "Arrow Columnar Format", section "Serialization and Interprocess Communication". The
//! metadata are flatbuffers, which the crate `arrow-ipc` verifies and decodes. The file reader of
//! `arrow-ipc` is not used, because it trusts the sizes stated in a file.

use std::fmt::Display;
use std::io::Read;

use arrow_ipc::{CompressionType, RecordBatch, root_as_footer, root_as_message};
use lz4_flex::frame::FrameDecoder;

use crate::error::{Fault, Place, ReadProblem};
use crate::formats::arrow_schema::{Column, Schema};
use crate::formats::damage;
use crate::formats::shared::SharedInput;
use crate::input::InputFile;
use crate::sheet::{Columns, Numbers, Sheet};
use crate::value_limit::ValueLimit;

/// Longest metadata of a message or footer that is read, bytes.
const MOST_METADATA: u64 = 16 << 20;
/// The first bytes of a file, then the first bytes of a message.
const FILE: &[u8] = b"ARROW1";
const MESSAGE: [u8; 4] = [0xff; 4];
const FEATHER_V1: &str =
    "this is Feather of version 1; write it as version 2 (in pyarrow: version=2)";

/// An opened file.
pub(crate) struct Arrow {
    columns: Columns,
    schema: Schema,
    batches: Vec<Batch>,
    limit: ValueLimit,
    source: SharedInput,
}

/// Where a batch of rows is, and how many rows it has.
#[derive(Debug, Clone, Copy)]
struct Batch {
    message: Message,
    rows: u64,
}

/// Where a message is.
#[derive(Debug, Clone, Copy)]
struct Message {
    metadata: u64,
    metadata_bytes: u64,
    body: u64,
    body_bytes: u64,
}

impl Arrow {
    /// Reads the schema and finds the batches.
    pub(crate) fn open(opened: InputFile<'_>, limit: ValueLimit) -> Result<Self, Fault> {
        let (is_file, is_old) = (opened.front.starts_with(FILE), opened.front.starts_with(b"FEA1"));
        let source = SharedInput::new(opened.random()?)?;
        let mut arrow = Self {
            columns: Columns::default(),
            schema: Schema::default(),
            batches: Vec::new(),
            limit,
            source,
        };
        let read = match is_file {
            _ if is_old => Err((0, ReadProblem::invalid(FEATHER_V1))),
            true => arrow.read_footer(),
            false => arrow.read_stream(),
        };
        read.map_err(|(at, problem)| damaged(format!("byte {at}"), &problem))?;
        arrow.columns = Columns::new(arrow.schema.columns.iter().map(|c| c.name.clone()), None);
        Ok(arrow)
    }

    /// Reads a file's footer, which lists its batches.
    fn read_footer(&mut self) -> Result<(), (u64, ReadProblem)> {
        let length = self.source.length();
        let tail_at = length.saturating_sub(10);
        let tail = self.source.read(tail_at, 10).map_err(|error| (tail_at, error.into()))?;
        if tail[4..] != *FILE {
            let problem = "the file does not end with ARROW1; it seems truncated, copy it again";
            return Err((tail_at, ReadProblem::invalid(problem)));
        }
        let size = u64::from(u32::from_le_bytes([tail[0], tail[1], tail[2], tail[3]]));
        let at = tail_at.saturating_sub(size);
        let read = || {
            let bytes = metadata(&self.source, at, size)?;
            let footer = root_as_footer(&bytes).map_err(bad_metadata)?;
            let schema = footer.schema().ok_or_else(|| {
                ReadProblem::invalid("the footer has no schema; write the file again")
            })?;
            let blocks: Vec<[i64; 3]> = footer
                .recordBatches()
                .into_iter()
                .flatten()
                .map(|block| [block.offset(), block.metaDataLength().into(), block.bodyLength()])
                .collect();
            Ok((Schema::from_ipc(&schema), blocks))
        };
        let (schema, blocks) = read().map_err(|error| (at, error))?;
        self.schema = schema;
        for [offset, metadata_bytes, body_bytes] in blocks {
            let size = |value: i64| u64::try_from(value).unwrap_or(u64::MAX);
            let (offset, metadata_bytes) = (size(offset), size(metadata_bytes));
            let message = Message {
                metadata: offset,
                metadata_bytes,
                body: offset.saturating_add(metadata_bytes),
                body_bytes: size(body_bytes),
            };
            self.add_batch(message).map_err(|error| (offset, error))?;
        }
        Ok(())
    }

    /// Reads the messages of a stream one after the other.
    fn read_stream(&mut self) -> Result<(), (u64, ReadProblem)> {
        let mut at = 0;
        let mut is_first = true;
        while at + 8 <= self.source.length() {
            let next = self.read_message(at, is_first).map_err(|error| (at, error))?;
            match next {
                None => return Ok(()),
                Some(next) => at = next,
            }
            is_first = false;
        }
        Ok(())
    }

    /// Reads the message at `at` and returns the place of the next message; `None` at the end of
    /// the stream.
    fn read_message(&mut self, at: u64, is_first: bool) -> Result<Option<u64>, ReadProblem> {
        let prefix = self.source.read(at, 8)?;
        if prefix[..4] != MESSAGE {
            return Err(ReadProblem::invalid(
                "no message begins here; the stream is damaged, write it again",
            ));
        }
        let size = u64::from(u32::from_le_bytes([prefix[4], prefix[5], prefix[6], prefix[7]]));
        if size == 0 {
            return Ok(None);
        }
        let bytes = metadata(&self.source, at + 8, size)?;
        let message = root_as_message(&bytes).map_err(bad_metadata)?;
        let body_bytes = u64::try_from(message.bodyLength()).unwrap_or(u64::MAX);
        let body = at + 8 + size;
        match (is_first, message.header_as_schema()) {
            (true, Some(schema)) => self.schema = Schema::from_ipc(&schema),
            (true, None) => {
                return Err(ReadProblem::invalid(
                    "the stream does not begin with a schema; write it again",
                ));
            }
            _ => {}
        }
        if message.header_as_record_batch().is_some() {
            self.add_batch(Message { metadata: at, metadata_bytes: size + 8, body, body_bytes })?;
        }
        let left = self.source.length().saturating_sub(body);
        if body_bytes <= left {
            Ok(Some(body + body_bytes))
        } else {
            Err(ReadProblem::invalid("the stream ends inside this message; copy it again"))
        }
    }

    fn add_batch(&mut self, message: Message) -> Result<(), ReadProblem> {
        let rows = self.with_batch(message, |batch| Ok(batch.length()))?;
        let rows = u64::try_from(rows).map_err(|_| {
            ReadProblem::invalid("a batch has a negative length; write the file again")
        })?;
        self.batches.push(Batch { message, rows });
        Ok(())
    }

    /// Calls a function with a batch's metadata.
    fn with_batch<T>(
        &self,
        message: Message,
        read: impl FnOnce(&RecordBatch<'_>) -> Result<T, ReadProblem>,
    ) -> Result<T, ReadProblem> {
        let bytes = metadata(&self.source, message.metadata, message.metadata_bytes)?;
        // Files from before version 0.15 have no marker before the length.
        let start = if bytes.starts_with(&MESSAGE) { 8 } else { 4 };
        let root = root_as_message(bytes.get(start..).unwrap_or_default()).map_err(bad_metadata)?;
        match root.header_as_record_batch() {
            Some(batch) => read(&batch),
            None => {
                Err(ReadProblem::invalid("a block is not a batch of rows; write the file again"))
            }
        }
    }

    /// Appends a column's values in a batch, with NaN for missing values.
    fn append(
        &self,
        batch: Batch,
        column: &Column,
        values: &mut Vec<f64>,
    ) -> Result<(), ReadProblem> {
        let Some(kind) = column.number else {
            return Err(ReadProblem::Invalid(format!(
                "its type is {}, which is not read as numbers; write it as float64",
                column.kind
            )));
        };
        let missing = || {
            ReadProblem::invalid(
                "the batch has fewer buffers than its schema; write the file again",
            )
        };
        let size = kind.size() as u64;
        // Buffers are padded, so a buffer may be longer than its values.
        let wanted = batch.rows.saturating_mul(size);
        let (validity, numbers) = self.with_batch(batch.message, |metadata| {
            let codec = metadata.compression().map(|compression| compression.codec());
            let nodes = metadata.nodes().filter(|nodes| column.node < nodes.len());
            let nulls = nodes.map(|nodes| nodes.get(column.node).null_count());
            let buffer = |index: usize| {
                let buffers = metadata.buffers().filter(|buffers| index < buffers.len());
                buffers.map(|buffers| (buffers.get(index).offset(), buffers.get(index).length()))
            };
            let (Some(nulls), Some(bits), Some(numbers)) =
                (nulls, buffer(column.buffer), buffer(column.buffer + 1))
            else {
                return Err(missing());
            };
            // The bits may be left out if no value is missing, so they are read only if a value is
            // missing.
            let validity = match nulls {
                0 => None,
                _ => Some(self.buffer(batch.message, bits, codec, batch.rows.div_ceil(8))?),
            };
            Ok((validity, self.buffer(batch.message, numbers, codec, wanted)?))
        })?;
        let is_there = |row: usize| {
            let bits = validity.as_ref().and_then(|bits| bits.get(row / 8));
            bits.is_none_or(|bits| bits >> (row % 8) & 1 == 1)
        };
        values.extend(numbers.chunks_exact(kind.size()).enumerate().map(|(row, bytes)| {
            if is_there(row) { kind.value(bytes, self.schema.endian) } else { f64::NAN }
        }));
        Ok(())
    }

    /// Returns the first `wanted` bytes of a buffer, decompressed. The stated length of the
    /// decompressed data is not trusted.
    fn buffer(
        &self,
        message: Message,
        (offset, length): (i64, i64),
        codec: Option<CompressionType>,
        wanted: u64,
    ) -> Result<Vec<u8>, ReadProblem> {
        let outside = || {
            ReadProblem::invalid("a buffer is outside its batch or too short; copy the file again")
        };
        let offset = u64::try_from(offset).map_err(|_| outside())?;
        let length = u64::try_from(length).map_err(|_| outside())?;
        if offset.saturating_add(length) > message.body_bytes {
            return Err(outside());
        }
        let at = message.body + offset;
        let Some(codec) = codec else {
            return if length < wanted {
                Err(outside())
            } else {
                Ok(self.source.read(at, wanted)?)
            };
        };
        if codec != CompressionType::LZ4_FRAME {
            return Err(ReadProblem::Invalid(format!(
                "it is compressed by {codec:?}, which is not read; write it with lz4 (in pyarrow: compression='lz4')"
            )));
        }
        if length == 0 && wanted == 0 {
            return Ok(Vec::new());
        }
        let bytes = self.source.read(at, length)?;
        let (stated, compressed) = bytes.split_first_chunk().ok_or_else(outside)?;
        let mut decompressed = Vec::new();
        // A length of -1 marks bytes that are not compressed.
        match i64::from_le_bytes(*stated) {
            -1 => compressed.take(wanted).read_to_end(&mut decompressed)?,
            _ => FrameDecoder::new(compressed).take(wanted).read_to_end(&mut decompressed)?,
        };
        if decompressed.len() as u64 == wanted { Ok(decompressed) } else { Err(outside()) }
    }
}

impl Sheet for Arrow {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn numbers(&mut self, wanted: &[usize]) -> Result<Numbers, Fault> {
        let rows = self.batches.iter().fold(0_u64, |sum, batch| sum.saturating_add(batch.rows));
        self.limit.check(rows.saturating_mul(wanted.len() as u64))?;
        let mut columns = vec![Vec::new(); wanted.len()];
        for (values, index) in columns.iter_mut().zip(wanted) {
            let Some(column) = self.schema.columns.get(*index) else {
                continue;
            };
            for batch in &self.batches {
                self.append(*batch, column, values)
                    .map_err(|problem| damaged(self.columns.name(*index), &problem))?;
            }
        }
        Ok(Numbers { columns, ..Numbers::default() })
    }
}

/// Reads metadata, up to the largest allowed size.
fn metadata(source: &SharedInput, at: u64, bytes: u64) -> Result<Vec<u8>, ReadProblem> {
    if bytes <= MOST_METADATA {
        Ok(source.read(at, bytes)?)
    } else {
        Err(ReadProblem::invalid(
            "the metadata are longer than any that are read; copy the file again",
        ))
    }
}

fn bad_metadata(error: impl Display) -> ReadProblem {
    ReadProblem::Invalid(format!(
        "not readable Arrow metadata: {error}; copy the file again, or write it again"
    ))
}

fn damaged(place: impl Into<Place>, problem: &ReadProblem) -> Fault {
    ReadProblem::Invalid(htex_base::finding::plain(&damage(problem)).into_owned()).at_place(place)
}
