import os
import pathlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, Protocol, final

import numpy as np
import numpy.typing as npt

from ._data import Condition, Coverage, DeviceStatus, Envelope, Exponent, LibraryChange, LibraryDifference, LibraryEntry, Quantity, Spectrum

__version__: str
__all__ = [
    "Build",
    "Device",
    "Library",
    "Scene",
    "Texture",
    "Voice",
    "__version__",
    "agreement",
    "compare",
    "devices",
    "edit",
    "export",
    "fit",
    "formats",
    "hash_file",
    "import_file",
    "make",
    "mix",
    "models",
    "open",
    "pack",
    "process",
    "register_model",
    "remember",
    "response",
    "response_csv",
    "run",
    "run_job",
    "simulate",
    "tradeoff",
    "unhashed",
    "unregister_model",
    "work_folder",
    "write_file",
]

_Path = str | os.PathLike[str]
_At = Condition | tuple[float | None, float | None]
_Series = float | Sequence[float] | npt.NDArray[np.floating[Any]]

class _Readable(Protocol):
    def read(self) -> bytes: ...

@final
class Texture:
    """A texture: an open asset (a .htex file), and the models that play it."""

    @property
    def name(self) -> str: ...
    @property
    def quantity(self) -> Quantity: ...
    @property
    def unit(self) -> str: ...
    @property
    def band_hz(self) -> tuple[float, float]: ...
    @property
    def manifest(self) -> dict[str, Any]: ...
    @property
    def conditions(self) -> list[Condition]: ...
    @property
    def contact(self) -> str: ...
    @property
    def law(self) -> dict[str, Exponent]: ...
    @property
    def models(self) -> list[str]: ...
    def spectrum(
        self,
        frequency_hz: Sequence[float] | npt.NDArray[np.floating[Any]] | None = None,
        model: str | None = None,
        at: _At | None = None,
    ) -> Spectrum: ...
    def read_spectrum(self, model: str | None = None, condition: int | None = None) -> Spectrum: ...
    def level(self, model: str | None = None, at: _At | None = None) -> float: ...
    def parameters(self, model: str | None = None, at: _At | None = None) -> dict[str, float | list[float]]: ...
    def save(self, path: _Path) -> None: ...
    def to_bytes(self) -> bytes: ...
    def voice(
        self,
        model: str | None = None,
        rate_hz: float = 20000.0,
        seed: int = 0,
        speed_mm_s: float | None = None,
        force_n: float | None = None,
        position_mm: float | None = None,
        synthesis: str = "streamed",
        *,
        x_mm: float | None = None,
        y_mm: float | None = None,
        frequency_scaling: bool = True,
        level_scaling: bool = True,
        contact: bool = True,
        ceiling: float = 4.0,
        gain: float = 1.0,
        limit: float | None = None,
        envelope_bands: int = 0,
        fluctuation: bool = False,
    ) -> Voice: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Library:
    """A library: a single file with thousands of textures. A texture is read only when it is
    requested."""

    def __new__(
        cls,
        source: _Path | bytes | bytearray | memoryview | _Readable,
        *,
        plugins: Sequence[_Path] = ...,
        embedded: bool = True,
        installed: bool = False,
        only_signed_by: str | Sequence[str] | None = None,
        signature: bytes | None = None,
    ) -> Library: ...
    @property
    def name(self) -> str: ...
    @property
    def metadata(self) -> dict[str, object]: ...
    @property
    def blake3(self) -> str: ...
    def info(self) -> dict[str, Any]: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def entries(self) -> list[LibraryEntry]: ...
    def find(
        self,
        *words: str,
        tags: Sequence[str] = ...,
        speed_mm_s: float | None = None,
        force_n: float | None = None,
        model: str | None = None,
        license: str | None = None,
        author: str | None = None,
        quantity: str | None = None,
        max_felt_db: float | None = None,
        max_held_out_db: float | None = None,
    ) -> list[LibraryEntry]: ...
    def similar(self, name: str, count: int = 10) -> list[tuple[float, LibraryEntry]]: ...
    def duplicates(self, within_db: float = 0.5) -> list[tuple[str, str, float]]: ...
    def diff(self, newer: Library) -> LibraryDifference: ...
    def entry(self, name: str) -> LibraryEntry: ...
    def to_bytes(self, name: str) -> bytes: ...
    @staticmethod
    def edit(
        path: _Path,
        output: _Path | None = None,
        *,
        remove: Sequence[str] = ...,
        rename: Mapping[str, str] = ...,
        add: Mapping[str, _Path] = ...,
        add_libraries: Sequence[_Path] = ...,
        metadata: Mapping[str, object] | None = None,
        add_tags: Sequence[str] = ...,
        remove_tags: Sequence[str] = ...,
        filters: Mapping[str, str] = ...,
        table: _Path | None = None,
        describe: Mapping[str, str] | None = None,
        unlicensed: bool = False,
    ) -> LibraryChange: ...
    @staticmethod
    def merge(
        paths: Sequence[_Path],
        output: _Path,
        *,
        prefixes: Sequence[str] = ...,
        on_conflict: Literal["error", "first", "last"] = "error",
        name: str = "",
        describe: Mapping[str, str] = ...,
    ) -> int: ...
    def __getitem__(self, name: str, /) -> Texture: ...
    def __contains__(self, name: str, /) -> bool: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[str]: ...

