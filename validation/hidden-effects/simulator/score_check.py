"""Checks of the score: Wilson's interval against printed numbers, and what counts as a claim. Each returns an error."""

from .answers import Answer
from .metrics import measure
from .wilson import interval


def printed_interval():
    """81 of 263: (0.2553, 0.3662), R. G. Newcombe, Statistics in Medicine 17 (1998), table I."""
    low, high = interval(81, 263)
    return max(abs(low - 0.2553), abs(high - 0.3662))


def claims():
    """Three answers to a hidden friction: named, its twin named first, and a name under `unknown`, which is neither right nor wrong."""
    found = _rates("single", [_answer("missing", "coulomb-friction"), _answer("missing", "creep", "coulomb-friction"), _answer("unknown", "creep")])
    wanted = {"top-1, d 8 to 16.5": 1 / 3, "class right, d 8 to 16.5": 2 / 3, "detected, d 8 to 16.5": 1.0, "called unknown: how many names beside it": 1.0}
    return max(abs(found[title] - value) for title, value in wanted.items())


def quiet():
    """Nothing hidden: a name under `unknown` is a false alarm, but no false name."""
    found = _rates("null", [_answer("adequate"), _answer("unknown", "creep")])
    return max(abs(found["false alarms, nothing hidden"] - 0.5), found["false names, nothing hidden"])


def _rates(kind, answers):
    entry = {"effect": "coulomb-friction", "d_given_others": 12.0, "acceptable": ["coulomb-friction"], "class": ["coulomb-friction", "creep"]}
    for answer in answers:
        answer.truth = {"kind": kind, "hidden": [] if kind == "null" else [entry]}
    return {row["measure"]: row["value"] for row in measure(answers)}


def _answer(verdict, *names):
    missing = [{"effect": names[0], "class": list(names)}] if names else []
    return Answer({}, verdict, missing, False, [])
