"""Rivals of a hidden effect: signatures of the usual formulas, some at several values of the numbers that no diagnosis is told."""

from dataclasses import replace

import numpy as np

from .detectability import available
from .forms_effects import EFFECTS, shows

TANGENT = 0.3
"""Share of an effect's usual amplitude at which its signature is taken."""
NUMBERS = {
    "presliding-hysteresis": ("presliding_lengths", (0.15, 0.5, 2.0)),
    "pressure-threshold": ("threshold_pressure", (0.3, 3.0)),
    "creep": ("relaxation_times", (0.1, 10.0)),
    "stress-softening": ("conditioning_loops", (0.5, 2.5)),
    "limited-unfolding": ("cloth_radius", (0.97, 1.03)),
}
"""Entry of `Nature`, and factors on it."""
WORLDS = {
    "coulomb-friction": {"sliding": "sign"},
    "pressure-friction": {"sliding": "sign"},
    "force-friction": {"sliding": "sign"},
    "self-heating": {"heating": 1.0},
    "creep": {"creep": "alone"},
}
"""Entries of the world that are tried too."""


def rival_names(world, path, provided, order):
    """The catalogue's formulas that this muscle has and this test can show."""
    found = [name for name in available(world, path, provided) if not EFFECTS[name].fixed]
    found += ["self-heating", "fibre-length"]
    if world.muscle.kind == "braided":
        found += ["bladder-prestrain", "radius-error"]
    if "pressure-path" in provided:
        found += ["pressure-lag", "pressure-hysteresis"]
    return [name for name in found if shows(order.rig, name) or name.startswith("pressure-")]


def columns(world, path, names, base, own=()):
    """Signatures (rows x m) and the name of each: small amplitudes of the named effects; of the `own` ones, pairs of name and amplitude, that one too."""
    labels, found = [], []
    for name, amplitude in [*((name, _small(name)) for name in names), *own]:
        one = world.changed({name: world.amplitude(name) + amplitude})
        for variant in [one, *_variants(one, name)]:
            labels.append(name)
            found.append(variant.force(path) - base)
    return labels, np.stack(found, axis=1)


def _small(name):
    effect = EFFECTS[name]
    return (1.0 if effect.power != 1.0 else TANGENT) * effect.scale


def _variants(world, name):
    if name in WORLDS:
        yield replace(world, **WORLDS[name])
    if name in NUMBERS:
        entry, factors = NUMBERS[name]
        value = np.array(getattr(world.nature, entry))
        for factor in factors:
            changed = value * factor
            yield replace(world, nature=replace(world.nature, **{entry: tuple(changed.tolist()) if changed.ndim else float(changed)}))
