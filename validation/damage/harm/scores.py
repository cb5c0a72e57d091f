"""Sets with their answers, and the tables of the README."""

import re
from dataclasses import dataclass

from bench.scores import kind as kind_of_effect
from bench.scores import markdown, rate

from .naming import covered, named

INSTRUMENT = re.compile(r"^(force-(lag|filter|nonlinearity|gain|drift|offset)|displacement-gain|length-zero-error|pressure-(offset|gain|lag|hysteresis))$")
"""Effects of the catalogue that are errors of a sensor, not of muscle or rig."""
IS_IT = {
    ("late", None, None): {"force-lag", "force-filter", "pressure-lag", "regulator-lag"},
    ("clipped", "softly", "force"): {"force-nonlinearity"},
    ("shifted", None, "force"): {"force-offset"},
    ("shifted", None, "pressure"): {"pressure-offset"},
    ("shifted", None, "length"): {"length-zero-error"},
    ("slip", None, "force"): {"force-offset", "force-drift"},
    ("slip", None, "pressure"): {"pressure-offset"},
    ("slip", None, "length"): {"length-zero-error"},
    ("unit", "absolute", "pressure"): {"pressure-offset"},
    ("unit", "unit", "pressure"): {"pressure-gain"},
    ("unit", "unit", "force"): {"force-gain"},
    ("unit", "unit", "length"): {"displacement-gain"},
    ("leak", "unseen", "pressure"): {"pressure-gain", "pressure-offset", "line-drop"},
}
"""Damage, habit and column (None: any) -> effects that say the same of the instrument, though of all rows."""
RUBBER = re.compile(r"bladder|hoop-elasticity|membrane-axial|wall-thickness|limited-unfolding")
HIDDEN = {"rubber": None, "pressure-zero": "zero", "strand-friction": "friction", "rig-friction": "friction"}
"""Hidden effect -> kind of effect that is right; rubber goes by `RUBBER`."""
OUTCOMES = ("adequate", "cannot-tell", "refused", "unknown", "instrument-is-it", "another-instrument", "physics", "no-answer")
WORDS = ("adequate", "cannot tell", "refused", "unknown", "the instrument's error that it is", "another instrument's", "physics", "no answer")
SIZES = ((0.0, 5.0, "below 5"), (5.0, 30.0, "5 to 30"), (30.0, 100.0, "30 to 100"), (100.0, 300.0, "100 to 300"), (300.0, 1e99, "above 300"))
"""Of the damage, in sigma."""


@dataclass
class Result:
    """One set: its truth, what was kept of the answer (None: none), what was said instead."""

    truth: dict
    answer: dict | None
    problem: str | None = None
    seconds: float | None = None

    @property
    def first(self):
        """The first name, or None."""
        names = self.answer and self.answer["verdict"] == "missing" and self.answer["missing"]
        return names[0]["effect"] if names else None

    @property
    def outcome(self):
        """One of `OUTCOMES`, for a set that hides nothing. An exit status of 1 is a refusal: the input is said to be wrong."""
        if self.answer is None:
            return "refused" if (self.problem or "").startswith("exit status 1:") else "no-answer"
        if self.answer["verdict"] != "missing":
            return self.answer["verdict"]
        if self.first in self.is_it:
            return "instrument-is-it"
        return "another-instrument" if INSTRUMENT.match(self.first or "") else "physics"

    @property
    def is_it(self):
        """Effects that are this damage."""
        key = [self.truth[name] for name in ("kind", "habit", "column")]
        return set().union(*(names for words, names in IS_IT.items() if all(word in (None, there) for word, there in zip(words, key))))

    @property
    def misnamed(self):
        """Whether something is named that the damage is not."""
        return self.outcome in ("another-instrument", "physics")

    @property
    def naming(self):
        """2: the damage is named, 1: pointed at, 0: not."""
        if self.outcome == "instrument-is-it":
            return 2
        return named(self.truth, self.answer or {"refusal": self.problem or ""})

    @property
    def covers(self):
        """Share of damaged rows that are named."""
        return covered(self.truth, self.answer or {})

    def right(self, depth=1):
        """Whether the hidden effect is named first, or in its class (`depth` larger)."""
        if self.first is None:
            return False
        names = [self.first, *self.answer["missing"][0].get("class", [])][:depth]
        wanted = HIDDEN[self.truth["hidden"]]
        return any(RUBBER.search(name) if wanted is None else kind_of_effect(name) == wanted for name in names)


def tables(results, told):
    """The Markdown tables; `told` is the line that says what was run."""
    nulls = [one for one in results if not one.truth["hidden"]]
    damaged, whole = [one for one in nulls if not one.truth["whole"]], [one for one in nulls if one.truth["whole"]]
    hidden = [one for one in results if one.truth["hidden"]]
    return "\n\n".join([told, _verdicts(damaged, whole), _naming(damaged), _hidden(hidden), _habits(damaged)])


