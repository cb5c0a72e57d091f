"""What usual methods name on the same files.

    python baselines.py DIR [--only REGEX] [--jobs 2]

Writes DIR/baselines.json: for each case and method the effects named, in order. Every method sees data.csv and muscle.toml alone, the residual of
the stated muscle, and for each effect of `simulator/effects.py` the signature of a small amplitude from this generator (a generous gift: the physics
is that of the data). All treat rows as independent:

- aicc, bic: forward selection by least squares while the criterion falls, sigma^2 estimated; AICc = n ln(RSS/n) + 2k + 2k(k+1)/(n-k-1), BIC = n ln(RSS/n) + k ln n.
- largest-drop: the one effect that lowers the RMS most, if it does so by more than 2 %.
- lasso: coordinate descent on standardised columns (Tibshirani 1996; Friedman, Hastie, Hoefling & Tibshirani 2007), penalty by BIC along its path.

Effects whose amplitude cannot be negative are held to that.
"""

import argparse
import json
import os
import re
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import numpy as np  # noqa: E402

from simulator import muscle as muscles  # noqa: E402
from simulator import path as paths  # noqa: E402
from simulator.detectability import available, tangents  # noqa: E402
from simulator.effects import CATALOGUE  # noqa: E402
from simulator.meridian import NoEquilibrium, solve  # noqa: E402
from simulator.surface import OutsideWindow, Shape, Window  # noqa: E402
from simulator.world import Nature, World  # noqa: E402

LEAST_DROP = 0.02
MOST_EFFECTS = 6
PENALTIES = 25
SWEEPS = 40
MOST_ROWS = 5000


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    cases = sorted(p.parent for p in arguments.folder.glob("*/truth.json") if re.search(arguments.only, p.parent.name))
    with ProcessPoolExecutor(max_workers=arguments.jobs) as pool:
        named = dict(zip((case.name for case in cases), pool.map(name_effects, cases, chunksize=4)))
    target = arguments.folder / "baselines.json"
    target.write_text(json.dumps(named, indent=1) + "\n", encoding="utf-8")
    print(f"{len(named)} cases, {target}")
    return 0


def name_effects(case):
    """Named effects of all methods for the files of one case."""
    residual, columns, names = _problem(case)
    signs = np.array([CATALOGUE[name].sign for name in names])
    scale = np.sqrt((columns**2).mean(axis=0))
    kept = scale > 1e-9 * np.sqrt((residual**2).mean())
    columns, signs = columns[:, kept] / scale[kept], signs[kept]
    names = [name for name, keep in zip(names, kept) if keep]
    gram, cross, total, rows = columns.T @ columns, columns.T @ residual, float(residual @ residual), len(residual)
    problem = gram, cross, total, rows, signs
    return {
        "aicc": [names[i] for i in _forward(problem, _aicc)],
        "bic": [names[i] for i in _forward(problem, _bic)],
        "largest-drop": [names[i] for i in _largest_drop(problem)],
        "lasso": [names[i] for i in _lasso(problem)],
    }


def _problem(case):
    """Residual of the stated muscle and the signatures of the effects that these columns can show."""
    stated = muscles.read(case / "muscle.toml")
    path, force = paths.read(case / "data.csv", stated.length)
    low, high = path.contraction.min(), path.contraction.max()
    floor = 0.6 * low if stated.kind == "pleated" else low - 0.012
    window = Window((0.85 * path.pressure.min(), 1.15 * path.pressure.max()), (floor, high + 0.02))
    shape = Shape(stated.kind, stated.length, stated.radius, stated.radius, fibres=stated.fibres, braid_angle=stated.braid_angle or 0.0)
    radius = float(solve(shape.body(), 1e5, stated.length * (1.0 - high)).equator)
    nature = Nature(
        cloth_radius=0.9 * radius,
        circumference=2.0 * np.pi * radius * 1.2,
        threshold_pressure=0.1 * path.pressure.min(),
        specimen_factors=_factors(path),
    )
    world = World(stated.without_instruments(), window, nature)
    base = world.force(path)
    names, columns = [], []
    for name in available(world, path, _shown(path)):
        try:
            columns.append(tangents(world, path, [name], base)[:, 0])
            names.append(name)
        except (NoEquilibrium, OutsideWindow):
            continue
    return _thinned(force - base, np.stack(columns, axis=1), names)


