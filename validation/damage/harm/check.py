"""Self-test: the habits, the sets, and what counts as naming. Every check says what is wrong, or nothing."""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from . import case
from .habits import HABITS, harmed, listed, runs
from .naming import covered, named
from .orders import EACH, WITH_HIDDEN, orders
from .scores import Result

ROWS = 300


def run():
    """Runs all checks; 0 if all pass, 1 otherwise."""
    checks = [
        ("every habit, mild and severe: rows that are not named are untouched, those that are differ", _untouched),
        ("a table with noise is damaged in the same rows as one without, but where readings decide", _alike),
        ("habits by hand: slip, freeze, bridge, clip, lost packets, sweep written twice", _by_hand),
        (f"{EACH} sets of each kind or more, four rigs in each, {WITH_HIDDEN} with something hidden; no name twice", _orders),
        ("lines of damage, read from the files of built sets; whole twins hold the same readings; the same seed gives the same bytes", _built),
        ("naming: rows, column and kind, of lines, sweeps, files, jumps and refusals", _named),
        ("outcomes of made-up answers", _outcomes),
    ]
    failed = 0
    for title, check in checks:
        wrong = list(check())
        failed += bool(wrong)
        print(f"{'FAIL' if wrong else 'pass'}  {title}{': ' if wrong else ''}{'; '.join(wrong[:5])}", flush=True)
    print(f"{len(checks) - failed} passed, {failed} failed")
    return 1 if failed else 0


