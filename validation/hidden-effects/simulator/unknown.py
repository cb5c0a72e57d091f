"""Effects that no catalogue holds: twelve shapes in contraction, pressure, time and temperature, each smooth where nature is smooth.

Each function takes the path, the static force F, the true pressure and contraction (SI) and returns the change of the force of unit amplitude [N].
Those that disturb the reading of the length return it through the slope dF/deps. x is the contraction from 0 to 1 over the test's range.
"""

import numpy as np

_BAR = 1e5


def _across(path):
    return (path.contraction - path.contraction.min()) / np.ptp(path.contraction)


def _session(path):
    return path.time / path.time[-1]


def resonance(path, force, slope, pressure):
    """A bump at one contraction, as if a fold locked and let go: p/(1 bar) exp(-(x - 0.6)^2/(2 0.09^2))."""
    return pressure / _BAR * np.exp(-0.5 * ((_across(path) - 0.6) / 0.09) ** 2)


def kink(path, force, slope, pressure):
    """A stop that is met at one contraction: the slope changes at x = 0.45, proportional to the pressure."""
    return -pressure / _BAR * np.logaddexp(0.0, (_across(path) - 0.45) / 0.01) * 0.01 * 4.0


def pressure_squared(path, force, slope, pressure):
    """Stiffening with the square of the pressure that is largest at middle contraction: p^2 sin(pi x)."""
    return (pressure / _BAR) ** 2 * np.sin(np.pi * _across(path))


def ageing(path, force, slope, pressure):
    """Ageing with the root of time that turns its sign: sqrt(t) - 1.25 t, times the force."""
    t = _session(path)
    return 1e-3 * force * (np.sqrt(t) - 1.25 * t) * 10.0


def torsion(path, force, slope, pressure):
    """The ends twist to and fro with the stroke: p sin(3 pi x) with growing size."""
    x = _across(path)
    return pressure / _BAR * np.sin(3.0 * np.pi * x) * (0.4 + x)


def thermal_length(path, force, slope, pressure):
    """Cross-talk from temperature to the reading of the length: 0.05 mm-like shift per 10 K, delivered through dF/deps."""
    return slope * 1e-5 * (path.temperature - path.temperature.mean())


def screw(path, force, slope, pressure):
    """The lead screw of the rig is eccentric: the length is wrong periodically, four turns over the stroke."""
    return slope * 1e-4 * np.sin(2.0 * np.pi * 4.0 * _across(path) + 0.5)


def root_pressure(path, force, slope, pressure):
    """Seals that grip with the root of the pressure at the short end of the stroke: -sqrt(p) x^6."""
    return -np.sqrt(pressure / _BAR) * _across(path) ** 6


def one_way(path, force, slope, pressure):
    """A lip that grips only while lengthening, only in the middle third of the stroke."""
    back = 0.5 * (1.0 - np.tanh(path.rate / (0.05 * np.abs(path.rate).max())))
    return back * np.exp(-(((_across(path) - 0.5) / 0.17) ** 4))


def hum(path, force, slope, pressure):
    """The amplifier's output swings slowly, 7.3 times over the session."""
    return np.sin(2.0 * np.pi * 7.3 * _session(path) + 1.1)


def slip_event(path, force, slope, pressure):
    """At one moment of the session a clamp slips by a jump and creeps on for a while."""
    after = np.clip(_session(path) - 0.37, 0.0, None)
    return slope * 1e-4 * np.where(after > 0.0, 1.0 - 0.4 * np.exp(-after / 0.05), 0.0)


def pressure_window(path, force, slope, pressure):
    """A liner that carries load only in a window of pressures, and not near either end of the range."""
    middle, width = 0.5 * (pressure.min() + pressure.max()), 0.22 * np.ptp(pressure)
    return -np.exp(-0.5 * ((pressure - middle) / width) ** 2) * (0.3 + _across(path) ** 2)


UNKNOWN = {
    "resonance": (resonance, ()),
    "kink": (kink, ()),
    "pressure-squared": (pressure_squared, ()),
    "ageing": (ageing, ("motion",)),
    "torsion": (torsion, ()),
    "thermal-length": (thermal_length, ("motion", "temperature")),
    "screw": (screw, ()),
    "root-pressure": (root_pressure, ()),
    "one-way": (one_way, ("motion",)),
    "hum": (hum, ("motion",)),
    "slip-event": (slip_event, ("motion",)),
    "pressure-window": (pressure_window, ()),
}
"""Function and needs of each effect that is outside the catalogue."""

VARIABLES = {
    "resonance": ("contraction", "pressure"),
    "kink": ("contraction", "pressure"),
    "pressure-squared": ("pressure", "contraction"),
    "ageing": ("time", "cycle"),
    "torsion": ("contraction", "pressure"),
    "thermal-length": ("temperature",),
    "screw": ("contraction",),
    "root-pressure": ("pressure", "contraction"),
    "one-way": ("direction", "rate", "contraction"),
    "hum": ("time",),
    "slip-event": ("time", "cycle"),
    "pressure-window": ("pressure", "contraction"),
}
"""Columns in each formula, beside the force or the slope that it multiplies; a cycle is a stretch of time."""
