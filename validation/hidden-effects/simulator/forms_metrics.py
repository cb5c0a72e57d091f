"""The measures of the forms suite: families and mechanisms named, alone or with others, by strength, kind, fold, rig and noise law."""

import json
from collections import Counter
from dataclasses import dataclass, field
from itertools import permutations

import numpy as np
from scipy.special import ndtr

from .forms_effects import FAMILY, MECHANISM, family, mechanism
from .forms_suite import STRENGTHS
from .metrics import calibrated, mean_row, rate_row

LEVELS = ("mechanism", "family", "form")
KNOWN = ("one", "two", "three")
SAME = {"end-factor": "displacement-gain"}
"""Names of different families that are one formula on any data: k eps in the place of eps."""


@dataclass
class Answer:
    """One case and what was answered; `verdict` is None where there is no answer."""

    truth: dict
    verdict: str | None
    missing: list = field(default_factory=list)
    structured: bool = False
    seconds: float | None = None

    @property
    def kind(self):
        """Kind of the case."""
        return self.truth["kind"]

    @property
    def known(self):
        """Hidden effects that the catalogue has."""
        return [entry for entry in self.truth["hidden"] if entry["family"]]

    @property
    def claims(self):
        """What is claimed to be missing. Names under `unknown` are no claims."""
        return self.missing if self.verdict == "missing" else []

    @property
    def quiet(self):
        """Whether nothing is claimed."""
        return self.verdict not in ("missing", "unknown")

    def right(self, claim, level="family"):
        """Whether a claim names a hidden effect, or one that is identical with it on these data, at a level."""
        return any(matches(claim, entry, level) for entry in self.known)

    def names_hidden(self, claim, level):
        """Whether a claim names a hidden effect itself at a level."""
        return any(matches(claim, {**entry, "acceptable": []}, level) for entry in self.known)

    def all_right(self, level="family"):
        """Whether there is one claim for each hidden effect, and nothing else."""
        known, claims = self.known, self.claims
        if self.verdict != "missing" or len(claims) != len(known):
            return False
        return any(all(matches(claim, entry, level) for claim, entry in zip(claims, order)) for order in permutations(known))

    def as_claimed(self, claim):
        """Whether a claim is right at the level that it states: one of a class, a mechanism, or a family."""
        level = claim.get("level")
        if level == "class":
            return self.in_class(claim)
        return self.right(claim, "mechanism" if level == "mechanism" else "family")

    def in_class(self, claim):
        """Whether the class of a claim holds a hidden family, or one that is identical with it on these data."""
        names = [claim["effect"], *claim.get("class", [])]
        return any(matches({"effect": name}, entry, "family") for name in names for entry in self.known)

    def found(self, entry, level="family"):
        """Whether some claim names this hidden effect."""
        return any(matches(claim, entry, level) for claim in self.claims)


def head(claim):
    """Head of the family of a claim; the program's own word counts for names that are not known here."""
    name = claim["effect"]
    return family(name) if name in FAMILY or name in MECHANISM else family(claim.get("family") or name)


def matches(claim, entry, level):
    """Whether a claim names a hidden effect at a level: mechanism, or family."""
    level_of = mechanism if level == "mechanism" else lambda name: name
    named = {level_of(head(claim)), level_of(family(SAME.get(claim["effect"], claim["effect"])))}
    return bool(named & {entry[level], *(level_of(family(name)) for name in entry["acceptable"])})


def confidence(claim, level):
    """The confidence that a claim states at a level; one number is that of the family."""
    stated = claim.get("confidence")
    value = claim.get(f"confidence_{level}", stated.get(level) if isinstance(stated, dict) else stated if level == "family" else None)
    return float(value) if isinstance(value, (int, float)) else None


def at_best(entry):
    """How often the better of two formulas that are s sigma apart is the true one: Phi(s/2), s to the nearest rival; 1 if that one counts as right."""
    nearest = entry["nearest"]
    return 1.0 if nearest["effect"] in entry["acceptable"] else float(ndtr(0.5 * nearest["separation"]))


