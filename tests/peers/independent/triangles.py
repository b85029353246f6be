"""Stored triangles: the rules of *Triangles* in htex-1.md section 2.

A fault is a pointer below `triangles`: `/INDEX` for a triangle, or an empty text for all of them.
"""

from __future__ import annotations

import math

from .mesh import orient, sides

Point = tuple[float, float]
Triangle = list[float]
FLAT = 1e-9


def motion_of(condition: dict) -> tuple[float | None, float | None]:
    return condition.get("speed_mm_s"), condition.get("force_n")


def scaled(motions: list[tuple[float, float]]) -> list[Point]:
    """Positions: each axis over its greatest value, or over 1 if that is 0."""
    speed, force = (max(axis, default=0.0) or 1.0 for axis in (zip(*motions) if motions else ((), ())))
    return [(v / speed, f / force) for v, f in motions]


def fault_of_indices(triangles: list[Triangle], count: int) -> str | None:
    """Rule 1: an index that `at` has not, or two equal ones."""
    for number, triangle in enumerate(triangles):
        if len(set(triangle)) < 3 or any(index >= count for index in triangle):
            return f"/{number}"
    return None


def fault_of_cover(points: list[Point], triangles: list[Triangle]) -> str | None:
    """Rules 3 to 5, of known motions."""
    corners = [[int(index) for index in triangle] for triangle in triangles]
    for number, triangle in enumerate(corners):
        if is_flat(*(points[i] for i in triangle)):
            return f"/{number}"
    directed: set[tuple[int, int]] = set()
    for number, (a, b, c) in enumerate(corners):
        # Of two triangles that go around the same way, those on one side of an edge pass it in one direction.
        around = sides((a, b, c) if orient(points[a], points[b], points[c]) > 0 else (a, c, b))
        if any(side in directed for side in around):
            return f"/{number}"
        directed.update(around)
    if {i for triangle in corners for i in triangle} != set(range(len(points))):
        return ""
    outer = [side for side in directed if side[::-1] not in directed]
    return None if is_convex_outline(points, outer) else ""


def is_flat(a: Point, b: Point, c: Point) -> bool:
    """Whether twice the area is at most 1e-9 of the square of the longest side."""
    longest = max((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 for p, q in ((a, b), (b, c), (c, a)))
    return abs(orient(a, b, c)) <= FLAT * longest


def is_convex_outline(points: list[Point], edges: list[tuple[int, int]]) -> bool:
    """Whether edges that go counterclockwise are one outline that turns around once, never to the right."""
    after = dict(edges)
    if not edges or len(after) != len(edges):
        return False
    outline = [edges[0][0]]
    while (following := after.get(outline[-1])) is not None and following != outline[0]:
        if len(outline) > len(edges):
            return False
        outline.append(following)
    if len(outline) != len(edges):
        return False
    turned = 0.0
    for i, corner in enumerate(outline):
        a, b, c = points[outline[i - 1]], points[corner], points[outline[(i + 1) % len(outline)]]
        cross = orient(a, b, c)
        if cross < 0 and not is_flat(a, b, c):
            return False
        turned += math.atan2(cross, (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]))
    return round(turned / (2 * math.pi)) == 1