def _groups(damaged, whole=()):
    kinds = sorted({one.truth["kind"] for one in damaged})
    yield from ((kind, [one for one in damaged if one.truth["kind"] == kind]) for kind in kinds)
    yield from ((f"{words} sigma", [one for one in damaged if low <= one.truth["sigmas"] < high]) for low, high, words in SIZES)
    for key in ("rig", "muscle"):
        yield from ((value, [one for one in damaged if one.truth[key] == value]) for value in sorted({one.truth[key] for one in damaged}))
    yield "**all damaged**", damaged
    if whole:
        yield "the same sets, whole", whole


def _verdicts(damaged, whole):
    rows = []
    for title, group in _groups(damaged, whole):
        if group:
            counts = [sum(one.outcome == outcome for one in group) or "" for outcome in OUTCOMES]
            wrong = rate(sum(one.misnamed for one in group), len(group))
            rows.append((title, len(group), *counts, wrong))
    return markdown(("damage", "sets", *WORDS, "wrongly named [Wilson's 95 % interval]"), rows)


def _naming(damaged):
    """What there is to name: not a leak that the sensor shows."""
    damaged = [one for one in damaged if one.truth["habit"] != "seen" and any(one.truth["lines"].values())]
    rows = []
    for title, group in _groups(damaged):
        large = [one for one in group if one.truth["sigmas"] >= 5.0]
        shares = sorted(one.covers for one in group) or [0.0]
        middle = f"{100.0 * shares[len(shares) // 2]:.0f} %"
        rows.append(
            (
                title,
                rate(sum(one.naming == 2 for one in group), len(group)),
                sum(one.naming == 1 for one in group) or "",
                rate(sum(one.naming == 2 for one in large), len(large)),
                middle,
                sum(one.outcome in ("adequate", "cannot-tell", "refused", "instrument-is-it") and one.naming == 2 for one in group),
            )
        )
    header = ("damage", "named: rows, column, kind", "rows only", "named, of those of 5 sigma and more", "damaged rows named (median)", "named, and nothing else claimed")
    return markdown(header, [row for row in rows if row[1] != "-"])


def _hidden(hidden):
    rows = []
    for family in [*sorted({one.truth["hidden"] for one in hidden}), None]:
        for whole in (True, False):
            group = [one for one in hidden if family in (None, one.truth["hidden"]) and one.truth["whole"] == whole]
            if not group:
                continue
            claims = sum(one.first is not None for one in group)
            right, within = sum(one.right() for one in group), sum(one.right(99) for one in group)
            verdicts = [sum((one.answer or {}).get("verdict") == word for one in group) for word in ("unknown", "cannot-tell", "adequate")]
            shown = [rate(right, len(group)), within, claims - right, *verdicts, sum(one.answer is None for one in group)]
            rows.append((f"{family or '**all**'}, {'whole' if whole else 'damaged'}", len(group), *shown, "" if whole else sum(one.naming == 2 for one in group)))
    header = ("hidden", "sets", "right kind first", "in the class", "wrong name first", "unknown", "cannot tell", "adequate", "no answer", "damage named")
    return markdown(header, rows)


def _habits(damaged):
    rows = []
    for key in sorted({tuple(one.truth[name] for name in ("kind", "habit", "column")) for one in damaged}):
        group = [one for one in damaged if tuple(one.truth[name] for name in ("kind", "habit", "column")) == key]
        sizes = sorted(one.truth["sigmas"] for one in group)
        counts = [sum(test(one) for one in group) or "" for test in (lambda one: one.misnamed, lambda one: one.outcome == "unknown", lambda one: one.naming == 2)]
        rows.append((*key, len(group), f"{sizes[0]:.0f} to {sizes[-1]:.0f}", *counts))
    return markdown(("damage", "habit", "column", "sets", "sigma", "wrongly named", "unknown", "damage named"), rows)


def wrong(results):
    """One line for every set that is wrongly named, unknown, or without an answer."""
    lines = []
    for one in results:
        bad = one.misnamed or one.outcome in ("unknown", "no-answer")
        if one.truth["hidden"]:
            bad = one.first is not None and not one.right()
        if bad:
            claims = [f"{c['effect']} ({c.get('confidence', 0.0):.2f}; {', '.join(c.get('class', []))})" for c in (one.answer or {}).get("missing", [])]
            t = one.truth
            what = f"{t['kind']}/{t['habit']}, {t['column']}, {t['sigmas']:g} sigma, lines {_short(t['lines'])}" if not t["whole"] else "whole"
            said = "; ".join(claims) or one.outcome
            extra = " ".join(filter(None, [(one.answer or {}).get("jump"), *(one.answer or {}).get("hints", [])[:1]])) or one.problem or ""
            lines.append(f"{t['case']}: {what}; verdict {(one.answer or {}).get('verdict')}; {said}; damage {('not named', 'pointed at', 'named')[one.naming]}; {extra}")
    return lines


def _short(lines):
    runs = [(file, run) for file, found in lines.items() for run in found]
    some = ", ".join(f"{file + ':' if len(lines) > 1 else ''}{a}-{b}" for file, (a, b) in runs[:4])
    return some + (f" and {len(runs) - 4} more" if len(runs) > 4 else "")
