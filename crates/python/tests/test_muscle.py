"""Muscles: what they are made of, and their force, volume and stiffness against solutions that share no code with them."""

import copy
import pickle

import bulge
import numpy as np
import pytest

BAR = 1e5


@pytest.mark.parametrize("contraction", [0.03, 0.2, 0.38])
@pytest.mark.parametrize("method", ["closed-form", "shooting"])
def test_pleated_muscle_against_integration_of_its_equilibrium(ppam, pleated_reference, contraction, method):
    expected = vars(pleated_reference(0.11, 0.016, 40, contraction, 2 * BAR))
    found = ppam.evaluate(list(expected), contraction, pressure=2 * BAR, method=method)
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=1e-9, abs=1e-12), name


def test_few_fibres_of_another_muscle(pleated_reference):
    expected = pleated_reference(0.3, 0.02, 6, 0.25, 1.7 * BAR)
    muscle = bulge.Muscle(kind="pleated", length=0.3, radius=0.02, fibres=6)
    assert muscle.force(0.25, pressure=1.7 * BAR) == pytest.approx(expected.force, rel=1e-9)
    assert muscle.volume(0.25, pressure=1.7 * BAR) == pytest.approx(expected.volume, rel=1e-9)


@pytest.mark.parametrize("contraction", [-0.002, 0.1])
def test_fibres_that_stretch(ppam, pleated_reference, contraction):
    expected = vars(pleated_reference(0.11, 0.016, 40, contraction, 3 * BAR, stiffness=12e3))
    found = ppam.replace(fibre_stiffness="12 kN").evaluate(list(expected), contraction, pressure=3 * BAR)
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=1e-9), name


@pytest.mark.parametrize("contraction", [0.03, 0.12])
def test_clamped_braid_against_integration_of_its_equilibrium(braid, braid_reference, contraction):
    expected = vars(braid_reference(0.06, 0.010725, np.radians(25.0), contraction, 3 * BAR))
    found = braid.evaluate(list(expected), contraction, pressure=3 * BAR)
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=1e-9), name


def test_specimens_are_muscles_of_their_own():
    numbers = {"kind": "braided", "radius": "10 mm", "braid_angle": "25 deg", "ends": "clamped"}
    hose = bulge.Muscle(length="250 mm", specimens={"short": {"length": "60 mm"}, "no. 2": {}}, **numbers)
    assert hose.specimens == ["short", "no. 2"]
    assert bulge.Muscle.from_toml(hose.to_toml()).specimens == hose.specimens
    short = bulge.Muscle(length="60 mm", **numbers)
    for name, muscle in [("short", short), ("no. 2", hose)]:
        assert hose.specimen(name).force(0.1, pressure=2 * BAR) == muscle.force(0.1, pressure=2 * BAR)
    with pytest.raises(bulge.InputError, match="there is no specimen `long`"):
        hose.specimen("long")
    with pytest.raises(bulge.InputError, match="greater than 0"):
        bulge.Muscle(length="250 mm", specimens={"short": {"length": "-60 mm"}}, **numbers)


def test_cylinder_formula(cylinder):
    contraction, pressure = np.linspace(-0.05, 0.3, 8)[:, None], np.array([1.0, 4.0]) * BAR
    a, b = 3 / np.tan(np.radians(25)) ** 2, 1 / np.sin(np.radians(25)) ** 2
    expected = pressure * np.pi * 0.010725**2 * (a * (1 - contraction) ** 2 - b)
    np.testing.assert_allclose(cylinder.force(contraction, pressure=pressure), expected, rtol=1e-12)
    limit = 1 - np.sqrt(b / a)
    assert cylinder.contraction_limit("3 bar") == pytest.approx(limit, rel=1e-12)
    # A fibre of the length b on a cylinder: r = sqrt(b^2 - l^2)/(2 pi N).
    radius = 0.010725 * np.sqrt(1 - (np.cos(np.radians(25)) * 0.9) ** 2) / np.sin(np.radians(25))
    assert cylinder.volume(0.1, pressure=BAR) == pytest.approx(np.pi * radius**2 * 0.225, rel=1e-12)


