"""The list of sets: which kind of damage, habit, column, rig, size, strength, and what is hidden beside it."""

from dataclasses import dataclass

import numpy as np
from bench.rigs import RIGS

from .habits import HABITS, listed

EACH = 16
"""Least sets of a kind; a kind has each of its habits equally often."""
ROWS = (240, 300, 200, 360, 240, 450, 300, 900)
HIDDEN = ("rig-friction", "rubber", "pressure-zero", "strand-friction")
BESIDE = ("spikes", "shifted", "slip", "frozen", "clipped", "duplicated", "late", "gaps", "dropout", "stuck-bit")
"""Damage beside a hidden effect: that which leaves most of the data whole."""
UNFIT = {"rubber": (), "pressure-zero": (), "rig-friction": ("isometric",), "strand-friction": ("isometric", "isotonic")}
"""Rigs that don't show an effect, or don't move enough for it."""
WITH_HIDDEN = 40
WHOLE = 24


@dataclass(frozen=True)
class Order:
    """One set. `twin` is the name of the set whose random numbers it shares."""

    name: str
    kind: str
    habit: str
    column: str
    rig: str
    rows: int
    strength: float
    hidden: str | None = None
    whole: bool = False
    twin: str | None = None


def orders():
    """All sets, in a fixed order."""
    damaged = list(_damaged())
    step = len(damaged) / WHOLE
    hidden = list(_hidden())
    return [*damaged, *(_whole(damaged[int(k * step)]) for k in range(WHOLE)), *hidden, *(_whole(order) for order in hidden)]


def _damaged():
    for number, kind in enumerate(sorted(HABITS)):
        habits = listed(kind)
        count = -(-EACH // len(habits)) * len(habits)
        rng = np.random.default_rng([7, number])
        strengths = (rng.permutation(count) + 0.5) / count
        rigs = rng.permutation(np.resize(RIGS, count))
        for i, (strength, rig) in enumerate(zip(strengths, rigs)):
            name, column = habits[i % len(habits)]
            yield Order(f"{kind}-{name}-{column}-{rig}-{i:02d}", kind, name, column, str(rig), ROWS[(i * 3 + number) % len(ROWS)], float(strength))


def _hidden():
    for i in range(WITH_HIDDEN):
        family, kind = HIDDEN[i % len(HIDDEN)], BESIDE[i % len(BESIDE)]
        name, column = listed(kind)[(i // len(BESIDE) * 2 + i) % len(listed(kind))]
        rigs = [rig for rig in RIGS if rig not in UNFIT[family]]
        rig = rigs[i // len(HIDDEN) % len(rigs)]
        strength = ((i * 7) % WITH_HIDDEN + 0.5) / WITH_HIDDEN
        yield Order(f"hidden-{family}-{kind}-{name}-{column}-{rig}-{i:02d}", kind, name, column, rig, ROWS[i % len(ROWS)], strength, family)


def _whole(order):
    """The same set before it was damaged."""
    return Order(**{**vars(order), "name": f"whole-{order.name}", "whole": True, "twin": order.name})
