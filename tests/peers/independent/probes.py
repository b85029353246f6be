"""Documents with expected verdicts, as JSON Lines: {"kind", "what", "document", "valid", "schema"}.

`schema` is the verdict of the JSON Schema, schemas/KIND-1.json, and is compared for all kinds. `valid` is that of reading, which
this reader has for manifests, in an archive with an entry `a.bin` of nine zero bytes, and for scenes without files.
"""

from __future__ import annotations

import json
import math
from collections import defaultdict
from pathlib import Path
from typing import Callable

from jsonschema import Draft202012Validator
from jsonschema.exceptions import best_match

from . import limits
from .asset import read_entries
from .findings import Findings, Refused
from .models import Models
from .scene_document import accept_document, check_document

# The key of the expected verdict, by judge.
EXPECTED = {"schema": "schema", "reader": "valid"}
JUDGED = ("manifest", "scene")
CONTAINER_OF_PROBES = {"mimetype": b"application/vnd.htex+zip", "a.bin": bytes(9)}


def judge(kind: str, document, models: Models) -> Findings:
    """The verdict of this reader on a manifest or scene."""
    findings = Findings()
    if kind == "manifest":
        text = json.dumps(document).encode()
        read_entries({**CONTAINER_OF_PROBES, "manifest.json": text}, models, limits.ASSET, findings)
        return findings
    try:
        check_text(document)
        check_document(accept_document(document, findings), limits.SCENE, findings)
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


def depth_of(value) -> int:
    """The depth of arrays and objects."""
    if isinstance(value, dict):
        return 1 + max(map(depth_of, value.values()), default=0)
    if isinstance(value, list):
        return 1 + max(map(depth_of, value), default=0)
    return 0


def is_finite(value) -> bool:
    if isinstance(value, float):
        return math.isfinite(value)
    if isinstance(value, dict):
        value = list(value.values())
    return all(map(is_finite, value)) if isinstance(value, list) else True


def load(text: str):
    """JSON whose numbers are all binary64, as in `jsontext`."""
    return json.loads(text, parse_int=float)


def check_text(scene) -> None:
    """What the text of a scene would have been refused for."""
    if depth_of(scene) > limits.SCENE["json_depth"]:
        raise Refused("SCENE_JSON_TOO_DEEP")
    if not is_finite(scene):
        raise Refused("SCENE_JSON_SYNTAX", "", "a number beyond binary64")


def compare_probes(path: Path, models: Models, folder: Path, say: Callable[[str], None]) -> dict[str, tuple[int, int]]:
    """By kind and judge, how many agree, of how many. Manifests and scenes are judged by this reader and their schema."""
    schemas = Schemas(folder)
    counts: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    for number, line in enumerate(path.read_text("utf-8").split("\n"), 1):
        if not line.strip():
            continue
        probe = load(line)
        kind, document = probe["kind"], probe["document"]
        problems = {"schema": schemas.problem(kind, document)}
        if kind in JUDGED:
            findings = judge(kind, document, models)
            problems["reader"] = None if findings.valid else str([finding.key() for finding in findings.items])
        for name, problem in problems.items():
            count = counts[f"{kind} by {name}"]
            count[1] += 1
            if (problem is None) == probe[EXPECTED[name]]:
                count[0] += 1
            else:
                say(f"probes/{kind} by {name}, line {number} ({probe['what']}): {problem or 'valid'}")
    return {name: (agree, total) for name, (agree, total) in counts.items()}
