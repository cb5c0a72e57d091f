"""The list of tests: which rig, hidden effects, dialect, size and damage each has."""

from dataclasses import dataclass

from .dialects import DIALECTS
from .rigs import RIGS

HIDDEN = {
    "isobaric": (
        ("strand-friction",), ("rig-friction",), ("pressure-zero",), ("strand-friction",), ("rubber-loss",), ("frame-compliance",), ("creep",),
        ("strand-friction", "pressure-zero"),
    ),
    "isometric": (
        ("strand-friction",), ("rubber-loss",), ("pressure-hysteresis",), ("creep",), ("pressure-lag",), ("rubber-loss",),
        ("strand-friction",), ("pressure-hysteresis", "rubber-loss"),
    ),
    "isotonic": (
        ("strand-friction",), ("rig-friction",), ("pressure-hysteresis",), ("rubber-loss",), ("strand-friction",), ("pressure-lag",),
    ),
    "mixed": (("strand-friction",), ("rig-friction",), ("pressure-hysteresis",), ("creep",), ("strand-friction",), ("pressure-zero",)),
}  # fmt: skip
"""What is hidden in the tests of each rig, in turn."""
COUNTS = {"isobaric": 16, "isometric": 28, "isotonic": 14, "mixed": 14}
ROWS = (300, 600, 450, 1200, 240, 900, 2000, 400)
NULLS = 100
DAMAGE = (
    ("nan", "spikes"), ("duplicates", "blank"), ("frozen", "nan"), ("clipped", "duplicates"), ("spikes", "duplicates", "nan"),
    ("mislabelled", "spikes"), ("negative-pressure", "nan"), ("spikes",), ("blank", "frozen"), ("mislabelled", "clipped"),
    ("nan", "blank", "duplicates", "spikes"),
)  # fmt: skip
LARGE_ROWS = (15000, 3000, 6000, 1500)
LARGE = 12
HARD = (
    ("isometric", (), 15000, ("spikes", "frozen"), "heavy", 0.0),
    ("isobaric", (), 6000, (), "correlated", 200.0),
    ("isotonic", (), 3000, ("shifted",), "white", 0.0),
    ("isometric", (), 3000, ("shifted", "nan"), "heavy", 0.0),
    ("mixed", (), 15000, (), "correlated", 300.0),
    ("isobaric", (), 15000, ("spikes", "clipped"), "white", 0.0),
    ("isobaric", ("strand-friction",), 15000, (), "correlated", 50.0),
    ("isometric", ("rubber-loss",), 3000, ("spikes",), "heavy", 0.0),
    ("isometric", ("pressure-hysteresis",), 1200, (), "correlated", 100.0),
    ("isotonic", ("strand-friction",), 6000, ("shifted",), "white", 0.0),
    ("mixed", ("creep",), 6000, (), "heavy", 0.0),
    ("isometric", ("strand-friction", "creep"), 1200, ("nan", "spikes"), "correlated", 30.0),
)
"""Rig, hidden, rows, damage, law of the noise and rows within which it forgets: each a trap for what takes rows for independent or a shift for physics."""
NAMES = tuple(DIALECTS)
SELECTED = (
    "isobaric-strand-friction-and-pressure-zero-15",
    "isometric-rubber-loss-13",
    "isometric-strand-friction-00",
    "isometric-strand-friction-06",
    "isotonic-strand-friction-10",
    "mixed-strand-friction-10",
    "null-isobaric-damaged-097",
    "null-isometric-damaged-011",
)
"""Small tests of all rigs in eight dialects, for the program's own tests."""


@dataclass(frozen=True)
class Order:
    """One test to be made. `group` is hidden, null, large or hard; `noise`: law and memory in rows, drawn if None."""

    name: str
    group: str
    rig: str
    hidden: tuple = ()
    dialect: str = "contract"
    rows: int = 600
    damage: tuple = ()
    number: int = 0
    noise: tuple | None = None


def orders():
    """All tests, in a fixed order."""
    return [*_hidden(), *_nulls(), *_large(), *_hard()]


def _hidden():
    number = 0
    for rig in RIGS:
        for i in range(COUNTS[rig]):
            hidden = HIDDEN[rig][i % len(HIDDEN[rig])]
            damage = DAMAGE[number % len(DAMAGE)] if number % 5 == 4 else ()
            yield _order(f"{rig}-{'-and-'.join(hidden)}-{i:02d}", "hidden", rig, hidden, number, damage)
            number += 1


def _nulls():
    for i in range(NULLS):
        damage = DAMAGE[i // 2 % len(DAMAGE)] if i % 2 else ()
        # Rigs and dialects in turn, both with and without damage.
        yield _order(
            f"null-{RIGS[i // 2 % 4]}-{'damaged' if damage else 'whole'}-{i:03d}",
            "null",
            RIGS[i // 2 % 4],
            (),
            i // 2 + 31 * (i % 2),
            damage,
        )


def _large():
    for i in range(LARGE):
        rows = LARGE_ROWS[i // 2 % len(LARGE_ROWS)]
        rig = ("isometric", "isobaric", "isometric", "isotonic", "isometric", "mixed")[i // 2 % 6]
        if i % 2:
            hidden = HIDDEN[rig][i // 2 % len(HIDDEN[rig])]
            yield Order(f"large-{rig}-{'-and-'.join(hidden)}-{rows}-{i:02d}", "large", rig, hidden, rows=rows, number=i)
        else:
            damage = ("spikes", "nan", "frozen") if i % 4 == 2 else ()
            yield Order(
                f"large-null-{rig}-{'damaged' if damage else 'whole'}-{rows}-{i:02d}", "large", rig, rows=rows, damage=damage, number=i
            )


def _hard():
    for i, (rig, hidden, rows, damage, law, memory) in enumerate(HARD):
        what = "-and-".join(hidden) or "null"
        yield Order(f"hard-{what}-{rig}-{rows}-{i:02d}", "hard", rig, hidden, rows=rows, damage=damage, number=i, noise=(law, memory))


def _order(name, group, rig, hidden, number, damage):
    dialect = "labelled" if "mislabelled" in damage else NAMES[number % len(NAMES)]
    return Order(name, group, rig, hidden, dialect, ROWS[(number + number // len(ROWS)) % len(ROWS)], damage, number)
