"""How well an effect can be seen: the norm of its signature in units of the noise, after all that may explain it away.

With K the covariance of the noise and J the signatures of one standard deviation of every stated uncertainty (zero and gain of the
instruments, widths of the geometry), signatures S have the projected Gram matrix

    G = S' K^-1 S - S' K^-1 J (I + J' K^-1 J)^-1 J' K^-1 S

d = sqrt(G_ss); rho = G_se/sqrt(G_ss G_ee). A rival e whose amplitude is fitted leaves sqrt(G_ss - G_se^2/G_ee). Source: generalised least squares
with Gaussian priors (Aitken 1935; the Schur complement).
"""

import numpy as np

from .effects import CATALOGUE
from .noise import apply_inverse

STATED = (
    ("pressure", "zero", "pressure-offset"),
    ("pressure", "gain", "pressure-gain"),
    ("force", "zero", "force-offset"),
    ("force", "gain", "force-gain"),
    ("stroke", "zero", "length-zero-error"),
    ("stroke", "gain", "displacement-gain"),
)
"""Sheet, its entry, and the amplitude that it is the standard deviation of."""


def stated_widths(muscle):
    """Standard deviations of all amplitudes that the muscle file gives a width."""
    widths = {name: getattr(getattr(muscle, sheet), entry) for sheet, entry, name in STATED}
    widths.update(muscle.widths)
    return {name: width for name, width in widths.items() if width}


class Metric:
    """Inner products of signatures on one path under one noise law, as seen from a reference world."""

    def __init__(self, world, path, law):
        self.world, self.path, self.law = world, path, law
        self.base = world.force(path)
        step_p, step_e = 200.0, 2e-5
        pressure_slope = (world.force(_moved(path, step_p, 0.0)) - world.force(_moved(path, -step_p, 0.0))) / (2.0 * step_p)
        contraction_slope = (world.force(_moved(path, 0.0, step_e)) - world.force(_moved(path, 0.0, -step_e))) / (2.0 * step_e)
        self.variance = law.white_variance(pressure_slope, contraction_slope)
        self.nuisances = np.stack(
            [self._tangent(name, width) for name, width in stated_widths(world.muscle).items()] or [np.zeros(len(path))], axis=1
        )
        self._solved = apply_inverse(law, path, self.variance, self.nuisances)
        self._inner = np.eye(self.nuisances.shape[1]) + self.nuisances.T @ self._solved

    def _tangent(self, name, width):
        up, down = (self.world.changed({name: self.world.amplitude(name) + sign * width}).force(self.path) for sign in (0.5, -0.5))
        return up - down

    def gram(self, signatures):
        """Projected Gram matrix of signatures (rows x m)."""
        solved = apply_inverse(self.law, self.path, self.variance, signatures)
        cross = self.nuisances.T @ solved
        return signatures.T @ solved - cross.T @ np.linalg.solve(self._inner, cross)

    def norm(self, signature):
        """d of one signature."""
        return float(np.sqrt(max(self.gram(signature[:, None])[0, 0], 0.0)))


def _moved(path, pressure, contraction):
    """The path with all readings shifted; only the static force is meant to follow."""
    return type(path)(
        **{
            **{k: getattr(path, k) for k in path.__dataclass_fields__},
            "pressure": path.pressure + pressure,
            "contraction": path.contraction + contraction,
        }
    )


def available(world, path, plan_needs):
    """Effects of the catalogue that the muscle has and this test can show."""
    kind = world.muscle.kind
    names = []
    for effect in CATALOGUE.values():
        if kind not in effect.kinds or not set(effect.needs) <= plan_needs:
            continue
        if effect.name == "end-taper" and world.muscle.ends != "cylinder":
            continue
        if effect.name == "bladder-elasticity" and (world.muscle.wall is None or world.muscle.bladder is not None):
            continue
        names.append(effect.name)
    return names


def tangents(world, path, names, base=None):
    """Signatures of small amplitudes of the named effects (rows x m)."""
    base = world.force(path) if base is None else base
    columns = []
    for name in names:
        effect = CATALOGUE[name]
        share = 1.0 if effect.fixed or effect.power != 1.0 else 0.3
        columns.append(world.changed({name: world.amplitude(name) + share * effect.scale}).force(path) - base)
    return np.stack(columns, axis=1)


def rivals(gram_ss, gram_se, gram_ee, signs):
    """What is left of a signature of squared norm G_ss after each rival is fitted; a rival with a sign can't be negative."""
    usable = (gram_ee > 1e-12) & ((signs == 0) | (gram_se > 0.0))
    explained = np.where(usable, gram_se**2 / np.where(gram_ee > 1e-12, gram_ee, 1.0), 0.0)
    return np.sqrt(np.maximum(gram_ss - explained, 0.0))


def rival_pairs(gram_ss, gram_se, gram_ee, signs):
    """What is left of a signature of squared norm G_ss after the best pair of rivals is fitted to it. `gram_ee` is the matrix of all rivals."""
    norms = np.diag(gram_ee)
    alone = rivals(gram_ss, gram_se, norms, signs).min()
    first, second = np.triu_indices(len(norms), 1)
    inner = norms[first] * norms[second] - gram_ee[first, second] ** 2
    usable = inner > 1e-9 * norms[first] * norms[second]
    first, second, inner = first[usable], second[usable], inner[usable]
    a = (gram_se[first] * norms[second] - gram_se[second] * gram_ee[first, second]) / inner
    b = (gram_se[second] * norms[first] - gram_se[first] * gram_ee[first, second]) / inner
    allowed = ((signs[first] == 0) | (a > 0.0)) & ((signs[second] == 0) | (b > 0.0))
    explained = (a * gram_se[first] + b * gram_se[second])[allowed]
    return float(min(alone, np.sqrt(max(gram_ss - explained.max(initial=0.0), 0.0))))
