"""Baked blocks (baked-1.md): a reader of section 1 and a player of section 3.

Arrays and scalars are NumPy float32, so that every operation rounds once; sums in order are `np.add.accumulate`.
"""

from __future__ import annotations

import hashlib
import json
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

import numpy as np

f32 = np.float32
NOISE, SINUSOIDS = 1, 2
HEADER = struct.Struct("<4sHBBIfHHHHBBBB6f")
WORD = 0xFFFFFFFF


class Broken(Exception):
    """A block that breaks the rule named."""


def bits(value: int | str) -> np.float32:
    value = int(value, 16) if isinstance(value, str) else value
    return np.array([value], "<u4").view("<f4")[0]


LOG = [bits(b) for b in (0x4038AA3B, 0x3F76384F, 0x3F13BB62, 0x3ED30BB2)]
EXP = [bits(b) for b in (0x3F800000, 0x3F317218, 0x3E75FDF0, 0x3D635847, 0x3C1D955B, 0x3AAEC3FF, 0x39218489)]
COS = [bits(b) for b in (0x40C90FDB, 0xC2255DE7, 0x42A335E3, 0xC2996966, 0x42283C1A)]
LEAST_ENERGY, NOISE_SCALE, HOLD_S = bits(0x3089705F), bits(0x37DDB3B9), bits(0x3DCCCCCD)
STRENGTH = bits(0x3B2A152D)


@dataclass
class Block:
    """The numbers of a block; conditions have the forces as rows and the speeds as columns."""

    kind: int
    drawn: bool
    rate: np.float32
    up: int
    count: int
    glide: int
    exponents: tuple
    ceiling: np.float32
    highest: np.float32
    speeds: np.ndarray
    forces: np.ndarray
    rows: np.ndarray
    levels: np.ndarray
    scales: np.ndarray
    weights: np.ndarray
    filters: np.ndarray
    frequencies: np.ndarray
    amplitudes: np.ndarray
    fluctuation: tuple | None


def read_block(data: bytes) -> Block:
    """Section 1: the block, or `Broken` with the first rule that it breaks."""
    if len(data) < 56:
        raise Broken("too_short")
    magic, version, kind, flags, length, rate, u, t, n, g, s, f, k, quantity, a, b, c, ceiling, full, p = (
        HEADER.unpack_from(data)
    )
    if magic != b"HTXB":
        raise Broken("not_a_block")
    if version != 1:
        raise Broken("version")
    if not 56 <= length <= len(data):
        raise Broken("length")
    if zlib.crc32(data[: length - 4]) != int.from_bytes(data[length - 4 : length], "little"):
        raise Broken("checksum")
    noise = kind == NOISE
    if not (
        kind in (NOISE, SINUSOIDS)
        and flags in ((0, 2) if noise else (0, 1, 2, 3))
        and 100 <= rate <= 1e6
        and 1 <= u <= 64
        and (t == 0 if u == 1 else t % 4 == 0 and 4 <= t <= 64)
        and (n % 4 == 0 and 4 <= n <= 320 if noise else 1 <= n <= 64)
        and 1 <= g <= 4096
        and 1 <= s <= 32
        and 1 <= f <= 32
        and (1 <= k <= 64 if noise else k == 0)
        and 1 <= quantity <= 5
        and all(-4 <= exponent <= 4 for exponent in (a, b, c))
        and 0 <= ceiling <= f32(1e10)
        and 0 < full <= f32(1e10)
        and 0 <= p <= 0.5
    ):
        raise Broken("header")
    cells = s * f
    numbers = 4 * k + 2 * cells * k + 2 * k * (n + 1) if noise else 8 * cells * n
    parts = HEADER.size + 4 * (s + f + u * t + cells) + numbers
    padded = parts + -parts % 4
    if length != padded + (8 if flags & 2 else 0) + 4:
        raise Broken("length")
    at = HEADER.size

    def take(number: int, kind: str = "<f4") -> np.ndarray:
        nonlocal at
        values = np.frombuffer(data, kind, number, at).astype(f32)
        at += values.size * int(kind[-1])
        return values

    def within(values: np.ndarray, low: float, high: float) -> bool:
        return bool(np.all((values >= f32(low)) & (values <= f32(high))))

    speeds, forces = take(s), take(f)
    for axis, low, high in ((speeds, 0.5, 1000), (forces, 1e-6, 20)):
        if not within(axis, low, high) or not np.all(axis[1:] > axis[:-1]):
            raise Broken("axes")
    rows, levels = take(u * t).reshape(u, t), take(cells)
    scales = take(k)
    weights = take(cells * k, "<i2").reshape(cells, k)
    filters = take(k * (n + 1), "<i2").reshape(k, n + 1)
    pairs = take(0 if noise else 2 * cells * n).reshape(cells, -1, 2)
    frequencies, amplitudes = pairs[:, :, 0], pairs[:, :, 1]
    if not (
        within(rows, -64, 64)
        and within(levels, 0, 1e9)
        and within(scales, 0, 2.0**-24)
        and within(frequencies, 0, 0.5)
        and within(amplitudes, -64, 64)
        and not any(data[parts:padded])
    ):
        raise Broken("values")
    fluctuation = None
    if flags & 2:
        period, slow, fast, offset = struct.unpack_from("<HBBf", data, padded)
        if period == 0 or not -16 <= offset <= 16:
            raise Broken("values")
        fluctuation = (f32(period), f32(slow), f32(fast), f32(offset))
    return Block(
        kind, bool(flags & 1), f32(rate), u, n, g, (f32(a), f32(b), f32(c)), f32(ceiling), f32(p), speeds, forces,
        rows, levels, scales, weights, filters, frequencies, amplitudes, fluctuation,
    )  # fmt: skip