def _thinned(residual, columns, names):
    """Every k-th row of dense files: independent rows would make these methods surer still."""
    step = max(1, len(residual) // MOST_ROWS)
    return residual[::step], columns[::step], names


def _factors(path):
    count = int(path.specimen.max())
    return tuple(np.linspace(-1.0, 1.0, count)) if count > 1 else (0.0,)


def _shown(path):
    found = {"cloth-range", "low-load"}
    if path.timed:
        found |= {"motion", "rate", "dwell"}
    if path.shows_cycle:
        found.add("cycles")
    if path.shows_specimen:
        found.add("specimens")
    if path.shows_temperature:
        found.add("temperature")
    return found


def _fit(problem, chosen):
    """Least squares on the chosen columns: coefficients and residual sum of squares."""
    gram, cross, total, _, _ = problem
    inner = gram[np.ix_(chosen, chosen)]
    coefficients = np.linalg.lstsq(inner, cross[chosen], rcond=1e-10)[0]
    return coefficients, max(total - float(coefficients @ cross[chosen]), 1e-12 * total)


def _allowed(problem, chosen, coefficients):
    signs = problem[4][chosen]
    return bool(np.all((signs == 0) | (coefficients > 0.0)))


def _aicc(rss, rows, count):
    k = count + 1
    return rows * np.log(rss / rows) + 2 * k + 2 * k * (k + 1) / (rows - k - 1)


def _bic(rss, rows, count):
    return rows * np.log(rss / rows) + (count + 1) * np.log(rows)


def _forward(problem, criterion):
    rows = problem[3]
    chosen, best = [], criterion(problem[2], rows, 0)
    while len(chosen) < MOST_EFFECTS:
        trials = []
        for i in set(range(len(problem[1]))) - set(chosen):
            coefficients, rss = _fit(problem, [*chosen, i])
            if _allowed(problem, [*chosen, i], coefficients):
                trials.append((criterion(rss, rows, len(chosen) + 1), i))
        if not trials or min(trials)[0] >= best:
            break
        best, winner = min(trials)
        chosen.append(winner)
    return chosen


def _largest_drop(problem):
    trials = []
    for i in range(len(problem[1])):
        coefficients, rss = _fit(problem, [i])
        if _allowed(problem, [i], coefficients):
            trials.append((rss, i))
    if not trials:
        return []
    rss, winner = min(trials)
    return [winner] if np.sqrt(rss / problem[2]) < 1.0 - LEAST_DROP else []


def _lasso(problem):
    """Path of penalties from the first that lets a column in down to 1/1000 of it; the members with the least BIC, largest coefficient first."""
    gram, cross, total, rows, signs = problem
    drive = np.where((signs == 0) | (cross > 0.0), np.abs(cross), 0.0)
    if drive.max() <= 0.0:
        return []
    coefficients, best, winner = np.zeros(len(cross)), _bic(total, rows, 0), []
    for penalty in drive.max() * np.logspace(0.0, -3.0, PENALTIES)[1:]:
        _descend(gram, cross, signs, penalty, coefficients)
        members = np.flatnonzero(coefficients)
        rss = total - 2.0 * coefficients @ cross + coefficients @ gram @ coefficients
        value = _bic(max(rss, 1e-12 * total), rows, len(members))
        if value < best:
            best, winner = value, sorted(members, key=lambda i: -abs(coefficients[i]))
    return [int(i) for i in winner]


def _descend(gram, cross, signs, penalty, coefficients):
    """Cyclic coordinate descent with soft thresholding, in place."""
    gradient = cross - gram @ coefficients
    for _ in range(SWEEPS):
        largest = 0.0
        for i in range(len(cross)):
            pull = gradient[i] + gram[i, i] * coefficients[i]
            value = np.sign(pull) * max(abs(pull) - penalty, 0.0) / gram[i, i]
            if signs[i] and value < 0.0:
                value = 0.0
            change = value - coefficients[i]
            if change:
                gradient -= gram[:, i] * change
                coefficients[i] = value
                largest = max(largest, abs(change))
        if largest < 1e-6 * np.abs(coefficients).max(initial=1e-12):
            break


if __name__ == "__main__":
    sys.exit(main())
