"""The air in a muscle: shut in, flowing through a valve, and used in a stroke: what ``bulge air`` does.

>>> import bulge
>>> muscle = bulge.Muscle.preset("ppam-2-r16")
>>> filling = bulge.air.fill(muscle, supply="3 bar", conductance="0.5 l/(s bar)", load="500 N", support="10 %")
>>> print(f"90 % of the pressure after {filling.filling['time_90_s']:.2f} s")  # doctest: +SKIP
"""

from __future__ import annotations

from typing import Any

from bulge import _bulge
from bulge.answers import Answer
from bulge.muscle import Muscle
from bulge.results import number
from bulge.units import Ends, Quantity, optional, si, si_range

__all__ = ["Filling", "Shut", "Stroke", "fill", "shut", "stroke"]


class Shut(Answer):
    """A muscle with its valve shut: the document of ``bulge air shut --json``. ``states`` go over the contractions, ``under_force`` is the state
    under a force, where one was given."""

    _what = "answer about a shut valve"

    def _rows(self) -> list[dict[str, Any]]:
        rows = []
        for at in self._document["states"]:
            state, stiffness = at["state"], at["stiffness"]
            volume = state["response"]["volume_m3"]
            rows.append({key: state[key] for key in ("contraction", "pressure_pa", "force_n")} | {"volume_m3": volume} | stiffness)
        return rows

    def _lines(self) -> list[str]:
        d = self._document
        lines = [f"{d['muscle']}, shut with {number(1e3 * d['mass_kg'])} g of air, exponent {number(d['exponent'], 3)}"]
        if d["under_force"]:
            u = d["under_force"]
            lines.append(f"under {number(u['force_n'])} N it stands at {number(100 * u['contraction'])} % and {number(u['pressure_pa'] / 1e5)} bar")
        return lines

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        rows = [
            [number(100 * r["contraction"]), number(r["pressure_pa"] / 1e5), number(r["force_n"]), number(1e6 * r["volume_m3"]), number(1e-3 * r["total_n_per_m"])]
            for r in self._rows()
        ]
        return [(["contraction [%]", "pressure [bar]", "force [N]", "volume [ml]", "stiffness [N/mm]"], rows)]


