//! Records the force on the participant's finger while a trial plays. The source is read in its own
//! thread.
//!
//! The source is opened anew for each trial, so that the recording of a trial does not depend on
//! earlier trials.
//!
//! A session that is killed and then continued writes the same files as a session without
//! interruption. This requires that the source delivers the same samples in both cases.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;

use htex_author::Exploration;
use htex_author::recording::Role;
use htex_base::files::{AtFile, OwnFolder};
use htex_device::{DeviceError, Input};
use htex_format::Quantity;
use serde_json::json;

use crate::error::LabError;
use crate::record::{
    Format, Inputs, Reader, Requirements, Signals, TakeData, TakeHeader, TrackerRows, judge,
    write_signals,
};
use crate::study::asking::Playback;
use crate::study::lines::{FeltFile, SourceUsed};
use crate::study::log::file_hash;
use crate::study::stimulus::Stimulus;

/// Folder for a participant's recordings.
const FOLDER: &str = "felt";
/// Each recording is judged by this number: the largest allowed relative difference between its
/// motion and the study's motion.
const TOLERANCE: f64 = 0.1;

pub type OpenSource = Box<dyn Fn() -> Result<Box<dyn Input>, DeviceError>>;

/// Settings for recording felt forces: what is recorded, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct FeltSetup {
    /// Folder for the answers.
    pub folder: PathBuf,
    pub participant: String,
    /// The source, as the user named it.
    pub source: String,
    /// Settings of the source, as the user gave them.
    pub settings: BTreeMap<String, String>,
    /// The channel map (which channel carries which signal), as the user gave it.
    pub map: Option<String>,
    /// Quantity of the texture's signal.
    pub quantity: Quantity,
    /// Speed and normal force of the study's motion, if the study has a single motion.
    pub target: Exploration,
    pub format: Format,
    /// Name and version of the program that records.
    pub tool: String,
    /// Whether a recording begins with the first sample of the source. If false, the recording
    /// begins when the first played sample reaches the display. Set this field to true for trials
    /// that are not played in real time, because such trials and the source have no common clock.
    pub is_fast: bool,
}

/// Records felt forces.
pub struct Felt {
    setup: FeltSetup,
    open: OpenSource,
    rate_hz: f64,
    /// `None` while a recording thread uses them.
    inputs: Option<Inputs>,
    running: Option<Running>,
}

/// A recording in progress.
struct Running {
    shared: Arc<ThreadState>,
    thread: JoinHandle<(Inputs, Result<TakeData, LabError>)>,
}

#[derive(Default)]
struct ThreadState {
    stop: AtomicBool,
    failed: AtomicBool,
    /// Time until the first played sample reaches the display, seconds.
    lead_s: OnceLock<f64>,
}

impl Felt {
    /// Creates a recorder and the folder for its recordings, and removes unfinished files that a
    /// killed program left there. `signals` are the signals of the source, and `rate_hz` is its
    /// sample rate.
    ///
    /// # Errors
    /// Returns [`LabError::File`] if the folder cannot be prepared, and [`LabError::Setup`] if the
    /// file format of the recordings cannot store this sample rate.
    pub fn new(
        setup: FeltSetup,
        open: OpenSource,
        rate_hz: f64,
        signals: Signals,
        tracker: Option<Box<dyn TrackerRows>>,
    ) -> Result<Self, LabError> {
        setup.format.check(rate_hz)?;
        let own = OwnFolder::private(&setup.folder);
        let inside = Path::new(&setup.participant).join(FOLDER);
        remove_unfinished(&own, &inside).writing(setup.folder.join(&inside))?;
        let inputs = Some(Inputs { signals, tracker });
        Ok(Self { setup, open, rate_hz, inputs, running: None })
    }

    /// Describes the source, for the header of answers.
    pub fn used(&self) -> Option<SourceUsed> {
        let inputs = self.inputs.as_ref()?;
        let setup = &self.setup;
        Some(SourceUsed {
            name: setup.source.clone(),
            settings: setup.settings.clone(),
            map: setup.map.clone(),
            calibrations: inputs.signals.calibrations(),
            quantity: setup.quantity,
            rate_hz: self.rate_hz,
            signals: inputs.signals.list(),
            tracker: inputs.tracked(),
            format: setup.format,
        })
    }

