"""Convert recordings to files: an array to an NPY file of numbers, and a data frame to one of records.

So arrays and data frames have the same channels, scale and limits as these files.
"""

from __future__ import annotations

import io
import os
import re
from collections.abc import Mapping
from typing import Any, BinaryIO, Union

import numpy as np
import numpy.typing as npt

from . import _errors
from ._data import Simulation

Recording = Union[str, os.PathLike[str], bytes, BinaryIO, npt.ArrayLike]

# First words of the names of columns that have the time.
_TIMES = ("t", "time", "timestamp", "elapsed")


def sources(recordings: Any) -> list[Any]:
    """Return the source of each recording. A list of numbers is a single recording."""
    several = isinstance(recordings, (list, tuple))
    if several and not recordings:
        raise _errors.OptionError("no recordings; give at least one")
    if not several or isinstance(recordings[0], (int, float)):
        return [source(recordings)]
    return [source(recording) for recording in recordings]


def source(recording: Any) -> Any:
    """Return a path, or the name and the bytes of a file. An array becomes an NPY file."""
    if isinstance(recording, (str, os.PathLike)):
        return recording
    if isinstance(recording, Simulation):
        return ("simulated", recording.csv)
    if isinstance(recording, (bytes, bytearray, memoryview)):
        return ("recording", bytes(recording))
    if hasattr(recording, "read"):
        content = recording.read()
        if not isinstance(content, bytes):
            raise TypeError("expected a file opened in binary mode; open it with mode 'rb'")
        name = getattr(recording, "name", "recording")
        return (os.path.basename(name) if isinstance(name, str) else "recording", content)
    named = _columns(recording)
    if named is not None:
        return ("frame", _records(named))
    array = _unmasked("the array", recording)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"expected a path, bytes, a binary file or an array of numbers, got {array.dtype}")
    if array.dtype not in (np.float32, np.float64, np.int16, np.int32):
        array = array.astype(np.float64)
    file = io.BytesIO()
    np.save(file, array, allow_pickle=False)
    return ("array", file.getvalue())


def _columns(recording: Any) -> dict[str, Any] | None:
    """Return the columns of a data frame or a mapping by name, or ``None`` for objects without
    column names. An index of times is a column of seconds.
    """
    if not (isinstance(recording, Mapping) or hasattr(recording, "columns")):
        return None
    names = list(getattr(recording, "columns", recording))
    if not names or not all(isinstance(name, str) for name in names):
        return None
    columns = {name: _unmasked(f"column {name!r}", recording[name]) for name in names}
    index = np.asarray(getattr(recording, "index", ()))
    has_time = any(re.split(r"[^a-z]", name.lower())[0] in _TIMES for name in names)
    if index.dtype.kind not in "mM" or index.size == 0 or has_time:
        return columns
    return {"time_s": (index - index[0]) / np.timedelta64(1, "ns") * 1e-9, **columns}


def _unmasked(what: str, values: Any) -> Any:
    """Return values as an array. Refuse masked values, because NumPy would turn them into
    samples."""
    if np.ma.is_masked(values):
        raise _errors.OptionError(f"{what} has masked values; leave their rows out, or fill them with filled()")
    return np.asarray(values)


def _records(columns: Mapping[str, Any]) -> bytes:
    """Return columns as an NPY file of records. It has all digits of the numbers, and the column
    names as they are."""
    for name, values in columns.items():
        if values.ndim != 1 or values.dtype.kind not in "biuf":
            raise TypeError(f"column {name!r} is of {values.dtype} in {values.ndim} dimensions; give numbers, one for each sample")
        if not name or not name.isprintable() or any(c in name for c in "\"\\"):
            raise _errors.OptionError(f"column {name!r}: a name is not empty, and has no double quote, backslash or line end; rename it")
    lengths = {len(values) for values in columns.values()}
    if len(lengths) > 1:
        raise _errors.OptionError(f"the columns have {min(lengths)} to {max(lengths)} numbers; give equally many")
    records = np.empty(lengths.pop(), dtype=[(name, "<f8") for name in columns])
    for name, values in columns.items():
        records[name] = values
    file = io.BytesIO()
    # Names in UTF-8.
    np.lib.format.write_array(file, records, version=(3, 0), allow_pickle=False)
    return file.getvalue()


def stem(source: Any) -> str:
    name = source[0] if isinstance(source, tuple) else os.path.basename(os.fspath(source))
    return os.path.splitext(name)[0] or "texture"
