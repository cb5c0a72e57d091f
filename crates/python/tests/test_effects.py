"""Effects: the catalogue, and effects of one's own as expressions and as Python functions."""

import math
import pickle

import bulge
import numpy as np
import pytest

BAR = 1e5
N = bulge.Parameter("N", typical=50, low=-1e6, high=1e6)
ONE = bulge.Parameter("1", typical=0.1, low=-1e6, high=1e6)
bar = bulge.quantity("1 bar")

#: Functions of eps, p, mid_radius and two parameters: every function and every way to group that an effect may use.
FUNCTIONS = {
    "arithmetic": lambda eps, k, a: -k * (eps - a) / (2 + eps) + k,
    "minus": lambda eps, k, a: k - (eps * k - (k - a * k)) - -k + (3 - eps) * k + (5 + a) * k * (-2 * eps),
    "quotients": lambda eps, k, a: k / (2 / (eps + 3) / (a + 5)) / 7,
    "powers": lambda eps, k: k * -(eps**2) + k * (-eps) ** 2 * 3 + k * 2 ** (eps**2) + k * (2**eps) ** 3 + k * (eps + 1) ** -2,
    "float powers": lambda eps, k: k * (eps + 1) ** 0.5 + k * np.power(eps + 2, 1.5) + k * np.square(eps) + k * np.reciprocal(eps + 2),
    "numpy operators": lambda eps, k: np.add(k, np.multiply(eps, k)) - np.subtract(np.divide(k, 3), np.negative(k)) * np.positive(eps),
    "roots": lambda eps, k: k * np.sqrt(eps + 2) * np.exp(-eps) * np.log(eps + 3) * np.log10(eps + 4),
    "angles": lambda eps, k: k * np.sin(eps) + k * 2 * np.cos(eps) + k * 3 * np.tan(eps) + k * 5 * np.arcsin(eps) + k * 7 * np.arctan(eps),
    "hyperbolic": lambda eps, k, a: k * np.sinh(eps) + k * 2 * np.cosh(eps) + k * 3 * np.tanh(eps / a),
    "signs": lambda eps, k, a: k * abs(eps - 0.2) + k * 2 * np.abs(eps - 0.3) + k * 3 * np.sign(eps - 0.15) + k * 4 * np.fabs(a - eps),
    "minimum": lambda eps, k, a: k * np.minimum(eps, a) + 2 * k * np.maximum(0.2, eps) + k * 3 * np.fmin(eps, 0.1) + k * 4 * np.fmax(a, eps),
    "clip": lambda eps, k, a: k * np.clip(eps, 0.1, 0.2) + k * np.clip(eps, a, 0.3),
    "where": lambda eps, k, a: np.where(eps > a, k * eps, -k) + np.where(0.2 <= eps, 3 * k, k) + np.where(eps < 0.1, k, 0 * k),
    "constants": lambda eps, k: k + bulge.quantity("3 N") * eps - bulge.quantity("-0.2 kN") * eps + np.pi * k - 1e-7 * k,
    "pressure": lambda eps, p, k: k * (p / bar) ** 2 - k * np.tanh(p / bar / 2),
    "places": lambda eps, p, mid_radius, length, k, a: a * p * np.pi * mid_radius**2 + k * length / mid_radius,
}


def added(muscle, effect, numbers, eps, p):
    """What an effect adds to the force of a muscle."""
    stating = bulge.Muscle(kind="pleated", length=0.11, radius=0.016, fibres=40, effects={effect.name: numbers}, own=effect)
    return stating.force(eps, pressure=p) - muscle.force(eps, pressure=p)


@pytest.mark.parametrize("name", list(FUNCTIONS))
def test_a_function_means_what_numpy_computes(ppam, name):
    function = FUNCTIONS[name]
    taken = function.__code__.co_varnames[: function.__code__.co_argcount]
    parameters = {key: value for key, value in {"k": N, "a": ONE}.items() if key in taken}
    numbers = {key: value for key, value in {"k": 313.0, "a": 0.17}.items() if key in taken}
    effect = bulge.Effect("own", function, parameters=parameters)
    random = np.random.default_rng(len(name))
    eps, p = random.uniform(0.02, 0.38, 40), random.uniform(0.5, 5, 40) * BAR
    values = {"eps": eps, "p": p, "mid_radius": ppam.evaluate("max_radius", eps), "length": 0.11 * (1 - eps), **numbers}
    expected = function(**{key: values[key] for key in taken})
    found = added(ppam, effect, numbers, eps, p)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)
    # The expression is one that the command line reads, and it is the same effect.
    expression = bulge.Effect("own", effect.expression, parameters=parameters)
    assert expression.to_toml() == effect.to_toml()
    np.testing.assert_array_equal(added(ppam, expression, numbers, eps, p), found)


