"""`python conformance_reader.py PART FILE [OPTIONS]`: the independent reader, as spec/conformance-protocol.md asks."""

from __future__ import annotations

import json
import sys
from pathlib import Path

SPEC = Path(__file__).resolve().parents[2] / "spec"


def reported(findings) -> dict:
    return {
        "verdict": "valid" if findings.valid else "invalid",
        "findings": [{"code": one.key()[0], "pointer": one.key()[2]} for one in findings.reported()],
    }


def assets(path: Path, options: dict) -> dict:
    from independent.asset import read_asset
    from independent.models import read_models

    return reported(read_asset(path.read_bytes(), read_models(SPEC), options.get("limits", {}))[1])


def libraries(path: Path, options: dict) -> dict:
    from independent.library import read_library
    from independent.models import read_models

    return reported(read_library(path.read_bytes(), read_models(SPEC), options.get("limits", {})))


def scenes(path: Path, options: dict) -> dict:
    from independent.models import read_models
    from independent.scene import read_scene

    return reported(read_scene(path, read_models(SPEC), options.get("limits", {})))


def recordings(path: Path, options: dict) -> dict:
    from independent.recording import read_recording

    arguments = options.get("arguments", [])
    given = dict(zip(arguments[::2], arguments[1::2]))
    speed, force = (given.get(name) for name in ("--speed", "--force"))
    return reported(read_recording(path, float(speed) if speed else None, float(force) if force else None))


def baked(path: Path, _options: dict) -> dict:
    import hashlib

    import numpy as np
    from independent.baked import Broken, bits, integers, play, read_block

    question = json.loads(path.read_text("utf-8"))
    try:
        block = read_block(Path(question["block"]).read_bytes())
    except Broken as broken:
        return {"verdict": "invalid", "findings": [{"code": str(broken), "pointer": ""}]}
    if question["steps"] is None:
        return {"verdict": "valid", "findings": []}
    with np.errstate(all="ignore"):
        samples = play(block, question["seed"], question["steps"])
    whole = integers(samples, bits(question["full_scale_bits"]))
    return {
        "verdict": "valid",
        "findings": [],
        "values": {
            "samples_sha256": hashlib.sha256(samples.tobytes()).hexdigest(),
            "integers_sha256": hashlib.sha256(whole.tobytes()).hexdigest(),
        },
    }


def playing(path: Path, _options: dict) -> dict:
    import numpy as np
    from independent.asset import read_asset
    from independent.models import read_models
    from independent.playing import Refusal, Voice

    question = json.loads(path.read_text("utf-8"))
    models = read_models(SPEC)
    asset, findings = read_asset(Path(question["asset"]).read_bytes(), models)
    if not findings.valid:
        return reported(findings)
    frequencies, voices, cases = np.array(question["frequency_hz"]), {}, []
    for case in question["cases"]:
        try:
            voice = voices.get(case["model"]) or voices.setdefault(case["model"], Voice(asset, models[case["model"]]))
            now = voice.at(*voice.motion(case))
        except Refusal:
            cases.append(None)
            continue
        numbers = {
            "parameters": [float(number) for number in now.parameters],
            "frequency_factor": float(now.frequency_factor),
            "level_rms": float(now.level_rms),
            "magnitude": [float(number) for number in now.magnitude(frequencies)],
        }
        cases.append(numbers)
    return {"verdict": "valid", "values": {"cases": cases}}


PARTS = {part.__name__: part for part in (assets, libraries, scenes, recordings, baked, playing)}


def main() -> int:
    part, path, *options = sys.argv[1:]
    answer = PARTS[part](Path(path), json.loads(options[0]) if options else {})
    print(json.dumps(answer, allow_nan=False))
    return 0


if __name__ == "__main__":
    sys.exit(main())
