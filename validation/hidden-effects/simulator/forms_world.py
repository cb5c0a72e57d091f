"""The simulated test of `world.py` in which effects may act in another form, with five more effects of exact formula."""

from dataclasses import dataclass, field, fields, replace

import numpy as np

from .forms import State
from .forms_motion import dahl
from .forms_time import loops
from .forms_wall import FormedShape
from .world import World

ALIAS = {"length": "fibre-length", "radius": "radius-error"}
"""Errors of the stated geometry, and the effect that is the same beyond its width."""


@dataclass
class FormsWorld(World):
    """`forms` holds the form that an effect acts in; the others act by the formulas of `World`.

    `sliding` is "dahl" or "sign", friction without build-up and none at rest; `heating` the time of self-heating over the session; `creep` grows with the
    "pressure" or with nothing but the logarithm of the time, "alone".
    """

    forms: dict = field(default_factory=dict)
    sliding: str = "dahl"
    heating: float = 0.25
    creep: str = "pressure"

    def amplitude(self, name):
        """Amplitude for the usual formula: 0 where the effect has a form."""
        if name in self.forms:
            return 0.0
        return super().amplitude(name) + (super().amplitude(ALIAS[name]) if name in ALIAS else 0.0)

    def size(self, name):
        """Amplitude of an effect, in whatever form."""
        return self.amplitudes.get(name, 0.0)

    def usual(self):
        """The same world without forms."""
        return replace(self, forms={})

    def formed(self, form, amplitude):
        """The world with one more effect in a form."""
        return replace(
            self, forms={**self.forms, form.form.effect: form}, amplitudes={**self.amplitudes, form.form.effect: amplitude}
        )

    def _acting(self, stage):
        return [(self.size(name), one) for name, one in self.forms.items() if one.form.stage == stage and self.size(name)]

    def shape(self):
        plain = super().shape()
        changes = {}
        for amplitude, one in self._acting("shape"):
            changes.update(one.form.act(self, amplitude, one.constants))
        if not changes:
            return plain
        return FormedShape(**{**{entry.name: getattr(plain, entry.name) for entry in fields(plain)}, **changes})

    def _state(self, path, static, pressure, contraction, force=None):
        return State(path, static, pressure, contraction, force, None, self.muscle)

    def _true_pressure(self, path, static, contraction):
        pressure = super()._true_pressure(path, static, contraction)
        for amplitude, one in self._acting("pressure"):
            pressure = pressure + one.act(self._state(path, static, pressure, contraction), amplitude)
        if self.amplitude("pressure-lag"):
            pressure = pressure + self.amplitude("pressure-lag") * self._state(path, static, pressure, contraction).rates(pressure)
        if self.amplitude("pressure-hysteresis"):
            pressure = pressure + self.amplitude("pressure-hysteresis") * dahl(path, pressure, 1e4, 1.0)
        if self.amplitude("line-drop"):
            pressure = pressure * (1.0 - self.amplitude("line-drop"))
        return pressure

    def _yielding(self, static, pressure, contraction):
        found = super()._yielding(static, pressure, contraction)
        giving = self._acting("give")
        if not giving:
            return found
        start = found
        for _ in range(6):
            miss, slope = found - start, 1.0
            for amplitude, one in giving:
                load = static(pressure, found) if one.form.effect == "frame-compliance" else static.tension(pressure, found)
                step = 1e-4 * np.abs(load) + 1e-6
                low, high = (one.form.act(load + side * step, amplitude / self.muscle.length, one.constants) for side in (-1.0, 1.0))
                miss = miss - 0.5 * (low + high)
                # The tension across the equator changes with the contraction about as the force does.
                slope = slope - (high - low) / (2.0 * step) * static.slope(pressure, found)
            found = found - miss / slope
        return found

    def _wall(self, path, force, pressure, contraction):
        virgin = self.amplitude("stress-softening")
        if virgin:
            # Along the loops of each run, as the catalogue has it: it is a rival.
            force = force + virgin * np.exp(-loops(path, pressure) / self.nature.conditioning_loops) * self._softens(force, pressure, contraction)
        force = self.changed({"stress-softening": 0.0})._plain_wall(path, force, pressure, contraction)
        state = self._state(path, None, pressure, contraction, force)
        total = 0.0
        for amplitude, one in self._acting("wall"):
            if one.form.effect == "stress-softening":
                state.bare = self._softens(force, pressure, contraction)
            total = total + one.act(state, amplitude)
        if self.amplitude("bladder-prestrain"):
            total = total + self._prestrain(contraction)
        return force + total

    def _plain_wall(self, path, force, pressure, contraction):
        return super()._wall(path, force, pressure, contraction)

    def _prestrain(self, contraction):
        """2 pi r0 tau (2 l2 - 1) dl2/dl1 on a cylinder, as the catalogue has it: it is a rival."""
        angle, l1 = self.muscle.braid_angle, 1.0 - contraction
        l2 = np.sqrt(1.0 - (l1 * np.cos(angle)) ** 2) / np.sin(angle)
        return self.amplitude("bladder-prestrain") * 2.0 * np.pi * self.muscle.radius * (2.0 * l2 - 1.0) * -l1 / (np.tan(angle) ** 2 * l2)

    def _dissipation(self, path, static, force, pressure, contraction):
        if self.sliding == "sign":
            a = self.amplitude
            total = (a("coulomb-friction") + a("pressure-friction") * pressure + a("force-friction") * np.abs(force)) * np.sign(path.rate)
        else:
            total = super()._dissipation(path, static, force, pressure, contraction)
        state = self._state(path, static, pressure, contraction, force)
        for amplitude, one in self._acting("motion"):
            total = total - one.act(state, amplitude)
        return total

    def _later(self, path, force, pressure):
        before = force
        if self.creep == "alone":
            force = force - self.amplitude("creep") * np.log10(1.0 + path.since_start)
        else:
            force = super()._later(path, force, pressure)
        if self.amplitude("self-heating"):
            force = force + self.amplitude("self-heating") * before * -np.expm1(-path.time / (self.heating * path.time[-1]))
        for amplitude, one in self._acting("later"):
            force = force + one.act(self._state(path, None, pressure, path.contraction, before), amplitude)
        return force

    def _sensor(self, path, force):
        acting = {one.form.effect: (amplitude, one) for amplitude, one in self._acting("reading")}
        for name in ("low-load-slack", "force-lag"):
            if name in acting:
                amplitude, one = acting[name]
                force = force + one.act(self._state(path, None, path.pressure, path.contraction, force), amplitude)
        reading = super()._sensor(path, force)
        if "force-nonlinearity" in acting:
            amplitude, one = acting["force-nonlinearity"]
            reading = reading + one.act(self._state(path, None, path.pressure, path.contraction, force), amplitude)
        return reading
