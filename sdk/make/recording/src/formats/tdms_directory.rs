//! The directory of a TDMS file: its channels, and where their values are stored.

use std::collections::HashMap;
use std::io::{BufReader, Read, Seek};

use crate::error::ReadProblem;
use crate::formats::bytes::{ByteReader, Endian, NumberType};
use crate::formats::tdms_object::{
    Layout, MOST_CHANNELS, attribute, daqmx_index, layout, parts, text,
};
use crate::input::Random;
use crate::value_limit::ValueLimit;

/// Length of a segment's lead-in, bytes.
const LEAD_IN: u64 = 28;
/// Reasons for refusing a channel.
const RAW_DAQMX: &str =
    "it has raw DAQmx data, which are not read; in LabVIEW or DIAdem, save it with scaled values";
const UNSCALED: &str = "its values are stored without their scales (NI_Number_Of_Scales), which are not applied; in LabVIEW or \
                        DIAdem, save it with scaled values";

/// Bits in a segment's table of contents.
const METADATA: u32 = 1 << 1;
const NEW_OBJECTS: u32 = 1 << 2;
const RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
const DAQMX: u32 = 1 << 7;
/// The length stated by a segment that was not completed.
const INCOMPLETE: u64 = u64::MAX;

/// A channel of a file.
#[derive(Debug)]
pub(crate) struct Channel {
    /// The name, as `Group/Channel`.
    pub(crate) name: String,
    /// Byte at which the channel's own name begins.
    pub(crate) part: usize,
    /// Seconds between samples, above 0.
    pub(crate) increment_s: Option<f64>,
    pub(crate) samples: u64,
    pub(crate) pieces: Vec<Piece>,
    /// Why the channel cannot be read, if it cannot.
    pub(crate) refused: Option<&'static str>,
    layout: Option<Layout>,
    /// The last list of objects to which the channel was added.
    list: u64,
}

/// A channel's values in the chunks of one segment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    /// Position of the first value, bytes.
    pub(crate) start: u64,
    pub(crate) chunks: u64,
    pub(crate) chunk_bytes: u64,
    /// Number of values in a chunk.
    pub(crate) values: u64,
    /// Bytes from one value to the next.
    pub(crate) stride: u64,
    pub(crate) kind: NumberType,
    pub(crate) endian: Endian,
}

/// What has been read of a directory so far.
pub(crate) struct Directory {
    pub(crate) channels: Vec<Channel>,
    pub(crate) warnings: Vec<String>,
    by_path: HashMap<String, usize>,
    /// Channels with values in the current segment, in their order.
    current: Vec<usize>,
    /// Number of the current list of objects, counted from 1.
    list: u64,
    limit: ValueLimit,
    pieces: u64,
    /// Position of the segment, bytes.
    segment: u64,
}

struct Segment {
    contents: u32,
    endian: Endian,
    data: u64,
    end: u64,
    is_complete: bool,
}

impl Directory {
    pub(crate) fn new(limit: ValueLimit) -> Self {
        Self {
            channels: Vec::new(),
            warnings: Vec::new(),
            by_path: HashMap::new(),
            current: Vec::new(),
            list: 1,
            limit,
            pieces: 0,
            segment: 0,
        }
    }

    /// Returns the place in the file that was read last.
    pub(crate) fn place(&self) -> String {
        format!("segment at byte {}", self.segment)
    }

    /// Reads all segments.
    pub(crate) fn read(&mut self, input: &mut Random) -> Result<(), ReadProblem> {
        let length = input.len()?;
        let mut input = BufReader::new(input);
        while self.segment < length {
            let here = input.stream_position()?;
            // A relative seek keeps the contents of the buffer. Otherwise, a file with many small
            // segments would be read again for each segment.
            input.seek_relative(self.segment.wrapping_sub(here) as i64)?;
            let mut reader = ByteReader::new(&mut input, Endian::Little);
            let segment = self.lead_in(&mut reader, length)?;
            if segment.contents & METADATA != 0 {
                if segment.contents & NEW_OBJECTS != 0 {
                    self.current.clear();
                    self.list += 1;
                }
                self.objects(&mut reader)?;
            }
            if segment.contents & RAW_DATA != 0 {
                self.raw_data(&segment)?;
            }
            self.segment = segment.end;
        }
        Ok(())
    }

