"""Equilibrium of the pressurised muscle by minimising its energy: one Ritz method for pleats, braids, rubber and cloth.

Half a muscle is described along its fibre, S = sigma h, 0 <= sigma <= 1, h half the fibre length, sigma = 1 the fitting. A fibre that turns
by kappa per unit of its length (sin(theta) = kappa r while it is not stretched) and is stretched by e(S) advances along the axis by

    x' = sqrt(M - r'^2),   M = (1 + e)^2 - (kappa r)^2        (Pythagoras on hoop, radial and axial steps; ' = d/dS)

Equilibrium at the end distance l makes the potential stationary (the gas does the work p dV, F is the multiplier of the end distance):

    Pi = 2 int [ K e^2/2 + B W(M/c^2, (r/r0)^2) + u(r) sqrt(M) - (p A(r) + F) x' ] h dsigma + F l

K is EA of all fibres together; W is the Mooney-Rivlin energy c10 (I1 - 3) + c01 (I2 - 3) of an incompressible skin whose meridional stretch
is sqrt(M)/c, c = cos(alpha0), and whose hoop stretch is r/r0; B = 2 pi r0 t c its volume per fibre length; u the energy of the cloth per meridian
length; A the area of a cross-section. r(sigma) = r_end + (1 - sigma^2) sum c_k P_k(2 sigma^2 - 1), P_k Legendre; all grid points are
solved at once by Newton's method on the stationarity conditions. Source: principle of virtual work; rubber: Mooney 1940, Rivlin 1948.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from .section import Cloth, Section

QUADRATURE_NODES = 72
RADIUS_TERMS = {"pleated": 20, "braided": 26}
STRETCH_TERMS = {"pleated": 1, "braided": 10}
MAX_STEPS = 40
RESTARTS = 2
TOLERANCE = 1e-10


class NoEquilibrium(RuntimeError):
    """Newton's method did not converge at some point of the grid."""


@dataclass(frozen=True)
class Rubber:
    """Mooney-Rivlin skin: constants [Pa], rest radius [m], thickness [m] and cosine of the braid angle at rest."""

    c10: float
    c01: float
    radius: float
    thickness: float
    cosine: float

    def slopes(self, a, g):
        """First and second derivatives of the energy per fibre length by a and g: W_a, W_g, W_aa, W_gg, W_ag."""
        volume = 2.0 * np.pi * self.radius * self.thickness * self.cosine
        k1, k2 = volume * self.c10, volume * self.c01
        w_a = k1 * (1.0 - 1.0 / (a**2 * g)) + k2 * (g - 1.0 / a**2)
        w_g = k1 * (1.0 - 1.0 / (a * g**2)) + k2 * (a - 1.0 / g**2)
        w_aa = 2.0 * k1 / (a**3 * g) + 2.0 * k2 / a**3
        w_gg = 2.0 * k1 / (a * g**3) + 2.0 * k2 / g**3
        w_ag = k1 / (a * g) ** 2 + k2
        return w_a, w_g, w_aa, w_gg, w_ag


@dataclass(frozen=True)
class Body:
    """All that decides the equilibrium; `stiffness` [N] is EA of all fibres together (or an object whose `pull(e)` gives tension and tangent), None if they do not stretch."""

    kind: str
    fibre_length: float
    end_radius: float
    turn: float
    section: Section
    stiffness: float | None = None
    rubber: Rubber | None = None
    cloth: Cloth | None = None

    @property
    def scales_with_pressure(self):
        """Whether nothing but the pressure sets the scale of the force, so that F/p depends on the length alone."""
        return self.stiffness is None and self.rubber is None and self.cloth is None


@dataclass
class Equilibria:
    """Axial force [N], enclosed volume [m^3], largest radius [m] and axial tension across the equator [N] of each point."""

    force: np.ndarray
    volume: np.ndarray
    equator: np.ndarray
    tension: np.ndarray


class _Basis:
    """Even functions of sigma and their derivatives at the quadrature nodes."""

    def __init__(self, kind, with_stretch):
        nodes, weights = legendre.leggauss(QUADRATURE_NODES)
        self.sigma, self.weights = (nodes + 1.0) / 2.0, weights / 2.0
        s = self.sigma
        count = RADIUS_TERMS[kind]
        polynomials, slopes = _legendre_even(s, count)
        self.value = (1.0 - s[:, None] ** 2) * polynomials
        self.slope = (1.0 - s[:, None] ** 2) * slopes - 2.0 * s[:, None] * polynomials
        self.stretch = _legendre_even(s, STRETCH_TERMS[kind])[0] if with_stretch else np.zeros((len(s), 0))
        self.equator = _legendre_even(np.zeros(1), count)[0][0]

    def fit(self, bulge):
        """Coefficients that reproduce the bulge r - r_end (points x nodes) in the least-squares sense."""
        root = np.sqrt(self.weights)
        return np.linalg.lstsq(self.value * root[:, None], (bulge * root).T, rcond=None)[0].T


