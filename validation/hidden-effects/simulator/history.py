"""Forces that remember: friction that builds up with distance, viscosity, creep, softening, and first-order lags.

Friction is a state, never the sign of a velocity. Dahl 1968 with exponent 3/2: dz/dx = sgn (1 - sgn z)^(3/2)/delta, |z| <= 1, sgn that of dx. With
y = 1 - sgn z a row with motion dx takes 1/sqrt(y) to 1/sqrt(y) + |dx|/(2 delta) exactly. The level that the state scales follows Stribeck's curve.
Several Dahl elements of different delta make presliding (a smooth Iwan 1966 chain). Creep: gas pressure loads the wall, which
gives way with a spectrum of relaxation times, log-uniform between two bounds.
"""

import math

import numpy as np
from scipy.signal import lfilter


def dahl(path, contraction, delta, cycled):
    """State z of each row; `cycled`: the rig has run the same loop before it records, otherwise z = 0 at the start of each run."""
    result = np.empty(len(path))
    for run in path.runs:
        x = contraction[run]
        moves = np.diff(x, prepend=x[0])
        ways = (0.5 * np.abs(moves) / delta).tolist()
        signs = np.sign(moves).tolist()
        z = 0.0
        for _ in range(2 if cycled else 1):
            states = []
            for way, sign in zip(ways, signs):
                if sign:
                    root = math.sqrt(max(1.0 - sign * z, 0.0))
                    z = sign * (1.0 - (root / (1.0 + root * way)) ** 2)
                states.append(z)
        result[run] = states
    return result


def stribeck(rate, ratio, speed):
    """Level of friction against that of fast sliding: `ratio` at rest, falling to 1 over `speed` [1/s]."""
    return 1.0 + (ratio - 1.0) * np.exp(-((rate / speed) ** 2))


def viscous(rate, exponent, speed):
    """|v|^exponent with the sign of v, linear below 2 % of `speed` [1/s]; equals v at `speed`."""
    return rate * ((rate**2 + (0.02 * speed) ** 2) / (1.0004 * speed**2)) ** ((exponent - 1.0) / 2.0)


def relaxed(path, times, span):
    """Share of the wall that has given way since the start of the run, per decade of the spectrum; `span` in decades."""
    since = path.since_start[:, None]
    return (1.0 - np.exp(-since / np.asarray(times))).mean(axis=1) * span


def lag(path, signal, tau):
    """First-order lag tau y' = x - y of a signal that is linear between rows, exactly; at rest at the start of each run."""
    result = np.empty(len(path))
    for run in path.runs:
        x, time = signal[run], path.time[run]
        step = (time[-1] - time[0]) / (len(time) - 1)
        ratio = step / tau
        fade = math.exp(-ratio)
        slope = (1.0 - fade) / ratio
        drive = np.r_[0.0, (1.0 - slope) * x[1:] + (slope - fade) * x[:-1]]
        drive[0] = x[0]
        result[run] = lfilter([1.0], [1.0, -fade], drive)
    return result


def regulated(path, pressure, log_volume, tau, atmosphere):
    """Pressure in the muscle behind a valve: p' = (p_valve - p)/tau - (p + p_atm) V'/V (isothermal gas), by implicit steps."""
    result = np.empty(len(path))
    for run in path.runs:
        set_point, volume, time = pressure[run].tolist(), log_volume[run].tolist(), path.time[run].tolist()
        p = set_point[0]
        values = [p]
        for i in range(1, len(time)):
            feed = (time[i] - time[i - 1]) / tau
            growth = volume[i] - volume[i - 1]
            p = (p + feed * set_point[i] - atmosphere * growth) / (1.0 + feed + growth)
            values.append(p)
        result[run] = values
    return result
