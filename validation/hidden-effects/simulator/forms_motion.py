"""Forms of friction and of damping: what resists the motion.

Build-up after a reversal: Dahl 1968, dz/dx = s (1 - s z)^n/delta with any exponent n; Iwan 1966, elements in parallel whose slip distances are spread.
Sliding level: Stribeck 1902, 1 + (k - 1) exp(-(v/v_s)^2). Friction that has no stick at all: arctan and tanh of the rate. Damping: power law
(Ostwald 1925, de Waele 1923), asinh (Eyring 1936), two plateaus (Carreau 1972).
"""

import math

import numpy as np
from scipy.special import ndtri

from .forms import Form

ELEMENTS = 12


def dahl(path, contraction, delta, exponent):
    """State z of dz/dx = s (1 - s z)^n/delta, 0 at the start of each run; exact over a row's motion.

    With y = 1 - s z: y^(1 - n) grows by (n - 1) |dx|/delta, or y falls by exp(-|dx|/delta) if n = 1. For n < 1 the state arrives at 1.
    """
    result = np.empty(len(path))
    power = 1.0 - exponent
    for run in path.runs:
        moves = np.diff(contraction[run], prepend=contraction[run.start])
        z, states = 0.0, []
        for way, sign in zip((np.abs(moves) / delta).tolist(), np.sign(moves).tolist()):
            if sign:
                y = max(1.0 - sign * z, 1e-12)
                if abs(power) < 1e-9:
                    y *= math.exp(-way)
                else:
                    y = max(y**power - power * way, 0.0) ** (1.0 / power)
                z = sign * (1.0 - y)
            states.append(z)
        result[run] = states
    return result


def iwan(path, contraction, distance, spread):
    """Mean of elements that stick up to their distance and then slip; log-normal distances of this median and spread (of the logarithm)."""
    distances = distance * np.exp(spread * ndtri((np.arange(ELEMENTS) + 0.5) / ELEMENTS))
    result = np.empty(len(path))
    for run in path.runs:
        moves = np.diff(contraction[run], prepend=contraction[run.start])
        steps = moves[:, None] / distances
        z = np.zeros(ELEMENTS)
        for i, step in enumerate(steps, run.start):
            z = np.minimum(np.maximum(z + step, -1.0), 1.0)
            result[i] = z.mean()
    return result


def stribeck(rate, ratio, speed):
    """Level of friction over that of fast sliding."""
    return 1.0 + (ratio - 1.0) * np.exp(-((rate / speed) ** 2))


def _contact(rng, scales, low=5e-4, high=2.5e-3):
    return scales.stroke * float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _two_strokes(rate, bias):
    """1 + b while shortening, 1 - b while lengthening."""
    return 1.0 + bias * np.tanh(rate / (0.02 * np.max(np.abs(rate)) + 1e-30))


# Constant friction.


def _lugre(state, amplitude, c):
    level = stribeck(state.path.rate, c["ratio"], c["speed"])
    return -amplitude * level * dahl(state.path, state.contraction, c["distance"], c["exponent"])


def _draw_lugre(rng, scales):
    return {
        "ratio": rng.uniform(1.15, 1.6),
        "speed": scales.slow * rng.uniform(0.15, 0.5),
        "distance": _contact(rng, scales),
        "exponent": rng.uniform(0.7, 1.3),
    }


def _arctan(state, amplitude, c):
    return -amplitude * 2.0 / np.pi * np.arctan(state.path.rate / c["speed"])


def _draw_rate(rng, scales):
    return {"speed": scales.slow * rng.uniform(0.01, 0.06)}


def _growing(state, amplitude, c):
    x = state.across - 0.5
    return -amplitude * (1.0 + c["growth"] * x) * _two_strokes(state.path.rate, c["bias"]) * np.tanh(state.path.rate / c["speed"])


def _draw_growing(rng, scales):
    return {"growth": rng.uniform(0.25, 0.7), "bias": rng.uniform(-0.25, 0.25), "speed": scales.slow * rng.uniform(0.01, 0.05)}


def _iwan_short(state, amplitude, c):
    return -amplitude * iwan(state.path, state.contraction, c["distance"], c["spread"])


def _draw_iwan_short(rng, scales):
    return {"distance": _contact(rng, scales, 5e-4, 2e-3), "spread": rng.uniform(0.5, 1.0)}


# In proportion to the pressure, or nearly.


def _pressure_power(state, amplitude, c):
    level = state.pressure * (state.pressure / c["pressure"]) ** (c["power"] - 1.0)
    return -amplitude * level * dahl(state.path, state.contraction, c["distance"], 2.0)


def _draw_pressure_power(rng, scales):
    power = rng.uniform(0.75, 0.9) if rng.random() < 0.5 else rng.uniform(1.1, 1.3)
    return {"power": power, "pressure": 0.7 * scales.pressure, "distance": _contact(rng, scales, 3e-4, 1e-3)}


def _pressure_adhesion(state, amplitude, c):
    level = np.maximum(state.pressure + c["adhesion"], 0.0)
    return -amplitude * level * np.tanh(state.path.rate / c["speed"])


def _draw_pressure_adhesion(rng, scales):
    return {"adhesion": scales.pressure * rng.uniform(-0.08, 0.15), "speed": scales.slow * rng.uniform(0.01, 0.05)}


def _pressure_growing(state, amplitude, c):
    return -amplitude * state.pressure * (1.0 + c["growth"] * (state.across - 0.5)) * iwan(
        state.path, state.contraction, c["distance"], c["spread"]
    )


def _draw_pressure_growing(rng, scales):
    return {"growth": rng.uniform(0.2, 0.6), "distance": _contact(rng, scales), "spread": rng.uniform(0.4, 0.9)}


