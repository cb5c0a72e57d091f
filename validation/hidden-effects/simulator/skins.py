"""Energies of rubber skins, laws of fibres and energies of cloth beyond those of `meridian.py` and `section.py`: what forms put into the equilibrium.

Skins are functions of a, g, the squares of the meridional and hoop stretch, per fibre length of volume B = 2 pi r0 t cos(alpha0); c10 is half the
shear modulus at rest of each. I1 = a + g + 1/(a g):

    Yeoh 1993       c10 x + c20 x^2 + c30 x^3,  x = I1 - 3
    Gent 1996       -c10 J ln(1 - x/J)
    Ogden 1972      sum of 4 c_i/alpha_i^2 (a^(alpha_i/2) + g^(alpha_i/2) + (a g)^(-alpha_i/2) - 3),  c_i shares of c10
    prestretched    neo-Hooke at g s^2: the bladder was s times narrower than the braid
    thick           neo-Hooke in layers: the radius of a layer follows from the volume inside the braid
    stiffening      hoop modulus E = 6 c10: E/2 (l - 1)^2 + E b/3 (l - 1)^3,  l = sqrt(g)
"""

from dataclasses import dataclass

import numpy as np

LAYERS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
LAYERS, SHARES = (LAYERS + 1.0) / 2.0, _WEIGHTS / 2.0


@dataclass(frozen=True)
class Skin:
    """A skin of one law: constant c10 [Pa], rest radius [m], thickness [m], cosine of the braid angle at rest, and what the law has beside."""

    law: str
    c10: float
    radius: float
    thickness: float
    cosine: float
    more: tuple = ()

    def slopes(self, a, g):
        """Derivatives of the energy per fibre length: W_a, W_g, W_aa, W_gg, W_ag."""
        volume = 2.0 * np.pi * self.radius * self.thickness * self.cosine
        return tuple(volume * self.c10 * part for part in _LAWS[self.law](self, a, g, *self.more))


def _first_invariant(a, g, w1, w2):
    """Of W(x), with W' = w1(x), W'' = w2(x)."""
    x = a + g + 1.0 / (a * g) - 3.0
    i_a, i_g = 1.0 - 1.0 / (a**2 * g), 1.0 - 1.0 / (a * g**2)
    w1, w2 = w1(x), w2(x)
    return (
        w1 * i_a,
        w1 * i_g,
        w1 * 2.0 / (a**3 * g) + w2 * i_a**2,
        w1 * 2.0 / (a * g**3) + w2 * i_g**2,
        w1 / (a * g) ** 2 + w2 * i_a * i_g,
    )


def _yeoh(skin, a, g, c20, c30):
    return _first_invariant(a, g, lambda x: 1.0 + 2.0 * c20 * x + 3.0 * c30 * x**2, lambda x: 2.0 * c20 + 6.0 * c30 * x)


def _gent(skin, a, g, limit):
    # Newton's method may try states beyond the limit: there the stiffness stays that of 95 % of it.
    def share(x):
        return 1.0 - np.minimum(x, 0.95 * limit) / limit

    return _first_invariant(a, g, lambda x: 1.0 / share(x), lambda x: 1.0 / (limit * share(x) ** 2))


def _ogden(skin, a, g, *terms):
    total = [0.0] * 5
    for share, alpha in zip(terms[::2], terms[1::2]):
        k, h = 4.0 * share / alpha**2, alpha / 2.0
        mixed = (a * g) ** -h
        parts = (
            k * h * (a**h - mixed) / a,
            k * h * (g**h - mixed) / g,
            k * h * ((h - 1.0) * a**h + (h + 1.0) * mixed) / a**2,
            k * h * ((h - 1.0) * g**h + (h + 1.0) * mixed) / g**2,
            k * h**2 * mixed / (a * g),
        )
        total = [before + part for before, part in zip(total, parts)]
    return tuple(total)


def _neo_hooke(a, g):
    return _first_invariant(a, g, lambda x: 1.0 + 0.0 * x, lambda x: 0.0 * x)


def _prestretched(skin, a, g, stretch):
    s = stretch**2
    w_a, w_g, w_aa, w_gg, w_ag = _neo_hooke(a, s * g)
    return w_a, s * w_g, w_aa, s**2 * w_gg, s * w_ag


