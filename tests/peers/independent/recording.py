"""Findings in recordings (recording-findings.md, *Thresholds*)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import band, segments
from .findings import Findings
from .table import NotATable, read_table

# Columns by name: the role, and whether the name states the unit.
COLUMNS = {
    "t_s": ("time", True),
    "lateral_n": ("lateral", True),
    "friction": ("lateral", False),
    "fz_n": ("normal", True),
    "speed_mm_s": ("speed", True),
}
LEAST_RATE_HZ = 60.0
MOST_IN_QUANTILE = 20000


def quantile(values: np.ndarray, p: float) -> float:
    """The value at p (n - 1), rounded to the nearest, halves up."""
    if len(values) > MOST_IN_QUANTILE:
        values = values[:: math.ceil(len(values) / MOST_IN_QUANTILE)]
    return float(np.sort(values)[math.floor(p * (len(values) - 1) + 0.5)])


def median(values: np.ndarray) -> float:
    return quantile(values, 0.5)


@dataclass
class Recording:
    rate: float = 0.0
    signals: dict[str, np.ndarray] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    gaps: np.ndarray = field(default_factory=lambda: np.array([], dtype=int))


def read_recording(path: Path, target_speed: float | None = None, target_force: float | None = None) -> Findings:
    findings = Findings()
    try:
        recording = load(path.read_bytes())
    except NotATable as error:
        findings.add("RECORDING_UNREADABLE", "", str(error))
        return findings
    check_clock(recording, findings)
    lateral = recording.signals["lateral"]
    if check_axis(recording, lateral, findings):
        band.check(lateral, recording.rate, findings)
    if "normal" in recording.signals:
        check_normal(recording, recording.signals["normal"], findings)
        check_friction(recording, lateral, recording.signals["normal"], findings)
    if "speed" in recording.signals:
        check_speed(recording.signals["speed"], findings)
    check_segments(recording, target_speed, target_force, findings)
    return findings


def load(data: bytes) -> Recording:
    names, values = read_table(data)
    recording, unused = Recording(), []
    for name, column in zip(names, values):
        role, has_unit = COLUMNS.get(name, (None, True))
        if role is None or role in recording.signals:
            unused.append(name)
            continue
        recording.signals[role] = np.array(column)
        if not has_unit:
            recording.notes.append(f"{name} has no unit")
    if unused:
        recording.notes.append(f"not used: {', '.join(unused)}")
    if "lateral" not in recording.signals or "time" not in recording.signals:
        raise NotATable("no lateral force, or no time")
    return recording


def check_clock(recording: Recording, findings: Findings) -> None:
    """The rate, gaps and jitter."""
    steps = np.diff(recording.signals["time"])
    if not len(steps) or np.any(steps <= 0):
        findings.add("RECORDING_UNREADABLE", "", "time does not ascend")
        return
    middle = median(steps)
    uneven = quantile(steps, 0.75) - quantile(steps, 0.25) > 0.15 * middle
    is_gap = steps > (10 if uneven else 1.5) * middle * (1 + 1e-6)
    even = steps[~is_gap]
    recording.rate = len(even) / float(np.sum(even))
    recording.gaps = np.flatnonzero(is_gap)
    if len(recording.gaps):
        findings.add("RECORDING_CLOCK_GAP", f"/time/{recording.gaps[0] + 1}")
    if np.std(even) > 0.01 * np.mean(even):
        findings.add("RECORDING_CLOCK_JITTER", "/time")


def stretches(values: np.ndarray) -> list[tuple[int, int]]:
    """Stretches of one value, as first and end."""
    ends = np.flatnonzero(np.diff(values)) + 1
    return list(zip([0, *ends.tolist()], [*ends.tolist(), len(values)]))


def clipped_at(values: np.ndarray) -> list[float]:
    """The values at which an axis is clipped."""
    low, high = float(np.min(values)), float(np.max(values))
    result = []
    for extreme, sign in ((high, 1.0), (low, -1.0)):
        flipped, t = sign * values, sign * extreme
        below = flipped[flipped < t]
        if not len(below):
            return []
        border = min(float(np.max(below)), t - 0.001 * (high - low))
        at, near = np.sum(flipped == t), np.sum((flipped >= border) & (flipped < t))
        if abs(extreme) >= 0.5 * np.mean(np.abs(values)) and at >= 0.01 * len(values) and at >= 4 * near:
            result.append(extreme)
    separate = sum(values[begin] in result for begin, _ in stretches(values))
    return result if separate >= 3 else []


def check_axis(recording: Recording, values: np.ndarray, findings: Findings) -> bool:
    """The findings of an axis; whether the band is checked too."""
    segment = segments.length_of(recording.rate)
    coarse = len(values) >= segment and 2 <= len(np.unique(values)) <= 15
    if coarse:
        findings.add("RECORDING_COARSE", "/lateral")
    course = course_of(values, recording.rate)
    if coarse or len(values) < segment:
        if course:
            findings.add(course, "/lateral")
        return False
    clipped = clipped_at(values)
    if clipped:
        findings.add("RECORDING_CLIPPED", f"/lateral/{np.flatnonzero(np.isin(values, clipped))[0]}")
    if course:
        findings.add(course, "/lateral")
    check_stuck(recording, values, clipped, findings)
    spikes = find_spikes(values, recording.rate)
    if spikes:
        findings.add("RECORDING_SPIKE", f"/lateral/{spikes[0]}")
    return not course


def course_of(values: np.ndarray, rate: float) -> str | None:
    """The code of a ramp or an alternation."""
    if len(values) < 5 * segments.length_of(rate) or np.ptp(values) == 0:
        return None
    if np.corrcoef(np.arange(len(values)), values)[0, 1] ** 2 >= 0.99:
        return "RECORDING_RAMP"
    centred = values - np.mean(values)
    for period in (2, 3, 4):
        places = [centred[place::period] for place in range(period)]
        if sum(len(p) * np.mean(p) ** 2 for p in places) >= 0.5 * np.sum(centred**2):
            return "RECORDING_ALTERNATES"
    return None


def long_stretches(values: np.ndarray, rate: float) -> list[tuple[int, int]]:
    least = max(2, math.floor(0.5 * rate))
    return [(begin, end) for begin, end in stretches(values) if end - begin >= least]


def check_stuck(recording: Recording, values: np.ndarray, clipped: list[float], findings: Findings) -> None:
    speed = recording.signals.get("speed")
    mean_speed = float(np.mean(np.abs(speed))) if speed is not None else 0.0
    mean_value = float(np.mean(np.abs(values)))
    stuck, silent = [], []
    for begin, end in long_stretches(values, recording.rate):
        if values[begin] in clipped:
            continue
        if mean_speed > 0:
            if np.mean(np.abs(speed[begin:end])) > 0.1 * mean_speed:
                stuck.append(begin)
        elif abs(values[begin]) > 0.5 * mean_value:
            stuck.append(begin)
        elif end - begin >= recording.rate:
            silent.append(begin)
    if stuck:
        findings.add("RECORDING_STUCK", f"/lateral/{stuck[0]}")
    if silent:
        findings.add("RECORDING_SILENT", f"/lateral/{silent[0]}")


def find_spikes(values: np.ndarray, rate: float, floor: float = 0.0) -> list[int]:
    """The samples that are outliers; `floor` is a level that corners must exceed 10 times too."""
    size = max(8, round(0.1 * rate))
    corners = np.zeros(len(values))
    corners[1:-1] = np.abs(values[1:-1] - (values[:-2] + values[2:]) / 2)
    blocks = len(values) // size
    if not blocks:
        return []
    starts = range(0, len(values), size)
    tops = [start + int(np.argmax(corners[start : start + size])) for start in starts]
    threshold = 10 * max(quantile(corners[tops], 0.75), floor)
    spikes: list[int] = []
    for top in tops:
        if corners[top] <= threshold:
            continue
        if spikes and top - spikes[-1] <= 2:
            if corners[top] > corners[spikes[-1]]:
                spikes[-1] = top
        else:
            spikes.append(top)
    if len(spikes) > max(3, math.floor(0.1 * blocks)):
        spikes = []
    many = many_spikes(values, corners, size, 10 * floor)
    return many if len(many) > len(spikes) else spikes


def many_spikes(values: np.ndarray, corners: np.ndarray, size: int, floor: float) -> list[int]:
    """The samples that are outliers one by one, if there are enough of them."""
    inner = corners[1:-1]
    whole = inner[: len(inner) // size * size].reshape(-1, size)
    if not len(whole):
        return []
    usual = 1.4826 * quantile(np.array([median(block) for block in whole]), 0.75)
    if usual == 0:
        return []
    singles = [at for at in range(3, len(values) - 3) if corners[at] > 5 * usual and is_single(values, corners, at)]
    small, large = ([at for at in singles if corners[at] > max(floor, ratio * usual)] for ratio in (5, 12))
    if len(small) >= 0.0075 * len(values):
        return small
    return large if len(large) >= 6 else []


def is_single(values: np.ndarray, corners: np.ndarray, at: int) -> bool:
    if corners[at] < corners[at - 1] or corners[at] <= corners[at + 1]:
        return False
    around = values[at - 3 : at + 4].copy()
    around[3] = (4 * (around[2] + around[4]) - (around[1] + around[5])) / 6
    left = np.abs(around[1:-1] - (around[:-2] + around[2:]) / 2)
    return bool(np.all(2 * left < corners[at]))


def check_normal(recording: Recording, values: np.ndarray, findings: Findings) -> None:
    held = long_stretches(values, recording.rate)
    outside = len(values) - sum(end - begin for begin, end in held)
    if held and np.count_nonzero(np.diff(values)) > 0.5 * outside:
        findings.add("RECORDING_STUCK", f"/normal/{held[0][0]}")
    spikes = find_spikes(values, recording.rate, 0.05 * median(values))
    if spikes:
        findings.add("RECORDING_FORCE_OUTLIER", f"/normal/{spikes[0]}")


def check_friction(recording: Recording, lateral: np.ndarray, normal: np.ndarray, findings: Findings) -> None:
    if median(np.abs(lateral)) > 10 * max(median(normal), 0.0):
        findings.add("RECORDING_FRICTION_IMPLAUSIBLE", "/normal")
    if is_coefficient(lateral, normal, recording.rate):
        findings.add("RECORDING_FRICTION_COEFFICIENT", "/lateral")


def is_coefficient(lateral: np.ndarray, normal: np.ndarray, rate: float) -> bool:
    """Whether the lateral force does not follow the normal force, over segments of sliding."""
    length = segments.length_of(rate)
    if len(lateral) < length:
        return False
    sliding, magnitude = segments.find(lateral, rate).sliding, np.abs(lateral)
    # The last whole segment is left out if it ends with the recording.
    parts = [slice(s, s + length) for s in range(0, len(lateral) - length, length)]
    means = [(np.mean(normal[part]), np.mean(magnitude[part])) for part in parts if np.all(sliding[part])]
    logs = np.log([pair for pair in means if min(pair) > 0])
    if len(logs) < 20:
        return False
    x, y = logs.T - logs.mean(axis=0)[:, None]
    if np.std(x) < 0.05:
        return False
    slope = np.sum(x * y) / np.sum(x * x)
    error = np.sqrt(np.mean((y - slope * x) ** 2) / ((len(x) - 2) * np.var(x)))
    return bool(abs(slope) + 2 * error <= 0.25)


def check_speed(speed: np.ndarray, findings: Findings) -> None:
    magnitude = np.abs(speed)
    if np.max(magnitude) < 0.001:
        findings.add("RECORDING_SPEED_ZERO", "/speed")
    elif not 1 <= quantile(magnitude, 0.75) <= 2000:
        findings.add("RECORDING_SPEED_IMPLAUSIBLE", "/speed")


def check_segments(recording: Recording, speed: float | None, force: float | None, findings: Findings) -> None:
    """Segments, that the recording is unusable, and notes."""
    lateral, rate = recording.signals["lateral"], recording.rate
    length = segments.length_of(rate)
    if len(lateral) < length or rate < LEAST_RATE_HZ:
        findings.add("RECORDING_UNUSABLE", "")
        return
    reading = segments.find(lateral, rate)
    motions = [(role, target) for role, target in (("speed", speed), ("normal", force)) if role in recording.signals]
    on_target = [
        start
        for start in reading.starts
        if not any(target and is_off(recording, role, target, start, length) for role, target in motions)
    ]
    if len(on_target) < len(reading.starts):
        findings.add("RECORDING_OFF_TARGET", "")
    if reading.cut_off:
        findings.add("RECORDING_SWEEPS_CUT_OFF", "/lateral")
    if reading.windows:
        findings.add("RECORDING_READ_IN_WINDOWS", "/lateral")
    starts = on_target
    check_uneven(lateral, rate, starts, length, findings)
    for role, target in motions:
        if target is None and starts:
            values = np.abs(recording.signals[role])
            middle = median(np.concatenate([values[s : s + length] for s in starts]))
            if any(is_off(recording, role, middle, start, length) for start in starts):
                findings.add("RECORDING_UNSTEADY", f"/{role}")
    if not starts:  # A guess: the text does not say so of segments that are all off their target.
        findings.add("RECORDING_UNUSABLE", "")
    for note in recording.notes:
        findings.add("RECORDING_NOTED", "", note)
    if rate < 2000:
        findings.add("RECORDING_NOTED", "", "the spectrum ends below 1000 Hz")
    if len(starts) < 3:
        findings.add("RECORDING_NOTED", "", "few segments")


def is_off(recording: Recording, role: str, target: float, start: int, length: int) -> bool:
    """Whether the average over 0.05 s differs from the target by more than 0.1 of it, anywhere in the segment."""
    smooth = segments.average(np.abs(recording.signals[role]), recording.rate)
    return bool(np.any(np.abs(smooth[start : start + length] - target) > 0.1 * target))


def check_uneven(lateral: np.ndarray, rate: float, starts: list[int], length: int, findings: Findings) -> None:
    if not starts:
        return
    window = np.hanning(length + 1)[:-1]
    frequencies = np.fft.rfftfreq(length, 1 / rate)
    band = (frequencies >= 20 - 1e-6) & (frequencies <= 1000 + 1e-6)
    parts = [lateral[s : s + length] for s in starts]
    spectra = [np.abs(np.fft.rfft((part - np.mean(part)) * window))[band] for part in parts]
    levels = np.array([math.sqrt(float(np.sum(spectrum**2))) for spectrum in spectra])
    loud = [s for s, level in zip(starts, levels) if level > 4 * median(levels)]
    if loud and len(loud) * 4 <= len(starts):
        findings.add("RECORDING_UNEVEN", f"/lateral/{loud[0]}")
