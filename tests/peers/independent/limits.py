"""Limits of the reference reader (htex-1.md section 9, scene-1.md section 8, htexlib-1.md section 9)."""

ASSET = {
    "file_bytes": 16777216,
    "entries": 256,
    "entry_bytes": 4194304,
    "total_bytes": 16777216,
    "ratio": 200,
    "json_depth": 32,
    "json_nodes": 1000000,
    "conditions": 10000,
    "values": 1048576,
}
SCENE = {"file_bytes": 1048576, "json_depth": 16, "surfaces": 256}
LIBRARY = {
    "entries": 16777216,
    "leaves": 65536,
    "root_bytes": 1048576,
    "leaf_bytes": 65536,
    "asset_bytes": 16777216,
    "objects": 1048576,
    "ratio": 1000,
}


def with_defaults(defaults: dict[str, int], given: dict[str, int] | None) -> dict[str, int]:
    """The defaults with those of `given` in their place; names of other tables are ignored."""
    return {**defaults, **{k: v for k, v in (given or {}).items() if k in defaults}}