def test_every_variable(ppam):
    eps, p = 0.2, 2 * BAR
    shape = ppam.shape(pressure=p, contraction=eps)
    expected = {
        "p": p, "eps": eps, "length": 0.088, "l0": 0.11, "radius": 0.016, "mid_radius": shape.max_radius_m, "force": shape.force_n,
        "tension": 40 * shape.fibre_tension_n, "fibres": 40, "braid_angle": 0, "direction": 0, "rate": 0, "time": 0, "temperature": 0,
    }  # fmt: skip
    units = {"p": "Pa", "length": "m", "l0": "m", "radius": "m", "mid_radius": "m", "force": "N", "tension": "N", "rate": "1/s", "time": "s", "temperature": "K"}
    for name, value in expected.items():
        unit = bulge.Parameter(units.get(name, "1"), typical=1, low=-1e6, high=1e6)
        effect = bulge.Effect("own", f"k * {name} / unit", parameters={"k": N, "unit": unit})
        one = f"1 {units[name]}" if name in units else 1.0
        assert added(ppam, effect, {"k": 100.0, "unit": one}, eps, p) == pytest.approx(100 * value, rel=1e-9, abs=1e-9), name


def hose(eps, k, eps_free):
    """The example of the documentation."""
    return -k * np.maximum(eps - eps_free, 0)


HOSE = {"k": bulge.Parameter("N", typical=50, low=0, high=500), "eps_free": bulge.Parameter("1", typical=0.1, low=-0.1, high=0.4)}


@pytest.fixture(scope="module")
def effect():
    return bulge.Effect("hose-stiffness", hose, parameters=HOSE, title="Hose pulls", about="a hose", source="here", family="own", twins="membrane-axial",
        mechanism="give-of-the-rig", form="near")


def test_an_effect_as_a_file(effect, tmp_path):
    text = effect.to_toml()
    for line in ["[effects.hose-stiffness]", 'title = "Hose pulls"', 'about = "a hose"', 'source = "here"', 'family = "own"', 'twins = ["membrane-axial"]']:
        assert line in text
    path = tmp_path / "own.toml"
    path.write_text(text)
    assert bulge.read_effects(path) == text
    for own in [effect, path, str(path), [effect], [path], text]:
        assert "hose-stiffness" in bulge.effects(own=own) and "hose-stiffness" not in bulge.effects()
        card = bulge.effects("hose-stiffness", own=own)
        assert (card.mechanism, card.form) == ("give-of-the-rig", "near")
        assert card.title == "Hose pulls" and "a hose" in repr(card)
    with pytest.raises(bulge.InputError, match="none.toml"):
        bulge.read_effects(tmp_path / "none.toml")


def test_an_effect_of_a_muscle(effect, ppam):
    muscle = bulge.Muscle(name="ppam", kind="pleated", length=0.11, radius=0.016, fibres=40, effects={"hose-stiffness": {"k": "70 N", "eps_free": 0.05}}, own=effect)
    assert muscle.effects == ["hose-stiffness"] and muscle != ppam
    assert muscle.force(0.2, pressure=BAR) - ppam.force(0.2, pressure=BAR) == pytest.approx(-70 * 0.15, rel=1e-9)
    assert muscle.shape(pressure=BAR, contraction=0.2).force_n == pytest.approx(muscle.force(0.2, pressure=BAR), rel=1e-9)
    assert muscle.stiffness(0.2, pressure=BAR) - ppam.stiffness(0.2, pressure=BAR) == pytest.approx(70 / 0.11, rel=1e-7)
    varied = muscle.force(0.2, pressure=BAR, numbers={"hose-stiffness.k": ["10 N", "20 N"]})
    np.testing.assert_allclose(varied - ppam.force(0.2, pressure=BAR), [-1.5, -3.0], rtol=1e-9)
    other = pickle.loads(pickle.dumps(muscle))
    assert other == muscle and other.force(0.2, pressure=BAR) == muscle.force(0.2, pressure=BAR)
    assert bulge.Muscle.from_toml(muscle.to_toml(), own=effect) == muscle
    with pytest.raises(bulge.InputError, match=r"unknown effect `hose-stiffness`: it is not in the catalogue(.|\n)*an effect of your own needs `own=`"):
        bulge.Muscle.from_toml(muscle.to_toml())


def test_effects_travel(effect):
    other = pickle.loads(pickle.dumps(effect))
    assert other.to_toml() == effect.to_toml() and other.expression == "(-k) * max(eps - eps_free, 0)"


def test_quantities():
    assert bulge.quantity("50 N") == 50.0 and bulge.quantity("2.5 bar") == 2.5e5 and bulge.quantity("-3e-1 mm") == pytest.approx(-3e-4, rel=1e-15)
    assert bulge.quantity("3") == 3.0
    for wrong in ["N", "3 foo", "a lot"]:
        with pytest.raises(bulge.InputError):
            bulge.quantity(wrong)


