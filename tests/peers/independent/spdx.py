"""SPDX licence expressions (htex-1.md section 2, `license`; the grammar is SPDX 2.3, annex D).

The lists of ids are those of the package `packaging`.
"""

from __future__ import annotations

import re

from packaging.licenses import _spdx

TOKEN = re.compile(r"\s*([()]|[A-Za-z0-9.\-:+]+)")
IDSTRING = re.compile(r"[A-Za-z0-9.\-]+")
REFERENCE = re.compile(r"(?:DocumentRef-[A-Za-z0-9.\-]+:)?LicenseRef-[A-Za-z0-9.\-]+")
ADDITION = re.compile(r"(?:DocumentRef-[A-Za-z0-9.\-]+:)?AdditionRef-[A-Za-z0-9.\-]+")
WORDS = {"AND", "OR", "WITH", "and", "or", "with"}


class NotAnExpression(ValueError):
    pass


def unknown_ids(expression: str) -> list[str]:
    """The ids that the list lacks; raises `NotAnExpression` where the grammar is broken."""
    return Expression(expression).read()


class Expression:
    def __init__(self, text: str):
        self.tokens, self.at, self.unknown = [], 0, []
        position = 0
        while text[position:].strip():
            match = TOKEN.match(text, position)
            if not match:
                raise NotAnExpression(text)
            self.tokens.append(match.group(1))
            position = match.end()

    def peek(self) -> str:
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def take(self) -> str:
        token = self.peek()
        self.at += 1
        return token

    def read(self) -> list[str]:
        self.compound()
        if self.at != len(self.tokens):
            raise NotAnExpression(self.peek())
        return self.unknown

    def compound(self) -> None:
        """OR and AND differ in precedence only, which no rule of the text needs."""
        self.simple()
        while self.peek() in ("AND", "OR", "and", "or"):
            self.take()
            self.simple()

    def simple(self) -> None:
        token = self.take()
        if token == "(":
            self.compound()
            if self.take() != ")":
                raise NotAnExpression("no closing bracket")
            return
        if token in WORDS or not token:
            raise NotAnExpression(token)
        if not REFERENCE.fullmatch(token):
            plain = token[:-1] if token.endswith("+") else token
            if not IDSTRING.fullmatch(plain):
                raise NotAnExpression(token)
            known = _spdx.LICENSES.get(plain.lower())
            if (known is None or known["id"] != plain) and not self.known_with_plus(token):
                self.unknown.append(token)
        if self.peek() in ("WITH", "with"):
            self.take()
            self.exception(self.take())

    @staticmethod
    def known_with_plus(token: str) -> bool:
        known = _spdx.LICENSES.get(token.lower())
        return known is not None and known["id"] == token

    def exception(self, token: str) -> None:
        if ADDITION.fullmatch(token):
            return
        if token in WORDS or not IDSTRING.fullmatch(token):
            raise NotAnExpression(token)
        known = _spdx.EXCEPTIONS.get(token.lower())
        if known is None or known["id"] != token:
            self.unknown.append(token)
