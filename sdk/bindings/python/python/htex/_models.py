"""Models written in Python."""

from __future__ import annotations

import inspect
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from . import _htex

Numbers = npt.NDArray[np.float64]

Parameters = Mapping[str, Any]
"""Parameters by name: a number for a scalar field, a list of numbers for a list field."""


@dataclass(frozen=True)
class Field:
    """A parameter of a model written in Python."""

    name: str
    """Name of the parameter, including its unit, such as ``peak_hz``."""
    unit: str
    """Symbol of the unit; ``1`` for a pure number."""
    min: float
    """Smallest allowed value."""
    max: float
    """Largest allowed value."""
    description: str = ""
    """Meaning of the parameter."""
    most: int | None = None
    """Largest length of a list; ``None`` for a single number."""

    def _described(self) -> dict[str, Any]:
        scalar = self.most is None
        return {
            "name": self.name,
            "unit": self.unit,
            "kind": {"type": "scalar"} if scalar else {"type": "list", "max_len": self.most},
            "min": self.min,
            "max": self.max,
            "store": {"type": "f32"},
            "description": self.description,
        }


class Model(Protocol):
    """What a class must define so that ``register_model`` accepts it."""

    id: str
    fields: Sequence[Field]

    def fit(self, frequency_hz: Numbers, magnitude: Numbers) -> Parameters: ...
    def magnitude(self, parameters: Any, frequency_hz: Numbers) -> npt.ArrayLike: ...


_Class = TypeVar("_Class", bound="type[Model]")


def register_model(model: _Class) -> _Class:
    """Register a model written in Python, for prototypes. This function can also be used as a
    decorator.

    ``model`` is a class whose constructor needs no arguments. It has an ``id`` in reverse-DNS form,
    such as ``org.example.plateau``, a list of parameters called ``fields`` (each is a ``Field``),
    and these methods:

    - ``fit(frequency_hz, magnitude)`` returns a dict of the parameters that describe a spectrum;
    - ``magnitude(parameters, frequency_hz)`` returns a magnitude for each frequency. Their common
      scale does not matter. A voice plays noise with these magnitudes;
    - ``voice(parameters, rate_hz, seed)`` is optional. It returns an object that makes the samples
      instead of that noise. The object's ``render(n)`` returns the next ``n`` samples, with an RMS
      of 1. Its ``retune(parameters)`` changes the parameters, which textures with several
      conditions need.

    ``htex.models()`` shows the class's ``name`` and ``version``, if it has them, and the first line
    of its docstring.

    Only this process knows the model. All later calls of ``fit``, ``open``, ``tradeoff``,
    ``models`` and ``Scene`` can use it; the ``htex`` command cannot. The model replaces a
    registered model with the same id. Its methods are slow, because they run under Python's global
    interpreter lock. If others will use your model, write it in Rust or C. If a method raises an
    exception, the caller gets a ``ModelError`` whose cause is that exception.
    """
    if not inspect.isclass(model):
        raise TypeError(f"expected a class, got {type(model).__name__}; give the class itself, not an object")
    for name in ("id", "fields", "fit", "magnitude"):
        if not hasattr(model, name):
            raise TypeError(f"class {model.__name__} has no `{name}`; a model has id, fields, fit and magnitude")
    fields = list(model.fields)
    for field in fields:
        if not isinstance(field, Field):
            raise TypeError(f"fields of class {model.__name__}: expected htex.Field, got {type(field).__name__}")
    documentation = inspect.getdoc(model) or model.__name__
    descriptor = {
        "id": model.id,
        "name": getattr(model, "name", model.__name__),
        "version": getattr(model, "version", "0.0.0"),
        "summary": documentation.splitlines()[0],
        "fields": [field._described() for field in fields],
    }
    adapter = _Adapter(model(), fields)
    _htex.register_model(json.dumps(descriptor), adapter, hasattr(model, "voice"))
    return model


class _Adapter:
    """Calls the author's class with parameters by name, where the extension module uses flat
    arrays, and checks its results."""

    def __init__(self, model: Any, fields: list[Field]) -> None:
        self.model = model
        self.fields = fields

    def fit(self, frequency_hz: Numbers, magnitude: Numbers) -> list[float]:
        return self._flat(self.model.fit(frequency_hz, magnitude))

    def magnitude(self, flat: Numbers, frequency_hz: Numbers) -> Numbers:
        returned = self.model.magnitude(self._named(flat), frequency_hz.copy())
        found = np.asarray(returned, dtype=np.float64)
        if found.shape != frequency_hz.shape:
            raise ValueError(
                f"magnitude returned an array of shape {found.shape} for {len(frequency_hz)} frequencies; "
                "return one magnitude for each"
            )
        invalid = ~(np.isfinite(found) & (found >= 0))
        if invalid.any():
            at = int(invalid.argmax())
            raise ValueError(
                f"magnitude returned {found[at]} at {frequency_hz[at]:g} Hz; return finite numbers from 0"
            )
        return found

    def voice(self, flat: Numbers, rate_hz: float, seed: int) -> _Voice:
        return _Voice(self, self.model.voice(self._named(flat), rate_hz, seed))

    def _flat(self, parameters: Any) -> list[float]:
        names = [field.name for field in self.fields]
        if not isinstance(parameters, Mapping):
            raise TypeError(f"fit returned {type(parameters).__name__}; return a dict with {', '.join(names)}")
        if set(parameters) != set(names):
            raise ValueError(f"fit returned {', '.join(map(str, parameters))}; return {', '.join(names)}")
        flat: list[float] = []
        for field in self.fields:
            value = parameters[field.name]
            if field.most is None:
                flat.append(float(value))
            else:
                numbers = [float(x) for x in value]
                flat += [float(len(numbers)), *numbers]
        return flat

    def _named(self, flat: Numbers) -> dict[str, float | list[float]]:
        named: dict[str, float | list[float]] = {}
        rest = iter(flat.tolist())
        for field in self.fields:
            first = next(rest)
            named[field.name] = first if field.most is None else [next(rest) for _ in range(int(first))]
        return named


class _Voice:
    """Calls the author's voice and checks its samples."""

    def __init__(self, adapter: _Adapter, voice: Any) -> None:
        if not hasattr(voice, "render"):
            raise TypeError(f"voice returned {type(voice).__name__}, which has no render(n)")
        self.adapter = adapter
        self.voice = voice

    def render(self, n: int) -> npt.NDArray[np.float32]:
        returned = self.voice.render(n)
        with np.errstate(over="ignore"):
            samples = np.ascontiguousarray(returned, dtype=np.float32)
        if samples.shape != (n,) or np.ndim(returned) != 1:
            raise ValueError(
                f"render returned an array of shape {np.shape(returned)} for {n} samples; return one number for each"
            )
        finite = np.isfinite(samples)
        if not finite.all():
            at = int((~finite).argmax())
            raise ValueError(f"render returned {samples[at]} at sample {at} of {n}; return finite numbers")
        return samples

    def retune(self, flat: Numbers) -> None:
        if not hasattr(self.voice, "retune"):
            raise TypeError(
                f"{type(self.voice).__name__} has no retune(parameters), which changes the parameters between conditions"
            )
        self.voice.retune(self.adapter._named(flat))


for _class in (Field, register_model):
    _class.__module__ = "htex"
