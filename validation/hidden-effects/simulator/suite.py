"""The list of cases: which kind, muscle family, hidden effects, size of the data and wanted detectability each has."""

from dataclasses import dataclass

from .effects import BOTH, CATALOGUE
from .unknown import UNKNOWN

LADDER = (2.0, 16.0, 4.0, 8.0, 3.0, 11.0, 6.0)
"""Detectabilities, in the order in which they are dealt out."""

PER_SINGLE = 4
COUNTS = {"null": 132, "rig-within": 44, "rig-beyond": 44, "pair": 64, "masking": 32, "confusable": 44}
PER_UNKNOWN = 5
RIG = tuple(effect.name for effect in CATALOGUE.values() if effect.rig and effect.name != "end-slip")
STATED_RIG = ("force-offset", "force-gain", "pressure-offset", "pressure-gain", "length-zero-error", "displacement-gain")


@dataclass(frozen=True)
class Order:
    """One case to be built. `hidden` is empty where the builder chooses (pairs) or nothing is hidden (null, rig-within)."""

    name: str
    kind: str
    family: str
    hidden: tuple = ()
    targets: tuple = ()
    size: str = "normal"


def orders():
    """All cases, in a fixed order."""
    return [*_null(), *_rig(), *_singles(), *_pairs(), *_unknown(), *_dense()]


def _size(number, needs=()):
    """Every sixth case is sparse, if its effect can be seen without time."""
    return "sparse" if number % 6 == 5 and not set(needs) - {"cloth-range", "low-load"} else "normal"


def _null():
    for i in range(COUNTS["null"]):
        yield Order(f"null-{i:03d}", "null", BOTH[i % 2], size=_size(i // 2))


def _rig():
    for i in range(COUNTS["rig-within"]):
        yield Order(f"rig-within-{i:03d}", "rig-within", BOTH[i % 2], (STATED_RIG[i // 2 % len(STATED_RIG)],), size=_size(i // 2))
    for i in range(COUNTS["rig-beyond"]):
        effect = RIG[i // 2 % len(RIG)]
        target = (4.0, 8.0, 16.0, 6.0, 11.0)[i % 5]
        size = _size(i // 2, CATALOGUE[effect].needs)
        yield Order(f"rig-beyond-{effect}-{i:03d}", "rig-beyond", BOTH[i % 2], (effect,), (target,), size)


def _singles():
    number = 0
    for effect in CATALOGUE.values():
        for family in effect.kinds:
            for i in range(PER_SINGLE):
                target = LADDER[number % len(LADDER)]
                size = _size(number, effect.needs)
                number += 1
                label = "fixed" if effect.fixed else f"d{target:g}"
                yield Order(f"single-{family}-{effect.name}-{label}-{i}", "single", family, (effect.name,), (target,), size)


def _pairs():
    for kind, targets in (("pair", (6.0, 8.0, 12.0, 16.0)), ("masking", (8.0, 12.0, 16.0)), ("confusable", (6.0, 8.0, 12.0, 16.0))):
        for i in range(COUNTS[kind]):
            first, second = targets[i % len(targets)], targets[(i // 2 + 1) % len(targets)]
            wanted = (first,) if kind == "confusable" else (first, second)
            yield Order(f"{kind}-{i:03d}", kind, BOTH[i % 2], (), wanted, _size(i // 2) if kind != "masking" else "normal")


def _unknown():
    number = 0
    for name, (_, needs) in UNKNOWN.items():
        for i in range(PER_UNKNOWN):
            target = (4.0, 8.0, 12.0, 16.0)[number % 4]
            number += 1
            yield Order(f"unknown-{name}-{i}", "unknown", BOTH[i % 2], (name,), (target,), _size(number, needs))


def _dense():
    for name, kind, family, hidden, targets in (
        ("dense-null-pleated", "null", "pleated", (), ()),
        ("dense-null-braided", "null", "braided", (), ()),
        ("dense-coulomb-friction", "single", "braided", ("coulomb-friction",), (8.0,)),
        ("dense-fibre-stretch", "single", "pleated", ("fibre-stretch",), (16.0,)),
        ("dense-bladder-elasticity", "single", "braided", ("bladder-elasticity",), (16.0,)),
        ("dense-resonance", "unknown", "pleated", ("resonance",), (16.0,)),
    ):
        yield Order(name, kind, family, hidden, targets, "dense")
