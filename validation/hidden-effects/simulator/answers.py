"""Truths and answers side by side: diagnoses as the JSON of `bulge diagnose` has them, and the baselines in the same form."""

import json
from dataclasses import dataclass, field

FAMILY = {
    "radius-error": "end-radius",
    "end-factor": "displacement-gain",
    "bladder-c01": "bladder-elasticity",
    "hoop-elasticity": "bladder-elasticity",
    "bladder-prestrain": "bladder-elasticity",
    "bladder-axial": "membrane-axial",
    "asymmetric-friction": "coulomb-friction",
    "crossing-friction": "pressure-friction",
    "contact-friction": "pressure-friction",
    "tension-friction": "force-friction",
    "maxwell-slip": "presliding-hysteresis",
    "bouc-wen": "presliding-hysteresis",
    "pressure-viscosity": "viscous-damping",
    "pressure-creep": "creep",
    "fibre-creep": "creep",
    "standard-linear-solid": "creep",
    "generalised-maxwell": "creep",
    "stribeck-friction": "coulomb-friction",
    "force-filter": "force-lag",
    "self-heating": "temperature",
    "line-drop": "pressure-gain",
    "load-misalignment": "force-gain",
    "weight": "force-offset",
}
"""Names that a catalogue may hold beyond those of `effects.py`, and the one of those that each counts under."""


def family(name):
    """The name in `effects.py` under which an effect counts."""
    return FAMILY.get(name, name)


def variants(names):
    """All names that count under one of these."""
    return sorted({*names, *(name for name, counted in FAMILY.items() if counted in names)})


def clarity(entry):
    """Detectability of a hidden effect beside the other hidden ones; of one outside the catalogue, beyond the best two rivals."""
    return entry.get("d_beyond_two", entry["d_given_others"])


@dataclass
class Answer:
    """One case with what was answered; `verdict` is None where there is no answer. `located` is the misfit by variable, largest share first."""

    truth: dict
    verdict: str | None
    missing: list
    structured: bool
    ladder: list
    located: list = field(default_factory=list)
    seconds: float | None = None

    @property
    def hidden(self):
        """Effects that are hidden."""
        return self.truth["hidden"]

    @property
    def d(self):
        """Detectability of the hidden effect that is hardest to see."""
        return min(clarity(entry) for entry in self.hidden)

    @property
    def alarmed(self):
        """Whether a structure is claimed."""
        return self.verdict in ("missing", "unknown")

    @property
    def claims(self):
        """What is claimed to be missing. Names under the verdict `unknown` are steps of the search: no claim, so neither right nor wrong."""
        return self.missing if self.verdict == "missing" else []

    @property
    def aside(self):
        """Names under the verdict `unknown`, each with all that the data cannot tell from it."""
        return _classes(self.missing) if self.verdict == "unknown" else []

    @property
    def names(self):
        """Effects claimed, in order."""
        return [family(item["effect"]) for item in self.claims]

    def classes(self):
        """Each claimed effect with all that the data cannot tell from it."""
        return _classes(self.claims)

    def first_is_right(self):
        """Whether the first name is that of a hidden effect, or of one physically identical with it on these data."""
        right = {name for entry in self.hidden for name in entry["acceptable"]}
        return bool(self.claims) and self.names[0] in right

    def first_is_hidden(self):
        """Whether the first name is of the family of a hidden effect; one that is only identical with it on these data doesn't count."""
        return bool(self.claims) and self.names[0] in {family(entry["effect"]) for entry in self.hidden}

    def found(self, entry):
        """Whether a hidden effect, or one identical with it, is in a reported class."""
        return any(one & set(entry["acceptable"]) for one in self.classes())

    def covered(self, entry):
        """Whether the hidden effect itself is in a reported class."""
        return any(entry["effect"] in one for one in self.classes())


def _classes(items):
    return [{family(name) for name in [item["effect"], *item.get("class", [])]} for item in items]


def truths(folder):
    """All truths of a suite by case."""
    return {path.parent.name: json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*/truth.json"))}


def diagnoses(known, results):
    """Answers of `bulge diagnose --json`, one file <case>.json each; seconds from times.json if it is there."""
    times_file = results / "times.json"
    times = json.loads(times_file.read_text(encoding="utf-8")) if times_file.exists() else {}
    answers = []
    for case, truth in known.items():
        file = results / f"{case}.json"
        try:
            document = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            document = {}
        remaining = document.get("remaining") or {}
        answers.append(
            Answer(
                truth,
                document.get("verdict"),
                document.get("missing") or document.get("nearest") or [],
                bool(remaining.get("structured")),
                document.get("ladder") or [],
                document.get("where") or [],
                times.get(case),
            )
        )
    return answers


def baselines(known, folder):
    """Answers of each baseline method; they know neither classes nor `unknown`."""
    file = folder / "baselines.json"
    if not file.exists():
        return {}
    named = json.loads(file.read_text(encoding="utf-8"))
    methods = next(iter(named.values()), {}).keys()
    return {
        method: [
            Answer(truth, "missing" if named[case][method] else "adequate", [{"effect": name} for name in named[case][method]], False, [])
            for case, truth in known.items()
            if case in named
        ]
        for method in methods
    }
