"""The muscle on its rig: true pressure, contraction and force along a motion, with hidden hysteresis, and what the sensors would show without noise."""

from dataclasses import dataclass, field

import numpy as np
from simulator import hysteresis
from simulator.hysteresis import Strands

from . import rigs

FAMILIES = (
    "strand-friction",
    "rubber-loss",
    "pressure-hysteresis",
    "pressure-lag",
    "creep",
    "rig-friction",
    "frame-compliance",
    "pressure-zero",
)
"""What can be hidden; each has an amplitude, 0: absent."""
SHARES_LENGTH = ("strand-friction", "rig-friction")
"""What answers the length while it is found: an isotonic test solves for both."""


@dataclass(frozen=True)
class Nature:
    """Constants that no diagnosis knows, drawn once per case. Angles in rad, pressures in Pa, times in s."""

    strands: Strands = Strands(0.006, 1.0, 4e4)
    rig_contact: float = 5e-4
    rubber_order: float = 0.15
    rubber_times: tuple = (0.3, 300.0)
    filling: float = 1e5
    stop_widths: tuple = (1e3, 2e3, 4e3)
    stop_sign: float = 1.0
    creep_time: float = 50.0
    creep_exponent: float = 0.4
    regulator: float = 8.0
    damping: float = 0.6
    frame_give: float = 5e-4


@dataclass
class Record:
    """Row by row: what is (pressure, contraction, force at the muscle) and what the sensors show without noise."""

    motion: rigs.Motion
    pressure: np.ndarray
    contraction: np.ndarray
    force: np.ndarray
    shown_pressure: np.ndarray
    shown_contraction: np.ndarray

    def kept(self, name):
        """A column at the recorded rows."""
        return getattr(self, name)[self.motion.keep]


@dataclass
class World:
    """A hose with hidden effects of these amplitudes (unit by family: see `record`)."""

    hose: object
    nature: Nature
    amplitudes: dict = field(default_factory=dict)

    def amplitude(self, family):
        """Amplitude of a family, 0 if it is absent."""
        return self.amplitudes.get(family, 0.0)

    def record(self, motion):
        """Runs the test.

        Amplitudes: strand-friction, friction coefficient times radius of contact [m]; rubber-loss and creep, share of the force that relaxes;
        pressure-hysteresis, factor on the widths; pressure-lag [s]; rig-friction [N]; frame-compliance, contraction over force [1/N]; pressure-zero [Pa].
        """
        pressure = hysteresis.overshooting(motion.time, motion.pressure, self.nature.regulator, self.nature.damping)
        pressure = np.maximum(pressure, 0.0)
        if motion.contraction is None:
            contraction, resisted = self._carry(motion, pressure)
            force = self.hose.pull(pressure, contraction) - resisted
        else:
            # The frame gives way under the load: the length is not quite held, and the sensor on the muscle sees that.
            full = float(np.max(self.hose.pull(pressure, motion.contraction)))
            contraction = motion.contraction
            for _ in range(3):
                contraction = motion.contraction + self.nature.frame_give * self.hose.pull(pressure, contraction) / full
            force = self.hose.pull(pressure, contraction) - self.resisted(motion, pressure, contraction)
        return self._shown(motion, pressure, contraction, force)

    def _shown(self, motion, pressure, contraction, force):
        shown = pressure + self.amplitude("pressure-zero")
        if self.amplitude("pressure-lag"):
            # The sensor sits at the supply: the muscle is late. So the reading runs ahead of it.
            shown = shown + (pressure - hysteresis.late(motion.time, pressure, self.amplitude("pressure-lag")))
        if self.amplitude("pressure-hysteresis"):
            widths = self.amplitude("pressure-hysteresis") * np.array(self.nature.stop_widths)
            shown = shown - self.nature.stop_sign * widths.mean() * hysteresis.stops(pressure, widths)
        # The length is read at the crosshead: what the load train gives is not seen.
        seen = contraction - self.amplitude("frame-compliance") * force
        return Record(motion, pressure, contraction, force, shown, seen)

    def resisted(self, motion, pressure, contraction):
        """Force that is missing against the static one [N], along a known path."""
        total = self._remembered(motion, pressure, contraction)
        if self.amplitude("strand-friction"):
            angle = self.hose.angle(pressure, contraction)
            moment = self.nature.strands.along(angle, self.level(pressure, angle))
            total = total - self.strand_force(self.hose.angle_slope(pressure, contraction), moment)
        if self.amplitude("rig-friction"):
            rig = self.rig_contact()
            total = total + self.amplitude("rig-friction") * rig.along(contraction[:, None], np.ones((len(contraction), 1)))[:, 0]
        return total

    def _remembered(self, motion, pressure, contraction):
        """Rubber that relaxes after filling, and fibres that creep under their load."""
        total, nature = np.zeros(len(pressure)), self.nature
        if self.amplitude("rubber-loss"):
            drive = self.hose.rubber_force(contraction) * -np.expm1(-((pressure / nature.filling) ** 1.5))
            spectrum = hysteresis.fractional(nature.rubber_order, *nature.rubber_times)
            total = total + self.amplitude("rubber-loss") * hysteresis.relaxing(motion.time, drive, *spectrum)
        if self.amplitude("creep"):
            drive = self.hose.pull(pressure, contraction)
            times, weights = hysteresis.stretched(nature.creep_time, nature.creep_exponent)
            left = hysteresis.relaxing(motion.time, drive, times, weights)
            total = total + self.amplitude("creep") * (weights.sum() * drive - left)
        return total

    def level(self, pressure, angle):
        """Slip limit [N] of the moments per length for a coefficient times radius of contact of 1 m: 4 pi p r."""
        return 4.0 * np.pi * pressure[..., None] * np.sin(angle) / self.hose.shape.body().turn

    def strand_force(self, slope, moment):
        """Change of the force [N] by moments of that level, at the amplitude."""
        return self.amplitude("strand-friction") * self.hose.strand_force(slope, moment)

    def rig_contact(self):
        """Elements of the guide and seals outside the muscle: they follow its length."""
        return Strands(self.nature.rig_contact, 0.6, 1.0)

    def _carry(self, motion, pressure):
        """Contraction that carries the load, and the force that friction takes: row by row, by Newton's method on what sticks and slips.

        Rubber and creep follow the length of the muscle without them, which they change by little; then they are known forces.
        """
        load = motion.load
        start = self._balanced(pressure, load)
        known = self._remembered(motion, pressure, start)
        if not any(self.amplitude(name) for name in SHARES_LENGTH):
            # Where no contraction carries the load it rests on a stop, and the muscle pulls with less.
            return self._balanced(pressure, load + known), known
        return self._sliding(pressure, load + known, known)

    def _balanced(self, pressure, load):
        """Contraction at which the static force is the load, all rows at once."""
        lo, hi = self.hose.map.window.contraction
        contraction = np.full(len(pressure), 0.5 * (lo + hi))
        for _ in range(60):
            miss = self.hose.pull(pressure, contraction) - load
            step = miss / np.minimum(self.hose.slope(pressure, contraction), -1.0)
            contraction = np.clip(contraction - np.clip(step, -0.05, 0.05), lo + 1e-4, hi - 1e-4)
        return contraction

    def _sliding(self, pressure, load, known):
        """Row by row. What is missed falls with the contraction, so Newton's method stays between bounds that close in."""
        contraction, resisted = np.empty(len(pressure)), np.empty(len(pressure))
        x = float(self._balanced(pressure[:1], load[:1])[0])
        rubbing = _Rubbing(self, np.array(pressure[0]), x)
        lo, hi = (bound + side for bound, side in zip(self.hose.map.window.contraction, (1e-4, -1e-4)))
        for i, (p, wanted) in enumerate(zip(pressure, load)):
            p, least, most = np.array(p), lo, hi
            for _ in range(60):
                at = np.array(x)
                taken, stiffness = rubbing.tried(p, x)
                miss = float(self.hose.pull(p, at)) - taken - wanted
                if abs(miss) < 1e-7:
                    break
                least, most = (x, most) if miss > 0.0 else (least, x)
                x -= miss / min(float(self.hose.slope(p, at)) - stiffness, -1e-3)
                if not least < x < most:
                    x = 0.5 * (least + most)
            rubbing.settle()
            contraction[i], resisted[i] = x, taken + known[i]
        return contraction, resisted


