"""Traces of motions (scene-1.md section 3)."""

from __future__ import annotations

from .table import NotATable, read_table

LEAST_STEP_S = 1e-9
FARTHEST = 1e9
MOST_NUMBERS = 40_000_000
PLACES = ("pos_{}", "{}_pos", "position_{}", "{}_position", "finger_{}")
LENGTHS = {"mm": 1.0, "um": 1e-3, "cm": 10.0, "m": 1e3}
# column: (its names without a unit, units with their factors, the first of which is assumed)
COLUMNS = {
    "t_s": (("t", "time", "timestamp", "elapsed"), {"s": 1.0, "ms": 1e-3, "us": 1e-6}),
    "x_mm": (("x", *(name.format("x") for name in PLACES)), LENGTHS),
    "y_mm": (("y", *(name.format("y") for name in PLACES)), LENGTHS),
    "force_n": (
        "force force_z z_force fz f_z fn f_n normal normal_force force_normal f_normal load".split(),
        {"n": 1.0, "un": 1e-6, "mn": 1e-3, "kn": 1e3},
    ),
    "speed_mm_s": (
        "speed velocity vel finger_speed sliding_speed scan_speed".split(),
        {"mm_s": 1.0, "mm/s": 1.0, "cm_s": 10.0, "cm/s": 10.0, "m_s": 1e3, "m/s": 1e3},
    ),
}
REQUIRED = ("t_s", "x_mm", "y_mm", "force_n")


def spellings() -> dict[str, tuple[str, float, bool]]:
    """By name: the column, the factor of its unit, and whether the unit is assumed."""
    result = {}
    for column, (names, units) in COLUMNS.items():
        for name in names:
            result[name] = (column, 1.0, True)
            for unit, factor in units.items():
                for written in (f"_{unit}", f"[{unit}]", f"_[{unit}]", f"({unit})", f"_({unit})"):
                    result[name + written] = (column, factor, False)
    return result


SPELLINGS = spellings()


def spelling(name: str) -> tuple[str, float, bool] | None:
    return SPELLINGS.get(name.lower().replace(" ", "_").replace("-", "_"))


def read_trace(data: bytes) -> tuple[dict[str, list[float]], list[str]]:
    """The columns of a trace in the units of their names, and what was assumed of them."""
    names, values = read_table(data, lambda name: spelling(name) is not None)
    columns: dict[str, list[float]] = {}
    assumptions, unused = [], []
    for name, numbers in zip(names, values):
        found = spelling(name)
        if found is None:
            unused.append(name)
            continue
        column, factor, assumed = found
        if column in columns:
            raise NotATable(f"two columns of {column}")
        columns[column] = [factor * number for number in numbers]
        if assumed:
            assumptions.append(f"{name} is read as {column}")
    if unused:
        assumptions.append(f"not used: {', '.join(unused)}")
    if any(name not in columns for name in REQUIRED):
        raise NotATable("a column is missing")
    times = columns["t_s"]
    if len(times) < 2 or any(b - a < LEAST_STEP_S for a, b in zip(times, times[1:])):
        raise NotATable("fewer than two rows, or times that do not ascend by 1 ns")
    if sum(map(len, columns.values())) > MOST_NUMBERS or any(abs(x) > FARTHEST for c in columns.values() for x in c):
        raise NotATable("too many numbers, or one beyond 1e9")
    return columns, assumptions
