"""Random muscles, rigs, tests and noise laws on the scale of real ones: aramid pleats of 1 to 3 bar, braids like a 20 mm fluidic muscle."""

from dataclasses import replace

import numpy as np

from .muscle import Muscle, Sheet
from .noise import Law
from .protocols import Plan
from .surface import Window
from .world import Nature

LAWS = ("white", "correlated", "offsets", "heavy", "inputs", "mixture")
STATIC_LAWS = ("white", "heavy", "inputs")


def draw_muscle(rng, kind, hidden):
    """A muscle as stated, without instruments; `hidden` are the effects that it must be able to show."""
    widths = rng.random() < 0.6
    if kind == "pleated":
        radius = round(rng.uniform(11e-3, 18e-3), 4)
        muscle = Muscle(
            name=f"simulated pleated muscle {rng.integers(1000, 9999)}",
            kind=kind,
            length=round(radius * rng.uniform(5.8, 9.0), 3),
            radius=radius,
            fibres=int(rng.integers(12, 22)) if "fibre-count" in hidden else int(rng.integers(24, 64)),
        )
        return replace(muscle, widths={"length": 2e-4, "radius": 1e-4}) if widths else muscle
    radius = round(rng.uniform(7e-3, 14e-3), 4)
    cylinder = "end-taper" in hidden
    slenderness = rng.uniform(60.0, 90.0) if cylinder else rng.uniform(12.0, 35.0)
    rubber = not cylinder and "bladder-elasticity" not in hidden and rng.random() < 0.5
    c10 = round(rng.uniform(0.06e6, 0.15e6), -3)
    muscle = Muscle(
        name=f"simulated braided muscle {rng.integers(1000, 9999)}",
        kind=kind,
        length=round(radius * slenderness, 3),
        radius=radius,
        fibres=int(rng.integers(60, 140)) if rng.random() < 0.5 else None,
        braid_angle=np.radians(round(rng.uniform(21.0, 28.0), 1)),
        ends="cylinder" if cylinder else "clamped",
        wall=round(radius * rng.uniform(0.12, 0.18), 4),
        bladder=(c10, round(c10 * rng.uniform(0.0, 0.3), -3)) if rubber else None,
    )
    return replace(muscle, widths={"length": 2e-4, "radius": 5e-5, "braid_angle": np.radians(0.1)}) if widths else muscle


