"""Tests of the forms suite: how long, how fast, on which rig; at held pressure, at held length, or under a held load."""

from dataclasses import dataclass, replace

import numpy as np

from . import designs
from .forms import Scales
from .path import Path
from .protocols import PAUSE, Plan

RIGS = ("isobaric", "isometric", "isotonic")
LOWEST = {"pleated": 0.8e5, "braided": 1.6e5}
"""Lowest pressure of a test [Pa]: below it a braid with rubber goes slack."""


@dataclass(frozen=True)
class HeldLength(Plan):
    """Pressure driven up and down between the first and the last of `pressures` at the contractions `held`."""

    held: tuple = ()

    def path(self, pressures=None):
        lowest, highest = min(self.pressures), max(self.pressures)
        parts, start, number = [], 0.0, 0
        for period in self.periods:
            for contraction in self.held:
                number += 1
                time, share, _, cycle = replace(self, low=0.0, high=1.0)._run(period)
                one = np.ones_like(time)
                parts.append((lowest + (highest - lowest) * share, contraction * one, 0.0 * one, start + time, number * one, cycle, one))
                start += time[-1] + PAUSE
        return _joined(self, parts, number)


@dataclass(frozen=True)
class HeldLoad(Plan):
    """Length driven, while the pressure does what a load of `loads` [N] needs: `pressures` are those of a muscle without hidden effects."""

    loads: tuple = ()
    tops: tuple = ()
    starts: tuple = ()

    def path(self, pressures=None):
        parts, start, number = [], 0.0, 0
        for period in self.periods:
            for load, top in zip(self.loads, self.tops):
                number += 1
                time, contraction, rate, cycle = replace(self, high=top)._run(period)
                one = np.ones_like(time)
                parts.append((0.0 * one, contraction, rate, start + time, number * one, cycle, one))
                start += time[-1] + PAUSE
        return _joined(self, parts, number)

    def held(self, path):
        """Load of each row [N]."""
        return np.array(self.loads)[(path.sweep - 1) % len(self.loads)]


def _joined(plan, parts, number):
    columns = [np.concatenate(column) for column in zip(*parts)]
    temperature = plan._temperature(columns[3], columns[4], number)
    path = Path(*columns[:4], *(column.astype(int) for column in columns[4:]), temperature=temperature)
    path.shows_cycle = plan.loops > 1
    path.shows_temperature = plan.temperature_swing > 0.0
    return path


def draw_plan(rng, kind, rig, needs, rows):
    """A test of about so many rows that meets the needs; a held load gets its loads by `loaded`."""
    low, high = (rng.uniform(0.05, 0.08), rng.uniform(0.24, 0.32)) if kind == "pleated" else (rng.uniform(0.006, 0.02), rng.uniform(0.17, 0.215))
    lowest = LOWEST[kind] * rng.uniform(1.0, 1.25)
    highest = rng.uniform(2.4e5, 3.4e5) if kind == "pleated" else rng.uniform(4.0e5, 5.5e5)
    if "low-load" in needs:
        high = 0.38 if kind == "pleated" else 0.27
    elif rig == "isometric":
        high *= 0.85
    count = int(rng.integers(3, 6))
    form = ("triangle", "sine", "triangle", "sine", "minor", "stairs")[int(rng.integers(6))]
    loops = (1, 1, 2, 2, 3)[int(rng.integers(5))]
    period = float(round(rng.uniform(20.0, 120.0)))
    if "long" in needs:
        # A drift of the zero takes hours.
        period *= 6.0
    periods = (period,)
    if "dwell" in needs and rng.random() < 0.5:
        form, period = "stairs", 5.0 * period
    if "rate" in needs:
        form, periods = form if form in ("triangle", "sine") else "triangle", (period, float(round(period / rng.uniform(5.0, 12.0), 1)))
    if "cycles" in needs:
        form, loops = form if form in ("triangle", "sine") else "sine", int(rng.integers(3, 6))
    if form in ("minor", "stairs"):
        loops, periods = 1, (period,)
    specimens = int(rng.integers(3, 5)) if "specimens" in needs else 1
    swing = rng.uniform(4.0, 8.0) if "temperature" in needs or rng.random() < 0.15 else 0.0
    runs = count * len(periods) * specimens
    common = {
        "form": form,
        "pressures": tuple(float(round(p, -3)) for p in np.linspace(lowest, highest, count)),
        "low": low,
        "high": high,
        "rows": int(max(rows / runs, 30 * loops)),
        "periods": periods,
        "loops": loops,
        "specimens": specimens,
        "temperature_swing": swing,
    }
    if rig == "isometric":
        held = np.linspace(low, high, count)
        return HeldLength(**common, held=tuple(float(round(x, 4)) for x in (rng.permutation(held) if rng.random() < 0.4 else held)))
    return HeldLoad(**common) if rig == "isotonic" else Plan(**common)


