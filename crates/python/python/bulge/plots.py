"""Plots with matplotlib, where it is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from bulge.optional import need
from bulge.results import rung_names
from bulge.units import Quantities, si_array

if TYPE_CHECKING:
    from bulge.inference import Comparison, Diagnosis
    from bulge.measurements import Data
    from bulge.muscle import Muscle, Shape

#: Colours that can be told apart by everybody (Okabe and Ito).
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"]


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    pyplot = need("matplotlib.pyplot", "a plot", "plot")
    return pyplot.subplots(figsize=(6.4, 4.2), layout="constrained")[1]


def _colour(i: int) -> str:
    return COLOURS[i % len(COLOURS)]


def meridian(shape: Shape, ax: Any) -> Any:
    """Both sides of the meridian, with the fittings."""
    ax = _axes(ax)
    x, r = 1e3 * shape.meridian["x_m"], 1e3 * shape.meridian["r_m"]
    for sign in (1, -1):
        ax.plot(x, sign * r, color=COLOURS[0])
    for end in (0, -1):
        ax.plot([x[end], x[end]], [-r[end], r[end]], color="0.4", linewidth=3)
    ax.set(xlabel="x [mm]", ylabel="radius [mm]", aspect="equal")
    ax.set_title(f"{shape.muscle}: {shape.force_n:.4g} N at {shape.pressure_pa / 1e5:.3g} bar, {100 * shape.contraction:.3g} %")
    return ax


def characteristics(muscle: Muscle, pressure: Quantities, points: int, ax: Any) -> Any:
    """Force against contraction."""
    ax = _axes(ax)
    for i, p in enumerate(np.atleast_1d(np.asarray(si_array(pressure, "Pa", "pressure")))):
        limit = muscle.contraction_limit(float(p))
        singular = muscle.kind == "pleated" and muscle.number("fibre_stiffness") is None
        contraction = np.linspace(0.1 * limit if singular else 0.0, limit, points)
        force = muscle.force(contraction, pressure=float(p), errors="coerce")
        ax.plot(100 * contraction, force, color=_colour(i), label=f"{p / 1e5:.3g} bar")
    ax.set(xlabel="contraction [%]", ylabel="force [N]", title=muscle.name, ylim=(0, None))
    ax.legend()
    return ax


def measured(data: Data, ax: Any) -> Any:
    """Force against motion, a colour for each sweep."""
    ax = _axes(ax)
    columns = data.columns
    label, motion = ("contraction [%]", 100 * columns["contraction"]) if "contraction" in columns else ("length [mm]", 1e3 * columns["length_m"])
    style = "-" if data.is_path else "."
    sweeps = columns.get("sweep", np.zeros(len(data), dtype=int))
    for i, sweep in enumerate(np.unique(sweeps)):
        rows = sweeps == sweep
        bar = float(np.median(columns["pressure_pa"][rows])) / 1e5
        ax.plot(motion[rows], columns["force_n"][rows], style, color=_colour(i), linewidth=1, label=f"{bar:.3g} bar" if data.is_path else None)
    ax.set(xlabel=label, ylabel="force [N]")
    if data.is_path and data.n_sweeps <= 12:
        ax.legend()
    return ax


def compared(comparison: Comparison, ax: Any) -> Any:
    """Measured points, the first and the last rung."""
    ax = _axes(ax)
    several = len(comparison.ladder) > 1
    for i, curve in enumerate(comparison.curves):
        points = curve["points"]
        take = {key: np.array([point[key] for point in points]) for key in ("contraction", "measured_n", "first_n", "last_n")}
        e = 100 * take["contraction"]
        ax.plot(e, take["measured_n"], ".", color=_colour(i), markersize=3, label=f"{curve['pressure_pa'] / 1e5:.3g} bar")
        if several:
            ax.plot(e, take["first_n"], ":", color=_colour(i), linewidth=1)
        ax.plot(e, take["last_n"], "-", color=_colour(i), linewidth=1)
    ax.set(xlabel="contraction [%]", ylabel="force [N]", title=f"{comparison.muscle}: points measured, lines computed")
    if len(comparison.curves) <= 12:
        ax.legend()
    return ax


def ladder(diagnosis: Diagnosis, ax: Any) -> Any:
    """The error of each rung above the noise floor."""
    ax = _axes(ax)
    rungs = diagnosis.ladder
    names = [name.replace(", ", ",\n") for name in rung_names(rungs, "as stated")]
    ax.bar(names, [rung["rmse_n"] for rung in rungs], color=COLOURS[0], width=0.6)
    floor = diagnosis.noise_floor_n
    if floor:
        ax.axhline(floor, color=COLOURS[1], linestyle="--", label=f"noise floor {floor:.3g} N")
        ax.legend()
    ax.set(ylabel="RMS error [N]", title=f"{diagnosis.verdict}: {', '.join(diagnosis.names)}" if diagnosis.names else diagnosis.verdict)
    ax.tick_params(axis="x", labelrotation=20)
    return ax


def lines(drawing: tuple[str, str, str, list[tuple[str, list[list[float]]]]], ax: Any) -> Any:
    """Named lines against two axes."""
    ax = _axes(ax)
    title, x, y, every = drawing
    for i, (name, points) in enumerate(every):
        at = np.array(points).reshape(-1, 2)
        load = name == "load"
        ax.plot(at[:, 0], at[:, 1], "o-" if load else "-", color="black" if load else _colour(i), label=name)
    ax.set(xlabel=x, ylabel=y, title=title)
    if len(every) > 1:
        ax.legend()
    return ax
