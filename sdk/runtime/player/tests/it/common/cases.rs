//! The blocks of `spec/baked-conformance`, the calls to make with them, and the samples that a
//! player renders or the reason why it refuses a block.

use htex_player::{Block, OpenError, Player};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::blocks::{Plan, noise, tones, with_checksum};

/// The folder that contains the files.
pub const FOLDER: &str = "spec/baked-conformance";
pub const SEED: u32 = 7;
/// Number of samples that the files list.
const LISTED: usize = 16;

/// One call of a player.
#[derive(Clone, Copy)]
pub enum Step {
    SetMotion(f32, f32),
    Render(usize),
}

use Step::{Render, SetMotion};

/// The files of all cases: their paths from the workspace's folder, and their bytes.
pub fn files() -> Vec<(String, Vec<u8>)> {
    let valid = all_sound().into_iter().map(|(name, bytes, steps)| {
        let case = played(name, &bytes, &steps);
        (name, bytes, case)
    });
    let refused = hostile().into_iter().map(|(name, bytes)| {
        let case = json!({"block": format!("{name}.bin"), "valid": false, "rule": rule(&bytes)});
        (name, bytes, case)
    });
    let both = |(name, bytes, case): (&str, Vec<u8>, Value)| {
        let text = format!("{:#}\n", case).into_bytes();
        [("bin", bytes), ("json", text)].map(|(end, of)| (format!("{FOLDER}/{name}.{end}"), of))
    };
    valid.chain(refused).flat_map(both).collect()
}

/// Returns all blocks, including the invalid blocks, and the calls to make with each block.
pub fn blocks_and_steps() -> Vec<(Vec<u8>, Vec<Step>)> {
    let played = all_sound().into_iter().map(|(_, bytes, steps)| (bytes, steps));
    let refused = hostile().into_iter().map(|(_, bytes)| (bytes, Vec::new()));
    played.chain(refused).collect()
}

/// Returns the rule that a block violates, as the specification names it.
fn rule(bytes: &[u8]) -> Option<&'static str> {
    Some(match Block::open(bytes).err()? {
        OpenError::TooShort => "too_short",
        OpenError::NotABlock => "not_a_block",
        OpenError::Version => "version",
        OpenError::Length => "length",
        OpenError::Checksum => "checksum",
        OpenError::Header => "header",
        OpenError::Axes => "axes",
        _ => "values",
    })
}

/// Returns calls with motions on the grid, between its points, beyond it and at rest, with
/// implausible readings and numbers that are not finite, and with new motions during a glide.
fn steps(rate_hz: f32) -> Vec<Step> {
    let held = (0.1 * rate_hz) as usize;
    vec![
        SetMotion(80.0, 0.4),
        Render(64),
        SetMotion(55.5, 0.25),
        Render(1),
        Render(333),
        SetMotion(f32::NAN, 0.4),
        SetMotion(70.0, f32::INFINITY),
        Render(30),
        SetMotion(0.0, 0.0),
        Render(200),
        SetMotion(101.25, 0.5),
        Render(100),
        SetMotion(101.25, 0.5),
        Render(7),
        SetMotion(1e6, 0.5),
        Render(held / 2),
        SetMotion(80.0, 100.0),
        Render(held / 2 + 200),
        SetMotion(-60.0, 0.3),
        Render(250),
        SetMotion(999.0, 19.5),
        Render(200),
        SetMotion(1.25, 0.001),
        Render(200),
        SetMotion(240.0, 0.05),
        Render(3),
        SetMotion(70.0, 2.0),
        Render(200),
        SetMotion(0.25, 2.0),
        Render(11),
        SetMotion(64.0, 0.35),
        Render(200),
    ]
}