    fn lead_in(
        &self,
        reader: &mut ByteReader<impl Read>,
        length: u64,
    ) -> Result<Segment, ReadProblem> {
        match &reader.array()? {
            b"TDSm" => {}
            b"TDSh" => {
                return Err(ReadProblem::invalid(
                    "this is only an index (TDSh); give the .tdms file beside it",
                ));
            }
            other => {
                return Err(ReadProblem::Invalid(format!(
                    "a segment begins with {other:02x?} instead of TDSm; the file is damaged, copy it again"
                )));
            }
        }
        let contents = reader.u32()?;
        if contents & BIG_ENDIAN != 0 {
            reader.endian = Endian::Big;
        }
        let _version = reader.u32()?;
        let (size, metadata) = (reader.u64()?, reader.u64()?);
        let start = self.segment + LEAD_IN;
        let left = length.saturating_sub(start);
        let is_complete = size != INCOMPLETE;
        let size = if is_complete { size } else { left };
        if size > left || metadata > size {
            return Err(ReadProblem::Invalid(format!(
                "a segment of {} bytes begins where {left} are left; the file seems truncated, copy it again",
                size.max(metadata)
            )));
        }
        Ok(Segment {
            contents,
            endian: reader.endian,
            data: start + metadata,
            end: start + size,
            is_complete,
        })
    }

    /// Reads the objects that a segment adds or changes.
    fn objects(&mut self, reader: &mut ByteReader<impl Read>) -> Result<(), ReadProblem> {
        for _ in 0..reader.u32()? {
            let path = text(reader)?;
            let channel = self.channel(&path)?;
            let index = reader.u32()?;
            match (channel, index) {
                (Some(channel), u32::MAX) => self.remove_current(channel),
                (None, u32::MAX) => {}
                (Some(channel), 0) => self.add_current(channel),
                (None, 0) => {}
                // The two marks of DAQmx data: the bytes 69 12 00 00 and 69 13 00 00, read in
                // either byte order.
                (channel, 0x1269 | 0x1369 | 0x6912_0000 | 0x6913_0000) => {
                    daqmx_index(reader)?;
                    if let Some(channel) = channel {
                        self.refuse(channel, RAW_DAQMX);
                    }
                }
                (channel, _) => {
                    let layout = layout(reader)?;
                    if let Some(channel) = channel {
                        self.set_layout(channel, layout);
                    }
                }
            }
            self.attributes(reader, channel)?;
        }
        Ok(())
    }

    /// Returns the channel with a path; `None` for the file itself and for groups.
    fn channel(&mut self, path: &str) -> Result<Option<usize>, ReadProblem> {
        if let Some(channel) = self.by_path.get(path) {
            return Ok(Some(*channel));
        }
        let bad = || {
            ReadProblem::Invalid(format!(
                "the object {} is neither the file, a group nor a channel; the file is damaged, copy it again",
                htex_base::finding::plain(path)
            ))
        };
        let parts = parts(path).ok_or_else(bad)?;
        let [group, own] = &parts[..] else {
            return if parts.len() < 2 { Ok(None) } else { Err(bad()) };
        };
        if self.channels.len() == MOST_CHANNELS {
            return Err(ReadProblem::Invalid(format!(
                "more than {MOST_CHANNELS} channels; export only the channels of the recording"
            )));
        }
        let index = self.channels.len();
        self.channels.push(Channel {
            name: format!("{group}/{own}"),
            part: group.len() + 1,
            increment_s: None,
            samples: 0,
            pieces: Vec::new(),
            refused: None,
            layout: None,
            list: 0,
        });
        self.by_path.insert(path.to_owned(), index);
        Ok(Some(index))
    }

    fn add_current(&mut self, channel: usize) {
        let own = &mut self.channels[channel];
        if own.list != self.list {
            own.list = self.list;
            self.current.push(channel);
        }
    }

    /// Removes a channel that has no values in this segment from the list of the previous segment.
    fn remove_current(&mut self, channel: usize) {
        self.channels[channel].list = 0;
        self.current.retain(|own| *own != channel);
    }

    fn set_layout(&mut self, channel: usize, layout: Layout) {
        self.channels[channel].layout = Some(layout);
        self.add_current(channel);
    }

