"""SPDX licence expressions (htex-1.md section 2, *Licence*: the grammar of SPDX 3.0).

The list of ids is `spdx-ids.txt`; lists of readers may differ, since SPDX's grows.
"""

from __future__ import annotations

import re
from pathlib import Path

TOKEN = re.compile(r"\s*([()]|[A-Za-z0-9.\-:+]+)", re.ASCII)
ID = re.compile(r"[A-Za-z0-9.\-]+")
REFERENCE = re.compile(r"(?:DocumentRef-[A-Za-z0-9.\-]+:)?LicenseRef-[A-Za-z0-9.\-]+")
ADDITION = re.compile(r"(?:DocumentRef-[A-Za-z0-9.\-]+:)?AdditionRef-[A-Za-z0-9.\-]+")
# A part that begins so is a reference or nothing.
REFERENCES = ("LicenseRef-", "AdditionRef-", "DocumentRef-")
WORDS = {"AND", "OR", "WITH", "and", "or", "with"}
GNU = re.compile(r"(?:AGPL|GFDL|GPL|LGPL)-")


def read_ids() -> tuple[frozenset[str], frozenset[str]]:
    """Ids of licences and of exceptions."""
    lines = Path(__file__).with_name("spdx-ids.txt").read_text("ascii").split("\n", 1)[1]
    licences, exceptions = lines.split("\n\n")
    # Some deprecated ids of the list end in `+`, which no id of the grammar does.
    return frozenset(filter(ID.fullmatch, licences.split())), frozenset(exceptions.split())


LICENCES, EXCEPTIONS = read_ids()


class NotAnExpression(ValueError):
    pass


def first_unknown_id(expression: str) -> str | None:
    """The first id that the list lacks; raises `NotAnExpression` where the grammar is broken."""
    unknown = Expression(expression).read()
    return unknown[0] if unknown else None


class Expression:
    def __init__(self, text: str):
        self.tokens, self.at, self.unknown = [], 0, []
        position, end = 0, len(text.rstrip(" \t\n\r\f\v"))
        while position < end:
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
        self.licence(token)
        if self.peek() in ("WITH", "with"):
            self.take()
            self.exception(self.take())

    def licence(self, token: str) -> None:
        if REFERENCE.fullmatch(token) or token in LICENCES:
            return
        if token.endswith("+"):
            if token[:-1] not in LICENCES or GNU.match(token):
                raise NotAnExpression(token)
        else:
            self.check_id(token)
            self.unknown.append(token)

    def exception(self, token: str) -> None:
        if ADDITION.fullmatch(token):
            return
        self.check_id(token)
        if token not in EXCEPTIONS:
            self.unknown.append(token)

    @staticmethod
    def check_id(token: str) -> None:
        if token in WORDS or token.startswith(REFERENCES) or not ID.fullmatch(token):
            raise NotAnExpression(token)