@pytest.mark.parametrize(
    ("effects", "c10", "c01", "wall"),
    [
        ({"bladder-elasticity": {"c10": "0.2 MPa"}}, 2e5, 0.0, 0.0),
        ({"bladder-elasticity": {"c10": "0.2 MPa", "c01": "0.05 MPa"}}, 2e5, 5e4, 0.0),
        ({"wall-thickness": {"thickness": "1.5 mm"}}, 0.0, 0.0, 0.0015),
    ],
)
def test_cylinder_with_rubber_and_wall_by_its_energy(effects, c10, c01, wall):
    muscle = bulge.Muscle(kind="braided", length=0.25, radius=0.01, braid_angle="25 deg", ends="cylinder", wall="2 mm", effects=effects)
    p, cosine, sine = 3 * BAR, np.cos(np.radians(25)), np.sin(np.radians(25))

    def energy(length):
        axial = length / 0.25
        hoop = np.sqrt(1 - (cosine * axial) ** 2) / sine
        i1 = axial**2 + hoop**2 + (axial * hoop) ** -2
        i2 = axial**-2 + hoop**-2 + (axial * hoop) ** 2
        rubber = 2 * np.pi * 0.01 * 0.002 * 0.25 * (c10 * (i1 - 3) + c01 * (i2 - 3))
        return rubber - p * np.pi * (0.01 * hoop - wall) ** 2 * length

    for contraction in [-0.03, 0.0, 0.08, 0.2]:
        length, h = 0.25 * (1 - contraction), 1e-5
        expected = (energy(length - 2 * h) - 8 * energy(length - h) + 8 * energy(length + h) - energy(length + 2 * h)) / (12 * h)
        assert muscle.force(contraction, pressure=p) == pytest.approx(expected, rel=1e-8), contraction


@pytest.mark.parametrize("fixture", ["ppam", "cylinder", "braid"])
def test_force_is_the_work_of_the_gas(fixture, request):
    muscle = request.getfixturevalue(fixture)
    length, p, e, h = muscle.number("length"), 2 * BAR, 0.15, 1e-4
    volumes = muscle.evaluate("volume_polygon", [e - 2 * h, e - h, e + h, e + 2 * h], pressure=p)
    slope = (volumes[0] - 8 * volumes[1] + 8 * volumes[2] - volumes[3]) / (12 * h) / -length
    assert muscle.force(e, pressure=p) == pytest.approx(-p * slope, rel=1e-8)


@pytest.mark.parametrize("fixture", ["ppam", "cylinder", "braid"])
def test_stiffness_is_the_slope_of_the_force(fixture, request):
    muscle = request.getfixturevalue(fixture)
    length, p, e, h = muscle.number("length"), 2 * BAR, 0.15, 1e-4
    f = muscle.force([e - 2 * h, e - h, e + h, e + 2 * h], pressure=p)
    slope = (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h)
    assert muscle.stiffness(e, pressure=p) == pytest.approx(-slope / length, rel=1e-8)
    assert muscle.evaluate("force_by_contraction", e, pressure=p) == pytest.approx(slope, rel=1e-8)


def test_gas_that_is_shut_in_stiffens(ppam):
    p, atmosphere, e = 2 * BAR, 101325.0, 0.2
    opened, slow, fast = (ppam.stiffness(e, pressure=p, gas=gas) for gas in ["open", "isothermal", "adiabatic"])
    # Of inextensible fibres V doesn't depend on p, F_p is -V_l.
    volume, force = ppam.evaluate("volume_polygon", e, pressure=p), ppam.force(e, pressure=p)
    for exponent, found in [(1.0, slow), (1.4, fast)]:
        gas = exponent * (p + atmosphere) / volume * (force / p) ** 2
        assert found == pytest.approx(opened + gas, rel=1e-9)
    assert opened < slow < fast


