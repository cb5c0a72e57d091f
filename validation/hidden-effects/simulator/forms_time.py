"""Forms of relaxation, softening and warmth: what time and travel change.

Relaxation: two Kelvin elements; stretched exponential (Kohlrausch 1854); power of time (Andrade 1910); Burgers 1935; logarithm with another onset
than a second; Boltzmann 1874, the load's own history under a stretched exponential. Softening: Mullins 1948 by the largest stretch so far (error
function after Ogden and Roxburgh 1999), stretched exponential of the travel, power of the cycle. Warmth: Arrhenius 1889; a muscle that lags behind the air; two thermal masses; a power balance
of work and cooling.
"""

import numpy as np
from scipy.special import erf

from .forms import Form
from .hysteresis import relaxing, stretched
from .path import REFERENCE_TEMPERATURE


def _load(state, c):
    """Share of the reference load that relaxes: 1, or what the pressure makes of it."""
    return (state.pressure / c["pressure"]) ** c["by_pressure"]


def _loads(rng, scales):
    return {"pressure": 0.7 * scales.pressure, "by_pressure": float(rng.choice([0.0, 0.0, 1.0, 0.6]))}


def _decades(scales):
    return max(np.log10(1.0 + scales.run), 1.0)


def _two_times(state, amplitude, c):
    t = state.path.since_start
    return -amplitude * c["size"] * _load(state, c) * (
        c["share"] * -np.expm1(-t / c["first"]) + (1.0 - c["share"]) * -np.expm1(-t / c["second"])
    )


def _draw_two_times(rng, scales):
    first = scales.run * rng.uniform(0.01, 0.05)
    return {"size": _decades(scales), "share": rng.uniform(0.35, 0.65), "first": first, "second": first * rng.uniform(8.0, 25.0), **_loads(rng, scales)}


def _kohlrausch(state, amplitude, c):
    return -amplitude * c["size"] * _load(state, c) * -np.expm1(-((state.path.since_start / c["time"]) ** c["power"]))


def _draw_kohlrausch(rng, scales):
    return {"size": _decades(scales), "time": scales.run * rng.uniform(0.05, 0.3), "power": rng.uniform(0.3, 0.6), **_loads(rng, scales)}


def _andrade(state, amplitude, c):
    return -amplitude * c["size"] * _load(state, c) * (state.path.since_start / c["time"]) ** c["power"]


def _draw_andrade(rng, scales):
    return {"size": _decades(scales), "time": scales.run, "power": rng.uniform(0.15, 0.35), **_loads(rng, scales)}


def _burgers(state, amplitude, c):
    t = state.path.since_start
    return -amplitude * c["size"] * _load(state, c) * ((1.0 - c["flow"]) * -np.expm1(-t / c["time"]) + c["flow"] * t / c["run"])


def _draw_burgers(rng, scales):
    return {"size": _decades(scales), "time": scales.run * rng.uniform(0.03, 0.1), "flow": rng.uniform(0.15, 0.4), "run": scales.run, **_loads(rng, scales)}


def _late_logarithm(state, amplitude, c):
    return -amplitude * _load(state, c) * np.log10(1.0 + state.path.since_start / c["onset"])


def _draw_late_logarithm(rng, scales):
    onset = float(rng.choice([rng.uniform(0.05, 0.3), scales.run * rng.uniform(0.01, 0.05)]))
    return {"onset": onset, **_loads(rng, scales)}


def _hereditary(state, amplitude, c):
    """Boltzmann's sum over the load's own history: a (F_load - what is left of it)."""
    times, weights = stretched(c["time"], c["power"])
    drive = state.force / c["force"]
    result = np.empty(len(drive))
    for run in state.path.runs:
        left = relaxing(state.path.time[run], drive[run], times, weights)
        result[run] = weights.sum() * drive[run] - left
    return -amplitude * c["size"] * result


def _draw_hereditary(rng, scales):
    return {"size": _decades(scales), "time": scales.run * rng.uniform(0.05, 0.3), "power": rng.uniform(0.3, 0.6), "force": 0.6 * scales.force}


# Softening: the virgin muscle has more of what softens.


def loops(path, pressure):
    """Full loops since the start of each run, from the way of contraction or, at held length, of pressure."""
    result = np.empty(len(path))
    for run in path.runs:
        signal = path.contraction[run] if np.ptp(path.contraction[run]) > 2e-3 else pressure[run] / np.max(pressure)
        way = np.cumsum(np.abs(np.diff(signal, prepend=signal[0])))
        result[run] = way / (2.0 * np.ptp(signal) + 1e-30)
    return result


def _travel(state, amplitude, c):
    """Filler of many strengths breaks along the way: a stretched exponential of it."""
    return amplitude * np.exp(-((loops(state.path, state.pressure) / c["loops"]) ** c["power"])) * state.bare


def _draw_travel(rng, scales):
    return {"loops": rng.uniform(0.6, 2.0), "power": rng.uniform(0.5, 0.8)}


def _power_of_cycle(state, amplitude, c):
    return amplitude * (1.0 + loops(state.path, state.pressure)) ** -c["power"] * state.bare


def _draw_power_of_cycle(rng, scales):
    return {"power": rng.uniform(0.8, 2.0)}


