"""Triangles that a representation stores (htex-1.md section 2, *Triangles*, and section 11, *Stored triangles*)."""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction

FLAT = Fraction(1, 10**9)

Point = tuple[Fraction, Fraction]
Triangle = tuple[int, int, int]


def places(motions: list[tuple[float, float]]) -> list[Point]:
    """Speed and force, each divided by the greatest value of all."""
    greatest = [max(Fraction(motion[axis]) for motion in motions) or Fraction(1) for axis in (0, 1)]
    return [(Fraction(v) / greatest[0], Fraction(f) / greatest[1]) for v, f in motions]


def turn(a: Point, b: Point, c: Point) -> Fraction:
    """Twice the signed area of a, b, c."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def is_flat(a: Point, b: Point, c: Point) -> bool:
    longest2 = max((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 for p, q in ((a, b), (b, c), (c, a)))
    return abs(turn(a, b, c)) <= FLAT * longest2


def counterclockwise(triangle: Triangle, at: list[Point]) -> Triangle:
    a, b, c = triangle
    return triangle if turn(at[a], at[b], at[c]) > 0 else (a, c, b)


def sides(triangle: Triangle) -> list[tuple[int, int]]:
    a, b, c = triangle
    return [(a, b), (b, c), (c, a)]


def wrong_corner(triangles: list[list[int]], count: int) -> int | None:
    """Rule 1: the first triangle with an index that `at` has not, or with two equal ones."""
    for number, triangle in enumerate(triangles):
        if len(set(triangle)) < 3 or not all(0 <= corner < count for corner in triangle):
            return number
    return None


def wrong_triangle(triangles: list[Triangle], at: list[Point]) -> int | None:
    """Rules 3 and 4: the first flat triangle, else the first on the same side of an edge as an earlier one."""
    for number, (a, b, c) in enumerate(triangles):
        if is_flat(at[a], at[b], at[c]):
            return number
    taken: set[tuple[int, int]] = set()
    for number, triangle in enumerate(triangles):
        own = sides(counterclockwise(triangle, at))
        if taken.intersection(own):
            return number
        taken.update(own)
    return None


def outer_edges(triangles: list[Triangle], at: list[Point]) -> list[tuple[int, int]]:
    """The edges of one triangle only, counterclockwise around it."""
    directed = [side for triangle in triangles for side in sides(counterclockwise(triangle, at))]
    both = set(directed)
    return [(a, b) for a, b in directed if (b, a) not in both]


def covers_once(triangles: list[Triangle], at: list[Point]) -> bool:
    """Rule 5: every condition is a corner, and the outer edges are one convex outline that turns around once."""
    if {corner for triangle in triangles for corner in triangle} != set(range(len(at))):
        return False
    following = dict(outer := outer_edges(triangles, at))
    ends = Counter(b for _, b in outer)
    if len(following) != len(outer) or any(count > 1 for count in ends.values()):
        return False
    start = corner = outer[0][0]
    turned, passed = 0.0, 0
    while True:
        middle = following[corner]
        after = following[middle]
        way = turn(at[corner], at[middle], at[after])
        if way < 0 and not is_flat(at[corner], at[middle], at[after]):
            return False
        dx, dy = (float(at[middle][i] - at[corner][i]) for i in (0, 1))
        ex, ey = (float(at[after][i] - at[middle][i]) for i in (0, 1))
        turned += math.atan2(dx * ey - dy * ex, dx * ex + dy * ey)
        corner, passed = middle, passed + 1
        if corner == start:
            break
    return passed == len(outer) and round(turned / math.tau) == 1


class StoredMesh:
    """Stored triangles, in which a player interpolates in place of Delaunay's."""

    def __init__(self, triangles: list[list[int]], motions: list[tuple[float, float]]):
        self.exact = places(motions)
        self.points = [(float(x), float(y)) for x, y in self.exact]
        self.triangles = [counterclockwise((int(a), int(b), int(c)), self.exact) for a, b, c in triangles]
        self.outer = outer_edges(self.triangles, self.exact)

    def weights(self, point: tuple[float, float]) -> tuple[dict[int, float], tuple[float, float] | None]:
        """Weights of conditions, and the nearest point of the outer edges where the motion is in no triangle."""
        q = (Fraction(point[0]), Fraction(point[1]))
        for triangle in self.triangles:
            a, b, c = (self.exact[i] for i in triangle)
            parts = (turn(q, b, c), turn(q, c, a), turn(q, a, b))
            if min(parts) >= 0:
                return {i: float(part / turn(a, b, c)) for i, part in zip(triangle, parts)}, None
        nearest = None
        for i, j in self.outer:
            a, b = self.exact[i], self.exact[j]
            along = (b[0] - a[0], b[1] - a[1])
            foot = ((q[0] - a[0]) * along[0] + (q[1] - a[1]) * along[1]) / (along[0] ** 2 + along[1] ** 2)
            foot = min(max(foot, Fraction(0)), Fraction(1))
            place = (a[0] + foot * along[0], a[1] + foot * along[1])
            distance2 = (place[0] - q[0]) ** 2 + (place[1] - q[1]) ** 2
            if nearest is None or distance2 < nearest[0]:
                nearest = (distance2, {i: float(1 - foot), j: float(foot)}, place)
        _, weights, place = nearest
        return weights, (float(place[0]), float(place[1]))
