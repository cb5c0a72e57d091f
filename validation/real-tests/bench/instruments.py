"""What amplifiers, converters and clocks make of the readings: noise that is white, correlated or heavy-tailed, errors within the data sheet, steps."""

from dataclasses import asdict, dataclass

import numpy as np
from simulator.muscle import Sheet

LAWS = ("white", "correlated", "heavy")


@dataclass(frozen=True)
class Instruments:
    """Standard deviations and steps in SI. `law` is that of the force; correlated noise forgets within `memory` rows. Errors are what is so, constant."""

    law: str
    force: float
    pressure: float
    length: float
    memory: float
    force_step: float
    pressure_step: float
    length_step: float
    stated: str
    force_zero: float = 0.0
    force_gain: float = 0.0
    pressure_zero: float = 0.0
    length_zero: float = 0.0

    def describe(self):
        """For the truth file."""
        return asdict(self)

    @property
    def total(self):
        """Standard deviation of the force reading with its step [N]."""
        return float(np.hypot(self.force, self.force_step / np.sqrt(12.0)))

    def read(self, rng, force, pressure, length):
        """The readings."""
        count = len(force)
        force = force * (1.0 + self.force_gain) + self.force_zero + self.force * noise(rng, self.law, count, self.memory)
        pressure = pressure + self.pressure_zero + self.pressure * rng.standard_normal(count)
        length = length + self.length_zero + self.length * rng.standard_normal(count)
        return _steps(force, self.force_step), _steps(pressure, self.pressure_step), _steps(length, self.length_step)

    def sheets(self):
        """Data sheets as the muscle file states them: all, that of the force's noise alone, or none."""
        if self.stated == "none":
            return {}
        noise = _two(self.total)
        if self.stated == "noise":
            return {"force": Sheet(noise=noise)}
        return {
            "force": Sheet(noise, zero=_two(0.4 * noise), gain=1e-3),
            "pressure": Sheet(_two(float(np.hypot(self.pressure, self.pressure_step / np.sqrt(12.0)))), zero=200.0, gain=5e-4),
            "length": Sheet(_two(float(np.hypot(self.length, self.length_step / np.sqrt(12.0)))), zero=3e-5, gain=5e-4),
        }


def _two(value):
    return float(f"{value:.2g}")


def noise(rng, law, count, memory):
    """Noise of variance 1, by law; what is correlated forgets within about `memory` rows."""
    if law == "heavy":
        return rng.standard_t(3, count) / np.sqrt(3.0)
    white = rng.standard_normal(count)
    if law == "white":
        return white
    # A moving average with a triangle's weights: not a process that forgets exponentially.
    width = max(int(memory), 2)
    kernel = np.convolve(np.ones(width), np.ones(width))
    kernel = kernel / np.linalg.norm(kernel)
    slow = np.convolve(rng.standard_normal(count + len(kernel) - 1), kernel, mode="valid")
    return 0.6 * white + 0.8 * slow


def _steps(values, step):
    return np.round(values / step) * step if step else values


def draw(rng, noise, force, slopes):
    """Instruments for a force noise [N]; `slopes` are rms dF/dp [m^2] and dF/dl [N/m]. Twelve to sixteen bits over the usual ranges."""
    law = LAWS[int(rng.integers(len(LAWS)))]
    bits = [int(bit) for bit in rng.integers(12, 17, 3)]
    full = _range(np.max(force))
    stated = str(rng.choice(["all", "noise", "none"], p=[0.7, 0.15, 0.15]))
    within = rng.uniform(-1.0, 1.0, 4) if stated == "all" else np.zeros(4)
    force_step = 2.0 * full / 2 ** bits[0]
    # Inputs less noisy than the force, and converters fine enough for it.
    pressure_step = min(10e5 / 2 ** bits[1], 0.8 * noise / slopes[0])
    length_step = min(0.1 / 2 ** bits[2], 0.8 * noise / slopes[1])
    return Instruments(
        law=law,
        force=noise,
        pressure=min(rng.uniform(0.1, 0.4) * noise / slopes[0], 300.0),
        length=rng.uniform(0.1, 0.4) * noise / slopes[1],
        memory=float(rng.integers(3, 12)),
        force_step=min(force_step, noise),
        pressure_step=pressure_step,
        length_step=length_step,
        stated=stated,
        force_zero=0.4 * noise * within[0],
        force_gain=1e-3 * within[1],
        pressure_zero=200.0 * within[2],
        length_zero=3e-5 * within[3],
    )


def _range(force):
    """The load cell that is bought for this force [N]."""
    return next(size for size in (500.0, 1000.0, 2000.0, 5000.0, 10000.0) if size > 1.05 * force)
