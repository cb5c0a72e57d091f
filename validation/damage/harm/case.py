"""Builds one set: muscle, test and readings by the suites of simulated tests, then the damage; the noise is chosen for the size of the damage."""

import json
from dataclasses import replace
from functools import lru_cache
from zlib import crc32

import numpy as np
from bench import instruments, rigs
from bench.case import SWING, misfit, nature, sized, slopes
from bench.hoses import CONTRACTION, Hose, hoses
from bench.world import World

from . import habits

SIGMAS = (5.0, 300.0)
"""Norm of what the damage puts between model and readings, over the noise: the noise is chosen for it, within these bounds [N]."""
NOISE = (0.15, 8.0)
BESIDE = (20.0, 120.0)
"""The same of a hidden effect, where there is one."""
FULL = 2e-3
"""Least noise of a load cell, of its largest reading, where the damage leaves none between model and readings."""
QUIET = instruments.Instruments("white", 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, "none")


def build(order, seed, out, whole=False):
    """Writes out/<case> and returns its truth. The same seed and name give the same bytes; `whole` leaves the damage out."""
    rng = np.random.default_rng([seed, crc32((order.twin or order.name).encode())])
    tests = _tests(rng, order, seed)
    timed, motion = rng.random() > 0.08 or order.kind == "gaps", _form(rng, order)
    harm = int(rng.integers(2**32))
    clean = _table(rng, QUIET, tests, motion)
    stated = [_stated(order, test.hose) for test in tests]
    bare, _ = _harmed(order, harm, clean)
    hidden = _missing(clean, stated, motion)
    damage = np.sqrt(abs(_missing(bare, stated, motion) ** 2 - hidden**2))
    noise = _noise(rng, order, damage, hidden, float(np.max(clean["force"])))
    rig = instruments.draw(rng, noise, clean["force"], slopes(tests[0].hose, tests[0].record))
    table = _table(rng, rig, tests, motion)
    rows = np.array([], int)
    if whole or order.whole:
        damage = 0.0
    else:
        table, rows = _harmed(order, harm, table)
    exact, labels = bool(rng.random() < 0.5), bool(rng.random() < 0.5)
    folder = out / order.name
    folder.mkdir(parents=True, exist_ok=True)
    files = _write(folder, order, table, rows, motion, timed, labels)
    muscle = replace(stated[0].muscle, **{("stroke" if name == "length" else name): sheet for name, sheet in rig.sheets().items()})
    (folder / "muscle.toml").write_text(muscle.toml(exact) + _specimens(stated), encoding="utf-8")
    (folder / "args").write_text("\n".join([*files, "--muscle", "muscle.toml"]) + "\n", encoding="utf-8")
    truth = {
        "case": order.name,
        **{key: getattr(order, key) for key in ("kind", "habit", "column", "rig", "hidden")},
        "whole": whole or order.whole,
        "strength": round(order.strength, 3),
        "muscle": muscle.kind,
        "rows": len(table["force"]),
        "motion": motion,
        "timed": timed,
        "exact": exact,
        "stated": rig.stated,
        "noise_n": float(f"{rig.total:.4g}"),
        "sigmas": round(float(damage / rig.total), 1),
        "hidden_sigmas": round(float(hidden / rig.total), 1),
        "lines": files,
        "tick_s": round(float(np.median(np.abs(np.diff(np.sort(table["time"]))))), 6),
        "edges_s": _edges(table["time"], rows) if timed else [],
        "sweeps": sorted({int(label) for label in table["sweep"][rows]}) if labels or order.kind == "mislabelled" else [],
    }
    (folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    return truth


class _Test:
    """One muscle on its rig: what was recorded, and which rows were leaking while the supply stood still."""

    def __init__(self, rng, order, hose, motion, amplitude=None):
        self.hose, self.files = hose, 5 if order.kind == "unit" else 1
        world = World(hose, nature(rng, hose, motion))
        if amplitude:
            world = sized(world, motion, {amplitude: rng.uniform(*SWING)})
        self.record = self.supply = world.record(motion)
        if order.kind == "leak":
            self.record = world.record(_leaking(rng, order, hose, motion))

    def table(self, rng, rig, motion):
        """What the instruments give: columns in SI; `length` is what the length sensor shows, a length or a displacement."""
        rest, record = self.hose.muscle.length, self.record
        force, pressure, length = rig.read(rng, record.kept("force"), record.kept("shown_pressure"), rest * (1.0 - record.kept("shown_contraction")))
        supply = self.supply.kept("shown_pressure")
        gap = np.abs(supply - record.kept("shown_pressure"))
        driven = record.motion.contraction if record.motion.rig in ("isobaric", "mixed") else record.motion.pressure
        return {
            "time": record.motion.time[record.motion.keep],
            "pressure": pressure,
            "length": length if motion == "length" else rest - length,
            "force": force,
            "sweep": record.motion.sweep[record.motion.keep],
            "direction": np.sign(np.diff(driven[record.motion.keep], prepend=driven[0])),
            "specimen": np.ones(len(force)),
            "file": np.ones(len(force)),
            "leaking": gap > 1e-3 * np.max(supply),
            "supply": supply + pressure - record.kept("shown_pressure"),
        }


def _tests(rng, order, seed):
    """The test, or those of three specimens."""
    if order.kind == "mislabelled":
        trio = specimens(seed)[int(rng.integers(3))]
        return [_Test(rng, order, hose, _motion(rng, order, hose, max(order.rows, 300) // 3)) for hose in trio]
    pool = hoses(seed + 1000 * int(rng.integers(2)))
    if order.hidden in ("rubber", "strand-friction"):
        hose = pool[int(rng.integers(4 if order.hidden == "rubber" else 8))]
    else:
        hose = pool[int(rng.integers(8, 10))] if rng.random() < 0.35 else pool[int(rng.integers(8))]
    motion = _motion(rng, order, hose, order.rows)
    while order.kind == "unit" and order.rig in ("isobaric", "isometric") and motion.levels != 5:
        motion = _motion(rng, order, hose, order.rows)
    return [_Test(rng, order, hose, motion, None if order.hidden == "rubber" else order.hidden)]


def _motion(rng, order, hose, rows):
    # The regulator overshoots: three specimens have three chances to leave what the equilibria are known for.
    most = 6.2e5 if hose.muscle.kind == "braided" else 2.9e5 if order.kind == "mislabelled" else 3.2e5
    return rigs.isometric(rng, hose, rows, most, False) if order.rig == "isometric" else getattr(rigs, order.rig)(rng, hose, rows, most)


@lru_cache(maxsize=2)
def specimens(seed):
    """Three makes of muscle, three specimens each, which differ by 0.3 to 3 % in radius and length."""
    rng = np.random.default_rng([seed, 5])
    trios = []
    for hose, spread in zip((hoses(seed)[1], hoses(seed)[5], hoses(seed)[8]), (0.01, 0.003, 0.03)):
        m = hose.muscle
        others = [
            replace(m, radius=round(m.radius * (1.0 + spread * r), 6), length=round(m.length * (1.0 + spread * s), 5))
            for r, s in zip((0.0, 1.0, -0.7), rng.uniform(-1.0, 1.0, 3))
        ]
        trios.append(tuple(Hose(muscle) for muscle in others))
    return trios


def _stated(order, hose):
    """The muscle as the file states it: a hidden rubber is left out."""
    return Hose(replace(hose.muscle, bladder=None)) if order.hidden == "rubber" else hose


def _specimens(stated):
    """The tables of specimens in the muscle file."""
    if len(stated) < 2:
        return ""
    size = [(hose.muscle.length * 1e3, hose.muscle.radius * 1e3) for hose in stated]
    return "".join(f'\n[specimens.{name}]\nlength = "{length:.6g} mm"\nradius = "{radius:.6g} mm"\n' for name, (length, radius) in zip("ABC", size))


def _form(rng, order):
    """What the length sensor shows."""
    if order.kind in ("unit", "flipped"):
        return "length" if order.kind == "unit" else "displacement"
    return "length" if rng.random() < 0.6 else "displacement"


def _leaking(rng, order, hose, motion):
    """The same set points with a sag of 1 to 20 %: at once or slowly, for a while. A load stays carried, a muscle taut."""
    depth, share = habits.between(0.01, 0.2, order.strength), habits.between(0.03, 0.3, rng.random())
    count, start = len(motion.time), rng.uniform(0.1, 0.65)
    after = np.arange(count) / count - start
    inside = (after >= 0.0) & (after < share)
    slow = -np.expm1(-3.0 * after / share) if rng.random() < 0.5 else 1.0
    least = np.full(count, 1.02 * hose.lowest if motion.rig == "isobaric" else np.min(motion.pressure))
    if motion.rig == "isotonic":
        least = np.array([np.min(motion.pressure[motion.run == run]) for run in motion.run])
    sagged = np.maximum(motion.pressure * (1.0 - np.where(inside, depth * slow, 0.0)), np.minimum(least, motion.pressure))
    return replace(motion, pressure=sagged)


def _table(rng, rig, tests, motion):
    """All tests as one table."""
    parts, time, sweep = [], 0.0, 0.0
    for number, test in enumerate(tests, 1):
        part = test.table(rng, rig, motion)
        part["time"], part["sweep"] = part["time"] + time, part["sweep"] + sweep
        part["specimen"][:] = number
        time, sweep = part["time"][-1] + 60.0, np.max(part["sweep"])
        parts.append(part)
    table = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    if tests[0].files > 1:
        # A file for each of five sweeps, else for each fifth of the record.
        levels, count = np.unique(table["sweep"]), len(table["force"])
        table["file"] = 1.0 + (np.searchsorted(levels, table["sweep"]) if len(levels) == 5 else np.arange(count) * 5 // count)
    return table


def _harmed(order, harm, table):
    """The damaged table, and its damaged rows."""
    return habits.harmed(np.random.default_rng(harm), table, order.kind, order.habit, order.column, order.strength)


def _missing(table, stated, motion):
    """Norm of static model less reading [N], of the muscles as labelled; readings that no muscle has count as the nearest that it has."""
    square = 0.0
    for number, hose in enumerate(stated, 1):
        rows = table["specimen"] == number
        rest, (low, high) = hose.muscle.length, CONTRACTION[hose.muscle.kind]
        shown = table["length"][rows]
        contraction = np.clip(shown / rest if motion == "displacement" else 1.0 - shown / rest, low + 1e-4, high - 1e-4)
        pressure = np.clip(table["pressure"][rows], 0.0, hose.map.window.pressure[1])
        square += float(np.sum((hose.pull(pressure, contraction) - table["force"][rows]) ** 2))
    return np.sqrt(square)


def _noise(rng, order, damage, hidden, largest):
    wanted = 10.0 ** rng.uniform(*np.log10(BESIDE if order.hidden else SIGMAS))
    norm = hidden if order.hidden else damage
    # Where the damage changes no force that is expected, the noise is that of a usual load cell.
    chosen = norm / wanted if norm > 1.0 else FULL * largest * 10.0 ** rng.uniform(-0.7, 0.3)
    return float(np.clip(chosen, *NOISE))


def _write(folder, order, table, rows, motion, timed, labels):
    """Writes the files; the damaged lines of each, as ranges."""
    columns = {"time [s]": table["time"]} if timed else {}
    columns |= {"pressure [bar]": table["pressure"] / 1e5, f"{motion} [mm]": table["length"] * 1e3, "force [N]": table["force"]}
    cells = {name: [f"{value:.8g}" for value in values] for name, values in columns.items()}
    if labels or order.kind == "mislabelled":
        cells["sweep"] = [f"{value:.0f}" for value in table["sweep"]]
    if order.kind == "mislabelled":
        cells["specimen"] = ["ABC"[int(value) - 1] for value in table["specimen"]]
    if order.column == "direction":
        cells["direction"] = [f"{value:.0f}" for value in table["direction"]]
    numbers, damaged, files = np.unique(table["file"]), np.zeros(len(table["force"]), bool), {}
    damaged[rows] = True
    for number in numbers:
        inside = np.flatnonzero(table["file"] == number)
        name = "data.csv" if len(numbers) == 1 else f"test-{number:.0f}.csv"
        lines = [",".join(cells), *(",".join(column[row] for column in cells.values()) for row in inside)]
        (folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
        files[name] = ranges(np.flatnonzero(damaged[inside]) + 2)
    return files


def _edges(time, rows):
    """Where damage begins and where it has ended, in seconds from the first row; the first forty."""
    ends = [row for first, last in ranges(rows) for row in (first, last + 1) if 0 < row < len(time)]
    return [round(float(time[row] - time[0]), 4) for row in ends[:40]]


def ranges(lines):
    """[[first, last], ...] of sorted numbers."""
    lines = np.asarray(lines, int)
    if not len(lines):
        return []
    cut = np.flatnonzero(np.diff(lines) > 1)
    return [[int(a), int(b)] for a, b in zip(lines[np.r_[0, cut + 1]], lines[np.r_[cut, len(lines) - 1]])]
