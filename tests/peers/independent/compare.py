"""Comparison with the expected reports of a conformance folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Callable

from .findings import Findings
from .recording import read_recording

# A reader has as many as it has assumptions (recording-findings.md).
NOT_COMPARED = {"RECORDING_NOTED"}

Validator = Callable[[Path, dict], Findings]


def compare_folder(folder: Path, suffix: str, validate: Validator, say: Callable[[str], None]) -> tuple[int, int]:
    """Validate each file that has a report; how many agree, of how many."""
    agree = total = 0
    for report_path in sorted(folder.glob("*.report.json")):
        report = json.loads(report_path.read_text("utf-8"))
        name = report_path.name[: -len(".report.json")]
        findings = validate(folder / (name + suffix), report.get("limits", {}))
        ours = [finding.key() for finding in findings.reported()]
        theirs = [(f["code"], f["severity"], f["pointer"]) for f in report["findings"]]
        ours, theirs = ([key for key in keys if key[0] not in NOT_COMPARED] for keys in (ours, theirs))
        total += 1
        if ours == theirs and findings.valid == report["valid"]:
            agree += 1
        else:
            say(f"{folder.name}/{name}: ours {ours}, expected {theirs}")
    return agree, total


def compare_recordings(folder: Path, say: Callable[[str], None]) -> tuple[int, int]:
    """The same for recordings, whose reports have the arguments of the command."""

    def validate(path: Path, _limits: dict) -> Findings:
        report = json.loads(path.with_suffix(".report.json").read_text("utf-8"))
        arguments = dict(zip(report["arguments"][::2], report["arguments"][1::2]))
        speed, force = arguments.get("--speed"), arguments.get("--force")
        return read_recording(path, float(speed) if speed else None, float(force) if force else None)

    return compare_folder(folder, ".csv", validate, say)
