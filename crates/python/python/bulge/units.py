"""Quantities: text with a unit, or numbers in SI."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from bulge import _bulge

#: A quantity: a number in SI, or text with a unit such as ``"2 bar"``.
Quantity = Union[float, str]
#: The same, or an array of numbers in SI, or a list of either.
Quantities = Union[float, str, npt.ArrayLike, Iterable[Union[float, str]]]
#: Two quantities, or text such as ``"1 bar..6 bar"``.
Ends = Union[str, tuple[Quantity, Quantity], list[Quantity]]

FloatArray = npt.NDArray[np.float64]

#: Bare numbers that nobody means, by the SI unit: those below the first and those above the second value are refused, with the unit that was
#: probably meant and its size. "%" is a share of 1, such as a contraction; pure numbers ("1") may be anything. 0 always is what it says.
PLAUSIBLE: dict[str, tuple[float, float, str, float]] = {
    "Pa": (100.0, math.inf, "bar", 1e5),
    "m": (0.0, 50.0, "mm", 1e-3),
    "%": (0.0, 1.0, "%", 1e-2),
    "rad": (0.0, 2 * math.pi, "deg", math.pi / 180),
}
#: Words in names of numbers that rightly are small: standard deviations and widths. And numbers in Pa that are moduli.
_SMALL = ("_sd", "noise", "zero", "gain")
_MODULI = ("c10", "c01")


def check_bare(largest: float, unit: str, name: str) -> None:
    """Refuses a bare number (of an array: its largest absolute value) that is implausible for what it is; see :data:`PLAUSIBLE`."""
    limits = PLAUSIBLE.get(unit)
    if limits is None or largest == 0.0:
        return
    low, high, meant, size = limits
    if (low <= abs(largest) <= high) or not math.isfinite(largest) or name.endswith(_SMALL):
        return
    if unit == "Pa" and ("." in name or name in _MODULI):
        meant, size = "MPa", 1e6
    is_ = f"{100 * largest:.6g} %" if unit == "%" else f"{largest:.6g} {unit}"
    raise _bulge.InputError(f'{name}: {largest:.6g} is {is_}, bare numbers are SI: write "{largest:.6g} {meant}" or {_plain(largest * size)}')


def _plain(value: float) -> str:
    """A number as one writes it."""
    return f"{value:.4g}".replace("e+0", "e").replace("e+", "e").replace("e-0", "e-")


def si(value: Quantity, unit: str, name: str = "the value") -> float:
    """A quantity in SI.

    ``unit`` is the SI unit that it must have the dimension of ("%" for a share of 1), ``name`` what an error calls it.

    >>> import bulge
    >>> bulge.si("2 bar", "Pa")
    200000.0

    Raises :class:`bulge.InputError` if text has no unit or one of another dimension, and for bare numbers that are implausible: below 100 Pa,
    above 50 m, beyond a whole turn or 100 %.
    """
    if isinstance(value, str):
        return _bulge.si(name, value, "1" if unit == "%" else unit)
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise _bulge.InputError(f"{name}: {value!r} is neither a number (in {'1' if unit == '%' else unit}) nor text with a unit") from None
    check_bare(number, unit, name)
    return number


def si_array(values: Quantities, unit: str, name: str) -> float | FloatArray:
    """Quantities in SI: a float for a single one, else an array of float64."""
    if isinstance(values, (str, float, int)):
        return si(values, unit, name)
    bare: list[float] = []
    if isinstance(values, (list, tuple)):
        values = _without_text(values, unit, name, bare)
    array = np.asarray(values)
    if array.dtype.kind in "OUS":
        array = np.asarray(_without_text(array.tolist(), unit, name, bare))
    elif not bare and not isinstance(values, list):
        bare = [_largest(array)]
    if array.dtype.kind not in "iufb":
        raise _bulge.InputError(f"{name}: {array.dtype} is no array of numbers")
    array = array.astype(np.float64, copy=False)
    if bare:
        check_bare(max(bare, key=abs), unit, name)
    return float(array) if array.ndim == 0 else array


def _largest(array: npt.NDArray[Any]) -> float:
    """The number with the largest absolute value; 0 of none."""
    if array.dtype.kind not in "iufb" or array.size == 0:
        return 0.0
    low, high = float(array.min()), float(array.max())
    return low if abs(low) > abs(high) else high


def _without_text(values: Any, unit: str, name: str, bare: list[float]) -> Any:
    """Nested lists with every text turned into a number; the largest bare ones are collected."""
    if isinstance(values, (list, tuple)):
        return [_without_text(value, unit, name, bare) for value in values]
    if values is None:
        raise _bulge.InputError(f"{name}: None is no number")
    if isinstance(values, str):
        return si(values, unit, name)
    array = np.asarray(values)
    bare.append(_largest(array))
    return values


def si_range(values: Ends, unit: str, name: str) -> list[float]:
    """A range in SI, from ``"1 bar..6 bar"`` or a pair; the first end of text may take the unit of the second."""
    if isinstance(values, str):
        ends: list[Any] = [end.strip() for end in values.split("..")]
        if len(ends) == 2:
            try:
                float(ends[0])
            except ValueError:
                pass
            else:
                ends[0] += ends[1].lstrip("+-.0123456789eE")
    else:
        ends = list(values)
    if len(ends) != 2:
        raise _bulge.InputError(f"{name}: write a range such as \"1..2 {unit}\" with two ends, or a pair")
    bare = [float(end) for end in ends if isinstance(end, (float, int))]
    if len(bare) == 2:
        check_bare(max(bare, key=abs), unit, name)
        return bare
    return [si(end, unit, name) for end in ends]


def optional(value: Quantity | None, unit: str, name: str) -> float | None:
    """A quantity in SI, if it is given."""
    return None if value is None else si(value, unit, name)


def listed(values: Quantities | None, unit: str, name: str) -> list[float] | None:
    """Quantities in SI as a list, from one, from several or from text such as ``"4 bar,4.5 bar"``; None where none are given."""
    if values is None:
        return None
    if isinstance(values, str) and "," in values:
        values = [part.strip() for part in values.split(",")]
    return [float(value) for value in np.atleast_1d(np.asarray(si_array(values, unit, name)))]