def in_order(terms: np.ndarray) -> np.ndarray:
    """The sum of the rows, from the first, that begins with 0."""
    return np.add.accumulate(np.concatenate([np.zeros_like(terms[:1]), terms]))[-1]


def lanes(x: np.ndarray, y: np.ndarray) -> np.float32:
    sums = in_order((x * y).reshape(-1, 4))
    return (sums[0] + sums[1]) + (sums[2] + sums[3])


def log2(x: np.float32) -> np.float32:
    pattern = int(np.array([x], f32).view(np.uint32)[0])
    e, m_bits = (pattern >> 23) - 127, (pattern & 0x7FFFFF) | 0x3F800000
    m = bits(m_bits)
    if m_bits > 0x3FB504F3:
        m, e = m * f32(0.5), e + 1
    s = (m - f32(1)) / (m + f32(1))
    q = s * s
    return f32(e) + s * (LOG[0] + q * (LOG[1] + q * (LOG[2] + q * LOG[3])))


def exp2(x: np.float32) -> np.float32:
    n = int(x + f32(-0.5 if x < 0 else 0.5))
    p, total = x - f32(n), EXP[6]
    for e in EXP[5::-1]:
        total = total * p + e
    return total * f32(2.0**n)


def cosine(phases: np.ndarray) -> np.ndarray:
    x = phases.astype(np.uint32).view(np.int32).astype(f32) * f32(2.0**-32)
    t = f32(0.25) - np.abs(x)
    s = t * t
    return t * (COS[0] + s * (COS[1] + s * (COS[2] + s * (COS[3] + s * COS[4]))))


class Random:
    """xoshiro128++."""

    def __init__(self, seed: int):
        self.s, c = [], seed
        for _ in range(4):
            c = (c + 0x9E3779B9) & WORD
            z = ((c ^ (c >> 16)) * 0x85EBCA6B) & WORD
            z = ((z ^ (z >> 13)) * 0xC2B2AE35) & WORD
            self.s.append(z ^ (z >> 16))

    def next(self) -> int:
        def rotl(x: int, k: int) -> int:
            return ((x << k) | (x >> (32 - k))) & WORD

        s0, s1, s2, s3 = self.s
        result = (rotl((s0 + s3) & WORD, 7) + s0) & WORD
        t = (s1 << 9) & WORD
        s2 ^= s0
        s3 ^= s1
        s1 ^= s2
        s0 ^= s3
        self.s = [s0, s1, s2 ^ t, rotl(s3, 11)]
        return result

    def noise(self) -> np.float32:
        x, y = self.next(), self.next()
        return f32((x & 0xFFFF) + (x >> 16) + (y & 0xFFFF) + (y >> 16) - 131070) * NOISE_SCALE


