//! Recognises roles and units from the names of columns.

use htex_format::Quantity;

use crate::columns::map::Role;

/// The unit that a column's name states.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Unit {
    /// Factor to the role's base unit (the quantity's unit, N, mm/s, s, mm).
    Scale(f64),
    /// The name has no unit.
    Unsaid,
    /// Volts, whose factor depends on the sensor.
    Volts,
    Unknown(String),
}

const NAMES: [(Role, &[&str]); 8] = [
    (
        Role::Lateral,
        &[
            "lateral",
            "lateral_force",
            "force_lateral",
            "f_lateral",
            "fl",
            "f_l",
            "friction",
            "friction_force",
            "force_friction",
            "f_friction",
            "tangential",
            "tangential_force",
            "force_tangential",
            "ft",
            "f_t",
            "shear",
            "shear_force",
        ],
    ),
    (Role::LateralX, &["fx", "f_x", "force_x", "x_force", "lateral_x", "friction_x"]),
    (Role::LateralY, &["fy", "f_y", "force_y", "y_force", "lateral_y", "friction_y"]),
    (
        Role::Normal,
        &[
            "fz",
            "f_z",
            "force_z",
            "z_force",
            "fn",
            "f_n",
            "normal",
            "normal_force",
            "force_normal",
            "f_normal",
            "force",
            "load",
        ],
    ),
    (Role::Speed, &["speed", "velocity", "vel", "finger_speed", "sliding_speed", "scan_speed"]),
    (Role::Time, &["t", "time", "timestamp", "elapsed"]),
    (Role::X, &["x", "pos_x", "x_pos", "position_x", "x_position", "finger_x"]),
    (Role::Y, &["y", "pos_y", "y_pos", "position_y", "y_position", "finger_y"]),
];

/// Unit suffixes after an underscore. If a suffix ends with a shorter suffix, the longer one comes
/// first in this list, so that it is found first.
const SUFFIXES: [&str; 23] = [
    "mm_s2", "cm_s2", "m_s2", "mm/s2", "cm/s2", "m/s2", "mm_s", "cm_s", "um_s", "m_s", "mm/s",
    "cm/s", "m/s", "mn", "un", "kn", "n", "mv", "v", "ms", "us", "s", "mm",
];
/// Units of length, and standard gravity. They are separate because `_m` is also the end of other
/// units.
const SHORT: [&str; 5] = ["cm", "um", "nm", "m", "g"];
/// Standard gravity, m/s².
const GRAVITY_M_S2: f64 = 9.806_65;

/// Returns the role and the unit that a column's name stands for, if the recording is of
/// `quantity`.
pub(crate) fn recognise(name: &str, quantity: Quantity) -> Option<(Role, Unit)> {
    let name = normalise(name);
    let known = |name: &str| signal_role(name, quantity).or_else(|| known_role(name));
    if let Some(role) = known(&name) {
        return Some((role, Unit::Unsaid));
    }
    let (base, unit) = split_unit(&name)?;
    let role = known(base)?;
    Some((role, unit_of(role, unit, quantity)))
}

/// Returns the unit stated in the name of a column with this role.
pub(crate) fn unit_in(name: &str, role: Role, quantity: Quantity) -> Unit {
    match split_unit(&normalise(name)) {
        Some((_, unit)) => unit_of(role, unit, quantity),
        None => Unit::Unsaid,
    }
}

/// Returns the base unit of a role.
pub(crate) fn base_unit(role: Role, quantity: Quantity) -> &'static str {
    match role {
        Role::Signal | Role::SignalX | Role::SignalY | Role::SignalZ => quantity.unit(),
        Role::Lateral | Role::LateralX | Role::LateralY | Role::Normal => "N",
        Role::Speed => "mm/s",
        Role::Time => "s",
        Role::X | Role::Y => "mm",
    }
}

fn normalise(name: &str) -> String {
    name.trim()
        .to_ascii_lowercase()
        // Two characters look alike: the micro sign and the Greek letter.
        .replace(['µ', 'μ'], "u")
        .replace([' ', '-'], "_")
        .replace('²', "2")
        .replace('^', "")
}

/// Returns the axis of a motion's quantity that a name stands for, such as `accel`, `ax`,
/// `velocity_y` or `z_disp`.
fn signal_role(name: &str, quantity: Quantity) -> Option<Role> {
    let bases: &[&str] = match quantity {
        Quantity::LateralForce | Quantity::NormalForce => return None,
        Quantity::Acceleration => &["acceleration", "accel", "acc", "a"],
        Quantity::Velocity => &["velocity", "vel", "v"],
        Quantity::Displacement => &["displacement", "disp", "deflection", "d"],
    };
    bases.iter().find_map(|base| {
        let before = name.strip_suffix(base).filter(|axis| axis.ends_with('_'));
        let axis = name.strip_prefix(base).or(before)?;
        match axis.trim_matches('_') {
            "" => Some(Role::Signal),
            "x" => Some(Role::SignalX),
            "y" => Some(Role::SignalY),
            "z" => Some(Role::SignalZ),
            _ => None,
        }
    })
}

fn known_role(name: &str) -> Option<Role> {
    NAMES.iter().find(|(_, names)| names.contains(&name)).map(|(role, _)| *role)
}