@final
class Voice:
    """A voice: an endless stream of samples in the texture's unit, which follows the motion of the finger."""

    @property
    def model(self) -> str: ...
    @property
    def rate_hz(self) -> float: ...
    @property
    def seed(self) -> int: ...
    @property
    def unit(self) -> str: ...
    def render(self, n: int) -> npt.NDArray[np.float32]: ...
    def render_into(self, array: npt.NDArray[np.float32]) -> None: ...
    def set_motion(
        self,
        speed_mm_s: float,
        force_n: float,
        position_mm: float | None = None,
        *,
        x_mm: float | None = None,
        y_mm: float | None = None,
    ) -> None: ...
    def render_path(
        self,
        speed_mm_s: _Series,
        force_n: _Series,
        position_mm: _Series | None = None,
        block: int = 64,
        *,
        x_mm: _Series | None = None,
        y_mm: _Series | None = None,
    ) -> npt.NDArray[np.float32]: ...
    def set_gain(self, gain: float) -> None: ...
    @property
    def is_silent(self) -> bool: ...
    @property
    def envelope_edges_hz(self) -> npt.NDArray[np.float64]: ...
    def envelope(self) -> Envelope: ...
    def coverage(self, speed_mm_s: float, force_n: float) -> Coverage: ...

@final
class Scene:
    """A scene: surfaces, a motion of the finger, and the device for which samples are made. The
    device itself is not opened."""

    def __new__(
        cls,
        path: _Path,
        *,
        plugins: Sequence[_Path] = ...,
        embedded: bool = True,
        installed: bool = False,
        device: str | None = None,
        profile: str | None = None,
        settings: Mapping[str, Any] = ...,
        quantity_gain: float | None = None,
        only_signed_by: str | Sequence[str] | None = None,
    ) -> Scene: ...
    @property
    def unit(self) -> str: ...
    @property
    def rate_hz(self) -> float: ...
    @property
    def notes(self) -> list[str]: ...
    def plan(self) -> dict[str, Any]: ...
    def render(self, seconds: float | None = None) -> npt.NDArray[np.float32]: ...
    def render_path(
        self,
        speed_mm_s: _Series,
        force_n: _Series,
        x_mm: _Series | None = None,
        y_mm: _Series | None = None,
        block: int = 64,
    ) -> npt.NDArray[np.float32]: ...

@final
class Device:
    """An open device, which plays samples.

    ``name`` selects the device, such as ``sdl``. If it is closed without ``finish``, it goes to
    rest at once.

    A ``with`` block finishes the device at its end; after an exception it only closes the device.
    ``settings`` are the device's settings; ``devices()`` lists them. ``rate_hz`` is the sample
    rate; the default is the device's own. A display that is driven by a voltage cannot be opened
    here: use ``htex play``.
    """

    def __new__(
        cls,
        name: str,
        *,
        rate_hz: float | None = None,
        profile: str | None = None,
        settings: Mapping[str, Any] = ...,
        installed: bool = False,
    ) -> Device: ...
    @property
    def rate_hz(self) -> float: ...
    @property
    def unit(self) -> str: ...
    @property
    def status(self) -> DeviceStatus: ...
    def write(self, samples: npt.NDArray[np.float32], timeout_s: float = 1.0) -> int: ...
    def finish(self) -> None: ...
    def close(self) -> None: ...
    def __enter__(self) -> Device: ...
    def __exit__(self, kind: type[BaseException] | None, _value: object, _traceback: object) -> None: ...

