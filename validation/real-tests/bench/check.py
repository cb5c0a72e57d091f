"""Self-test of the tests' generator: equilibria, laws of hysteresis, rigs, instruments, damage, dialects. Every check prints its error and its tolerance."""

import json
import tempfile
from pathlib import Path

import numpy as np
from scipy.stats import t as student
from simulator import hysteresis, meridian
from simulator.hysteresis import Strands
from simulator.muscle import Muscle

from . import case, damage, dialects, instruments, rigs, scores
from .hoses import CONTRACTION, HIGHEST, Hose, hoses
from .suite import Order
from .world import Nature, World

HOSE = Hose(Muscle("reference", "braided", 0.25, 10.7e-3, 100, np.radians(25.0), wall=2e-3, bladder=(3e5, 0.0), fibre_stiffness=5e3))
"""250 mm, 25 degrees, rubber of 0.3 MPa, fibres that stretch by 0.2 %/kN: the hose for which loop sizes are known from another model and from benches."""


def run():
    """Runs all checks; 0 if all pass, 1 otherwise."""
    checks = [
        ("splines between the nodes against equilibria, ten muscles", _splines, 1e-4),
        ("F = -p dV/dl of the maps, nets without rubber or stretch", _virtual_work, 1e-4),
        ("fibre angles: sin(theta) = kappa r, equator of a long net tends to cos(theta) = (1 - eps) cos(alpha0)", _angles, 2e-3),
        ("strands, isobaric loop at 3.7 bar, 10 %, 75 um: 14 N within a quarter", _isobaric_loop, 0.25),
        ("strands, isometric loop: negative, between -1 and -11 N as contacts slip late or early", _isometric_loop, 0.0),
        ("strands: an isobaric cycle loses work, whatever the yield angles", _loses_work, 0.0),
        ("rubber: isometric loop negative, 3 to 20 % of the rubber's force, grows with the contraction", _rubber_loop, 0.0),
        ("stops: loop of a pressure reading flat in pressure, its sign that of the stops", _stop_loop, 0.0),
        ("creep: loop positive when filled first, less in the second cycle", _creep_loop, 0.0),
        ("stretched exponential by positive weights, over four decades", _stretched, 2e-3),
        ("relaxation of a ramp, exactly", _relaxing, 1e-12),
        ("two lags delay a ramp by their times", _late, 1e-9),
        ("regulator: overshoot of a step exp(-pi d/sqrt(1 - d^2))", _overshoot, 1e-3),
        ("isotonic: load carried with strands and rig that rub [N]", _carried, 1e-6),
        ("isotonic, a regulator that undershoots: the muscle pulls as at rest, or less than the load on its stop [N]", _rests, 1e-6),
        ("noise: size of samples, three laws", _noise, 0.05),
        ("damage: rows that are not named are untouched", _untouched, 0.0),
        ("24 dialects read back by pandas, openpyxl and SciPy", _dialects, 2e-7),
        ("score: kinds of the catalogue's names, and outcomes of made-up answers", _scored, 0.0),
        ("sizes of what is hidden, and noise, as ordered; the same seed gives the same bytes", _built, 0.0),
    ]
    failed = 0
    for title, check, tolerance in checks:
        error = check()
        passed = error <= tolerance
        failed += not passed
        print(f"{'pass' if passed else 'FAIL'}  {title}: {error:.2g} (tolerance {tolerance:g})", flush=True)
    print(f"{len(checks) - failed} passed, {failed} failed")
    return 1 if failed else 0


def _splines():
    rng, worst = np.random.default_rng(3), 0.0
    for hose in hoses(1):
        kind = hose.muscle.kind
        pressure = np.exp(rng.uniform(*np.log((hose.lowest, HIGHEST[kind])), 24))
        contraction = rng.uniform(CONTRACTION[kind][0] + 0.005, CONTRACTION[kind][1] - 0.005, 24)
        exact = meridian.solve(hose.shape.body(), pressure, hose.muscle.length * (1.0 - contraction)).force
        worst = max(worst, float(np.abs((hose.map(pressure, contraction) - exact) / np.abs(exact).max()).max()))
    return worst


