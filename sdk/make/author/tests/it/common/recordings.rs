//! The conformance recordings: one valid recording, and one or more for each finding code.

use std::fmt::Write;
use std::path::Path;

use htex_author::recording::ReadOptions;
use htex_author::simulate::{Simulation, SimulationOptions, Surface, simulate};
use htex_author::{Exploration, SpectrumOptions, validate_recording};
use serde_json::json;

const RATE_HZ: f64 = 500.0;

/// A conformance recording.
pub struct Case {
    pub name: &'static str,
    pub text: String,
    /// Scanning speed requested by the user, mm/s.
    pub speed_mm_s: Option<f64>,
}

impl Case {
    pub fn file(&self) -> String {
        format!("{}.csv", self.name)
    }

    /// The code after which the case is named. If a code has several cases, their names have
    /// another word after the code.
    pub fn code(&self) -> String {
        self.name.trim_end_matches("_many").to_uppercase()
    }

    pub fn report(&self) -> String {
        format!("{}.report.json", self.name)
    }

    /// Whether a finding with this code may also occur in the case. A knock is sharp, and a gap or
    /// the end of a stuck stretch is a step in the signal.
    pub fn may_also_raise(&self, code: &str) -> bool {
        let also: &[&str] = match self.name {
            "recording_clock_gap" | "recording_stuck" | "recording_silent" => &["RECORDING_SPIKE"],
            "recording_uneven" => &["RECORDING_SPIKE"],
            "recording_force_outlier" | "recording_speed_zero" => &["RECORDING_UNSTEADY"],
            "recording_friction_coefficient" => &["RECORDING_UNSTEADY"],
            _ => &[],
        };
        also.contains(&code)
    }

    /// The expected report of the recording in `folder`, as pretty JSON.
    pub fn golden(&self, folder: &Path) -> String {
        let given = Exploration { speed_mm_s: self.speed_mm_s, force_n: None };
        let (read, options) = (ReadOptions::default(), SpectrumOptions::default());
        let report = validate_recording(&folder.join(self.file()), &read, given, &options).unwrap();
        let arguments: Vec<String> = self
            .speed_mm_s
            .iter()
            .flat_map(|speed| ["--speed".to_owned(), speed.to_string()])
            .collect();
        let golden = json!({
            "file": self.file(),
            "arguments": arguments,
            "valid": report.valid,
            "findings": report.findings,
        });
        serde_json::to_string_pretty(&golden).unwrap() + "\n"
    }
}

/// Columns of a simulated recording; each case changes some of them.
struct Columns {
    /// Decimals of the time.
    decimals: usize,
    t_s: Vec<f64>,
    lateral_n: Vec<f64>,
    normal_n: Vec<f64>,
    speed_mm_s: Vec<f64>,
}

impl Columns {
    fn new(seconds: f64) -> Self {
        let options =
            SimulationOptions::new(Surface::Vinyl).with_rate_hz(RATE_HZ).with_duration_s(seconds);
        let simulation: Simulation = simulate(&options).unwrap();
        let speed_mm_s = simulation.to_recording("").unwrap().speed_mm_s.unwrap();
        Self {
            decimals: 3,
            t_s: simulation.t_s,
            lateral_n: simulation.fy_n,
            normal_n: simulation.fz_n,
            speed_mm_s,
        }
    }

    /// Only the time and the lateral force.
    fn lateral(self) -> String {
        self.text("t_s,lateral_n", |c, at| format!("{:.5}", c.lateral_n[at]))
    }

    fn with_normal(self) -> String {
        self.text("t_s,lateral_n,fz_n", |c, at| {
            format!("{:.5},{:.4}", c.lateral_n[at], c.normal_n[at])
        })
    }

    fn with_speed(self) -> String {
        self.text("t_s,lateral_n,speed_mm_s", |c, at| {
            format!("{:.5},{:.3}", c.lateral_n[at], c.speed_mm_s[at])
        })
    }

    fn text(&self, header: &str, row: impl Fn(&Self, usize) -> String) -> String {
        let mut text = format!("# simulated\n{header}\n");
        for (at, t_s) in self.t_s.iter().enumerate() {
            writeln!(text, "{t_s:.*},{}", self.decimals, row(self, at)).unwrap();
        }
        text
    }

