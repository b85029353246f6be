//! Reader of FLAC: losslessly compressed integer samples of up to eight channels.
//!
//! The crate `claxon` decodes the format. The crate `symphonia` is not used because its licence is
//! the MPL.

use std::io::Read;

use claxon::{Block, FlacReader, FlacReaderOptions};

use crate::error::{Fault, ReadProblem};
use crate::formats::samples::{Order, Samples, channel_names};
use crate::input::InputFile;
use crate::sheet::Layout;
use crate::value_limit::ValueLimit;

/// Opens a FLAC file. Its blocks are decoded one by one later.
pub(crate) fn open(opened: InputFile<'_>, limit: ValueLimit) -> Result<Samples<'_>, Fault> {
    let options = FlacReaderOptions { metadata_only: false, read_vorbis_comment: false };
    let reader = FlacReader::new_ext(opened.stream(), options)
        .map_err(|error| broken("header", format!("not a readable FLAC file: {error}")))?;
    let info = reader.streaminfo();
    if info.sample_rate == 0 || info.channels == 0 {
        let problem = "it has no channels or no sample rate; export it again".to_owned();
        return Err(broken("header", problem));
    }
    let width = info.channels as usize;
    Ok(Samples {
        columns: channel_names(width),
        rate_hz: Some(f64::from(info.sample_rate)),
        layout: Layout::Channels { are_integers: true },
        frames: info.samples,
        limit,
        order: Order::Interleaved,
        samples: Box::new(SampleDecoder {
            // Samples are signed, so one bit is the sign.
            full_scale: libm::exp2(f64::from(info.bits_per_sample) - 1.0),
            expected: info.samples,
            reader,
            width,
            block: Block::empty(),
            next: (0, 0),
            before: 0,
            ended: false,
        }),
    })
}

/// The decoded samples, interleaved, as fractions of full scale.
struct SampleDecoder<R: Read> {
    reader: FlacReader<R>,
    width: usize,
    full_scale: f64,
    /// Number of samples in a channel according to the header, if it states one.
    expected: Option<u64>,
    block: Block,
    /// Sample and channel index of the next value in the block.
    next: (u32, u32),
    /// Number of samples of a channel before this block.
    before: u64,
    ended: bool,
}

impl<R: Read> SampleDecoder<R> {
    /// Decodes the next block; returns false at the end.
    fn advance(&mut self) -> Result<bool, Fault> {
        self.before += u64::from(self.block.duration());
        // The decoder reuses the buffer of the last block, so that it does not allocate a buffer
        // for every block.
        let buffer = std::mem::replace(&mut self.block, Block::empty()).into_buffer();
        let place = |at: u64| format!("sample {at} (counted from 0)");
        let block = self.reader.blocks().read_next_or_eof(buffer).map_err(|error| {
            let problem = format!("the file ends or breaks here: {error}; copy it again");
            broken(&place(self.before), problem)
        })?;
        let Some(block) = block else {
            return match self.expected {
                // If the file ends after a whole block, the decoder takes this for the end of the
                // stream.
                Some(expected) if self.before < expected => {
                    let problem = format!(
                        "the file ends here, its header says {expected} samples; copy it again"
                    );
                    Err(broken(&place(self.before), problem))
                }
                _ => Ok(false),
            };
        };
        if block.channels() as usize != self.width {
            let problem =
                format!("{} channels follow {}; export it again", block.channels(), self.width);
            return Err(broken(&place(self.before), problem));
        }
        self.block = block;
        self.next = (0, 0);
        Ok(true)
    }
}

impl<R: Read> Iterator for SampleDecoder<R> {
    type Item = Result<f64, Fault>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.ended && self.next.0 >= self.block.duration() {
            match self.advance() {
                Ok(true) => {}
                Ok(false) => self.ended = true,
                Err(error) => {
                    self.ended = true;
                    return Some(Err(error));
                }
            }
        }
        if self.ended {
            return None;
        }
        let (sample, channel) = self.next;
        let value = self.block.sample(channel, sample);
        self.next = if channel + 1 == self.block.channels() {
            (sample + 1, 0)
        } else {
            (sample, channel + 1)
        };
        Some(Ok(f64::from(value) / self.full_scale))
    }
}

fn broken(place: &str, problem: String) -> Fault {
    ReadProblem::Invalid(problem).at_place(place)
}
