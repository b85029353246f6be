//! The position and motion of the finger over the course of a scene.

use htex_play::exploration::{HOLD_S, MIN_SLIDING_MM_S, slides};

use crate::file::{Constant, Motion, Region, Surface};
use crate::trace::Trace;

/// Position, signed speed and force of the finger at one time. [`Self::motion`] is the part that a
/// voice follows; [`crate::file::Motion`] is the motion of a whole scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finger {
    /// Scanning speed, mm/s; negative on the back stroke.
    pub speed_mm_s: f64,
    /// Normal force, newtons.
    pub force_n: f64,
    /// Position, mm. `None` means that the finger is on every surface without a region.
    pub at_mm: Option<[f64; 2]>,
}

impl Finger {
    /// A finger without contact.
    pub const AWAY: Self = Self { speed_mm_s: 0.0, force_n: 0.0, at_mm: None };

    /// The motion that a voice follows: the speed without its sign, and the force.
    pub fn motion(&self) -> htex_play::Motion {
        htex_play::Motion::new(self.speed_mm_s.abs(), self.force_n)
    }

    /// Returns whether a finger can move like this: all numbers are finite, the force is not
    /// negative, the speed is at most 1000 mm/s and the force at most 20 N. Otherwise the reading
    /// has failed.
    pub fn is_reading(&self) -> bool {
        let is_placed = self.at_mm.is_none_or(|at| at.iter().all(|x| x.is_finite()));
        is_placed && self.motion().checked().is_ok() && self.motion().is_plausible()
    }

    /// Whether the finger is in contact and moving.
    pub fn slides(&self) -> bool {
        slides(self.speed_mm_s, self.force_n)
    }

    /// Whether the finger is inside a region; `None` covers everything.
    pub(crate) fn is_in(&self, region: Option<&Region>) -> bool {
        match (region, self.at_mm) {
            (None, _) => true,
            (Some(region), Some([x, y])) => {
                let within = |range: [f64; 2], at: f64| (range[0]..range[1]).contains(&at);
                within(region.x_mm, x) && within(region.y_mm, y)
            }
            (Some(_), None) => false,
        }
    }
}

/// Filters the readings of a finger. It replaces impossible readings by the last good motion, for
/// at most [`HOLD_S`]. Every motion of a scene passes through this filter, so that one bad reading
/// is not felt.
#[derive(Debug)]
pub(crate) struct Readings {
    last: Finger,
    /// How many control blocks a motion is held at most, and for how many it has been held.
    most: u64,
    held: u64,
}

impl Readings {
    /// Makes a filter for one reading in each control block, whose duration is given in seconds.
    pub(crate) fn new(control_s: f64) -> Self {
        Self { last: Finger::AWAY, most: (HOLD_S / control_s) as u64, held: 0 }
    }

    /// Takes a reading that lasts for a number of control blocks. Returns that reading, or the last
    /// good one in its place, or no contact.
    pub(crate) fn take(&mut self, finger: Finger, blocks: u64) -> Finger {
        if finger.is_reading() {
            (self.last, self.held) = (finger, 0);
            return finger;
        }
        self.held += blocks;
        let known = if self.held <= self.most { self.last } else { Finger::AWAY };
        let is_placed = |at: &[f64; 2]| at.iter().all(|x| x.is_finite());
        // The place may be good although speed or force is not.
        Finger { at_mm: finger.at_mm.filter(is_placed).or(self.last.at_mm), ..known }
    }

    /// Whether the last reading was good.
    pub(crate) fn is_good(&self) -> bool {
        self.held == 0
    }
}

/// Index of the surface under the finger: the one on the highest layer.
pub(crate) fn topmost(surfaces: &[Surface], finger: &Finger) -> Option<usize> {
    let under = |i: &usize| finger.is_in(surfaces[*i].region.as_ref());
    // Surfaces on one layer never overlap (`REGION_OVERLAP`), so there are no ties.
    (0..surfaces.len()).filter(under).max_by_key(|&i| surfaces[i].layer)
}

/// The motion of the finger over time.
#[derive(Debug, Clone)]
pub(crate) enum Course {
    Constant(Constant),
    Trace(Trace, [f64; 2]),
    Live,
}

impl Course {
    pub(crate) fn new(motion: &Motion, trace: Option<&Trace>) -> Self {
        match (motion, trace) {
            (Motion::Constant(constant), _) => Self::Constant(*constant),
            (Motion::Trace(_), Some(trace)) => Self::Trace(trace.clone(), first_way(trace)),
            _ => Self::Live,
        }
    }

    /// Returns the finger at `t_s` seconds; without contact if the motion is live. Does not
    /// allocate.
    pub(crate) fn at(&self, t_s: f64) -> Finger {
        match self {
            Self::Constant(constant) => Finger {
                speed_mm_s: constant.speed_mm_s,
                force_n: constant.force_n,
                at_mm: constant.from_mm.map(|[x, y]| {
                    let way = constant.speed_mm_s * t_s;
                    let (sin, cos) = libm::sincos(constant.direction_deg.to_radians());
                    [x + way * cos, y + way * sin]
                }),
            },
            Self::Trace(trace, way) => {
                let point = trace.at(t_s);
                let forward = point.vx_mm_s * way[0] + point.vy_mm_s * way[1] >= 0.0;
                Finger {
                    speed_mm_s: if forward { point.speed_mm_s } else { -point.speed_mm_s },
                    force_n: point.force_n,
                    at_mm: Some([point.x_mm, point.y_mm]),
                }
            }
            Self::Live => Finger::AWAY,
        }
    }

    /// Whether speed, force and direction are constant.
    pub(crate) fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }
}

/// Direction of the first stroke, at the first contact in motion.
fn first_way(trace: &Trace) -> [f64; 2] {
    let moving = trace.t_s.iter().map(|t| trace.at(*t));
    let mut sliding = moving.filter(|point| point.speed_mm_s >= MIN_SLIDING_MM_S);
    // Only the sign of its product with other velocities counts, so it is not normalised.
    sliding.next().map_or([1.0, 0.0], |point| [point.vx_mm_s, point.vy_mm_s])
}
