"""Descriptors of the models of the specification (the folder `models`)."""

from __future__ import annotations

import json
from pathlib import Path

Models = dict[str, dict]


def read_models(spec: Path) -> Models:
    descriptors = [json.loads(path.read_text("utf-8")) for path in sorted((spec / "models").glob("*.json"))]
    return {descriptor["id"]: descriptor for descriptor in descriptors}
