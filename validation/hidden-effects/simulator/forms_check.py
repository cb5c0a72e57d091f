"""Checks of the forms: derivatives, limits in which a form is the usual formula, exact solutions, and what the suite promises. Each returns an error."""

import tempfile
from dataclasses import replace
from pathlib import Path as Folder

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.special import ndtr
from scipy.stats import laplace, t, uniform

from . import forms_bound, forms_metrics, forms_rig, forms_time
from .forms import FOLDS, Drawn, Form, State, all_forms, fold
from .forms_case import build
from .forms_design import HeldLoad, carried, loaded
from .forms_effects import EXACT, LOOSE, MECHANISM
from .forms_motion import dahl, iwan
from .forms_suite import Order, orders
from .forms_world import FormsWorld
from .meridian import Body, Rubber, solve
from .muscle import Muscle
from .protocols import Plan
from .section import Cloth, Section
from .skins import Fibre, Skin, Weave
from .surface import Window, force_map
from .world import World

ALPHA = np.radians(25.0)
BRAID = Muscle("check", "braided", 0.2, 0.01, braid_angle=ALPHA, wall=1.5e-3)
VIEW = Window((1.2e5, 5e5), (-0.01, 0.23))
SKINS = {
    "yeoh": (-0.1, 0.04),
    "gent": (4.0,),
    "ogden": (0.8, 1.2, 0.2, 4.0),
    "prestretched": (1.08,),
    "thick": (0.2,),
    "stiffening": (0.6,),
}


def _path(rows=300, form="triangle"):
    return Plan(form, (1.6e5, 3e5, 4.5e5), 0.01, 0.2, rows, (60.0,)).path()


def _state(path, force=None):
    return State(path, None, path.pressure, path.contraction, force, force, BRAID)


def skin_derivatives():
    """Second derivatives of each law by central differences of its first ones, which must be those of one energy (W_ag from either)."""
    a, g, step, worst = np.array([0.7, 0.9, 1.02]), np.array([2.3, 1.5, 1.05]), 1e-5, 0.0
    for law, more in SKINS.items():
        skin = Skin(law, 1e5, 0.01, 1.5e-3, float(np.cos(ALPHA)), more)
        _, _, w_aa, w_gg, w_ag = skin.slopes(a, g)
        up, down = skin.slopes(a + step, g), skin.slopes(a - step, g)
        right, left = skin.slopes(a, g + step), skin.slopes(a, g - step)
        found = [(up[k] - down[k]) / (2 * step) for k in (0, 1)] + [(right[k] - left[k]) / (2 * step) for k in (0, 1)]
        scale = np.abs(w_gg).max()
        worst = max(worst, *(float(np.abs(x - y).max() / scale) for x, y in zip(found, (w_aa, w_ag, w_ag, w_gg))))
    return worst


def _change(rubber):
    length = 0.2 * np.array([0.95, 0.85])
    body = Body("braided", 0.2 / np.cos(ALPHA), 0.01, np.sin(ALPHA) / 0.01, Section(), rubber=rubber)
    return solve(body, 2e5, length).force


def skin_limits():
    """Each law is neo-Hooke in its limit; a hoop of linear stiffness is what is left of the last."""
    neo = _change(Rubber(1e5, 0.0, 0.01, 1.5e-3, float(np.cos(ALPHA))))
    bare = _change(None)
    limits = {
        "yeoh": (0.0, 0.0),
        "gent": (1e7,),
        "ogden": (0.5, 2.0, 0.5, 2.0),
        "prestretched": (1.0,),
    }
    worst = max(
        float(np.abs((_change(Skin(law, 1e5, 0.01, 1.5e-3, float(np.cos(ALPHA)), more)) - neo) / (neo - bare)).max())
        for law, more in limits.items()
    )
    # A thick wall of a hundredth of the thickness and a hundred times the modulus.
    thin = _change(Skin("thick", 1e7, 0.01, 1.5e-5, float(np.cos(ALPHA)), (0.0,)))
    return max(worst, 0.1 * float(np.abs((thin - neo) / (neo - bare)).max()))


