"""JSON as htex reads it (htex-1.md section 2, htex-reports-1.md section 4): strict, with duplicate keys refused.

The result has dict, list, str, float, bool and None. Every number is a float (binary64), and a `Whole` if it is of
digits alone and binary64 does not have it. The first error in the order of the text is raised as `Refused` with the
code SYNTAX, TYPE, TOO_DEEP or TOO_LARGE, to which a caller adds its prefix.
"""

from __future__ import annotations

import math
import re

from .findings import Refused, escape

NUMBER = re.compile(r"-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?")
PLAIN = re.compile(r'[^"\\\x00-\x1f]*')
SPACE = re.compile(r"[ \t\n\r]*")
HEX4 = re.compile(r"[0-9a-fA-F]{4}")
ESCAPES = {'"': '"', "\\": "\\", "/": "/", "b": "\b", "f": "\f", "n": "\n", "r": "\r", "t": "\t"}


def parse(data: bytes, depth_limit: int, prefix: str = "JSON_", nodes: int | None = None):
    """Parse `data`, or raise `Refused` with `prefix` + SYNTAX, TOO_DEEP, TOO_LARGE or TYPE."""
    depth, count = size_of(data)
    if depth > depth_limit:
        raise Refused(prefix + "TOO_DEEP")
    if nodes is not None and count > nodes:
        raise Refused(prefix + "TOO_LARGE")
    complete = True
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        # What precedes the first wrong byte is still read: a key may appear twice there.
        text, complete = data[: error.start].decode("utf-8"), False
    value = Parser(text, prefix).document()
    if not complete:
        raise Refused(prefix + "SYNTAX", "", "not UTF-8")
    return value


def size_of(data: bytes) -> tuple[int, int]:
    """The depth of brackets outside strings, and how many brackets open and commas are there, without parsing."""
    depth = deepest = nodes = 0
    in_string = skip = False
    for byte in data:
        if skip:
            skip = False
        elif in_string:
            if byte == 0x5C:
                skip = True
            elif byte == 0x22:
                in_string = False
        elif byte == 0x22:
            in_string = True
        elif byte in (0x5B, 0x7B):
            depth += 1
            nodes += 1
            deepest = max(deepest, depth)
        elif byte in (0x5D, 0x7D):
            # One that closes nothing is no JSON, which is found later.
            depth = max(depth - 1, 0)
        elif byte == 0x2C:
            nodes += 1
    return deepest, nodes


class Whole(float):
    """A number of digits alone that binary64 does not have; `written` is what was written (htex-1.md section 2)."""

    def __new__(cls, written: int):
        number = super().__new__(cls, written)
        number.written = written
        return number


def number_of(text: str) -> float:
    """The binary64 of a JSON number, infinite beyond them."""
    number = float(text)
    digits = text.lstrip("-")
    if digits.isdigit() and len(digits) < 400 and math.isfinite(number) and int(text) != number:
        return Whole(int(text))
    return number


class Parser:
    def __init__(self, text: str, prefix: str):
        self.text, self.prefix, self.at = text, prefix, 0

    def fail(self, why: str):
        raise Refused(self.prefix + "SYNTAX", "", f"{why} at character {self.at}")

    def space(self) -> str:
        """Skip white space; the next character, or '' at the end."""
        self.at = SPACE.match(self.text, self.at).end()
        return self.text[self.at : self.at + 1]

    def document(self):
        value = self.value("")
        if self.space():
            self.fail("more after the value")
        return value

    def value(self, pointer: str):
        char = self.space()
        if char == "{":
            return self.object(pointer)
        if char == "[":
            return self.array(pointer)
        if char == '"':
            return self.string()
        for word, meaning in (("true", True), ("false", False), ("null", None)):
            if self.text.startswith(word, self.at):
                self.at += len(word)
                return meaning
        match = NUMBER.match(self.text, self.at)
        if not match:
            self.fail("no value")
        number = number_of(match.group())
        if not math.isfinite(number):
            self.fail("a number beyond binary64")
        self.at = match.end()
        return number

    def object(self, pointer: str) -> dict:
        result: dict = {}
        self.at += 1
        if self.space() == "}":
            self.at += 1
            return result
        while True:
            if self.space() != '"':
                self.fail("no key")
            key = self.string()
            if key in result:
                raise Refused(self.prefix + "TYPE", f"{pointer}/{escape(key)}", "a key twice")
            if self.space() != ":":
                self.fail("no colon")
            self.at += 1
            result[key] = self.value(f"{pointer}/{escape(key)}")
            char = self.space()
            self.at += 1
            if char == "}":
                return result
            if char != ",":
                self.fail("no comma")

    def array(self, pointer: str) -> list:
        result: list = []
        self.at += 1
        if self.space() == "]":
            self.at += 1
            return result
        while True:
            result.append(self.value(f"{pointer}/{len(result)}"))
            char = self.space()
            self.at += 1
            if char == "]":
                return result
            if char != ",":
                self.fail("no comma")

    def string(self) -> str:
        self.at += 1
        parts = []
        while True:
            match = PLAIN.match(self.text, self.at)
            parts.append(match.group())
            self.at = match.end()
            char = self.text[self.at : self.at + 1]
            if char == '"':
                self.at += 1
                return "".join(parts)
            if char != "\\":
                self.fail("a string that does not end, or a control character")
            escaped = self.text[self.at + 1 : self.at + 2]
            if escaped == "u":
                self.at += 2
                parts.append(self.unicode())
            elif escaped in ESCAPES and escaped:
                parts.append(ESCAPES[escaped])
                self.at += 2
            else:
                self.fail("an unknown escape")

    def unicode(self) -> str:
        code = self.hex4()
        if 0xD800 <= code < 0xDC00 and self.text.startswith("\\u", self.at):
            self.at += 2
            low = self.hex4()
            if 0xDC00 <= low < 0xE000:
                return chr(0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00))
            self.fail("half of a surrogate pair")
        if 0xD800 <= code < 0xE000:
            self.fail("half of a surrogate pair")
        return chr(code)

    def hex4(self) -> int:
        match = HEX4.match(self.text, self.at)
        if not match:
            self.fail("no four hexadecimal digits")
        self.at = match.end()
        return int(match.group(), 16)