    fn map_lateral(mut self, change: impl Fn(usize, f64) -> f64) -> Self {
        for (at, force) in self.lateral_n.iter_mut().enumerate() {
            *force = change(at, *force);
        }
        self
    }
}

/// Uniform random numbers from -1 to 1, the same on every machine.
pub fn noise(at: usize) -> f64 {
    let mixed = (at as u64 ^ 0x9E37_79B9).wrapping_mul(0xD134_2543_DE82_EF95);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0x2545_F491_4F6C_DD1D);
    (mixed >> 40) as f64 / f64::from(1u32 << 23) - 1.0
}

fn sample(second: f64) -> usize {
    (second * RATE_HZ) as usize
}

pub fn cases() -> Vec<Case> {
    let short = || Columns::new(3.0);
    let case = |name, text| Case { name, text, speed_mm_s: None };
    vec![
        case("valid", Columns::new(4.0).with_normal()),
        case("recording_unreadable", "t_s,lateral_n\n0,0.1\n0.01,a\n".to_owned()),
        case("recording_unusable", Columns::new(0.1).lateral()),
        case("recording_clock_gap", clock_gap()),
        case("recording_clock_jitter", clock_jitter()),
        case("recording_coarse", short().map_lateral(|_, f| (f * 20.0).round() / 20.0).lateral()),
        case("recording_clipped", clipped()),
        case("recording_stuck", held(sample(1.0)..sample(2.26), |f| f[sample(1.0)])),
        case("recording_silent", held(0..sample(1.2), |_| 0.0)),
        case("recording_spike", spikes()),
        case("recording_spike_many", many_spikes()),
        case("recording_ramp", bare(|at, _| 0.2 + 0.03 * at as f64 / RATE_HZ)),
        case(
            "recording_alternates",
            bare(|at, noise| 0.2 + 0.02 * noise + if at % 2 == 0 { 0.1 } else { -0.1 }),
        ),
        case("recording_below_band", bare(|at, _| 0.2 + 0.02 * below(at))),
        case("recording_above_band", above()),
        case("recording_force_outlier", outlier()),
        case("recording_friction_implausible", short().map_lateral(|_, f| 120.0 * f).with_normal()),
        case("recording_friction_coefficient", coefficient()),
        case("recording_speed_zero", speed(|_| 0.0)),
        case("recording_speed_implausible", speed(|v| 1e-3 * v)),
        case("recording_sweeps_cut_off", Columns::new(3.2).lateral()),
        case("recording_read_in_windows", stroke()),
        Case { speed_mm_s: Some(80.0), ..case("recording_off_target", slow_sweep()) },
        case("recording_unsteady", slow_sweep()),
        case("recording_uneven", knock()),
        case(
            "recording_noted",
            short().text("t_s,friction,mood", |c, at| format!("{:.5},7", c.lateral_n[at])),
        ),
    ]
}

/// A tenth of the samples are missing.
fn clock_gap() -> String {
    let text = Columns::new(3.0).lateral();
    let lost = sample(1.0)..sample(1.3);
    let kept = text.lines().enumerate().filter(|(at, _)| !lost.contains(at));
    kept.map(|(_, line)| format!("{line}\n")).collect()
}

/// Timestamps of a busy computer.
fn clock_jitter() -> String {
    let mut columns = Columns { decimals: 5, ..Columns::new(3.0) };
    for (at, t_s) in columns.t_s.iter_mut().enumerate() {
        *t_s += 0.45 * noise(at) / RATE_HZ;
    }
    columns.lateral()
}

/// 61 % of the samples are at two levels.
fn clipped() -> String {
    let columns = Columns::new(3.0);
    let mut sorted: Vec<f64> = columns.lateral_n.iter().map(|f| f.abs()).collect();
    sorted.sort_by(f64::total_cmp);
    let limit = (sorted[(0.39 * sorted.len() as f64) as usize] * 1e5).round() / 1e5;
    columns.map_lateral(|_, f| f.clamp(-limit, limit)).lateral()
}