def draw_plan(rng, kind, needs, size):
    """A test that meets the needs; `size` is sparse, normal or dense."""
    if kind == "pleated":
        low, high = rng.uniform(0.05, 0.08), rng.uniform(0.24, 0.32)
        lowest, highest = rng.uniform(0.8e5, 1.2e5), rng.uniform(2.4e5, 3.4e5)
    else:
        low, high = rng.uniform(0.006, 0.02), rng.uniform(0.17, 0.215)
        lowest, highest = rng.uniform(1.6e5, 2.0e5), rng.uniform(4.0e5, 5.5e5)
    if "low-load" in needs:
        high = 0.38 if kind == "pleated" else 0.27
    count = int(rng.integers(3, 6))
    pressures = tuple(float(round(p, -3)) for p in np.linspace(lowest, highest, 5 if size == "dense" else count))
    if size == "sparse":
        return Plan("static", tuple(float(round(p, -3)) for p in np.linspace(lowest, highest, 5)), low, high, 60)
    period = float(round(rng.uniform(20.0, 120.0)))
    specimens = int(rng.integers(3, 5)) if "specimens" in needs else 1
    swing = rng.uniform(4.0, 8.0) if "temperature" in needs or rng.random() < 0.15 else 0.0
    common = {"pressures": pressures, "low": low, "high": high, "specimens": specimens, "temperature_swing": swing}
    if "dwell" in needs:
        return Plan("stairs", rows=int(rng.integers(160, 320)), periods=(10.0 * period,), repeats=1, **common)
    if "cycles" in needs:
        return Plan(_wave(rng), rows=int(rng.integers(240, 400)), periods=(period,), loops=int(rng.integers(3, 6)), **common)
    if "rate" in needs:
        return Plan(_wave(rng), rows=int(rng.integers(80, 160)), periods=(period, period / rng.uniform(6.0, 15.0)), **common)
    if size == "dense":
        return Plan(_wave(rng), rows=20000 // specimens, periods=(period * 5.0,), **common)
    form = ("triangle", "sine", "minor", "triangle", "sine", "stairs")[int(rng.integers(6))]
    repeats = 1 if specimens > 1 else int(rng.integers(1, 4))
    return Plan(form, rows=int(rng.integers(90, 200)), periods=(period,), repeats=repeats, **common)


def _wave(rng):
    return "triangle" if rng.random() < 0.5 else "sine"


def provides(plan):
    """What effects find in this test."""
    found = {"cloth-range"}
    if plan.form != "static":
        found.add("motion")
    if len(set(plan.periods)) > 1:
        found.add("rate")
    if plan.form == "stairs":
        found.add("dwell")
    if plan.loops > 1:
        found.add("cycles")
    if plan.specimens > 2:
        found.add("specimens")
    if plan.temperature_swing:
        found.add("temperature")
    if plan.high > (0.34 if plan.low > 0.03 else 0.24):
        found.add("low-load")
    return found


def window(plan, kind):
    """Range of the force map: the test's with room for errors of the rig and for thresholds."""
    lowest, highest = min(plan.pressures), max(plan.pressures)
    if kind == "pleated":
        contraction = (0.55 * plan.low, plan.high + 0.02)
    else:
        contraction = (plan.low - 0.02, plan.high + 0.015)
    return Window((0.86 * lowest, 1.1 * highest), contraction)


def draw_nature(rng, largest_radius, plan):
    """Constants of the hidden effects; `largest_radius` [m] is where the muscle ends up in this test."""
    start = rng.uniform(0.3, 1.0)
    decades = rng.uniform(3.0, 3.6)
    factors = rng.standard_normal(max(plan.specimens, 1))
    if plan.specimens > 1:
        factors = (factors - factors.mean()) / factors.std()
    speed = 2.0 * (plan.high - plan.low) / max(plan.periods)
    session = sum(plan.periods) * plan.repeats * plan.specimens * len(plan.pressures)
    return Nature(
        stribeck_ratio=rng.uniform(1.0, 1.1),
        stribeck_speed=speed * rng.uniform(0.1, 0.3),
        contact_length=(plan.high - plan.low) * rng.uniform(1e-3, 3e-3),
        presliding_lengths=tuple((plan.high - plan.low) * np.array([0.02, 0.05, 0.1]) * rng.uniform(0.8, 1.4)),
        viscous_exponent=rng.uniform(0.93, 1.0),
        viscous_speed=speed,
        relaxation_times=tuple(float(t) for t in start * np.logspace(0.0, decades, 10)),
        relaxation_decades=decades,
        conditioning_loops=rng.uniform(0.8, 1.6),
        rubber_ratio=rng.uniform(0.0, 0.3),
        cloth_radius=largest_radius * rng.uniform(0.86, 0.93),
        circumference=2.0 * np.pi * largest_radius * rng.uniform(1.08, 1.4),
        threshold_pressure=0.12 * min(plan.pressures),
        drift_time=rng.uniform(4.0, 10.0) * session,
        cycled=bool(rng.random() < 0.5),
        specimen_factors=tuple(float(f) for f in factors),
    )


def draw_law(rng, name, full_scale, path, slopes):
    """A noise law on the scale of a load cell; `slopes` are rms dF/dp and dF/deps."""
    level = full_scale * 10.0 ** rng.uniform(-2.9, -2.4)
    steps = {
        "force_step": float(f"{0.2 * level:.1g}"),
        "pressure_step": 50.0 if rng.random() < 0.5 else 0.0,
        "contraction_step": 0.0,
    }
    correlation = (
        float(np.mean([path.time[run][-1] - path.time[run][0] for run in path.runs])) / rng.uniform(15.0, 60.0) if path.timed else 1.0
    )
    p, e = 0.5 * level / slopes[0], 0.6 * level / slopes[1]
    forms = {
        "white": Law(name, level, **steps),
        "correlated": Law(name, 0.6 * level, correlated=0.8 * level, time=correlation, **steps),
        "offsets": Law(name, 0.8 * level, offset=rng.uniform(0.4, 0.9) * level, **steps),
        "heavy": Law(name, level, heavy=True, **steps),
        "inputs": Law(name, 0.6 * level, pressure=p, contraction=e, **steps),
        "mixture": Law(
            name,
            0.5 * level,
            correlated=0.5 * level,
            time=correlation,
            offset=0.4 * level,
            heavy=True,
            pressure=0.6 * p,
            contraction=0.6 * e,
            **steps,
        ),
    }
    return forms[name]


def with_instruments(rng, muscle, law, completeness):
    """The muscle with the data sheets of its rig: "full", "noise" (of the force only) or "none"."""
    if completeness == "none":
        return muscle
    noise = float(f"{np.hypot(law.white, law.correlated) * rng.uniform(0.95, 1.1):.2g}")
    if completeness == "noise":
        return replace(muscle, force=Sheet(noise=noise))
    return replace(
        muscle,
        force=Sheet(noise, zero=float(f"{0.4 * noise:.2g}"), gain=1e-3),
        pressure=Sheet(float(f"{max(law.pressure, 20.0):.2g}"), zero=200.0, gain=5e-4),
        stroke=Sheet(float(f"{max(law.contraction * muscle.length, 2e-6):.2g}"), zero=3e-5, gain=5e-4),
    )
