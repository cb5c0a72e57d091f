"""The simulated test: what the force sensor shows along a path for a muscle with hidden effects on a rig with errors.

The readings of pressure and contraction follow the path (the rig is controlled by its own sensors); what the muscle feels is the reading
without the sensor's errors. So two worlds on one path differ in force alone, and their difference is an effect's signature.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import ndtr

from . import history
from .path import REFERENCE_TEMPERATURE
from .surface import Shape, Window, force_map
from .unknown import UNKNOWN

ATMOSPHERE = 101325.0


@dataclass(frozen=True)
class Nature:
    """Constants that the hidden effects have but no diagnosis knows: drawn once per case."""

    stribeck_ratio: float = 1.05
    stribeck_speed: float = 1e-3
    contact_length: float = 4e-4
    presliding_lengths: tuple = (0.004, 0.012, 0.03)
    viscous_exponent: float = 1.0
    viscous_speed: float = 5e-3
    relaxation_times: tuple = (1.0, 10.0, 100.0)
    relaxation_decades: float = 3.0
    conditioning_loops: float = 1.2
    rubber_ratio: float = 0.1
    cloth_radius: float = 0.05
    threshold_pressure: float = 2e4
    drift_time: float = 3e4
    circumference: float = 0.4
    reference_pressure: float = 2e5
    cycled: bool = True
    specimen_factors: tuple = (0.0,)


@dataclass
class World:
    """Stated muscle, window of the maps, nature, and amplitudes by name: effects, unknown effects, and "length", "radius" [m] off the stated ones."""

    muscle: object
    window: Window
    nature: Nature = Nature()
    amplitudes: dict = field(default_factory=dict)

    def changed(self, changes):
        """The same world with some amplitudes replaced."""
        return replace(self, amplitudes={**self.amplitudes, **changes})

    def amplitude(self, name):
        """Amplitude of an effect, 0 if it is off."""
        return self.amplitudes.get(name, 0.0)

    def shape(self):
        """True geometry and material."""
        m, a, nature = self.muscle, self.amplitude, self.nature
        radius = m.radius + a("radius")
        common = {
            "kind": m.kind,
            "length": m.length + a("length"),
            "radius": radius,
            "end_radius": radius + a("end-radius"),
            "compliance": a("fibre-stretch"),
        }
        if m.kind == "pleated":
            return Shape(
                **common,
                fibres=m.fibres + a("fibre-count"),
                crest=a("pleat-depth"),
                circumference=nature.circumference if a("lobes") else None,
                misalignment=a("fibre-misalignment"),
                unevenness=a("uneven-fibres"),
                cloth=(a("limited-unfolding"), nature.cloth_radius) if a("limited-unfolding") else None,
            )
        angle = m.braid_angle + a("braid_angle") + a("braid-angle-error")
        ends = "clamped" if a("end-taper") else m.ends
        return Shape(**common, braid_angle=angle, ends=ends, inner_wall=a("wall-thickness"), rubber=self._rubber())

    def _rubber(self):
        c10, c01 = self.muscle.bladder or (0.0, 0.0)
        more = self.amplitude("bladder-elasticity")
        c10, c01 = c10 + more, c01 + self.nature.rubber_ratio * more
        return (c10, c01, self.muscle.wall) if c10 else None

    def force(self, path):
        """Reading of the force sensor along the path [N], without noise."""
        static = force_map(self.shape(), self.window)
        contraction = self._true_contraction(path)
        pressure = self._true_pressure(path, static, contraction)
        contraction = self._yielding(static, pressure, contraction)
        force = self._wall(path, static(pressure, contraction), pressure, contraction)
        force = force + self._unknown(path, static, force, pressure, contraction)
        force = force - self._dissipation(path, static, force, pressure, contraction)
        force = self._later(path, force, pressure)
        return self._sensor(path, force)

    def _true_pressure(self, path, static, contraction):
        """From the reading to the pressure that acts on the wall."""
        a, nature = self.amplitude, self.nature
        pressure = (path.pressure - a("pressure-offset")) / (1.0 + a("pressure-gain"))
        if a("regulator-lag"):
            volume = np.log(static.volume(pressure, contraction))
            pressure = history.regulated(path, pressure, volume, a("regulator-lag"), ATMOSPHERE)
        if a("pressure-threshold"):
            pressure = pressure - a("pressure-threshold") * -np.expm1(-pressure / nature.threshold_pressure)
        return pressure

    def _wall(self, path, force, pressure, contraction):
        """The static force with what the wall bears along the axis, and has more of while it is virgin."""
        a, nature = self.amplitude, self.nature
        if a("stress-softening"):
            force = force + a("stress-softening") * np.exp(-path.travel / nature.conditioning_loops) * self._softens(
                force, pressure, contraction
            )
        return force + a("membrane-axial") * np.log(np.maximum(1.0 - contraction, 0.1))

    def _later(self, path, force, pressure):
        """What time, warmth and the specimen change."""
        a, nature = self.amplitude, self.nature
        if a("creep"):
            given = history.relaxed(path, nature.relaxation_times, nature.relaxation_decades)
            force = force - a("creep") * pressure / nature.reference_pressure * given
        if a("temperature"):
            force = force * (1.0 + a("temperature") * (path.temperature - REFERENCE_TEMPERATURE))
        if a("specimen-spread"):
            factors = np.array(nature.specimen_factors)[(path.specimen - 1) % len(nature.specimen_factors)]
            force = force * (1.0 + a("specimen-spread") * factors)
        return force

    def _true_contraction(self, path):
        """From the reading (based on the stated length, shifted and stretched by the sensor) to the muscle's own."""
        a, stated = self.amplitude, self.muscle.length
        shortening = stated * path.contraction / (1.0 + a("displacement-gain")) - a("length-zero-error")
        return 1.0 - (stated - shortening) / (stated + a("length"))

    def _yielding(self, static, pressure, contraction):
        """True contraction where frame and fittings give way under the load: eps = reading + k F + k_end T, solved by Newton's method."""
        frame, end = (self.amplitude(name) / self.muscle.length for name in ("frame-compliance", "end-slip"))
        if not frame and not end:
            return contraction
        found = contraction
        for _ in range(5):
            load, pull = static(pressure, found), static.tension(pressure, found)
            miss = found - contraction - frame * load - end * pull
            # The tension across the equator changes with the contraction about as the force does.
            found = found - miss / (1.0 - (frame + end) * static.slope(pressure, found))
        return found

    def _softens(self, force, pressure, contraction):
        """What a virgin muscle has more of: the part of its rubber, or without rubber the whole force."""
        if self.muscle.bladder is None:
            return force
        bare = force_map(replace(self.shape(), rubber=None), self.window)
        return force - bare(pressure, contraction)

    def _unknown(self, path, static, force, pressure, contraction):
        total = 0.0
        for name, (function, _) in UNKNOWN.items():
            if self.amplitude(name):
                total = total + self.amplitude(name) * function(path, force, static.slope(pressure, contraction), pressure)
        return total

    def _dissipation(self, path, static, force, pressure, contraction):
        """All that resists the motion; shortening is resisted by a smaller force."""
        a, nature = self.amplitude, self.nature
        total = 0.0
        sliding = a("coulomb-friction") + a("pressure-friction") * pressure + a("force-friction") * np.abs(force)
        if np.any(sliding):
            level = history.stribeck(path.rate, nature.stribeck_ratio, nature.stribeck_speed)
            total = total + sliding * level * history.dahl(path, contraction, nature.contact_length, nature.cycled)
        if a("presliding-hysteresis"):
            states = [history.dahl(path, contraction, delta, nature.cycled) for delta in nature.presliding_lengths]
            total = total + a("presliding-hysteresis") * np.mean(states, axis=0)
        if a("viscous-damping"):
            total = total + a("viscous-damping") * history.viscous(path.rate, nature.viscous_exponent, nature.viscous_speed)
        return total

    def _sensor(self, path, force):
        a = self.amplitude
        if a("low-load-slack"):
            # Fibres go slack one after the other: the mean of max(f, 0) over normally distributed loads f of the fibres.
            share = force / a("low-load-slack")
            force = force * ndtr(share) + a("low-load-slack") * np.exp(-0.5 * share**2) / np.sqrt(2.0 * np.pi)
        if a("force-lag"):
            force = history.lag(path, force, a("force-lag"))
        reading = force * (1.0 + a("force-gain")) + a("force-nonlinearity") * force**2 + a("force-offset")
        if a("force-drift"):
            settle = self.nature.drift_time
            reading = reading - a("force-drift") * settle * np.expm1(-path.time / settle)
        return reading