@lru_cache(maxsize=4)
def _basis(kind, with_stretch):
    """The functions of a kind of muscle, made once."""
    return _Basis(kind, with_stretch)


def _legendre_even(sigma, count):
    """P_k(2 sigma^2 - 1) and its derivative by sigma for k < count."""
    y = 2.0 * sigma**2 - 1.0
    identity = np.eye(count)
    values = np.stack([legendre.legval(y, row) for row in identity], axis=1)
    slopes = np.stack([legendre.legval(y, legendre.legder(row)) for row in identity], axis=1)
    return values, slopes * (4.0 * sigma)[:, None]


def solve(body, pressure, length):
    """Equilibria at gauge pressures [Pa] > 0 and end distances [m], arrays of one shape. Raises NoEquilibrium."""
    pressure, length = np.broadcast_arrays(np.asarray(pressure, float), np.asarray(length, float))
    basis = _basis(body.kind, body.stiffness is not None)
    unknowns = _unknowns(body, basis, pressure.ravel(), length.ravel())
    return _results(body, basis, pressure.ravel(), unknowns, pressure.shape)


def profile(body, pressure, length):
    """Radii [m] of the equilibria (points x nodes) and the weights that integrate over the fibre, sum 1. `length` is a vector."""
    basis = _basis(body.kind, body.stiffness is not None)
    unknowns = _unknowns(body, basis, np.full(len(length), pressure), length)
    return _fields(body, basis, unknowns)[0], basis.weights


def angles(body, pressure, length, sigma):
    """Angles [rad] between fibre and axis at the places `sigma` along half a fibre, points x places; sin(theta) = kappa r/(1 + e)."""
    basis = _basis(body.kind, body.stiffness is not None)
    unknowns = _unknowns(body, basis, pressure, length)
    count = basis.value.shape[1]
    radius = body.end_radius + unknowns[:, :count] @ ((1.0 - sigma[:, None] ** 2) * _legendre_even(sigma, count)[0]).T
    stretches = basis.stretch.shape[1]
    stretch = unknowns[:, count:-1] @ _legendre_even(sigma, stretches)[0].T if stretches else 0.0
    return np.arcsin(body.turn * radius / (1.0 + stretch))


def _unknowns(body, basis, pressure, length):
    """Solves all points; those that fail start again from their neighbours."""
    unknowns = _first_guess(body, basis, pressure, length)
    unknowns, good = _newton(body, basis, pressure, length, unknowns)
    for _ in range(RESTARTS):
        if good.all():
            return unknowns
        unknowns = _from_neighbours(unknowns, good, pressure, length)
        unknowns[~good], good[~good] = _newton(body, basis, pressure[~good], length[~good], unknowns[~good])
    if not good.all():
        raise NoEquilibrium(f"{np.count_nonzero(~good)} of {good.size} points have no equilibrium, first at length {length[~good][0]} m")
    return unknowns


def _results(body, basis, pressure, unknowns, shape):
    radius, slope, stretch = _fields(body, basis, unknowns)
    advance = np.sqrt((1.0 + stretch) ** 2 - (body.turn * radius) ** 2 - slope**2)
    volume = body.fibre_length * (body.section.area(radius)[0] * advance) @ basis.weights
    force = unknowns[:, -1]
    count = basis.value.shape[1]
    equator = body.end_radius + unknowns[:, :count] @ basis.equator
    tension = force + pressure * body.section.area(equator)[0]
    return Equilibria(*(part.reshape(shape) for part in (force, volume, equator, tension)))


def _first_guess(body, basis, pressure, length):
    """Pleated: a circular arc of the fibre's length. Braided: the cylinder with a boundary layer at the clamp."""
    sigma, half = basis.sigma, body.fibre_length / 2.0
    ratio = length / body.fibre_length
    if body.kind == "pleated":
        angle = _arc_angle(np.minimum(ratio, 1.0 - 1e-6))[:, None]
        bulge = half / angle * (np.cos(angle * sigma) - np.cos(angle))
        force = pressure * half**2 * np.maximum(1.0 - 2.0 * (1.0 - ratio), 0.1)
    else:
        cosine = np.minimum(ratio, 0.9999)
        radius = np.sqrt(1.0 - cosine**2) / body.turn
        width = 0.9 * radius[:, None]
        depth = 1.0 - np.cosh(half * sigma / width) / np.cosh(half / width)
        bulge = (radius - body.end_radius)[:, None] * depth
        force = pressure * np.pi / body.turn**2 * (3.0 * cosine**2 - 1.0)
    extra = basis.stretch.shape[1]
    guess = np.zeros((len(length), basis.value.shape[1] + extra + 1))
    guess[:, : basis.value.shape[1]] = basis.fit(bulge)
    guess[:, -1] = force
    return guess


