"""Builds one case: draws muscle, test, rig and noise, hides effects of the wanted detectability, writes the files and the truth."""

import json
import zlib
from dataclasses import dataclass, replace

import numpy as np

from . import path as paths
from .designs import LAWS, STATIC_LAWS, draw_law, draw_muscle, draw_nature, draw_plan, provides, window, with_instruments
from .detectability import Metric, available, rival_pairs, rivals, stated_widths, tangents
from .effects import CATALOGUE
from .meridian import NoEquilibrium, solve
from .noise import rounded
from .surface import OutsideWindow, Shape
from .unknown import UNKNOWN
from .world import World

ATTEMPTS = 25
CLOSE = 0.02
IDENTICAL = 1.0
CLASS = 3.29
UNREACHABLE = 0.6


class Unsuitable(RuntimeError):
    """The draw cannot carry the case; another one may."""


@dataclass
class Setting:
    """A test before anything is hidden."""

    world: World
    path: object
    unseen: object
    law: object
    metric: Metric
    provided: set
    plan: object


def build(order, seed, folder, exact=False):
    """Builds the case of an order and writes it to folder/<name>; `exact` states widths of 0 where none are. Returns its truth."""
    reason = None
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, zlib.crc32(order.name.encode()), attempt])
        try:
            return _build_once(order, rng, folder, exact)
        except (Unsuitable, NoEquilibrium, OutsideWindow) as problem:
            reason = problem
    raise RuntimeError(f"case {order.name}: none of {ATTEMPTS} draws is suitable; the last: {reason}")


def _build_once(order, rng, folder, exact):
    setting = _setting(order, rng)
    names = available(setting.world, setting.path, setting.provided)
    world, hidden = _hide(order, rng, setting, names)
    truth = _truth(order, setting, world, hidden, names)
    _write(order, rng, setting, world, truth, folder, exact)
    return truth


def _setting(order, rng):
    needs = set()
    for name in order.hidden:
        needs |= set(CATALOGUE[name].needs if name in CATALOGUE else UNKNOWN[name][1])
    if order.kind in ("pair", "masking", "confusable") and order.size == "normal":
        # Sessions that can show many effects: two speeds, holds or several loops.
        needs |= set(_session(rng))
    muscle = draw_muscle(rng, order.family, set(order.hidden))
    plan = draw_plan(rng, order.family, needs, order.size)
    view = window(plan, order.family)
    largest = _largest_radius(muscle, plan)
    nature = draw_nature(rng, largest, plan)
    path = plan.path()
    middle = [round(0.5 * (a + b), -2) for a, b in zip(plan.pressures[:-1], plan.pressures[1:])]
    unseen = replace(plan, repeats=1).path(middle)
    bare = World(muscle, view, nature)
    force = bare.force(path)
    # dF/dp is about F/p; dF/deps follows from neighbouring contractions.
    shifted = bare.force(replace(path, contraction=path.contraction + 1e-4))
    slopes = np.sqrt(np.mean((force / path.pressure) ** 2)), np.sqrt(np.mean(((shifted - force) / 1e-4) ** 2))
    law_names = STATIC_LAWS if plan.form == "static" else LAWS
    law = draw_law(rng, law_names[int(rng.integers(len(law_names)))], np.abs(force).max(), path, slopes)
    muscle = with_instruments(rng, muscle, law, _completeness(order, rng))
    errors = {
        name: width * float(np.clip(rng.standard_normal(), -1.8, 1.8))
        for name, width in stated_widths(muscle).items()
        if name not in order.hidden
    }
    world = World(muscle, view, nature, errors)
    return Setting(world, path, unseen, law, Metric(world, path, law), provides(plan), plan)


def _session(rng):
    return (("rate",), ("dwell",), ("cycles",), ("rate", "temperature"), ("specimens",), ())[int(rng.integers(6))]


def _largest_radius(muscle, plan):
    """Radius of the equator at the end of the stroke [m]."""
    shape = Shape(muscle.kind, muscle.length, muscle.radius, muscle.radius, fibres=muscle.fibres, braid_angle=muscle.braid_angle or 0.0)
    return float(solve(shape.body(), 1e5, muscle.length * (1.0 - plan.high)).equator)


def _completeness(order, rng):
    if order.kind in ("rig-within", "rig-beyond"):
        return "full"
    return ("full", "full", "full", "full", "full", "full", "full", "noise", "none", "none")[int(rng.integers(10))]


def _hide(order, rng, setting, names):
    """The world with its hidden effects, and their names."""
    if order.kind == "null":
        return setting.world, []
    if order.kind == "rig-within":
        name = order.hidden[0]
        size = stated_widths(setting.world.muscle)[name] * rng.uniform(0.9, 1.6) * rng.choice([-1.0, 1.0])
        return setting.world.changed({name: float(size)}), []
    if order.kind == "unknown":
        return _hide_unknown(order, rng, setting, names)
    if order.kind in ("single", "rig-beyond"):
        chosen = [(order.hidden[0], _sign(rng, order.hidden[0]))]
    else:
        chosen = _choose(order, rng, setting, names)
    world = setting.world
    for (name, sign), target in zip(chosen, order.targets):
        world = _scaled(world, setting.metric, name, sign, target)
    return world, [name for name, _ in chosen]