def _virtual_work():
    worst, step = 0.0, 1e-4
    for hose in hoses(1):
        if hose.muscle.bladder or hose.muscle.fibre_stiffness:
            continue
        contraction = np.linspace(0.05, 0.18, 9)
        pressure = np.full(9, 2e5)
        volumes = [hose.map.volume(pressure, contraction + k * step) for k in (-2.0, -1.0, 1.0, 2.0)]
        slope = (volumes[0] - 8.0 * volumes[1] + 8.0 * volumes[2] - volumes[3]) / (12.0 * step * -hose.muscle.length)
        worst = max(worst, float(np.abs(-pressure * slope / hose.map(pressure, contraction) - 1.0).max()))
    return worst


def _angles():
    contraction = np.array([0.03, 0.1, 0.17])
    # The clamps take a little length: two muscles differ by it, half as much where the length is twice as much.
    extrapolated = 2.0 * np.cos(_middle(0.8, contraction)) - np.cos(_middle(0.4, contraction))
    return float(np.abs(extrapolated / ((1.0 - contraction) * np.cos(np.radians(25.0))) - 1.0).max())


def _middle(length, contraction):
    """Angle at the middle of a net of this length."""
    body = Hose(Muscle("long", "braided", length, 8e-3, braid_angle=np.radians(25.0))).shape.body()
    return meridian.angles(body, np.full(3, 2e5), length * (1.0 - contraction), np.zeros(1))[:, 0]


def _motion(pressure, contraction, seconds=200.0):
    count = len(pressure)
    zeros = np.zeros(count, int)
    return rigs.Motion("check", "check", np.linspace(0.0, seconds, count), pressure, contraction, None, zeros, zeros == 0, zeros, 1)


def _loop(family, amplitude, pressure, contraction, at, nature=Nature(), cycle=-1):
    """Force on the way up minus that on the way down, of the hidden effect alone, at the value `at` of what is driven, in one of two cycles."""
    motion = _motion(pressure, contraction)
    world = World(HOSE, nature, {family: amplitude})
    taken = -world.resisted(motion, pressure, contraction)
    driven = pressure if np.ptp(pressure) else contraction
    half = len(driven) // 4
    start = 2 * half if cycle else 0
    up, down = slice(start, start + half), slice(start + half, start + 2 * half)
    order = np.argsort(driven[down])
    return np.interp(at, driven[up], taken[up]) - np.interp(at, driven[down][order], taken[down][order])


def _two_cycles(low, high, count=400):
    phase = np.arange(4 * count) / (2.0 * count)
    return low + (high - low) * rigs.wave("triangle", phase)


def _strands(slip):
    """Elements that slip after this contraction."""
    return Nature(strands=Strands(1.6 * slip, 0.7, 4.0 * np.pi * 3.7e5 * 10.7e-3))


def _isobaric_loop():
    contraction = _two_cycles(0.005, 0.15)
    loop = _loop("strand-friction", 7.5e-5, np.full(len(contraction), 3.7e5), contraction, 0.1, _strands(0.001))
    return abs(-loop / 14.0 - 1.0)


def _isometric_loop():
    pressure = _two_cycles(1.3e5, 6e5)
    at = np.linspace(1.6e5, 5.7e5, 30)
    loops = [np.array(_loop("strand-friction", 7.5e-5, pressure, np.full(len(pressure), 0.1), at, _strands(slip))) for slip in (5e-4, 1e-2)]
    early, late = (float(loop[np.argmax(np.abs(loop))]) for loop in loops)
    return 0.0 if -12.0 < early < -4.0 and -4.0 < late < 1.0 else max(abs(early), abs(late))


