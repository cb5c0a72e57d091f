"""The measures of a set of answers: rates with Wilson intervals, means with 1.96 standard errors, medians."""

import numpy as np

from .effects import CATALOGUE
from .unknown import VARIABLES
from .wilson import interval

BINS = ((2.0, 4.0), (4.0, 8.0), (8.0, 16.5), (16.5, np.inf))
CONFIDENCE_BINS = (0.0, 0.5, 0.7, 0.9, 0.97, 1.0 + 1e-9)
TWINS = ((0, 0), (1, 1), (2, 3), (4, np.inf))
ONE_HIDDEN = ("single", "rig-beyond", "confusable")
ROUNDING = 0.05


def measure(answers):
    """All measures, in the order of the report: a list of {"measure", "value", "low", "high", "n", ...}."""
    answered = [a for a in answers if a.verdict is not None]
    one = [a for a in answered if a.truth["kind"] in ONE_HIDDEN]
    rows = [rate_row("answered", [a.verdict is not None for a in answers])]
    rows += _quiet(answered)
    for low, high in BINS:
        some = _within(one, low, high)
        span = f"d {low:g} to {high:g}" if np.isfinite(high) else f"d above {low:g}"
        rows.append(rate_row(f"detected, {span}", [a.alarmed for a in some]))
        rows.append(rate_row(f"top-1, {span}", [a.first_is_right() for a in some]))
        rows.append(rate_row(f"class right, {span}", [a.found(a.hidden[0]) for a in some]))
    rows += _classes(one)
    rows += _several(answered)
    rows += _outside(answered, one)
    rows += _held_out(one)
    rows.append(rate_row("intervals that hold the true parameter", _intervals(one)))
    rows += _calibration(answered)
    times = [a.seconds for a in answered if a.seconds is not None]
    if times:
        rows.append(median_row("seconds per case, median", times))
        rows.append({"measure": "seconds per case, largest", "value": max(times), "n": len(times)})
    return rows


def _within(answers, low, high):
    return [a for a in answers if low * (1.0 - ROUNDING) <= a.d < high * (1.0 - ROUNDING)]


def _quiet(answered):
    rows = []
    for kind, title in (("null", "false alarms, nothing hidden"), ("rig-within", "false alarms, rig errors within the data sheets")):
        some = [a for a in answered if a.truth["kind"] == kind]
        rows.append(rate_row(title, [a.alarmed for a in some]))
        rows.append(rate_row(title.replace("alarms", "names"), [bool(a.claims) for a in some]))
        rows.append(rate_row(title.replace("false alarms", "called adequate"), [a.verdict == "adequate" for a in some]))
    return rows


def _classes(one):
    clear = [a for a in one if a.d >= 8.0 * (1.0 - ROUNDING)]
    seen = [a for a in one if a.d >= 4.0 * (1.0 - ROUNDING)]
    alone = [a for a in clear if len(a.hidden[0]["class"]) == 1]
    sizes = [len(a.classes()[0]) for a in clear if a.claims]
    true_sizes = [len(a.hidden[0]["class"]) for a in clear if a.claims]
    twins = {span: [size for size, true in zip(sizes, true_sizes) if span[0] <= true - 1 <= span[1]] for span in TWINS}
    return [
        rate_row("class right, d >= 4", [a.found(a.hidden[0]) for a in seen]),
        rate_row("top-1, d >= 8, no twin in the data", [a.first_is_right() for a in alone]),
        rate_row("hidden effect in the class reported, d >= 4", [a.covered(a.hidden[0]) for a in seen if a.claims]),
        mean_row("mean class size, d >= 8", sizes),
        mean_row("mean class size by the truth (3.29 sigma), same cases", true_sizes),
        *(mean_row(f"mean class size, d >= 8, {_counted(*span)}", some) for span, some in twins.items()),
        rate_row("more names than effects, d >= 4", [len(a.claims) > 1 for a in seen]),
        rate_row("class right and nothing else named, d >= 4", [a.found(a.hidden[0]) and len(a.claims) == 1 for a in seen]),
    ]


def _counted(low, high):
    if high == np.inf:
        return f"{low} or more true twins"
    return ("no true twin", "1 true twin")[low] if low == high else f"{low} to {high} true twins"


def _several(answered):
    rows = []
    for kind in ("pair", "masking"):
        some = [a for a in answered if a.truth["kind"] == kind]
        found = [sum(a.found(entry) for entry in a.hidden) for a in some]
        rows.append(rate_row(f"{kind}s: both in the classes", [count == 2 for count in found]))
        rows.append(rate_row(f"{kind}s: one of two", [count == 1 for count in found]))
        clear = [count == 2 for count, a in zip(found, some) if a.d >= 4.0]
        rows.append(rate_row(f"{kind}s: both, each with d >= 4 beside the other", clear))
    return rows