class Envelope:
    """The fluctuation."""

    def __init__(self, fluctuation: tuple, rate: np.float32, seed: int):
        self.period, slow, fast, self.offset = fluctuation
        self.strength = (slow * STRENGTH, fast * STRENGTH)
        random, d = Random(seed ^ 0x666C7563), self.period / rate
        self.phases, self.advance = np.zeros((2, 8), np.uint32), np.zeros((2, 8), np.uint32)
        for part, (low, width) in enumerate(((0.5, 0.9375), (8, 3))):
            for i in range(8):
                u = f32(random.next() >> 8) * f32(2.0**-24)
                f = f32(low) + f32(width) * (f32(i) + u)
                self.advance[part, i] = advance_of(f * d)
                self.phases[part, i] = random.next()
        self.values, self.count = [self.next(), self.next()], 0

    def next(self) -> np.float32:
        slow, fast = (in_order(row) for row in cosine(self.phases))
        self.phases = self.phases + self.advance
        return exp2(self.offset + self.strength[0] * slow + self.strength[1] * fast)

    def factor(self) -> np.float32:
        if self.count == self.period:
            self.values, self.count = [self.values[1], self.next()], 0
        a, b = self.values
        part = f32(self.count) / self.period
        self.count += 1
        return a + (b - a) * part


class Player:
    """Section 3. `values` has a row of coefficients, or one of amplitudes and one of frequencies."""

    def __init__(self, block: Block, seed: int):
        self.block, self.random = block, Random(seed)
        self.noise = block.kind == NOISE
        shape = (1, block.count + 1) if self.noise else (2, block.count)
        self.values, self.steps = np.zeros(shape, f32), np.zeros(shape, f32)
        self.left = self.held_left = self.phase = 0
        self.silent = self.held = self.rendered = False
        self.motion = (f32(0), f32(0))
        self.history = np.zeros(0, f32)
        self.phases = np.zeros(block.count, np.uint32)
        self.inputs = np.zeros(block.rows.shape[1], f32)
        if self.noise:
            self.history = np.array([self.random.noise() for _ in range(2 * block.count + 1)], f32)
        elif block.drawn:
            self.phases = np.array([self.random.next() for _ in range(block.count)], np.uint32)
        self.envelope = block.fluctuation and Envelope(block.fluctuation, block.rate, seed)
        self.sound(block.speeds[0], block.forces[0])

    def read(self, v: np.float32, force: np.float32) -> None:
        """A reading."""
        if not (np.isfinite(v) and np.isfinite(force)):
            return
        v = abs(v)
        if v > 1000 or force > 20:
            if not self.held:
                self.held, self.held_left = True, int(HOLD_S * self.block.rate)
            return
        self.held = False
        if v < 0.5 or force <= 0:
            self.fade()
        elif self.silent or (v, force) != self.motion:
            self.sound(v, force)

    def change(self) -> np.float32:
        """Begin a change; its part."""
        self.left = self.block.glide if self.rendered else 0
        return f32(1) / f32(max(self.left, 1))

    def fade(self) -> None:
        if self.silent:
            return
        self.silent = True
        part = self.change()
        self.steps[:] = 0
        self.steps[0] = (-self.values[0]) * part
        if not self.left:
            self.values[0] = 0

    def sound(self, v: np.float32, force: np.float32) -> None:
        block = self.block
        self.silent, self.motion = False, (v, force)
        part = self.change()
        v0 = min(max(v, block.speeds[0]), block.speeds[-1])
        force0 = min(max(force, block.forces[0]), block.forces[-1])
        i, u = place(block.speeds, v0)
        j, w = place(block.forces, force0)
        one, columns = f32(1), len(block.speeds)
        corners = (
            ((one - u) * (one - w), j * columns + i),
            (u * (one - w), j * columns + i + 1),
            ((one - u) * w, (j + 1) * columns + i),
            (u * w, (j + 1) * columns + i + 1),
        )
        corners = [(weight, cell) for weight, cell in corners if weight > 0]

        def mix(numbers: np.ndarray) -> np.ndarray:
            return in_order(np.array([weight * numbers[cell] for weight, cell in corners], f32))

        level, r = mix(block.levels), one
        if (v, force) != (v0, force0):
            a, b, c = block.exponents
            x = log2(min(max(v / v0, f32(0.0625)), f32(8)))
            y = log2(min(max(force / force0, f32(2.0**-20)), f32(2.0**20)))
            r = min(max(exp2(a * x), f32(0.0625)), f32(8))
            raised = level * exp2(b * x + c * y)
            level = max(level, block.ceiling) if raised > level and raised > block.ceiling else raised
        if self.noise:
            sums = in_order((mix(block.weights) * block.scales)[:, None] * block.filters)
            power = sums[0] * sums[0] + f32(2) * lanes(sums[1:], sums[1:])
            new = (sums * gain_of(level, power))[None]
        else:
            frequencies, amplitudes = mix(block.frequencies), mix(block.amplitudes)
            power = in_order((f32(0.5) * amplitudes) * amplitudes)
            highest = max(frequencies[amplitudes != 0], default=f32(0))
            if r > 1 and highest * r > block.highest:
                r = max(block.highest / highest, one)
            new = np.array([amplitudes * gain_of(level, power), frequencies * r])
        self.steps = (new - self.values) * part
        if not self.left:
            self.values = new

    def sample(self) -> np.float32:
        sample = self.steady()
        return sample * self.envelope.factor() if self.envelope else sample

    def steady(self) -> np.float32:
        if self.held:
            if self.held_left == 0:
                self.fade()
            else:
                self.held_left -= 1
        self.rendered = True
        if self.block.up == 1:
            return self.internal()
        if self.phase == 0:
            self.inputs = np.append(self.inputs[1:], self.internal())
        result = lanes(self.block.rows[self.phase], self.inputs)
        self.phase = (self.phase + 1) % self.block.up
        return result

    def internal(self) -> np.float32:
        """A sample of the internal rate."""
        if self.left:
            self.values = self.values + self.steps
            self.left -= 1
            if self.left == 0 and self.silent:
                self.values[0] = 0
        if self.noise:
            n, values = self.block.count, self.values[0]
            self.history = np.append(self.history[1:], self.random.noise())
            pairs = self.history[n + 1 :] + self.history[n - 1 :: -1]
            return values[0] * self.history[n] + lanes(values[1:], pairs)
        amplitudes, frequencies = self.values
        result = in_order(amplitudes * cosine(self.phases))
        self.phases = self.phases + advance_of(frequencies)
        return result


