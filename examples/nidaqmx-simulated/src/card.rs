//! The card: two outputs, their tasks, and the clock that takes samples.

pub mod input;
pub mod loopback;

use std::collections::{BTreeMap, VecDeque};
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use crate::codes;
use loopback::Loopback;

/// Of one channel of a PCIe-6321.
pub const FULL_SCALE_V: f64 = 10.0;
pub const MAX_RATE_HZ: f64 = 900_000.0;
pub const MIN_RATE_HZ: f64 = 100e6 / u32::MAX as f64;
pub const CHANNELS: [&str; 2] = ["Dev1/ao0", "Dev1/ao1"];

/// Time by which a call advances the clock if `by_calls` is set, seconds.
const STEP_S: f64 = 0.002;

#[derive(Default)]
pub struct Card {
    /// Folder to which the output is recorded: a file for each channel, in volts, one value a line.
    pub record: Option<PathBuf>,
    /// Whether each call that reads the state advances the clock, which then ignores real time.
    pub by_calls: bool,
    /// Whether the clock stands still.
    pub stands: bool,
    /// Voltages at the inputs: a row for each frame.
    pub input: Option<Vec<Vec<f64>>>,
    /// The finger that feels the output and moves the inputs; in place of `input`.
    pub loopback: Option<Loopback>,
    /// If `by_calls` is set: the time by which the next call to an input comes too late, seconds.
    pub late_s: f64,
    /// Number of output samples or input frames after which the card is removed.
    pub unplug_after: Option<u64>,
    tasks: BTreeMap<usize, Task>,
    made: usize,
    came_out: u64,
}

#[derive(Default)]
struct Task {
    channel: Option<usize>,
    limits_v: (f64, f64),
    rate_hz: Option<f64>,
    regenerates: bool,
    capacity: usize,
    buffer: VecDeque<f64>,
    running: Option<Instant>,
    taken: u64,
    fault: Option<i32>,
    inputs: Vec<usize>,
    range_v: f64,
    /// Frames that the inputs have sampled, and those that were read.
    sampled: u64,
    read: u64,
}

type Answer<T> = Result<T, i32>;

impl Card {
    pub fn create(&mut self) -> Answer<usize> {
        self.plugged()?;
        self.made += 1;
        let task = Task { regenerates: true, ..Task::default() };
        self.tasks.insert(self.made, task);
        Ok(self.made)
    }

    pub fn add_channel(&mut self, id: usize, name: &str, min_v: f64, max_v: f64) -> Answer<()> {
        self.plugged()?;
        if !name.starts_with("Dev1/") {
            return Err(codes::NO_SUCH_DEVICE);
        }
        let found = CHANNELS.iter().position(|c| *c == name);
        let channel = found.ok_or(codes::NO_SUCH_CHANNEL)?;
        if min_v < -FULL_SCALE_V || max_v > FULL_SCALE_V || min_v >= max_v {
            return Err(codes::INVALID_VALUE);
        }
        let task = self.task(id)?;
        (task.channel, task.limits_v) = (Some(channel), (min_v, max_v));
        Ok(())
    }

    pub fn set_clock(&mut self, id: usize, rate_hz: f64, samples: u64) -> Answer<()> {
        if !(MIN_RATE_HZ..=MAX_RATE_HZ).contains(&rate_hz) {
            return Err(codes::INVALID_VALUE);
        }
        let task = self.task(id)?;
        task.rate_hz = Some(rate_hz);
        task.capacity = task.capacity.max(samples as usize);
        Ok(())
    }

    pub fn set_buffer(&mut self, id: usize, samples: u32) -> Answer<()> {
        self.task(id)?.capacity = samples as usize;
        Ok(())
    }

    pub fn set_regenerates(&mut self, id: usize, yes: bool) -> Answer<()> {
        self.task(id)?.regenerates = yes;
        Ok(())
    }

    pub fn start(&mut self, id: usize) -> Answer<()> {
        self.plugged()?;
        let channel = self.task(id)?.channel;
        let own = self.tasks.get(&id).ok_or(codes::INVALID_TASK)?;
        let taken = |(other, task): (&usize, &Task)| {
            let output = channel.is_some() && task.running.is_some() && task.channel == channel;
            *other != id && (output || input::taken(own, task))
        };
        if self.tasks.iter().any(taken) {
            return Err(codes::RESERVED);
        }
        self.begin(id)
    }

    /// The output keeps its last value.
    pub fn stop(&mut self, id: usize) -> Answer<()> {
        if self.task(id)?.inputs.is_empty() {
            self.advance(id, 0.0)?;
        }
        let task = self.task(id)?;
        task.running = None;
        task.buffer.clear();
        task.fault.take().map_or(Ok(()), Err)
    }