/// Returns the samples of two players with the same seed. One renders floating-point numbers, the
/// other integers.
fn played(name: &str, bytes: &[u8], steps: &[Step]) -> Value {
    let block = Block::open(bytes).unwrap();
    let full_scale = block.full_scale();
    let mut players = [Player::new(block, SEED), Player::new(block, SEED)];
    let (mut samples, mut integers) = (Vec::new(), Vec::new());
    for step in steps {
        match *step {
            SetMotion(speed, force) => players.iter_mut().for_each(|player| {
                player.set_motion(speed, force);
            }),
            Render(count) => {
                let from = samples.len();
                samples.resize(from + count, 0.0f32);
                integers.resize(from + count, 0i16);
                players[0].render(&mut samples[from..]);
                players[1].render_i16(&mut integers[from..], full_scale);
            }
        }
    }
    let sha256 = |bytes: Vec<u8>| hex(&Sha256::digest(bytes));
    let first: Vec<String> = samples.iter().take(LISTED).map(|x| bits(*x)).collect();
    json!({
        "block": format!("{name}.bin"),
        "valid": true,
        "quantity": block.quantity().name(),
        "unit": block.quantity().unit(),
        "seed": SEED,
        "steps": steps.iter().map(described).collect::<Vec<_>>(),
        "samples": {
            "count": samples.len(),
            "first_bits": first,
            "sha256": sha256(samples.iter().flat_map(|x| x.to_le_bytes()).collect()),
        },
        "integers": {
            "full_scale": full_scale,
            "full_scale_bits": bits(full_scale),
            "count": integers.len(),
            "first": integers.iter().take(LISTED).collect::<Vec<_>>(),
            "sha256": sha256(integers.iter().flat_map(|x| x.to_le_bytes()).collect()),
        },
    })
}

fn described(step: &Step) -> Value {
    match *step {
        SetMotion(speed, force) => json!({"set_motion": {
            "speed_mm_s": readable(speed), "force_n": readable(force),
            "speed_bits": bits(speed), "force_bits": bits(force),
        }}),
        Render(count) => json!({"render": count}),
    }
}

/// A number, or its name if it is not finite.
fn readable(x: f32) -> Value {
    if x.is_finite() { json!(x) } else { json!(x.to_string()) }
}