class Filling(Answer):
    """Filling or venting over time: the document of ``bulge air fill --json``. ``filling["samples"]`` are the moments, ``filling["time_90_s"]``
    the time after which 90 % of the change of pressure is done."""

    _what = "filling"

    def _rows(self) -> list[dict[str, Any]]:
        samples: list[dict[str, Any]] = self._document["filling"]["samples"]
        return samples

    def _lines(self) -> list[str]:
        d = self._document["filling"]
        after = ["not reached" if d[key] is None else f"after {number(d[key])} s" for key in ("time_90_s", "time_99_s")]
        return [
            f"filling of {self._document['muscle']}: 90 % of the change of pressure {after[0]}, 99 % {after[1]}{'' if d['settled'] else '; it has not settled'}",
            f"{number(1e3 * d['air_kg'])} g of air",
        ]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        samples = self._rows()
        shown = samples[:: max(1, -(-(len(samples) - 1) // 10))]
        rows = [[number(s["time_s"]), number(s["pressure_pa"] / 1e5), number(100 * s["contraction"]), number(s["force_n"])] for s in shown]
        return [(["time [s]", "pressure [bar]", "contraction [%]", "force [N]"], rows)]


class Stroke(Answer):
    """Air, energy and efficiency of a stroke: the document of ``bulge air stroke --json``; the numbers are in ``cycle``."""

    _what = "stroke"

    def _rows(self) -> list[dict[str, Any]]:
        return [self._document["cycle"]]

    def _lines(self) -> list[str]:
        c = self._document["cycle"]
        return [
            f"{self._document['muscle']} lifts by {number(1e3 * c['stroke_m'])} mm, from {number(c['start_pressure_pa'] / 1e5)} to "
            f"{number(c['end_pressure_pa'] / 1e5)} bar, with {number(c['air_litres_anr'])} litres of air (ANR)"
        ]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        c = self._document["cycle"]
        names = {
            "exergy_j": "exergy of the air at the supply", "work_j": "work on the load: the efficiency", "not_passed_on_j": "work of the gas that doesn't reach it",
            "throttled_j": "lost between supply and muscle", "vented_j": "let out with the air",
        }  # fmt: skip
        rows = [[name, number(c[key]), number(100 * c[key] / c["exergy_j"], 3)] for key, name in names.items()]
        return [(["", "J", "%"], rows)]


def shut(
    muscle: Muscle,
    *,
    pressure: Quantity,
    contraction: Quantity,
    range: Ends | None = None,
    exponent: float = 1.0,
    force: Quantity | None = None,
    dead_volume: Quantity = 0.0,
) -> Shut:
    """The valve shut at a gauge pressure [Pa] and a contraction: pressure, force and stiffness over a ``range`` of contractions.

    ``exponent`` goes from 1 (slow: isothermal) to 1.4 (fast: adiabatic); with ``force`` [N] also the state under it; ``dead_volume`` [m^3] is that of
    fittings and tubes.
    """
    return Shut(
        _bulge.air_shut(
            muscle._native, si(pressure, "Pa", "pressure"), si(contraction, "%", "contraction"), None if range is None else si_range(range, "%", "range"),
            float(exponent), optional(force, "N", "force"), si(dead_volume, "m^3", "dead_volume"),
        )
    )  # fmt: skip


def fill(
    muscle: Muscle,
    *,
    supply: Quantity,
    conductance: Quantity | None = None,
    critical_ratio: float = 0.3,
    hole: Quantity | None = None,
    held: Quantity | None = None,
    load: Quantity | None = None,
    support: Quantity | None = None,
    vessel: Quantity | None = None,
    start: Quantity = 0.0,
    adiabatic: bool = False,
    longest: Quantity = "60 s",
    dead_volume: Quantity = 0.0,
) -> Filling:
    """Filling (or venting, with ``supply=0``) over time through a valve after ISO 6358.

    ``supply`` and ``start`` are gauge pressures [Pa], ``conductance`` is the sonic conductance of the valve, such as ``"2 l/(s bar)"`` [m^3/(s Pa)],
    ``hole`` the diameter of a sharp hole in its place [m]. The muscle is ``held`` at a contraction, or lifts a ``load`` [N] from a ``support`` at
    a contraction. ``vessel`` is the volume of the supply's vessel [m^3], if its pressure falls.
    """
    if support is not None and load is None:
        raise _bulge.InputError("support: it carries a load: give load too")
    valve = None if conductance is None else (si(conductance, "m^3/(s Pa)", "conductance"), float(critical_ratio))
    lifted = None if load is None else (si(load, "N", "load"), optional(support, "%", "support"))
    return Filling(
        _bulge.air_fill(
            muscle._native, si(supply, "Pa", "supply"), optional(vessel, "m^3", "vessel"), si(start, "Pa", "start"), valve, optional(hole, "m", "hole"),
            optional(held, "%", "held"), lifted, bool(adiabatic), si(longest, "s", "longest"), si(dead_volume, "m^3", "dead_volume"),
        )
    )  # fmt: skip


def stroke(
    muscle: Muscle, *, load: Quantity, stroke: Ends, supply: Quantity, pressure: Quantity | None = None, dead_volume: Quantity = 0.0
) -> Stroke:
    """Air, energy and efficiency of lifting a ``load`` [N] over a ``stroke`` of contractions, such as ``"5 %..20 %"``.

    ``supply`` is the gauge pressure of the supply [Pa]. With a ``pressure`` the muscle is filled to it while held, and moved at it; otherwise the pressure
    rises with the load.
    """
    return Stroke(
        _bulge.air_stroke(
            muscle._native, si(load, "N", "load"), si_range(stroke, "%", "stroke"), si(supply, "Pa", "supply"), optional(pressure, "Pa", "pressure"),
            si(dead_volume, "m^3", "dead_volume"),
        )
    )  # fmt: skip