    pub fn clear(&mut self, id: usize) -> Answer<()> {
        let there = self.tasks.remove(&id);
        there.map(|_| ()).ok_or(codes::INVALID_TASK)
    }

    /// Ends all tasks and sets the outputs to zero, their power-on state.
    pub fn reset(&mut self) {
        self.tasks.clear();
        self.put_out(0, &[0.0], None);
    }

    /// Takes the samples that fit. A task without a clock outputs its samples at once.
    pub fn write(&mut self, id: usize, samples: &[f64], start: bool) -> Answer<usize> {
        self.advance(id, STEP_S)?;
        let task = self.task(id)?;
        let (min_v, max_v) = task.limits_v;
        if samples.iter().any(|v| !(min_v..=max_v).contains(v)) {
            return Err(codes::INVALID_SAMPLE);
        }
        let (clocked, running) = (task.rate_hz.is_some(), task.running.is_some());
        let space = task.capacity - task.buffer.len().min(task.capacity);
        if clocked && !running && samples.len() > space {
            return Err(codes::NO_MORE_SPACE);
        }
        let taken = if clocked { samples.len().min(space) } else { samples.len() };
        task.buffer.extend(&samples[..taken]);
        if start && !running {
            self.start(id)?;
        }
        self.advance(id, 0.0)?;
        Ok(taken)
    }

    pub fn space(&mut self, id: usize) -> Answer<u32> {
        self.advance(id, STEP_S)?;
        let task = self.task(id)?;
        let space = task.capacity.saturating_sub(task.buffer.len());
        Ok(task.running.map_or(0, |_| space as u32))
    }

    pub fn generated(&mut self, id: usize) -> Answer<u64> {
        self.advance(id, STEP_S)?;
        Ok(self.task(id)?.taken)
    }

    pub fn done(&mut self, id: usize) -> Answer<bool> {
        self.advance(id, STEP_S)?;
        Ok(self.task(id)?.running.is_none())
    }

    pub fn plugged(&self) -> Answer<()> {
        match self.unplug_after {
            Some(after) if self.came_out >= after => Err(codes::NOT_PRESENT),
            _ => Ok(()),
        }
    }

    fn task(&mut self, id: usize) -> Answer<&mut Task> {
        self.tasks.get_mut(&id).ok_or(codes::INVALID_TASK)
    }

    /// Lets the clock take the samples that are due; `step_s` is the step of a clock that advances
    /// by calls.
    fn advance(&mut self, id: usize, step_s: f64) -> Answer<()> {
        self.plugged()?;
        let (by_calls, stands, left) = (self.by_calls, self.stands, self.left());
        let task = self.task(id)?;
        task.fault.map_or(Ok(()), Err)?;
        let Some(since) = task.running else {
            return Ok(());
        };
        let due = match task.rate_hz {
            None => task.buffer.len(),
            Some(_) if stands => 0,
            Some(rate_hz) if by_calls => (step_s * rate_hz) as usize,
            Some(rate_hz) => {
                ((since.elapsed().as_secs_f64() * rate_hz) as u64 - task.taken) as usize
            }
        };
        let mut out = Vec::with_capacity(due);
        while out.len() < due.min(left) {
            let Some(value) = task.buffer.pop_front() else {
                break;
            };
            if task.regenerates && task.rate_hz.is_some() {
                task.buffer.push_back(value);
            }
            out.push(value);
        }
        task.taken += out.len() as u64;
        if out.len() < due.min(left) {
            (task.fault, task.running) = (Some(codes::RAN_DRY), None);
        }
        let (fault, channel) = (task.fault, task.channel.unwrap_or(0));
        let rate_hz = task.rate_hz;
        self.put_out(channel, &out, rate_hz);
        self.plugged()?;
        fault.map_or(Ok(()), Err)
    }

    fn left(&self) -> usize {
        let left = |after: u64| (after - self.came_out.min(after)) as usize;
        self.unplug_after.map_or(usize::MAX, left)
    }

    fn put_out(&mut self, channel: usize, volts: &[f64], rate_hz: Option<f64>) {
        self.came_out += volts.len() as u64;
        if let Some(loopback) = self.loopback.as_ref().filter(|_| channel == 0) {
            loopback.put(volts, rate_hz);
        }
        let Some(folder) = &self.record else { return };
        let lines: String = volts.iter().map(|v| format!("{v}\n")).collect();
        let name = format!("{}.txt", CHANNELS[channel].replace('/', "_"));
        let file = File::options().create(true).append(true).open(folder.join(name));
        let written = file.and_then(|mut file| file.write_all(lines.as_bytes()));
        if let Err(error) = written {
            eprintln!("nidaqmx-simulated: {}: {error}", folder.display());
        }
    }
}
