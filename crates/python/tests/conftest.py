"""What the tests share: muscles, small measurements, the command line, and equilibria by SciPy that share no code with Bulge."""

import json
import os
import subprocess
from types import SimpleNamespace

import bulge
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import root

#: Three sweeps of 60 rows: a diagnosis takes less than a second.
PROTOCOL = """
pause = "10 s"
[[block]]
pressures = ["2 bar", "3 bar", "4 bar"]
contraction = "1 %..20 %"
shape = "loops"
cycles = 2
period = "50 s"
rows = 30
[noise]
force = "2 N"
[sampling]
force = "0.1 N"
"""


#: A table that is built in a moment.
SMALL_TABLE = """
muscle = "ppam-2-r16"
outputs = ["volume_v"]
[axes.contraction]
range = "1 %..20 %"
[table]
tolerance = 1e-3
gradient = 1e-1
max_size = "8 KiB"
checks = 100000
"""

@pytest.fixture(scope="session")
def ppam():
    """The second-generation pleated muscle; its fibres don't stretch."""
    return bulge.Muscle(name="ppam", kind="pleated", length=0.11, radius=0.016, fibres=40)


@pytest.fixture(scope="session")
def cylinder():
    """A braid as the textbooks have it, with the widths of the rig."""
    return bulge.Muscle(
        name="cylinder", kind="braided", length="250 mm", radius="10.725 mm", braid_angle="25 deg", ends="cylinder", wall="2 mm",
        instruments={"force": {"noise": 2.0, "zero": "1 N"}, "pressure": {"noise": 100.0}, "length": {"noise": "20 um"}},
    )  # fmt: skip


@pytest.fixture(scope="session")
def braid():
    """A short braid with clamped ends."""
    return bulge.Muscle(name="braid", kind="braided", length=0.06, radius=0.010725, braid_angle=np.radians(25.0))


@pytest.fixture(scope="session")
def protocol():
    """A test of 180 rows."""
    return PROTOCOL


@pytest.fixture(scope="session")
def rubbed(cylinder):
    """Measurements of the cylinder in which friction and a bladder are hidden."""
    return bulge.simulate(cylinder, PROTOCOL, {"coulomb-friction": "14 N", "bladder-elasticity": "0.3 MPa"}, seed=7)


@pytest.fixture(scope="session")
def diagnosed(rubbed):
    """Its diagnosis."""
    return bulge.diagnose(rubbed.data, rubbed.muscle)


@pytest.fixture(scope="session")
def command():
    """The command line of the same sources: returns what a command prints. The environment variable BULGE_COMMAND names the program."""
    program = os.environ.get("BULGE_COMMAND")
    if not program:
        pytest.skip("BULGE_COMMAND names no program")

    def run(*arguments, cwd=None):
        made = subprocess.run([program, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, check=False, timeout=60)
        assert made.returncode == 0, made.stderr
        return made.stdout

    return run


@pytest.fixture(scope="session")
def document(command):
    """The same, as a JSON document."""
    return lambda *arguments, cwd=None: json.loads(command(*arguments, "--json", cwd=cwd))


@pytest.fixture(scope="session")
def pleated_reference():
    """Equilibria of a pleated muscle, by SciPy."""
    return pleated_by_scipy


@pytest.fixture(scope="session")
def braid_reference():
    """Equilibria of a clamped braid, by SciPy."""
    return braid_by_scipy


def pleated_by_scipy(length, radius, fibres, contraction, pressure, stiffness=None):
    """Fibres along the axis on a pressurised bellows of polygons: the tension N of all is constant, so that a piece of them in equilibrium has
    d(psi)/ds = (p/N) dA/dr (psi downwards from mid-length), and a cut at mid-length gives F = N - p A."""
    area = lambda r: 0.5 * fibres * np.sin(2 * np.pi / fibres) * r**2  # noqa: E731
    slope = lambda r: fibres * np.sin(2 * np.pi / fibres) * r  # noqa: E731

    def run(unknown):
        middle, tension = radius + length * np.exp(unknown[0]), pressure * length**2 * np.exp(unknown[1])
        strain = tension / (fibres * stiffness) if stiffness else 0.0

        def turn(_, y):
            _, r, psi = y[:3]
            return [np.cos(psi), -np.sin(psi), pressure * slope(r) / tension, np.pi * r**2 * np.cos(psi), area(r) * np.cos(psi)]

        ends = _integrated(turn, [0.0, middle, 0.0, 0.0, 0.0], 0.5 * length * (1 + strain))
        return middle, tension, strain, ends

    def misses(unknown):
        _, _, _, ends = run(unknown)
        return [(ends[1] - radius) / length, ends[0] / length - 0.5 * (1 - contraction)]

    middle, tension, strain, ends = run(_solved(misses, np.log([0.25, 1.0])))
    return SimpleNamespace(
        force=tension - pressure * area(middle), volume=2 * ends[3], volume_polygon=2 * ends[4], max_radius=middle,
        fibre_tension=tension / fibres, fibre_strain=strain, end_slope=ends[2],
    )  # fmt: skip


def braid_by_scipy(length, radius, angle, contraction, pressure):
    """Two families of fibres, pinned where they cross: sin(theta) = q r. What all of them carry along their own direction is N/cos(theta) with
    the meridional force N = H/cos(theta); (F + p pi r^2)/N is the cosine of the slope."""
    q = np.sin(angle) / radius

    def run(unknown):
        # Between the radius at the fittings and that of fibres which run around the axis.
        middle = radius + (1 / q - radius) / (1 + np.exp(-unknown[0]))
        h = pressure * radius**2 * np.exp(unknown[1])

        def turn(_, y):
            _, r, psi = y[:3]
            cosine = np.sqrt(1 - (q * r) ** 2)
            force, rise = h / cosine, h * q**2 * r / cosine**3
            curvature = (2 * np.pi * pressure * r - rise * np.cos(psi)) / force
            # By the length of a fibre: a meridian goes on by the cosine of its angle.
            return [cosine * np.cos(psi), -cosine * np.sin(psi), cosine * curvature, cosine * np.pi * r**2 * np.cos(psi)]

        return middle, h, _integrated(turn, [0.0, middle, 0.0, 0.0], 0.5 * length / np.cos(angle))

    def misses(unknown):
        _, _, ends = run(unknown)
        return [(ends[1] - radius) / length, ends[0] / length - 0.5 * (1 - contraction)]

    middle, h, ends = run(_solved(misses, np.array([0.0, np.log(20.0)])))
    force = h / np.sqrt(1 - (q * middle) ** 2) - pressure * np.pi * middle**2
    return SimpleNamespace(force=force, volume=2 * ends[3], max_radius=middle, end_slope=ends[2])


def _integrated(turn, start, length):
    found = solve_ivp(turn, (0.0, length), start, method="DOP853", rtol=1e-12, atol=1e-15)
    return found.y[:, -1]


def _solved(misses, start):
    found = root(misses, start, method="hybr", tol=1e-13)
    assert np.max(np.abs(misses(found.x))) < 1e-11, found.message
    return found.x


@pytest.fixture(scope="session")
def small_table():
    """The text of a sweep that wishes a small table."""
    return SMALL_TABLE