REFUSED = {
    "branches": (lambda eps, k: k if eps > 0.1 else 0 * k, TypeError, "can't branch.*numpy.where"),
    "chains": (lambda eps, k: k * np.where(0.1 < eps < 0.2, 1, 0), TypeError, "can't branch"),
    "truth": (lambda eps, k: k * (eps and 1), TypeError, "can't branch"),
    "max of Python": (lambda eps, k: k * max(eps, 0), TypeError, "numpy.maximum"),
    "equality": (lambda eps, k: k * np.where(eps == 1, 1, 0), TypeError, "equal"),
    "math": (lambda eps, k: k * math.sqrt(eps), TypeError, r"numpy.sqrt.*not those of math"),
    "cbrt": (lambda eps, k: k * np.cbrt(eps), TypeError, "can't use numpy.cbrt.*tanh"),
    "sum": (lambda eps, k: k * np.sum(eps), TypeError, "can't use numpy.sum"),
    "loops": (lambda eps, k: k * sum(eps), TypeError, "looped"),
    "arrays": (lambda eps, k: k * np.array([1, 2]) * eps, TypeError, "constants are numbers"),
    "text": (lambda eps, k: "k", TypeError, "constants are numbers"),
    "nothing": (lambda eps, k: None, TypeError, "constants are numbers"),
    "infinity": (lambda eps, k: k * np.inf * eps, TypeError, "finite"),
    "unknown name": (lambda eps, q: q, bulge.InputError, "takes `q`, which is neither.*mid_radius"),
    "units of a sum": (lambda eps, k: k * eps + 3, bulge.InputError, r"cannot be added.*3 \[N\]"),
    "no force": (lambda eps, k: eps, bulge.InputError, "pure number, but must give a force"),
    "a pressure as a number": (lambda p, k: k * np.tanh(p), bulge.InputError, "(?i)pressure|Pa|unit"),
}


@pytest.mark.parametrize("name", list(REFUSED))
def test_what_an_effect_cannot_be(name):
    function, kind, words = REFUSED[name]
    with pytest.raises(kind, match=f"(?s){words}"):
        bulge.Effect("own", function, parameters={"k": N})


@pytest.mark.parametrize("function", [lambda eps, k: k * np.where((eps > 0.1) & (eps < 0.2), 1, 0), lambda eps, k: k * eps // 1])
def test_what_an_effect_cannot_be_is_said_in_its_words(function):
    with pytest.raises(TypeError, match="the force of an effect"):
        bulge.Effect("own", function, parameters={"k": N})


def test_multiples_of_quantities_keep_their_unit():
    assert bulge.Effect("own", lambda p, k: k * np.tanh(p / (2 * bar)), parameters={"k": N}).expression


def test_expressions_that_are_wrong():
    for expression, words in [("-k * (eps", r"own effects:\d+"), ("-k * colour", "colour"), ("k + 3", "cannot be added")]:
        with pytest.raises(bulge.InputError, match=words):
            bulge.Effect("own", expression, parameters={"k": N})


def test_the_catalogue():
    names = bulge.effects()
    assert len(names) == len(set(names)) > 40 and {"coulomb-friction", "bladder-elasticity", "end-taper"} <= set(names)
    for name in names:
        card = bulge.effects(name)
        assert card.name == name and card.equation and name in repr(card)
        assert pickle.loads(pickle.dumps(card)).to_dict() == card.to_dict()
    with pytest.raises(bulge.InputError, match="coulomb-friction"):
        bulge.effects("coulomb-frction")


RUBBER = {"c10": bulge.Parameter("MPa", typical=0.3, low=0, high=3), "h": bulge.Parameter("mm", typical=2, low=0.5, high=5)}


def test_a_rubber_of_ones_own_is_the_bladder():
    """The bladder of the catalogue as an expression and as a function: the same force in the equilibrium."""

    def energy(l1, l2, c10, h):
        return h * c10 * (l1**2 + l2**2 + 1 / (l1 * l2) ** 2 - 3)

    own = bulge.Effect("my-rubber", energy=energy, parameters=RUBBER)
    assert own.quantity == "energy" and pickle.loads(pickle.dumps(own)) == own
    numbers = {"kind": "braided", "length": "250 mm", "radius": "10 mm", "braid_angle": "25 deg", "wall": "2 mm"}
    shipped = bulge.Muscle(**numbers, effects={"bladder-elasticity": {"c10": "0.3 MPa"}})
    mine = bulge.Muscle(**numbers, effects={"my-rubber": {"c10": "0.3 MPa", "h": "2 mm"}}, own=own)
    for contraction in (0.02, 0.1, 0.2):
        one, other = (muscle.shape(pressure="3 bar", contraction=contraction).force_n for muscle in (shipped, mine))
        assert one == pytest.approx(other, rel=1e-11)
    with pytest.raises(bulge.InputError, match="one formula"):
        bulge.Effect("both", "k", energy="k", parameters={"k": N})
    with pytest.raises(bulge.InputError, match="nor one of l1"):
        bulge.Effect("own", energy=lambda eps, c10, h: h * c10 * eps, parameters=RUBBER)
