"""Forms of what the wall bears: bladder, axial stiffness, prestrain, fibres, cloth.

Those of stage `shape` return parts of a `FormedShape`; the equilibrium is solved with them (`skins.py`). Membrane along the axis: neo-Hookean
compression; folds that buckle; rubber that stiffens. Prestrain: forces of a hoop energy u(l2) on the cylinder, l2 the hoop stretch of a braid.
"""

from dataclasses import dataclass

import numpy as np

from .forms import Form
from .skins import Fibre, Skin, Weave
from .surface import Shape


@dataclass(frozen=True)
class FormedShape(Shape):
    """A shape with other laws than the usual ones: constants of a skin, a fibre, a cloth; relative lengths of uneven fibres and their shares."""

    skin: tuple | None = None
    fibre: Fibre | None = None
    weave: Weave | None = None
    spread: tuple | None = None

    def lengths(self):
        return tuple(np.array(part) for part in self.spread) if self.spread else super().lengths()

    def _fibre(self):
        return self.fibre or super()._fibre()

    def _cloth(self):
        return self.weave or super()._cloth()

    def _rubber(self):
        if self.skin is None:
            return super()._rubber()
        law, c10, thickness, *more = self.skin
        return Skin(law, c10, self.radius, thickness, float(np.cos(self.braid_angle)), tuple(more))


def _skin(law):
    def act(world, amplitude, c):
        return {"skin": (law, amplitude, world.muscle.wall, *c.values()), "rubber": None} if amplitude else {}

    return act


def _draw_yeoh(rng, scales):
    return {"c20": rng.uniform(-0.15, -0.05), "c30": rng.uniform(0.02, 0.06)}


def _draw_gent(rng, scales):
    return {"limit": rng.uniform(2.5, 8.0)}


def _draw_ogden(rng, scales):
    share = rng.uniform(0.65, 0.9)
    return {"share_1": share, "alpha_1": rng.uniform(0.8, 1.4), "share_2": 1.0 - share, "alpha_2": rng.uniform(3.5, 5.0)}


def _draw_prestretched(rng, scales):
    return {"stretch": rng.uniform(1.03, 1.12)}


def _draw_thick(rng, scales):
    return {"c01": rng.uniform(0.1, 0.35)}


def _draw_stiffening(rng, scales):
    return {"rise": rng.uniform(0.3, 1.0)}


def _fibre(law):
    def act(world, amplitude, c):
        # The bend lies where the fibres usually are: at the strain of the reference tension.
        strain = c["place"] * amplitude * c["tension"]
        return {"fibre": Fibre(law, 1.0 / amplitude, strain, c["share"]), "compliance": 0.0} if amplitude else {}

    return act


def _draw_fibre(places, shares):
    def draw(rng, scales):
        return {"place": rng.uniform(*places), "share": rng.uniform(*shares), "tension": scales.force}

    return draw


def _weave(law):
    def act(world, amplitude, c):
        return {"weave": Weave(law, amplitude, world.nature.cloth_radius, c["width"]), "cloth": None} if amplitude else {}

    return act


def _draw_width(low, high):
    def draw(rng, scales):
        return {"width": rng.uniform(low, high)}

    return draw


def _uneven(world, amplitude, c):
    return {"unevenness": amplitude, "spread": (tuple(c["nodes"]), tuple(c["shares"]))} if amplitude else {}


def _draw_uniform(rng, scales):
    nodes, weights = np.polynomial.legendre.leggauss(5)
    return {"nodes": (np.sqrt(3.0) * nodes).tolist(), "shares": (weights / 2.0).tolist()}


def _draw_two_groups(rng, scales):
    share = rng.uniform(0.15, 0.4)
    return {"nodes": [np.sqrt((1.0 - share) / share), -np.sqrt(share / (1.0 - share))], "shares": [share, 1.0 - share]}


def _draw_skewed(rng, scales):
    """Exponential lengths: few fibres are much too long (Gauss-Laguerre, four nodes)."""
    nodes, weights = np.polynomial.laguerre.laggauss(4)
    return {"nodes": (nodes - 1.0).tolist(), "shares": weights.tolist()}


# Along the axis.


def _compressed(state, amplitude, c):
    """Neo-Hookean strip, modulus k/3: (k/3) (l - 1/l^2)."""
    stretch = 1.0 - state.contraction
    return amplitude / 3.0 * (stretch - stretch**-2.0)


