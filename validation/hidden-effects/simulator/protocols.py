"""Test protocols: loops at constant pressure, loops that turn early, stairs with holds, static maps. Motion is smooth in time."""

from dataclasses import dataclass

import numpy as np

from .path import REFERENCE_TEMPERATURE, Path

PAUSE = 40.0
# How round the corners of a triangle are: 1 is sharp.
_TRIANGLE = 0.985


@dataclass(frozen=True)
class Plan:
    """One protocol: pressures [Pa], range of contraction, form of the motion and its size."""

    form: str
    pressures: tuple
    low: float
    high: float
    rows: int
    periods: tuple = (60.0,)
    loops: int = 1
    repeats: int = 1
    specimens: int = 1
    temperature_swing: float = 0.0

    def path(self, pressures=None):
        """The readings of the plan, at other pressures if given."""
        chosen = tuple(pressures or self.pressures)
        if self.form == "static":
            return self._static(chosen)
        parts, start, number = [], 0.0, 0
        runs = [(s, r, period, p) for s in range(self.specimens) for r in range(self.repeats) for period in self.periods for p in chosen]
        for specimen, _, period, pressure in runs:
            number += 1
            time, contraction, rate, cycle = self._run(period)
            one = np.ones_like(time)
            parts.append((pressure * one, contraction, rate, start + time, number * one, cycle, (specimen + 1) * one))
            start += time[-1] + PAUSE
        columns = [np.concatenate(column) for column in zip(*parts)]
        path = Path(
            *columns[:4], *(column.astype(int) for column in columns[4:]), temperature=self._temperature(columns[3], columns[4], number)
        )
        path.shows_cycle = self.loops > 1
        path.shows_specimen = self.specimens > 1
        path.shows_temperature = self.temperature_swing > 0.0
        return path

    def _temperature(self, time, sweep, sweeps):
        """The room warms up and cools down over the session, in another order than the pressures rise; mean near the reference."""
        if not self.temperature_swing:
            return np.full(len(time), REFERENCE_TEMPERATURE)
        level = np.cos(2.4 * (sweep - 1.0) + 0.7)
        wave = np.sin(2.0 * np.pi * 1.3 * time / (time[-1] + PAUSE))
        mixed = 0.6 * level + 0.6 * wave if sweeps > 1 else wave
        return REFERENCE_TEMPERATURE + self.temperature_swing * (mixed - mixed.mean())

    def _static(self, pressures):
        steps = max(2, round(self.rows / len(pressures)))
        p, eps = np.meshgrid(pressures, np.linspace(self.low, self.high, steps), indexing="ij")
        p, eps = p.ravel(), eps.ravel()
        zero = np.zeros_like(p)
        one = np.ones(len(p), int)
        return Path(p, eps, zero, zero, one, 0 * one, one, zero + REFERENCE_TEMPERATURE, timed=False)

    def _run(self, period):
        """Time, contraction, its rate and the number of the loop of one run."""
        if self.form in ("triangle", "sine"):
            return self._loops(period)
        if self.form == "minor":
            corners = self.low + (self.high - self.low) * np.array([0.0, 1.0, 0.0, 0.55, 0.25, 0.8, 0.45, 1.0, 0.65, 0.9, 0.0])
            rest = 0.0
        else:
            up = np.linspace(self.low, self.high, 5)
            corners = np.concatenate([up, up[-2::-1]])
            rest = 2.0
        legs = np.abs(np.diff(corners)) / (2.0 * (self.high - self.low)) * period
        dwell = rest * period / len(legs)
        total = legs.sum() + dwell * (len(legs) + 1)
        time = np.linspace(0.0, total, self.rows)
        contraction, rate = _through(corners, legs, dwell, time)
        return time, contraction, rate, np.zeros_like(time)

    def _loops(self, period):
        time = np.linspace(0.0, self.loops * period, self.rows)
        phase = 2.0 * np.pi * time / period
        speed = 2.0 * np.pi / period
        if self.form == "sine":
            shape, slope = 0.5 - 0.5 * np.cos(phase), 0.5 * np.sin(phase) * speed
        else:
            k = _TRIANGLE
            shape = 0.5 - 0.5 * np.arcsin(k * np.cos(phase)) / np.arcsin(k)
            slope = 0.5 * k * np.sin(phase) * speed / np.sqrt(1.0 - (k * np.cos(phase)) ** 2) / np.arcsin(k)
        span = self.high - self.low
        return time, self.low + span * shape, span * slope, np.minimum(time // period, self.loops - 1)


def _through(corners, legs, dwell, time):
    """Cosine-shaped moves between corners with rests before, between and after them."""
    contraction, rate = np.full_like(time, corners[-1]), np.zeros_like(time)
    start = dwell
    contraction[time < start] = corners[0]
    for first, last, duration in zip(corners[:-1], corners[1:], legs):
        inside = (time >= start) & (time < start + duration)
        phase = np.pi * (time[inside] - start) / duration
        contraction[inside] = first + (last - first) * 0.5 * (1.0 - np.cos(phase))
        rate[inside] = (last - first) * 0.5 * np.pi / duration * np.sin(phase)
        rests = (time >= start + duration) & (time < start + duration + dwell)
        contraction[rests] = last
        start += duration + dwell
    return contraction, rate