def _sign(rng, name):
    return 1.0 if CATALOGUE[name].sign else float(rng.choice([-1.0, 1.0]))


def _scaled(world, metric, name, sign, target):
    """The world with the effect at the amplitude whose signature has the wanted norm."""
    effect = CATALOGUE[name]
    if effect.fixed:
        return world.changed({name: 1.0})
    base = world.force(metric.path)

    def norm(amplitude):
        return metric.norm(world.changed({name: amplitude}).force(metric.path) - base)

    return world.changed({name: _amplitude(norm, sign * effect.scale, effect.limit, effect.power, target)})


def _amplitude(norm, start, limit, power, target):
    """Solves norm(A) = target by repeated scaling with the local power of the norm."""
    amplitude = start
    for _ in range(14):
        found = norm(amplitude)
        if not found > 1e-9:
            raise Unsuitable("the effect leaves no trace in this test")
        if abs(found / target - 1.0) < CLOSE:
            return amplitude
        change = float(np.clip((target / found) ** (1.0 / power), 0.2, 5.0))
        amplitude = float(np.clip(amplitude * change, -limit, limit))
        if abs(amplitude) == limit and norm(amplitude) < target:
            raise Unsuitable(f"even the largest plausible amplitude has d < {target}")
    raise Unsuitable("the amplitude for the wanted detectability was not found")


def _choose(order, rng, setting, names):
    """Pairs that differ (|rho| < 0.5), pairs that hide each other (rho from -0.9 to -0.5), or an effect that has a twin in this test."""
    candidates = [name for name in names if not CATALOGUE[name].fixed]
    gram = setting.metric.gram(tangents(setting.world, setting.path, candidates, setting.metric.base))
    norms = np.sqrt(np.maximum(np.diag(gram), 1e-30))
    cosine = gram / np.outer(norms, norms)
    reachable = np.array([_reachable(name, norm, max(order.targets)) for name, norm in zip(candidates, norms)])
    signs = np.array([CATALOGUE[name].sign for name in candidates])
    first, second = np.where(~np.eye(len(candidates), dtype=bool) & reachable[:, None] & reachable[None, :])
    rho = cosine[first, second]
    if order.kind == "confusable":
        twins = np.unique(first[(np.abs(rho) > 0.97) & ((rho > 0.0) | (signs[second] == 0))])
        if twins.size == 0:
            raise Unsuitable("no two effects are alike in this test")
        name = candidates[int(rng.choice(twins))]
        return [(name, _sign(rng, name))]
    free = (signs[first] == 0) | (signs[second] == 0)
    if order.kind == "pair":
        fits = np.abs(rho) < 0.5
    else:
        fits = (np.abs(rho) > 0.5) & (np.abs(rho) < 0.9) & (free | (rho < 0.0))
    if not fits.any():
        raise Unsuitable(f"no pair in this test is {order.kind}")
    pick = int(rng.choice(np.flatnonzero(fits)))
    pair = [candidates[first[pick]], candidates[second[pick]]]
    chosen = [(name, _sign(rng, name)) for name in pair]
    if order.kind == "masking":
        product = chosen[0][1] * chosen[1][1] * rho[pick]
        if product > 0.0:
            turned = 0 if CATALOGUE[pair[0]].sign == 0 else 1
            chosen[turned] = (pair[turned], -chosen[turned][1])
    return chosen


def _reachable(name, norm, target):
    effect = CATALOGUE[name]
    share = 1.0 if effect.power != 1.0 else 0.3
    largest = norm * (effect.limit / (share * effect.scale)) ** effect.power
    return largest * UNREACHABLE > target


def _hide_unknown(order, rng, setting, names):
    """An effect outside the catalogue, of the wanted norm after the two effects of the catalogue that explain most of it."""
    name, sign = order.hidden[0], float(rng.choice([-1.0, 1.0]))
    metric, world = setting.metric, setting.world
    columns = tangents(world, setting.path, names, metric.base)
    signs = np.array([CATALOGUE[n].sign for n in names])

    def norm(amplitude):
        signature = world.changed({name: amplitude}).force(metric.path) - metric.base
        gram = metric.gram(np.column_stack([signature, columns]))
        return rival_pairs(gram[0, 0], gram[0, 1:], gram[1:, 1:], signs)

    amplitude = _amplitude(norm, sign, 1e6, 1.0, order.targets[0])
    return world.changed({name: amplitude}), [name]