/// Splits `fx_[n]`, `fx(n)` and `fx_n` into `fx` and `n`.
fn split_unit(name: &str) -> Option<(&str, &str)> {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((base, unit)) = name.strip_suffix(close).and_then(|name| name.rsplit_once(open))
        {
            return Some((base.trim_end_matches('_'), unit.trim_matches('_')));
        }
    }
    SUFFIXES.iter().chain(&SHORT).find_map(|unit| {
        let base = name.strip_suffix(unit)?.strip_suffix('_')?;
        Some((base, *unit))
    })
}

/// Returns the unit with this symbol (in lower case) for a role.
pub(crate) fn unit_of(role: Role, unit: &str, quantity: Quantity) -> Unit {
    let scale = match (base_unit(role, quantity), unit) {
        ("N", "n" | "newton" | "newtons") => 1.0,
        ("N", "mn") => 1e-3,
        ("N", "un") => 1e-6,
        ("N", "kn") => 1e3,
        ("mm/s", "mm_s" | "mm/s" | "mm/sec") => 1.0,
        ("mm/s", "cm_s" | "cm/s") => 10.0,
        ("mm/s", "m_s" | "m/s") => 1e3,
        ("m/s2", "m_s2" | "m/s2" | "m/s/s") => 1.0,
        ("m/s2", "cm_s2" | "cm/s2") => 1e-2,
        ("m/s2", "mm_s2" | "mm/s2") => 1e-3,
        ("m/s2", "g" | "g0" | "gn") => GRAVITY_M_S2,
        ("m/s", "m_s" | "m/s") => 1.0,
        ("m/s", "cm_s" | "cm/s") => 1e-2,
        ("m/s", "mm_s" | "mm/s") => 1e-3,
        ("m/s", "um_s" | "um/s") => 1e-6,
        ("m", "m") => 1.0,
        ("m", "cm") => 1e-2,
        ("m", "mm") => 1e-3,
        ("m", "um") => 1e-6,
        ("m", "nm") => 1e-9,
        ("s", "s" | "sec" | "seconds") => 1.0,
        ("s", "ms") => 1e-3,
        ("s", "us") => 1e-6,
        ("mm", "mm") => 1.0,
        ("mm", "cm") => 10.0,
        ("mm", "m") => 1e3,
        ("mm", "um") => 1e-3,
        (_, "v" | "mv" | "volt" | "volts") => return Unit::Volts,
        (_, unit) => return Unit::Unknown(unit.to_owned()),
    };
    Unit::Scale(scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_give_role_and_unit() {
        let cases = [
            ("t_s", Role::Time, Unit::Scale(1.0)),
            ("t_ms", Role::Time, Unit::Scale(1e-3)),
            ("Fx [mN]", Role::LateralX, Unit::Scale(1e-3)),
            ("fy_n", Role::LateralY, Unit::Scale(1.0)),
            ("F_n", Role::Normal, Unit::Unsaid),
            ("Fn_N", Role::Normal, Unit::Scale(1.0)),
            ("Lateral Force (N)", Role::Lateral, Unit::Scale(1.0)),
            ("lateral_V", Role::Lateral, Unit::Volts),
            ("normal [counts]", Role::Normal, Unit::Unknown("counts".into())),
            ("speed_mm_s", Role::Speed, Unit::Scale(1.0)),
            ("Velocity (m/s)", Role::Speed, Unit::Scale(1e3)),
            ("speed_cm_s", Role::Speed, Unit::Scale(10.0)),
            ("x_mm", Role::X, Unit::Scale(1.0)),
            ("y_m", Role::Y, Unit::Scale(1e3)),
        ];
        for (name, role, unit) in cases {
            let found = recognise(name, Quantity::LateralForce);
            assert_eq!(found, Some((role, unit)), "{name}");
        }
        for name in ["accel", "temperature_C", "", "n", "torque_n"] {
            assert_eq!(recognise(name, Quantity::LateralForce), None, "{name}");
        }
        let motions = [
            ("ax [m/s²]", Quantity::Acceleration, Role::SignalX, Unit::Scale(1.0)),
            ("acc_z_g", Quantity::Acceleration, Role::SignalZ, Unit::Scale(GRAVITY_M_S2)),
            ("Y accel (mm/s^2)", Quantity::Acceleration, Role::SignalY, Unit::Scale(1e-3)),
            ("accel", Quantity::Acceleration, Role::Signal, Unit::Unsaid),
            ("a_v", Quantity::Acceleration, Role::Signal, Unit::Volts),
            ("velocity_mm_s", Quantity::Velocity, Role::Signal, Unit::Scale(1e-3)),
            ("speed_mm_s", Quantity::Velocity, Role::Speed, Unit::Scale(1.0)),
            ("disp_um", Quantity::Displacement, Role::Signal, Unit::Scale(1e-6)),
            ("x_mm", Quantity::Displacement, Role::X, Unit::Scale(1.0)),
            ("fz_n", Quantity::Acceleration, Role::Normal, Unit::Scale(1.0)),
        ];
        for (name, quantity, role, unit) in motions {
            assert_eq!(recognise(name, quantity), Some((role, unit)), "{name}");
        }
    }
}
