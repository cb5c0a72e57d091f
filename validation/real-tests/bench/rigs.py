"""What a rig does: set points of pressure, and of contraction or load, over time; which rows are recorded, and its uninterrupted runs."""

from dataclasses import dataclass

import numpy as np

RIGS = ("isobaric", "isometric", "isotonic", "mixed")
RATES = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0)
"""Sampling [Hz]."""
PAUSE = 30.0
"""Between two runs, not recorded [s]."""


@dataclass
class Motion:
    """Set points in SI. `contraction` is None where a load is held, `load` [N] else; `run` numbers the uninterrupted runs,
    `sweep` is what the laboratory numbers, `keep` marks recorded rows."""

    rig: str
    form: str
    time: np.ndarray
    pressure: np.ndarray
    contraction: np.ndarray | None
    load: np.ndarray | None
    run: np.ndarray
    keep: np.ndarray
    sweep: np.ndarray
    levels: int

    def describe(self):
        """For the truth file."""
        time = self.time[self.keep]
        return {"rig": self.rig, "form": self.form, "levels": self.levels, "seconds": round(float(time[-1] - time[0]), 3)}


def wave(form, phase):
    """From 0 to 1 and back within a period; `phase` in periods. Stairs climb in six steps and rest on each."""
    inside = phase % 1.0
    if form == "sine":
        return 0.5 - 0.5 * np.cos(2.0 * np.pi * inside)
    ramp = 1.0 - np.abs(2.0 * inside - 1.0)
    if form == "triangle":
        return ramp
    if form == "trapezoid":
        return np.clip(1.3 * ramp - 0.15, 0.0, 1.0)
    step, part = np.divmod(ramp * 6.0, 1.0)
    return np.minimum((step + np.clip(4.0 * part, 0.0, 1.0)) / 6.0, 1.0)


def _timing(rng, rows, periods):
    """Step of time [s]: a period lasts between 2.5 and 240 s."""
    per_period = rows / periods
    fitting = [rate for rate in RATES if 2.5 <= per_period / rate <= 240.0]
    return 1.0 / float(rng.choice(fitting or RATES[:1]))