def answers(known, results):
    """Answers of `bulge diagnose --json` to the cases, one file <case>.json each."""
    times_file = results / "times.json"
    times = json.loads(times_file.read_text(encoding="utf-8")) if times_file.exists() else {}
    found = []
    for case, truth in known.items():
        try:
            document = json.loads((results / f"{case}.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            document = {}
        structured = bool((document.get("remaining") or {}).get("structured"))
        found.append(Answer(truth, document.get("verdict"), document.get("missing") or [], structured, times.get(case)))
    return found


def measure(everything):
    """All measures, in the order of the report."""
    rows = [rate_row("runs with an answer", [a.verdict is not None for a in everything])]
    # A run without an answer names nothing: it counts as not right.
    one = [a for a in everything if a.kind == "one"]
    rows += _one(one)
    rows += _several(everything)
    rows += _quiet_and_unknown(everything)
    rows += _names(everything)
    rows += _parts(everything)
    for level in LEVELS[:2]:
        rows += _calibration(everything, level)
    times = [a.seconds for a in everything if a.seconds is not None]
    if times:
        rows.append(mean_row("seconds per case, mean", times))
        rows.append({"measure": "seconds per case, 95th percentile", "value": float(np.quantile(times, 0.95)), "n": len(times)})
        slowest = max((a for a in everything if a.seconds is not None), key=lambda a: a.seconds)
        rows.append({"measure": f"seconds per case, largest ({slowest.truth['case']})", "value": slowest.seconds, "n": len(times)})
    return rows


def _one(one):
    rows = []
    for level in ("family", "mechanism"):
        for strength in STRENGTHS:
            some = [a for a in one if a.known[0]["strength"] == strength]
            if level == "family" and some:
                rows.append(mean_row(f"one effect, d {strength:g}: right at best beside the nearest rival", [at_best(a.known[0]) for a in some]))
            rows.append(rate_row(f"one effect, d {strength:g}: {level} right and nothing else named", [a.all_right(level) for a in some]))
        rows.append(rate_row(f"one effect, all: {level} right and nothing else named", [a.all_right(level) for a in one]))
    loose = [a for a in one if a.known[0]["form"] != "exact"]
    plain = [a for a in loose if not a.known[0].get("nearer")]
    exact = [a for a in one if a.known[0]["form"] == "exact"]
    for title, some in (
        ("in another form", loose),
        ("in another form, its own formula nearest", plain),
        ("by the catalogue's formula", exact),
    ):
        rows.append(rate_row(f"one effect, {title}: family right and nothing else named", [a.all_right() for a in some]))
    decided = [a for a in one if len(a.known[0]["class"]) == 1]
    rows.append(rate_row("one effect, no rival within 3.29 sigma: family right and nothing else named", [a.all_right() for a in decided]))
    rows.append(rate_row("one effect: one claim, the hidden family in its class", [len(a.claims) == 1 and a.in_class(a.claims[0]) for a in one]))
    rows.append(rate_row("one effect: found, whatever else is named", [a.found(a.known[0]) for a in one]))
    rows.append(rate_row("one effect: more than one name", [len(a.claims) > 1 for a in one]))
    rows.append(rate_row("one effect: called unknown", [a.verdict == "unknown" for a in one]))
    rows.append(rate_row("one effect: nothing claimed", [a.quiet for a in one]))
    return rows


def _several(everything):
    rows = []
    for kind, word in (("two", "both"), ("three", "all three")):
        some = [a for a in everything if a.kind == kind]
        for level in ("family", "mechanism"):
            rows.append(rate_row(f"{kind} effects: {word} at the level of the {level}, nothing else named", [a.all_right(level) for a in some]))
        rows.append(rate_row(f"{kind} effects: {word} found, whatever else", [all(a.found(e) for e in a.known) for a in some]))
        rows.append(rate_row(f"{kind} effects: a wrong name", [any(not a.right(c) for c in a.claims) for a in some]))
        rows.append(rate_row(f"{kind} effects: called unknown", [a.verdict == "unknown" for a in some]))
    return rows


def _quiet_and_unknown(everything):
    none = [a for a in everything if a.kind == "none"]
    alone = [a for a in everything if a.kind == "unknown"]
    beside = [a for a in everything if a.kind == "beside"]
    left = [a.structured and a.all_right() for a in beside]
    return [
        rate_row("nothing hidden: quiet", [a.quiet for a in none]),
        rate_row("nothing hidden: a name claimed", [bool(a.claims) for a in none]),
        rate_row("outside the catalogue: called unknown", [a.verdict == "unknown" for a in alone]),
        rate_row("outside the catalogue: a name, structure said to remain", [a.verdict == "missing" and a.structured for a in alone]),
        rate_row("outside the catalogue: a name, said to explain the data", [a.verdict == "missing" and not a.structured for a in alone]),
        rate_row("outside the catalogue: not noticed", [a.quiet for a in alone]),
        rate_row("beside a known effect: called unknown", [a.verdict == "unknown" for a in beside]),
        rate_row("beside a known effect: the known family alone, structure said to remain", left),
        rate_row("beside a known effect: called unknown, or the known family alone with structure that remains", [a.verdict == "unknown" or good for a, good in zip(beside, left)]),
    ]


def _names(everything):
    claims = [(a, claim) for a in everything for claim in a.claims]
    return [
        rate_row("wrong names, of all names (by family)", [not a.right(claim) for a, claim in claims]),
        rate_row("wrong names, of all names (by mechanism)", [not a.right(claim, "mechanism") for a, claim in claims]),
        rate_row("claims that are wrong at the level that they state", [not a.as_claimed(claim) for a, claim in claims]),
        rate_row("a wrong name, and the data said to be explained", [
            a.verdict == "missing" and not a.structured and any(not a.right(claim) for claim in a.claims) for a in everything
        ]),
    ]


def _parts(everything):
    """By fold, rig, noise law, kind of muscle, and size: family right and nothing else named, over one, two and three effects."""
    known = [a for a in everything if a.kind in KNOWN]
    rows = []
    for fold in range(3):
        some = [a for a in everything if a.kind == "one" and a.known[0]["fold"] == fold]
        rows.append(rate_row(f"fold {fold}: one effect, family right and nothing else named", [a.all_right() for a in some]))
    for key, title in (("rig", "test"), ("family", "muscle"), ("size", "data")):
        for value in sorted({a.truth[key] for a in known}):
            some = [a for a in known if a.truth[key] == value]
            rows.append(rate_row(f"{title} {value}: all families right, nothing else named", [a.all_right() for a in some]))
    for law in sorted({a.truth["noise"]["name"] for a in known}):
        some = [a for a in known if a.truth["noise"]["name"] == law]
        rows.append(rate_row(f"noise {law}: all families right, nothing else named", [a.all_right() for a in some]))
    for stated in (True, False):
        some = [a for a in known if a.truth["widths_stated"] is stated]
        word = "stated" if stated else "not stated"
        rows.append(rate_row(f"widths of the geometry {word}: all families right, nothing else named", [a.all_right() for a in some]))
    return rows


def _calibration(everything, level):
    """Share of claims that name what was hidden against the confidence stated with them, which counts another family or mechanism as wrong even if it is
    identical on these data."""
    pairs = [(c, a.names_hidden(claim, level)) for a in everything for claim in a.claims if (c := confidence(claim, level)) is not None]
    rows, gap = calibrated(pairs, f"{level} right when its confidence")
    if pairs:
        overall = abs(np.mean([c for c, _ in pairs]) - np.mean([right for _, right in pairs]))
        rows.append({"measure": f"calibration of the {level}: mean distance of confidence and rate", "value": gap, "n": len(pairs)})
        rows.append({"measure": f"calibration of the {level}: mean confidence less mean rate, size", "value": float(overall), "n": len(pairs)})
    return rows


def wrong(everything):
    """What was hidden and what was named instead or beside it, the most frequent first: lines for whoever mends the program."""
    pairs, cases = Counter(), {}
    for a in everything:
        if a.kind in KNOWN and a.all_right() or a.kind == "none" and a.quiet or a.kind == "unknown" and a.verdict == "unknown":
            continue
        if a.kind == "beside" and (a.verdict == "unknown" or a.structured and a.all_right()):
            continue
        hidden = " + ".join(f"{e['effect']} ({e['form']})" for e in a.truth["hidden"]) or "nothing"
        if a.kind in ("two", "three", "beside"):
            hidden = " + ".join(sorted(e["effect"] for e in a.truth["hidden"]))
        named = " + ".join(c["effect"] for c in a.claims) or {None: "no answer"}.get(a.verdict, a.verdict)
        pairs[f"{a.kind}: {hidden} -> {named}"] += 1
        cases.setdefault(f"{a.kind}: {hidden} -> {named}", []).append(a.truth["case"])
    return [f"{count:3d}  {pair}   [{', '.join(cases[pair][:4])}{', ...' if count > 4 else ''}]" for pair, count in pairs.most_common()]


def wrong_names(everything):
    """Wrong names with the families that were hidden, the most frequent first."""
    pairs = Counter()
    for a in everything:
        hidden = " + ".join(sorted(e["family"] or e["effect"] for e in a.truth["hidden"])) if a.kind in ("one", "unknown") else a.kind
        for claim in a.claims:
            if not a.right(claim):
                pairs[f"{head(claim)} where {hidden or 'nothing'} is hidden"] += 1
    return [f"{count:3d}  {pair}" for pair, count in pairs.most_common()]