fn bits(x: f32) -> String {
    format!("{:08x}", x.to_bits())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Different numbers from -1 to 1, without a pattern.
fn scattered(count: usize) -> impl Iterator<Item = f32> {
    let spread = |i: usize| (i as u32).wrapping_mul(2_654_435_761) as i32;
    (1..=count).map(move |i| spread(i) as f32 / 2_147_483_648.0)
}

/// An interpolator whose coefficients add up to 1 in each phase.
fn rows(up: usize, row: usize) -> Vec<f32> {
    let at = move |phase: usize, i: usize| {
        let t = i as f32 - (row / 2) as f32 + 1.0 - phase as f32 / up as f32;
        (1.0 - t.abs() / (row / 2) as f32).max(0.0)
    };
    let phase = |p: usize| {
        let sum: f32 = (0..row).map(|i| at(p, i)).sum();
        (0..row).map(move |i| at(p, i) / sum)
    };
    (0..up).flat_map(phase).collect()
}

/// Noise with three filters at three speeds and two forces.
fn noise_grid() -> Plan {
    let (filters, conditions, size) = (3, 6, 16);
    let decays = (0..filters).flat_map(|k| {
        let side = scattered(size + 1).zip(0..).map(move |(x, i)| {
            let envelope = 1.0 / (1.0 + 0.2 * (i * (k + 1)) as f32);
            (30_000.0 * envelope * if i == 0 { 1.0 } else { x }) as i16
        });
        side.collect::<Vec<_>>()
    });
    let weights = scattered(filters * conditions).zip(0..).map(|(x, i)| match i % 3 {
        0 => 32_767,
        _ => (20_000.0 * x) as i16,
    });
    Plan {
        up: 3,
        row: 8,
        size: size as u16,
        glide: 53,
        filters: filters as u8,
        speeds: vec![40.0, 80.0, 160.0],
        forces: vec![0.2, 0.6],
        rows: rows(3, 8),
        levels: vec![0.05, 0.07, 0.11, 0.12, 0.17, 0.31],
        numbers: vec![4.1e-10, 2.7e-10, 1.3e-10],
        integers: weights.chain(decays).collect(),
        law: [1.0, 0.43, 0.9],
        ceiling: 1.25,
        full_scale: 1.6,
        ..noise()
    }
}

fn noise_one_condition() -> Plan {
    Plan {
        rate_hz: 2000.0,
        up: 1,
        row: 0,
        size: 4,
        glide: 40,
        filters: 1,
        quantity: 3,
        rows: vec![],
        speeds: vec![80.0],
        forces: vec![0.4],
        levels: vec![2.5],
        numbers: vec![4.6e-10],
        integers: vec![32_767, 31_000, -12_000, 4_001, -77, 9],
        law: [0.0, 2.0, 1.0],
        ceiling: 10.0,
        full_scale: 12.5,
        highest: 0.5,
        ..noise()
    }
}

/// Noise whose mix is silent at the higher speed.
fn noise_without_energy() -> Plan {
    let mut plan = noise();
    plan.integers[2] = 0;
    plan.integers[3] = 0;
    plan
}

fn noise_rate(rate_hz: f32, up: u16, row: u16, glide: u16) -> Plan {
    let rows = match up {
        1 => vec![],
        _ => rows(up.into(), row.into()),
    };
    Plan { rate_hz, up, row, glide, quantity: 4, rows, ..noise_grid() }
}

fn tones_fixed() -> Plan {
    let numbers = scattered(24).zip(0..).map(|(x, i)| match i % 2 {
        0 => 0.01 + 0.2 * x.abs(),
        _ => x,
    });
    Plan {
        size: 3,
        rate_hz: 2667.0,
        quantity: 2,
        speeds: vec![40.0, 120.0],
        forces: vec![0.2, 0.6],
        levels: vec![0.5, 0.75, 1.0, 2.0],
        numbers: numbers.collect(),
        ..tones()
    }
}

fn tones_random() -> Plan {
    Plan {
        flags: 1,
        rate_hz: 12_000.0,
        up: 4,
        row: 12,
        rows: rows(4, 12),
        glide: 60,
        quantity: 5,
        levels: vec![2e-5, 3e-5, 4e-5, 5e-5],
        ceiling: 2e-4,
        full_scale: 3e-4,
        law: [0.75, -0.5, -0.25],
        ..tones_fixed()
    }
}

/// Sinusoids that the law would raise above the highest frequency. It would also raise their level
/// above the ceiling.
fn tones_law() -> Plan {
    Plan { law: [4.0, -4.0, 4.0], ceiling: 3.0, highest: 0.4, ..tones_fixed() }
}

/// A level in the grid that is above the ceiling.
fn tones_low_ceiling() -> Plan {
    Plan { law: [-2.0, 1.5, 0.0], ceiling: 0.6, ..tones_fixed() }
}

fn sound() -> Vec<(&'static str, Plan)> {
    vec![
        ("noise_grid", noise_grid()),
        ("noise_one_condition", noise_one_condition()),
        ("noise_without_energy", noise_without_energy()),
        ("noise_100_hz", noise_rate(100.0, 1, 0, 2)),
        ("noise_44100_hz", noise_rate(44_100.0, 17, 12, 52)),
        ("noise_fluctuating", Plan { flags: 2, ..noise_grid() }),
        (
            "noise_fluctuating_slowly",
            Plan { flags: 2, fluctuation: (300, [255, 0], 1.5), ..noise_one_condition() },
        ),
        (
            "tones_fluctuating",
            Plan { flags: 3, fluctuation: (1, [0, 255], -1.0), ..tones_random() },
        ),
        ("tones_fixed_phases", tones_fixed()),
        ("tones_random_phases", tones_random()),
        ("tones_law", tones_law()),
        ("tones_low_ceiling", tones_low_ceiling()),
    ]
}

/// A block that a player accepts, with its name and the calls to make with it.
type Sound = (&'static str, Vec<u8>, Vec<Step>);

fn all_sound() -> Vec<Sound> {
    let with_steps = |(name, plan): (&'static str, Plan)| (name, plan.bytes(), steps(plan.rate_hz));
    sound().into_iter().map(with_steps).chain(edges()).collect()
}

/// Each motion, and samples after it.
fn motions(all: &[[f32; 2]]) -> Vec<Step> {
    all.iter().flat_map(|[speed, force]| [SetMotion(*speed, *force), Render(24)]).collect()
}

/// Blocks and motions at the edges of rules. Each of them tells apart players that
/// `tests/peers/mutants` lists.
fn edges() -> Vec<Sound> {
    let one = |plan: Plan| Plan {
        glide: 8,
        up: 1,
        row: 0,
        rows: vec![],
        speeds: vec![80.0],
        forces: vec![0.4],
        levels: vec![1.0],
        ..plan
    };
    let tone = |numbers: &[f32]| Plan {
        size: numbers.len() as u16 / 2,
        numbers: numbers.to_vec(),
        ..one(tones())
    };
    let mut longer = noise_one_condition().bytes();
    longer.extend(b"more");
    // The least energy that is heard is above 0x3089705F, which the second has exactly: the first
    // is below it, the third above it.
    let quiet = |a: f32, b: f32| [0.05, a, 0.1, b];
    let [a, b] = [0x382e_c69a, 0x3788_33e5].map(f32::from_bits);
    let quiet = [quiet(1e-5, 0.0), quiet(a, b), quiet(1e-4, 0.0)].concat();
    vec![
        ("noise_with_bytes_after", longer, motions(&[[80.0, 0.4], [160.0, 0.8]])),
        // The last motions at which a finger is felt, and the first at which it is not. A motion
        // sounds again after silence.
        (
            "tones_contact",
            tone(&[0.05, 1.0, 0.1, 0.5]).bytes(),
            motions(&[
                [80.0, 0.5],
                [80.0, 0.0],
                [80.0, 0.5],
                [0.499_999_97, 0.5],
                [0.5, 0.5],
                [80.0, -0.0],
                [1000.0, 0.5],
                [1000.0001, 0.4],
                [80.0, 20.0],
                [90.0, 20.000_002],
                [70.0, 1e-30],
            ]),
        ),
        // A finger that is still before the first sample.
        (
            "tones_silent_at_first",
            tone(&[0.05, 1.0, 0.1, 0.5]).bytes(),
            motions(&[[0.0, 0.4], [80.0, 0.4]]),
        ),
        // A level that falls, but not as far as the ceiling.
        (
            "tones_above_ceiling",
            Plan { law: [0.0, 1.0, 0.0], ceiling: 0.1, ..tone(&[0.05, 1.0]) }.bytes(),
            motions(&[[40.0, 0.4], [80.0, 0.4]]),
        ),
        // Ratios of forces, and a force that is below 1e-6 and the nearest f32 to it.
        (
            "tones_least_force",
            Plan { forces: vec![1e-6], law: [0.0, 0.5, -0.25], ..tone(&[0.05, 1.0]) }.bytes(),
            motions(&[[80.0, 1e-3], [80.0, 20.0], [80.0, 1.1], [80.0, 0.9]]),
        ),
        (
            "tones_small_forces",
            Plan { law: [0.0, 0.0, 0.75], ..tone(&[0.05, 1.0]) }.bytes(),
            motions(&[[80.0, 1e-5], [80.0, 3e-7], [80.0, 1e-7], [80.0, 1e-9]]),
        ),
        // The logarithm at the number from which its argument is halved, and halves of the power.
        (
            "tones_logarithm",
            Plan { law: [1.0, 2.0, 0.5], ceiling: 64.0, ..tone(&[0.01, 1.0]) }.bytes(),
            motions(&[
                [f32::from_bits(0x42e2_4630), 0.4],
                [f32::from_bits(0x42e2_462e), 0.4],
                [f32::from_bits(0x42e2_462d), 0.4],
                [80.0, 0.2],
                [80.0, 0.05],
                [80.0, 0.8],
            ]),
        ),
        // Frequencies that are raised by more than 8, and by as much as P allows.
        (
            "tones_raised",
            Plan { law: [4.0, 0.0, 0.0], ..tone(&[0.001, 1.0, 0.45, 0.0]) }.bytes(),
            motions(&[[160.0, 0.4], [640.0, 0.4], [60.0, 0.4]]),
        ),
        (
            "tones_above_highest",
            Plan { law: [1.0, 0.0, 0.0], highest: 0.1, ..tone(&[0.2, 1.0, 0.4, 0.5]) }.bytes(),
            motions(&[[80.0, 0.4], [160.0, 0.4], [40.0, 0.4]]),
        ),
        (
            "tones_quiet",
            Plan {
                speeds: vec![40.0, 80.0, 160.0],
                levels: vec![1.0; 3],
                numbers: quiet,
                ..tone(&[0.0; 4])
            }
            .bytes(),
            motions(&[[80.0, 0.4], [160.0, 0.4], [40.0, 0.4]]),
        ),
    ]
}

/// Blocks that a player refuses.
fn hostile() -> Vec<(&'static str, Vec<u8>)> {
    let noise_with = |change: fn(&mut Plan)| {
        let mut plan = noise();
        change(&mut plan);
        plan.bytes()
    };
    let tones_with = |change: fn(&mut Plan)| {
        let mut plan = tones();
        change(&mut plan);
        plan.bytes()
    };
    let changed = |change: fn(&mut Vec<u8>)| {
        let mut bytes = noise().bytes();
        change(&mut bytes);
        bytes
    };
    let padded = || {
        let mut odd = noise();
        (odd.filters, odd.numbers, odd.integers) = (1, vec![1e-9], vec![1; 11]);
        let mut bytes = odd.content();
        let last = bytes.len() - 1;
        bytes[last] = 1;
        with_checksum(bytes)
    };
    vec![
        ("refused_too_short", noise().bytes()[..55].to_vec()),
        ("refused_magic", changed(|b| b[0] = b'h')),
        ("refused_version", changed(|b| b[4] = 2)),
        ("refused_truncated", changed(|b| b.truncate(b.len() - 4))),
        ("refused_length_of_header", changed(|b| b[8] = 40)),
        ("refused_changed_byte", changed(|b| b[60] ^= 1)),
        ("refused_missing_integers", noise_with(|p| p.integers.truncate(19))),
        ("refused_too_many_levels", noise_with(|p| p.levels.push(0.0))),
        ("refused_kind", noise_with(|p| p.kind = 3)),
        ("refused_flags", noise_with(|p| p.flags = 1)),
        ("refused_rate", noise_with(|p| p.rate_hz = f32::NAN)),
        ("refused_up", noise_with(|p| p.up = 65)),
        ("refused_row", noise_with(|p| p.row = 6)),
        ("refused_row_without_up", tones_with(|p| p.row = 4)),
        ("refused_half", noise_with(|p| p.size = 10)),
        ("refused_glide", noise_with(|p| p.glide = 0)),
        ("refused_no_force", noise_with(|p| p.forces.clear())),
        ("refused_no_filter", noise_with(|p| p.filters = 0)),
        ("refused_tones_with_filter", tones_with(|p| p.filters = 1)),
        ("refused_quantity", noise_with(|p| p.quantity = 6)),
        ("refused_exponent", noise_with(|p| p.law[2] = -4.5)),
        ("refused_ceiling", noise_with(|p| p.ceiling = f32::INFINITY)),
        ("refused_full_scale", noise_with(|p| p.full_scale = 0.0)),
        ("refused_highest", noise_with(|p| p.highest = 0.6)),
        ("refused_equal_speeds", noise_with(|p| p.speeds = vec![80.0, 80.0])),
        ("refused_speed", noise_with(|p| p.speeds[1] = 1001.0)),
        ("refused_force", noise_with(|p| p.forces[0] = 0.0)),
        ("refused_level", noise_with(|p| p.levels[0] = -1.0)),
        ("refused_scale", noise_with(|p| p.numbers[0] = 1e-7)),
        ("refused_interpolator", noise_with(|p| p.rows[0] = f32::NAN)),
        ("refused_frequency", tones_with(|p| p.numbers[0] = 0.6)),
        ("refused_amplitude", tones_with(|p| p.numbers[1] = 65.0)),
        ("refused_padding", padded()),
        ("refused_rate_below", noise_with(|p| p.rate_hz = 99.0)),
        ("refused_rate_above", noise_with(|p| p.rate_hz = 1.5e6)),
        ("refused_row_above", noise_with(|p| p.row = 68)),
        ("refused_no_row", noise_with(|p| p.row = 0)),
        ("refused_size_above", noise_with(|p| p.size = 324)),
        ("refused_tones_above", tones_with(|p| p.size = 65)),
        ("refused_no_tones", tones_with(|p| p.size = 0)),
        ("refused_glide_above", noise_with(|p| p.glide = 4097)),
        ("refused_speeds_above", noise_with(|p| p.speeds = vec![1.0; 33])),
        ("refused_forces_above", noise_with(|p| p.forces = vec![1.0; 33])),
        ("refused_filters_above", noise_with(|p| p.filters = 65)),
        ("refused_quantity_below", noise_with(|p| p.quantity = 0)),
        ("refused_exponent_above", noise_with(|p| p.law[0] = 4.5)),
        ("refused_ceiling_below", noise_with(|p| p.ceiling = -1.0)),
        ("refused_ceiling_above", noise_with(|p| p.ceiling = 1e11)),
        ("refused_full_scale_above", noise_with(|p| p.full_scale = 1e11)),
        ("refused_highest_below", noise_with(|p| p.highest = -0.5)),
        ("refused_speed_below", noise_with(|p| p.speeds[0] = 0.25)),
        ("refused_force_above", noise_with(|p| p.forces[0] = 20.5)),
        ("refused_interpolator_above", noise_with(|p| p.rows[0] = 65.0)),
        ("refused_level_above", noise_with(|p| p.levels[0] = 2e9)),
        ("refused_scale_below", noise_with(|p| p.numbers[0] = -1e-10)),
        ("refused_frequency_below", tones_with(|p| p.numbers[0] = -0.1)),
        ("refused_amplitude_below", tones_with(|p| p.numbers[1] = -65.0)),
        (
            "refused_fluctuation_offset_below",
            noise_with(|p| (p.flags, p.fluctuation.2) = (2, -16.5)),
        ),
        // The first rule that is broken counts.
        (
            "refused_speeds_and_level",
            noise_with(|p| (p.speeds, p.levels[0]) = (vec![80.0, 80.0], -1.0)),
        ),
        ("refused_fluctuation_flag", noise_with(|p| p.flags = 4)),
        ("refused_fluctuation_period", noise_with(|p| (p.flags, p.fluctuation.0) = (2, 0))),
        ("refused_fluctuation_offset", noise_with(|p| (p.flags, p.fluctuation.2) = (2, 16.5))),
        (
            "refused_fluctuation_missing",
            changed(|b| {
                b[7] = 2;
                b.truncate(b.len() - 4);
                *b = with_checksum(std::mem::take(b));
            }),
        ),
    ]
}