    /// Starts the source for a trial. The recording begins at the time that [`Self::sounds`] sets;
    /// earlier samples are left out.
    ///
    /// # Errors
    /// Returns an error if the source cannot be opened or started, or if its sample rate has
    /// changed.
    pub fn begin(&mut self, name: &str, seconds: f64) -> Result<(), LabError> {
        // If an earlier recording was not finished, it may still be running.
        self.abort();
        let mut source = (self.open)()?;
        if source.stream().rate_hz != self.rate_hz {
            return Err(LabError::Setup {
                what: "the sample rate of the source",
                value: source.stream().rate_hz.to_string(),
                allowed: "it is the one that it had at the beginning of the session",
            });
        }
        let Some(mut inputs) = self.inputs.take() else {
            return Err(DeviceError::Closed(self.setup.source.clone()).into());
        };
        if let Some(tracker) = &mut inputs.tracker {
            tracker.restart();
        }
        let header = self.header(name, seconds, &inputs);
        if let Err(error) = source.start() {
            // The inputs are put back, so that the next trial can try again.
            self.inputs = Some(inputs);
            return Err(error.into());
        }
        let shared = Arc::new(ThreadState::default());
        if self.setup.is_fast {
            let _ = shared.lead_s.set(0.0);
        }
        let reader = Reader::new(source, inputs, seconds);
        let of_thread = Arc::clone(&shared);
        let thread = std::thread::spawn(move || read(reader, header, &of_thread));
        self.running = Some(Running { shared, thread });
        Ok(())
    }

    fn header(&self, name: &str, seconds: f64, inputs: &Inputs) -> TakeHeader {
        let setup = &self.setup;
        let signals = inputs.signals.list();
        // A target can only be judged if the quantity is measured.
        let is_motion = |(role, _): &(String, String)| ["x", "y", "speed"].contains(&&role[..]);
        let moves = signals.iter().chain(&inputs.tracked()).any(is_motion);
        let normal = inputs.signals.position(Role::Normal);
        TakeHeader {
            htex_take: 1,
            name: name.to_owned(),
            number: 1,
            tool: setup.tool.clone(),
            source: setup.source.clone(),
            map: setup.map.clone(),
            calibrations: inputs.signals.calibrations(),
            quantity: setup.quantity,
            rate_hz: self.rate_hz,
            seconds,
            signals,
            tare: Vec::new(),
            tracker: inputs.tracked(),
            target_speed_mm_s: setup.target.speed_mm_s.filter(|_| moves),
            target_force_n: setup.target.force_n.filter(|_| normal.is_some()),
            tolerance: TOLERANCE,
            required: Requirements::NOTHING,
            format: setup.format,
        }
    }

    /// Tells the recorder that the first played sample reaches the display in `lead_s` seconds. The
    /// recording begins at this time.
    pub fn sounds(&self, lead_s: f64) {
        if let Some(running) = &self.running {
            // Only the first call has an effect.
            let _ = running.shared.lead_s.set(lead_s.max(0.0));
        }
    }

    /// Returns whether a recording still waits for a call of [`Self::sounds`].
    pub fn waits(&self) -> bool {
        let running = self.running.as_ref();
        running.is_some_and(|running| running.shared.lead_s.get().is_none())
    }

    /// Returns whether the recording has ended with an error. [`Self::finish`] returns that error.
    pub fn has_failed(&self) -> bool {
        let running = self.running.as_ref();
        running.is_some_and(|running| running.shared.failed.load(Ordering::Acquire))
    }

    /// Waits for the end of the recording, and writes the recording and its JSON. Returns only
    /// after both files are on disk. Returns `None` if nothing was recorded.
    ///
    /// # Errors
    /// Returns the errors of the source, and [`LabError::File`] if a file cannot be written or
    /// read.
    pub fn finish(
        &mut self,
        stimulus: &Stimulus,
        played: &Playback,
    ) -> Result<Option<FeltFile>, LabError> {
        // `end` is called even if nothing is recorded, because it joins a thread that may still be
        // running.
        let (Some(name), Some(data)) = (&stimulus.felt, self.end()) else {
            return Ok(None);
        };
        let data = data.map_err(LabError::felt)?;
        let verdict = judge(&data);
        let participant = &self.setup.participant;
        let own = OwnFolder::private(&self.setup.folder);
        let inside = Path::new(participant).join(FOLDER);
        let written = write_signals(&own, &inside, name, &data, &|fit| {
            json!({
                "trial": {
                    "participant": participant,
                    "texture": stimulus.texture,
                    "model": stimulus.model,
                    "seed": stimulus.seed,
                    "gain_db": stimulus.gain_db,
                    "drive_v": played.drive_v,
                    "speed_mm_s": self.setup.target.speed_mm_s,
                    "force_n": self.setup.target.force_n,
                },
                "take": data.header,
                "frames": data.frames(),
                "verdict": verdict,
                "fit": fit.iter().map(|text| within(&self.setup.folder, text)).collect::<Vec<_>>(),
            })
        })
        .map_err(LabError::felt)?;
        let file = written.recording.file_name().unwrap_or_default();
        Ok(Some(FeltFile {
            file: format!("{participant}/{FOLDER}/{}", file.to_string_lossy()),
            blake3: file_hash(&written.recording)?,
            compared: data.header.target_speed_mm_s.or(data.header.target_force_n).is_some(),
            off_target: verdict.reasons,
        }))
    }