def fibres_and_cloth():
    """Tangents by differences; the laws' limits: linear fibres, and the usual cloth."""
    e, step, worst = np.array([-0.004, 0.002, 0.01]), 1e-7, 0.0
    for law in ("toe", "stiffening", "degressive"):
        fibre = Fibre(law, 1e5, 5e-3, 0.6)
        found = (fibre.pull(e + step)[0] - fibre.pull(e - step)[0]) / (2 * step)
        worst = max(worst, float(np.abs(found / fibre.pull(e)[1] - 1.0).max()))
        straight = Fibre(law, 1e5, 1e4, 0.0).pull(e)[0]
        worst = max(worst, float(np.abs(straight / (1e5 * e) - 1.0).max()))
    r = np.array([0.0295, 0.0301, 0.031, 0.033])
    for law in ("late", "power", "exponential", "two"):
        weave = Weave(law, 1e4, 0.03, 0.05)
        u, u_r, u_rr = weave.energy(r)
        up, down = weave.energy(r + 1e-8), weave.energy(r - 1e-8)
        worst = max(worst, float(np.abs((up[0] - down[0]) / 2e-8 - u_r).max() / u_r.max()))
        worst = max(worst, float(np.abs((up[1] - down[1]) / 2e-8 - u_rr).max() / u_rr.max()))
    same = zip(Weave("late", 1e4, 0.03, 0.002).energy(r), Cloth(1e4, 0.03).energy(r))
    return max(worst, *(float(np.abs(x / y - 1.0).max()) for x, y in same))


def dahl_exponents():
    """Dahl's state for three exponents against its differential equation (SciPy), and n -> 1 against the exponential."""
    path, delta, worst = _path(), 4e-3, 0.0
    up = slice(0, 100)
    for exponent in (0.6, 1.7, 2.4):
        exact = solve_ivp(
            lambda x, z, n=exponent: np.maximum(1.0 - z, 0.0) ** n / delta,
            path.contraction[[0, 99]],
            [0.0],
            t_eval=path.contraction[up],
            rtol=1e-10,
            atol=1e-12,
        )
        worst = max(worst, float(np.abs(dahl(path, path.contraction, delta, exponent)[up] - exact.y[0]).max()))
    near, exponential = (dahl(path, path.contraction, delta, n) for n in (1.0 + 1e-7, 1.0))
    return max(worst, float(np.abs(near - exponential).max()))


def iwan_limit():
    """Elements of one distance: elastic up to it, then sliding."""
    path = _path()
    x = path.contraction[:100] - path.contraction[0]
    return float(np.abs(iwan(path, path.contraction, 0.01, 0.0)[:100] - np.minimum(x / 0.01, 1.0)).max())


def damping_limits():
    """Power 1, slow Eyring and slow Carreau are linear damping; the error of the slow ones falls with the square of the rate."""
    by_name = {form.name: form for form in all_forms()["viscous-damping"]}
    path = _path(form="sine")
    linear = -300.0 * path.rate

    def off(name, constants):
        return float(np.abs(by_name[name].act(_state(path), 300.0, constants) - linear).max() / np.abs(linear).max())

    fastest = float(np.abs(path.rate).max())
    eyring = [off("eyring", {"speed": k * fastest}) for k in (50.0, 100.0)]
    carreau = [off("carreau", {"speed": k * fastest, "power": 0.5, "floor": 0.2}) for k in (50.0, 100.0)]
    orders_ = [abs(np.log2(pair[0] / pair[1]) - 2.0) for pair in (eyring, carreau)]
    return max(off("power-thinning", {"power": 1.0, "speed": fastest}), 1e-3 * max(orders_))


def relaxation():
    """A load that is held: Boltzmann's sum is Kohlrausch's function; Kohlrausch with exponent 1 and Burgers without flow are one Kelvin element."""
    forms = {form.name: form for form in all_forms()["creep"]}
    path = _path()
    state = _state(path, np.full(len(path), 500.0))
    load = {"pressure": 2e5, "by_pressure": 0.0, "size": 1.0}
    held = forms["hereditary"].act(state, 2.0, {"time": 12.0, "power": 0.5, "force": 500.0, **load})
    spread = forms["kohlrausch"].act(state, 2.0, {"time": 12.0, "power": 0.5, **load})
    one = forms["kohlrausch"].act(state, 2.0, {"time": 12.0, "power": 1.0, **load})
    kelvin = forms["burgers"].act(state, 2.0, {"time": 12.0, "flow": 0.0, "run": 60.0, **load})
    # The spectrum that stands for Kohlrausch's function begins at a thousandth of its time: what is faster is gone at once.
    late = path.since_start > 1.2
    return max(float(np.ptp((held - spread)[late])) / 2.0, float(np.abs(one - kelvin).max()) / 2.0)