def _outside(answered, one):
    out = [a for a in answered if a.truth["kind"] == "unknown"]
    clear = [a for a in out if a.d >= 8.0 * (1.0 - ROUNDING)]
    called = [a for a in answered if a.verdict == "unknown"]
    placed = [a.located[0]["variable"] in VARIABLES[a.hidden[0]["effect"]] for a in out if a.verdict == "unknown" and a.located]
    known = [a for a in one if a.verdict == "unknown"]
    return [
        rate_row("outside the catalogue: called unknown", [a.verdict == "unknown" for a in out]),
        rate_row("outside the catalogue, 8 sigma beyond any two effects: called unknown", [a.verdict == "unknown" for a in clear]),
        rate_row("outside the catalogue: adequate under a wrong name", [a.verdict == "missing" and not a.structured for a in out]),
        rate_row("outside the catalogue: a wrong name, with structure said to remain", [a.verdict == "missing" and a.structured for a in out]),
        rate_row("outside the catalogue: not noticed", [a.verdict in ("adequate", "cannot-tell") for a in out]),
        rate_row("outside the catalogue, called unknown: misfit placed on a variable of the hidden formula", placed),
        rate_row("in the catalogue, called unknown", [a.verdict == "unknown" for a in one]),
        rate_row("called unknown: names beside it, no claims", [bool(a.aside) for a in called]),
        mean_row("called unknown: how many names beside it", [len(a.aside) for a in called]),
        rate_row("in the catalogue, called unknown: hidden effect among the names beside it", [_aside(a) for a in known]),
    ]


def _aside(answer):
    right = set(answer.hidden[0]["acceptable"])
    return any(one & right for one in answer.aside)


def _held_out(one):
    """Held-out error after the last step against the noise of the data, which no structure can beat."""
    ratios, first = [], []
    for a in one:
        errors = [step.get("held_out_rmse_n") for step in a.ladder if not step.get("bent")]
        if a.claims and errors and errors[-1] and a.found(a.hidden[0]):
            ratios.append(errors[-1] / a.truth["noise"]["rms_n"])
            first.append((errors[0] or np.nan) / a.truth["noise"]["rms_n"])
    if not ratios:
        return []
    return [
        median_row("held-out error / noise, before", first),
        median_row("held-out error / noise, after the right class", ratios),
        rate_row("held-out error within 1.1 of the noise", [ratio <= 1.1 for ratio in ratios]),
    ]


def _intervals(one):
    """Whether intervals hold the truth, where the parameter means the same here and there; errors of either sign count by size."""
    results = []
    for a in one:
        entry = a.hidden[0]
        if "reported" not in entry:
            continue
        for item in a.claims:
            parameter = (item.get("parameters") or {}).get(entry["reported"]["parameter"])
            if item["effect"] != entry["effect"] or not parameter or parameter.get("unit") != entry["reported"]["unit"]:
                continue
            value, low, high = entry["reported"]["value"], parameter["low"], parameter["high"]
            signs = (1.0,) if CATALOGUE[entry["effect"]].sign else (1.0, -1.0)
            results.append(any(low <= sign * value <= high for sign in signs))
    return results


def _calibration(answered):
    """Share of first names of the hidden family against the confidence stated with them, which counts an effect of another family as wrong even if it is
    identical on these data."""
    pairs = [(item[0]["confidence"], a.first_is_hidden()) for a in answered if (item := a.claims) and item[0].get("confidence") is not None]
    rows, gap = calibrated(pairs, "right when the confidence")
    return [*rows, {"measure": "calibration: mean distance of confidence and rate", "value": gap, "n": len(pairs)}] if pairs else []


def calibrated(pairs, title):
    """Rates of right claims by bins of the confidence, of pairs of both, and the mean distance of the two."""
    rows, gap = [], 0.0
    for low, high in zip(CONFIDENCE_BINS[:-1], CONFIDENCE_BINS[1:]):
        inside = [(c, right) for c, right in pairs if low <= c < high]
        if inside:
            stated = float(np.mean([c for c, _ in inside]))
            row = rate_row(f"{title} is {low:g} to {min(high, 1.0):g} (mean {stated:.3f})", [right for _, right in inside])
            gap += len(inside) / len(pairs) * abs(row["value"] - stated)
            rows.append(row)
    return rows, gap


def rate_row(title, outcomes):
    """A rate with Wilson's interval."""
    count, good = len(outcomes), int(sum(outcomes))
    low, high = interval(good, count)
    return {"measure": title, "value": good / count if count else None, "low": low, "high": high, "n": count, "rate": True}


def mean_row(title, values):
    """A mean with 1.96 standard errors."""
    if not values:
        return {"measure": title, "value": None, "n": 0}
    half = 1.96 * float(np.std(values)) / len(values) ** 0.5
    mean = float(np.mean(values))
    return {"measure": title, "value": mean, "low": mean - half, "high": mean + half, "n": len(values)}


def median_row(title, values):
    """A median."""
    return {"measure": title, "value": float(np.nanmedian(values)), "n": len(values)}
