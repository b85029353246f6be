//! The finger's motion while a scene plays. It comes either from input lines or from a finger on a
//! page. A thread reads the lines and passes them to the playing loop without a lock.

use std::io::BufRead;
use std::thread;
use std::time::Duration;

use htex::Motion;
#[cfg(feature = "lab")]
use htex_lab::study::Touch;
use htex_scene::Renderer;
use rtrb::{Consumer, Producer, RingBuffer};

/// Maximum number of motions that may wait in the queue for the player.
const ROOM: usize = 1024;
/// Time between two attempts of the reader if the queue is full.
const WAIT: Duration = Duration::from_millis(1);

/// The source of motions.
pub(crate) enum Motions {
    /// The queue that a reader fills.
    Queue(Consumer<Motion>),
    /// A page, and the force of a finger on it (N).
    #[cfg(feature = "lab")]
    Page(Touch, f64),
}

/// The input that arrived since the last call.
enum MotionUpdate {
    /// The newest motion.
    New(Motion),
    /// Nothing new.
    Unchanged,
    /// The input has ended.
    End,
}

impl Motions {
    /// Reads lines `speed_mm_s force_n [x_mm y_mm]` from standard input in a separate thread. A
    /// malformed line is reported with its number and skipped. A line with a speed or force that no
    /// finger can have is a failed reading, as in the renderer.
    pub(crate) fn from_stdin() -> Self {
        let (sender, receiver) = RingBuffer::new(ROOM);
        // A read cannot be interrupted, so the thread is left to the end of the process.
        thread::spawn(move || read(std::io::stdin().lock(), sender));
        Self::Queue(receiver)
    }

    /// Applies the newest motion to a renderer. Returns false when the input has ended.
    pub(crate) fn follow(&mut self, renderer: &mut Renderer) -> bool {
        match self.update() {
            MotionUpdate::New(finger) => {
                // After a failed reading, the renderer keeps the last motion for a while, and then
                // assumes no contact. The next reading may be valid.
                let _ = renderer.set_motion(finger);
                true
            }
            MotionUpdate::Unchanged => true,
            MotionUpdate::End => false,
        }
    }

    /// Returns what has arrived since the last call.
    fn update(&mut self) -> MotionUpdate {
        match self {
            Self::Queue(queue) => newest(queue),
            #[cfg(feature = "lab")]
            Self::Page(touch, force_n) => {
                let motion = touch
                    .now()
                    .map_or(Motion::AWAY, |touched| Motion::new(touched.speed_mm_s, *force_n));
                MotionUpdate::New(motion)
            }
        }
    }
}

/// Returns the newest valid reading in a queue. Returns a failed one only if there is no valid one.
fn newest(queue: &mut Consumer<Motion>) -> MotionUpdate {
    // The end is checked before the queue is emptied, so that no motion before the end is missed.
    let is_ended = queue.is_abandoned();
    let mut newest: Option<Motion> = None;
    while let Ok(finger) = queue.pop() {
        if newest.is_none() || finger.is_reading() {
            newest = Some(finger);
        }
    }
    match newest {
        Some(finger) => MotionUpdate::New(finger),
        None if is_ended => MotionUpdate::End,
        None => MotionUpdate::Unchanged,
    }
}

fn read(lines: impl BufRead, mut sender: Producer<Motion>) {
    for (index, line) in lines.lines().enumerate() {
        let Ok(line) = line else { return };
        if line.trim().is_empty() {
            continue;
        }
        let Some(finger) = parse(&line) else {
            let number = index + 1;
            crate::output::tell!(
                "warning: line {number}, {line:?}, is skipped: a motion is \
                 `speed_mm_s force_n [x_mm y_mm]`"
            );
            continue;
        };
        while sender.is_full() {
            if sender.is_abandoned() {
                return;
            }
            thread::sleep(WAIT);
        }
        // Cannot fail: there is space, and only this thread fills it.
        let _ = sender.push(finger);
    }
}

fn parse(line: &str) -> Option<Motion> {
    let words = line.split([' ', '\t', ',', ';']).filter(|w| !w.is_empty());
    let numbers: Vec<f64> = words.map(|w| w.parse().ok()).collect::<Option<_>>()?;
    match numbers[..] {
        [speed, force] => Some(Motion::new(speed, force)),
        [speed, force, x, y] => Some(Motion::new(speed, force).with_place_mm([x, y])),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_motion_counts_and_bad_lines_do_not() {
        let (sender, receiver) = RingBuffer::new(ROOM);
        read(&b"80 0.4\nfast\n1 2 3\n-60,0.5, 1 2\n50 -1\nNaN 1\n9e9 1\n"[..], sender);
        let mut motions = Motions::Queue(receiver);
        let MotionUpdate::New(finger) = motions.update() else {
            unreachable!("two lines were good");
        };
        let got = (finger.speed_mm_s, finger.force_n, finger.place_mm);
        assert_eq!(got, (-60.0, 0.5, Some([1.0, 2.0])));
        assert!(matches!(motions.update(), MotionUpdate::End));
    }

    /// A failed reading is passed on. The renderer holds the last motion for a while, and then
    /// assumes no contact.
    #[test]
    fn a_failed_reading_alone_is_passed_on() {
        for line in ["NaN 0.4\n", "80 inf\n", "80 -1\n", "80 21\n", "1001 0.4\n"] {
            let (sender, receiver) = RingBuffer::new(ROOM);
            read(line.as_bytes(), sender);
            let moved = Motions::Queue(receiver).update();
            assert!(matches!(moved, MotionUpdate::New(finger) if !finger.is_reading()), "{line}");
        }
    }
}