def _arc_angle(ratio):
    """Half the opening angle psi of an arc with sin(psi)/psi = ratio, by Newton's method from the series."""
    angle = np.sqrt(6.0 * (1.0 - ratio))
    for _ in range(30):
        angle = angle - (np.sin(angle) - ratio * angle) / (np.cos(angle) - ratio)
    return angle


def _from_neighbours(unknowns, good, pressure, length):
    """Replaces the unknowns of points that failed by those of the nearest point that did not."""
    if not good.any():
        raise NoEquilibrium("no point of the grid has an equilibrium")
    where = np.flatnonzero(good)
    result = unknowns.copy()
    for point in np.flatnonzero(~good):
        apart = np.abs(length[where] / length[point] - 1.0) + 0.1 * np.abs(np.log(pressure[where] / pressure[point]))
        nearest = where[np.argmin(apart)]
        result[point] = unknowns[nearest]
        result[point, -1] *= pressure[point] / pressure[nearest]
    return result


def _fields(body, basis, unknowns):
    """Radius, its slope by S, and stretch at the nodes (points x nodes)."""
    count = basis.value.shape[1]
    half = body.fibre_length / 2.0
    coefficients = unknowns[:, :count]
    radius = body.end_radius + coefficients @ basis.value.T
    slope = coefficients @ basis.slope.T / half
    stretch = unknowns[:, count:-1] @ basis.stretch.T if basis.stretch.shape[1] else np.zeros_like(radius)
    return radius, slope, stretch


def _room(body, fields):
    """Smallest squared axial advance of each point: it must stay positive."""
    radius, slope, stretch = fields
    return ((1.0 + stretch) ** 2 - (body.turn * radius) ** 2 - slope**2).min(axis=1)


def _newton(body, basis, pressure, length, unknowns):
    unknowns = unknowns.copy()
    good = np.zeros(len(length), bool)
    count = basis.value.shape[1]
    # A guess may be too steep for the fibre; a flatter one is not.
    for _ in range(60):
        steep = _room(body, _fields(body, basis, unknowns)) < 0.02
        if not steep.any():
            break
        unknowns[steep, :count] *= 0.9
    for _ in range(MAX_STEPS):
        active = np.flatnonzero(~good)
        if active.size == 0:
            break
        # A point that leaves the region where x' is real gives NaN, never converges, and starts again from a neighbour.
        with np.errstate(all="ignore"):
            step = _step(body, basis, pressure[active], length[active], unknowns[active])
        share = np.ones(active.size)
        room = _room(body, _fields(body, basis, unknowns[active]))
        for _ in range(30):
            short = _room(body, _fields(body, basis, unknowns[active] + share[:, None] * step)) < 0.25 * room
            if not short.any():
                break
            share[short] *= 0.6
        unknowns[active] += share[:, None] * step
        small = np.abs(step[:, :count]).max(axis=1) < TOLERANCE * body.end_radius
        still = np.abs(step[:, -1]) < 1e-9 * (np.abs(unknowns[active, -1]) + pressure[active] * body.end_radius**2)
        good[active] = small & still & (share == 1.0)
    return unknowns, good


def _step(body, basis, pressure, length, unknowns):
    """Newton step of all points: solves the symmetric system of stationarity and end distance."""
    fields = _fields(body, basis, unknowns)
    first, second, advance = _density(body, fields, pressure[:, None], unknowns[:, -1:])
    half = body.fibre_length / 2.0
    weights = basis.weights * half
    shapes, stretches = basis.value.shape[1], basis.stretch.shape[1]
    total = shapes + stretches
    points = len(length)
    matrix = np.zeros((points, total + 1, total + 1))
    right = np.zeros((points, total + 1))
    names = ("r", "s", "e")
    # The radius and its slope share their coefficients; the stretch has its own.
    place = {"r": slice(0, shapes), "s": slice(0, shapes), "e": slice(shapes, total)}
    block = {"r": basis.value, "s": basis.slope / half, "e": basis.stretch}
    for a in names:
        right[:, place[a]] -= (first[a] * weights) @ block[a]
        border = (first["x" + a] * weights) @ block[a]
        matrix[:, place[a], -1] -= border
        matrix[:, -1, place[a]] -= border
        for b in names:
            density = second["".join(sorted(a + b))] * weights
            outer = (block[a][:, :, None] * block[b][:, None, :]).reshape(len(weights), -1)
            matrix[:, place[a], place[b]] += (density @ outer).reshape(points, block[a].shape[1], block[b].shape[1])
    right[:, -1] = -(length / 2.0 - (advance * weights).sum(axis=1))
    try:
        return np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError as problem:
        raise NoEquilibrium(f"the equations of a point are singular: {problem}") from problem


