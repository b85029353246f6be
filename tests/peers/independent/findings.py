"""Findings and reports (htex-reports-1.md)."""

from __future__ import annotations

from dataclasses import dataclass, field

MAX_FINDINGS = 100

WARNINGS = frozenset(
    """ENTRY_UNREFERENCED JSON_UNKNOWN_KEY LICENSE_UNKNOWN LICENSE_MISSING SOURCE_PATH PLUGIN_UNUSED
    EXTENSION_NAME_INVALID
    TRACE_ASSUMED DURATION_BEYOND_TRACE MOTION_BEYOND_RECORDED RESPONSE_RAISED DEVICE_PATH_UNUSED
    DEVICE_HARDWARE DEVICE_ABSENT
    RECORDING_CLOCK_GAP RECORDING_CLOCK_JITTER RECORDING_COARSE RECORDING_SILENT RECORDING_SPIKE
    RECORDING_FORCE_OUTLIER RECORDING_FRICTION_COEFFICIENT RECORDING_SPEED_IMPLAUSIBLE
    RECORDING_ABOVE_BAND RECORDING_LEVELS_DIFFER
    RECORDING_OFF_TARGET RECORDING_UNSTEADY RECORDING_UNEVEN GRID_NOT_BETTER""".split()
)
INFOS = frozenset(
    """VERSION_NEWER FINDINGS_TRUNCATED SCENE_VERSION_NEWER LIBRARY_VERSION_NEWER
    RECORDING_SWEEPS_CUT_OFF RECORDING_READ_IN_WINDOWS RECORDING_NOTED""".split()
)


def severity_of(code: str) -> str:
    """The severity of a rule, from the tables of the three files of findings."""
    if code in WARNINGS:
        return "warning"
    return "info" if code in INFOS else "error"


@dataclass(frozen=True)
class Finding:
    code: str
    pointer: str = ""
    message: str = ""

    @property
    def severity(self) -> str:
        return severity_of(self.code)

    def key(self) -> tuple[str, str, str]:
        return (self.code, self.severity, self.pointer)


@dataclass
class Findings:
    """A list of findings, with the bookkeeping that stages need."""

    items: list[Finding] = field(default_factory=list)

    def add(self, code: str, pointer: str = "", message: str = "") -> None:
        self.items.append(Finding(code, pointer, message))

    def has_errors(self) -> bool:
        return any(f.severity == "error" for f in self.items)

    @property
    def valid(self) -> bool:
        return not self.has_errors()

    def reported(self) -> list[Finding]:
        """The findings of a report: the first hundred, then FINDINGS_TRUNCATED."""
        if len(self.items) <= MAX_FINDINGS:
            return list(self.items)
        return self.items[:MAX_FINDINGS] + [Finding("FINDINGS_TRUNCATED")]


class Refused(Exception):
    """One finding that ends what is being read."""

    def __init__(self, code: str, pointer: str = "", message: str = ""):
        super().__init__(f"{code} {pointer} {message}")
        self.finding = Finding(code, pointer, message)


def escape(part: str | int) -> str:
    """One reference token of a JSON pointer (RFC 6901)."""
    return str(part).replace("~", "~0").replace("/", "~1")
