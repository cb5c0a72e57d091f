"""The list of cases of the forms suite: kind, muscle, rig, hidden effects with their forms, strengths and size of the data."""

from dataclasses import dataclass

from .effects import BOTH
from .forms import all_forms
from .forms_effects import EFFECTS, EXACT, LOOSE, shows
from .unknown import UNKNOWN

STRENGTHS = (8.0, 12.0, 40.0, 120.0, 300.0)
COUNTS = {"none": 80, "two": 80, "three": 40, "unknown": 60, "beside": 40}
EXACT_PER_STRENGTH = 16
FORMS_PER_STRENGTH = 2
PRESSURE_DRIVEN = ("isobaric", "isometric", "isobaric", "isotonic", "isobaric", "isobaric", "isometric", "isobaric")
"""Rigs in turn."""


@dataclass(frozen=True)
class Order:
    """One case to be built. `hidden` names (effect, form or "exact"); empty where the builder chooses. `strengths`: wanted d, drawn if empty."""

    name: str
    kind: str
    family: str
    rig: str
    hidden: tuple = ()
    strengths: tuple = ()
    sparse: bool = False

    @property
    def effects(self):
        """Names of the hidden effects that the order fixes."""
        return tuple(name for name, _ in self.hidden)

    @property
    def size(self):
        """As orders of the present suite have it."""
        return "sparse" if self.sparse else "normal"


def orders():
    """All cases, in a fixed order."""
    return [*_one(), *_several(), *_outside()]


def _rig(number, name=None):
    """The rig whose turn it is, if it shows the effect; the next one that does otherwise."""
    wanted = PRESSURE_DRIVEN[number % len(PRESSURE_DRIVEN)]
    return wanted if name is None or shows(wanted, name) else "isobaric"


def _one():
    forms, number = all_forms(), 0
    for place, strength in enumerate(STRENGTHS):
        chosen = []
        for name in LOOSE:
            count = len(forms[name])
            for k in range(FORMS_PER_STRENGTH):
                chosen.append((name, forms[name][(FORMS_PER_STRENGTH * place + k) % count].name))
        chosen += [(EXACT[(EXACT_PER_STRENGTH * place + k) % len(EXACT)], "exact") for k in range(EXACT_PER_STRENGTH)]
        for name, form in chosen:
            families = EFFECTS[name].kinds
            family = families[number % len(families)]
            rig = _rig(number * 3 + place, name)
            label = f"one-{name}-{form}-d{strength:g}-{number:03d}"
            yield Order(label, "one", family, rig, ((name, form),), (strength,), number % 10 == 7)
            number += 1


def _several():
    for kind in ("none", "two", "three"):
        for i in range(COUNTS[kind]):
            yield Order(f"{kind}-{i:03d}", kind, BOTH[i % 2], _rig(i // 2), sparse=i % 10 == 7)


def _outside():
    names = list(UNKNOWN)
    for kind in ("unknown", "beside"):
        for i in range(COUNTS[kind]):
            name = names[i % len(names)]
            # These are shapes along the contraction, which doesn't move in an isometric test.
            rig = "isotonic" if i % 6 == 5 and name not in ("pressure-window", "one-way") else "isobaric"
            yield Order(f"{kind}-{name}-{i:03d}", kind, BOTH[(i + i // len(names)) % 2], rig, ((name, "outside"),), (), i % 10 == 7)
