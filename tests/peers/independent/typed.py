"""The types of keys, and the check of a document against them (htex-1.md section 2, htex-reports-1.md section 4).

Types are checked depth first, keys in ascending order of their bytes, and absent keys after those that
are there. The first error is raised. Unknown keys are collected by `unknown_keys`.
"""

from __future__ import annotations

from dataclasses import dataclass

from .findings import Refused, escape
from .jsontext import Whole

LARGEST_INTEGER = 2**53


WHITE_SPACE = "\t\n\v\f\r \x85\xa0\u1680" + "".join(map(chr, range(0x2000, 0x200B))) + "\u2028\u2029\u202f\u205f\u3000"


class Wrong(Exception):
    """A value of the wrong type at a pointer."""

    def __init__(self, pointer: str, why: str):
        super().__init__(f"{pointer}: {why}")
        self.pointer, self.why = pointer, why


class Any:
    def check(self, value, pointer: str) -> None:
        pass

    def unknown(self, value, pointer: str):
        return iter(())


class Text(Any):
    def check(self, value, pointer):
        if not isinstance(value, str):
            raise Wrong(pointer, "no string")


class Boolean(Any):
    def check(self, value, pointer):
        if not isinstance(value, bool):
            raise Wrong(pointer, "neither true nor false")


class Number(Any):
    def check(self, value, pointer):
        if not isinstance(value, float):
            raise Wrong(pointer, "no number")


@dataclass
class Integer(Any):
    """A whole number, compared as it is written if it is of digits alone."""

    low: int = 0
    high: int = LARGEST_INTEGER

    def check(self, value, pointer):
        exact = value.written if isinstance(value, Whole) else value
        if not isinstance(value, float) or not value.is_integer() or not self.low <= exact <= self.high:
            raise Wrong(pointer, "no whole number in range")


@dataclass
class Word(Any):
    words: tuple[str, ...]

    def check(self, value, pointer):
        if not isinstance(value, str) or value not in self.words:
            raise Wrong(pointer, f"none of {', '.join(self.words)}")


@dataclass
class List(Any):
    item: Any
    length: int | None = None

    def check(self, value, pointer):
        if not isinstance(value, list):
            raise Wrong(pointer, "no array")
        if self.length is not None and len(value) != self.length:
            raise Wrong(pointer, f"not {self.length} values")
        for index, item in enumerate(value):
            self.item.check(item, f"{pointer}/{index}")

    def unknown(self, value, pointer):
        for index, item in enumerate(value):
            yield from self.item.unknown(item, f"{pointer}/{index}")


@dataclass
class Map(Any):
    item: Any

    def check(self, value, pointer):
        if not isinstance(value, dict):
            raise Wrong(pointer, "no object")
        for key in in_order(value):
            self.item.check(value[key], f"{pointer}/{escape(key)}")

    def unknown(self, value, pointer):
        for key in in_order(value):
            yield from self.item.unknown(value[key], f"{pointer}/{escape(key)}")


@dataclass
class Object(Any):
    """Keys with their types; a name that ends in `*` is required."""

    keys: dict[str, Any]

    def __post_init__(self):
        self.required = [name[:-1] for name in self.keys if name.endswith("*")]
        self.types = {name.rstrip("*"): kind for name, kind in self.keys.items()}

    def check(self, value, pointer):
        if not isinstance(value, dict):
            raise Wrong(pointer, "no object")
        for key in in_order(value):
            if key in self.types:
                self.types[key].check(value[key], f"{pointer}/{escape(key)}")
        for key in self.required:
            if key not in value:
                raise Wrong(pointer, f"no {key}")

    def unknown(self, value, pointer):
        for key in in_order(value):
            below = f"{pointer}/{escape(key)}"
            if key in self.types:
                yield from self.types[key].unknown(value[key], below)
            else:
                yield below


def in_order(value: dict) -> list[str]:
    return sorted(value, key=lambda key: key.encode("utf-8"))


def check(kind: Any, value, code: str) -> None:
    """Raise `Refused` with `code` at the first value of the wrong type."""
    try:
        kind.check(value, "")
    except Wrong as wrong:
        raise Refused(code, wrong.pointer, wrong.why) from None


def unknown_keys(kind: Any, value) -> list[str]:
    """Pointers of all unknown keys, depth first, the keys of an object in ascending order of their bytes."""
    return list(kind.unknown(value, ""))


def is_blank(text: str) -> bool:
    """Whether all characters are Unicode's White_Space (htex-1.md section 2)."""
    return not text.strip(WHITE_SPACE)