def _truth(order, setting, world, hidden, names):
    """What is hidden, how well it can be seen, and which names count as right."""
    metric, law = setting.metric, setting.law
    clean = world.force(setting.path)
    entries = []
    if hidden:
        alone = np.stack([clean - world.changed({name: 0.0}).force(setting.path) for name in hidden], axis=1)
        others = [name for name in names if name not in hidden]
        columns = np.column_stack([alone, tangents(setting.world, setting.path, others, metric.base)])
        gram = metric.gram(columns)
        signs = np.array([CATALOGUE[name].sign for name in others])
        entries = [_entry(name, i, world, gram, len(hidden), others, signs) for i, name in enumerate(hidden)]
    sd = float(np.sqrt(metric.variance.mean() + law.correlated**2 + law.offset**2))
    signature = clean - setting.metric.base
    stated = World(setting.world.muscle, setting.world.window, setting.world.nature)
    return {
        "case": order.name,
        "kind": order.kind,
        "family": order.family,
        "size": order.size,
        "rows": len(setting.path),
        "protocol": setting.plan.form,
        "expected": {"null": "adequate", "rig-within": "adequate", "unknown": "unknown"}.get(order.kind, "missing"),
        "hidden": entries,
        "acceptable": sorted({name for entry in entries for name in entry["acceptable"]}),
        "misfit_n": float(np.sqrt(np.mean(signature**2))),
        "stated_misfit_n": float(np.sqrt(np.mean((clean - stated.force(setting.path)) ** 2))),
        "noise": {**law.describe(), "rms_n": sd},
        "rig_errors": {name: value for name, value in world.amplitudes.items() if name not in hidden},
        "unseen": "unseen.csv",
    }


def _entry(name, i, world, gram, count, others, signs):
    """One hidden effect; rivals are judged with the other hidden effects fitted beside them."""
    rest = [k for k in range(count) if k != i]
    kept = [i, *range(count, gram.shape[0])]
    left = gram[np.ix_(kept, kept)]
    if rest:
        cross = gram[np.ix_(rest, kept)]
        left = left - cross.T @ np.linalg.solve(gram[np.ix_(rest, rest)], cross)
    apart = rivals(left[0, 0], left[0, 1:], np.diag(left)[1:], signs)
    known = CATALOGUE.get(name)
    entry = {
        "effect": name,
        "d": float(np.sqrt(max(gram[i, i], 0.0))),
        "d_given_others": float(np.sqrt(max(left[0, 0], 0.0))),
        "amplitude": float(world.amplitude(name)),
        "unit": known.unit if known else "N",
        "acceptable": [],
        "class": [],
    }
    if known is None:
        entry["d_beyond_one"] = float(apart.min())
        entry["d_beyond_two"] = rival_pairs(left[0, 0], left[0, 1:], left[1:, 1:], signs)
        entry["d_beyond_all"] = _beyond_all(left)
        return entry
    entry["acceptable"] = [name, *(other for other, d in zip(others, apart) if d < IDENTICAL)]
    entry["class"] = [name, *(other for other, d in zip(others, apart) if d < CLASS)]
    entry["nearest"] = {"effect": others[int(np.argmin(apart))], "separation": float(apart.min())}
    if known.reported:
        parameter, unit, size = known.reported
        entry["reported"] = {"parameter": parameter, "unit": unit, "value": entry["amplitude"] * size}
    return entry


def _beyond_all(gram):
    """Norm that is left if every effect of the catalogue may have any amplitude at once."""
    scale = np.sqrt(np.maximum(np.diag(gram)[1:], 1e-30))
    inner = gram[1:, 1:] / np.outer(scale, scale)
    cross = gram[1:, 0] / scale
    values, vectors = np.linalg.eigh(inner)
    good = values > 1e-8 * values[-1]
    part = (vectors.T @ cross)[good]
    return float(np.sqrt(max(gram[0, 0] - (part**2 / values[good]).sum(), 0.0)))


def _write(order, rng, setting, world, truth, folder, exact):
    """data.csv, muscle.toml, unseen.csv and, last, truth.json."""
    target = folder / order.name
    unit, motion = write_data(target, rng, setting, world, exact)
    paths.write(target / "unseen.csv", setting.unseen, world.force(setting.unseen), world.muscle.length, unit, motion)
    (target / "truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")


def write_data(target, rng, setting, world, exact):
    """data.csv and muscle.toml; the unit of the pressure and how the motion is given."""
    target.mkdir(parents=True, exist_ok=True)
    law, path = setting.law, setting.path
    force, pressure, contraction = law.sample(rng, path)
    readings = replace(
        path,
        pressure=rounded(path.pressure + pressure, law.pressure_step),
        contraction=path.contraction + contraction,
        temperature=path.temperature + 0.05 * rng.standard_normal(len(path)) * path.shows_temperature,
    )
    unit = ("bar", "kPa")[int(rng.integers(2))]
    motion = ("contraction", "length")[int(rng.integers(2))]
    paths.write(target / "data.csv", readings, rounded(world.force(path) + force, law.force_step), world.muscle.length, unit, motion)
    (target / "muscle.toml").write_text(world.muscle.toml(exact), encoding="utf-8")
    return unit, motion