def _thick(skin, a, g, c01):
    """Layers between braid and inner wall: r_i^2 = r^2 - (r0^2 - rho^2)/sqrt(a) keeps the volume outside of each."""
    total = [0.0] * 5
    outside = skin.radius**2
    rest = [(skin.radius - share * skin.thickness) ** 2 for share in LAYERS]
    mean = sum(weight * np.sqrt(one) for weight, one in zip(SHARES, rest))
    for weight, inside in zip(SHARES, rest):
        k, q = outside / inside, 1.0 - inside / outside
        h = k * (g - q / np.sqrt(a))
        h_a, h_aa = k * q / (2.0 * a**1.5), -0.75 * k * q / a**2.5
        w_a, w_h, w_aa, w_hh, w_ah = _neo_hooke(a, h)
        w_a, w_h = w_a + c01 * (h - 1.0 / a**2), w_h + c01 * (a - 1.0 / h**2)
        w_aa, w_hh, w_ah = w_aa + 2.0 * c01 / a**3, w_hh + 2.0 * c01 / h**3, w_ah + c01
        share = weight * np.sqrt(inside) / mean
        parts = (w_a + w_h * h_a, w_h * k, w_aa + 2.0 * w_ah * h_a + w_hh * h_a**2 + w_h * h_aa, w_hh * k**2, (w_ah + w_hh * h_a) * k)
        total = [before + share * part for before, part in zip(total, parts)]
    return tuple(total)


def _stiffening(skin, a, g, rise):
    stretch = np.sqrt(g)
    excess = stretch - 1.0
    slope, bend = 6.0 * (excess + rise * excess**2), 6.0 * (1.0 + 2.0 * rise * excess)
    return 0.0 * a, slope / (2.0 * stretch), 0.0 * a, (bend - slope / stretch) / (4.0 * g), 0.0 * a


_LAWS = {"yeoh": _yeoh, "gent": _gent, "ogden": _ogden, "prestretched": _prestretched, "thick": _thick, "stiffening": _stiffening}


@dataclass(frozen=True)
class Fibre:
    """Tension of all fibres over their strain e, odd in e; EA at rest is `stiffness` [N], `strain` the scale of the bend.

    toe: EA (e - s e1 (1 - exp(-e/e1))); stiffening: EA e (1 + s e/e1); degressive: EA e1 ln(1 + e/e1)/1.
    """

    law: str
    stiffness: float
    strain: float
    share: float = 0.0

    def pull(self, e):
        """Tension [N] and tangent [N]."""
        size, one = np.abs(e), self.strain
        if self.law == "toe":
            fade = self.share * np.exp(-size / one)
            value, tangent = size - one * (self.share - fade), 1.0 - fade
        elif self.law == "stiffening":
            value, tangent = size * (1.0 + self.share * size / one), 1.0 + 2.0 * self.share * size / one
        else:
            value, tangent = one * np.log1p(size / one), 1.0 / (1.0 + size / one)
        return self.stiffness * np.sign(e) * value, self.stiffness * tangent


@dataclass(frozen=True)
class Weave:
    """Cloth of hoop stiffness K [N/m] that is taut beyond `unfolded` [m], by law; energy per meridian length from q, the softened excess of the radius.

    late: q softened over a share w of the radius; power: f q^2.5/sqrt(w r_u); exponential: 2 f (w r_u)^2 (exp(q/(w r_u)) - 1 - q/(w r_u)); f = pi K/r_u.
    two: half of the threads is taut at r_u, half at (1 + w) r_u.
    """

    law: str
    stiffness: float
    unfolded: float
    width: float

    def energy(self, r):
        """u and its first two derivatives by r."""
        factor = np.pi * self.stiffness / self.unfolded
        if self.law == "two":
            first, second = (_excess(r, onset, 0.002) for onset in (self.unfolded, self.unfolded * (1.0 + self.width)))
            return tuple(0.5 * factor * (x + y) for x, y in zip(_square(*first), _square(*second)))
        q, rate, bend = _excess(r, self.unfolded, self.width if self.law == "late" else 0.002)
        if self.law == "late":
            return tuple(factor * part for part in _square(q, rate, bend))
        scale = self.width * self.unfolded
        if self.law == "power":
            u, u_q, u_qq = q**2.5, 2.5 * q**1.5, 3.75 * np.sqrt(q)
            u, u_q, u_qq = (factor / np.sqrt(scale) * part for part in (u, u_q, u_qq))
        else:
            # Newton's method may try radii far beyond: there the cloth stays as stiff as at six times the scale.
            z = np.minimum(q / scale, 6.0)
            u, u_q, u_qq = 2.0 * factor * scale**2 * (np.expm1(z) - z), 2.0 * factor * scale * np.expm1(z), 2.0 * factor * np.exp(z)
        return u, u_q * rate, u_qq * rate**2 + u_q * bend


def _excess(r, onset, width):
    """Softened r - onset and its derivatives."""
    scale = width * onset
    z = np.clip((r - onset) / scale, -60.0, 60.0)
    rate = 1.0 / (1.0 + np.exp(-z))
    return scale * np.logaddexp(0.0, z), rate, rate * (1.0 - rate) / scale


def _square(q, rate, bend):
    return q**2, 2.0 * q * rate, 2.0 * (rate**2 + q * bend)
