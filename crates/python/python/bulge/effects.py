"""Physical effects: the catalogue, and effects of one's own as expressions or as Python functions."""

from __future__ import annotations

import inspect
import json
import os
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Union

import numpy as np

from bulge import _bulge
from bulge.results import Result
from bulge.texts import quoted, read_text

#: Variables of a force, SI: gauge pressure ``p`` [Pa], contraction ``eps``, ``length``, ``l0``, ``radius``, ``mid_radius`` [m], ``direction`` (+1
#: shortening, -1 lengthening, 0 at rest), ``rate`` d(eps)/dt [1/s], ``time`` since the sweep began [s], ``temperature`` above that of the first row [K],
#: ``force`` of the equilibrium [N], ``cycle`` number, ``max_eps`` so far in the sweep, meridional ``tension`` [N], number of ``fibres``,
#: ``braid_angle`` [rad].
VARIABLES = (
    "p", "eps", "length", "l0", "radius", "mid_radius", "direction", "rate", "time", "temperature", "force", "cycle", "max_eps", "tension",
    "fibres", "braid_angle",
)  # fmt: skip


#: Variables of a formula of the shape (``energy``, ``area``, ``twist``), SI: stretches ``l1`` along the meridian and ``l2`` around the axis, radius ``r`` of the
#: fibres and reference radius ``r0`` [m], gauge pressure ``p`` [Pa], braid angle at rest ``alpha0`` [rad], length at rest ``l0`` [m].
SHAPE_VARIABLES = ("l1", "l2", "r", "r0", "p", "alpha0", "l0")

#: What an effect may state a formula for, and its variables.
_QUANTITIES = {"force": VARIABLES, "energy": SHAPE_VARIABLES, "area": SHAPE_VARIABLES, "twist": SHAPE_VARIABLES}


@dataclass(frozen=True)
class Parameter:
    """A number of an effect.

    Numbers are in ``unit``, **not in SI**: ``Parameter("mm", typical=5)`` is 5 mm, and so is ``typical="5 mm"``.
    ``low`` and ``high`` bound it, ``typical`` is a usual value, ``prior`` is what is known beforehand: mean and standard deviation.
    """

    unit: str = "1"
    typical: float | str = 1.0
    low: float | str = 0.0
    high: float | str = 10.0
    prior: tuple[float | str, float | str] | None = None
    about: str = ""

    def __post_init__(self) -> None:
        def plain(name: str, value: float | str) -> float:
            return _bulge.si(name, value, self.unit) / _bulge.unit_factor(self.unit) if isinstance(value, str) else float(value)

        for name in ("typical", "low", "high"):
            object.__setattr__(self, name, plain(name, getattr(self, name)))
        if self.prior is not None:
            mean, sd = self.prior
            object.__setattr__(self, "prior", (plain("prior", mean), plain("prior", sd)))

    def _toml(self) -> str:
        def text(value: float | str) -> str:
            return repr(float(value)) if self.unit == "1" else _quoted(f"{float(value)!r} {self.unit}")

        parts = [f"unit = {_quoted(self.unit)}", f"typical = {text(self.typical)}", f"low = {text(self.low)}", f"high = {text(self.high)}"]
        if self.prior is not None:
            mean, sd = (float(value) for value in self.prior)
            unit = "" if self.unit == "1" else f" {self.unit}"
            parts.append(f"prior = {_quoted(f'{mean!r}{unit} +- {sd!r}{unit}')}")
        if self.about:
            parts.append(f"about = {_quoted(self.about)}")
        return "{ " + ", ".join(parts) + " }"


