//! The position and motion of the finger over the course of a scene.

use htex_play::Motion;
use htex_play::exploration::{HOLD_S, MIN_SLIDING_MM_S};

use crate::file::{self, Constant, Region, Surface};
use crate::trace::Trace;

/// Returns whether the finger is inside a region. A region that is `None` covers everything.
fn is_in(motion: &Motion, region: Option<&Region>) -> bool {
    match (region, motion.place_mm) {
        (None, _) => true,
        (Some(region), Some([x, y])) => {
            let within = |range: [f64; 2], at: f64| (range[0]..range[1]).contains(&at);
            within(region.x_mm, x) && within(region.y_mm, y)
        }
        (Some(_), None) => false,
    }
}

/// Filters the readings of a finger. Replaces impossible readings by the last valid motion, for at
/// most [`HOLD_S`]. Every motion of a scene passes through this filter, so that a single invalid
/// reading is not felt.
#[derive(Debug)]
pub(crate) struct Readings {
    last: Motion,
    /// Maximum number of control blocks for which a motion is held.
    most: u64,
    held: u64,
}

impl Readings {
    /// Makes a filter for one reading in each control block. `control_s` is the duration of a
    /// control block, seconds.
    pub(crate) fn new(control_s: f64) -> Self {
        Self { last: Motion::AWAY, most: (HOLD_S / control_s) as u64, held: 0 }
    }

    /// Takes a reading that lasts for a number of control blocks. Returns this reading if it is
    /// valid, otherwise the last valid motion, or no contact if that motion has been held too long.
    pub(crate) fn filter(&mut self, finger: Motion, blocks: u64) -> Motion {
        if finger.is_reading() {
            (self.last, self.held) = (finger, 0);
            return finger;
        }
        self.held += blocks;
        let known = if self.held <= self.most { self.last } else { Motion::AWAY };
        let is_placed = |at: &[f64; 2]| at.iter().all(|x| x.is_finite());
        // The place may be valid although the speed or the force is not.
        known.with_place_mm(finger.place_mm.filter(is_placed).or(self.last.place_mm))
    }

    /// Whether the last reading was valid.
    pub(crate) fn is_good(&self) -> bool {
        self.held == 0
    }
}

/// Returns the index of the surface that the finger touches: of the surfaces under it, the one on
/// the highest layer.
pub(crate) fn topmost(surfaces: &[Surface], finger: &Motion) -> Option<usize> {
    let under = |i: &usize| is_in(finger, surfaces[*i].region.as_ref());
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
    pub(crate) fn new(motion: &file::Motion, trace: Option<&Trace>) -> Self {
        match (motion, trace) {
            (file::Motion::Constant(constant), _) => Self::Constant(*constant),
            (file::Motion::Trace(_), Some(trace)) => Self::Trace(trace.clone(), first_way(trace)),
            _ => Self::Live,
        }
    }

    /// Returns the motion of the finger at `t_s` seconds. If the motion is live, returns a finger
    /// without contact. Does not allocate.
    pub(crate) fn motion(&self, t_s: f64) -> Motion {
        match self {
            Self::Constant(constant) => {
                let place = constant.from_mm.map(|[x, y]| {
                    let way = constant.speed_mm_s * t_s;
                    let (sin, cos) = libm::sincos(constant.direction_deg.to_radians());
                    [x + way * cos, y + way * sin]
                });
                Motion::new(constant.speed_mm_s, constant.force_n).with_place_mm(place)
            }
            Self::Trace(trace, way) => {
                let point = trace.point_at(t_s);
                let forward = point.vx_mm_s * way[0] + point.vy_mm_s * way[1] >= 0.0;
                let speed_mm_s = if forward { point.speed_mm_s } else { -point.speed_mm_s };
                Motion::new(speed_mm_s, point.force_n).with_place_mm([point.x_mm, point.y_mm])
            }
            Self::Live => Motion::AWAY,
        }
    }

    /// Whether speed, force and direction are constant.
    pub(crate) fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }
}

/// Returns the direction of the first stroke, taken where the finger first slides.
fn first_way(trace: &Trace) -> [f64; 2] {
    let moving = trace.t_s.iter().map(|t| trace.point_at(*t));
    let mut sliding = moving.filter(|point| point.speed_mm_s >= MIN_SLIDING_MM_S);
    // Only the sign of the product of this direction and another velocity matters, so the direction
    // is not normalised.
    sliding.next().map_or([1.0, 0.0], |point| [point.vx_mm_s, point.vy_mm_s])
}
