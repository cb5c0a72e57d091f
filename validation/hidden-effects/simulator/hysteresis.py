"""Hysteresis that pressure and length drive: strands that rub on each other, rubber that relaxes, pressure readings with play, creep.

Strands: at every place along the fibre the friction moment of the crossings is a sum of elements (Iwan 1966) of *constant* stiffness, whose
yield angles are spread over more than a decade (log-normal) and whose slip limit follows the pressure. Virtual work makes a force of the moments:
dF = -(1/l0) int m dtheta/deps ds. What turns is the fibre's own angle, out of the equilibria: by length, pressure, stretch and rubber alike.

Rubber and creep: a drive b(t) that is linear between rows relaxes with a spectrum of times, q_k' = b' - q_k/tau_k, exactly. Weights tau^-beta
make a fractional element (Koeller 1984); a fit with positive weights makes Kohlrausch's stretched exponential.

Pressure sensors: stops of spread widths (Prandtl-Ishlinskii); the reading is the pressure plus or minus their mean.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm
from scipy.optimize import nnls
from scipy.special import ndtri

ELEMENTS = 14


@dataclass(frozen=True)
class Strands:
    """Elements in parallel: yield angles [rad] of median `distance` and `spread` (standard deviation of their natural logarithm).

    A level of 1 is the slip limit of all elements together; the stiffness is that of the level `reference`.
    """

    distance: float
    spread: float
    reference: float

    @property
    def distances(self):
        """Yield angles of the elements [rad], equal shares of the distribution."""
        return self.distance * np.exp(self.spread * ndtri((np.arange(ELEMENTS) + 0.5) / ELEMENTS))

    def moved(self, state, turn, level):
        """States (places x elements) after the turns [rad] of the places, at the slip limits `level` of the places."""
        bound = (level / ELEMENTS)[:, None]
        return np.clip(state + self.reference / ELEMENTS * turn[:, None] / self.distances, -bound, bound)

    def tangent(self, state, level):
        """Stiffness of the elements that stick, for each place."""
        sticks = np.abs(state) < (level / ELEMENTS)[:, None]
        return (self.reference / ELEMENTS * sticks / self.distances).sum(axis=1)

    def along(self, angle, level):
        """Sum of the elements at every row and place (rows x places); the first row is virgin."""
        state = np.zeros((angle.shape[1], ELEMENTS))
        result = np.zeros_like(angle)
        turns = np.diff(angle, axis=0)
        for i, turn in enumerate(turns, 1):
            state = self.moved(state, turn, level[i])
            result[i] = state.sum(axis=1)
        return result


def relaxing(time, drive, times, weights):
    """Weighted sum of q_k, q_k' = b' - q_k/tau_k, at rest with b = 0 before the first row."""
    times, weights = np.asarray(times, float), np.asarray(weights, float)
    state = np.full(len(times), drive[0])
    result = np.empty(len(time))
    result[0] = weights @ state
    ratios = np.maximum(np.diff(time)[:, None] / times, 1e-12)
    fades = np.exp(-ratios)
    gains = -np.expm1(-ratios) / ratios
    for i, (fade, gain, step) in enumerate(zip(fades, gains, np.diff(drive)), 1):
        state = state * fade + gain * step
        result[i] = weights @ state
    return result


def fractional(order, shortest, longest, count=9):
    """Relaxation times and weights of a fractional element between two times [s]: weights tau^-order, sum 1."""
    times = np.geomspace(shortest, longest, count)
    weights = times**-order
    return times, weights / weights.sum()


def stretched(tau, exponent, shortest=1e-3, longest=1e6):
    """Times and weights >= 0 with sum w_k exp(-t/tau_k) = exp(-(t/tau)^exponent) from `shortest` to `longest` times tau."""
    times = np.geomspace(shortest, longest, 40) * tau
    at = np.geomspace(0.3 * shortest, 0.1 * longest, 300) * tau
    matrix = np.exp(-at[:, None] / times)
    weights, _ = nnls(matrix, np.exp(-((at / tau) ** exponent)))
    used = weights > 0.0
    return times[used], weights[used]


def stops(signal, widths):
    """Mean of stops of these widths along the signal, in units of their mean width: between -1 and 1."""
    widths = np.asarray(widths, float)
    state = np.zeros(len(widths))
    result = np.zeros(len(signal))
    for i, step in enumerate(np.diff(signal), 1):
        state = np.clip(state + step, -widths, widths)
        result[i] = state.sum()
    return result / widths.sum()


def late(time, signal, tau):
    """The signal behind two first-order lags of tau and tau/2, at rest at the first row."""
    for one in (tau, 0.5 * tau):
        signal = signal - relaxing(time, signal - signal[0], [one], [1.0])
    return signal


def overshooting(time, wanted, frequency, damping):
    """What a controlled pressure does with a set point held between rows: y'' + 2 d w y' + w^2 y = w^2 x, at rest at the first row."""
    system = np.array([[0.0, 1.0], [-(frequency**2), -2.0 * damping * frequency]])
    known = {}
    state = np.zeros(2)
    result = np.empty(len(time))
    result[0] = wanted[0]
    for i, step in enumerate(np.diff(time), 1):
        key = round(float(step), 9)
        if key not in known:
            known[key] = expm(system * key)
        target = np.array([wanted[i - 1], 0.0])
        if i == 1:
            state = target.copy()
        state = target + known[key] @ (state - target)
        result[i] = state[0]
    return result
