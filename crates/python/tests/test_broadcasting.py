"""Arrays: every kind of them gives the numbers of calls one by one, to the bit; what can't be computed is said or NaN."""

import threading

import bulge
import numpy as np
import pytest

BAR = 1e5
CONTRACTIONS, PRESSURES = [0.05, 0.17, 0.31], [1.0 * BAR, 1.5 * BAR, 2.5 * BAR, 3.0 * BAR]


@pytest.fixture(scope="module", params=["ppam", "braid"])
def muscle(request):
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="module")
def expected(muscle):
    return np.array([[muscle.force(e, pressure=p) for p in PRESSURES] for e in CONTRACTIONS])


def test_a_float_for_floats(muscle, expected):
    for e in [0.05, np.float64(0.05), np.array(0.05), "5 %"]:
        found = muscle.force(e, pressure=BAR)
        assert type(found) is float and found == expected[0, 0]


def test_arrays_broadcast(muscle, expected):
    e, p = np.array(CONTRACTIONS), np.array(PRESSURES)
    assert len(np.unique(expected)) == 12
    for contraction, pressure in [
        (e[:, None], p),
        (np.repeat(e[:, None], 4, axis=1), np.broadcast_to(p, (3, 4))),
        (e.reshape(3, 1), p.reshape(1, 4)),
        ([[x] for x in CONTRACTIONS], PRESSURES),
        ([[f"{100 * x:.0f} %"] for x in CONTRACTIONS], [f"{x / BAR} bar" for x in PRESSURES]),
        (tuple((x,) for x in CONTRACTIONS), tuple(PRESSURES)),
        (np.asfortranarray(np.broadcast_to(e[:, None], (3, 4))), p),
        (np.repeat(e, 2)[::2][:, None], p[::-1][::-1]),
        (e.astype(">f8")[:, None], p.astype(">f8")),
        (e[:, None], p.astype(np.int64)),
        (e[:, None], p.astype(np.uint32).astype(">u4")),
        (e[:, None], p.astype(np.float32)),
        (e[:, None], np.array([str(x) + " Pa" for x in PRESSURES])),
        (e[:, None], np.array([PRESSURES[0], "1.5 bar", 250000, np.float64(3e5)], dtype=object)),
    ]:
        np.testing.assert_array_equal(muscle.force(contraction, pressure=pressure), expected)
    np.testing.assert_array_equal(muscle.force(e[:, None, None], pressure=p[None, :, None])[:, :, 0], expected)
    np.testing.assert_array_equal(muscle.force(e, pressure=PRESSURES[2]), expected[:, 2])
    np.testing.assert_array_equal(muscle.force(e[::-1], pressure=PRESSURES[2]), expected[::-1, 2])
    np.testing.assert_array_equal(muscle.force(e[1], pressure=p), expected[1])


def test_half_precision_is_taken_as_it_is(ppam):
    single = np.float32([0.1, 0.2])
    np.testing.assert_array_equal(ppam.force(single, pressure=BAR), [ppam.force(float(e), pressure=BAR) for e in single])
    assert ppam.force(single, pressure=BAR).dtype == np.float64


def test_empty_arrays(muscle):
    for shape in [(0,), (0, 3), (2, 0)]:
        assert muscle.force(np.empty(shape), pressure=BAR).shape == shape
        assert muscle.evaluate(["force", "volume"], np.empty(shape), pressure=BAR)["volume"].shape == shape
    assert muscle.force([], pressure=[]).shape == (0,)
    assert muscle.contraction_limit([]).shape == (0,)


def test_arrays_are_not_changed(ppam):
    e = np.array([0.3, 0.1])
    ppam.force(e, pressure=BAR)[:] = 0
    assert e.tolist() == [0.3, 0.1]
    e.flags.writeable = False
    assert ppam.force(e, pressure=BAR).shape == (2,)


def test_pandas_series(ppam):
    pandas = pytest.importorskip("pandas")
    series = pandas.Series([0.1, 0.2], index=[7, 3])
    np.testing.assert_array_equal(ppam.force(series, pressure=BAR), ppam.force([0.1, 0.2], pressure=BAR))


def test_numbers_of_the_muscle_broadcast(ppam):
    radius, fibres = np.array([0.014, 0.016])[:, None], [20, 40, 60]
    found = ppam.evaluate(["force", "max_radius"], 0.2, pressure=BAR, radius=radius, fibres=fibres)
    for i in range(2):
        for j in range(3):
            other = ppam.replace(radius=radius[i, 0], fibres=fibres[j])
            for name in found:
                assert found[name][i, j] == other.evaluate(name, 0.2, pressure=BAR)
    slender = ppam.force(0.2, pressure=BAR, slenderness=[5.0, 10.0])
    np.testing.assert_allclose(slender, [ppam.replace(radius=0.11 / s).force(0.2, pressure=BAR) for s in [5, 10]], rtol=1e-13)
    stretchy = ppam.replace(fibre_stiffness=12e3)
    assert ppam.force(0.1, pressure=BAR, fibre_stiffness="12 kN") == pytest.approx(stretchy.force(0.1, pressure=BAR), rel=1e-13)
    # elastic_group = p sin(2 pi/n) R^2/EA
    group = BAR * np.sin(2 * np.pi / 40) * 0.016**2 / 12e3
    assert stretchy.force(0.1, pressure=BAR, elastic_group=group) == pytest.approx(stretchy.force(0.1, pressure=BAR), rel=1e-12)