def late_ramps():
    """Every late reading of a ramp is late by the amplitude, whatever its form."""
    path, worst = _path(), 0.0
    ramp, late = 3.0 * path.since_start, path.since_start > 30.0
    for form in all_forms()["force-lag"]:
        change = form.act(_state(path, ramp), 0.8, {"share": 0.6})
        worst = max(worst, float(np.abs(change[late] + 3.0 * 0.8).max()))
    return worst


def slack():
    """What is read beyond the mean load, by quadrature over each distribution of the fibres' loads."""
    size, worst = 20.0, 0.0
    laws = {
        "uniform": uniform(-np.sqrt(3.0) * size, 2.0 * np.sqrt(3.0) * size),
        "laplace": laplace(0.0, size / np.sqrt(2.0)),
        "hyperbola": t(2, scale=size / np.sqrt(2.0)),
    }
    for form in all_forms()["low-load-slack"]:
        for force in (-30.0, 0.0, 15.0, 50.0):
            exact = quad(lambda f, law=laws[form.name], mean=force: max(f, 0.0) * law.pdf(f - mean), 0.0, np.inf, limit=400, epsabs=1e-9)[0]
            found = force + float(form.act(_state(_path(30), np.array(force)), size, {}))
            worst = max(worst, abs(found - exact))
    return worst


def lengths():
    """Lengths of uneven fibres: shares sum to 1, mean 0, standard deviation 1."""
    worst, rng = 0.0, np.random.default_rng(3)
    for form in all_forms()["uneven-fibres"]:
        drawn = form.draw(rng, None)
        nodes, shares = np.array(drawn["nodes"]), np.array(drawn["shares"])
        worst = max(worst, abs(shares.sum() - 1.0), abs(shares @ nodes), abs(shares @ nodes**2 - 1.0))
    return worst


def small_forces():
    """Curved load cells tend to F^2 or its like: the saturating one to the quadratic, with an error that falls with the square of the force."""
    form = next(one for one in all_forms()["force-nonlinearity"] if one.name == "saturating")
    path = _path(30)
    off = []
    for force in (20.0, 10.0):
        change = form.act(_state(path, np.full(len(path), force)), 1e-5, {"force": 1000.0, "span": 0.8})
        off.append(float(np.abs(change / (1e-5 * force**2) - 1.0).max()))
    return max(off[1], 1e-3 * abs(np.log2(off[0] / off[1]) - 2.0))


def same_world():
    """Without forms the world is that of the other suite; a frame form that is linear is its compliance."""
    path = _path()
    names = {"coulomb-friction": 5.0, "creep": 1.0, "force-gain": 0.01, "length-zero-error": 1e-4}
    plain = World(BRAID, VIEW, amplitudes=names).force(path)
    worst = float(np.abs(FormsWorld(BRAID, VIEW, amplitudes=names).force(path) / plain - 1.0).max())
    linear = Drawn(Form("frame-compliance", "linear", "give", None, lambda load, amplitude, c: amplitude * load))
    formed = FormsWorld(BRAID, VIEW).formed(linear, 1e-6).force(path)
    usual = World(BRAID, VIEW, amplitudes={"frame-compliance": 1e-6}).force(path)
    return max(worst, float(np.abs(formed / usual - 1.0).max()))


def held_load():
    """The load of an isotonic test without hidden effects, over its largest deviation; pressures stay within the plan's."""
    plan = HeldLoad("triangle", (1.8e5, 3e5, 4.5e5), 0.01, 0.18, 200, (60.0,))
    world = FormsWorld(BRAID, VIEW)
    static = force_map(world.shape(), VIEW)
    plan = loaded(np.random.default_rng(1), plan, static)
    path = carried(plan, plan.path(), world, static, 2)
    return float(np.abs(world.force(path) / plan.held(path) - 1.0).max())


def softening_without_memory():
    """Far from the first loop nothing is left of a virgin muscle: power of the cycle aside, less than the square of what one loop leaves."""
    path = replace(Plan("sine", (2e5,), 0.01, 0.2, 800, (60.0,), loops=8).path())
    bare = np.full(len(path), 100.0)
    form = next(one for one in all_forms()["stress-softening"] if one.name == "travel")
    change = form.act(_state(path, bare), 0.2, {"loops": 1.0, "power": 0.5})
    return float(abs(change[-1] / (20.0 * np.exp(-(8.0**0.5))) - 1.0)) + abs(float(forms_time.loops(path, path.pressure)[-1]) - 8.0)


