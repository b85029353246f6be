//! A live motion, read from lines and passed to the playing loop without a lock.

use std::io::BufRead;
use std::thread;
use std::time::Duration;

use htex_scene::Finger;
use rtrb::{Consumer, Producer, RingBuffer};

/// Motions that may wait for the player.
const ROOM: usize = 1024;
/// Time between two tries of the reader when the queue is full.
const WAIT: Duration = Duration::from_millis(1);

/// The queue of incoming motions.
pub(crate) struct Motions(Consumer<Finger>);

/// What has arrived since the last call.
pub(crate) enum Moved {
    /// The newest motion.
    To(Finger),
    /// Nothing new.
    Not,
    /// The input has ended.
    Ended,
}

impl Motions {
    /// A queue, and its other end.
    #[cfg(feature = "lab")]
    pub(crate) fn queue() -> (Producer<Finger>, Self) {
        let (sender, receiver) = RingBuffer::new(ROOM);
        (sender, Self(receiver))
    }

    /// Reads lines `speed_mm_s force_n [x_mm y_mm]` from standard input in a thread of its own. An
    /// invalid line is reported with its number and skipped.
    pub(crate) fn from_stdin() -> Self {
        let (sender, receiver) = RingBuffer::new(ROOM);
        thread::spawn(move || read(std::io::stdin().lock(), sender));
        Self(receiver)
    }

    /// What has arrived since the last call.
    pub(crate) fn look(&mut self) -> Moved {
        // Read before the ring is emptied, so that no motion before the end is missed.
        let is_ended = self.0.is_abandoned();
        let mut newest = None;
        while let Ok(finger) = self.0.pop() {
            newest = Some(finger);
        }
        match newest {
            Some(finger) => Moved::To(finger),
            None if is_ended => Moved::Ended,
            None => Moved::Not,
        }
    }
}

fn read(lines: impl BufRead, mut sender: Producer<Finger>) {
    for (index, line) in lines.lines().enumerate() {
        let Ok(line) = line else { return };
        if line.trim().is_empty() {
            continue;
        }
        let Some(finger) = parse(&line) else {
            let number = index + 1;
            crate::output::tell!(
                "warning: line {number}, {line:?}, is skipped: a motion is \
                 `speed_mm_s force_n [x_mm y_mm]`, the force not negative"
            );
            continue;
        };
        while sender.is_full() {
            if sender.is_abandoned() {
                return;
            }
            thread::sleep(WAIT);
        }
        // There is space, and only this thread fills it.
        let _ = sender.push(finger);
    }
}

fn parse(line: &str) -> Option<Finger> {
    let words = line.split([' ', '\t', ',', ';']).filter(|w| !w.is_empty());
    let numbers: Vec<f64> = words.map(|w| w.parse().ok()).collect::<Option<_>>()?;
    let (speed_mm_s, force_n, at_mm) = match numbers[..] {
        [speed, force] => (speed, force, None),
        [speed, force, x, y] => (speed, force, Some([x, y])),
        _ => return None,
    };
    let is_sound = numbers.iter().all(|x| x.is_finite()) && force_n >= 0.0;
    is_sound.then_some(Finger {
        speed_mm_s,
        force_n,
        at_mm,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_motion_counts_and_bad_lines_do_not() {
        let (sender, receiver) = RingBuffer::new(ROOM);
        read(
            &b"80 0.4\nfast\n1 2 3\n-60,0.5, 1 2\n50 -1\nNaN 1\n"[..],
            sender,
        );
        let mut motions = Motions(receiver);
        let Moved::To(finger) = motions.look() else {
            unreachable!("two lines were good");
        };
        let got = (finger.speed_mm_s, finger.force_n, finger.at_mm);
        assert_eq!(got, (-60.0, 0.5, Some([1.0, 2.0])));
        assert!(matches!(motions.look(), Moved::Ended));
    }
}
