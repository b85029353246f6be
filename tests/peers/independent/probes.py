"""Documents with expected verdicts, as JSON Lines: {"kind", "what", "document", "valid", "schema"}.

`valid` is what reading says, `schema` what the kind's JSON Schema says. A manifest is read in a container with an
entry `a.bin` of zeros: three bytes (a `u16` and a `u8`) for each of the three conditions of the probes' manifests. Of a
scene the document alone is read, without its files and device. Of other kinds only the schema's verdict is compared: no
text gives the rest of what a reader of them checks.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections import defaultdict
from pathlib import Path
from typing import Callable

from jsonschema import Draft202012Validator
from jsonschema.exceptions import best_match

from . import limits
from .archive import MIMETYPE
from .asset import read_asset
from .findings import Findings, Refused
from .models import Models
from .scene_document import check_document, read_document

BLOCK_BYTES = 9
START = '{"document":'


def container(manifest: bytes) -> bytes:
    """An asset of a manifest and a block of zeros."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, data in (("mimetype", MIMETYPE), ("manifest.json", manifest), ("a.bin", bytes(BLOCK_BYTES))):
            archive.writestr(zipfile.ZipInfo(name), data)
    return file.getvalue()


def read(kind: str, text: str, models: Models) -> Findings:
    """The findings of this reader in a manifest or scene."""
    data = text.encode("utf-8")
    if kind == "manifest":
        return read_asset(container(data), models)[1]
    findings = Findings()
    try:
        scene = read_document(data, limits.SCENE, findings)
        if scene is not None:
            check_document(scene, limits.SCENE, findings)
    except Refused as refused:
        findings.items.append(refused.finding)
    return findings


class Schemas:
    """The JSON Schemas of a folder, by kind."""

    def __init__(self, folder: Path):
        self.validators = {
            path.name.removesuffix("-1.json"): Draft202012Validator(json.loads(path.read_text("utf-8")))
            for path in folder.glob("*-1.json")
        }

    def problem(self, kind: str, document) -> str | None:
        """What breaks the schema, if anything."""
        error = best_match(self.validators[kind].iter_errors(document))
        return error and f"{error.json_path}: {error.message[:200]}"


def text_of(line: str) -> str:
    """The document of a line as it is written: it is the first key."""
    if not line.startswith(START):
        raise ValueError("a line that does not begin with its document")
    return line[len(START) : json.JSONDecoder().raw_decode(line, len(START))[1]]


def compare_probes(path: Path, models: Models, folder: Path, say: Callable[[str], None]) -> dict[str, tuple[int, int]]:
    """By kind and judge, how many agree, of how many."""
    schemas = Schemas(folder)
    counts: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    for number, line in enumerate(path.read_text("utf-8").split("\n"), 1):
        if not line.strip():
            continue
        probe = json.loads(line)
        kind = probe["kind"]
        problems = {"schema": schemas.problem(kind, probe["document"])}
        if kind in ("manifest", "scene"):
            findings = read(kind, text_of(line), models)
            problems["valid"] = None if findings.valid else str([finding.key() for finding in findings.items])
        for name, problem in problems.items():
            count = counts[f"{kind} by {name}"]
            count[1] += 1
            if (problem is None) == probe[name]:
                count[0] += 1
            else:
                say(f"probes/{kind} by {name}, line {number} ({probe['what']}): {problem or 'valid'}")
    return {name: (agree, total) for name, (agree, total) in counts.items()}