def test_exact_derivatives_by_numbers_of_the_muscle(ppam):
    h = 1e-6
    for name, value in [("radius", 0.016), ("length", 0.11)]:
        f = [ppam.replace(**{name: value + s * h}).force(0.2, pressure=BAR) for s in (-1, 1)]
        found = ppam.evaluate(f"force_by_{name}", 0.2, pressure=BAR)
        assert found == pytest.approx((f[1] - f[0]) / (2 * h), rel=1e-6), name
    assert ppam.evaluate("force_by_pressure", 0.2, pressure=BAR) == pytest.approx(ppam.force(0.2, pressure=BAR) / BAR, rel=1e-12)


def test_numbers_and_text_are_the_same_muscle():
    numbers = bulge.Muscle(
        kind="braided", length=0.25, radius=0.010725, braid_angle=np.pi / 180 * 25, wall=0.002, ends="clamped", fibres=60,
        fibre={"stiffness": 12e3, "section": 3e-7}, effects={"bladder-elasticity": {"c10": 2e5}, "coulomb-friction": {"force": 15}},
        instruments={"force": {"noise": 4.0, "zero": 1, "gain": 0.001}, "pressure": {"noise": 30.0}, "length": {"noise": 5e-6}},
    )  # fmt: skip
    text = bulge.Muscle(
        kind="braided", length="250 mm", radius="10.725 mm", braid_angle="25 deg", wall="2 mm", ends="clamped", fibres=60,
        fibre={"stiffness": "12 kN", "section": "0.3 mm^2"}, effects={"bladder-elasticity": {"c10": "0.2 MPa"}, "coulomb-friction": {"force": "15 N"}},
        instruments={"force": {"noise": "4 N", "zero": "1 N", "gain": "0.1 %"}, "pressure": {"noise": "0.3 mbar"}, "length": {"noise": "5 um"}},
    )  # fmt: skip
    for name in ["length", "radius", "braid_angle", "wall", "fibres", "fibre_stiffness", "c10"]:
        assert numbers.number(name) == pytest.approx(text.number(name), rel=1e-15), name
    assert numbers.number("braid_angle") == pytest.approx(np.radians(25), rel=1e-15)
    assert numbers.to_toml() == text.to_toml()
    assert numbers.force(0.1, pressure=3 * BAR) == text.force("10 %", pressure="3 bar")


#: Every key of a muscle file, with the line that says it.
KEYS = {
    "pleated": [
        ({"fibre": {"stiffness": "12 kN", "section": "0.3 mm^2"}}, 'fibre = { stiffness = "12 kN", section = "0.3 mm^2" }'),
        ({"effects": {"end-radius": {"radius": 0.015}}}, 'radius = "15 mm"'),
        ({"effects": {"pleat-depth": {"depth": 0.0045}}}, 'depth = "4.5 mm"'),
        ({"effects": {"lobes": {"circumference": 0.33}}}, 'circumference = "330 mm"'),
        ({"effects": {"fibre-misalignment": {"angle": "2 deg"}}}, 'angle = "2 deg"'),
        ({"effects": {"limited-unfolding": {"hoop_stiffness": 81e3, "unfolded_radius": 0.05}}}, 'hoop_stiffness = "81 kN/m"'),
        ({"instruments": {"length": {"noise": 5e-6, "zero": 5e-5, "gain": 0.001}}}, 'length = { noise = "0.005 mm", zero = "0.05 mm", gain = "0.1 %" }'),
        ({"length": "110 mm +- 0.2 mm"}, 'length = "110 mm +- 0.2 mm"'),
        ({"name": 'a "quoted" name, größer'}, """name = 'a "quoted" name, größer'"""),
    ],
    "braided": [
        ({"ends": "cylinder"}, 'ends = "cylinder"'),
        ({"wall": 0.002}, 'wall = "2 mm"'),
        ({"fibres": 60}, "fibres = 60"),
        ({"effects": {"bladder-elasticity": {"c10": 2e5, "c01": "0.05 MPa", "wall": "2 mm"}}}, 'c01 = "0.05 MPa"'),
        ({"effects": {"wall-thickness": {"thickness": 0.002}}}, 'thickness = "2 mm"'),
    ],
}


