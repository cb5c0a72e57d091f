"""What is stated beside data, muscle and effects: rows to leave out, numbers held, bounded or tied."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Union

from bulge import _bulge
from bulge.texts import count
from bulge.units import Quantity

#: Rows to leave out, by their lines in the file (the first is 1, and usually the heading): ``"12,33-40"``, with several files
#: ``"a.csv:12,b.csv:33-40"``, or line numbers such as ``[12, 13]`` or ``range(33, 41)``.
Lines = Union[None, str, int, Iterable[Union[int, str]]]
#: Values by the names of numbers, ``"effect.number"`` (``"effect"`` where it has one, ``"effect.number[specimen]"`` for one specimen's own).
Held = Union[None, Mapping[str, Quantity]]
#: Bounds by the names of numbers: a pair, or text such as ``"5..20 N"``.
Bounded = Union[None, Mapping[str, Union[str, tuple[Quantity, Quantity]]]]
#: The number whose value it has, by the names of numbers.
Tied = Union[None, Mapping[str, str]]


def lines(exclude: Lines) -> str | None:
    """Lines as one text."""
    if exclude is None or isinstance(exclude, str):
        return exclude
    every: Iterable[int | str] = exclude if isinstance(exclude, Iterable) else [exclude]
    return ",".join(one if isinstance(one, str) else str(count("exclude", one, 1)) for one in every)


def said(exclude: Lines, hold: Held, bound: Bounded, tie: Tied) -> Any:
    """All that is stated, for the compiled part; numbers stay in SI there."""
    for name, value in [("hold", hold), ("bound", bound), ("tie", tie)]:
        if value is not None and not isinstance(value, Mapping):
            raise _bulge.InputError(f"{name}: {value!r} is no mapping: write such as {_EXAMPLES[name]}")
    held = [(str(name), _value("hold", name, value)) for name, value in (hold or {}).items()]
    bounded = [(str(name), value if isinstance(value, str) else _pair(name, value)) for name, value in (bound or {}).items()]
    return lines(exclude), held, bounded, [(str(name), str(other)) for name, other in (tie or {}).items()]


_EXAMPLES = {
    "hold": '{"coulomb-friction.force": "14 N"}',
    "bound": '{"coulomb-friction.force": ("5 N", "20 N")}',
    "tie": '{"force-lag.time": "pressure-lag.time"}',
}


def _value(what: str, name: str, value: Any) -> float | str:
    if isinstance(value, str):
        return value
    try:
        return float(value)
    except (TypeError, ValueError):
        raise _bulge.InputError(f"{what}: {name}: {value!r} is neither a number in SI nor text with a unit") from None


def _pair(name: str, value: Any) -> tuple[float | str, float | str]:
    try:
        low, high = value
    except (TypeError, ValueError):
        raise _bulge.InputError(f"bound: {name}: {value!r} is no pair: write such as {_EXAMPLES['bound']}") from None
    return _value("bound", name, low), _value("bound", name, high)