def _table(noise=0.0):
    rng, rows = np.random.default_rng(4), np.arange(ROWS)
    phase = 2.0 * np.pi * rows / 50.0 + 0.13
    table = {"time": 0.1 * rows, "pressure": 1e5 * (3.0 + np.sin(phase) + 1e-3 * phase), "length": 0.2 - 0.02 * np.cos(0.9 * phase), "force": 900.0 + 500.0 * np.sin(1.1 * phase)}
    table |= {"sweep": rows // 60 + 1.0, "specimen": rows // 100 + 1.0, "file": rows // 60 + 1.0, "direction": np.where(rows % 50 < 25, 1.0, -1.0)}
    table |= {"leaking": (rows > 120) & (rows < 150), "supply": table["pressure"] * 1.05}
    return {name: values * (1.0 + noise * rng.standard_normal(ROWS)) if name in ("force", "pressure", "length") else values for name, values in table.items()}


def _each():
    for kind in HABITS:
        for habit, column in listed(kind):
            for strength in (0.05, 0.95):
                table, rows = harmed(np.random.default_rng(9), _table(), kind, habit, column, strength)
                yield f"{kind}/{habit}/{column} at {strength}", kind, table, rows, (kind, habit, column, strength)


def _untouched():
    whole = _table()
    for title, kind, table, rows, order in _each():
        if not len(rows) or np.any(np.diff(rows) <= 0) or rows[-1] >= len(table["force"]):
            yield f"{title} names {rows}"
        if len(table["force"]) == ROWS and order[:2] != ("leak", "seen"):
            touched = np.flatnonzero(np.any([table[name] != whole[name] for name in whole], axis=0))
            if not set(touched) <= set(rows) or (3 * len(touched) < len(rows) and kind != "sorted"):
                yield f"{title} names {len(rows)} rows and touches {len(touched)}"


def _alike():
    for title, kind, _, rows, order in _each():
        if kind not in ("clipped", "stuck-bit", "sorted") and order[1] != "thousands":
            again = harmed(np.random.default_rng(9), _table(1e-4), *order)[1]
            if not np.array_equal(rows, again):
                yield title


def _by_hand():
    def harm(*order):
        return harmed(np.random.default_rng(2), _table(), *order)

    whole = _table()
    table, rows = harm("slip", "to-the-end", "force", 1.0)
    step = (table["force"] - whole["force"])[rows]
    if rows[-1] != ROWS - 1 or not np.allclose(np.abs(step), 40.0):
        yield "slip"
    table, rows = harm("frozen", "stutters", "pressure", 0.5)
    if any(np.ptp(table["pressure"][np.r_[piece[0] - 1, piece]]) for piece in runs(rows)):
        yield "freeze"
    table, rows = harm("gaps", "bridged", "force", 0.5)
    if any(np.ptp(np.diff(table["force"][piece[0] - 1 : piece[-1] + 2])) > 1e-9 for piece in runs(rows)):
        yield "bridge"
    table, rows = harm("clipped", "softly", "force", 1.0)
    if np.max(table["force"]) >= np.max(whole["force"]) or np.any(table["force"] > whole["force"] + 1e-9):
        yield "clip"
    table, rows = harm("gaps", "lost-without-a-trace", "time", 0.5)
    if not np.allclose(np.diff(table["time"]), 0.1) or not np.all(np.isin(table["force"], whole["force"])) or len(table["force"]) == ROWS:
        yield "lost packets"
    table, rows = harm("duplicated", "sweep-twice", "all", 0.5)
    if np.any(np.diff(table["time"]) <= 0.0) or not np.all(np.isin(table["force"][rows], whole["force"])):
        yield "sweep written twice"


def _orders():
    every = orders()
    if len({order.name for order in every}) != len(every):
        yield "a name stands twice"
    for kind in HABITS:
        some = [order for order in every if order.kind == kind and not order.hidden and not order.whole]
        if len(some) < EACH or len({order.rig for order in some}) < 4:
            yield f"{kind}: {len(some)} sets"
    if sum(order.hidden is not None and not order.whole for order in every) != WITH_HIDDEN:
        yield "hidden"


def _built():
    some = [order for order in orders() if order.column == "pressure" and not order.whole]
    chosen = [next(order for order in some if order.kind == kind) for kind in ("spikes", "unit")]
    with tempfile.TemporaryDirectory() as name:
        folders = [Path(name) / part for part in ("one", "two", "whole")]
        for order in chosen:
            truth = [case.build(order, 3, folder, folder.name == "whole") for folder in folders][0]
            one, two, whole = ({file.name: file.read_text(encoding="utf-8") for file in (folder / order.name).glob("*.[ct]*")} for folder in folders)
            if one != two:
                yield f"{order.name}: other bytes"
            for file, pieces in truth["lines"].items():
                damaged, clean = one[file].splitlines(), whole[file].splitlines()
                differing = [number for number, (a, b) in enumerate(zip(damaged, clean), 1) if a != b]
                if case.ranges(differing) != pieces:
                    yield f"{order.name}, {file}: {case.ranges(differing)} differ, not {pieces}"
            twin = replace(order, name=f"whole-{order.name}", whole=True, twin=order.name)
            case.build(twin, 3, folders[0])
            if (folders[0] / twin.name / "args").read_text() != (folders[0] / order.name / "args").read_text():
                yield "twin"


def _truth(**others):
    usual = {"kind": "spikes", "habit": "isolated", "column": "force", "lines": {"data.csv": [[12, 12], [40, 41]]}, "rows": 300, "sweeps": []}
    return {**usual, "edges_s": [], "tick_s": 0.1, "hidden": None, "whole": False, "sigmas": 20.0, **others}


def _named():
    spike = {"why": "spike: the force lies far from what the rows around lead to", "lines": "12, 40-41", "rows": 3}
    shifted = _truth(kind="shifted", habit="zero-of-a-sweep", sweeps=[3], lines={"data.csv": [[2, 90]]})
    jump = _truth(kind="slip", habit="to-the-end", column="length", lines={"data.csv": [[100, 301]]}, edges_s=[9.8])
    files = {"test-1.csv": [], "test-2.csv": [[2, 60]]}
    unit = _truth(kind="unit", habit="unit", column="pressure", lines=files)
    cases = [
        ("lines", _truth(), {"left_out": [spike]}, 2),
        ("another column", _truth(column="pressure"), {"left_out": [spike]}, 1),
        ("other lines", _truth(), {"left_out": [{**spike, "lines": "99-120"}]}, 0),
        ("ranges", _truth(), {"quality": [{"kind": "spike", "says": "the force of 2 rows", "rows": [{"file": 0, "first": 40, "last": 41}]}]}, 2),
        ("a sweep", shifted, {"left_out": [{"why": "shifted: all of sweep `3` lies 5 N off: the load cell", "lines": "2-90", "rows": 89}]}, 2),
        ("another sweep", shifted, {"warnings": ["shifted: all of sweep 4 lies off: the load cell"]}, 0),
        ("a jump", jump, {"jump": "a jump of 5 N within a sweep (at 3 bar and 10 % contraction, after 9.81 s)"}, 2),
        ("a jump elsewhere", jump, {"jump": "a jump of 5 N within a sweep (at 3 bar and 10 %, after 20 s)"}, 0),
        ("a file", unit, {"refusal": "exit status 1: test-2.csv: the pressure has another unit"}, 2),
        ("another file", unit, {"refusal": "exit status 1: test-1.csv: the pressure has another unit"}, 0),
        ("a line of a file", unit, {"left_out": [{"why": "pressure: another unit?", "lines": "test-2.csv:2-60", "rows": 59}]}, 2),
        ("lines of another file", unit, {"left_out": [{"why": "pressure: another unit?", "lines": "test-1.csv:2-60", "rows": 59}]}, 0),
        ("lines of a refusal", _truth(), {"refusal": "exit status 1: a spike of the force at line 40-41"}, 2),
        ("nothing", _truth(), {}, 0),
    ]
    for title, truth, answer, wanted in cases:
        if named(truth, answer) != wanted:
            yield f"{title}: {named(truth, answer)}, not {wanted}"
    if covered(_truth(), {"left_out": [spike]}) != 1.0:
        yield "share"


def _outcomes():
    def claim(*names):
        return {"verdict": "missing", "missing": [{"effect": name, "class": [], "confidence": 0.8} for name in names]}

    late = _truth(kind="late", habit="by-samples")
    cases = [
        (Result(late, claim("force-lag", "creep")), "instrument-is-it"),
        (Result(late, claim("force-gain")), "another-instrument"),
        (Result(late, claim("creep", "force-lag")), "physics"),
        (Result(_truth(), claim("force-lag")), "another-instrument"),
        (Result(_truth(), {"verdict": "cannot-tell", "missing": []}), "cannot-tell"),
        (Result(_truth(), None, "exit status 1: the length leaves the muscle"), "refused"),
        (Result(_truth(), None, "no answer within 9 s"), "no-answer"),
    ]
    yield from (f"{one.outcome}, not {wanted}" for one, wanted in cases if one.outcome != wanted)
    rubber = Result(_truth(hidden="rubber"), claim("bladder-elasticity"))
    if not rubber.right() or Result(_truth(hidden="pressure-zero"), claim("creep")).right():
        yield "hidden"