def line_losses():
    """At the reference pressure each loss that is proportional is the amplitude's share."""
    pressure = np.array([2e5])
    state = replace(_state(_path(30)), pressure=pressure)
    found = forms_rig._poiseuille(state, 0.02, {"pressure": 2e5}), forms_rig._turbulent_leak(state, 0.02, {"pressure": 2e5, "power": 1.7})
    return max(float(np.abs(change / (-0.02 * pressure) - 1.0).max()) for change in found)


def promises():
    """Three forms and three folds for each loose effect, none that is in no mechanism, and the counts of the suite: the number of what is broken."""
    forms, broken = all_forms(), 0
    for name in LOOSE:
        broken += len(forms[name]) < 3 or {fold(form) for form in forms[name]} != set(range(FOLDS))
        broken += len({form.name for form in forms[name]}) < len(forms[name])
    broken += set(forms) != set(LOOSE)
    broken += sum(name not in MECHANISM and name != "line-drop" for name in (*LOOSE, *EXACT))
    every = orders()
    broken += len(every) < 600 or len({order.name for order in every}) < len(every)
    broken += sum(len([o for o in every if o.kind == "one" and o.strengths == (s,)]) < 60 for s in (8.0, 12.0, 40.0, 120.0, 300.0))
    return float(broken)


def reached():
    """Strengths of built cases, one for each stage at which forms act, and each rig."""
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for name, form, family, rig, strength in (
            ("bladder-elasticity", "gent", "braided", "isobaric", 120.0),
            ("regulator-lag", "second-order", "pleated", "isometric", 40.0),
            ("presliding-hysteresis", "iwan-spread", "braided", "isotonic", 40.0),
            ("frame-compliance", "hertz", "pleated", "isobaric", 12.0),
            ("force-nonlinearity", "exponential", "braided", "isometric", 12.0),
        ):
            truth = build(Order(f"check-{name}", "one", family, rig, ((name, form),), (strength,)), 11, Folder(folder))
            worst = max(worst, abs(truth["hidden"][0]["d"] / strength - 1.0))
    return worst


def score():
    """Families, mechanisms and members: what is right and alone, what is only of the mechanism, what is wrong, and two names for two effects."""
    entry = {"effect": "coulomb-friction", "family": "coulomb-friction", "mechanism": "dry friction", "acceptable": ["coulomb-friction"]}
    other = {"effect": "creep", "family": "creep", "mechanism": "relaxation", "acceptable": ["creep"]}

    def answer(names, hidden):
        return forms_metrics.Answer({"kind": "one", "hidden": hidden}, "missing", [{"effect": name} for name in names])

    wanted = (
        (["asymmetric-friction"], [entry], True, True),
        (["maxwell-slip"], [entry], False, True),
        (["coulomb-friction", "creep"], [entry], False, False),
        (["pressure-creep", "coulomb-friction"], [entry, other], True, True),
        (["creep", "fibre-creep"], [entry, other], False, False),
    )
    broken = 0
    for names, hidden, by_family, by_mechanism in wanted:
        one = answer(names, hidden)
        broken += one.all_right() is not by_family
        broken += one.all_right("mechanism") is not by_mechanism
    claimed = answer(["creep"], [entry, other])
    broken += [claimed.as_claimed(claim) for claim in (
        {"effect": "creep", "level": "family"},
        {"effect": "maxwell-slip", "level": "family"},
        {"effect": "maxwell-slip", "level": "mechanism"},
        {"effect": "end-slip", "level": "class", "class": ["end-slip", "creep"]},
        {"effect": "end-slip", "level": "class", "class": ["end-slip"]},
    )] != [True, False, True, True, False]
    claim = {"confidence": {"mechanism": 0.9, "family": 0.8, "form": 0.5}}
    broken += forms_metrics.confidence(claim, "mechanism") != 0.9 or forms_metrics.confidence({"confidence": 0.7}, "family") != 0.7
    return float(broken)