    fn refuse(&mut self, channel: usize, problem: &'static str) {
        self.channels[channel].refused.get_or_insert(problem);
    }

    /// Reads the attributes of an object. If it is a channel, its rate and scales are stored.
    fn attributes(
        &mut self,
        reader: &mut ByteReader<impl Read>,
        channel: Option<usize>,
    ) -> Result<(), ReadProblem> {
        for _ in 0..reader.u32()? {
            let name = text(reader)?;
            let value = attribute(reader)?;
            let Some(channel) = channel else {
                continue;
            };
            match (&name[..], value) {
                ("wf_increment", Some(step_s)) if step_s > 0.0 && step_s.is_finite() => {
                    self.channels[channel].increment_s = Some(step_s);
                }
                ("NI_Number_Of_Scales", Some(count)) if count > 0.0 => {
                    self.refuse(channel, UNSCALED);
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Adds the pieces of a segment to its channels.
    fn raw_data(&mut self, segment: &Segment) -> Result<(), ReadProblem> {
        if segment.contents & DAQMX != 0 {
            for channel in self.current.clone() {
                self.refuse(channel, RAW_DAQMX);
            }
            return Ok(());
        }
        let bytes = segment.end - segment.data;
        if self.current.is_empty() || bytes == 0 {
            return Ok(());
        }
        let layouts: Vec<(usize, Layout)> = self
            .current
            .iter()
            .filter_map(|channel| Some((*channel, self.channels[*channel].layout?)))
            // An empty channel is ignored, even in the rows of interleaved channels.
            .filter(|(_, layout)| layout.values > 0)
            .collect();
        let chunk_bytes =
            layouts.iter().fold(0_u64, |sum, (_, layout)| sum.saturating_add(layout.bytes));
        if chunk_bytes == 0 {
            return Err(ReadProblem::invalid(
                "the segment has values, but no channel has any; the file is damaged, copy it again",
            ));
        }
        let chunks = bytes / chunk_bytes;
        if !bytes.is_multiple_of(chunk_bytes) {
            if segment.is_complete {
                return Err(ReadProblem::invalid(
                    "the segment ends inside its values; the file is damaged, copy it again",
                ));
            }
            self.warnings.push(format!(
                "The file was not completed: the last {} bytes are less than the {chunk_bytes} of a chunk and are left out.",
                bytes % chunk_bytes
            ));
        }
        let is_interleaved = segment.contents & INTERLEAVED != 0;
        let rows = layouts.first().map_or(0, |(_, layout)| layout.values);
        if is_interleaved
            && layouts.iter().any(|(_, layout)| layout.values != rows || layout.kind.is_none())
        {
            return Err(ReadProblem::invalid(
                "interleaved channels have different lengths; the file is damaged, copy it again",
            ));
        }
        let stride = layouts
            .iter()
            .filter_map(|(_, layout)| layout.kind)
            .map(|kind| kind.size() as u64)
            .sum();
        let mut start = segment.data;
        for (channel, layout) in layouts {
            let size = layout.kind.map_or(0, |kind| kind.size() as u64);
            self.add_piece(
                channel,
                layout,
                Piece {
                    start,
                    chunks,
                    chunk_bytes,
                    values: layout.values,
                    stride: if is_interleaved { stride } else { size },
                    kind: layout.kind.unwrap_or(NumberType::U8),
                    endian: segment.endian,
                },
            )?;
            start += if is_interleaved { size } else { layout.bytes };
        }
        Ok(())
    }

    fn add_piece(
        &mut self,
        channel: usize,
        layout: Layout,
        piece: Piece,
    ) -> Result<(), ReadProblem> {
        if layout.kind.is_none() || piece.values == 0 || piece.chunks == 0 {
            return Ok(());
        }
        // A piece takes as much memory as eight numbers.
        self.pieces += 8;
        if self.pieces > self.limit.most_values as u64 {
            return Err(ReadProblem::invalid(
                "its pieces are more than the limit of numbers; export the recording again as one piece (defragmented)",
            ));
        }
        let own = &mut self.channels[channel];
        own.samples = own.samples.saturating_add(piece.values.saturating_mul(piece.chunks));
        own.pieces.push(piece);
        Ok(())
    }
}
