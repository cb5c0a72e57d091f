"""The effects of the forms suite: those of `effects.py` with bounds that real muscles and rigs keep, and five more; mechanism of each family.

Bounds are the plausible ranges that the literature gives (the same sources as the catalogue's): friction to 80 N, gains to 5 %, zeros to 8 mm, 10 kPa
and 50 N, frames to 2 um/N, fibres to 0.5 %/kN, lags to 2 s.
"""

from dataclasses import replace

from .effects import BOTH, BRAIDED, CATALOGUE, Effect

MECHANISMS = {
    "dry friction": ("coulomb-friction", "pressure-friction", "force-friction", "presliding-hysteresis"),
    "rate": ("viscous-damping",),
    "relaxation": ("creep",),
    "softening and heat": ("stress-softening", "self-heating", "temperature"),
    "rubber": ("bladder-elasticity", "membrane-axial", "bladder-prestrain"),
    "cloth and fibres": ("fibre-stretch", "limited-unfolding", "uneven-fibres", "low-load-slack"),
    "section": ("lobes", "pleat-depth", "end-radius"),
    "fibre geometry": ("fibre-length", "fibre-count", "fibre-misalignment", "radius-error", "braid-angle-error", "wall-thickness"),
    "ends": ("end-taper",),
    "length chain": ("length-zero-error", "displacement-gain"),
    "give of the rig": ("frame-compliance", "end-slip"),
    "pressure chain": ("pressure-offset", "pressure-gain", "pressure-threshold"),
    "regulator": ("regulator-lag",),
    "force chain": ("force-offset", "force-gain", "force-nonlinearity", "force-drift"),
    "late reading": ("force-lag",),
    "specimens": ("specimen-spread",),
    "hysteresis of the bladder": ("bladder-hysteresis",),
    "pressure sensor": ("pressure-hysteresis", "pressure-lag"),
}
"""Families (by their head) of each mechanism."""

MEMBERS = {
    "coulomb-friction": ("asymmetric-friction",),
    "pressure-friction": ("pressure-presliding", "crossing-friction", "contact-friction"),
    "force-friction": ("tension-friction",),
    "presliding-hysteresis": ("maxwell-slip", "bouc-wen"),
    "viscous-damping": ("pressure-viscosity",),
    "creep": ("pressure-creep", "fibre-creep", "standard-linear-solid"),
    "bladder-elasticity": ("bladder-c01", "hoop-elasticity"),
    "membrane-axial": ("bladder-axial",),
    "end-taper": ("end-factor",),
    "pressure-gain": ("line-drop",),
    "regulator-lag": ("pressure-droop", "valve-hysteresis"),
    "force-offset": ("weight",),
    "force-gain": ("load-misalignment",),
    "bladder-hysteresis": ("bladder-relaxation",),
}
"""Names beside the head of each family."""

FAMILY = {name: head for head, names in MEMBERS.items() for name in names}
MECHANISM = {family: mechanism for mechanism, families in MECHANISMS.items() for family in families}
MOVED = ("bladder-prestrain", "self-heating")
"""Families of their own here, whatever an older program's card says."""


def family(name, cards=None):
    """Head of the family of a name; `cards` are a program's own families, for names that are not known here."""
    return FAMILY.get(name, name if name in MECHANISM else (cards or {}).get(name, name))


def mechanism(name, cards=None):
    """Mechanism of a name; that of its family, or the family itself where none is known."""
    head = family(name, cards)
    return MECHANISM.get(head, head)


def _bounded(name, limit, **more):
    return replace(CATALOGUE[name], limit=limit, **more)


EFFECTS = {
    **CATALOGUE,
    **{
        effect.name: effect
        for effect in (
            _bounded("pressure-friction", 3e-4),
            _bounded("viscous-damping", 4e4),
            _bounded("creep", 30.0, needs=("motion",)),
            _bounded("stress-softening", 0.5),
            _bounded("fibre-misalignment", 0.105),
            _bounded("uneven-fibres", 0.01),
            _bounded("frame-compliance", 2e-6),
            _bounded("end-slip", 4e-7),
            _bounded("force-nonlinearity", 2e-5),
            _bounded("force-drift", 8e-3),
            _bounded("force-lag", 2.0),
            _bounded("regulator-lag", 2.0),
            _bounded("force-gain", 0.05),
            _bounded("pressure-gain", 0.05),
            _bounded("pressure-offset", 1e4),
            _bounded("force-offset", 50.0),
            _bounded("displacement-gain", 0.05),
            _bounded("specimen-spread", 0.05),
            _bounded("low-load-slack", 100.0),
            Effect("self-heating", BOTH, 5e-3, 0.15, "1", needs=("motion",)),
            Effect("bladder-prestrain", BRAIDED, 20.0, 300.0, "N/m"),
            Effect("line-drop", BOTH, 3e-3, 0.05, "1", sign=1, rig=True),
            Effect("fibre-length", BOTH, 5e-5, 4e-3, "m", structural=True),
            Effect("radius-error", BRAIDED, 5e-5, 1e-3, "m", structural=True),
            Effect("pressure-lag", BOTH, 0.05, 1.0, "s", needs=("pressure-path",)),
            Effect("pressure-hysteresis", BOTH, 300.0, 1e4, "Pa", needs=("pressure-path",)),
        )
    },
}
"""All that can be hidden or be a rival, by name."""

LOOSE = (
    "coulomb-friction", "pressure-friction", "force-friction", "presliding-hysteresis", "viscous-damping", "creep", "stress-softening",
    "self-heating", "temperature", "bladder-elasticity", "membrane-axial", "bladder-prestrain", "fibre-stretch", "limited-unfolding",
    "uneven-fibres", "low-load-slack", "frame-compliance", "end-slip", "line-drop", "regulator-lag", "force-nonlinearity", "force-lag",
)  # fmt: skip
"""Effects that are hidden in another form than the catalogue's."""
EXACT = (
    "end-radius", "pleat-depth", "fibre-length", "fibre-count", "fibre-misalignment", "radius-error", "braid-angle-error", "wall-thickness",
    "length-zero-error", "displacement-gain", "pressure-offset", "pressure-gain", "pressure-threshold", "force-offset", "force-gain",
    "force-drift", "specimen-spread",
)  # fmt: skip
"""Effects that keep their formula. Lobes and the ends of a cylinder are there or not: they have no strength to choose, and are hidden nowhere."""

AT_HELD_LENGTH = (
    "creep", "stress-softening", "self-heating", "temperature", "bladder-elasticity", "fibre-stretch", "frame-compliance", "end-slip",
    "regulator-lag", "force-nonlinearity", "force-lag", "pressure-offset", "pressure-gain", "pressure-threshold", "force-offset",
    "force-gain", "force-drift", "length-zero-error", "wall-thickness", "radius-error", "braid-angle-error", "fibre-length", "pleat-depth",
)  # fmt: skip
"""What an isometric test shows."""
NOT_AT_HELD_LOAD = ("line-drop", "force-lag", "force-nonlinearity", "low-load-slack", "force-gain", "specimen-spread")
"""What an isotonic test doesn't show, or only by its few loads."""


def shows(rig, name):
    """Whether tests of a rig show an effect."""
    if rig == "isometric":
        return name in AT_HELD_LENGTH
    return rig == "isobaric" or name not in NOT_AT_HELD_LOAD


def kinds(name):
    """Kinds of muscles that have an effect: pleated, braided or both."""
    return EFFECTS[name].kinds