def told_apart():
    """Two shapes of strength d at an angle of cosine c are told apart in Phi(d sqrt((1 - c)/2)) of all noises; beside what shares their part in common as well."""
    worst, rng = 0.0, np.random.default_rng(7)
    for d, cosine in ((20.0, 0.995), (12.0, 0.97), (40.0, 0.9999)):
        truth, rival = np.array([d, 0.0, 0.0]), np.array([cosine, np.sqrt(1.0 - cosine**2), 0.0])
        noise = rng.standard_normal((40_000, 3))
        for others in (np.empty((0, 3)), np.array([[0.0, 0.0, 2.0]])):
            own, found = forms_bound.compared(truth, others, rival[None, :], ["creep"], ["creep alone"], np.array([np.inf]), noise)
            worst = max(worst, abs(np.mean(own > found["creep"]) - ndtr(d * np.sqrt(0.5 * (1.0 - cosine)))))
    # With the second direction known to be there, only the first is left to tell: nothing.
    own, found = forms_bound.compared(truth, np.array([[0.0, 1.0, 0.0]]), rival[None, :], ["creep"], ["creep alone"], np.array([np.inf]), noise)
    return float(max(worst, np.abs(own - found["creep"]).max()))


def evidence_of_a_form():
    """Evidence of a form of two draws against the integral over their deviation, at the best size."""
    rng, worst = np.random.default_rng(8), 0.0
    for strength in (5.0, 20.0):
        draws = np.array([[1.0, 0.1, 0.0], [1.0, -0.1, 0.05]])
        data = strength * np.array([1.0, 0.03, 0.0]) + rng.standard_normal(3)
        units = draws / np.linalg.norm(draws, axis=1)[:, None]
        mean = units.mean(axis=0)
        away = units[0] - mean, units[1] - mean
        sizes, best = np.linspace(0.5, 2.0, 601) * strength, -np.inf
        c = np.linspace(-8.0, 8.0, 4001)
        along = np.sqrt(np.sum(np.square(away), axis=0))
        direction = along * np.sign(away[0])
        for size in sizes:
            left = data - size * (mean + c[:, None] * direction)
            density = np.exp(-0.5 * np.sum(left**2, axis=1) - 0.5 * c**2 + 0.5 * data @ data) / np.sqrt(2.0 * np.pi)
            best = max(best, np.log(np.trapezoid(density, c)))
        found = forms_bound.evidence(data[None, :], draws, np.array([np.inf, np.inf]), 1)
        worst = max(worst, abs(found[0] - best))
    return float(worst)


CHECKS = [
    ("forms: derivatives of the skins by differences", skin_derivatives, 1e-8),
    ("forms: Yeoh, Gent, Ogden, prestretched and thick skins tend to neo-Hooke", skin_limits, 1e-3),
    ("forms: derivatives and limits of fibres and cloth", fibres_and_cloth, 1e-5),
    ("forms: Dahl's state of any exponent against its differential equation (SciPy)", dahl_exponents, 1e-6),
    ("forms: a chain of equal elements is elastic, then slides", iwan_limit, 1e-12),
    ("forms: damping tends to the linear one, with order 2", damping_limits, 1e-3),
    ("forms: Boltzmann's sum of a held load is Kohlrausch's function", relaxation, 2e-3),
    ("forms: late readings of a ramp are late by the amplitude", late_ramps, 1e-3),
    ("forms: slack by quadrature over the loads of the fibres", slack, 2e-3),
    ("forms: lengths of uneven fibres have mean 0 and deviation 1", lengths, 1e-9),
    ("forms: a saturating load cell is quadratic at small forces, with order 2", small_forces, 1e-3),
    ("forms: without forms, and with a linear one, the world of the other suite", same_world, 1e-9),
    ("forms: the load of an isotonic test is held", held_load, 1e-6),
    ("forms: a softened muscle after eight loops", softening_without_memory, 5e-3),
    ("forms: losses of a line at the reference pressure", line_losses, 1e-12),
    ("forms: three forms in three folds for each effect, counts of the suite", promises, 0.0),
    ("forms: strengths reached by built cases", reached, 0.05),
    ("bound of the forms: two shapes told apart as the normal law says", told_apart, 0.01),
    ("bound of the forms: evidence of a form by quadrature", evidence_of_a_form, 0.02),
    ("score of the forms: families, mechanisms, several effects, confidence", score, 0.0),
]
"""Title, check and tolerance."""
