"""How often the right name can be told at best: by who knows the noise law, the shape of what is hidden, and the other forms that every other effect may have.

The data are y = s + n, whitened and projected off what stated uncertainties may explain (`detectability.py`). The truth's own candidate is s itself with a free size:

    ln Z = (s'y)^2/(2 s's)

Each other effect has its forms. A form is the Gaussian process of its draws: unit signatures s_1 .. s_K at the strength of the hidden effect, mean m, deviations
U = (s_k - m)/sqrt(K - 1), size a:

    ln Z = max over a, c of -1/2 |y - a (m + U c)|^2 - 1/2 |c|^2,   less 1/2 ln|I + a^2 U'U|,   over -1/2 |y|^2

A size beyond the plausible bounds of an effect, or of the wrong sign, is no candidate. All names are equally likely before, the weight of an effect is shared by its
forms, and a free size costs all the same. The name of the largest sum is named. Of several hidden effects each is replaced in turn, beside the others as they are.
This is a bound from above: nobody who looks at data knows the very shape of what is hidden in them. With `by_form` the truth's candidate is what its rivals are: the sum
over the forms of its family, whose constants nobody tells.
"""

import numpy as np

from .case import Unsuitable
from .forms import Drawn, all_forms
from .forms_case import draw, limit_of
from .forms_effects import EFFECTS, LOOSE, family, shows
from .forms_rivals import columns
from .meridian import NoEquilibrium
from .surface import OutsideWindow

DRAWS = 6
"""Draws of the constants of a rival's form."""
NOISES = 400
"""Draws of the noise of a case."""
ROUNDS = 4
"""Size and deviations of a form in turn."""
TINY = 1e-9
"""Part of a norm below which a direction is rounding."""


def bound(order, seed):
    """The case's name, what is hidden and how strong, and the share of noise draws in which all of it would be named."""
    setting, world, truth, rng = draw(order, seed)
    entries = truth["hidden"]
    known = [i for i, entry in enumerate(entries) if entry["family"]]
    path = setting.path
    clean = world.force(path)
    alone = [clean - world.changed({e["effect"]: setting.world.amplitudes.get(e["effect"], 0.0)}).force(path) for e in entries]
    target = max(e["d"] for e in entries)
    labels, forms, signatures, limits = _rivals(setting, order, rng, target)
    coordinates = _coordinates(setting.metric.gram(np.column_stack([*alone, *signatures])))
    hidden, rivals = coordinates[: len(entries)], coordinates[len(entries) :]
    noise = rng.standard_normal((NOISES, coordinates.shape[1]))
    right, fair = np.ones((2, NOISES), dtype=bool)
    worst = {}
    for i in known:
        names = {family(name) for name in entries[i]["acceptable"]} | {entries[i]["family"]}
        others = hidden[[k for k in range(len(entries)) if k != i]]
        own, found = compared(hidden[i], others, rivals, labels, forms, limits, noise)
        against = {head: value for head, value in found.items() if head not in names}
        best = np.max([*against.values(), np.full(NOISES, -np.inf)], axis=0)
        right &= own > best
        fair &= np.max([value for head, value in found.items() if head in names] or [own], axis=0) > best
        lost = {head: float((value > own).mean()) for head, value in against.items()}
        worst[entries[i]["effect"]] = max(lost.items(), key=lambda pair: pair[1], default=None)
    strength = entries[known[0]]["strength"]
    return {"case": order.name, "kind": order.kind, "strength": strength, "possible": float(right.mean()), "by_form": float(fair.mean()), "nearest": worst}