def loaded(rng, plan, static):
    """The plan under two to four loads, which the muscle lifts over most of its stroke at the plan's pressures. `static` is its force map."""
    lowest, highest = min(plan.pressures), max(plan.pressures)
    count = int(rng.integers(2, 5))
    bottoms = np.linspace(lowest * 1.02, 0.5 * (lowest + highest), count)
    loads = static(bottoms, np.full(count, plan.low))
    grid = np.linspace(plan.low, plan.high, 400)
    most = static(np.full(400, highest), grid)
    tops = [float(grid[np.flatnonzero(most >= load)[-1]]) for load in loads]
    rows = int(plan.rows * len(plan.pressures) / count)
    return replace(plan, loads=tuple(float(round(load, 1)) for load in loads), tops=tuple(tops), rows=rows)


def carried(plan, path, world, static, rounds):
    """The path with the pressures at which the muscle carries its loads: Newton's method with the static dF/dp, all rows at once.

    What hysteresis leaves to be found after the last round is what the rig's controller doesn't reach: forces follow from the path in any case.
    """
    load = plan.held(path)
    lowest, highest = static.window.pressure
    if not np.any(path.pressure):
        share = np.array([static(np.array(1e5 * k), np.array(path.contraction.mean())) for k in (2.0, 3.0)])
        path = replace(path, pressure=np.clip(np.full(len(path), 2e5 + 1e5 * (load.mean() - share[0]) / np.diff(share)[0]), lowest, highest))
        for _ in range(8):
            miss = static(path.pressure, path.contraction) - load
            path = replace(path, pressure=np.clip(path.pressure - miss / static.rise(path.pressure, path.contraction), lowest, highest))
    room = (1.04 * lowest, 0.97 * highest)
    for _ in range(rounds):
        miss = world.force(path) - load
        inside = np.clip(path.pressure, *room)
        path = replace(path, pressure=np.clip(path.pressure - miss / static.rise(inside, path.contraction), *room))
    return path


def provides(plan, rig):
    """What effects find in this test."""
    found = (designs.provides(plan) | {"motion", "dwell"}) - {"cloth-range", "cycles"}
    if rig != "isometric":
        found.add("cloth-range")
    if rig != "isobaric":
        found.add("pressure-path")
    if plan.loops > 2:
        found.add("cycles")
    return found


def scales(plan, path, force, muscle, largest):
    """Sizes of a test for the constants of forms."""
    periods = plan.periods
    run = float(np.mean([path.time[one][-1] - path.time[one][0] for one in path.runs]))
    stroke = plan.high - plan.low
    return Scales(
        stroke=stroke,
        fast=2.0 * stroke / min(periods),
        slow=2.0 * stroke / max(periods),
        pressure=float(path.pressure.max()),
        force=float(np.abs(force).max()),
        run=run,
        session=float(path.time[-1]),
        radius=muscle.radius,
        largest=largest,
        loops=float(plan.loops),
    )