@final
class Build:
    """A planned build of a library from a recipe."""

    def __new__(
        cls, recipe: str, output: str, keep_going: bool, work: _Path | None, plugins: Sequence[_Path], no_removals: bool
    ) -> Build: ...
    @property
    def textures(self) -> int: ...
    def pending(self) -> list[tuple[str, str, int]]: ...
    def store(self, key: str, made: bytes) -> None: ...
    def run(self) -> None: ...
    def finish(self) -> dict[str, Any]: ...

def run_job(key: str, job: str) -> bytes: ...
def work_folder(output: str, work: _Path | None) -> str: ...
def unhashed(recipe: str, output: str) -> list[str]: ...
def hash_file(recipe: _Path, file: _Path) -> str: ...
def remember(output: str, hashed: Sequence[tuple[_Path, str]]) -> None: ...
def open(
    source: _Path | bytes | bytearray | memoryview | _Readable,
    *,
    plugins: Sequence[_Path] = ...,
    embedded: bool = True,
    installed: bool = False,
    only_signed_by: str | Sequence[str] | None = None,
    signature: bytes | None = None,
) -> Texture: ...
def pack(
    path: _Path,
    textures: Mapping[str, _Path | bytes | bytearray | memoryview | _Readable | Texture],
    *,
    name: str = "",
    describe: Mapping[str, str] = ...,
    unlicensed: bool = False,
) -> int: ...
def devices(*, installed: bool = False) -> list[dict[str, Any]]: ...
def formats() -> dict[str, Any]: ...
def import_file(file: _Path, request: Mapping[str, Any]) -> tuple[Texture, list[str], list[str]]: ...
def export(texture: Texture, request: Mapping[str, Any]) -> tuple[bytes, dict[str, Any]]: ...
def models(*, plugins: Sequence[_Path] = ..., installed: bool = False) -> list[dict[str, Any]]: ...
def register_model(descriptor: str, adapter: Any, plays: bool) -> None: ...
def unregister_model(id: str) -> bool: ...
def process(source: Any, reading: tuple[str, str]) -> dict[str, Any]: ...
def fit(sources: Sequence[Any], reading: tuple[str, str], request: Mapping[str, Any]) -> tuple[Texture, dict[str, Any]]: ...
def tradeoff(sources: Sequence[Any], reading: tuple[str, str], request: Mapping[str, Any]) -> dict[str, Any]: ...
def compare(source: Any, other: Any, reading: tuple[str, str]) -> dict[str, Any]: ...
def make(made: Mapping[str, Any]) -> Texture: ...
def mix(a: Texture, b: Texture, weight: float, metadata: str) -> Texture: ...
def edit(texture: Texture, metadata: str, fluctuation: tuple[float, float] | None) -> Texture: ...
def simulate(
    surface: str,
    seed: int,
    seconds: float,
    rate_hz: float,
    free: bool,
    speed_mm_s: float | tuple[float, float] | None,
    force_n: float | tuple[float, float] | None,
    departures: tuple[str, float, float],
) -> tuple[list[tuple[str, npt.NDArray[np.float64]]], bytes, tuple[list[float], list[float], list[float]]]: ...
def response(records: Sequence[tuple[list[float], list[float]]], rate_hz: float, settings: str) -> dict[str, Any]: ...
def response_csv(frequency_hz: list[float], magnitude: list[float], phase_rad: list[float]) -> bytes: ...
def write_file(path: _Path, content: bytes) -> None: ...
def agreement(
    frequency_hz: npt.NDArray[np.float64],
    band_hz: tuple[float, float],
    reference: npt.NDArray[np.float64],
    magnitude: npt.NDArray[np.float64],
) -> dict[str, Any]: ...
def run(arguments: Sequence[str], program: Sequence[str]) -> int: ...
