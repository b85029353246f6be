//! The analog inputs of the card: their samples, their clock and their buffer.

use std::time::Instant;

use super::{Answer, Card, STEP_S, Task};
use crate::codes;

/// Analog inputs of a PCIe-6321, single-ended.
pub const INPUTS: usize = 16;
/// Highest rate of all channels together.
pub const MAX_INPUT_RATE_HZ: f64 = 250_000.0;
/// Ranges, volts either way.
const RANGES_V: [f64; 4] = [0.2, 1.0, 5.0, 10.0];

impl Card {
    pub fn add_inputs(&mut self, id: usize, names: &str, min_v: f64, max_v: f64) -> Answer<()> {
        self.plugged()?;
        let inputs = expanded(names)?;
        let largest_v = min_v.abs().max(max_v.abs());
        let range_v = RANGES_V.into_iter().find(|range_v| largest_v <= *range_v);
        if min_v >= max_v {
            return Err(codes::INVALID_VALUE);
        }
        let task = self.task(id)?;
        task.range_v = range_v.ok_or(codes::INVALID_VALUE)?;
        task.inputs.extend(inputs);
        Ok(())
    }

    /// Frames that were sampled and not read.
    pub fn available(&mut self, id: usize) -> Answer<u32> {
        self.sample(id, STEP_S)?;
        let task = self.task(id)?;
        Ok((task.sampled - task.read) as u32)
    }

    /// Reads up to `most` frames (negative: all), a sample of each channel in turn.
    pub fn read(&mut self, id: usize, most: i32, to: &mut Vec<f64>) -> Answer<usize> {
        self.sample(id, 0.0)?;
        let task = self.task(id)?;
        let (first, there) = (task.read, task.sampled - task.read);
        let frames = u64::try_from(most).map_or(there, |most| most.min(there));
        task.read += frames;
        let (inputs, range_v, rate_hz) =
            (task.inputs.clone(), task.range_v, task.rate_hz.unwrap_or(1.0));
        for frame in first..first + frames {
            let volts = inputs.iter().map(|input| self.volts(*input, frame, rate_hz));
            to.extend(volts.map(|v| v.clamp(-range_v, range_v)));
        }
        Ok(frames as usize)
    }

    /// Marks a task as running.
    pub(super) fn begin(&mut self, id: usize) -> Answer<()> {
        let task = self.task(id)?;
        task.running = Some(Instant::now());
        let is_input = !task.inputs.is_empty();
        if let Some(loopback) = self.loopback.as_mut().filter(|_| is_input) {
            loopback.begin();
        }
        Ok(())
    }

    /// Returns the voltage at an input: from the finger, or from the file (0 after its end).
    /// Without a file the input carries a sine of 10 Hz times the input's number, counted from 1.
    fn volts(&self, input: usize, frame: u64, rate_hz: f64) -> f64 {
        if let Some(loopback) = &self.loopback {
            return loopback.volts(frame, rate_hz);
        }
        match &self.input {
            Some(rows) => {
                rows.get(frame as usize).and_then(|row| row.get(input)).copied().unwrap_or(0.0)
            }
            None => {
                let turns = frame as f64 / rate_hz * 10.0 * (input + 1) as f64;
                (std::f64::consts::TAU * turns).sin()
            }
        }
    }

    /// Lets the clock sample what is due. If more frames are unread than the buffer can hold, this
    /// call and all later calls fail.
    fn sample(&mut self, id: usize, step_s: f64) -> Answer<()> {
        self.plugged()?;
        let (by_calls, late_s) = (self.by_calls, std::mem::take(&mut self.late_s));
        let left = self.left() as u64;
        let rate_hz = self.task(id)?.rate_hz.unwrap_or(0.0);
        let from_signal = self.by_calls;
        let felt = self.loopback.as_mut();
        let felt = felt.and_then(|felt| felt.frames(rate_hz, from_signal));
        let task = self.task(id)?;
        task.fault.map_or(Ok(()), Err)?;
        let (Some(since), Some(rate_hz)) = (task.running, task.rate_hz) else {
            return Err(codes::NOT_STARTED);
        };
        let due = match felt {
            Some(frames) => frames.saturating_sub(task.sampled),
            None if by_calls => ((step_s + late_s) * rate_hz).round() as u64,
            None => ((since.elapsed().as_secs_f64() * rate_hz) as u64).saturating_sub(task.sampled),
        };
        let due = due.min(left);
        task.sampled += due;
        if task.sampled - task.read > task.capacity as u64 {
            (task.fault, task.running) = (Some(codes::OVERWRITTEN), None);
            return Err(codes::OVERWRITTEN);
        }
        self.came_out += due;
        self.plugged()
    }
}

/// Whether another task has the inputs' clock.
pub(super) fn taken(own: &Task, other: &Task) -> bool {
    !own.inputs.is_empty() && !other.inputs.is_empty() && other.running.is_some()
}

/// The inputs of `Dev1/ai0:2, Dev1/ai5`.
fn expanded(names: &str) -> Answer<Vec<usize>> {
    let mut inputs = Vec::new();
    for name in names.split(',').map(str::trim) {
        let range = name.strip_prefix("Dev1/").ok_or(codes::NO_SUCH_DEVICE)?.strip_prefix("ai").ok_or(codes::NO_SUCH_CHANNEL)?;
        let (first, last) = range.split_once(':').unwrap_or((range, range));
        let number = |text: &str| {
            text.trim_start_matches("ai").parse::<usize>().ok().filter(|n| *n < INPUTS)
        };
        let (Some(first), Some(last)) = (number(first), number(last)) else {
            return Err(codes::NO_SUCH_CHANNEL);
        };
        inputs.extend(first..=last);
    }
    Ok(inputs)
}