/// The force is constant over some samples.
fn held(samples: std::ops::Range<usize>, value: fn(&[f64]) -> f64) -> String {
    let columns = Columns::new(3.0);
    let value = value(&columns.lateral_n);
    let change = |at, force| if samples.contains(&at) { value } else { force };
    columns.map_lateral(change).lateral()
}

/// Two spikes, in the middles of sweeps.
fn spikes() -> String {
    let columns = Columns::new(6.0);
    let at = [sample(0.6), sample(3.1)];
    let change = |n, force| if at.contains(&n) { force + 4.0 } else { force };
    columns.map_lateral(change).lateral()
}

/// Fifteen small spikes, in more than a tenth of the blocks.
fn many_spikes() -> String {
    bare(|at, noise| 0.2 + 0.005 * noise + if at % 170 == 50 { 0.15 } else { 0.0 })
}

/// A recording of five seconds with only a force, computed from the sample index and a noise of
/// unit size.
fn bare(force: impl Fn(usize, f64) -> f64) -> String {
    let columns = Columns::new(5.0);
    columns.map_lateral(|at, _| force(at, noise(at))).lateral()
}

/// A sum of tones from 1 to 14.7 Hz.
fn below(at: usize) -> f64 {
    let t = at as f64 / RATE_HZ;
    let tone =
        |k: usize| (std::f64::consts::TAU * (1.0 + 0.7183 * k as f64) * t + (k * k) as f64).sin();
    (0..20).map(tone).sum::<f64>() / 3.0
}

/// Tones from 1200 Hz on, at 4 kHz.
fn above() -> String {
    let rate_hz = 4000.0;
    let tone = |k: usize, t: f64| {
        (std::f64::consts::TAU * (1200.0 + 37.3 * k as f64) * t + (k * k) as f64).sin()
    };
    let mut text = "# simulated\nt_s,lateral_n\n".to_owned();
    for at in 0..6000 {
        let t = f64::from(at) / rate_hz;
        let force = 0.2 + 0.02 * (0..20).map(|k| tone(k, t)).sum::<f64>();
        writeln!(text, "{t:.5},{force:.6}").unwrap();
    }
    text
}

/// The quotient of the forces, with a normal force that rises and falls by 40 %.
fn coefficient() -> String {
    let mut columns = Columns::new(9.0);
    for (at, normal) in columns.normal_n.iter_mut().enumerate() {
        columns.lateral_n[at] /= *normal;
        *normal *= 1.0 + 0.4 * (2.0 * at as f64 / RATE_HZ).sin();
    }
    columns
        .text("t_s,friction,fz_n", |c, at| format!("{:.5},{:.4}", c.lateral_n[at], c.normal_n[at]))
}

/// One reading of 36,870 N.
fn outlier() -> String {
    let mut columns = Columns::new(3.0);
    columns.normal_n[sample(0.6)] = 36_870.0;
    columns.with_normal()
}

fn speed(change: fn(f64) -> f64) -> String {
    let mut columns = Columns::new(3.0);
    columns.speed_mm_s.iter_mut().for_each(|v| *v = change(*v));
    columns.with_speed()
}

/// The first of several sweeps is at three quarters of the speed.
fn slow_sweep() -> String {
    let mut columns = Columns::new(4.0);
    columns.speed_mm_s[..sample(1.2)].iter_mut().for_each(|v| *v *= 0.75);
    columns.with_speed()
}

/// One stroke of 5 s between two rests.
fn stroke() -> String {
    let mut columns = Columns::new(6.0);
    columns = columns.map_lateral(|at, _| {
        let t = at as f64 / RATE_HZ;
        let slides = ((t - 0.4).min(5.4 - t) / 0.1).clamp(0.0, 1.0);
        slides * (0.2 + 0.01 * noise(at)) + 1e-4 * noise(at + 7)
    });
    columns.lateral()
}

/// Someone knocks at the table during one sweep.
fn knock() -> String {
    let columns = Columns::new(8.0);
    let from = sample(3.0);
    columns
        .map_lateral(|at, force| {
            let ring = (at >= from).then(|| (from as f64 - at as f64) / (0.03 * RATE_HZ));
            force + ring.map_or(0.0, |decay| 1.5 * decay.exp() * noise(at))
        })
        .lateral()
}
