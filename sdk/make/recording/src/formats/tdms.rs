//! Reader of TDMS, LabVIEW's file format. A file contains groups of channels with their sample
//! rates.
//!
//! Layout: "TDMS File Format Internal Structure", National Instruments. A file consists of
//! segments. Each segment of a file lists the objects whose properties or data layout change from
//! this segment on; chunks of raw data follow. The reader first reads the directory of all
//! segments, and then the values of the channels that are used.
//!
//! This reader was written for this project because the crate `tdms` panics if a damaged file lacks
//! certain values, and because it cannot read from memory.

use std::io::{Seek, SeekFrom};

use crate::columns::clock::snap;
use crate::error::{Fault, Place, ReadProblem};
use crate::formats::bytes::{ByteReader, Endian};
use crate::formats::damage;
use crate::formats::tdms_directory::{Channel, Directory, Piece};
use crate::input::{InputFile, Random};
use crate::sheet::{Columns, Numbers, Sheet};
use crate::value_limit::ValueLimit;

/// An opened file.
pub(crate) struct Tdms {
    columns: Columns,
    channels: Vec<Channel>,
    warnings: Vec<String>,
    limit: ValueLimit,
    input: Random,
}

impl Tdms {
    /// Reads the directory.
    pub(crate) fn open(opened: InputFile<'_>, limit: ValueLimit) -> Result<Self, Fault> {
        let mut input = opened.random()?;
        let mut directory = Directory::new(limit);
        directory.read(&mut input).map_err(|problem| damaged(directory.place(), &problem))?;
        let channels: Vec<Channel> = directory
            .channels
            .into_iter()
            .filter(|channel| channel.samples > 0 || channel.refused.is_some())
            .collect();
        let names = channels.iter().map(|channel| (channel.name.clone(), channel.part)).collect();
        Ok(Self {
            columns: Columns::with_parts(names),
            channels,
            warnings: directory.warnings,
            limit,
            input,
        })
    }

    fn read(&mut self, channel: &Channel) -> Result<Vec<f64>, ReadProblem> {
        if let Some(problem) = &channel.refused {
            return Err(ReadProblem::invalid(problem));
        }
        let mut values = Vec::new();
        for piece in &channel.pieces {
            for chunk in 0..piece.chunks {
                self.input.seek(SeekFrom::Start(piece.start + chunk * piece.chunk_bytes))?;
                read_chunk(&mut self.input, piece, &mut values)?;
            }
        }
        Ok(values)
    }
}

/// Reads a channel's values in one chunk; the input must be at the first value.
fn read_chunk(input: &mut Random, piece: &Piece, values: &mut Vec<f64>) -> Result<(), ReadProblem> {
    let size = piece.kind.size() as u64;
    if piece.stride == size {
        let mut reader = ByteReader::new(input, piece.endian);
        return Ok(reader.values(piece.kind, piece.values, |_, value| values.push(value))?);
    }
    // Reads whole rows of interleaved channels, several at once. A separate read for every value
    // would cost a system call for every value. At least one row is read, however many channels it
    // has.
    let rows_at_once = (256 << 10) / piece.stride + 1;
    let mut done = 0;
    while done < piece.values {
        let rows = rows_at_once.min(piece.values - done);
        // The last row ends with the channel's own value.
        let bytes = (rows - 1) * piece.stride + size;
        let rows_read = ByteReader::new(&mut *input, Endian::Little).vec(bytes)?;
        let of_rows = rows_read.chunks(piece.stride as usize);
        values.extend(of_rows.map(|row| piece.kind.value(row, piece.endian)));
        done += rows;
        if done < piece.values {
            input.seek(SeekFrom::Current((piece.stride - size) as i64))?;
        }
    }
    Ok(())
}

impl Sheet for Tdms {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    /// Returns the sample rate, the inverse of `wf_increment`; all wanted channels must agree.
    fn rate_hz(&self, wanted: &[usize]) -> Result<Option<f64>, Fault> {
        let channels = wanted.iter().filter_map(|column| self.channels.get(*column));
        let mut first: Option<(&Channel, f64)> = None;
        for channel in channels {
            let Some(step_s) = channel.increment_s else {
                continue;
            };
            match first {
                None => first = Some((channel, step_s)),
                Some((_, other)) if other == step_s => {}
                Some((other, other_s)) => {
                    let problem = format!(
                        "its samples are {step_s} s apart, and the samples of {} are {other_s} s apart; map channels of one rate",
                        htex_base::finding::plain(&other.name)
                    );
                    return Err(ReadProblem::Invalid(problem)
                        .at_place(htex_base::finding::plain(&channel.name)));
                }
            }
        }
        // The file states the time between samples, and its inverse is rarely the whole number that
        // was set.
        Ok(first.map(|(_, step_s)| snap(1.0 / step_s)))
    }

    fn numbers(&mut self, wanted: &[usize]) -> Result<Numbers, Fault> {
        let channels = std::mem::take(&mut self.channels);
        let chosen = || wanted.iter().filter_map(|column| channels.get(*column));
        let values = chosen().fold(0_u64, |sum, channel| sum.saturating_add(channel.samples));
        let read = self.limit.check(values).map_err(Fault::from);
        let read = read.and_then(|()| {
            let read = |channel: &Channel| {
                let read = self.read(channel);
                read.map_err(|problem| damaged(htex_base::finding::plain(&channel.name), &problem))
            };
            chosen().map(read).collect()
        });
        self.channels = channels;
        Ok(Numbers { columns: read?, warnings: self.warnings.clone(), ..Numbers::default() })
    }
}

fn damaged(place: impl Into<Place>, problem: &ReadProblem) -> Fault {
    ReadProblem::Invalid(damage(problem)).at_place(place)
}