@dataclass(frozen=True, eq=False)
class Effect:
    """A physical effect of one's own: a force that is added to that of the muscle, or a formula that the shape of the muscle is solved with.

    ``force`` is an expression (``"-k * (eps - eps_free)"``) or a Python function of some of :data:`VARIABLES` and the parameters, by their names:

    >>> import bulge, numpy as np
    >>> def hose(eps, k, eps_free):
    ...     return -k * np.maximum(eps - eps_free, 0)
    >>> effect = bulge.Effect("hose-stiffness", hose, parameters={
    ...     "k": bulge.Parameter("N", typical=50, low=0, high=500),
    ...     "eps_free": bulge.Parameter("1", typical=0.1, low=-0.1, high=0.4)})
    >>> effect.expression
    '(-k) * max(eps - eps_free, 0)'

    A function is called once, with symbols; what it does with them becomes an expression, so that it is differentiated exactly, has its units
    checked, runs on all cores, and travels to other machines. It may use arithmetic, NumPy's ``abs sign sqrt exp log log10 sin cos tan arcsin arctan
    sinh cosh tanh minimum maximum clip where`` and constants with a unit (:func:`quantity`); with arrays it is an ordinary vectorised function.

    Instead of ``force``, one of ``energy`` (of the wall per area at rest [N/m]), ``area`` (on which the pressure acts [m^2]) and ``twist`` (turn of the fibres
    per length of fibre [1/m]) changes the shape; they are formulas of :data:`SHAPE_VARIABLES` and at most six parameters:

    >>> rubber = bulge.Effect("my-rubber", energy="h * c10 * (l1^2 + l2^2 + 1/(l1*l2)^2 - 3)", parameters={
    ...     "c10": bulge.Parameter("MPa", typical=0.3, low=0, high=3),
    ...     "h": bulge.Parameter("mm", typical=2, low=0.5, high=5)})

    ``mechanism`` is one of the catalogue's (``"dry-friction"``, ``"rubber"``, ...), by default that of the family; ``form`` says how exact the
    formula can be: ``"exact"``, ``"near"`` (to 5 %) or ``"loose"`` (to 40 %), by default loose.
    """

    name: str
    force: str | Callable[..., Any] | None = None
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    title: str = ""
    about: str = ""
    source: str = ""
    family: str = ""
    twins: tuple[str, ...] = ()
    mechanism: str = ""
    form: str = ""
    energy: str | Callable[..., Any] | None = None
    area: str | Callable[..., Any] | None = None
    twist: str | Callable[..., Any] | None = None

    def __post_init__(self) -> None:
        if isinstance(self.twins, str):
            object.__setattr__(self, "twins", (self.twins,))
        own = {name: value if isinstance(value, Parameter) else Parameter(**value) for name, value in self.parameters.items()}
        object.__setattr__(self, "parameters", own)
        stated = [key for key in _QUANTITIES if getattr(self, key) is not None]
        if len(stated) != 1:
            raise _bulge.InputError(f"an effect has one formula, for {', '.join(_QUANTITIES)}: this one has {', '.join(stated) or 'none'}")
        # Complaints come here and not at the first use.
        _bulge.effect_names(self.to_toml())

    @property
    def quantity(self) -> str:
        """What it states a formula for: ``"force"``, ``"energy"``, ``"area"`` or ``"twist"``."""
        return next(key for key in _QUANTITIES if getattr(self, key) is not None)

    @property
    def expression(self) -> str:
        """Its formula as an expression."""
        formula = getattr(self, self.quantity)
        return formula if isinstance(formula, str) else _traced(formula, self.quantity, self.parameters)

    def to_toml(self) -> str:
        """The effect as part of an effect file: what ``--effects FILE`` of the command line reads."""
        lines = [f"[effects.{_key(self.name)}]", f"title = {_quoted(self.title or self.name)}", f"{self.quantity} = {_quoted(self.expression)}"]
        texts = {"about": self.about, "source": self.source, "family": self.family, "mechanism": self.mechanism, "form": self.form}
        lines += [f"{key} = {_quoted(value)}" for key, value in texts.items() if value]
        if self.twins:
            lines.append(f"twins = [{', '.join(_quoted(twin) for twin in self.twins)}]")
        lines += [f"parameters.{_key(name)} = {parameter._toml()}" for name, parameter in self.parameters.items()]
        return "\n".join(lines) + "\n"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Effect) and self.to_toml() == other.to_toml()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __reduce__(self) -> Any:
        # A function may be of a notebook; its expression goes anywhere.
        formulas = {key: self.expression if key == self.quantity else None for key in _QUANTITIES}
        words = (self.title, self.about, self.source, self.family, self.twins, self.mechanism, self.form)
        return (Effect, (self.name, formulas.pop("force"), dict(self.parameters), *words, *formulas.values()))


#: Effects of one's own: an effect, a list, or the name of an effect file.
OwnEffects = Union[None, Effect, str, "os.PathLike[str]", Iterable[Union[Effect, str, "os.PathLike[str]"]]]


