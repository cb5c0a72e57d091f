"""Cross-sections (enclosed area as a function of the fibre radius) and the cloth that is stretched in hoop direction."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Section:
    """Enclosed area A(r) [m^2].

    Circle: pi (r - wall)^2, `wall` a layer of constant thickness inside the braid. n fibres: the polygon through crests at r + crest,
    and if a circumference [m] of cloth that does not stretch is given, the lobes between neighbouring fibres (see `_lobed`).
    """

    fibres: float | None = None
    crest: float = 0.0
    wall: float = 0.0
    circumference: float | None = None

    def area(self, r):
        """A and its first two derivatives by r."""
        if self.fibres is None:
            inner = r - self.wall
            return np.pi * inner**2, 2.0 * np.pi * inner, np.full_like(inner, 2.0 * np.pi)
        if self.circumference is not None:
            return self._lobed(r)
        outer = r + self.crest
        factor = 0.5 * self.fibres * np.sin(2.0 * np.pi / self.fibres)
        return factor * outer**2, 2.0 * factor * outer, np.full_like(outer, 2.0 * factor)

    def _lobed(self, r):
        """Cloth of length s = circumference/n between two fibres, 2 w apart: an arc of half angle t with sin(t)/t = 2 w/s.

        More cloth than a half circle needs stands as two radial walls of height h below a half circle at r + h: s = 2 h + pi (w + h sin(pi/n)).
        Where the cloth is too short for its chord it is taut; the muscle does not get there. Derivatives by differences of the exact area.
        """
        step = 1e-5 * np.max(r)
        low, mid, high = (self._lobed_area(r + k * step) for k in (-1.0, 0.0, 1.0))
        return mid, (high - low) / (2.0 * step), (high - 2.0 * mid + low) / step**2

    def _lobed_area(self, r):
        n, angle = self.fibres, np.pi / self.fibres
        arc = self.circumference / n
        height = np.maximum((arc / 2.0 - 0.5 * np.pi * r * np.sin(angle)) / (1.0 + 0.5 * np.pi * np.sin(angle)), 0.0)
        outer = r + height
        width = outer * np.sin(angle)
        available = np.minimum(arc - 2.0 * height, np.pi * width)
        half = _arc_half_angle(np.clip(2.0 * width / available, 2.0 / np.pi, 1.0 - 1e-9))
        radius = available / (2.0 * half)
        lobe = radius**2 * (half - np.sin(half) * np.cos(half))
        return n * (0.5 * np.sin(2.0 * angle) * outer**2 + lobe)


def _arc_half_angle(ratio):
    """t in (0, pi/2] with sin(t)/t = ratio, Newton's method from the series."""
    t = np.sqrt(6.0 * (1.0 - ratio)) * (1.0 + 0.15 * (1.0 - ratio))
    for _ in range(12):
        t = t - (np.sin(t) - ratio * t) / (np.cos(t) - ratio)
    return t


@dataclass(frozen=True)
class Cloth:
    """Cloth that has unfolded at radius `unfolded` [m] and then stretches with the hoop stiffness [N/m].

    Energy per meridian length k (2 pi)^2 q(r)^2/(4 pi r_u), q = r - r_u softened over 0.2 % of r_u: threads do not tighten all at once.
    """

    stiffness: float
    unfolded: float

    def energy(self, r):
        """u and its first two derivatives by r."""
        width = 0.002 * self.unfolded
        z = np.clip((r - self.unfolded) / width, -60.0, 60.0)
        excess = width * np.logaddexp(0.0, z)
        rate = 1.0 / (1.0 + np.exp(-z))
        bend = rate * (1.0 - rate) / width
        factor = np.pi * self.stiffness / self.unfolded
        return factor * excess**2, 2.0 * factor * excess * rate, 2.0 * factor * (rate**2 + excess * bend)
