"""Positions of motions on the axes of speed and force (htex-playing-1.md section 4, 1)."""

from __future__ import annotations

from dataclasses import dataclass

SAME = 0.05
AT_GROUP = 1e-9


def same(a: float, b: float) -> bool:
    """Two speeds, or two forces, are the same within 5 % of the larger one."""
    return abs(a - b) <= SAME * max(abs(a), abs(b))


@dataclass(frozen=True)
class Group:
    low: float
    high: float
    position: float


class Axis:
    """The values of an axis, in groups; an absent one counts as 0."""

    def __init__(self, values: list[float | None], grouped: bool):
        ascending = sorted({value or 0.0 for value in values})
        greatest = ascending[-1]
        self.complete = greatest > 0 and None not in values
        groups: list[list[float]] = []
        for value in ascending:
            if grouped and groups and same(value, groups[-1][0]):
                groups[-1].append(value)
            else:
                groups.append([value])
        self.scale = greatest or 1.0
        self.groups = [Group(g[0], g[-1], (g[0] + g[-1]) / 2 / self.scale) for g in groups]

    def position(self, value: float | None) -> float:
        """The position of a value; an absent one counts as 0."""
        value = value or 0.0
        first, last = self.groups[0], self.groups[-1]
        if value < first.low:
            return first.position - (first.low - value) / self.scale
        if value > last.high:
            return last.position + (value - last.high) / self.scale
        previous = None
        for group in self.groups:
            if value < group.low:
                part = (value - previous.high) / (group.low - previous.high)
                return previous.position + part * (group.position - previous.position)
            if value <= group.high:
                return group.position
            previous = group
        raise AssertionError("a value between the groups")

    def nearest(self, position: float, value: float) -> float:
        """The value nearest to `value` whose position is `position`."""
        for group in self.groups:
            if abs(position - group.position) <= AT_GROUP:
                return min(max(value, group.low), group.high)
        if position < self.groups[0].position:
            return self.groups[0].low
        for before, after in zip(self.groups, self.groups[1:]):
            if position < after.position:
                part = (position - before.position) / (after.position - before.position)
                return before.high + part * (after.low - before.high)
        return self.groups[-1].high


class StoredAxis:
    """The axis of stored triangles: values over the greatest, in no groups (*Stored triangles*)."""

    def __init__(self, values: list[float]):
        greatest = max(values)
        self.complete = greatest > 0
        self.scale = greatest or 1.0

    def position(self, value: float) -> float:
        return value / self.scale

    def nearest(self, position: float, _value: float) -> float:
        return position * self.scale
