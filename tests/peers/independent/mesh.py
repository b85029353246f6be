"""The triangles over the positions of conditions (htex-playing-1.md section 4, 2 to 4).

Predicates are exact: positions are binary64 and are taken as fractions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from .axes import same

Point = tuple[float, float]
HALF_TURN_WITHIN = 1e-9
INSIDE = -1e-12


def orient(a, b, c) -> Fraction:
    """Twice the signed area of a, b, c."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def in_circle(a, b, c, d) -> Fraction:
    """Above 0 where d is inside the circle through a, b, c (counter-clockwise)."""
    rows = [(p[0] - d[0], p[1] - d[1]) for p in (a, b, c)]
    (ax, ay), (bx, by), (cx, cy) = rows
    a2, b2, c2 = (x * x + y * y for x, y in rows)
    return ax * (by * c2 - b2 * cy) - ay * (bx * c2 - b2 * cx) + a2 * (bx * cy - by * cx)


@dataclass
class Edge:
    """An edge of the hull: its conditions with the parts of its length at which their feet are."""

    ends: tuple[int, int]
    feet: list[tuple[float, int]]


class Mesh:
    def __init__(self, points: list[Point], stored: list[tuple[int, int, int]] | None = None):
        """Delaunay's triangles over `points`, or those that are `stored`, which are valid."""
        self.points = points
        self.exact = [(Fraction(x), Fraction(y)) for x, y in points]
        self.triangles: list[tuple[int, int, int]] = []
        self.edge_of: dict[tuple[int, int, int], Edge] = {}
        self.edges: list[Edge] = []
        if stored is not None:
            self.triangles = [counterclockwise(self.exact, triangle) for triangle in stored]
            self.edges = [Edge(ends, [(0.0, ends[0]), (1.0, ends[1])]) for ends in self.outer_edges()]
        elif self.on_one_line():
            order = sorted(range(len(points)), key=lambda i: points[i])
            edge = Edge((order[0], order[-1]), [])
            edge.feet = [(self.foot(edge.ends, points[i]), i) for i in order]
            self.edges = [edge]
        else:
            self.triangles = self.fans()
            self.find_hull()

    def on_one_line(self) -> bool:
        p = self.exact
        if len(p) < 3:
            return True
        other = next((q for q in p if q != p[0]), None)
        return other is None or all(orient(p[0], other, q) == 0 for q in p)

    # Delaunay's triangulation, as cells of positions that lie on one circle.

    def cells(self) -> list[list[int]]:
        """Cells of exactly cocircular positions, counter-clockwise."""
        p, count = self.exact, len(self.points)
        first = min(range(count), key=lambda i: p[i])
        others = [i for i in range(count) if i != first]
        second = others[0]
        for i in others[1:]:
            turn = orient(p[first], p[second], p[i])
            if turn < 0 or turn == 0 and self.distance2(first, i) < self.distance2(first, second):
                second = i
        todo, done, cells = [(first, second)], set(), []
        while todo:
            a, b = todo.pop()
            if (a, b) in done:
                continue
            left = [c for c in range(count) if c not in (a, b) and orient(p[a], p[b], p[c]) > 0]
            if not left:
                continue
            best = left[0]
            for c in left[1:]:
                if in_circle(p[a], p[b], p[best], p[c]) > 0:
                    best = c
            cell = [c for c in range(count) if c in (a, b, best) or in_circle(p[a], p[b], p[best], p[c]) == 0]
            cell = self.around(cell)
            cells.append(cell)
            for i, corner in enumerate(cell):
                following = cell[(i + 1) % len(cell)]
                done.add((corner, following))
                todo.append((following, corner))
        return cells

    def distance2(self, i: int, j: int) -> Fraction:
        (ax, ay), (bx, by) = self.exact[i], self.exact[j]
        return (ax - bx) ** 2 + (ay - by) ** 2

    def around(self, cell: list[int]) -> list[int]:
        """Corners of a convex polygon, counter-clockwise."""
        x = sum(self.points[i][0] for i in cell) / len(cell)
        y = sum(self.points[i][1] for i in cell) / len(cell)
        return sorted(cell, key=lambda i: math.atan2(self.points[i][1] - y, self.points[i][0] - x))

    def fans(self) -> list[tuple[int, int, int]]:
        """Merge cells whose opposite angles sum to half a turn, and replace each by its fan."""
        cells = self.cells()
        side = {edge: index for index, cell in enumerate(cells) for edge in sides(cell)}
        group = list(range(len(cells)))
        for (a, b), index in side.items():
            other = side.get((b, a))
            if other is None or other < index:
                continue
            angles = self.opposite(cells[index], a, b) + self.opposite(cells[other], a, b)
            if abs(angles - math.pi) <= HALF_TURN_WITHIN:
                old, new = group[other], group[index]
                group = [new if g == old else g for g in group]
        triangles = []
        for name in sorted(set(group)):
            members = [cell for cell, g in zip(cells, group) if g == name]
            edges = {edge for cell in members for edge in sides(cell)}
            outline = [edge for edge in edges if edge[::-1] not in edges]
            corners = {i for edge in outline for i in edge}
            apex = min(corners, key=lambda i: self.points[i])
            fan = [(apex, a, b) for a, b in outline if apex not in (a, b)]
            if any(orient(*(self.exact[i] for i in t)) <= 0 for t in fan):
                fan = []
                for cell in members:
                    top = min(cell, key=lambda i: self.points[i])
                    fan += [(top, a, b) for a, b in sides(cell) if top not in (a, b)]
            triangles += fan
        return sorted(triangles)

    def opposite(self, cell: list[int], a: int, b: int) -> float:
        """The angle opposite the side a, b of a cell (the same at all other corners)."""
        c = next(i for i in cell if i not in (a, b))
        (cx, cy), (ax, ay), (bx, by) = self.points[c], self.points[a], self.points[b]
        ux, uy, vx, vy = ax - cx, ay - cy, bx - cx, by - cy
        return math.atan2(abs(ux * vy - uy * vx), ux * vx + uy * vy)

    # Step 3: conditions that belong to an edge of the hull.

    def outer_edges(self) -> list[tuple[int, int]]:
        """Sides of one triangle only: by their lower conditions, then by the higher ones."""
        found = {side for triangle in self.triangles for side in sides(triangle)}
        outer = [side for side in found if side[::-1] not in found]
        return sorted(outer, key=lambda side: sorted(self.points[i] for i in side))

    def find_hull(self) -> None:
        at = {edge: triangle for triangle in self.triangles for edge in sides(triangle)}
        for a, b in self.outer_edges():
            edge = Edge((a, b), [(0.0, a), (1.0, b)])
            self.edges.append(edge)
            self.absorb(edge, at, (a, b), (0.0, 1.0))
            edge.feet.sort()

    def absorb(self, edge: Edge, at: dict, side: tuple[int, int], span: tuple[float, float]) -> None:
        """Add the corner opposite `side` to `edge`, if it belongs to it, and those behind it."""
        triangle = at.get(side)
        if triangle is None or triangle in self.edge_of:
            return
        corner = next(i for i in triangle if i not in side)
        part = self.foot(edge.ends, self.points[corner])
        if not span[0] < part < span[1]:
            return
        place = self.along(edge.ends, part)
        if not all(same(x, y) for x, y in zip(self.points[corner], place)):
            return
        self.edge_of[triangle] = edge
        edge.feet.append((part, corner))
        self.absorb(edge, at, (side[0], corner), (span[0], part))
        self.absorb(edge, at, (corner, side[1]), (part, span[1]))

    def foot(self, ends: tuple[int, int], point: Point) -> float:
        """The part of the edge's length at which the foot of `point` is; not clamped."""
        (ax, ay), (bx, by) = self.points[ends[0]], self.points[ends[1]]
        dx, dy = bx - ax, by - ay
        length2 = dx * dx + dy * dy
        return ((point[0] - ax) * dx + (point[1] - ay) * dy) / length2 if length2 else 0.0

    def along(self, ends: tuple[int, int], part: float) -> Point:
        (ax, ay), (bx, by) = self.points[ends[0]], self.points[ends[1]]
        return ax + part * (bx - ax), ay + part * (by - ay)

    # Step 4: weights.

    def weights(self, point: Point) -> tuple[dict[int, float], Point | None]:
        """Weights of conditions, and the foot on the nearest edge where the motion is in no triangle."""
        best, inside = None, INSIDE
        for triangle in self.triangles:
            parts = self.barycentric(triangle, point)
            if min(parts) >= inside:
                best, inside = (triangle, parts), min(parts)
        if best is not None:
            triangle, parts = best
            if triangle in self.edge_of:
                edge = self.edge_of[triangle]
                return self.on_edge(edge, self.foot(edge.ends, point)), None
            return {i: max(part, 0.0) for i, part in zip(triangle, parts)}, None
        nearest = None
        for edge in self.edges:
            part = min(max(self.foot(edge.ends, point), 0.0), 1.0)
            place = self.along(edge.ends, part)
            distance = math.hypot(place[0] - point[0], place[1] - point[1])
            if nearest is None or distance < nearest[0]:
                nearest = (distance, edge, part, place)
        _, edge, part, place = nearest
        return self.on_edge(edge, part), place

    def barycentric(self, triangle: tuple[int, int, int], point: Point) -> list[float]:
        p = [self.exact[i] for i in triangle]
        q = (Fraction(point[0]), Fraction(point[1]))
        area = orient(*p)
        return [
            float(orient(q, p[1], p[2]) / area),
            float(orient(p[0], q, p[2]) / area),
            float(orient(p[0], p[1], q) / area),
        ]

    @staticmethod
    def on_edge(edge: Edge, part: float) -> dict[int, float]:
        """Weights between the neighbouring feet."""
        feet = edge.feet
        if part <= feet[0][0]:
            return {feet[0][1]: 1.0}
        for (before, i), (after, j) in zip(feet, feet[1:]):
            if part <= after:
                share = (part - before) / (after - before)
                return {i: 1.0 - share, j: share}
        return {feet[-1][1]: 1.0}


def counterclockwise(exact, triangle) -> tuple[int, int, int]:
    a, b, c = triangle
    return (a, b, c) if orient(exact[a], exact[b], exact[c]) > 0 else (a, c, b)


def sides(cell) -> list[tuple[int, int]]:
    return [(cell[i], cell[(i + 1) % len(cell)]) for i in range(len(cell))]
