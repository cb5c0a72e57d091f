"""Static force of a muscle as a smooth map of pressure and contraction: equilibria on a grid, quintic splines between them.

The splines run over F/p, V and T/p in (log p, u), contraction = lo + (hi - lo) u^2: nodes are dense where the force of pleats diverges.
The textbook cylinder is differentiated from its volume, V = pi r^2 l with r = sqrt(b^2 - l^2)/(2 pi N): F = -p dV/dl + dU/dl.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.interpolate import RectBivariateSpline

from . import meridian
from .meridian import Body, Rubber
from .section import Cloth, Section

CONTRACTION_NODES = 40
PRESSURE_NODES = 6


class OutsideWindow(ValueError):
    """A hidden effect moved the muscle out of the range of its map."""


@dataclass(frozen=True)
class Shape:
    """Geometry and material as they truly are: the stated ones and all hidden changes. SI."""

    kind: str
    length: float
    radius: float
    end_radius: float
    fibres: float | None = None
    braid_angle: float = 0.0
    ends: str = "clamped"
    crest: float = 0.0
    inner_wall: float = 0.0
    circumference: float | None = None
    misalignment: float = 0.0
    unevenness: float = 0.0
    compliance: float = 0.0
    rubber: tuple | None = None
    cloth: tuple | None = None

    def body(self, excess=0.0):
        """The body of the meridian; `excess` is the relative surplus of fibre length."""
        if self.kind == "pleated":
            fibre, turn = self.length, np.sin(self.misalignment) / self.end_radius
            section = Section(fibres=self.fibres, crest=self.crest, circumference=self.circumference)
            if turn:
                # The stated length is that of the muscle: a fibre that runs askew on the fitting's cylinder is longer.
                fibre = self.length / np.cos(self.misalignment)
        else:
            fibre, turn = self.length / np.cos(self.braid_angle), np.sin(self.braid_angle) / self.radius
            section = Section(wall=self.inner_wall)
        return Body(
            kind=self.kind,
            fibre_length=fibre * (1.0 + excess),
            end_radius=self.end_radius,
            turn=turn,
            section=section,
            stiffness=self._fibre(),
            rubber=self._rubber(),
            cloth=self._cloth(),
        )

    def lengths(self):
        """Relative lengths of uneven fibres in units of their standard deviation, and shares: five Gauss-Hermite nodes."""
        nodes, weights = np.polynomial.hermite_e.hermegauss(5)
        return nodes, weights / weights.sum()

    def _fibre(self):
        return 1.0 / self.compliance if self.compliance else None

    def _cloth(self):
        return Cloth(*self.cloth) if self.cloth else None

    def _rubber(self):
        if self.rubber is None:
            return None
        c10, c01, thickness = self.rubber
        return Rubber(c10, c01, self.radius, thickness, float(np.cos(self.braid_angle)))


@dataclass(frozen=True)
class Window:
    """Range of true pressures [Pa] and contractions that the map covers."""

    pressure: tuple
    contraction: tuple


class ForceMap:
    """Callable F(p, eps) [N]; also slope dF/deps, volume [m^3] and tension across the equator [N]."""

    def __init__(self, shape, window, pressures=PRESSURE_NODES):
        self.window = window
        u = np.linspace(0.0, 1.0, CONTRACTION_NODES)
        lo, hi = window.contraction
        contraction = lo + (hi - lo) * u**2
        nodes = np.geomspace(*window.pressure, pressures)
        p, eps = np.meshgrid(nodes, contraction, indexing="ij")
        force, volume, tension = _grid(shape, p, eps)
        axis = np.log(nodes)
        self._force, self._volume, self._tension = (
            RectBivariateSpline(axis, u, value, kx=4, ky=5) for value in (force / p, volume, tension / p)
        )

    def _place(self, contraction):
        lo, hi = self.window.contraction
        share = (contraction - lo) / (hi - lo)
        if not (np.min(share) > 0.0 and np.max(share) <= 1.0):
            raise OutsideWindow(f"contraction {np.min(contraction)} to {np.max(contraction)} leaves the window {lo} to {hi}")
        return np.sqrt(share)

    def _log(self, pressure):
        lo, hi = self.window.pressure
        if not (np.min(pressure) >= lo and np.max(pressure) <= hi):
            raise OutsideWindow(f"pressure {np.min(pressure)} to {np.max(pressure)} Pa leaves the window {lo} to {hi} Pa")
        return np.log(pressure)

    def __call__(self, pressure, contraction):
        return pressure * self._force.ev(self._log(pressure), self._place(contraction))

    def slope(self, pressure, contraction):
        """dF/deps at constant pressure [N]."""
        lo, hi = self.window.contraction
        u = self._place(contraction)
        return pressure * self._force.ev(self._log(pressure), u, dy=1) / (2.0 * u * (hi - lo))

    def rise(self, pressure, contraction):
        """dF/dp at constant contraction [m^2]."""
        x, u = self._log(pressure), self._place(contraction)
        return self._force.ev(x, u) + self._force.ev(x, u, dx=1)

    def volume(self, pressure, contraction):
        """Enclosed volume [m^3]."""
        return self._volume.ev(self._log(pressure), self._place(contraction))

    def tension(self, pressure, contraction):
        """Axial tension of fibres and wall across the equator, F + p A(r_equator) [N]."""
        return pressure * self._tension.ev(self._log(pressure), self._place(contraction))


@lru_cache(maxsize=256)
def force_map(shape, window, pressures=PRESSURE_NODES):
    """The map of a shape; the same shape is solved once."""
    return ForceMap(shape, window, pressures)


def _grid(shape, p, eps):
    length = shape.length * (1.0 - eps)
    if shape.ends == "cylinder":
        return _cylinder(shape, p, length)
    if shape.unevenness:
        return _uneven(shape, p, length)
    return _solved(shape.body(), p, length)


def _solved(body, p, length):
    """Force, volume and tension; where everything is proportional to the pressure one row is enough."""
    if not body.scales_with_pressure:
        found = meridian.solve(body, p, length)
        return found.force, found.volume, found.tension
    row = meridian.solve(body, np.full(p.shape[1], 1e5), length[0])
    share = p / 1e5
    return row.force * share, np.broadcast_to(row.volume, p.shape), row.tension * share


def _uneven(shape, p, length):
    """Mean over the fibres' lengths: every fibre bulges as it would among its like."""
    nodes, weights = shape.lengths()
    plain = replace(shape, unevenness=0.0)
    parts = [_solved(plain.body(excess=shape.unevenness * node), p, length) for node in nodes]
    return tuple(sum(w * part[k] for w, part in zip(weights, parts)) for k in range(3))


def _cylinder(shape, p, length):
    """The braid as a cylinder; the derivative of volume and rubber energy by the length is a complex step."""
    fibre = shape.length / np.cos(shape.braid_angle)
    turns = fibre * np.sin(shape.braid_angle) / (2.0 * np.pi * shape.radius)
    step = 1e-30
    z = length + 1j * step
    radius = np.sqrt(fibre**2 - z**2) / (2.0 * np.pi * turns)
    volume = np.pi * (radius - shape.inner_wall) ** 2 * z
    force = -p * volume.imag / step
    if shape.rubber is not None:
        c10, c01, thickness = shape.rubber
        a, g = (z / shape.length) ** 2, (radius / shape.radius) ** 2
        energy = c10 * (a + g + 1.0 / (a * g) - 3.0) + c01 * (a * g + 1.0 / a + 1.0 / g - 3.0)
        force = force + (2.0 * np.pi * shape.radius * thickness * shape.length * energy).imag / step
    return force, volume.real, force + p * np.pi * radius.real**2
