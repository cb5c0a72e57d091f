"""Model against measurement: compare, diagnose, fit, plan, next experiment, simulate. The documents are those of the command line's ``--json``."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bulge import _bulge
from bulge.effects import OwnEffects, joined, own_text
from bulge.measurements import Data, DataLike, measured
from bulge.muscle import Muscle, effect_units
from bulge.optional import need
from bulge.progress import Progress, callback
from bulge.results import Result, number, rung_names
from bulge.statements import Bounded, Held, Lines, Tied, said
from bulge.texts import count, read_text, write_whole
from bulge.units import FloatArray, Quantity, si, si_range


class _Reported(Result):
    """A result with a report. Pickled, it keeps its numbers and leaves the report behind."""

    _file = "result.json"

    def __init__(self, native: Any, document: dict[str, Any] | None = None) -> None:
        super().__init__(json.loads(native.document()) if document is None else document)
        self._native = native

    def _whole(self) -> Any:
        if self._native is None:
            raise _bulge.InputError(f"this {self._what} has travelled and left its report behind: make it again where it is drawn")
        return self._native

    def to_html(self) -> str:
        """The report: a page that stands for itself, without network; its rows can be asked."""
        page: str = self._whole().html()
        return page

    def svgs(self) -> dict[str, str]:
        """The plots of the report as SVG, by name."""
        return {name: svg for name, _, svg in self._whole().plots()}

    def report(self, folder: str | os.PathLike[str]) -> Path:
        """Writes report.html, its plots and the document into a folder; returns the page."""
        page, drawings = self.to_html(), self.svgs()
        into = Path(folder)
        into.mkdir(parents=True, exist_ok=True)
        write_whole(into / self._file, (self.to_json() + "\n").encode())
        for name, svg in drawings.items():
            write_whole(into / f"{name}.svg", svg.encode())
        write_whole(into / "report.html", page.encode())
        return into / "report.html"

    def __copy__(self) -> Any:
        return self

    def __deepcopy__(self, memo: Any) -> Any:
        return self

    def __reduce__(self) -> Any:
        return (type(self), (None, self._document))


def _ladder(document: Mapping[str, Any]) -> tuple[list[str], list[list[str]]]:
    ladder = document["ladder"]
    names = rung_names(ladder, "the muscle as stated")
    rows = [[name, number(rung["rmse_n"], 3), number(rung.get("held_out_rmse_n"), 3)] for name, rung in zip(names, ladder)]
    return ["model", "error [N]", "held out [N]"], rows


def _parameters(fit: Mapping[str, Any] | None) -> tuple[list[str], list[list[str]]]:
    rows = [
        [f"{p['effect']} {p['name']}", number(p["value"]), f"{number(p['low'])} to {number(p['high'])}", "" if p["unit"] == "1" else p["unit"]]
        for p in (fit or {}).get("parameters", [])
    ]
    return ["fitted", "value", "95 %", "unit"], rows


class Comparison(_Reported):
    """Model against measurement, and the error as effects are added: the document of ``bulge compare --json``."""

    _what, _file = "comparison", "compare.json"

    @property
    def columns(self) -> dict[str, Any]:
        """The rows: arrays by name, each of shape ``(rows,)``, in the order of the data.

        ``file``, ``line`` (or number of the row, from 1), ``sweep`` (of a path), ``specimen``, ``counts`` (whether the row enters errors and fits),
        ``time_s`` (where it was read), ``pressure_pa``, ``contraction``, ``measured_n``, ``base_n`` (of the muscle as stated), ``model_n`` (with
        the effects) and ``residual_n`` (measured less ``model_n``). What is unknown is NaN.
        """
        return {name: np.asarray(values) for name, values in self._whole().columns().items()}

    @property
    def residuals(self) -> FloatArray:
        """Measured force less that of the model with the effects [N], of each row; NaN where a row has no state."""
        found: FloatArray = self.columns["residual_n"]
        return found

    def to_pandas(self) -> Any:
        """The rows as a DataFrame: see :attr:`columns`."""
        return need("pandas", "a data frame", "pandas").DataFrame(self.columns)

    def plot(self, ax: Any = None) -> Any:
        """Draws measured and computed force; returns the axes (matplotlib)."""
        from bulge.plots import compared

        return compared(self, ax)

    def _lines(self) -> list[str]:
        d = self._document
        floor = d["noise_floor"]
        lines = [f"{d['muscle']} against {', '.join(d['data']['files'])}: {d['data']['used']} rows"]
        if floor:
            lines.append(f"noise floor {number(floor['sd_n'], 3)} N ({floor['source']})")
        return lines + [f"! {warning}" for warning in d["warnings"]]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        return [_ladder(self._document), _parameters(self._document["ladder"][-1].get("fit"))]


class Diagnosis(_Reported):
    """What is missing, and how sure that is: the document of ``bulge diagnose --json``.

    ``verdict`` is "missing", "adequate", "unknown" or "cannot-tell"; ``missing`` lists the effects in the order of adding, each with its
    ``class`` (all effects that these data can't tell from it), ``confidence`` and ``parameters``.
    """

    _what, _file = "diagnosis", "diagnosis.json"

    def __init__(self, native: Any, document: dict[str, Any] | None = None, headlines: list[str] | None = None) -> None:
        super().__init__(native, document)
        self._headlines: list[str] = native.headlines() if headlines is None else headlines

    @property
    def says(self) -> list[str]:
        """The verdict in sentences."""
        return list(self._headlines)

    @property
    def names(self) -> list[str]:
        """Names of the missing effects."""
        return [missing["effect"] for missing in self._document["missing"]]

    def plot(self, ax: Any = None) -> Any:
        """Draws how the error falls; returns the axes (matplotlib)."""
        from bulge.plots import ladder

        return ladder(self, ax)

    def _lines(self) -> list[str]:
        lines = list(self._headlines)
        following = self._document.get("next_experiment")
        return lines + ([f"next: {following['says']}"] if following and following.get("says") else [])

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        rows = [
            [missing["effect"], f"{100 * missing['confidence']:.0f} %", ", ".join(name for name in missing["class"] if name != missing["effect"]) or "-"]
            for missing in self._document["missing"]
        ]
        return [(["missing", "confidence", "not told from"], rows), _ladder(self._document)]

    def __reduce__(self) -> Any:
        return (Diagnosis, (None, self._document, self._headlines))


class Fit(Result):
    """Fitted effects: the document of ``bulge fit --json``; ``fit.learnt`` is the muscle with what was learnt.

    With ``form_error=True`` there are ``fit.bent``, how much the data bend the formulas, and ``fit.drawn``, the forms that the data want as effects
    of one's own.
    """

    _what = "fit"

    def __init__(self, document: dict[str, Any], own: str = "", native: _bulge.Fit | None = None) -> None:
        super().__init__(document)
        self._own = own
        self._native = native
        self._comparison: Comparison | None = None

    def _compared(self) -> Comparison:
        """The comparison whose last rung is this fit; it is computed once, and takes as long as the fit."""
        if self._comparison is None:
            if self._native is None:
                raise _bulge.InputError(f"this {self._what} has travelled and left its rows behind: make it again where they are needed")
            self._comparison = Comparison(self._native.comparison())
        return self._comparison

    @property
    def columns(self) -> dict[str, Any]:
        """The rows, measured and fitted: see :attr:`Comparison.columns`. Computed when first asked for, which takes as long as the fit."""
        return self._compared().columns

    @property
    def residuals(self) -> FloatArray:
        """Measured less fitted force [N] of each row; NaN where a row has no state."""
        return self._compared().residuals

    def to_pandas(self) -> Any:
        """The rows as a DataFrame: see :attr:`columns`."""
        return self._compared().to_pandas()

    def plot(self, ax: Any = None) -> Any:
        """Draws measured and fitted force, dotted the muscle as stated; returns the axes (matplotlib)."""
        return self._compared().plot(ax)

    @property
    def names(self) -> list[str]:
        """Names of the fitted numbers with their units, as rows and columns of :attr:`covariance` have them."""
        return [_named(p) for p in (self._document["fit"] or {}).get("parameters", [])]

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the fitted numbers, in products of the units of :attr:`names`; NaN where the data don't determine one.

        ``pandas.DataFrame(fit.covariance, fit.names, fit.names)`` is a table with names.
        """
        return _matrix((self._document["fit"] or {}).get("covariance", []), len(self.names))

    @property
    def correlation(self) -> FloatArray:
        """Correlations of the fitted numbers."""
        return _matrix((self._document["fit"] or {}).get("correlations", []), len(self.names))

    def posterior(self, seed: int = 1) -> Posterior:
        """Draws of the posterior of the fitted numbers, their quantiles, and their profile likelihoods: what ``bulge fit --posterior`` computes.

        The same ``seed`` gives the same draws.
        """
        if self._native is None:
            raise _bulge.InputError(f"this {self._what} has travelled and left its rows behind: make it again where they are needed")
        document, draws, picture = self._native.posterior(count("seed", seed, 0))
        return Posterior(json.loads(document), draws, picture)

    @property
    def learnt(self) -> Muscle:
        """The muscle with what was learnt, for :meth:`Muscle.force`, the next comparison, or a file (``fit.learnt.to_toml("learnt.toml")``)."""
        return Muscle.from_toml(self._document["model"], self._own)

    def _forms(self) -> list[dict[str, Any]]:
        drawn = self._document.get("drawn")
        if drawn is None:
            raise _bulge.InputError("this fit has drawn no forms: ask for them with bulge.fit(..., form_error=True)")
        forms: list[dict[str, Any]] = drawn["forms"]
        return forms

    @property
    def drawn(self) -> str:
        """The forms that the data want, as the text of an effect file with the drawing in its comments: for ``own=``, or a file for ``--effects``.

        Each effect has the name that :attr:`bent` gives as ``written``. Empty where there is no form to write; ``says`` in :attr:`bent` tells why.
        """
        return "\n".join(form["toml"] for form in self._forms() if form["toml"])

    @property
    def bent(self) -> list[dict[str, Any]]:
        """How much the data bend the formula of each effect that was fitted.

        ``effect`` is its name, ``share`` the part of the effect by which it is bent, in units of the noise (0 where the formula holds, or is exact),
        ``newtons`` the RMS of what is added to the formula, ``written`` the name of the effect in :attr:`drawn` (None where none is written),
        ``says`` the same in a sentence.
        """

        def one(form: dict[str, Any]) -> dict[str, Any]:
            error = form["form_error"] or {"share": 0.0, "rms_n": 0.0}
            return {"effect": form["effect"], "share": error["share"], "newtons": error["rms_n"], "written": form["written"], "says": form["says"]}

        return [one(form) for form in self._forms()]

    def _lines(self) -> list[str]:
        d = self._document
        lines = [f"{d['muscle']} fitted to {', '.join(d['data']['files'])}: error {number(d['before_rmse_n'], 3)} N before, {number(d['rmse_n'], 3)} N after"]
        return lines + [form["says"] for form in d.get("drawn", {}).get("forms", [])]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        return [_parameters(self._document["fit"])]

    def __reduce__(self) -> Any:
        return (Fit, (self._document, self._own))


class Posterior(Result):
    """The posterior of a fit: ``parameters`` with their ``quantiles`` (2.5, 16, 50, 84, 97.5 %), ``profile`` (value, twice the fall of the log
    likelihood) and ``r_hat``; ``draws`` (draw, number).
    """

    _what = "posterior"

    def __init__(self, document: dict[str, Any], draws: FloatArray, picture: str | None) -> None:
        super().__init__(document)
        self._draws, self._picture = draws, picture

    @property
    def draws(self) -> FloatArray:
        """The draws: a row each, with the numbers in the units of :attr:`names`."""
        return self._draws

    @property
    def names(self) -> list[str]:
        """Names of the numbers with their units."""
        return [_named(p) for p in self._document["parameters"]]

    def to_pandas(self) -> Any:
        """The draws as a DataFrame."""
        return need("pandas", "a data frame", "pandas").DataFrame(self._draws, columns=self.names)

    @property
    def svg(self) -> str:
        """The picture of ``bulge fit --posterior``: each number alone with its profile likelihood, and each pair."""
        if self._picture is None:
            raise _bulge.InputError("nothing is drawn: only numbers of the rig were fitted, or none")
        return self._picture

    def _repr_svg_(self) -> str | None:
        return self._picture

    def _lines(self) -> list[str]:
        return [f"posterior of {len(self.names)} numbers, {self._document['count']} draws"]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        rows = []
        for name, p in zip(self.names, self._document["parameters"]):
            low, below, middle, above, high = (number(x) for x in p["quantiles"])
            rows.append([name, middle, f"{below} to {above}", f"{low} to {high}", f"{p['r_hat']:.3f}"])
        return [(["number", "median", "68 %", "95 %", "r-hat"], rows)]

    def __reduce__(self) -> Any:
        return (Posterior, (self._document, self._draws, self._picture))


def _named(p: Mapping[str, Any]) -> str:
    specimen = f"[{p['specimen']}]" if p["specimen"] else ""
    return f"{p['effect']}.{p['name']}{specimen}" + ("" if p["unit"] == "1" else f" [{p['unit']}]")


def _matrix(values: list[float | None], size: int) -> FloatArray:
    return np.array(values, dtype=np.float64).reshape(size, size)


class Plan(Result):
    """What a test would show: the document of ``bulge plan --json``."""

    _what = "plan"

    def _lines(self) -> list[str]:
        d = self._document
        return [f"{d['muscle']}, before measuring: {d['rows']} rows in {d['sweeps']} sweeps", *(f"! {warning}" for warning in d.get("warnings", []))]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        rows = [
            [e["effect"], number(e.get("detection_limit"), 3), "" if e.get("unit") in (None, "1") else e["unit"], number(e.get("detection_limit_n"), 3)]
            for e in self._document["effects"]
        ]
        return [(["effect", "seen from", "unit", "force [N]"], rows)]


class NextExperiment(Result):
    """The next experiment: the document of ``bulge next --json``; ``says`` is the advice."""

    _what = "next experiment"

    def _lines(self) -> list[str]:
        d = self._document
        named = f": {', '.join(missing['effect'] for missing in d['missing'])}" if d["missing"] else ""
        return [f"verdict {d['verdict']}{named}", d["says"]]


class Simulation(Result):
    """Simulated measurements: ``data``, the ``muscle`` as stated (it knows nothing of what is hidden), and the truth as the document."""

    _what = "simulation"

    def __init__(self, csv: str, muscle: str, document: dict[str, Any], own: str = "") -> None:
        super().__init__(document)
        self._csv, self._muscle, self._own = csv, muscle, own

    @property
    def csv(self) -> str:
        """The text of the data file."""
        return self._csv

    @property
    def data(self) -> Data:
        """The measurements."""
        from bulge.measurements import _data_of

        return _data_of("csv", (self._csv, "data.csv"), None, None)

    @property
    def muscle(self) -> Muscle:
        """The muscle as stated."""
        return Muscle.from_toml(self._muscle, self._own)

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes data.csv, muscle.toml and truth.json, as ``bulge simulate --out``."""
        into = Path(folder)
        into.mkdir(parents=True, exist_ok=True)
        for name, text in [("data.csv", self._csv), ("muscle.toml", self._muscle), ("truth.json", self.to_json() + "\n")]:
            write_whole(into / name, text.encode())

    def _lines(self) -> list[str]:
        d = self._document
        hidden = ", ".join(effect["effect"] for effect in d["effects"]) or "nothing"
        return [f"{d['rows']} rows of {self._document['muscle']}, seed {d['seed']}; hidden: {hidden}"]

    def __reduce__(self) -> Any:
        return (Simulation, (self._csv, self._muscle, self._document, self._own))


def compare(
    data: DataLike,
    muscle: Muscle,
    with_: Iterable[str] | str = (),
    *,
    own: OwnEffects = None,
    law: str | None = None,
    fit_law: bool = False,
    rivals: bool = False,
    exclude: Lines = None,
    hold: Held = None,
    bound: Bounded = None,
    tie: Tied = None,
    loss: str = "squares",
) -> Comparison:
    """Compares the model with measurements: what ``bulge compare`` does.

    ``data`` is what :func:`bulge.read` takes; ``with_`` names effects to fit, in their order; ``own`` are effects of one's own; ``law`` is a force
    law of the papers as the base (``fit_law``: fitted); ``rivals`` fits every law for comparison.

    ``exclude`` leaves rows out by their lines in the file: ``"12,33-40"`` or ``range(33, 41)``. ``hold`` holds numbers of effects at values,
    ``{"bladder-elasticity.modulus": "0.31 MPa"}``; ``bound`` keeps them between two, ``{"coulomb-friction.force": ("5 N", "20 N")}``; ``tie``
    gives a number the value of another, ``{"force-lag.time": "pressure-lag.time"}``. Floats are SI. Raises :class:`bulge.InputError` if there is no
    such line or number, a value is out of the bounds of its effect, or a number that isn't fitted is meant.

    ``loss`` is what a reading contributes that lies far off: ``"squares"``, or less than that with ``"huber"``, ``"soft-l1"`` or ``"cauchy"``, so that
    spikes pull less.
    """
    stated = said(exclude, hold, bound, tie)
    return Comparison(_bulge.compare(measured(data, muscle)._native, muscle._native, _names(with_), own_text(own), law, fit_law, rivals, loss, stated))


def diagnose(
    data: DataLike,
    muscle: Muscle,
    with_: Iterable[str] | str = (),
    *,
    own: OwnEffects = None,
    among: Iterable[str] | str = (),
    tolerance: Quantity | None = None,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = None,
    exclude: Lines = None,
    hold: Held = None,
    bound: Bounded = None,
    tie: Tied = None,
) -> Diagnosis:
    """Finds which physical effect is missing, and how sure that is: what ``bulge diagnose`` does.

    ``tolerance`` is the RMS misfit [N] that doesn't matter. The same ``seed`` gives the same answer, on any number of
    ``threads`` [default: all cores]. ``own`` effects are looked for too; ``among`` names the effects that alone are looked for.
    ``exclude``, ``hold``, ``bound`` and ``tie`` are those of :func:`compare`.
    """
    if threads is not None:
        threads = count("threads", threads, 1, 1024)
    allowed = None if tolerance is None else si(tolerance, "N", "tolerance")
    rows, stated = measured(data, muscle), said(exclude, hold, bound, tie)
    with callback(progress, "diagnose") as told:
        return Diagnosis(
            _bulge.diagnose(
                rows._native, muscle._native, _names(with_), own_text(own), _names(among), allowed, count("seed", seed, 0), threads, stated, told
            )
        )


def fit(
    data: DataLike,
    muscle: Muscle,
    with_: Iterable[str] | str,
    *,
    own: OwnEffects = None,
    form_error: bool = False,
    exclude: Lines = None,
    hold: Held = None,
    bound: Bounded = None,
    tie: Tied = None,
    loss: str = "squares",
) -> Fit:
    """Fits effects, and gives the muscle that has learnt them: what ``bulge fit`` does. Raises :class:`bulge.NotConvergedError`.

    ``form_error`` also draws the form that the data want of each effect, as ``bulge fit --form-error`` does: :attr:`Fit.bent` says how much the
    formulas are bent, and :attr:`Fit.drawn` are effects of one's own with these forms. ``exclude``, ``hold``, ``bound``, ``tie`` and ``loss`` are
    those of :func:`compare`.
    """
    names = _names(with_)
    if not names:
        raise _bulge.InputError("with_: name the effects to fit, such as [\"end-taper\", \"bladder-elasticity\"]")
    text = own_text(own)
    native = _bulge.fit(measured(data, muscle)._native, muscle._native, names, text, bool(form_error), loss, said(exclude, hold, bound, tie))
    return Fit(json.loads(native.document()), joined(muscle._native.own, text), native)


def plan(muscle: Muscle, protocol: str | os.PathLike[str], *, own: OwnEffects = None) -> Plan:
    """What a test would show before it is made: detection limits, and effects that it could not tell apart (``bulge plan``).

    ``protocol`` is a protocol file, or its text.
    """
    text, origin = _protocol(protocol)
    return Plan(json.loads(_bulge.plan(muscle._native, text, origin, own_text(own))))


def next_experiment(
    data: DataLike,
    muscle: Muscle,
    with_: Iterable[str] | str = (),
    *,
    own: OwnEffects = None,
    pressure: str | tuple[Quantity, Quantity] | None = None,
    contraction: str | tuple[Quantity, Quantity] | None = None,
    seed: int = 1,
    progress: Progress = None,
    exclude: Lines = None,
    hold: Held = None,
    bound: Bounded = None,
    tie: Tied = None,
) -> NextExperiment:
    """The experiment that best separates the effects that measurements leave open (``bulge next``), within ranges such as ``"1 bar..6 bar"``.

    ``exclude``, ``hold``, ``bound`` and ``tie`` are those of :func:`compare`.
    """
    limits = [
        None if value is None else si_range(value, unit, name)
        for value, unit, name in [(pressure, "Pa", "pressure"), (contraction, "%", "contraction")]
    ]
    rows, stated = measured(data, muscle), said(exclude, hold, bound, tie)
    with callback(progress, "next experiment") as told:
        document = _bulge.next_experiment(
            rows._native, muscle._native, _names(with_), own_text(own), limits[0], limits[1], count("seed", seed, 0), stated, told
        )
    return NextExperiment(json.loads(document))


def simulate(
    muscle: Muscle,
    protocol: str | os.PathLike[str],
    with_: Mapping[str, Any] | Iterable[str] | str = (),
    *,
    own: OwnEffects = None,
    seed: int = 1,
) -> Simulation:
    """Synthetic measurements with hidden effects, noise and rig errors (``bulge simulate``); the same seed gives the same bytes.

    ``with_`` names effects, with numbers where they are not the usual ones: ``{"coulomb-friction": "14 N", "end-taper": None}`` or
    ``["coulomb-friction=14 N", "end-taper"]``; floats are SI; several numbers of one effect as ``{"presliding-hysteresis": ("12 N", "1 %")}`` or by key.
    """
    text, origin = _protocol(protocol)
    own_effects = own_text(own)
    known = joined(muscle._native.own, own_effects)
    hidden = _hidden(with_, effect_units(known))
    csv, stated, truth = _bulge.simulate(muscle._native, text, origin, hidden, own_effects, count("seed", seed, 0))
    return Simulation(csv, stated, json.loads(truth), known)


def _hidden(with_: Mapping[str, Any] | Iterable[str] | str, units: Mapping[str, str]) -> list[str]:
    """Effects with their numbers as the command line takes them; ``units`` are those of floats."""

    def text(value: Any, unit: str) -> str:
        return value if isinstance(value, str) else f"{float(value)!r} {unit}".removesuffix(" 1")

    if not isinstance(with_, Mapping):
        return _names(with_)
    items: list[str] = []
    for name, value in with_.items():
        if value is None:
            items.append(name)
        elif isinstance(value, Mapping):
            items += [f"{name}.{key}={text(one, units.get(f'{name}.{key}', '1'))}" for key, one in value.items()]
        else:
            values = list(value) if isinstance(value, (tuple, list)) else [value]
            own = [unit for key, unit in units.items() if key.startswith(f"{name}.")] + ["1"] * len(values)
            written = [text(one, unit) for one, unit in zip(values, own)]
            items += [f"{name}={written[0]}", *written[1:]] if written else [name]
    return items


def _names(names: Iterable[str] | str) -> list[str]:
    return [name.strip() for name in names.split(",") if name.strip()] if isinstance(names, str) else [str(name) for name in names]


def _protocol(protocol: str | os.PathLike[str]) -> tuple[str, str]:
    if isinstance(protocol, str) and "\n" in protocol:
        return protocol, "protocol"
    return read_text(protocol), os.fspath(protocol)
