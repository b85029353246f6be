//! Reads the finger's position from a tracker, which has its own sample rate.

use std::io::BufRead;
use std::path::Path;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Instant;

use htex_author::recording::{ColumnMap, ReadOptions, Role, RowMap, read_channels};
use htex_base::files::bounded_lines;

use crate::error::LabError;

/// Shortest time between two rows, seconds.
const SHORTEST_S: f64 = 1e-6;

/// A tracker that delivers positions or speeds as rows with times.
pub trait TrackerRows: Send {
    /// Role and unit of each signal, except the time.
    fn signals(&self) -> Vec<(String, String)>;

    /// Appends the rows that have arrived since the last call. A row has the time on the source's
    /// clock (s), then a value for each signal. Times must ascend. `now_s` is the time of the
    /// source's last sample.
    ///
    /// # Errors
    /// Returns an error if the tracker delivers something that is not a position.
    fn poll(&mut self, now_s: f64, rows: &mut Vec<f64>) -> Result<(), LabError>;

    /// Called when the source's clock starts again at 0 s, because the session reads another source
    /// or has restarted the same source. Rows that arrived earlier are dropped.
    fn restart(&mut self);
}

/// A tracker that replays a file. The times of its rows refer to the clock of the source, which
/// starts at 0 s.
#[derive(Debug)]
pub struct TableTracker {
    signals: Vec<(String, String)>,
    /// Columns: the time, then the signals.
    columns: Vec<Vec<f64>>,
    next: usize,
}

impl TableTracker {
    /// Reads a file with positions or speeds. The first row of the file gets the time 0 s.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or has neither positions nor speeds.
    pub fn open(path: &Path, map: Option<&ColumnMap>) -> Result<Self, LabError> {
        let table = read_channels(path, &ReadOptions::default())?;
        let names: Vec<(String, String)> =
            table.names.iter().map(|name| (name.clone(), String::new())).collect();
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        let map = RowMap::of_motion(&file, &names, map)?;
        let roles = map.roles();
        let moves: Vec<usize> = (0..roles.len()).filter(|i| roles[*i] != Role::Time).collect();
        let signal = |i: &usize| (roles[*i].name().to_owned(), map.unit(roles[*i]).to_owned());
        let rows = table.channels.first().map_or(0, Vec::len);
        let time_s = match table.time_s {
            Some(time_s) => time_s.iter().map(|t| t - time_s[0]).collect(),
            None => (0..rows).map(|row| row as f64 / table.rate_hz).collect(),
        };
        let mut columns = vec![time_s];
        let mut values = map.values(&table.channels);
        columns.extend(moves.iter().map(|i| std::mem::take(&mut values[*i])));
        Ok(Self { signals: moves.iter().map(signal).collect(), columns, next: 0 })
    }
}

impl TrackerRows for TableTracker {
    fn signals(&self) -> Vec<(String, String)> {
        self.signals.clone()
    }

    fn poll(&mut self, now_s: f64, rows: &mut Vec<f64>) -> Result<(), LabError> {
        while self.columns[0].get(self.next).is_some_and(|t| *t <= now_s) {
            rows.extend(self.columns.iter().map(|column| column[self.next]));
            self.next += 1;
        }
        Ok(())
    }

    fn restart(&mut self) {
        self.next = 0;
    }
}

/// Longest line of a tracker, bytes. A line has two numbers, and may contain further text.
const MOST_LINE_BYTES: usize = 4096;
/// Largest number of lines that wait to be read. It is a minute at 1 kHz.
const MOST_LINES: usize = 60_000;

/// A tracker that sends lines `x_mm y_mm`, for example through a pipe or a serial port. Each row
/// gets the time of its arrival.
#[derive(Debug)]
pub struct LineTracker {
    name: String,
    lines: Receiver<(Instant, usize, String)>,
    last_s: f64,
}

impl LineTracker {
    /// Starts a thread that reads the lines. The thread ends when the input ends.
    pub fn new(name: &str, input: impl BufRead + Send + 'static) -> Self {
        // The queue is limited, so that a tracker that nobody reads does not fill the memory.
        let (sender, lines) = sync_channel(MOST_LINES);
        std::thread::spawn(move || {
            for (index, line) in bounded_lines(input, MOST_LINE_BYTES).enumerate() {
                // If reading fails, the text of the error is passed on as a line. This text is not
                // a position, so it is reported as an invalid line.
                let line = line.unwrap_or_else(|error| error.to_string());
                if sender.send((Instant::now(), index + 1, line)).is_err() {
                    return;
                }
            }
        });
        Self { name: name.to_owned(), lines, last_s: f64::NEG_INFINITY }
    }
}

impl TrackerRows for LineTracker {
    fn signals(&self) -> Vec<(String, String)> {
        let pair = |role: Role| (role.name().to_owned(), "mm".to_owned());
        [Role::X, Role::Y].map(pair).to_vec()
    }

    fn poll(&mut self, now_s: f64, rows: &mut Vec<f64>) -> Result<(), LabError> {
        let now = Instant::now();
        while let Ok((arrived, line, text)) = self.lines.try_recv() {
            if text.trim().is_empty() {
                continue;
            }
            let Some([x, y]) = position(&text) else {
                return Err(LabError::TrackerLine {
                    name: self.name.clone(),
                    line,
                    text: htex_base::finding::plain(&text).into_owned(),
                });
            };
            let at_s = now_s - now.saturating_duration_since(arrived).as_secs_f64();
            // Times must ascend, even if several lines arrived at once.
            self.last_s = at_s.max(self.last_s + SHORTEST_S);
            rows.extend([self.last_s, x, y]);
        }
        Ok(())
    }

    fn restart(&mut self) {
        while self.lines.try_recv().is_ok() {}
        self.last_s = f64::NEG_INFINITY;
    }
}

fn position(line: &str) -> Option<[f64; 2]> {
    let words = line.split([' ', '\t', ',', ';']).map(str::trim).filter(|w| !w.is_empty());
    let numbers: Vec<f64> = words.map(|w| w.parse().ok()).collect::<Option<_>>()?;
    let numbers: [f64; 2] = numbers.try_into().ok()?;
    numbers.iter().all(|n| n.is_finite()).then_some(numbers)
}