# In proportion to the force, or nearly.


def _force_power(state, amplitude, c):
    level = c["force"] * (np.abs(state.force) / c["force"]) ** c["power"]
    return -amplitude * level * dahl(state.path, state.contraction, c["distance"], 1.5)


def _draw_force_power(rng, scales):
    power = rng.uniform(0.8, 0.92) if rng.random() < 0.5 else rng.uniform(1.08, 1.2)
    return {"power": power, "force": 0.5 * scales.force, "distance": _contact(rng, scales)}


def _force_pulley(state, amplitude, c):
    level = np.abs(state.force) + c["idle"]
    return -amplitude * level * 2.0 / np.pi * np.arctan(state.path.rate / c["speed"])


def _draw_force_pulley(rng, scales):
    return {"idle": scales.force * rng.uniform(0.0, 0.05), **_draw_rate(rng, scales)}


def _force_two_strokes(state, amplitude, c):
    level = np.abs(state.force) * _two_strokes(state.path.rate, c["bias"]) * stribeck(state.path.rate, c["ratio"], c["speed"])
    return -amplitude * level * iwan(state.path, state.contraction, c["distance"], 0.6)


def _draw_force_two_strokes(rng, scales):
    return {
        "bias": rng.uniform(-0.2, 0.2),
        "ratio": rng.uniform(1.05, 1.3),
        "speed": scales.slow * rng.uniform(0.15, 0.4),
        "distance": _contact(rng, scales),
    }


# Friction whose build-up is seen: the distance is a good part of the stroke.


def _dahl_steep(state, amplitude, c):
    return -amplitude * dahl(state.path, state.contraction, c["distance"], c["exponent"])


def _draw_dahl(low, high):
    def draw(rng, scales):
        return {"distance": scales.stroke * rng.uniform(0.02, 0.1), "exponent": rng.uniform(low, high)}

    return draw


def _draw_iwan_long(rng, scales):
    return {"distance": scales.stroke * rng.uniform(0.02, 0.08), "spread": rng.uniform(0.7, 1.3)}


def _two_springs(state, amplitude, c):
    first = dahl(state.path, state.contraction, c["distance"], 1.0)
    second = dahl(state.path, state.contraction, c["distance"] * c["ratio"], 1.0)
    return -amplitude * (c["share"] * first + (1.0 - c["share"]) * second)


def _draw_two_springs(rng, scales):
    return {"distance": scales.stroke * rng.uniform(0.01, 0.03), "ratio": rng.uniform(5.0, 12.0), "share": rng.uniform(0.35, 0.65)}


# Damping. The amplitude is the force per rate at the slow test's speed.


def _power_law(state, amplitude, c):
    v = state.path.rate / c["speed"]
    return -amplitude * state.path.rate * (v**2 + 1e-4) ** ((c["power"] - 1.0) / 2.0)


def _draw_power(low, high):
    def draw(rng, scales):
        return {"power": rng.uniform(low, high), "speed": scales.slow}

    return draw


def _eyring(state, amplitude, c):
    return -amplitude * c["speed"] * np.arcsinh(state.path.rate / c["speed"])


def _draw_eyring(rng, scales):
    return {"speed": scales.fast * rng.uniform(0.3, 1.0)}


def _carreau(state, amplitude, c):
    v = state.path.rate / c["speed"]
    return -amplitude * state.path.rate * (c["floor"] + (1.0 - c["floor"]) * (1.0 + v**2) ** ((c["power"] - 1.0) / 2.0))


def _draw_carreau(rng, scales):
    return {"speed": scales.fast * rng.uniform(0.1, 0.4), "power": rng.uniform(0.4, 0.75), "floor": rng.uniform(0.1, 0.4)}


FORMS = (
    Form("coulomb-friction", "dahl-stribeck", "motion", _draw_lugre, _lugre),
    Form("coulomb-friction", "arctan-of-rate", "motion", _draw_rate, _arctan),
    Form("coulomb-friction", "two-strokes-growing", "motion", _draw_growing, _growing),
    Form("coulomb-friction", "iwan-chain", "motion", _draw_iwan_short, _iwan_short),
    Form("pressure-friction", "power-of-pressure", "motion", _draw_pressure_power, _pressure_power),
    Form("pressure-friction", "adhesion-tanh", "motion", _draw_pressure_adhesion, _pressure_adhesion),
    Form("pressure-friction", "growing-iwan-chain", "motion", _draw_pressure_growing, _pressure_growing),
    Form("force-friction", "power-of-force", "motion", _draw_force_power, _force_power),
    Form("force-friction", "pulley-arctan", "motion", _draw_force_pulley, _force_pulley),
    Form("force-friction", "two-strokes-stribeck", "motion", _draw_force_two_strokes, _force_two_strokes),
    Form("presliding-hysteresis", "dahl-steep", "motion", _draw_dahl(1.6, 2.6), _dahl_steep),
    Form("presliding-hysteresis", "dahl-blunt", "motion", _draw_dahl(0.3, 0.7), _dahl_steep),
    Form("presliding-hysteresis", "iwan-spread", "motion", _draw_iwan_long, _iwan_short),
    Form("presliding-hysteresis", "two-contacts", "motion", _draw_two_springs, _two_springs),
    Form("viscous-damping", "power-thinning", "motion", _draw_power(0.6, 0.85), _power_law),
    Form("viscous-damping", "power-thickening", "motion", _draw_power(1.1, 1.3), _power_law),
    Form("viscous-damping", "eyring", "motion", _draw_eyring, _eyring),
    Form("viscous-damping", "carreau", "motion", _draw_carreau, _carreau),
)