class _Rubbing:
    """Strands and the rig's guide while a length is looked for: what they take at a trial contraction, and what stays when it is found."""

    def __init__(self, world, pressure, contraction):
        self.world, self.strands, self.rig = world, world.nature.strands, world.rig_contact()
        self.rubs, self.friction = bool(world.amplitude("strand-friction")), world.amplitude("rig-friction")
        self.contraction, self.contact = contraction, np.zeros((1, hysteresis.ELEMENTS))
        if self.rubs:
            self.angle = world.hose.angle(pressure, np.array(contraction))
            self.moment = np.zeros((len(self.angle), hysteresis.ELEMENTS))
        self.trial = None

    def tried(self, pressure, contraction):
        """Force that is taken [N] and its slope by the contraction."""
        contact, moment, angle = self.contact, None, None
        taken, stiffness = 0.0, 0.0
        if self.friction:
            one = np.ones(1)
            contact = self.rig.moved(contact, np.array([contraction - self.contraction]), one)
            taken += self.friction * contact.sum()
            stiffness += self.friction * float(self.rig.tangent(contact, one)[0])
        if self.rubs:
            at = np.array(contraction)
            angle, turning = self.world.hose.angle(pressure, at), self.world.hose.angle_slope(pressure, at)
            level = self.world.level(pressure, angle)
            moment = self.strands.moved(self.moment, angle - self.angle, level)
            taken -= float(self.world.strand_force(turning, moment.sum(axis=1)))
            stiffness -= float(self.world.strand_force(turning, self.strands.tangent(moment, level) * turning))
        self.trial = contraction, contact, moment, angle
        return taken, stiffness

    def settle(self):
        """The last trial is what happened."""
        self.contraction, self.contact, self.moment, self.angle = self.trial