@pytest.mark.parametrize(("kind", "stated", "line"), [(kind, *case) for kind, cases in KEYS.items() for case in cases])
def test_every_key_of_a_muscle_file(kind, stated, line, tmp_path):
    plain = {"kind": kind, "length": 0.11, "radius": 0.016}
    plain |= {"fibres": 40} if kind == "pleated" else {"braid_angle": 0.4}
    muscle = bulge.Muscle(**(plain | stated))
    assert line in muscle.to_toml()
    assert muscle != bulge.Muscle(**plain)
    text = muscle.to_toml(tmp_path / "muscle.toml")
    assert (tmp_path / "muscle.toml").read_text(encoding="utf-8") == text
    for other in [bulge.Muscle.from_toml(text), bulge.Muscle.from_toml(tmp_path / "muscle.toml"), bulge.Muscle.from_toml(str(tmp_path / "muscle.toml"))]:
        assert other == muscle and other.to_toml() == text
    assert pickle.loads(pickle.dumps(muscle)) == muscle == copy.deepcopy(muscle)
    assert hash(pickle.loads(pickle.dumps(muscle))) == hash(muscle)


def test_a_continuous_membrane_by_keyword():
    muscle = bulge.Muscle(kind="pleated", length=0.11, radius=0.016, fibres="continuous")
    of_forty = bulge.Muscle.preset("ppam-2-r16").force(0.2, pressure=BAR)
    assert muscle.force(0.2, pressure=BAR) == pytest.approx(of_forty * np.pi / (20 * np.sin(np.pi / 20)), rel=1e-9)


def test_a_name_beyond_the_basic_plane():
    assert bulge.Muscle(name="muscle 💪", kind="pleated", length=0.11, radius=0.016, fibres=40).name == "muscle 💪"


@pytest.mark.parametrize(
    ("kind", "effect"),
    [
        ("braided", {"bladder-elasticity": {"c10": 2e5, "wall": 0.002}}),
        ("braided", {"bladder-elasticity": {"c10": 2e5, "c01": 5e4, "wall": "2 mm"}}),
        ("pleated", {"fibre-misalignment": {"angle": 0.03}}),
    ],
)
def test_numbers_of_effects_are_si(kind, effect):
    bulge.Muscle(kind=kind, length=0.11, radius=0.016, effects=effect, **({"fibres": 40} if kind == "pleated" else {"braid_angle": 0.4}))


def test_effects_that_a_muscle_states():
    stated = {"bladder-elasticity": {"c10": "0.2 MPa"}, "coulomb-friction": {"force": "15 N"}}
    assert sorted(bulge.Muscle(kind="braided", length=0.25, radius=0.01, braid_angle=0.4, wall=0.002, effects=stated).effects) == sorted(stated)


def test_a_name_states_no_effect():
    with pytest.raises(bulge.InputError, match="name"):
        bulge.Muscle(name="two\n[effects.hysteresis]\nlines", kind="pleated", length=0.11, radius=0.016, fibres=40)
    muscle = bulge.Muscle(name='[effects.hysteresis] "one" line', kind="pleated", length=0.11, radius=0.016, fibres=40)
    assert muscle.effects == [] and bulge.Muscle.from_toml(muscle.to_toml()).name == muscle.name


def test_advice_is_in_the_words_of_python():
    with pytest.raises(bulge.InputError, match=r"`bulge\.effects\(\)` lists .*an effect of your own needs `own=`"):
        bulge.Muscle(kind="pleated", length=0.11, radius=0.016, fibres=40, effects={"zzzzzzzz": {"k": 1.0}})


