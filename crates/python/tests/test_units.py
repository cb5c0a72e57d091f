"""Bare numbers are SI: those that nobody means are refused, and text says what it is."""

import bulge
import numpy as np
import pytest


@pytest.mark.parametrize(
    ("value", "unit", "name", "says"),
    [
        (3, "Pa", "pressure", 'pressure: 3 is 3 Pa, bare numbers are SI: write "3 bar" or 3e5'),
        (-0.5, "Pa", "pressure", 'pressure: -0.5 is -0.5 Pa, bare numbers are SI: write "-0.5 bar" or -5e4'),
        (np.float32(99), "Pa", "supply", 'supply: 99 is 99 Pa, bare numbers are SI: write "99 bar" or 9.9e6'),
        (0.3, "Pa", "c10", 'c10: 0.3 is 0.3 Pa, bare numbers are SI: write "0.3 MPa" or 3e5'),
        (110, "m", "length", 'length: 110 is 110 m, bare numbers are SI: write "110 mm" or 0.11'),
        (20, "%", "contraction", 'contraction: 20 is 2000 %, bare numbers are SI: write "20 %" or 0.2'),
        (25, "rad", "angle", 'angle: 25 is 25 rad, bare numbers are SI: write "25 deg" or 0.4363'),
    ],
)
def test_implausible_bare_numbers(value, unit, name, says):
    with pytest.raises(bulge.InputError) as caught:
        bulge.si(value, unit, name)
    assert str(caught.value) == says


@pytest.mark.parametrize(
    ("value", "unit", "found"),
    [
        (0, "Pa", 0.0), (0.0, "m", 0.0), (100, "Pa", 100.0), (-2e5, "Pa", -2e5), ("3 Pa", "Pa", 3.0), ("60 m", "m", 60.0), (50, "m", 50.0), (1, "%", 1.0), (-0.1, "%", -0.1),
        ("150 %", "%", 1.5), ("400 deg", "rad", np.radians(400)), (6.28, "rad", 6.28), (6.875, "1", 6.875), (3, "N", 3.0),
    ],
)  # fmt: skip
def test_plausible_numbers_and_text(value, unit, found):
    assert bulge.si(value, unit) == pytest.approx(found)


def test_arrays_are_judged_by_their_largest(ppam):
    assert ppam.force(0.1, pressure=np.array([10.0, 1e5])).shape == (2,)
    assert ppam.force(0.1, pressure=["10 Pa", "1 bar"]).shape == (2,)
    assert ppam.force(np.linspace(0.01, 0.3, 5), pressure=1e5).shape == (5,)
    for wrong, words in [
        ({"contraction": 0.1, "pressure": np.array([1.0, 2.0, 3.0])}, "pressure: 3 is 3 Pa"),
        ({"contraction": 0.1, "pressure": [1, 2, 3]}, "pressure: 3 is 3 Pa"),
        ({"contraction": 0.1, "pressure": ["2 bar", 3]}, "pressure: 3 is 3 Pa"),
        ({"contraction": [5, 20], "pressure": 1e5}, "contraction: 20 is 2000 %"),
        ({"contraction": 0.1, "pressure": 1e5, "radius": [16, 80]}, "radius: 80 is 80 m"),
    ]:
        with pytest.raises(bulge.InputError, match=words):
            ppam.force(**wrong)


def test_every_way_in(ppam):
    for ask, words in [
        (lambda: bulge.Muscle(kind="pleated", length=110, radius=0.016), 'length: 110 is 110 m, bare numbers are SI: write "110 mm" or 0.11'),
        (lambda: bulge.Muscle(kind="braided", length=0.1, radius=0.01, braid_angle=25), 'braid_angle: 25 is 25 rad'),
        (lambda: ppam.shape(pressure=2, contraction=0.2), "pressure: 2 is 2 Pa"),
        (lambda: ppam.shape(pressure="2 bar", contraction=20), "contraction: 20 is 2000 %"),
        (lambda: ppam.shape(pressure="2 bar", length=90), 'length: 90 is 90 m, bare numbers are SI: write "90 mm" or 0.09'),
        (lambda: ppam.contraction_limit(3), "pressure: 3 is 3 Pa"),
        (lambda: ppam.replace(length=110), "length: 110 is 110 m"),
    ]:
        with pytest.raises(bulge.InputError, match=words):
            ask()
    # What rightly is small stays: deviations, slendernesses, forces.
    bulge.Muscle(kind="pleated", length=0.11, radius=0.016, fibres=40, instruments={"pressure": {"noise": 20.0}, "force": {"noise": 2.0}})
    assert ppam.force(0.1, pressure=1e5, slenderness=8) > 0
