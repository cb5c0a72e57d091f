"""Builds one test: draws the muscle's test, sizes what is hidden, reads the instruments, damages rows, writes the folder."""

import json
from dataclasses import replace
from zlib import crc32

import numpy as np
from simulator.hysteresis import Strands

from . import damage, dialects, instruments, rigs
from .hoses import hoses
from .world import Nature, World

SWING = (5.0, 40.0)
"""Width of the loops or the misfit that is hidden [N], in the middle 95 % of rows."""
SIGMAS = (12.0, 120.0)
"""Norm of what is hidden over the noise; the noise is chosen for it, within bounds."""
NOISE = (0.15, 4.0)
BUCKLED = 5.0
"""Static force [N] below which a muscle at held length is about to push, and buckles: such rows are counted."""
UNIT = {
    "strand-friction": 7.5e-5, "rubber-loss": 0.1, "pressure-hysteresis": 1.0, "pressure-lag": 0.02, "creep": 0.01, "rig-friction": 5.0,
    "frame-compliance": 1e-6, "pressure-zero": 3e3,
}  # fmt: skip
LIMIT = {
    "strand-friction": 3e-4, "rubber-loss": 0.4, "pressure-hysteresis": 15.0, "pressure-lag": 0.4, "creep": 0.06, "rig-friction": 25.0,
    "frame-compliance": 1e-5, "pressure-zero": 1.5e4,
}  # fmt: skip
"""A usual amplitude, and the largest that a bench has."""


