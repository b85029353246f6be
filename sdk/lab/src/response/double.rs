//! Finds repeated contacts of a hammer within one window.

/// Returns the samples at which contacts begin. A contact is a rise by at least `rise` above the
/// lowest value since the last contact faded by as much, and to at least `rise` above rest. `pulse`
/// is measured from the level at rest, with the hit in the positive direction.
pub(crate) fn contacts(pulse: impl Iterator<Item = f64>, rise: f64) -> Vec<usize> {
    let mut found = Vec::new();
    let (mut lowest, mut highest, mut is_in_contact) = (0.0_f64, 0.0_f64, false);
    for (at, value) in pulse.enumerate() {
        if is_in_contact {
            highest = highest.max(value);
            if value <= highest - rise {
                (is_in_contact, lowest) = (false, value);
            }
        } else {
            lowest = lowest.min(value);
            if value >= (lowest + rise).max(rise) {
                (is_in_contact, highest) = (true, value);
                found.push(at);
            }
        }
    }
    found
}
