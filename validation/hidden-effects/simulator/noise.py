"""Noise laws: what they add to the readings, and their covariance, whose inverse is applied in O(n).

Force:  w + a + u.  w white with standard deviation s (normal, or Student's t with 4 degrees of freedom scaled to it), a exponentially correlated
in time within a run (variance sa^2, time tau: Ornstein-Uhlenbeck 1930), u constant within a run (variance su^2). Readings of pressure
and length have white errors of their own; in force they weigh dF/dp and dF/deps. Steps of the converters add step^2/12.
The inverse: a Markov process has a tridiagonal inverse covariance Q, so (W + Q^-1)^-1 = W^-1 - W^-1 (Q + W^-1)^-1 W^-1 (Woodbury),
and the constant of a run is a rank-one change of that.
"""

from dataclasses import asdict, dataclass

import numpy as np
from scipy.linalg import solveh_banded


@dataclass(frozen=True)
class Law:
    """Standard deviations in SI: force [N], pressure [Pa], contraction [1]; `time` of the correlation [s]; steps of the converters."""

    name: str
    white: float
    correlated: float = 0.0
    time: float = 1.0
    offset: float = 0.0
    heavy: bool = False
    pressure: float = 0.0
    contraction: float = 0.0
    force_step: float = 0.0
    pressure_step: float = 0.0
    contraction_step: float = 0.0

    def describe(self):
        """For the truth file."""
        return asdict(self)

    def white_variance(self, pressure_slope, contraction_slope):
        """Variance of what is independent from row to row [N^2]."""
        p = self.pressure**2 + self.pressure_step**2 / 12.0
        e = self.contraction**2 + self.contraction_step**2 / 12.0
        return self.white**2 + self.force_step**2 / 12.0 + pressure_slope**2 * p + contraction_slope**2 * e

    def sample(self, rng, path):
        """Errors of force [N], pressure [Pa] and contraction."""
        count = len(path)
        draws = rng.standard_t(4, count) / np.sqrt(2.0) if self.heavy else rng.standard_normal(count)
        force = self.white * draws
        for run in path.runs if path.timed else []:
            force[run] += self.offset * rng.standard_normal()
            if self.correlated:
                force[run] += self.correlated * _exponential(rng, path.time[run], self.time)
        return force, self.pressure * rng.standard_normal(count), self.contraction * rng.standard_normal(count)


def _exponential(rng, time, tau):
    """Ornstein-Uhlenbeck process of variance 1 at the given times."""
    fade = np.exp(-np.diff(time) / tau)
    draws = rng.standard_normal(len(time))
    kick = np.r_[1.0, np.sqrt(1.0 - fade**2)] * draws
    values = np.empty(len(time))
    state = 0.0
    for i, (share, push) in enumerate(zip(np.r_[0.0, fade].tolist(), kick.tolist())):
        state = share * state + push
        values[i] = state
    return values


def rounded(values, step):
    """Values as a converter of this step gives them; step 0: as they are."""
    return np.round(values / step) * step if step else values


def apply_inverse(law, path, variance, columns):
    """K^-1 times columns (rows x m); `variance` is the white variance of each row."""
    result = columns / variance[:, None]
    if not path.timed:
        return result
    for run in path.runs:
        part = columns[run]
        weight = 1.0 / variance[run]
        solved = _without_offset(law, path.time[run], weight, part)
        if law.offset:
            ones = _without_offset(law, path.time[run], weight, np.ones((len(weight), 1)))[:, 0]
            solved = solved - np.outer(ones, ones @ part) / (1.0 / law.offset**2 + ones.sum())
        result[run] = solved
    return result


def _without_offset(law, time, weight, columns):
    scaled = columns * weight[:, None]
    if not law.correlated:
        return scaled
    fade = np.exp(-np.diff(time) / law.time)
    gap = 1.0 - fade**2
    diagonal = np.zeros(len(time))
    diagonal[0] = 1.0
    diagonal[1:] += 1.0 / gap
    diagonal[:-1] += fade**2 / gap
    banded = np.zeros((2, len(time)))
    banded[0, 1:] = -fade / gap
    banded[1] = diagonal
    banded /= law.correlated**2
    banded[1] += weight
    return scaled - weight[:, None] * solveh_banded(banded, scaled)
