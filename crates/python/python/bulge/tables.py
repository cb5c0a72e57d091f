"""Certified tables of force and volume, looked up at arrays of points."""

from __future__ import annotations

import json
import os
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np

from bulge import _bulge
from bulge.results import Result, number
from bulge.muscle import common_shape
from bulge.units import PLAUSIBLE, FloatArray, Quantities, si_array


class Table(Result):
    """A table: the document of ``bulge table info --json``, with values and exact gradients of its splines or polynomials.

    The certified errors in ``outputs`` are relative to max(|y|, 0.001 max |y|): where an output passes through zero, to a thousandth of its largest value.

    >>> table = bulge.Table.read("table.bulge")                     # doctest: +SKIP
    >>> table(contraction=[0.1, 0.2], slenderness=6.875)["force_f"]     # doctest: +SKIP
    """

    _what = "table"

    def __init__(self, content: bytes, origin: str = "the table") -> None:
        self._native = _bulge.Table.from_bytes(content, origin)
        super().__init__(json.loads(self._native.document()))
        # Looked up at single points, a table is asked a million times.
        self._axes = [axis["name"] for axis in self._document["axes"]]
        self._outputs = [output["name"] for output in self._document["outputs"]]
        # A contraction is a share, of which 20 is a slip for 20 %.
        self._units = ["%" if axis["name"] == "contraction" else axis["unit"] for axis in self._document["axes"]]
        self._plausible = [PLAUSIBLE.get(unit, (0.0, inf, "", 1.0))[:2] for unit in self._units]

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Table:
        """A table from a file (``table.bulge`` of a sweep). A damaged file is refused."""
        try:
            return cls(Path(path).read_bytes(), os.fspath(path))
        except OSError as error:
            raise _bulge.InputError(f"{os.fspath(path)}: {error.strerror or error}") from None

    def to_bytes(self) -> bytes:
        """The file."""
        return self._native.to_bytes()

    @property
    def axis_names(self) -> list[str]:
        """Names of the axes."""
        return list(self._axes)

    @property
    def output_names(self) -> list[str]:
        """Names of the outputs."""
        return list(self._outputs)

    def __call__(self, *, errors: str = "coerce", **at: Quantities) -> dict[str, Any]:
        """Outputs at points: an array (or float) by name; the axes are given by name and broadcast.

        Outside of the domain, which nothing extrapolates, values are NaN; ``errors="raise"`` raises :class:`bulge.NoSolutionError`.
        """
        point = self._point(at)
        if point is not None and errors == "coerce":
            one = self._native.at(point)
            return dict(zip(self._outputs, one)) if one is not None else dict.fromkeys(self._outputs, nan)
        values, _, shape = self._sample(at)
        self._check(values, shape, errors)
        return {name: _shaped(values[:, o], shape) for o, name in enumerate(self._outputs)}

    def gradient(self, *, errors: str = "coerce", **at: Quantities) -> dict[str, dict[str, Any]]:
        """Derivatives at points: ``gradient["force_f"]["contraction"]``, in SI."""
        n = len(self._axes)
        point = self._point(at)
        if point is not None and errors == "coerce":
            one = self._native.slopes_at(point)
            if one is None:
                one = [nan] * (n * len(self._outputs))
            return {output: dict(zip(self._axes, one[o * n : o * n + n])) for o, output in enumerate(self._outputs)}
        values, gradients, shape = self._sample(at)
        self._check(values, shape, errors)
        return {
            output: {axis: _shaped(gradients[:, o * n + a], shape) for a, axis in enumerate(self._axes)}
            for o, output in enumerate(self._outputs)
        }

    def upper_end(self, **at: Quantities) -> Any:
        """The end of the first axis (the contraction limit, where the table follows it) at points of the others."""
        first = self._axes[0]
        points, shape = self._points({first: float(self._document["axes"][0]["low"]), **at})
        return _shaped(self._native.upper_end(points), shape)

    def _point(self, at: dict[str, Quantities]) -> tuple[Any, ...] | None:
        """A single point of plausible floats; None of anything else, which :meth:`_points` looks at."""
        if len(at) != len(self._axes):
            return None
        point = []
        for name, (low, high) in zip(self._axes, self._plausible):
            value = at.get(name)
            if not (isinstance(value, float) and (low <= abs(value) <= high or value == 0.0)):
                return None
            point.append(value)
        return tuple(point)

    def _points(self, at: dict[str, Quantities]) -> tuple[FloatArray, tuple[int, ...]]:
        names = self._axes
        wrong = [name for name in at if name not in names] + [name for name in names if name not in at]
        if wrong:
            raise _bulge.InputError(f"this table has the axes {', '.join(names)}: `{wrong[0]}` is {'missing' if wrong[0] in names else 'none of them'}")
        columns = {name: si_array(at[name], unit, name) for name, unit in zip(names, self._units)}
        shape = common_shape(columns)
        points = np.stack([np.broadcast_to(column, shape).reshape(-1) for column in columns.values()], axis=-1)
        return np.ascontiguousarray(points, dtype=np.float64), shape

    def _sample(self, at: dict[str, Quantities]) -> tuple[FloatArray, FloatArray, tuple[int, ...]]:
        points, shape = self._points(at)
        values, gradients = self._native.sample(points)
        return values, gradients, shape

    def _check(self, values: FloatArray, shape: tuple[int, ...], errors: str) -> None:
        if errors not in ("raise", "coerce"):
            raise _bulge.InputError(f"errors: {errors!r} is neither \"raise\" nor \"coerce\"")
        outside = np.asarray(np.isnan(values).any(axis=1))
        if errors == "raise" and outside.any():
            row = int(np.argmax(outside))
            where = f"; the first at index {tuple(int(i) for i in np.unravel_index(row, shape))}" if shape else ""
            raise _bulge.NoSolutionError(f"{int(outside.sum())} of {len(outside)} points lie outside of the table{where}")

    def _lines(self) -> list[str]:
        d = self._document
        return [f"table of {', '.join(self.output_names)} over {', '.join(self.axis_names)}: {d['form']}, {d['bytes']} bytes"]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        rows = [[o["name"], number(o["error"], 2), number(o["gradient_error"], 2)] for o in self._document["outputs"]]
        return [(["output", "relative error", "of gradients"], rows)]

    def __reduce__(self) -> Any:
        return (Table, (self.to_bytes(),))


def _shaped(values: FloatArray, shape: tuple[int, ...]) -> Any:
    return values.reshape(shape).copy() if shape else float(values[0])