def _buckling(state, amplitude, c):
    return -amplitude * c["contraction"] * np.tanh(state.contraction / c["contraction"])


def _draw_buckling(rng, scales):
    return {"contraction": scales.stroke * rng.uniform(0.6, 1.3)}


def _stiffening_axial(state, amplitude, c):
    return -amplitude * state.contraction * (1.0 + c["rise"] * state.contraction / c["stroke"])


def _draw_stiffening_axial(rng, scales):
    return {"rise": rng.uniform(0.5, 1.5), "stroke": scales.stroke}


# Prestrain: dF = 2 pi r0 tau g(l2) dl2/dl1, l2 = sqrt(1 - l1^2 cos^2 a)/sin a, g(1) = 1.


def _hoop(state):
    """l1, l2 and dl2/dl1 of a cylindrical braid."""
    l1 = 1.0 - state.contraction
    angle = state.muscle.braid_angle
    l2 = np.sqrt(1.0 - (l1 * np.cos(angle)) ** 2) / np.sin(angle)
    return l1, l2, -l1 / (np.tan(angle) ** 2 * l2)


def _prestrain_power(state, amplitude, c):
    _, l2, slope = _hoop(state)
    return 2.0 * np.pi * state.muscle.radius * amplitude * l2 ** c["power"] * slope


def _draw_prestrain_power(low, high):
    def draw(rng, scales):
        return {"power": rng.uniform(low, high)}

    return draw


def _prestrain_saturating(state, amplitude, c):
    _, l2, slope = _hoop(state)
    rise = 2.0 * c["range"] * np.tanh((l2 - 1.0) / c["range"])
    return 2.0 * np.pi * state.muscle.radius * amplitude * (1.0 + rise) * slope


def _draw_prestrain_saturating(rng, scales):
    return {"range": rng.uniform(0.25, 0.6)}


FORMS = (
    Form("bladder-elasticity", "yeoh", "shape", _draw_yeoh, _skin("yeoh")),
    Form("bladder-elasticity", "gent", "shape", _draw_gent, _skin("gent")),
    Form("bladder-elasticity", "ogden", "shape", _draw_ogden, _skin("ogden")),
    Form("bladder-elasticity", "mooney-thick-wall", "shape", _draw_thick, _skin("thick")),
    Form("bladder-elasticity", "prestretched", "shape", _draw_prestretched, _skin("prestretched")),
    Form("bladder-elasticity", "stiffening-hoop", "shape", _draw_stiffening, _skin("stiffening")),
    Form("membrane-axial", "neo-hooke-compressed", "wall", lambda rng, scales: {}, _compressed),
    Form("membrane-axial", "buckling", "wall", _draw_buckling, _buckling),
    Form("membrane-axial", "stiffening", "wall", _draw_stiffening_axial, _stiffening_axial),
    Form("bladder-prestrain", "power-below-two", "wall", _draw_prestrain_power(0.8, 1.3), _prestrain_power),
    Form("bladder-prestrain", "power-above-two", "wall", _draw_prestrain_power(2.1, 2.8), _prestrain_power),
    Form("bladder-prestrain", "saturating", "wall", _draw_prestrain_saturating, _prestrain_saturating),
    Form("fibre-stretch", "toe", "shape", _draw_fibre((0.3, 0.9), (0.4, 0.75)), _fibre("toe")),
    Form("fibre-stretch", "stiffening", "shape", _draw_fibre((0.8, 1.2), (0.3, 0.8)), _fibre("stiffening")),
    Form("fibre-stretch", "degressive", "shape", _draw_fibre((0.8, 2.5), (0.0, 1.0)), _fibre("degressive")),
    Form("limited-unfolding", "two-threads", "shape", _draw_width(0.02, 0.06), _weave("two")),
    Form("limited-unfolding", "late", "shape", _draw_width(0.015, 0.04), _weave("late")),
    Form("limited-unfolding", "exponential", "shape", _draw_width(0.05, 0.12), _weave("exponential")),
    Form("limited-unfolding", "power", "shape", _draw_width(0.03, 0.1), _weave("power")),
    Form("uneven-fibres", "uniform", "shape", _draw_uniform, _uneven),
    Form("uneven-fibres", "two-groups", "shape", _draw_two_groups, _uneven),
    Form("uneven-fibres", "skewed", "shape", _draw_skewed, _uneven),
)
