"""Quantities: text with a unit, or numbers in SI."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from bulge import _bulge

#: A quantity: a number in SI, or text with a unit such as ``"2 bar"``.
Quantity = Union[float, str]
#: The same, or an array of numbers in SI, or a list of either.
Quantities = Union[float, str, npt.ArrayLike, Iterable[Union[float, str]]]

FloatArray = npt.NDArray[np.float64]


def si(value: Quantity, unit: str, name: str = "the value") -> float:
    """A quantity in SI.

    ``unit`` is the SI unit that it must have the dimension of, ``name`` what an error calls it.

    >>> import bulge
    >>> bulge.si("2 bar", "Pa")
    200000.0

    Raises :class:`bulge.InputError` if text has no unit or one of another dimension.
    """
    if isinstance(value, str):
        return _bulge.si(name, value, unit)
    try:
        return float(value)
    except (TypeError, ValueError):
        raise _bulge.InputError(f"{name}: {value!r} is neither a number (in {unit}) nor text with a unit") from None


def si_array(values: Quantities, unit: str, name: str) -> float | FloatArray:
    """Quantities in SI: a float for a single one, else an array of float64."""
    if isinstance(values, (str, float, int)):
        return si(values, unit, name)
    if isinstance(values, (list, tuple)):
        values = _without_text(values, unit, name)
    array = np.asarray(values)
    if array.dtype.kind in "OUS":
        array = np.asarray(_without_text(array.tolist(), unit, name))
    if array.dtype.kind not in "iufb":
        raise _bulge.InputError(f"{name}: {array.dtype} is no array of numbers")
    array = array.astype(np.float64, copy=False)
    return float(array) if array.ndim == 0 else array


def _without_text(values: Any, unit: str, name: str) -> Any:
    """Nested lists with every text turned into a number."""
    if isinstance(values, (list, tuple)):
        return [_without_text(value, unit, name) for value in values]
    if values is None:
        raise _bulge.InputError(f"{name}: None is no number")
    return si(values, unit, name) if isinstance(values, str) else values


def si_range(values: str | tuple[Quantity, Quantity] | list[Quantity], unit: str, name: str) -> list[float]:
    """A range in SI, from ``"1 bar..6 bar"`` or a pair."""
    ends: Any = values.split("..") if isinstance(values, str) else list(values)
    if len(ends) != 2:
        raise _bulge.InputError(f"{name}: write a range such as \"1..2 {unit}\" with two ends, or a pair")
    return [si(end, unit, name) for end in ends]
