"""The muscles of the laboratories, and what of them the tests need: force, slopes, the rubber's part, and the angles of the fibres, as splines."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.interpolate import RectBivariateSpline
from simulator import meridian
from simulator.meridian import NoEquilibrium
from simulator.muscle import Muscle
from simulator.surface import Shape, Window, force_map

PRESSURE_NODES = 14
"""Of the splines: below 0.01 % between the nodes (`check.py`)."""
ANGLE_NODES = 24
PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(5)
PLACES, SHARES = (PLACES + 1.0) / 2.0, _WEIGHTS / 2.0
"""Places along half a fibre where strands rub, 1 the fitting, and the share of the fibre that each stands for."""
LOWEST = (0.8e5, 1.2e5, 1.6e5)
"""Lowest pressures of the map that are tried: below it rubber carries the load, the net goes slack, and the force is extended along its tangent."""
HIGHEST = {"braided": 6.6e5, "pleated": 3.4e5}
CONTRACTION = {"braided": (-0.02, 0.205), "pleated": (0.02, 0.36)}
SLACK = 1.5
"""A muscle that would push buckles: the force [N] over which it gives way."""


@dataclass(frozen=True)
class Hose:
    """A muscle as stated (which is as it is), and its maps."""

    muscle: Muscle

    @property
    def shape(self):
        """Geometry and material for the equilibrium."""
        m = self.muscle
        rubber = (*m.bladder, m.wall) if m.bladder else None
        compliance = 1.0 / (m.fibres * m.fibre_stiffness) if m.fibre_stiffness else 0.0
        angle = m.braid_angle or 0.0
        return Shape(m.kind, m.length, m.radius, m.radius, m.fibres, angle, compliance=compliance, rubber=rubber)

    @property
    def map(self):
        """Force over pressure and contraction, without anything that remembers."""
        return _maps(self.shape)[0]

    @property
    def lowest(self):
        """Lowest pressure of the map [Pa]."""
        return self.map.window.pressure[0]

    def pull(self, pressure, contraction):
        """Static force [N] of a muscle that may buckle or hang slack: below the map's pressures its tangent, never much below 0."""
        force = self.tangent(pressure, contraction)
        return SLACK * np.logaddexp(0.0, force / SLACK)

    def tangent(self, pressure, contraction):
        """Static force [N] of a net that never goes slack; below the map's pressures its tangent."""
        inside = np.maximum(pressure, self.lowest)
        return self.map(inside, contraction) + (pressure - inside) * self.map.rise(inside, contraction)

    def slope(self, pressure, contraction):
        """dF/deps [N] at constant pressure, of the muscle that may buckle."""
        inside = np.maximum(pressure, self.lowest)
        taut = 1.0 / (1.0 + np.exp(-np.clip(self.tangent(pressure, contraction) / SLACK, -60.0, 60.0)))
        return taut * self.map.slope(inside, contraction)

    def rubber_force(self, contraction):
        """What the bladder takes from the force [N] where the net is taut, at 3 bar: it hardly depends on the pressure."""
        at = np.full_like(contraction, 3e5)
        return _maps(self.shape)[1](at, contraction) - self.map(at, contraction)

    def angle(self, pressure, contraction):
        """Angles [rad] between fibre and axis at the places (rows x places)."""
        return self._angles(pressure, contraction, 0)

    def angle_slope(self, pressure, contraction):
        """Their derivatives by the contraction."""
        return self._angles(pressure, contraction, 1)

    def _angles(self, pressure, contraction, order):
        x = np.log(np.maximum(pressure, self.lowest))
        return np.stack([spline.ev(x, contraction, dy=order) for spline in _maps(self.shape)[2]], axis=-1)

    def strand_force(self, angle_slope, moment):
        """Force [N] of friction moments per length [N] at the places: -(1/l0) int m dtheta/deps ds over the fibre."""
        fibre = self.shape.body().fibre_length
        return -(fibre / self.muscle.length) * (angle_slope * moment * SHARES).sum(axis=-1)


@lru_cache(maxsize=32)
def _maps(shape):
    """The map, that without rubber, and the splines of the angles, from the lowest pressure at which all equilibria are found."""
    for lowest in LOWEST:
        window = Window((lowest, HIGHEST[shape.kind]), CONTRACTION[shape.kind])
        try:
            full = force_map(shape, window, PRESSURE_NODES)
            bare = force_map(replace(shape, rubber=None), window, PRESSURE_NODES) if shape.rubber else full
            return full, bare, _angle_splines(shape, window)
        except NoEquilibrium as problem:
            last = problem
    raise last


def _angle_splines(shape, window):
    if shape.kind == "pleated":
        return []
    pressure = np.geomspace(*window.pressure, PRESSURE_NODES)
    contraction = np.linspace(*window.contraction, ANGLE_NODES)
    p, eps = (part.ravel() for part in np.meshgrid(pressure, contraction, indexing="ij"))
    angles = meridian.angles(shape.body(), p, shape.length * (1.0 - eps), PLACES)
    return [RectBivariateSpline(np.log(pressure), contraction, column.reshape(len(pressure), -1)) for column in angles.T]


@lru_cache(maxsize=4)
def hoses(seed):
    """The muscles of one suite: four hoses with rubber, four thin nets, two pleated; stretching fibres in half of them."""
    rng = np.random.default_rng([seed, 77])
    return tuple(Hose(_braid(rng, i)) for i in range(8)) + tuple(Hose(_pleats(rng, i)) for i in range(2))


def _braid(rng, number):
    rubber, stretches = number < 4, number % 2 == 0
    radius = round(rng.uniform(7e-3, 11e-3), 4)
    c10 = round(rng.uniform(0.1e6, 0.28e6), -3)
    return Muscle(
        name=f"hose {'abcdefgh'[number]}",
        kind="braided",
        length=round(radius * rng.uniform(16.0, 30.0), 3),
        radius=radius,
        fibres=int(rng.integers(80, 140)) if stretches else None,
        braid_angle=np.radians(round(rng.uniform(22.0, 27.0), 1)),
        wall=round(radius * rng.uniform(0.12, 0.19), 4) if rubber else None,
        bladder=(c10, round(0.1 * c10, -3)) if rubber else None,
        fibre_stiffness=round(rng.uniform(3e3, 6e3), -2) if stretches else None,
    )


def _pleats(rng, number):
    radius = round(rng.uniform(12e-3, 17e-3), 4)
    return Muscle(
        name=f"pleated {'ab'[number]}",
        kind="pleated",
        length=round(radius * rng.uniform(6.0, 8.5), 3),
        radius=radius,
        fibres=int(rng.integers(30, 60)),
    )