def test_replace(ppam):
    other = ppam.replace(radius="17 mm", fibres=36)
    assert (other.number("radius"), other.number("fibres"), other.number("length")) == (pytest.approx(0.017), 36, pytest.approx(0.11))
    assert other.force(0.2, pressure=BAR) == bulge.Muscle(kind="pleated", length=0.11, radius=0.017, fibres=36).force(0.2, pressure=BAR)
    assert ppam.number("radius") == pytest.approx(0.016) and ppam.number("braid_angle") is None
    for wrong, word in [
        ({"radius": "3 bar"}, "pressure"),
        ({"radius": -1}, "greater than 0"),
        ({"fibres": 36.5}, "whole number"),
        ({"braid_angle": 0.3}, "braided"),
        ({"colour": 1}, "colour"),
    ]:
        with pytest.raises(bulge.InputError, match=word):
            ppam.replace(**wrong)


@pytest.mark.parametrize("name", list(bulge.presets()))
def test_presets(name):
    muscle = bulge.Muscle.preset(name)
    assert muscle.name == name and bulge.presets()[name]
    assert bulge.Muscle.from_toml(muscle.to_toml()) == muscle
    assert name in repr(muscle) and muscle.kind in repr(muscle) and f"{1e3 * muscle.number('length'):.5g} mm" in repr(muscle)
    assert "<pre>" in muscle._repr_html_()


def test_characteristics(ppam):
    table = ppam.curve(["1 bar", "2 bar"], points=5)
    assert list(table.columns) == ["pressure_pa", "contraction", "force_n", "volume_m3", "stiffness_n_per_m", "max_radius_m"]
    assert table.pressure_pa.tolist() == [BAR] * 5 + [2 * BAR] * 5
    assert table.contraction.iloc[4] == pytest.approx(ppam.contraction_limit(BAR), rel=1e-12)
    assert table.force_n.iloc[4] == pytest.approx(0, abs=1e-6)
    row = table.iloc[7]
    assert (row.force_n, row.volume_m3) == (ppam.force(row.contraction, pressure=2 * BAR), ppam.volume(row.contraction, pressure=2 * BAR))
    assert row.stiffness_n_per_m == ppam.stiffness(row.contraction, pressure=2 * BAR)


def test_the_worked_numbers_of_the_readme():
    shape = bulge.Muscle.preset("ppam-2-r16").shape(pressure="1 bar", contraction="20 %")
    assert (round(shape.force_n, 1), round(1e6 * shape.volume_m3, 1)) == (544.0, 376.9)


WRONG = [
    (lambda: bulge.Muscle(kind="pleated", length=1, radius="3 bar", fibres=40), "muscle:4:10.*pressure.*length"),
    (lambda: bulge.Muscle(kind="pleated", length=0.11, radius=0.016), "fibres.*missing"),
    (lambda: bulge.Muscle(kind="round", length=0.11, radius=0.016), "kind"),
    (lambda: bulge.Muscle(kind="pleated", length=float("nan"), radius=0.016, fibres=40), "nan"),
    (lambda: bulge.Muscle(kind="pleated", length=0.11, radius=0.016, fibres=40, fibre={"stifness": 1}), "did you mean `stiffness`"),
    (lambda: bulge.Muscle(kind="pleated", length=0.11, radius=0.016, fibres=40, effects={"colour": {"x": 1}}), "unknown effect `colour`"),
    (lambda: bulge.Muscle(kind="pleated", length=0.11, radius=0.016, fibres=4.5), "whole number"),
    (lambda: bulge.Muscle.preset("ppam-3"), "ppam-2-r16"),
    (lambda: bulge.Muscle.from_toml("/nowhere/muscle.toml"), "no such file"),
    (lambda: bulge.si("2 bar", "N"), "pressure.*force"),
    (lambda: bulge.si([1], "Pa"), "neither a number"),
]


@pytest.mark.parametrize(("wrong", "words"), WRONG)
def test_mistakes_are_said_with_their_cure(wrong, words):
    with pytest.raises(bulge.InputError, match=f"(?s){words}") as caught:
        wrong()
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, bulge.BulgeError)