def _density(body, fields, pressure, force):
    """First and second derivatives of the energy density by r, s = r', e, the advance x' and its derivatives ("xr", ...)."""
    r, s, e = fields
    turn = body.turn**2
    m = (1.0 + e) ** 2 - turn * r**2
    m_r, m_rr, m_e, m_ee = -2.0 * turn * r, -2.0 * turn, 2.0 * (1.0 + e), 2.0
    advance = np.sqrt(m - s**2)
    f1 = 0.5 / advance
    f2 = -0.25 / advance**3
    q_s = -2.0 * s
    area, area_r, area_rr = body.section.area(r)
    load, load_r, load_rr = pressure * area + force, pressure * area_r, pressure * area_rr
    along = {"xr": f1 * m_r, "xe": f1 * m_e, "xs": f1 * q_s}
    first = {
        "r": -load_r * advance - load * along["xr"],
        "e": -load * along["xe"],
        "s": -load * along["xs"],
        **along,
    }
    second = {
        "rr": -load_rr * advance - 2.0 * load_r * along["xr"] - load * (f2 * m_r**2 + f1 * m_rr),
        "er": -load_r * along["xe"] - load * f2 * m_r * m_e,
        "rs": -load_r * along["xs"] - load * f2 * m_r * q_s,
        "ee": -load * (f2 * m_e**2 + f1 * m_ee),
        "es": -load * f2 * m_e * q_s,
        "ss": -load * (f2 * q_s**2 - 2.0 * f1),
    }
    if body.stiffness is not None:
        pull, tangent = (body.stiffness * e, body.stiffness) if isinstance(body.stiffness, float) else body.stiffness.pull(e)
        first["e"] = first["e"] + pull
        second["ee"] = second["ee"] + tangent
    if body.rubber is not None:
        _add_rubber(body.rubber, first, second, r, m, (m_r, m_rr, m_e, m_ee))
    if body.cloth is not None:
        _add_cloth(body.cloth, first, second, r, m, (m_r, m_rr, m_e, m_ee))
    return first, second, advance


def _add_rubber(rubber, first, second, r, m, chain):
    """B W(a, g) with a, g the squares of the meridional and hoop stretch: I1 = a + g + 1/(a g), I2 = a g + 1/a + 1/g."""
    c = rubber.cosine**2
    a, g = m / c, (r / rubber.radius) ** 2
    m_r, m_rr, m_e, m_ee = chain
    a_r, a_rr, a_e, a_ee = m_r / c, m_rr / c, m_e / c, m_ee / c
    g_r, g_rr = 2.0 * r / rubber.radius**2, 2.0 / rubber.radius**2
    w_a, w_g, w_aa, w_gg, w_ag = rubber.slopes(a, g)
    first["r"] = first["r"] + w_a * a_r + w_g * g_r
    first["e"] = first["e"] + w_a * a_e
    second["rr"] = second["rr"] + w_aa * a_r**2 + 2.0 * w_ag * a_r * g_r + w_gg * g_r**2 + w_a * a_rr + w_g * g_rr
    second["er"] = second["er"] + (w_aa * a_r + w_ag * g_r) * a_e
    second["ee"] = second["ee"] + w_aa * a_e**2 + w_a * a_ee


def _add_cloth(cloth, first, second, r, m, chain):
    """u(r) sqrt(M): hoop energy of the cloth per meridian length, sqrt(M) of it per fibre length."""
    m_r, m_rr, m_e, m_ee = chain
    u, u_r, u_rr = cloth.energy(r)
    h = np.sqrt(m)
    h1, h2 = 0.5 / h, -0.25 / h**3
    first["r"] = first["r"] + u_r * h + u * h1 * m_r
    first["e"] = first["e"] + u * h1 * m_e
    second["rr"] = second["rr"] + u_rr * h + 2.0 * u_r * h1 * m_r + u * (h2 * m_r**2 + h1 * m_rr)
    second["er"] = second["er"] + u_r * h1 * m_e + u * h2 * m_r * m_e
    second["ee"] = second["ee"] + u * (h2 * m_e**2 + h1 * m_ee)
