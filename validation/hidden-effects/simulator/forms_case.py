"""Builds one case of the forms suite: draws muscle, test, rig and noise, hides effects in forms of the wanted strength, writes files and truth."""

import json
import zlib
from dataclasses import dataclass, replace

import numpy as np

from .case import CLASS, CLOSE, IDENTICAL, Unsuitable, _beyond_all, _completeness, _largest_radius, write_data
from .designs import LAWS, draw_law, draw_muscle, draw_nature, window, with_instruments
from .detectability import Metric, rival_pairs, rivals, stated_widths
from .forms import Drawn, all_forms, fold
from .forms_design import carried, draw_plan, loaded, provides, scales
from .forms_effects import EFFECTS, EXACT, LOOSE, family, mechanism, shows
from .forms_rivals import columns, rival_names
from .forms_world import FormsWorld
from .meridian import NoEquilibrium
from .surface import OutsideWindow, force_map
from .unknown import UNKNOWN

QUIETEST = (4e-4, 2e-4, 1e-4)
"""Least white noise over the largest force: of a good load cell, averaged over 4, over 16 readings; the later are tried if the first don't do."""
LARGEST_UNKNOWN = 0.05
"""Root mean square of an effect outside the catalogue over the largest force."""
VISIBLE = 0.6
"""Each of several hidden effects keeps this share of its strength when the others are fitted beside it."""
ATTEMPTS = 400
PLAIN_ATTEMPTS = 12
"""So many draws are tried for a case whose data are nearer to the exact formula of its own effect than to that of any other."""


@dataclass
class Setting:
    """A test before anything is hidden."""

    world: FormsWorld
    path: object
    law: object
    metric: Metric
    provided: set
    plan: object
    scales: object
    names: list


def build(order, seed, folder, exact=False):
    """Builds the case of an order and writes it to folder/<name>; `exact` states widths of 0 where none are. Returns its truth."""
    setting, world, truth, rng = draw(order, seed)
    _write(order, rng, setting, world, truth, folder, exact)
    return truth