def _loses_work():
    worst = 0.0
    for slip in (5e-4, 3e-3, 2e-2):
        contraction = _two_cycles(0.005, 0.15)
        motion = _motion(np.full(len(contraction), 3e5), contraction)
        taken = World(HOSE, _strands(slip), {"strand-friction": 7.5e-5}).resisted(motion, motion.pressure, contraction)
        last = slice(len(contraction) // 2, None)
        worst = max(worst, -float(np.trapezoid(taken[last], contraction[last])))
    return max(worst, 0.0)


def _rubber_loop():
    pressure = _two_cycles(0.0, 6e5)
    contraction = (0.005, 0.05, 0.15)
    loops = [float(_loop("rubber-loss", 0.15, pressure, np.full(len(pressure), eps), 1e5)) for eps in contraction]
    shares = [-loop / float(HOSE.rubber_force(np.array([eps]))[0]) for loop, eps in zip(loops, contraction)]
    return 0.0 if loops[2] < loops[1] < loops[0] < 0.0 and all(0.03 < share < 0.2 for share in shares) else max(shares)


def _stop_loop():
    pressure = _two_cycles(1e5, 6e5)
    contraction = np.full(len(pressure), 0.05)
    worst = 0.0
    for sign in (1.0, -1.0):
        world = World(HOSE, Nature(stop_sign=sign, regulator=1e4, frame_give=0.0), {"pressure-hysteresis": 1.0})
        record = world.record(_motion(pressure, contraction))
        lag = record.shown_pressure - record.pressure
        up = slice(2 * 400 + 200, 3 * 400 - 10)
        worst = max(worst, abs(float(np.ptp(lag[up]))) / 2e3, abs(float(np.mean(lag[up])) / (-sign * np.mean(Nature().stop_widths)) - 1.0))
    return worst if worst > 1e-6 else 0.0


def _creep_loop():
    pressure = _two_cycles(1e5, 6e5)
    contraction = np.full(len(pressure), 0.05)
    first, second = (float(_loop("creep", 0.02, pressure, contraction, 3e5, Nature(creep_time=50.0), cycle=cycle)) for cycle in (0, -1))
    return 0.0 if 0.0 < second < first else abs(second - first)


def _stretched():
    times, weights = hysteresis.stretched(20.0, 0.4)
    at = np.geomspace(2e-3, 20.0, 50) * 20.0
    return float(np.abs(np.exp(-at[:, None] / times) @ weights - np.exp(-((at / 20.0) ** 0.4))).max())


def _relaxing():
    time = np.linspace(0.0, 30.0, 200)
    found = hysteresis.relaxing(time, 2.0 * time, [5.0], [1.0])
    return float(np.abs(found - 10.0 * -np.expm1(-time / 5.0)).max())


def _late():
    time = np.linspace(0.0, 60.0, 600)
    return float(np.abs(hysteresis.late(time, 3.0 * time, 0.5) - 3.0 * (time - 0.75))[300:].max())


def _overshoot():
    time = np.linspace(0.0, 5.0, 4000)
    wanted = np.where(time > 0.01, 1.0, 0.0)
    found = float(hysteresis.overshooting(time, wanted, 10.0, 0.5).max())
    return abs(found - 1.0 - float(np.exp(-np.pi * 0.5 / np.sqrt(0.75))))


def _carried():
    hose, rng = hoses(1)[0], np.random.default_rng(4)
    motion = rigs.isotonic(rng, hose, 200, 6e5)
    world = World(hose, Nature(), {"strand-friction": 1e-4, "rig-friction": 4.0})
    record = world.record(motion)
    # The same path once more, now known beforehand.
    resisted = world.resisted(motion, record.pressure, record.contraction)
    left = hose.pull(record.pressure, record.contraction) - resisted - motion.load
    return float(np.abs(left).max())


def _rests():
    """A slow regulator undershoots at the lowest pressure, which just carries the load."""
    hose, worst, resting = hoses(1)[4], 0.0, 0
    for seed in range(8):
        motion = rigs.isotonic(np.random.default_rng(seed), hose, 200, 6e5)
        record = World(hose, Nature(regulator=4.0, damping=0.1)).record(motion)
        worst = max(worst, float(np.abs(record.force - hose.pull(record.pressure, record.contraction)).max()))
        # Away from the stop it carries the load.
        lowest, highest = hose.map.window.contraction
        on_stop = (record.contraction < lowest + 2e-4) | (record.contraction > highest - 2e-4)
        resting += int(on_stop.sum())
        worst = max(worst, float(np.abs(record.force - motion.load)[~on_stop].max()))
    return worst if resting else np.inf


def _noise():
    worst = 0.0
    for law in instruments.LAWS:
        draws = instruments.noise(np.random.default_rng(2), law, 200000, 5.0)
        # The variance of a sample of Student's t settles never; its quartiles do.
        heavy = law == "heavy"
        found = float(np.quantile(np.abs(draws), 0.5)) * np.sqrt(3.0) / student.ppf(0.75, 3) if heavy else float(draws.var())
        worst = max(worst, abs(found - 1.0))
    return worst


def _table(count=240):
    rng = np.random.default_rng(9)
    length = 0.25 * (1.0 - np.linspace(0.01, 0.16, count))
    return {
        "time": np.arange(count) * 0.25, "pressure": np.abs(rng.normal(3e5, 1e5, count)), "length": length, "contraction": 1.0 - length / 0.25,
        "displacement": 0.25 - length, "force": rng.normal(400.0, 80.0, count), "sweep": np.repeat([1.0, 2.0, 3.0], count // 3),
        "specimen": np.ones(count),
    }  # fmt: skip


def _untouched():
    wrong = 0
    for kind in damage.ALL:
        if kind == "duplicates":
            continue
        table = _table()
        table["pressure"][:5] = 100.0
        changed, said = damage.damaged(np.random.default_rng(5), table, (kind,), 2.0)
        named = {row - 1 for entry in said for row in entry["rows"]}
        for name, values in table.items():
            differs = np.flatnonzero(~((values == changed[name]) | (np.isnan(values) & np.isnan(changed[name]))))
            wrong += len(set(differs.tolist()) - named)
        wrong += not named
    return wrong


def _dialects():
    table, _ = damage.damaged(np.random.default_rng(6), _table(), ("nan", "blank", "duplicates", "spikes"), 2.0)
    worst = 0.0
    for name, write in dialects.DIALECTS.items():
        with tempfile.TemporaryDirectory() as folder:
            written = write(Path(folder), table)
            found = dialects.again(Path(folder), written)
        for quantity, values in found.items():
            wanted = table[quantity]
            if values.shape != wanted.shape or np.any(np.isnan(values) != np.isnan(wanted)):
                print(f"      {name}: {quantity} has other rows")
                return np.inf
            worst = max(worst, float(np.nanmax(np.abs(values - wanted)) / np.nanmax(np.abs(wanted))))
    return worst


def _scored():
    kinds = {
        "coulomb-friction": "friction",
        "pressure-friction": "friction",
        "pressure-presliding": "friction",
        "maxwell-slip": "friction",
        "pressure-creep": "viscoelastic",
        "standard-linear-solid": "viscoelastic",
        "pressure-viscosity": "viscoelastic",
        "valve-hysteresis": "pressure",
        "regulator-lag": "pressure",
        "force-lag": "pressure",
        "pressure-offset": "zero",
        "frame-compliance": "frame",
        "bladder-elasticity": None,
        "force-gain": None,
    }
    wrong = sum(scores.kind(name) != wanted for name, wanted in kinds.items())
    truth = {"hidden": [{"family": "strand-friction"}]}
    named = {"verdict": "missing", "missing": [{"effect": "pressure-creep", "class": ["pressure-creep", "maxwell-slip"]}]}
    for document, outcome, in_class, claimed in (
        (None, "none", False, False),
        ({"verdict": "adequate"}, "nothing", False, False),
        ({"verdict": "unknown", "missing": []}, "unknown", False, True),
        ({"verdict": "missing", "missing": [{"effect": "pressure-friction", "class": []}]}, "right", True, True),
        (named, "wrong", True, True),
    ):
        one = scores.Answer(truth, document, None, 1.0, True)
        wrong += (one.outcome, one.in_class, one.claimed) != (outcome, in_class, claimed)
    tried = {"candidates": [{"effect": "pressure-friction", "status": "not-testable"}, {"effect": "creep", "status": "rejected"}]}
    wrong += not scores.Answer(truth, tried, None, 1.0, True).looks_for_loops
    wrong += scores.Answer(truth, {"candidates": tried["candidates"][:1]}, None, 1.0, True).looks_for_loops
    return wrong


def _built():
    """Amplitudes are capped where benches have no more: then the swing is smaller, never larger, than ordered."""
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for rig, hidden, dialect in (
            ("isobaric", "rig-friction", "excel"),
            ("isometric", "rubber-loss", "matlab"),
            ("isotonic", "strand-friction", "parquet"),
            ("mixed", "creep", "contract"),
        ):
            order = Order(f"check-{rig}", "hidden", rig, (hidden,), dialect, 200)
            truth = case.build(order, 5, Path(folder))
            entry = truth["hidden"][0]
            wrong += not 3.0 < entry["swing_n"] < 1.05 * case.SWING[1]
            wrong += not 5.0 < entry["sigmas"] < 1.05 * case.SIGMAS[1]
            before = {file.name: file.read_bytes() for file in (Path(folder) / order.name).iterdir()}
            case.build(order, 5, Path(folder))
            wrong += before != {file.name: file.read_bytes() for file in (Path(folder) / order.name).iterdir()}
            wrong += json.loads(before["truth.json"]) != truth
    return wrong
