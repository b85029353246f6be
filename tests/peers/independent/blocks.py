"""Parameter blocks (htex-1.md section 4) and the reference (section 5)."""

from __future__ import annotations

import math
import struct

from .coded import CodeError, read_coded
from .stores import Store


class BlockError(Exception):
    """A block that is refused; `code` is the finding's."""

    def __init__(self, code: str, why: str = ""):
        super().__init__(f"{code}: {why}")
        self.code = code


class Budget:
    """The limit `values`, shared by all blocks and the reference."""

    def __init__(self, limit: int):
        self.left = limit

    def take(self, count: int) -> None:
        if count > self.left:
            raise BlockError("VALUES_TOO_MANY")
        self.left -= count


class Reader:
    def __init__(self, data: bytes):
        self.data, self.at = data, 0

    def take(self, count: int) -> bytes:
        if count > len(self.data) - self.at:
            raise BlockError("PARAMETERS_INVALID", "too short")
        self.at += count
        return self.data[self.at - count : self.at]

    def left(self) -> int:
        return len(self.data) - self.at

    def length(self) -> int:
        """A length in its shortest form."""
        first = self.take(1)[0]
        if first <= 250:
            return first
        forms = {0xFB: (2, 251), 0xFC: (4, 1 << 16), 0xFD: (8, 1 << 32)}
        if first not in forms:
            raise BlockError("PARAMETERS_INVALID", "no length")
        size, least = forms[first]
        value = int.from_bytes(self.take(size), "little")
        if value < least:
            raise BlockError("PARAMETERS_INVALID", "a length in a longer form")
        return value


def read_block(data: bytes, fields: list[dict], conditions: int, budget: Budget) -> list[list[float | list[float]]]:
    """For each condition the values of the fields: a number, or a list of them."""
    reader = Reader(data)
    result = []
    for _ in range(conditions):
        values: list[float | list[float]] = []
        for field in fields:
            store = Store.of(field)
            if store.kind == "coded":
                values.append([])
                continue
            values.append(read_list(reader, store, budget) if field.get("list") else read_number(reader, store, budget))
        result.append(values)
    stores = [Store.of(field) for field in fields]
    coded = [i for i, store in enumerate(stores) if store.kind == "coded"]
    if coded:
        lists = [bool(fields[i].get("list")) for i in coded]
        try:
            steps = read_coded(reader.take(reader.left()), lists, conditions, budget.take)
        except CodeError as error:
            raise BlockError("PARAMETERS_INVALID", str(error)) from error
        for values, of_fields in zip(result, steps):
            for i, q in zip(coded, of_fields):
                values[i] = [stores[i].step(x) for x in q] if isinstance(q, list) else stores[i].step(q)
    if reader.left():
        raise BlockError("PARAMETERS_INVALID", "too long")
    return result


def read_number(reader: Reader, store: Store, budget: Budget) -> float:
    budget.take(1)
    if store.kind == "packed":
        # STORE_INVALID; read as a list of one number without its length.
        return finite(store.step(read_packed(reader, 1)[0]))
    return finite(store.value(reader.take(store.bytes)))


def read_list(reader: Reader, store: Store, budget: Budget) -> list[float]:
    length = reader.length()
    if store.kind == "packed":
        # Each number takes at least one bit, the first eight.
        if length > reader.left() * 8:
            raise BlockError("PARAMETERS_INVALID", "more numbers than bits")
        budget.take(length)
        return [finite(store.step(q)) for q in read_packed(reader, length)]
    if length * store.bytes > reader.left():
        raise BlockError("PARAMETERS_INVALID", "a list is longer than the block")
    budget.take(length)
    return [finite(store.value(reader.take(store.bytes))) for _ in range(length)]


def finite(value: float) -> float:
    if not math.isfinite(value):
        raise BlockError("PARAMETERS_NOT_FINITE")
    return value


class Bits:
    """Bits of a reader's remaining bytes, the most significant of a byte first."""

    def __init__(self, reader: Reader):
        self.reader, self.byte, self.left = reader, 0, 0

    def one(self) -> int:
        if not self.left:
            self.byte, self.left = self.reader.take(1)[0], 8
        self.left -= 1
        return self.byte >> self.left & 1

    def number(self, count: int) -> int:
        value = 0
        for _ in range(count):
            value = value << 1 | self.one()
        return value


def read_packed(reader: Reader, length: int) -> list[int]:
    """The steps of a packed list."""
    if length == 0:
        return []
    bits = Bits(reader)
    k = bits.number(3)
    steps, coded = [bits.number(8)], []
    while len(steps) < length:
        ones = 0
        while bits.one():
            ones += 1
        z = ones << k | bits.number(k)
        coded.append(z)
        steps.append(steps[-1] + (-(z + 1) // 2 if z & 1 else z // 2))
        if not 0 <= steps[-1] <= 255:
            raise BlockError("PARAMETERS_INVALID", "a step out of range")
    if bits.byte & ((1 << bits.left) - 1):
        raise BlockError("PARAMETERS_INVALID", "bits at the end")
    if k != best_k(coded):
        raise BlockError("PARAMETERS_INVALID", "another k takes fewer bits")
    return steps


def best_k(coded: list[int]) -> int:
    return min(range(8), key=lambda k: (sum((z >> k) + 1 + k for z in coded), k))


def flat(values: list[float | list[float]]) -> list[float]:
    """The flat array of a condition: a list is preceded by its length (section 4)."""
    result: list[float] = []
    for value in values:
        if isinstance(value, list):
            result += [float(len(value)), *value]
        else:
            result.append(value)
    return result


def grid(low: float, high: float) -> range:
    """The numbers n of the multiples 5 n Hz in the band (section 5)."""
    return range(max(1, math.ceil(low / 5 - 1e-9)), math.floor(high / 5 + 1e-9) + 1)


def read_reference(data: bytes, low: float, high: float, conditions: int, budget: Budget) -> list[list[float]]:
    """The magnitudes of each condition."""
    count = len(grid(low, high))
    if len(data) != 4 * count * conditions:
        raise BlockError("REFERENCE_LENGTH")
    budget.take(count * conditions)
    numbers = struct.unpack(f"<{count * conditions}f", data)
    if any(not math.isfinite(n) or n < 0 for n in numbers):
        raise BlockError("REFERENCE_INVALID")
    return [list(numbers[i * count : (i + 1) * count]) for i in range(conditions)]