    /// Ends a recording and discards it.
    pub fn abort(&mut self) {
        if let Some(running) = &self.running {
            running.shared.stop.store(true, Ordering::Release);
        }
        let _ = self.end();
    }

    fn end(&mut self) -> Option<Result<TakeData, LabError>> {
        let running = self.running.take()?;
        let (inputs, data) = running.thread.join().ok()?;
        self.inputs = Some(inputs);
        Some(data)
    }
}

impl Drop for Felt {
    fn drop(&mut self) {
        self.abort();
    }
}

/// If the text is a path in the folder of answers, returns the path relative to this folder. Any
/// other text is returned unchanged.
fn within(folder: &Path, text: &str) -> String {
    let inner = Path::new(text).strip_prefix(folder);
    inner.map_or_else(|_| text.to_owned(), |path| path.display().to_string())
}

fn read(
    mut reader: Reader,
    header: TakeHeader,
    shared: &ThreadState,
) -> (Inputs, Result<TakeData, LabError>) {
    let mut data = TakeData::empty(header);
    let taken = read_take(&mut reader, &mut data, shared);
    let stopped = reader.source.finish();
    let result = taken.and(stopped.map_err(LabError::from));
    shared.failed.store(result.is_err(), Ordering::Release);
    (reader.inputs, result.map(|()| data))
}

/// Reads until the recording is complete or no longer wanted.
fn read_take(
    reader: &mut Reader,
    data: &mut TakeData,
    shared: &ThreadState,
) -> Result<(), LabError> {
    let frames = data.header.frames();
    let mut begin = None;
    while data.frames() < frames && !shared.stop.load(Ordering::Acquire) {
        // The lead is looked up before the block is read, so that the recording can begin with this
        // block.
        if let (None, Some(lead_s)) = (begin, shared.lead_s.get()) {
            begin = Some(reader.now_s() + lead_s);
        }
        let left = match begin {
            Some(begin_s) => frames - data.frames() + lead(reader, begin_s, data),
            None => frames,
        };
        let Some(block) = reader.block(left as u64).map_err(|e| after(e, data))? else {
            continue;
        };
        let Some(begin_s) = begin else { continue };
        block.check(&data.header)?;
        let before = ((begin_s - block.begin_s) * data.header.rate_hz).round().max(0.0) as usize;
        let width = data.header.signals.len();
        let values = block.interleaved();
        data.extend(&values[(before * width).min(values.len())..]);
        let rows = block.rows_since(&data.header, begin_s);
        data.extend_tracker(&rows);
    }
    Ok(())
}

/// Returns the number of frames before the recording begins.
fn lead(reader: &Reader, begin_s: f64, data: &TakeData) -> usize {
    ((begin_s - reader.now_s()) * data.header.rate_hz).round().max(0.0) as usize
}

/// If the error states that the source ended, adds to it how much was recorded until then.
fn after(error: LabError, data: &TakeData) -> LabError {
    match error {
        LabError::Ended { seconds, kept, .. } => {
            LabError::Ended { after_s: data.recorded_s(), seconds, kept }
        }
        error => error,
    }
}

/// Creates a folder, and removes unfinished files in it that a killed program left.
fn remove_unfinished(own: &OwnFolder, inside: &Path) -> std::io::Result<()> {
    own.make_folder(inside)?;
    let left = |name: &String| name.starts_with(".htex-") && name.ends_with(".part");
    for name in own.files(inside)?.into_iter().filter(left) {
        own.remove(&inside.join(name))?;
    }
    // Removing the last file also removes the folder, so the folder is created again.
    own.make_folder(inside).map(drop)
}