def test_dimensionless_outputs(ppam):
    f, v = ppam.evaluate(["force_f", "volume_v"], 0.2).values()
    a = 40 / (2 * np.pi) * np.sin(2 * np.pi / 40)
    assert ppam.force(0.2, pressure=BAR) == pytest.approx(BAR * 0.11**2 * a * f, rel=1e-13)
    assert ppam.volume(0.2, pressure=BAR) == pytest.approx(0.11**3 * v, rel=1e-13)


def test_many_points_are_those_of_few(muscle):
    e = np.random.default_rng(1).uniform(0.02, 0.3, 9001 if muscle.kind == "pleated" else 300)
    p = np.linspace(BAR, 5 * BAR, e.size)
    many = muscle.evaluate(["force", "stiffness_adiabatic"], e, pressure=p)
    for i in [0, 63, 64, 200, e.size - 1]:
        assert many["force"][i] == muscle.force(e[i], pressure=p[i])
        assert many["stiffness_adiabatic"][i] == muscle.stiffness(e[i], pressure=p[i], gas="adiabatic")


def test_calls_from_several_threads(muscle):
    e = np.linspace(0.02, 0.3, 200)
    expected = [muscle.force(e, pressure=(1 + i) * BAR) for i in range(6)]
    found = [None] * 6

    def one(i):
        found[i] = muscle.force(e, pressure=(1 + i) * BAR)

    threads = [threading.Thread(target=one, args=(i,)) for i in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    np.testing.assert_array_equal(found, expected)


def test_nan_exactly_beyond_the_limit(muscle):
    limit = muscle.contraction_limit(2 * BAR)
    e = np.linspace(limit - 0.05, limit + 0.05, 101)
    force = muscle.force(e, pressure=2 * BAR, errors="coerce")
    beyond = e > limit * (1 + 1e-9)
    np.testing.assert_array_equal(np.isnan(force), beyond)
    assert 45 < beyond.sum() < 55 and np.all(force[~beyond] >= -1e-6)
    rest = muscle.evaluate(["volume", "stiffness"], e, pressure=2 * BAR, errors="coerce")
    np.testing.assert_array_equal(np.isnan(rest["volume"]), beyond)


def test_contraction_limits(muscle):
    pressures = np.array([[1.0, 2.0], [3.0, 4.0]]) * BAR
    limits = muscle.contraction_limit(pressures)
    assert limits.shape == (2, 2) and limits[1, 0] == muscle.contraction_limit("3 bar")
    np.testing.assert_allclose(muscle.force(limits * (1 - 1e-12), pressure=pressures), 0, atol=1e-5)


def test_the_first_point_beyond_the_limit_is_named(ppam):
    e = np.full((2, 3), 0.1)
    e[1, 1] = e[1, 2] = 0.6
    with pytest.raises(bulge.NoSolutionError, match=r"ppam: 2 of 6 points; the first at index \(1, 1\): .*60\.0000 %.*41\.84.*errors=\"coerce\"") as caught:
        ppam.force(e, pressure=BAR)
    assert isinstance(caught.value, ValueError)
    with pytest.raises(bulge.NoSolutionError, match="limit of this muscle is 41.84"):
        ppam.force(0.6, pressure=BAR)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_what_is_no_number_is_refused(ppam, wrong):
    for call in [lambda: ppam.force(wrong, pressure=BAR), lambda: ppam.force([0.1, wrong], pressure=BAR), lambda: ppam.force(0.1, pressure=[BAR, wrong])]:
        with pytest.raises(ValueError, match="finite number") as caught:
            call()
        assert isinstance(caught.value, bulge.BulgeError)
    found = ppam.force([0.1, wrong, 0.2], pressure=BAR, errors="coerce")
    assert np.isnan(found).tolist() == [False, True, False]
    for limit in [lambda: ppam.contraction_limit(wrong), lambda: ppam.shape(pressure=wrong, contraction=0.1), lambda: ppam.shape(pressure=BAR, contraction=wrong)]:
        with pytest.raises(ValueError, match="finite number"):
            limit()


WRONG = {
    "no such output": (lambda m: m.evaluate("forc", 0.1, pressure=BAR), "no output `forc`.*force_f"),
    "no such number": (lambda m: m.force(0.1, pressure=BAR, colour=3), "nothing called `colour`.*slenderness"),
    "another unit": (lambda m: m.force("20 mm", pressure=BAR), "contraction: `20 mm` is a length"),
    "no unit": (lambda m: m.force(0.1, pressure="2"), "pressure: `2` is a pure number"),
    "another unit in a list": (lambda m: m.force(0.1, pressure=["2 bar", "2 N"]), "pressure: `2 N` is a force"),
    "no pressure": (lambda m: m.evaluate("force", 0.1), "gauge pressure"),
    "none": (lambda m: m.force(None, pressure=BAR), "contraction.*number"),
    "complex": (lambda m: m.force(np.array([0.1j]), pressure=BAR), "complex128"),
    "dates": (lambda m: m.force(np.array(["2020-01-01"], dtype="M8[D]"), pressure=BAR), "datetime64"),
    "no such method": (lambda m: m.force(0.1, pressure=BAR, method="newton"), "no `newton`.*shooting"),
    "no such errors": (lambda m: m.force(0.1, pressure=BAR, errors="ignore"), "ignore.*coerce"),
    "no such gas": (lambda m: m.stiffness(0.1, pressure=BAR, gas="helium"), "helium.*isothermal"),
    "no such progress": (lambda m: m.force(0.1, pressure=BAR, progress=3), "progress"),
}


@pytest.mark.parametrize("name", list(WRONG))
def test_mistakes_are_said_with_their_cure(ppam, name):
    wrong, words = WRONG[name]
    with pytest.raises(bulge.InputError, match=f"(?s){words}"):
        wrong(ppam)


def test_shapes_that_do_not_fit_are_value_errors(ppam):
    with pytest.raises(ValueError, match="broadcast"):
        ppam.force([0.1, 0.2], pressure=[1e5, 2e5, 3e5])
    with pytest.raises(ValueError):
        ppam.force([[0.1], [0.1, 0.2]], pressure=BAR)


def test_pressure_must_push(ppam):
    for pressure in [0.0, -BAR]:
        for call in [ppam.force, ppam.shape]:
            with pytest.raises(bulge.InputError, match="greater than 0"):
                call(contraction=0.1, pressure=pressure)


@pytest.mark.parametrize("contraction", [1.0, "120 %"])
def test_a_muscle_that_contracts_by_its_length_has_none(ppam, braid, cylinder, contraction):
    for muscle in [ppam, braid, cylinder]:
        calls = [
            lambda: muscle.force(contraction, pressure=BAR),  # noqa: B023
            lambda: muscle.evaluate(["force", "volume"], contraction, pressure=[BAR, 2 * BAR]),  # noqa: B023
            lambda: muscle.shape(contraction=contraction, pressure=BAR),  # noqa: B023
        ]
        # One input is one exception, whatever asks.
        for call in calls:
            with pytest.raises(bulge.InputError, match="contracts by 100 % has no length") as caught:
                call()
            assert "\n" not in str(caught.value)
    found = ppam.force([0.1, 1.0, "120 %"], pressure=BAR, errors="coerce")
    assert np.isnan(found).tolist() == [False, True, True]


BRAID_WITH_WALL = """
name = "b"
kind = "braided"
length = "250 mm"
radius = "10 mm"
braid_angle = "25 deg"
wall = "{wall}"
[effects.wall-thickness]
"""


@pytest.mark.parametrize("wall", ["-2 mm", "10 mm", "nan mm"])
def test_walls_that_leave_no_room_are_refused(tmp_path, wall):
    numbers = {"kind": "braided", "length": "250 mm", "radius": "10 mm", "braid_angle": "25 deg"}
    text = BRAID_WITH_WALL.format(wall=wall)
    file = tmp_path / "braid.toml"
    file.write_text(text)
    hose = bulge.Muscle.from_toml(BRAID_WITH_WALL.format(wall="2 mm"))
    ways = [
        lambda: bulge.Muscle(wall=wall, **numbers).force(0.1, pressure=BAR),
        lambda: bulge.Muscle.from_toml(text),
        lambda: bulge.Muscle.from_toml(file),
        lambda: hose.replace(wall=wall),
    ]
    for way in ways:
        with pytest.raises(bulge.InputError, match="wall"):
            way()
    with pytest.raises(bulge.BulgeError, match="wall"):
        hose.force(0.1, pressure=BAR, wall=wall)
    assert wall == "nan mm" or np.isnan(hose.force(0.1, pressure=BAR, wall=wall, errors="coerce"))


def test_the_same_mistake_is_the_same_exception(ppam):
    kinds = set()
    for call in [lambda: ppam.force(float("nan"), pressure=BAR), lambda: ppam.shape(contraction=float("nan"), pressure=BAR)]:
        with pytest.raises(bulge.BulgeError) as caught:
            call()
        kinds.add(type(caught.value))
    assert len(kinds) == 1


def test_numbers_that_contradict_each_other_are_refused(ppam):
    with pytest.raises(bulge.InputError):
        ppam.force(0.1, pressure=BAR, radius="20 mm", slenderness=5.0)