def own_text(own: OwnEffects) -> str:
    """Effects of one's own as the text of an effect file."""
    if own is None or own == "":
        return ""
    if isinstance(own, Effect):
        return own.to_toml()
    if isinstance(own, (str, os.PathLike)):
        return own if isinstance(own, str) and "\n" in own else read_effects(own)
    return joined(*(own_text(one) for one in own))


def joined(*texts: str) -> str:
    """Texts of effect files as one. An effect that several of them state in the same words is one."""
    parts: dict[tuple[str, str], str] = {}
    for text in texts:
        for name, part in _parts(text):
            parts.setdefault((name, part.strip()), part.strip() + "\n")
    return "\n".join(parts.values())


def _parts(text: str) -> list[tuple[str, str]]:
    """The effects of a text with their names; tables within an effect stay with it."""
    heads = list(re.finditer(r'^\[effects\.("[^"\n]*"|[A-Za-z0-9_-]+)(?:\.[^\n]*)?\]', text, re.MULTILINE))
    ends = [head.start() for head in heads[1:]] + [len(text)]
    found: list[tuple[str, str]] = []
    for head, end in zip(heads, ends):
        name, part = head.group(1).strip('"'), text[head.start() : end]
        if found and found[-1][0] == name:
            found[-1] = (name, found[-1][1] + part)
        else:
            found.append((name, part))
    return found


def read_effects(path: str | os.PathLike[str]) -> str:
    """The text of an effect file, checked."""
    text = read_text(path)
    _bulge.effect_names(text)
    return text


class EffectCard(Result):
    """An effect of the catalogue."""

    _what = "effect"

    def __init__(self, document: dict[str, Any], page: str = "") -> None:
        super().__init__(document)
        self._page = page

    def __repr__(self) -> str:
        return self._page or super().__repr__()

    def _repr_html_(self) -> str:
        import html

        return f"<pre>{html.escape(repr(self))}</pre>"

    def __reduce__(self) -> Any:
        return (EffectCard, (self._document, self._page))


def effects(name: str | None = None, own: OwnEffects = None) -> Any:
    """The catalogue of physical effects: the names of all, or the :class:`EffectCard` of one.

    >>> import bulge
    >>> "coulomb-friction" in bulge.effects()
    True
    >>> bulge.effects("coulomb-friction").equation is not None
    True
    """
    text = own_text(own)
    if name is None:
        return _bulge.effect_names(text)
    page, document = _bulge.effects(name, text)
    return EffectCard(json.loads(document), page)


class _Constant(float):
    """A number with a unit: itself for arrays, and with its unit in expressions."""

    text: str

    def __new__(cls, value: float, text: str) -> _Constant:
        made = super().__new__(cls, value)
        made.text = text
        return made

    def _with(self, operator: str, other: Any, value: Any, turned: bool = False) -> Any:
        """What a calculation with another number gives; of arrays and symbols, what they make of it."""
        if not isinstance(other, (int, float)) or value is NotImplemented:
            return value
        left, right = (_text(other), self.text) if turned else (self.text, _text(other))
        return _Constant(value, f"({left} {operator} {right})")

    def __add__(self, other: Any) -> Any:
        return self._with("+", other, float.__add__(self, other))

    def __radd__(self, other: Any) -> Any:
        return self._with("+", other, float.__radd__(self, other), True)

    def __sub__(self, other: Any) -> Any:
        return self._with("-", other, float.__sub__(self, other))

    def __rsub__(self, other: Any) -> Any:
        return self._with("-", other, float.__rsub__(self, other), True)

    def __mul__(self, other: Any) -> Any:
        return self._with("*", other, float.__mul__(self, other))

    def __rmul__(self, other: Any) -> Any:
        return self._with("*", other, float.__rmul__(self, other), True)

    def __truediv__(self, other: Any) -> Any:
        return self._with("/", other, float.__truediv__(self, other))

    def __rtruediv__(self, other: Any) -> Any:
        return self._with("/", other, float.__rtruediv__(self, other), True)

    def __neg__(self) -> _Constant:
        return _Constant(-float(self), f"(-{self.text})")

    def __abs__(self) -> _Constant:
        return _Constant(abs(float(self)), f"abs({self.text})")

    def __pow__(self, other: Any, modulo: Any = None) -> Any:
        if not isinstance(other, (int, float)):
            return NotImplemented
        return _Constant(float(self) ** other, f"({self.text})^{_in(other, 4)}")