def draw(order, seed):
    """The test of an order, the world with the hidden effects, the truth about it, and random numbers for its noise."""
    reason = None
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, zlib.crc32(order.name.encode()), attempt])
        least = QUIETEST[min(attempt // 8, len(QUIETEST) - 1)]
        try:
            return _draw_once(order, rng, least, attempt < PLAIN_ATTEMPTS)
        except (Unsuitable, NoEquilibrium, OutsideWindow) as problem:
            reason = problem
    raise RuntimeError(f"case {order.name}: none of {ATTEMPTS} draws is suitable; the last: {reason}")


def _draw_once(order, rng, least, plain):
    chosen = order.hidden or _choose(order, rng)
    strengths = order.strengths or tuple(float(np.exp(rng.uniform(np.log(12.0), np.log(120.0)))) for _ in chosen)
    if order.kind == "beside":
        known = _choose(order, rng)
        chosen, strengths = (*known, *chosen), (float(np.exp(rng.uniform(np.log(12.0), np.log(120.0)))), *strengths)
    draws = rng.integers(0, 2**63, 3)
    quiet = 1.0
    for _ in range(4):
        setting = _setting(order, draws[0], chosen, strengths, quiet)
        world, lacking = _hide(np.random.default_rng(draws[1]), setting, chosen, strengths)
        if lacking >= 1.0:
            break
        quiet *= 0.9 * lacking
        if setting.law.white * 0.9 * lacking < least * setting.scales.force:
            raise Unsuitable("even the largest plausible amplitude is too weak for the least noise")
    else:
        raise Unsuitable("the noise for the wanted strength was not found")
    setting, world = _under_load(setting, world, chosen, strengths)
    truth = _truth(order, setting, world, chosen, strengths)
    if plain and any(entry.get("nearer") for entry in truth["hidden"]):
        raise Unsuitable("another effect's exact formula is nearer to the data than that of the hidden one")
    return setting, world, truth, np.random.default_rng(draws[2])


def _choose(order, rng):
    """Known effects in a form each, of different mechanisms, which this rig and muscle show."""
    count = {"none": 0, "two": 2, "three": 3, "beside": 1}[order.kind]
    forms, found = all_forms(), []
    while len(found) < count:
        names = LOOSE if rng.random() < 0.75 else EXACT
        name = names[int(rng.integers(len(names)))]
        taken = {mechanism(one) for one, _ in found}
        if order.family not in EFFECTS[name].kinds or not shows(order.rig, name) or mechanism(name) in taken or not _fits(name, found):
            continue
        form = forms[name][int(rng.integers(len(forms[name])))].name if name in LOOSE else "exact"
        found.append((name, form))
    return tuple(found)


def _fits(name, found):
    """Whether one test can show an effect beside others: specimens and held steps or two speeds make it too long."""
    needs = set(EFFECTS[name].needs).union(*(EFFECTS[one].needs for one, _ in found))
    return len(needs & {"specimens", "cycles", "rate", "low-load"}) < 2


def _setting(order, seed, chosen, strengths, quiet):
    rng = np.random.default_rng(seed)
    names = [name for name, _ in chosen]
    needs = set().union(*(EFFECTS[name].needs if name in EFFECTS else UNKNOWN[name][1] for name in names))
    if "force-drift" in names and max(strengths) > 100.0:
        needs.add("long")
    if "creep" in names:
        needs.add("dwell")
    muscle = draw_muscle(rng, order.family, set(names))
    plan = draw_plan(rng, order.family, order.rig, needs, _rows(rng, order, max(strengths, default=12.0)))
    view = window(plan, order.family)
    largest = _largest_radius(muscle, plan)
    nature = draw_nature(rng, largest, plan)
    bare = FormsWorld(muscle, view, nature)
    static = force_map(bare.shape(), view)
    if order.rig == "isotonic":
        plan = loaded(rng, plan, static)
        path = carried(plan, plan.path(), bare, static, 0)
    else:
        path = plan.path()
    force = bare.force(path)
    shifted = bare.force(replace(path, contraction=path.contraction + 1e-4))
    slopes = np.sqrt(np.mean((force / path.pressure) ** 2)), np.sqrt(np.mean(((shifted - force) / 1e-4) ** 2))
    law = draw_law(rng, LAWS[int(rng.integers(len(LAWS)))], np.abs(force).max(), path, slopes)
    law = _quieter(law, quiet)
    muscle = with_instruments(rng, muscle, law, _completeness(order, rng))
    errors = {name: width * float(np.clip(rng.standard_normal(), -1.8, 1.8)) for name, width in stated_widths(muscle).items() if name not in names}
    world = FormsWorld(muscle, view, nature, errors)
    if order.rig == "isotonic":
        path = carried(plan, path, world, static, 2)
    provided = provides(plan, order.rig)
    sizes = scales(plan, path, force, muscle, largest)
    return Setting(world, path, law, Metric(world, path, law), provided, plan, sizes, rival_names(world, path, provided, order))


def _rows(rng, order, strength):
    """One in ten has few rows; strong effects are what long records see."""
    if order.sparse:
        return int(rng.uniform(110, 240))
    low = {0: 300, 1: 400, 2: 700, 3: 1000}[sum(strength > bound for bound in (20.0, 60.0, 200.0))]
    return int(np.exp(rng.uniform(np.log(low), np.log(2400.0))))


def _quieter(law, share):
    names = ("white", "correlated", "offset", "pressure", "contraction", "force_step", "pressure_step")
    return replace(law, **{name: float(f"{getattr(law, name) * share:.4g}") for name in names}) if share != 1.0 else law


def _hide(rng, setting, chosen, strengths):
    """The world with its hidden effects, and the least share of the wanted strengths that the largest plausible amplitudes reach."""
    world, metric, lacking = setting.world, setting.metric, 1.0
    for (name, form), strength in zip(chosen, strengths):
        if form == "outside":
            signature, sign = _outside_norm(rng, setting, name)
            before = world.force(setting.path)
            world = world.changed({name: sign * strength / signature})
            if np.sqrt(np.mean((world.force(setting.path) - before) ** 2)) > LARGEST_UNKNOWN * setting.scales.force:
                raise Unsuitable("the unknown effect would be larger than any bench has it")
            continue
        effect = EFFECTS[name]
        sign = 1.0 if effect.sign else float(rng.choice([-1.0, 1.0]))
        if form != "exact":
            one = next(entry for entry in all_forms()[name] if entry.name == form)
            alone = setting.world.formed(Drawn(one, one.draw(rng, setting.scales)), 0.0)
        else:
            alone = setting.world
        limit = limit_of(name, setting)
        amplitude, found = _amplitude(metric, alone, name, sign * min(effect.scale, 0.2 * limit), limit, effect.power, strength)
        if form != "exact":
            world = world.formed(alone.forms[name], amplitude)
        else:
            world = world.changed({name: alone.size(name) + amplitude})
        lacking = min(lacking, found / strength)
    return world, 1.0 if lacking > 1.0 - 2.0 * CLOSE else lacking


def limit_of(name, setting):
    """Largest plausible amplitude: some go with the muscle's size."""
    muscle = setting.world.muscle
    relative = {
        "pleat-depth": 0.45 * muscle.radius,
        "wall-thickness": 0.3 * muscle.radius,
        "end-radius": 0.3 * muscle.radius,
        "radius-error": 0.12 * muscle.radius,
        "fibre-length": 0.02 * muscle.length,
        "fibre-count": 0.1 * (muscle.fibres or 100),
        "length-zero-error": min(8e-3, 0.04 * muscle.length),
    }
    return relative.get(name, EFFECTS[name].limit)


def _amplitude(metric, world, name, start, limit, power, target):
    """Amplitude whose signature has the wanted norm, and the norm that is reached: less where the bounds end."""
    amplitude = start
    for _ in range(16):
        found = metric.norm(world.changed({name: world.size(name) + amplitude}).force(metric.path) - metric.base)
        if not found > 1e-9:
            raise Unsuitable("the effect leaves no trace in this test")
        if abs(found / target - 1.0) < CLOSE or (abs(amplitude) >= limit and found < target):
            return amplitude, found
        change = float(np.clip((target / found) ** (1.0 / power), 0.2, 5.0))
        amplitude = float(np.clip(amplitude * change, -limit, limit))
    raise Unsuitable("the amplitude for the wanted strength was not found")


def _outside_norm(rng, setting, name):
    """Norm of the unit signature of an unknown effect beyond the best two of the catalogue, and a sign."""
    metric, world = setting.metric, setting.world
    labels, tangents = columns(world, setting.path, setting.names, metric.base)
    signs = np.array([EFFECTS[one].sign for one in labels])
    sign = float(rng.choice([-1.0, 1.0]))
    signature = world.changed({name: sign}).force(metric.path) - metric.base
    gram = metric.gram(np.column_stack([signature, tangents]))
    norm = rival_pairs(gram[0, 0], gram[0, 1:], gram[1:, 1:], signs)
    if not norm > 1e-6:
        raise Unsuitable("two effects of the catalogue do what the unknown one does")
    return norm, sign


def _under_load(setting, world, chosen, strengths):
    """Under a held load the hidden effects change the pressure: the path follows, and the reference with it."""
    if not hasattr(setting.plan, "loads") or not chosen:
        return setting, world
    static = force_map(setting.world.shape(), setting.world.window)
    for _ in range(3):
        path = carried(setting.plan, setting.path, world, static, 5)
        setting = replace(setting, path=path, metric=Metric(setting.world, path, setting.law))
        name = chosen[0][0]
        if len(chosen) > 1 or name not in EFFECTS:
            break
        # One effect meets its strength on the new path too, unless its bounds end there.
        found = setting.metric.norm(world.force(path) - setting.metric.base)
        if abs(found / strengths[0] - 1.0) < CLOSE:
            break
        off, limit = setting.world.amplitudes.get(name, 0.0), limit_of(name, setting)
        change = (strengths[0] / max(found, 1e-9)) ** (1.0 / EFFECTS[name].power)
        world = world.changed({name: off + float(np.clip((world.size(name) - off) * change, -limit, limit))})
    return setting, world


def _truth(order, setting, world, chosen, strengths):
    """What is hidden, how well it can be seen, and which names count as right."""
    metric, law = setting.metric, setting.law
    clean = world.force(setting.path)
    names = [name for name, _ in chosen]
    entries = _entries(order, setting, world, clean, chosen, strengths) if chosen else []
    sd = float(np.sqrt(metric.variance.mean() + law.correlated**2 + law.offset**2))
    muscle = setting.world.muscle
    return {
        "case": order.name,
        "suite": "forms",
        "kind": order.kind,
        "family": order.family,
        "rig": order.rig,
        "size": order.size,
        "rows": len(setting.path),
        "cycles": setting.plan.loops,
        "protocol": setting.plan.form,
        "widths_stated": bool(muscle.widths),
        "instruments": sum(sheet != type(sheet)() for sheet in (muscle.force, muscle.pressure, muscle.stroke)),
        "expected": {"none": "adequate", "unknown": "unknown", "beside": "unknown"}.get(order.kind, "missing"),
        "hidden": entries,
        "acceptable": sorted({name for entry in entries for name in entry["acceptable"]}),
        "misfit_n": float(np.sqrt(np.mean((clean - metric.base) ** 2))),
        "largest_force_n": setting.scales.force,
        "noise": {**law.describe(), "rms_n": sd},
        "rig_errors": {name: value for name, value in setting.world.amplitudes.items() if name not in names},
    }


def _without(setting, world, name):
    """The world with one hidden effect less."""
    return world.changed({name: setting.world.amplitudes.get(name, 0.0)})


def _entries(order, setting, world, clean, chosen, strengths):
    metric = setting.metric
    names = [name for name, _ in chosen]
    alone = np.stack([clean - _without(setting, world, name).force(setting.path) for name in names], axis=1)
    own = [(name, world.size(name) * share) for name, form in chosen if form not in ("exact", "outside") for share in (0.6, 1.0)]
    labels, tangents = columns(setting.world, setting.path, setting.names, metric.base, own)
    gram = metric.gram(np.column_stack([alone, tangents]))
    signs = np.array([EFFECTS[name].sign for name in labels])
    entries = []
    for i, ((name, form), strength) in enumerate(zip(chosen, strengths)):
        entry = _entry(i, name, form, strength, world, gram, names, labels, signs)
        if order.kind != "one" and entry["d_given_others"] < max(10.0, VISIBLE * entry["d"]) and form != "outside":
            raise Unsuitable("the hidden effects hide each other")
        if order.kind == "beside" and form == "outside" and entry["d_beyond_two"] < 11.0:
            raise Unsuitable("the unknown effect is hardly seen beside the known one")
        entries.append(entry)
    return entries


def _entry(i, name, form, strength, world, gram, hidden, labels, signs):
    """One hidden effect; rivals are judged with the other hidden effects fitted beside them."""
    count = len(hidden)
    rest = [k for k in range(count) if k != i]
    own = np.array([family(label) == family(name) for label in labels])
    left = gram[np.ix_([i, *range(count, len(gram))], [i, *range(count, len(gram))])]
    if rest:
        cross = gram[np.ix_(rest, [i, *range(count, len(gram))])]
        left = left - cross.T @ np.linalg.solve(gram[np.ix_(rest, rest)] + 1e-9 * np.eye(len(rest)), cross)
    apart = rivals(left[0, 0], left[0, 1:], np.diag(left)[1:], signs)
    heads = {family(one) for one in hidden}
    others = [k for k, label in enumerate(labels) if family(label) not in heads]
    entry = {
        "effect": name,
        "family": family(name),
        "mechanism": mechanism(name),
        "form": form,
        "fold": None,
        "strength": strength,
        "d": float(np.sqrt(max(gram[i, i], 0.0))),
        "d_given_others": float(np.sqrt(max(left[0, 0], 0.0))),
        "amplitude": float(world.size(name)),
        "unit": EFFECTS[name].unit if name in EFFECTS else "N",
        "acceptable": [],
        "class": [],
    }
    if form == "outside":
        kept = [0, *(1 + k for k in others)]
        entry.update(family=None, mechanism=None, d_beyond_one=float(apart[others].min()))
        entry["d_beyond_two"] = rival_pairs(left[0, 0], left[0, 1:][others], left[1:, 1:][np.ix_(others, others)], signs[others])
        entry["d_beyond_all"] = _beyond_all(left[np.ix_(kept, kept)])
        return entry
    if form != "exact":
        drawn = world.forms[name]
        entry["fold"], entry["constants"] = fold(drawn.form), drawn.constants
        # What its own exact formula leaves.
        entry["d_form"] = float(apart[own].min()) if own.any() else None
    nearest = min(others, key=lambda k: apart[k])
    entry["acceptable"] = [name, *sorted({labels[k] for k in others if apart[k] < IDENTICAL})]
    entry["class"] = [name, *sorted({labels[k] for k in others if apart[k] < CLASS})]
    entry["nearest"] = {"effect": labels[nearest], "separation": float(apart[nearest])}
    if entry.get("d_form") is not None:
        entry["nearer"] = sorted({labels[k] for k in others if apart[k] < entry["d_form"] - IDENTICAL})
    known = EFFECTS[name]
    if known.reported and form == "exact":
        parameter, unit, size = known.reported
        entry["reported"] = {"parameter": parameter, "unit": unit, "value": entry["amplitude"] * size}
    return entry


def _write(order, rng, setting, world, truth, folder, exact):
    """data.csv, muscle.toml and, last, truth.json."""
    target = folder / order.name
    write_data(target, rng, setting, world, exact)
    (target / "truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