def _mullins(state, amplitude, c):
    """What lies below the largest stretch so far is soft: 1 - erf((x_max - x)/m), dying out slowly with the loops."""
    x = state.across if np.ptp(state.path.contraction[state.path.runs[0]]) > 2e-3 else state.pressure / np.max(state.pressure)
    result = np.empty(len(x))
    for run in state.path.runs:
        below = np.maximum.accumulate(x[run]) - x[run]
        result[run] = 1.0 - erf(below / c["width"])
    fade = np.exp(-loops(state.path, state.pressure) / c["loops"])
    return amplitude * (c["share"] * result * fade + (1.0 - c["share"]) * fade) * state.bare


def _draw_mullins(rng, scales):
    return {"width": rng.uniform(0.4, 1.0), "loops": rng.uniform(0.8, 2.5), "share": rng.uniform(0.3, 0.7)}


# Temperature of the room, and of the muscle by its own work.


def _arrhenius(state, amplitude, c):
    return amplitude * state.force * np.expm1(c["rise"] * (state.path.temperature - REFERENCE_TEMPERATURE)) / c["rise"]


def _draw_arrhenius(rng, scales):
    return {"rise": rng.uniform(0.04, 0.12) * float(rng.choice([-1.0, 1.0]))}


def _lagging(state, amplitude, c):
    """The muscle follows the air with a first-order lag over the whole session, pauses included."""
    warm = state.path.temperature - REFERENCE_TEMPERATURE
    muscle = warm - relaxing(state.path.time, warm - warm[0], [c["time"]], [1.0])
    return amplitude * state.force * muscle


def _draw_lagging(rng, scales):
    return {"time": scales.session * rng.uniform(0.01, 0.05)}


def _saturating(state, amplitude, c):
    return amplitude * state.force * c["range"] * np.tanh((state.path.temperature - REFERENCE_TEMPERATURE) / c["range"])


def _draw_saturating(rng, scales):
    return {"range": rng.uniform(5.0, 12.0)}


def _entropic(state, amplitude, c):
    """Rubber elasticity by entropy: what the wall bears grows with the absolute temperature, most where it is stretched most; the gas doesn't."""
    return amplitude * (1.0 - c["wall"] + c["wall"] * 2.0 * state.across) * state.force * (state.path.temperature - REFERENCE_TEMPERATURE)


def _draw_entropic(rng, scales):
    return {"wall": rng.uniform(0.2, 0.5)}


def _two_masses(state, amplitude, c):
    t = state.path.time
    return amplitude * state.force * (c["share"] * -np.expm1(-t / c["first"]) + (1.0 - c["share"]) * -np.expm1(-t / c["second"]))


def _draw_two_masses(rng, scales):
    first = scales.session * rng.uniform(0.04, 0.12)
    return {"share": rng.uniform(0.3, 0.6), "first": first, "second": first * rng.uniform(6.0, 15.0)}


def _hyperbola(state, amplitude, c):
    return amplitude * state.force * state.path.time / (state.path.time + c["time"])


def _draw_hyperbola(rng, scales):
    return {"time": scales.session * rng.uniform(0.1, 0.4)}


def _power_balance(state, amplitude, c):
    """dT/dt = (work rate/its mean - T)/tau: heated by motion, cooled in pauses."""
    power = np.abs(state.rates(state.path.contraction)) if np.any(state.path.rate) else np.abs(state.rates(state.path.pressure))
    time = state.path.time
    steps = np.diff(time, prepend=time[0])
    fade = np.exp(-steps / c["time"])
    usual = np.median(steps[1:])
    drive = np.where(steps > 5.0 * usual, 0.0, power / (power.mean() + 1e-30))
    warm, result = 0.0, np.empty(len(time))
    for i, (share, push) in enumerate(zip(fade.tolist(), drive.tolist())):
        warm = share * warm + (1.0 - share) * push
        result[i] = warm
    return amplitude * state.force * result


def _draw_power_balance(rng, scales):
    return {"time": scales.session * rng.uniform(0.6, 1.5)}


FORMS = (
    Form("creep", "two-times", "later", _draw_two_times, _two_times),
    Form("creep", "kohlrausch", "later", _draw_kohlrausch, _kohlrausch),
    Form("creep", "andrade", "later", _draw_andrade, _andrade),
    Form("creep", "burgers", "later", _draw_burgers, _burgers),
    Form("creep", "late-logarithm", "later", _draw_late_logarithm, _late_logarithm),
    Form("creep", "hereditary", "later", _draw_hereditary, _hereditary),
    Form("stress-softening", "travel", "wall", _draw_travel, _travel),
    Form("stress-softening", "power-of-cycle", "wall", _draw_power_of_cycle, _power_of_cycle),
    Form("stress-softening", "mullins", "wall", _draw_mullins, _mullins),
    Form("temperature", "arrhenius", "later", _draw_arrhenius, _arrhenius),
    Form("temperature", "lagging", "later", _draw_lagging, _lagging),
    Form("temperature", "saturating", "later", _draw_saturating, _saturating),
    Form("temperature", "entropic", "later", _draw_entropic, _entropic),
    Form("self-heating", "two-masses", "later", _draw_two_masses, _two_masses),
    Form("self-heating", "hyperbola", "later", _draw_hyperbola, _hyperbola),
    Form("self-heating", "power-balance", "later", _draw_power_balance, _power_balance),
)