def quantity(text: str) -> float:
    """A constant with a unit for the function of an :class:`Effect`: ``bulge.quantity("50 N")`` is the float 50.0 (SI), whose unit is known."""
    match = re.fullmatch(r"\s*([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*(\S.*?)?\s*", text)
    if match is None:
        raise _bulge.InputError(f"`{text}` is no quantity; write such as \"50 N\"")
    number, unit = match.groups()
    if unit is None:
        return float(number)
    value = float(number) * _bulge.unit_factor(unit)
    return _Constant(value, f"{number} [{unit}]")


class _Condition:
    """A comparison of symbols, for numpy.where."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __bool__(self) -> bool:
        raise TypeError(
            "the force of an effect can't branch on its variables with `if`, `and`, `or`, `min` or `max`: use numpy.where, numpy.minimum, numpy.maximum"
        )

    def _refuse(self, *_: Any) -> Any:
        raise TypeError("the force of an effect can't join comparisons: write one numpy.where inside another")

    __and__ = __rand__ = __or__ = __ror__ = __xor__ = __invert__ = _refuse

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        return _array_function(function, args, kwargs)


#: Characters of an expression; what is used twice stands in it twice.
_LONGEST = 16_000


class _Symbol:
    """A variable of an expression, or what has become of it."""

    __slots__ = ("text", "strength")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, text: str, strength: int = 4) -> None:
        if len(text) > _LONGEST:
            raise _bulge.InputError(f"the force of an effect becomes an expression of more than {_LONGEST} characters: write it with fewer repetitions")
        #: 1 sum, 2 product, 3 power, 4 a name or a call: what needs parentheses where.
        self.text, self.strength = text, strength

    def __add__(self, other: Any) -> _Symbol:
        return _binary("+", self, other)

    def __radd__(self, other: Any) -> _Symbol:
        return _binary("+", other, self)

    def __sub__(self, other: Any) -> _Symbol:
        return _binary("-", self, other)

    def __rsub__(self, other: Any) -> _Symbol:
        return _binary("-", other, self)

    def __mul__(self, other: Any) -> _Symbol:
        return _binary("*", self, other)

    def __rmul__(self, other: Any) -> _Symbol:
        return _binary("*", other, self)

    def __truediv__(self, other: Any) -> _Symbol:
        return _binary("/", self, other)

    def __rtruediv__(self, other: Any) -> _Symbol:
        return _binary("/", other, self)

    def __pow__(self, other: Any) -> _Symbol:
        return _binary("^", self, other)

    def __rpow__(self, other: Any) -> _Symbol:
        return _binary("^", other, self)

    def __neg__(self) -> _Symbol:
        return _Symbol(f"(-{_in(self, 3)})")

    def __pos__(self) -> _Symbol:
        return self

    def __abs__(self) -> _Symbol:
        return _call("abs", self)

    def __lt__(self, other: Any) -> _Condition:
        return _compare("<", self, other)

    def __le__(self, other: Any) -> _Condition:
        return _compare("<=", self, other)

    def __gt__(self, other: Any) -> _Condition:
        return _compare(">", self, other)

    def __ge__(self, other: Any) -> _Condition:
        return _compare(">=", self, other)

    def __eq__(self, other: object) -> bool:
        raise TypeError("the force of an effect can't ask whether numbers are equal: compare with <, <=, > or >=")

    def __bool__(self) -> bool:
        raise TypeError("the force of an effect can't branch on its variables: use numpy.where")

    def __float__(self) -> float:
        raise TypeError("the force of an effect is traced with symbols: use NumPy's functions (numpy.sqrt), not those of math")

    def _refuse(self, *_: Any) -> Any:
        raise TypeError(f"the force of an effect can't do that with its variables: it has {_KNOWN}")

    __floordiv__ = __rfloordiv__ = __mod__ = __rmod__ = __divmod__ = __round__ = __int__ = __index__ = __floor__ = __ceil__ = __trunc__ = _refuse
    __and__ = __rand__ = __or__ = __ror__ = __xor__ = __matmul__ = __rmatmul__ = __getitem__ = __len__ = _refuse

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise TypeError(f"a variable of an effect has no `.{name}`: use functions of NumPy, such as numpy.clip(eps, 0, 1)")

    def __iter__(self) -> Any:
        raise TypeError("a variable of an effect is a number of one moment: it can't be looped over")

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        binary = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/", "true_divide": "/", "power": "^", "float_power": "^"}
        compared = {"less": "<", "less_equal": "<=", "greater": ">", "greater_equal": ">="}
        name = ufunc.__name__
        if method == "__call__" and not kwargs:
            if name in binary:
                return _binary(binary[name], *inputs)
            if name in compared:
                return _compare(compared[name], *inputs)
            if name in _CALLS:
                return _call(_CALLS[name], *inputs)
            if name == "negative":
                return -inputs[0]
            if name == "positive":
                return inputs[0]
            if name == "square":
                return inputs[0] ** 2
            if name == "reciprocal":
                return 1.0 / inputs[0]
            if name == "cbrt":
                raise TypeError(f"the force of an effect can't use numpy.{name}: it has {_KNOWN}")
        raise TypeError(f"the force of an effect can't use numpy.{name}: it has {_KNOWN}")

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        return _array_function(function, args, kwargs)


_CALLS = {
    "absolute": "abs", "fabs": "abs", "sign": "sign", "sqrt": "sqrt", "exp": "exp", "log": "ln", "log10": "log10", "sin": "sin", "cos": "cos",
    "tan": "tan", "arcsin": "asin", "arctan": "atan", "sinh": "sinh", "cosh": "cosh", "tanh": "tanh", "minimum": "min", "maximum": "max",
    "fmin": "min", "fmax": "max", "clip": "clamp",
}  # fmt: skip
_KNOWN = "arithmetic, abs, sign, sqrt, exp, log, log10, sin, cos, tan, arcsin, arctan, sinh, cosh, tanh, minimum, maximum, clip and where"


def _array_function(function: Any, args: Any, kwargs: Any) -> Any:
    if function is np.where and len(args) == 3 and not kwargs:
        condition, left, right = args
        if isinstance(condition, _Condition):
            return _Symbol(f"if({condition.text}, {_text(left)}, {_text(right)})")
        raise TypeError("numpy.where in the force of an effect needs one comparison, such as eps > 0.1")
    if function is np.clip and len(args) == 3 and not kwargs:
        return _call("clamp", *args)
    raise TypeError(f"the force of an effect can't use numpy.{getattr(function, '__name__', function)}: it has {_KNOWN}")


def _text(value: Any) -> str:
    if isinstance(value, _Symbol):
        return value.text
    if isinstance(value, _Constant):
        return f"({value.text})" if value.text.startswith("-") else value.text
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise TypeError(f"the force of an effect can't use {value!r}: its constants are numbers, or quantities such as bulge.quantity(\"50 N\")")
    if not np.isfinite(value):
        raise TypeError(f"the force of an effect has the constant {value!r}: it must be finite")
    text = repr(int(value)) if float(value).is_integer() and abs(float(value)) < 1e15 else repr(float(value))
    return text if float(value) >= 0 else f"({text})"


def _in(value: Any, strength: int) -> str:
    text = _text(value)
    return f"({text})" if isinstance(value, _Symbol) and value.strength < strength else text


def _binary(operator: str, left: Any, right: Any) -> _Symbol:
    if operator == "^":
        return _Symbol(f"{_in(left, 4)}^{_in(right, 4)}", 3)
    strength = 1 if operator in "+-" else 2
    # Equal strengths group from the left.
    return _Symbol(f"{_in(left, strength)} {operator} {_in(right, strength + 1)}", strength)


def _compare(operator: str, left: Any, right: Any) -> _Condition:
    return _Condition(f"{_text(left)} {operator} {_text(right)}")


def _call(name: str, *args: Any) -> _Symbol:
    return _Symbol(f"{name}({', '.join(_text(arg) for arg in args)})")


def _traced(function: Callable[..., Any], quantity: str, parameters: Mapping[str, Parameter]) -> str:
    """What a function does with symbols."""
    names = list(inspect.signature(function).parameters)
    variables = _QUANTITIES[quantity]
    for name in names:
        if name not in (*variables, *parameters):
            raise _bulge.InputError(f"the {quantity} takes `{name}`, which is neither a parameter of the effect nor one of {', '.join(variables)}")
    found = function(**{name: _Symbol(name) for name in names})
    return _text(found)


def _quoted(text: str) -> str:
    return quoted(text)


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _quoted(name)