def advance_of(frequencies):
    return np.clip(np.trunc((frequencies * f32(2.0**32)).astype(np.float64)), 0, WORD).astype(np.uint32)


def place(axis: np.ndarray, value: np.float32) -> tuple[int, np.float32]:
    """Step 2 of sounding: the cell on an axis, and the part of it."""
    i = int(np.count_nonzero(axis <= value)) - 1
    return i, f32(0) if i + 1 == len(axis) else (value - axis[i]) / (axis[i + 1] - axis[i])


def gain_of(level: np.float32, power: np.float32) -> np.float32:
    return level / np.sqrt(power) if power > LEAST_ENERGY else f32(0)


def integers(samples: np.ndarray, full_scale: np.float32) -> np.ndarray:
    gain = f32(32767) / full_scale if full_scale > 0 else f32(0)
    y = samples * gain
    rounded = np.trunc(y + np.where(y < 0, f32(-0.5), f32(0.5)))
    return np.clip(np.nan_to_num(rounded, nan=0.0), -32768, 32767).astype("<i2")


def play(block: Block, seed: int, steps: list[dict]) -> np.ndarray:
    player, samples = Player(block, seed), []
    for step in steps:
        if "render" in step:
            samples += [player.sample() for _ in range(step["render"])]
        else:
            motion = step["set_motion"]
            player.read(bits(motion["speed_bits"]), bits(motion["force_bits"]))
    return np.array(samples, "<f4")


def compare_baked(folder: Path, say: Callable[[str], None]) -> tuple[int, int]:
    """Section 5: how many files agree, of how many."""
    agree = total = 0
    for path in sorted(folder.glob("*.json")):
        expected = json.loads(path.read_text("utf-8"))
        total += 1
        try:
            block = read_block(path.with_suffix(".bin").read_bytes())
        except Broken as broken:
            ours, theirs = {"rule": str(broken)}, {"rule": expected.get("rule")}
        else:
            with np.errstate(all="ignore"):
                samples = play(block, expected["seed"], expected["steps"]) if expected["valid"] else np.zeros(0, "<f4")
            ours, theirs = {"valid": True}, {"valid": expected["valid"]}
            if expected["valid"]:
                numbers = integers(samples, bits(expected["integers"]["full_scale_bits"]))
                ours |= {
                    "count": len(samples),
                    "first_bits": [f"{value:08x}" for value in samples[:16].view("<u4")],
                    "sha256": hashlib.sha256(samples.tobytes()).hexdigest(),
                    "first": numbers[:16].tolist(),
                    "sha256 of integers": hashlib.sha256(numbers.tobytes()).hexdigest(),
                }
                reals, whole = expected["samples"], expected["integers"]
                theirs |= {key: reals[key] for key in ("count", "first_bits", "sha256")}
                theirs |= {"first": whole["first"], "sha256 of integers": whole["sha256"]}
        if ours == theirs:
            agree += 1
        else:
            differing = [key for key in ours if ours[key] != theirs.get(key)]
            say(f"{folder.name}/{path.stem}: differs in {differing}: {ours}, expected {theirs}")
    return agree, total