def build(order, seed, out, plain=False):
    """Writes out/<case> and returns its truth. The same seed and name give the same bytes."""
    rng = np.random.default_rng([seed, crc32(order.name.encode())])
    hose = _hose(rng, order, seed)
    most = 6.2e5 if hose.muscle.kind == "braided" else 3.2e5
    from_zero = _from_zero(rng, order, hose)
    motion = (
        rigs.isometric(rng, hose, order.rows, most, from_zero)
        if order.rig == "isometric"
        else getattr(rigs, order.rig)(rng, hose, order.rows, most)
    )
    world = sized(World(hose, nature(rng, hose, motion)), motion, {name: rng.uniform(*SWING) / len(order.hidden) for name in order.hidden})
    record = world.record(motion)
    missing = misfit(world, record)
    noise = _noise(rng, missing, record)
    rig = instruments.draw(rng, noise, record.kept("force"), slopes(hose, record))
    if order.noise:
        rig = replace(rig, law=order.noise[0], memory=order.noise[1])
    table = readings(rng, rig, hose, record)
    table, rows = damage.damaged(rng, table, order.damage, rig.total)
    folder = out / order.name
    folder.mkdir(parents=True, exist_ok=True)
    muscle = replace(hose.muscle, **{("stroke" if name == "length" else name): sheet for name, sheet in rig.sheets().items()})
    written = (dialects.contract if plain else dialects.DIALECTS[order.dialect])(folder, table)
    (folder / "muscle.toml").write_text(muscle.toml() + written.toml, encoding="utf-8")
    arguments = [written.file, "--muscle", "muscle.toml", *written.arguments]
    (folder / "args").write_text("\n".join(arguments) + "\n", encoding="utf-8")
    truth = {
        "case": order.name,
        "group": order.group,
        **motion.describe(),
        "muscle": hose.muscle.kind,
        "bladder": hose.muscle.bladder is not None,
        "from_zero": from_zero,
        "dialect": "contract" if plain else order.dialect,
        "rows": len(table["force"]),
        "hidden": [_entry(world, motion, name, rig.total) for name in order.hidden],
        "sigmas": round(float(np.linalg.norm(missing - missing.mean()) / rig.total), 2),
        "buckled": int(np.count_nonzero(hose.tangent(record.kept("pressure"), record.kept("contraction")) < BUCKLED)),
        "damage": rows,
        "noise": rig.describe(),
    }
    (folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    return truth


def _hose(rng, order, seed):
    """Rubber for what needs rubber, strands for what needs strands; one in eight is pleated elsewhere."""
    pool = hoses(seed)
    if "rubber-loss" in order.hidden:
        return pool[int(rng.integers(0, 4))]
    if "strand-friction" in order.hidden and order.rig == "isometric":
        # Strands turn at held length only where fibres stretch or rubber shapes the net.
        return pool[int(rng.choice([0, 1, 2, 3, 4, 6]))]
    if "strand-friction" in order.hidden:
        return pool[int(rng.integers(0, 8))]
    return pool[int(rng.integers(0, 10))] if rng.random() < 0.6 else pool[int(rng.integers(0, 8))]


def _from_zero(rng, order, hose):
    """Whether an isometric test starts vented. With rubber it then buckles at first: not in tests that are to show nothing."""
    if order.rig != "isometric":
        return False
    if "negative-pressure" in order.damage or "rubber-loss" in order.hidden:
        return not hose.muscle.bladder or bool(order.hidden)
    return bool(rng.random() < 0.5) and (hose.muscle.bladder is None or bool(order.hidden))


def nature(rng, hose, motion):
    """Constants drawn for one case."""
    turn = 1.6 if hose.muscle.kind == "braided" else 1.0
    radius = hose.muscle.radius
    duration = float(motion.time[-1] - motion.time[0])
    return Nature(
        strands=Strands(turn * 10.0 ** rng.uniform(-3.4, -2.3), rng.uniform(0.7, 1.2), 4.0 * np.pi * 3e5 * radius),
        rig_contact=10.0 ** rng.uniform(-3.7, -3.0),
        rubber_order=rng.uniform(0.05, 0.25),
        rubber_times=(rng.uniform(0.002, 0.01) * duration, rng.uniform(0.5, 2.0) * duration),
        filling=rng.uniform(0.6e5, 1.4e5),
        stop_widths=tuple(float(w) for w in 1e3 * np.array([0.5, 1.0, 1.8, 3.2]) * rng.uniform(0.7, 1.5)),
        stop_sign=1.0 if rng.random() < 0.7 else -1.0,
        creep_time=rng.uniform(0.05, 0.5) * duration,
        creep_exponent=rng.uniform(0.3, 0.6),
        regulator=rng.uniform(5.0, 20.0),
        damping=rng.uniform(0.4, 0.8),
        frame_give=10.0 ** rng.uniform(-4.0, -3.0),
    )


def misfit(world, record):
    """What the static muscle at the readings has more than the force [N], at the recorded rows."""
    pressure = np.maximum(record.kept("shown_pressure"), 0.0)
    return world.hose.pull(pressure, record.kept("shown_contraction")) - record.kept("force")


def swing(missing):
    """Width of the middle 95 % of rows [N]."""
    low, high = np.quantile(missing, (0.025, 0.975))
    return float(high - low)


def sized(world, motion, wanted):
    """The world with amplitudes that give the wanted swings [N], each alone, as far as benches have such."""
    for name, target in wanted.items():
        amplitude = UNIT[name]
        for _ in range(4):
            found = swing(misfit(world, _alone(world, name, amplitude).record(motion)))
            amplitude = min(amplitude * np.clip(target / max(found, 1e-3), 0.2, 5.0), LIMIT[name])
        world.amplitudes[name] = float(amplitude)
    return world


def _alone(world, name, amplitude):
    return World(world.hose, world.nature, {name: amplitude})


def _entry(world, motion, name, noise):
    """What the truth says of one hidden effect."""
    missing = misfit(world, _alone(world, name, world.amplitude(name)).record(motion))
    return {
        "family": name,
        "amplitude": world.amplitude(name),
        "swing_n": round(swing(missing), 3),
        "sigmas": round(float(np.linalg.norm(missing - missing.mean()) / noise), 2),
    }


def _noise(rng, missing, record):
    norm = float(np.linalg.norm(missing - missing.mean()))
    wanted = 10.0 ** rng.uniform(*np.log10(SIGMAS))
    # Where nothing is hidden, that of a load cell.
    chosen = norm / wanted if norm > 1.0 else np.max(record.kept("force")) * 10.0 ** rng.uniform(-3.4, -2.7)
    return float(np.clip(chosen, *NOISE))


def slopes(hose, record):
    """rms dF/dp [m^2] and dF/dl [N/m]."""
    pressure = np.maximum(record.kept("pressure"), hose.lowest)
    contraction = record.kept("contraction")
    rise, slope = hose.map.rise(pressure, contraction), hose.map.slope(pressure, contraction)
    return float(np.sqrt(np.mean(rise**2))), float(np.sqrt(np.mean(slope**2))) / hose.muscle.length


def readings(rng, rig, hose, record):
    """The table that the instruments give: columns in SI."""
    rest = hose.muscle.length
    force, pressure, length = rig.read(
        rng, record.kept("force"), record.kept("shown_pressure"), rest * (1.0 - record.kept("shown_contraction"))
    )
    motion = record.motion
    return {
        "time": motion.time[motion.keep],
        "pressure": pressure,
        "length": length,
        "contraction": 1.0 - length / rest,
        "displacement": rest - length,
        "force": force,
        "sweep": motion.sweep[motion.keep],
        "specimen": np.ones(len(force)),
    }
