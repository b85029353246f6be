"""Coded fields (htex-coded-1.md section 2)."""

from __future__ import annotations

# column "+", then columns 0 to 6 of each row
DIFFERENCE = (128, [[250, 128, 128, 128, 128, 128, 128]])
FIRST = [124, 21, 30, 46, 59, 189, 253]
ALONE = (
    160,
    [
        [99, 161, 180, 117, 110, 112, 101],
        [71, 136, 147, 130, 134, 144, 114],
        [56, 127, 142, 135, 129, 103, 106],
        [43, 100, 118, 116, 116, 88, 68],
        [28, 63, 94, 98, 82, 79, 57],
        [26, 45, 58, 62, 63, 52, 40],
    ],
)
AFTER = (
    133,
    [
        [137, 208, 201, 170, 168, 165, 213],
        [113, 198, 206, 183, 133, 123, 139],
        [90, 183, 190, 157, 159, 141, 117],
        [66, 155, 165, 159, 155, 129, 126],
        [44, 96, 125, 137, 137, 138, 133],
        [26, 50, 67, 83, 92, 104, 85],
    ],
)
LIMITS = (4, 8, 14, 22, 34)


class CodeError(Exception):
    """A code that is refused."""


class Probability:
    def __init__(self, in_256: int):
        self.p, self.n = 256 * in_256, 16

    def after(self, yes: bool) -> None:
        self.p += -(self.p // (self.n + 3)) if yes else (65536 - self.p) // (self.n + 3)
        self.p = min(max(self.p, 64), 65472)
        self.n = min(self.n + 1, 80)


class Decoder:
    def __init__(self, data: bytes):
        self.data, self.at, self.range, self.number = data, 0, 2**32 - 1, 0
        for _ in range(4):
            self.number = self.number * 256 + self.byte()

    def byte(self) -> int:
        self.at += 1
        return self.data[self.at - 1] if self.at <= len(self.data) else 0

    def decide(self, p: int) -> bool:
        below = self.range // 65536 * p
        yes = self.number >= below
        if yes:
            self.number -= below
            self.range -= below
        else:
            self.range = below
        while self.range < 2**24:
            self.range *= 256
            self.number = self.number * 256 + self.byte()
        return yes


class Encoder:
    """Repeats decisions; `low` is a whole number with one byte more after each step of the range."""

    def __init__(self):
        self.low, self.range, self.shifts = 0, 2**32 - 1, 0

    def decide(self, p: int, yes: bool) -> None:
        below = self.range // 65536 * p
        if yes:
            self.low += below
            self.range -= below
        else:
            self.range = below
        while self.range < 2**24:
            self.range *= 256
            self.low *= 256
            self.shifts += 1

    def finish(self) -> bytes:
        for count in range(5):
            unit = 256 ** (4 - count)
            number = -(-self.low // unit) * unit
            if number < self.low + self.range:
                break
        # A number of 2^32 or more carries into the bytes before.
        return number.to_bytes(4 + self.shifts, "big").rstrip(b"\0")


class Recorder:
    """Reads decisions, and writes them again."""

    def __init__(self, data: bytes):
        self.decoder, self.encoder = Decoder(data), Encoder()

    def decide(self, probability: Probability | None) -> bool:
        p = probability.p if probability else 32768
        yes = self.decoder.decide(p)
        self.encoder.decide(p, yes)
        if probability:
            probability.after(yes)
        return yes

    def bits(self, count: int) -> int:
        """A number with this many bits after its leading one."""
        value = 1
        for _ in range(count):
            value = 2 * value + self.decide(None)
        return value


class Kind:
    def __init__(self, kind: tuple[int, list[list[int]]]):
        self.plus = Probability(kind[0])
        self.rows = [[Probability(p) for p in row] for row in kind[1]]

    def error(self, code: Recorder, row: int) -> int:
        columns = self.rows[row]
        if not code.decide(columns[0]):
            return 0
        sign = -1 if code.decide(self.plus) else 1
        for s in range(1, 15):
            if not code.decide(columns[min(s, 6)]):
                return sign * s
        b = 0
        while code.decide(None):
            b += 1
            if b > 17:
                raise CodeError("a number has too many bits")
        return sign * (15 + code.bits(b) - 1)


def row_of(unrest: int) -> int:
    return sum(unrest >= limit for limit in LIMITS)


class Field:
    def __init__(self, is_list: bool):
        self.is_list, self.before = is_list, 30 if is_list else 0
        self.difference, self.alone, self.after = Kind(DIFFERENCE), Kind(ALONE), Kind(AFTER)
        self.first = [Probability(p) for p in FIRST]
        self.expected: list[int] = []
        self.errors: list[int] = []

    def read(self, code: Recorder, take) -> int | list[int]:
        self.before += self.difference.error(code, 0)
        if not 0 <= self.before <= (65535 if self.is_list else 255):
            raise CodeError("a step or a length is out of range")
        if not self.is_list:
            take(1)
            return self.before
        take(self.before)
        steps, errors = self.list_after(code) if self.before == len(self.expected) else self.list_alone(code)
        self.errors = errors
        return steps

    def list_after(self, code: Recorder) -> tuple[list[int], list[int]]:
        unrest, d, steps, errors = 12, 0, [], []
        for x, e in zip(self.expected, self.errors):
            p = min(max((x + d + 8) // 16, 0), 255)
            error = self.after.error(code, row_of(unrest + 4 * e))
            steps.append(in_range(p + error))
            errors.append(abs(error))
            unrest = (unrest + 8 * min(abs(error), 40)) // 2
            d += (16 * steps[-1] - x - d) // 4
        self.expected = [x + d + (16 * q - x - d) // 2 for x, q in zip(self.expected, steps)]
        return steps, errors

    def list_alone(self, code: Recorder) -> tuple[list[int], list[int]]:
        unrest, steps, errors = 12, [], []
        for i in range(self.before):
            if i == 0:
                b = 0
                while b < 8 and code.decide(self.first[min(b, 6)]):
                    b += 1
                steps.append(code.bits(b - 1) if b else 0)
                errors.append(0)
                continue
            error = self.alone.error(code, row_of(unrest))
            steps.append(in_range(steps[-1] + error))
            errors.append(abs(error))
            unrest = (unrest + 8 * min(abs(error), 40)) // 2
        self.expected = [16 * q for q in steps]
        return steps, errors


def in_range(q: int) -> int:
    if not 0 <= q <= 255:
        raise CodeError("a step is out of range")
    return q


def read_coded(data: bytes, lists: list[bool], conditions: int, take) -> list[list[int | list[int]]]:
    """For each condition the steps of each coded field; `take` counts numbers against the limit."""
    code = Recorder(data)
    fields = [Field(is_list) for is_list in lists]
    steps = [[field.read(code, take) for field in fields] for _ in range(conditions)]
    if code.encoder.finish() != data:
        raise CodeError("an encoder writes another code")
    return steps