def _rivals(setting, order, rng, target):
    """Names, forms, signatures of the strength `target`, and how many times their size is still plausible."""
    metric, path = setting.metric, setting.path
    labels, forms, signatures, limits = [], [], [], []
    plain, found = columns(setting.world, path, setting.names, metric.base)
    for k, label in enumerate(plain):
        labels.append(label)
        forms.append(f"{label} {plain[:k].count(label)}")
        signatures.append(found[:, k])
        limits.append(np.inf)
    for name in LOOSE:
        effect = EFFECTS[name]
        if order.family not in effect.kinds or not shows(order.rig, name) or not set(effect.needs) <= setting.provided:
            continue
        limit = limit_of(name, setting)
        for form in all_forms()[name]:
            for _ in range(DRAWS):
                try:
                    one = setting.world.formed(Drawn(form, form.draw(rng, setting.scales)), 0.0)
                    amplitude, signature = _of_strength(metric, one, name, min(effect.scale, 0.2 * limit), limit, target)
                except (Unsuitable, NoEquilibrium, OutsideWindow):
                    continue
                labels.append(name)
                forms.append(f"{name} {form.name}")
                signatures.append(signature)
                limits.append(limit / amplitude)
    return labels, forms, signatures, np.array(limits)


def _of_strength(metric, world, name, start, limit, target):
    """An amplitude whose signature is about as strong as wanted, and the signature."""
    amplitude = start
    for again in (True, False):
        signature = world.changed({name: world.size(name) + amplitude}).force(metric.path) - metric.base
        norm = metric.norm(signature)
        if not norm > TINY:
            raise Unsuitable("the effect leaves no trace in this test")
        if again:
            amplitude = float(np.clip(amplitude * (target / norm) ** (1.0 / EFFECTS[name].power), 1e-3 * limit, limit))
    return amplitude, signature


def _coordinates(gram):
    """Rows whose inner products are the Gram matrix."""
    values, vectors = np.linalg.eigh(gram)
    kept = values > TINY * TINY * values.max()
    return vectors[:, kept] * np.sqrt(values[kept])


def compared(truth, others, rivals, labels, forms, limits, noise):
    """For each draw of the noise the log evidence of the truth itself, and of every family by its names and forms."""
    if len(others):
        basis = np.linalg.qr(others.T)[0]
        truth, rivals, noise = (one - (one @ basis) @ basis.T for one in (truth, rivals, noise))
    data = truth + noise
    names = {}
    for form in dict.fromkeys(forms):
        places = [k for k, one in enumerate(forms) if one == form]
        name = labels[places[0]]
        names.setdefault(name, []).append(evidence(data, rivals[places], limits[places], EFFECTS[name].sign))
    families = {}
    for name, values in names.items():
        families.setdefault(family(name), []).append(np.logaddexp.reduce(values) - np.log(len(values)))
    return 0.5 * (data @ truth) ** 2 / (truth @ truth), {head: np.logaddexp.reduce(values) for head, values in families.items()}


def evidence(data, draws, limits, sign):
    """Log evidence of one form for each row of data, over that of nothing."""
    norms = np.linalg.norm(draws, axis=1)
    usable = norms > TINY
    if not usable.any():
        return np.zeros(len(data))
    units = draws[usable] / norms[usable, None]
    most = float(np.median(limits[usable] * norms[usable]))
    mean = units.mean(axis=0)
    spread = (units - mean) / np.sqrt(max(len(units) - 1, 1))
    found = np.full(len(data), -np.inf)
    for side in (1.0, -1.0) if sign == 0 else (1.0,):
        found = np.maximum(found, _one_sided(side * data, mean, spread, most))
    return found


def _one_sided(data, mean, spread, most):
    size = np.clip(data @ mean / (mean @ mean), 0.0, most)
    inner, cross, middle = spread @ spread.T, data @ spread.T, spread @ mean
    count = len(spread)
    value = np.zeros(len(data))
    for _ in range(ROUNDS):
        a = size[:, None, None]
        matrix = np.eye(count) + a * a * inner
        pull = size[:, None] * (cross - size[:, None] * middle)
        c = np.linalg.solve(matrix, pull[..., None])[..., 0]
        shape = mean + c @ spread
        along = np.einsum("ij,ij->i", data, shape)
        size = np.clip(along / np.einsum("ij,ij->i", shape, shape), 0.0, most)
        left = np.sum(data**2, axis=1) - 2.0 * size * along + size**2 * np.einsum("ij,ij->i", shape, shape)
        determinant = np.linalg.slogdet(np.eye(count) + (size**2)[:, None, None] * inner)[1]
        value = -0.5 * left - 0.5 * np.sum(c * c, axis=1) - 0.5 * determinant
    return value + 0.5 * np.sum(data**2, axis=1)