def _runs(rng, rows, levels, loops, form, continuous):
    """Row by row: level, wave, uninterrupted run, time; between two levels a recorded change of the set points, or a pause."""
    step = _timing(rng, rows, levels * loops)
    each = rows // levels
    change = max(4, each // 25) if continuous else 0
    level, shape, run, time, start = [], [], [], [], 0.0
    for k in range(levels):
        if k and continuous:
            # The level moves while the wave rests at its low end.
            level.append(k - 1 + (np.arange(change) + 1.0) / (change + 1))
            shape.append(np.zeros(change))
            run.append(np.zeros(change, int))
        count = each - (change if k else 0)
        level.append(np.full(count, float(k)))
        shape.append(wave(form, np.arange(count) * loops / (count - 1)))
        run.append(np.full(count, 0 if continuous else k))
    counts = [len(part) for part in level]
    for count in counts:
        time.append(start + np.arange(count) * step)
        start = time[-1][-1] + (step if continuous else PAUSE)
    # The last sample of a wave closes it.
    return (np.concatenate(part) for part in (level, shape, run, time))


def isobaric(rng, hose, rows, most):
    """Length driven at three to five pressures."""
    levels, loops = int(rng.integers(3, 6)), int(rng.integers(1, 4))
    form = str(rng.choice(["triangle", "sine", "stairs"]))
    continuous = bool(rng.random() < 0.5)
    level, shape, run, time = _runs(rng, rows, levels, loops, form, continuous)
    pressures = np.linspace(max(1.1 * hose.lowest, 0.3 * most), rng.uniform(0.8, 0.97) * most, levels)
    low, high = _strokes(rng, hose)
    contraction = low + (high - low) * shape
    return Motion(
        "isobaric",
        form,
        time,
        np.interp(level, np.arange(levels), pressures),
        contraction,
        None,
        run,
        np.ones(len(time), bool),
        np.round(level) + 1.0,
        levels,
    )


def isometric(rng, hose, rows, most, from_zero):
    """Length held at three to six contractions, pressure driven up and down; lengths not always in order."""
    levels, loops = int(rng.integers(3, 7)), int(rng.integers(2, 5))
    form = str(rng.choice(["triangle", "sine", "trapezoid"]))
    continuous = bool(rng.random() < 0.3)
    level, shape, run, time = _runs(rng, rows, levels, loops, form, continuous)
    low, high = _strokes(rng, hose)
    lengths = np.linspace(low, high, levels)
    if rng.random() < 0.4:
        lengths = rng.permutation(lengths)
    bottom = 0.0 if from_zero else hose.lowest * rng.uniform(1.05, 1.5)
    if bottom and hose.muscle.bladder:
        # Where rubber outweighs the gas a shortened muscle buckles: such a test starts higher.
        while np.min(hose.map(np.full(levels, bottom), lengths)) < 15.0:
            bottom *= 1.15
    pressure = bottom + (rng.uniform(0.8, 0.97) * most - bottom) * shape
    return Motion(
        "isometric",
        form,
        time,
        pressure,
        np.interp(level, np.arange(levels), lengths),
        None,
        run,
        np.ones(len(time), bool),
        np.round(level) + 1.0,
        levels,
    )


def isotonic(rng, hose, rows, most):
    """Two to four loads held while the pressure rises and falls; the least pressure just carries each."""
    levels, loops = int(rng.integers(2, 5)), int(rng.integers(1, 4))
    form = str(rng.choice(["triangle", "sine", "stairs"]))
    level, shape, run, time = _runs(rng, rows, levels, loops, form, continuous=False)
    low, high = _strokes(rng, hose)
    top = rng.uniform(0.85, 0.97) * most
    bottom = np.linspace(max(1.15 * hose.lowest, 0.22 * most), 0.5 * most, levels)
    loads = hose.map(bottom, np.full(levels, low))
    # No load is so light that the muscle leaves its range at the highest pressure.
    loads = np.maximum(loads, float(hose.map(np.array(top), np.array(high))))
    carried = np.array([_carrying(hose, load, low, top) for load in loads])
    index = level.astype(int)
    pressure = carried[index] + (top - carried[index]) * shape
    return Motion("isotonic", form, time, pressure, None, loads[index], run, np.ones(len(time), bool), level + 1.0, levels)


def _carrying(hose, load, contraction, top):
    """Pressure at which the muscle carries the load at this contraction."""
    grid = np.linspace(hose.lowest, top, 400)
    return float(np.interp(load, hose.map(grid, np.full(400, contraction)), grid))


def mixed(rng, hose, rows, most):
    """Pressure and length both move: ramps of one while the other swings, steps in turn, or a map of set points."""
    form = str(rng.choice(["ramp-while-moving", "map", "steps"]))
    low, high = _strokes(rng, hose)
    bottom, top = max(1.2 * hose.lowest, 0.25 * most), rng.uniform(0.8, 0.97) * most
    if form == "map":
        return _map(rng, rows, (low, high), (bottom, top))
    step = _timing(rng, rows, 8)
    time = np.arange(rows) * step
    share = np.arange(rows) / rows
    if form == "steps":
        hold = max(rows // 40, 6)
        corners = np.linspace(0.0, 1.0, 5)[rng.integers(0, 5, (rows // hold + 2, 2))]
        # One of the two moves at a time.
        corners[1::2, 0] = corners[:-1:2, 0][: len(corners[1::2])]
        corners[2::2, 1] = corners[1:-1:2, 1][: len(corners[2::2])]
        part = np.clip((share * rows / hold) % 1.0 * 4.0, 0.0, 1.0)
        index = (share * rows / hold).astype(int)
        x, y = (corners[index, k] + (corners[index + 1, k] - corners[index, k]) * part for k in (0, 1))
    else:
        x, y = wave("triangle", share * rng.integers(2, 4)), wave("sine", share * (rng.integers(5, 9) + 0.37))
    return Motion(
        "mixed",
        form,
        time,
        bottom + (top - bottom) * x,
        low + (high - low) * y,
        None,
        np.zeros(rows, int),
        np.ones(rows, bool),
        np.ones(rows),
        1,
    )


def _map(rng, rows, strokes, pressures):
    """Set points of a grid, length by length or at random, one averaged row each; the way between them is driven, not recorded."""
    columns = int(rng.integers(6, 12))
    p, eps = np.meshgrid(np.linspace(*pressures, columns), np.linspace(*strokes, max(rows // columns, 4)), indexing="ij")
    order = rng.permutation(p.size) if rng.random() < 0.5 else np.arange(p.size)
    p, eps = p.ravel()[order], eps.ravel()[order]
    between = 8
    share = np.linspace(0.0, 1.0, between + 1)[1:]
    path = [np.r_[v[0], (v[:-1, None] + np.diff(v)[:, None] * share).ravel()] for v in (p, eps)]
    keep = np.zeros(len(path[0]), bool)
    keep[::between] = True
    time = np.arange(len(keep)) * 0.5
    return Motion("mixed", "map", time, *path, None, np.zeros(len(keep), int), keep, np.ones(len(keep)), 1)


def _strokes(rng, hose):
    if hose.muscle.kind == "pleated":
        return rng.uniform(0.05, 0.08), rng.uniform(0.22, 0.3)
    return rng.uniform(0.005, 0.02), rng.uniform(0.12, 0.17)
