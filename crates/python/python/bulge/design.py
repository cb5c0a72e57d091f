"""Muscles put to use: a size for a load, two on a joint, a sensor round them, their heat; and membrane elements.

The documents are those of the command line's ``--json``; the air in a muscle is in :mod:`bulge.air`.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import Any, Union

from bulge import _bulge
from bulge.answers import Answer, frame, plain
from bulge.muscle import Muscle
from bulge.progress import Progress, callback
from bulge.results import Result, number
from bulge.texts import count
from bulge.units import Ends, Quantities, Quantity, listed, optional, si, si_range

#: What :func:`size` looks through unless muscles are named.
MUSCLES = ("dmsp-10", "dmsp-20", "dmsp-40", "ppam-2-r16")
#: Travels [m] with the forces [N] that are needed after them.
Load = Union[str, Iterable[tuple[Quantity, Quantity]]]
#: Length [m] and inner diameter [m] of a pipe; None for no pipe.
PipeLike = Union[None, str, tuple[Quantity, Quantity]]


class Sizing(Answer):
    """Muscles, lengths and pressures for a load: the document of ``bulge size --json``.

    ``choices`` are ranked, the kindest to the muscle's life first; ``infeasible`` says what doesn't carry the load, and why.
    """

    _what = "sizing"

    def _rows(self) -> list[dict[str, Any]]:
        return [plain(c) | {"start_contraction": c["contraction"][0], "end_contraction": c["contraction"][1]} for c in self._document["choices"]]

    def _lines(self) -> list[str]:
        needed = ", ".join(f"{number(at['force_n'])} N after {number(1e3 * at['travel_m'])} mm" for at in self._document["load"])
        refused = len(self._document["infeasible"])
        return [needed] + ([f"{refused} don't carry it: see .infeasible"] if refused else [])

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        rows = [
            [
                c["family"], number(1e3 * c["diameter_m"], 3), number(1e3 * c["length_m"]), number(c["pressure_pa"] / 1e5, 3),
                number(100 * c["contraction"][1], 3), number(100 * c["force_margin"], 2), number(c["strain"], 2),
            ]
            for c in self._document["choices"][:12]
        ]  # fmt: skip
        return [(["muscle", "diameter [mm]", "length [mm]", "pressure [bar]", "contraction [%]", "reserve [%]", "strain of life"], rows)]


def size(
    *,
    force: Quantity | None = None,
    stroke: Quantity | None = None,
    at_rest: Quantity = 0.0,
    load: Load | None = None,
    muscle: str | Muscle | Iterable[str | Muscle] = MUSCLES,
    law: str | None = None,
    table: str | None = None,
    pressure: Quantities | None = None,
    length: Quantities | None = None,
    start: Quantity | None = None,
    max_contraction: Quantity | None = None,
    max_pressure: Quantity | None = None,
    max_length: Quantity | None = None,
    max_force: Quantity | None = None,
    margin: Quantity = 0.0,
    step: Quantity = "1 mm",
) -> Sizing:
    """From a load over a stroke to muscles, lengths and pressures: what ``bulge size`` does.

    ``force`` [N] (or a weight such as ``"50 kg"``) is needed after the ``stroke`` [m], ``at_rest`` before it; or ``load`` has pairs of travel and force.
    ``muscle`` names what is looked through: muscles, shipped ones by name, or "dmsp-10", "dmsp-20", "dmsp-40" by S4's law; ``law`` is another force law of
    the papers in their place, with the numbers of ``table``. With gauge ``pressure`` [Pa] given, the shortest length is sought, with ``length`` [m] the
    lowest pressure, without either all half bars and the best compromise. Raises :class:`bulge.NoSolutionError` if nothing carries the load.

    >>> import bulge
    >>> bulge.size(force="500 N", stroke="50 mm", muscle="dmsp-20", pressure="4 bar").choices[0]["length_m"]
    0.409
    """
    if load is None:
        if force is None or stroke is None:
            raise _bulge.InputError("give force and stroke, such as force=\"500 N\", stroke=\"50 mm\", or load, such as \"0 mm: 100 N, 50 mm: 500 N\"")
        travel = si(stroke, "m", "stroke")
        if travel == 0.0:
            raise _bulge.InputError("the load has no stroke: say what force is needed after what travel, such as 500 N after 50 mm")
        points = [(0.0, _weight(at_rest, "at_rest")), (travel, _weight(force, "force"))]
    elif force is not None or stroke is not None:
        raise _bulge.InputError("load, or force and stroke: give one of the two")
    else:
        points = [(si(travel, "m", "load"), _weight(needed, "load")) for travel, needed in _pairs(load)]
    named = muscle.split(",") if isinstance(muscle, str) else [muscle] if isinstance(muscle, Muscle) else list(muscle)
    muscles: list[tuple[str, _bulge.Muscle | None]] = [(one.name, one._native) if isinstance(one, Muscle) else (one.strip(), None) for one in named]
    limits = [
        optional(max_pressure, "Pa", "max_pressure"), optional(start, "%", "start"), optional(max_contraction, "%", "max_contraction"),
        optional(max_length, "m", "max_length"), None if max_force is None else _weight(max_force, "max_force"),
    ]  # fmt: skip
    pressures, lengths = listed(pressure, "Pa", "pressure"), listed(length, "m", "length") or []
    return Sizing(_bulge.size(points, muscles, law, table, pressures, lengths, limits, si(margin, "%", "margin"), si(step, "m", "step")))


def _weight(value: Quantity, name: str) -> float:
    return _bulge.weight(name, value) if isinstance(value, str) else si(value, "N", name)


def _pairs(load: Load) -> list[tuple[Quantity, Quantity]]:
    pairs = [tuple(part.split(":")) for part in load.split(",")] if isinstance(load, str) else [tuple(pair) for pair in load]
    for pair in pairs:
        if len(pair) != 2:
            raise _bulge.InputError(f"load: {pair!r} is no travel with its force: write such as \"50 mm: 500 N\", or pairs")
    return [(one.strip(), other.strip()) if isinstance(one, str) and isinstance(other, str) else (one, other) for one, other in pairs]


class Joint(Answer):
    """A joint in one state, or over both pressures: the document of ``bulge joint --json``.

    ``stand`` is the state (``stand["angle_rad"]``, ``stand["stiffness_nm_per_rad"]``, ``stand["sides"]``), ``outside`` the torque that holds it at an angle,
    ``map`` the states over both pressures.
    """

    _what = "joint"

    def _rows(self) -> list[dict[str, Any]]:
        d = self._document
        states = d["map"] if "map" in d else [d[key] for key in ("before", "stand") if key in d]

        def row(state: dict[str, Any]) -> dict[str, Any]:
            pressures = state.get("pressures_pa") or [side["pressure_pa"] for side in state["sides"]]
            return {"agonist_pa": pressures[0], "antagonist_pa": pressures[1]} | plain(state)

        return [row(state) for state in states]

    def _lines(self) -> list[str]:
        d = self._document
        lines = [d["name"]]
        if d["outside_nm"]:
            lines.append(f"under {number(d['outside_nm'])} N m from outside")
        if "outside" in d:
            lines.append(f"held by {number(d['outside']['torque_nm'])} +- {number(d['outside']['sd_nm'], 2)} N m from outside")
        return lines

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        def cell(value: float | None, factor: float) -> str:
            return "-" if value is None else number(factor * value)

        rows = [
            [number(r["agonist_pa"] / 1e5), number(r["antagonist_pa"] / 1e5), cell(r.get("angle_rad"), 180 / 3.141592653589793), cell(r.get("stiffness_nm_per_rad"), 1.0)]
            for r in self._rows()
        ]
        return [(["agonist [bar]", "antagonist [bar]", "angle [deg]", "stiffness [N m/rad]"], rows)]


def joint(
    source: str | os.PathLike[str],
    *,
    pressure: Quantities | None = None,
    angle: Quantity | None = None,
    stiffness: Quantity | None = None,
    torque: Quantity | None = None,
    closed: str | None = None,
    dead_volume: Quantity | None = None,
    pressure_sd: Quantity | None = None,
    angle_sd: Quantity | None = None,
    force_sd: Quantity | None = None,
) -> Joint:
    """Two antagonistic muscles on a joint: what ``bulge joint`` does. ``source`` is a joint file, or its text (which has line breaks).

    With two gauge pressures [Pa] (agonist, antagonist): the angle at which it rests, under a ``torque`` from outside [N m]; ``closed`` ("isothermal",
    "adiabatic") shuts both valves before the torque acts. With pressures and an ``angle`` [rad]: the torque from outside that holds it there, and how sure that
    is by the deviations of the readings. With an angle and a ``stiffness`` [N m/rad]: the pressures. Without any: its range over both pressures.
    """
    readings = [optional(pressure_sd, "Pa", "pressure_sd"), optional(angle_sd, "rad", "angle_sd"), optional(force_sd, "N", "force_sd")]
    return Joint(
        _bulge.joint(
            _source(source, "joint"), listed(pressure, "Pa", "pressure"), optional(angle, "rad", "angle"), optional(stiffness, "N m/rad", "stiffness"),
            optional(torque, "N m", "torque"), closed, optional(dead_volume, "m^3", "dead_volume"), readings,
        )
    )  # fmt: skip


def _source(source: str | os.PathLike[str], what: str) -> tuple[str | None, str]:
    """The text of a file with what messages call it, or no text and its path."""
    return (source, what) if isinstance(source, str) and "\n" in source else (None, os.fspath(source))


class Sensing(Answer):
    """A channel of liquid metal wound round a muscle: the document of ``bulge sense --json``.

    ``curve`` has the ``readings`` and how straight they are, ``resolution`` what the noise makes of the contraction, ``winding`` the place (the best one,
    if it was sought among those ``scanned``).
    """

    _what = "sensor"

    def _rows(self) -> list[dict[str, Any]]:
        curve = self._document["curve"]
        return [plain(reading) | {"gauge_factor": slope} for reading, slope in zip(curve["readings"], curve["sensitivity"])]

    def _lines(self) -> list[str]:
        d = self._document
        w, line, worst = d["winding"], d["curve"]["linearity"], d["resolution"]
        lines = [f"{d['muscle']}: {number(w['turns'])} turns from {number(100 * w['start'], 3)} to {number(100 * w['end'], 3)} % of the fibres"]
        if line:
            lines.append(f"gauge factor {number(line['mean_sensitivity'])} in the mean, off the best straight line by {number(line['best_fit_percent'], 3)} % of full scale")
        return lines + [f"the noise is {number(100 * worst['worst'], 2)} % of contraction at worst, {number(1e3 * worst['worst_m'], 2)} mm"]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        rows = self._rows()
        shown = rows[:: max(1, -(-(len(rows) - 1) // 10))]
        cells = [[number(100 * r["contraction"]), number(r["resistance_ohm"], 5), number(100 * r["relative_change"]), number(r["gauge_factor"])] for r in shown]
        return [(["contraction [%]", "resistance [ohm]", "change [%]", "gauge factor"], cells)]


def sense(
    muscle: Muscle,
    *,
    pressure: Quantity = "1 bar",
    contraction: Ends = "5 %..30 %",
    points: int = 101,
    turns: float = 20.0,
    zone: Ends = "30 %..70 %",
    channel: Quantity = "0.25 mm",
    offset: Quantity = "0.5 mm",
    noise: Quantity = "1 mohm",
    best: Quantity | None = None,
    least_gauge_factor: float | None = None,
) -> Sensing:
    """A channel of liquid metal wound round a muscle, whose resistance tells the contraction: what ``bulge sense`` does.

    ``turns`` of a round ``channel`` of this diameter [m] lie ``offset`` [m] outside the fibres in a ``zone`` of their length; ``noise`` is the standard
    deviation of the resistance that is read [ohm]. ``best`` seeks the best place for a zone of this width: the most sensitive one, or the straightest
    with a gauge factor of at least ``least_gauge_factor``.
    """
    if least_gauge_factor is not None and best is None:
        raise _bulge.InputError("least_gauge_factor: it chooses among places: give best too, such as best=\"40 %\"")
    return Sensing(
        _bulge.sense(
            muscle._native, si(pressure, "Pa", "pressure"), si_range(contraction, "%", "contraction"), count("points", points, 11), float(turns),
            si_range(zone, "%", "zone"), si(channel, "m", "channel"), si(offset, "m", "offset"),
            _bulge.resistance("noise", noise) if isinstance(noise, str) else si(noise, "ohm", "noise"),
            optional(best, "%", "best"), None if least_gauge_factor is None else float(least_gauge_factor),
        )
    )  # fmt: skip


class Heat(Answer):
    """How warm a muscle gets with each of some pipes: the document of ``bulge heat --json``. ``cases`` have the ``pipe`` with its ``solution``, or with
    ``why`` there is none."""

    _what = "heat"

    def _rows(self) -> list[dict[str, Any]]:
        return [_pipe_row(case) | plain(case.get("solution", {"why": case.get("why")})) for case in self._document["cases"]]

    def _lines(self) -> list[str]:
        tube, drive = self._document["problem"]["tube"], self._document["problem"]["drive"]
        return [
            f"a muscle of {number(1e3 * tube['length_m'])} mm, {number(1e3 * tube['inner_diameter_m'], 3)} mm wide, charged from {number(drive['low_pa'] / 1e5, 3)} to "
            f"{number(drive['high_pa'] / 1e5, 3)} bar every {number(drive['period_s'], 3)} s; mean wall temperatures above the ambient"
        ]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        rows = []
        for case in self._document["cases"]:
            pipe, found = case["pipe"], case.get("solution")
            name = "none" if pipe is None else f"{number(1e3 * pipe['length_m'], 3)} x {number(1e3 * pipe['inner_diameter_m'], 2)} mm"
            rows.append([name, *(number(found[key], 3) if found else "-" for key in ("end_rise_k", "inlet_rise_k", "hottest_rise_k", "time_to_90_s"))])
        return [(["pipe", "closed end [K]", "inlet [K]", "hottest [K]", "90 % after [s]"], rows)]


def _pipe_row(case: dict[str, Any]) -> dict[str, Any]:
    pipe = case["pipe"] or {"length_m": 0.0, "inner_diameter_m": 0.0}
    return {"pipe_length_m": pipe["length_m"], "pipe_diameter_m": pipe["inner_diameter_m"]}


def heat(
    *,
    length: Quantity = "250 mm",
    diameter: Quantity = "20 mm",
    wall: Quantity = "1.5 mm",
    port: Quantity = "6 mm",
    pressure: Ends = "0 bar..5 bar",
    period: Quantity = "1 s",
    ramp: Quantity = "0.2 s",
    duty: Quantity = "50 %",
    pipe: str | Iterable[PipeLike] = "none, 100 mm x 4 mm, 200 mm x 4 mm, 200 mm x 6 mm",
    cells: int = 40,
) -> Heat:
    """How warm a muscle gets that is charged again and again, with each inner ``pipe``: what ``bulge heat`` does.

    ``length``, inner ``diameter``, ``wall`` and ``port`` are lengths [m], ``pressure`` the gauge pressures between which it is charged [Pa], ``period``, and
    ``ramp`` of a change, times [s]. A pipe is ``"200 mm x 4 mm"`` or ``(0.2, 0.004)`` (length and inner diameter), "none" or None is none. Trends can be
    trusted, absolute temperatures only after a measurement has fixed the coefficients. More ``cells`` are more exact.
    """
    pipes: list[PipeLike] = [word.strip() for word in pipe.split(",")] if isinstance(pipe, str) else list(pipe)
    tube = [si(length, "m", "length"), si(diameter, "m", "diameter"), si(wall, "m", "wall"), si(port, "m", "port")]
    times = [si(period, "s", "period"), si(ramp, "s", "ramp")]
    return Heat(_bulge.heat(tube, si_range(pressure, "Pa", "pressure"), times, si(duty, "%", "duty"), [_pipe(one) for one in pipes], count("cells", cells, 1)))


def _pipe(pipe: PipeLike) -> tuple[float, float] | None:
    if pipe is None or pipe == "none":
        return None
    parts = [part.strip() for part in pipe.split("x")] if isinstance(pipe, str) else list(pipe)
    if len(parts) != 2:
        raise _bulge.InputError(f"pipe: {pipe!r} is no pipe: write length x inner diameter, such as \"200 mm x 4 mm\", or none")
    return si(parts[0], "m", "pipe"), si(parts[1], "m", "pipe")


class MembraneRun(Result):
    """The states of a membrane case: the document of ``bulge membrane --json``; ``states`` are its rows, ``effect`` what was learnt from them."""

    _what = "membrane run"

    def to_pandas(self) -> Any:
        """The states as a DataFrame; pairs (smallest and largest) have two columns."""
        pairs = ("membrane_force_n_per_m", "fibre_tension_n")
        rows = [
            plain(state) | {f"{which}_{key}": state[key][k] for key in pairs for k, which in enumerate(("least", "largest"))} for state in self._document["states"]
        ]
        return frame(rows)

    @property
    def learnt(self) -> Muscle:
        """The muscle of the case with the effect of its cloth, where ``as_effect=True`` was asked for."""
        if self._document["effect"] is None:
            raise _bulge.InputError("this run has learnt nothing: ask for it with bulge.membrane(..., as_effect=True)")
        return Muscle.from_toml(self._document["effect"]["model"])

    def _lines(self) -> list[str]:
        d = self._document
        return [f"{d['name']}: {d['nodes']} nodes, {d['elements']} elements, {d['unknowns']} unknowns, {d['effort']['iterations']} iterations"]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        def percent(value: float | None) -> str:
            return "-" if value is None else number(100 * value)

        rows = [
            [str(s["state"]), number(s["pressure_pa"] / 1e5), percent(s["contraction"]), number(s["force_n"]), number(1e6 * s["volume_m3"]), number(1e3 * s["largest_diameter_m"])]
            for s in self._document["states"]
        ]
        return [(["state", "pressure [bar]", "contraction [%]", "force [N]", "volume [ml]", "diameter [mm]"], rows)]


def membrane(
    case: str | os.PathLike[str],
    out: str | os.PathLike[str] | None = None,
    *,
    whole: bool = False,
    as_effect: bool = False,
    progress: Progress = None,
) -> MembraneRun:
    """A finite-element membrane case, state by state: what ``bulge membrane`` does. ``case`` is a case file, or its text (which has line breaks).

    Files go into the folder ``out``, if that is given: states.csv, forces.csv, a ``.vtu`` for each state and a ``.pvd``; ``whole`` draws the whole muscle in each.
    ``as_effect`` fits `limited-unfolding` to the states: what the cloth costs, in :attr:`MembraneRun.learnt`. Raises :class:`bulge.NoSolutionError` or
    :class:`bulge.NotConvergedError` at the first state without equilibrium; the states before it are in the folder.
    """
    folder = None if out is None else os.fspath(out)
    with callback(progress, "membrane") as told:
        return MembraneRun(json.loads(_bulge.membrane(_source(case, "case"), folder, bool(whole), bool(as_effect), told)))
