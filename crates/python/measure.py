"""Figures of the Python package, measured side by side:

    cargo build --release -p bulge-sweep --example pairs
    pip install bulge scipy
    python crates/python/measure.py target/release/examples/pairs [--points 1000000] [--wheel FILE.whl]

Force of the second-generation PPAM at random pairs of contraction and slenderness: from Python, from Rust with the same pairs, and from SciPy in
three ways that a user would write (the elliptic equations by a root finder point by point; the same by Newton's method on whole arrays; shooting on the
meridian ODE). All answers are compared with each other. Also the time of `import bulge`, and that of a lookup in a table at a single point, which
without the example is measured alone:

    python crates/python/measure.py
"""

import argparse
import subprocess
import sys
import tempfile
import time
import timeit
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root
from scipy.special import ellipeinc, ellipkinc

import bulge

PRESSURE, LENGTH, FIBRES = 1e5, 0.110, 40
#: Pairs that SciPy's slow ways are timed on.
FEW, FEWEST = 2000, 40


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pairs", type=Path, nargs="?", help="the Rust example `pairs`")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--runs", type=int, default=7, help="of Python and Rust, in turn")
    parser.add_argument("--wheel", type=Path)
    arguments = parser.parse_args()
    _table_lookups()
    if arguments.pairs is None:
        return
    generator = np.random.default_rng(1)
    contraction = generator.uniform(0.02, 0.30, arguments.points)
    slenderness = generator.uniform(4.0, 20.0, arguments.points)
    muscle = bulge.Muscle.preset("ppam-2-r16")
    python, rust, force = _side_by_side(muscle, contraction, slenderness, arguments)
    per_point = np.median(python) / arguments.points
    rows = [("Python, bulge", per_point), ("Rust, bulge", np.median(rust) / arguments.points)]
    rows += [(name, _timed(way, contraction[:many], slenderness[:many], force[:many])) for name, way, many in _WAYS]
    print(f"{arguments.points} pairs, {len(python)} runs in turn (medians)\n")
    for name, seconds in rows:
        print(f"  {name:<46} {1e6 * seconds:12.3f} us per pair {seconds / per_point:12.2f} times")
    imports = [_import_seconds() for _ in range(9)]
    print(f"\n  import bulge (with numpy): {1e3 * np.median(imports):.0f} ms, of which numpy {1e3 * np.median([_import_seconds('numpy') for _ in range(9)]):.0f} ms")
    if arguments.wheel:
        print(f"  wheel: {arguments.wheel.stat().st_size / 1e6:.1f} MB")


#: A table of force and volume over two axes.
TABLE = """
muscle = "ppam-2-r16"
outputs = ["force_f", "volume_v"]
[axes.contraction]
range = "0.5 %..limit"
[axes.slenderness]
range = "5..9"
[table]
tolerance = 1e-4
gradient = 1e-2
max_size = "64 KiB"
checks = 100000
"""


def _table_lookups():
    """Microseconds of a lookup at one point, the least of fifty runs."""
    table = bulge.Sweep(TABLE).table()
    many = {"contraction": np.full(100_000, 0.2), "slenderness": 6.875}
    asks = [
        ("value at a point", lambda: table(contraction=0.2, slenderness=6.875), 1000, 1),
        ("gradient at a point", lambda: table.gradient(contraction=0.2, slenderness=6.875), 1000, 1),
        ("value in an array of 100000", lambda: table(**many), 1, 100_000),
    ]
    print(f"table of {len(table.to_bytes())} bytes\n")
    for name, ask, number, points in asks:
        print(f"  {name:<46} {1e6 * min(timeit.repeat(ask, number=number, repeat=50)) / number / points:12.3f} us")
    print()


def _side_by_side(muscle, contraction, slenderness, arguments):
    """Seconds of Python and of Rust, in turn, and the forces."""
    python, rust = [], []
    muscle.force(contraction[:10_000], pressure=PRESSURE, slenderness=slenderness[:10_000])
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "pairs.f64"
        file.write_bytes(np.concatenate([contraction, slenderness]).astype("<f8").tobytes())
        for _ in range(arguments.runs):
            started = time.perf_counter()
            force = muscle.force(contraction, pressure=PRESSURE, slenderness=slenderness)
            python.append(time.perf_counter() - started)
            # The first run of a process starts its threads; Python's have been started.
            told = subprocess.run([arguments.pairs, file, "2"], check=True, capture_output=True, text=True).stdout.split()
            rust.append(float(told[2]))
            assert abs(float(told[3]) - force.sum()) < 1e-6 * abs(force.sum())
    return python, rust, force


def _timed(way, contraction, slenderness, expected):
    started = time.perf_counter()
    force = way(contraction, slenderness)
    seconds = (time.perf_counter() - started) / len(contraction)
    worst = np.max(np.abs(force / expected - 1))
    assert worst < 1e-6, f"{way.__name__} differs by {worst:.1e}"
    return seconds


def _force(m, phi, slenderness):
    """F = p n sin(2 pi/n) (1 - 2 m) R^2/(4 m cos^2 phi)."""
    radius = LENGTH / slenderness
    return PRESSURE * FIBRES * np.sin(2 * np.pi / FIBRES) * (1 - 2 * m) * radius**2 / (4 * m * np.cos(phi) ** 2)


def _equations(m, phi, contraction, slenderness):
    """E/F = 1 - eps/2 and F/(sqrt(m) cos phi) = l0/R."""
    f, e = ellipkinc(phi, m), ellipeinc(phi, m)
    return e / f - (1 - contraction / 2), f / (np.sqrt(m) * np.cos(phi)) / slenderness - 1


def by_root_finder(contraction, slenderness):
    """Two unknowns per point: SciPy's root (MINPACK hybr), started by the nested bracket where it fails."""
    return np.array([_force(*_solved(e, s), s) for e, s in zip(contraction, slenderness)])


def _solved(contraction, slenderness):
    # In log m: the root finder tries no m below 0.
    found = root(lambda x: _equations(np.exp(x[0]), x[1], contraction, slenderness), [np.log(0.2), 1.0], tol=1e-12)
    m, phi = np.exp(found.x[0]), found.x[1]
    if found.success and 0 < m < 0.5 and 0 < phi < np.pi / 2:
        return m, phi

    def phi_of(m):
        return brentq(lambda phi: _equations(m, phi, contraction, slenderness)[1], 1e-9, np.pi / 2 - 1e-9, xtol=1e-14)

    m = brentq(lambda m: _equations(m, phi_of(m), contraction, slenderness)[0], 1e-9, 0.5, xtol=1e-15)
    return m, phi_of(m)


def by_arrays(contraction, slenderness):
    """Newton's method on whole arrays, in log m and phi, with damping."""
    u, phi = np.full_like(contraction, np.log(0.2)), np.full_like(contraction, 1.0)
    for _ in range(60):
        m = np.exp(u)
        sin, cos = np.sin(phi), np.cos(phi)
        root_ = np.sqrt(1 - m * sin**2)
        f, e = ellipkinc(phi, m), ellipeinc(phi, m)
        f_m = e / (2 * m * (1 - m)) - f / (2 * m) - sin * cos / (2 * (1 - m) * root_)
        e_m = (e - f) / (2 * m)
        g1, g2 = e / f - (1 - contraction / 2), np.log(f / (np.sqrt(m) * cos) / slenderness)
        a11, a12 = m * (e_m * f - e * f_m) / f**2, (root_ * f - e / root_) / f**2
        a21, a22 = m * f_m / f - 0.5, 1 / (root_ * f) + sin / cos
        det = a11 * a22 - a12 * a21
        du, dphi = -(a22 * g1 - a12 * g2) / det, -(a11 * g2 - a21 * g1) / det
        step = np.minimum(1, 0.5 / np.maximum(np.abs(du), 1e-300))
        step = np.minimum(step, 0.5 * np.minimum(phi, np.pi / 2 - phi) / np.maximum(np.abs(dphi), 1e-300))
        u, phi = np.minimum(u + step * du, np.log(0.5)), phi + step * dphi
        if np.max(np.abs(du)) < 1e-12 and np.max(np.abs(dphi)) < 1e-12:
            break
    return _force(np.exp(u), phi, slenderness)


def by_shooting(contraction, slenderness):
    """The meridian ODE of a pleated muscle with inextensible fibres, integrated from the middle; two unknowns by MINPACK."""
    return np.array([_shot(e, s) for e, s in zip(contraction, slenderness)])


def _shot(contraction, slenderness):
    """Angle theta of the meridian against the axis over the fibre's length s: T d(theta)/ds = -q r, q = p sin(2 pi/n), T = const.

    Lengths in R: with k = q R^2/T and the largest radius r0 unknown, the half length l0/(2 R) must end at r = 1 and at the contraction's x.
    """
    half = slenderness / 2

    def ends(unknowns):
        k, middle = np.exp(unknowns)
        found = solve_ivp(
            lambda _, y: (np.cos(y[2]), np.sin(y[2]), -k * y[1]), (0, half), (0, middle, 0), method="DOP853", rtol=1e-11, atol=1e-13
        )
        return found.y[0, -1], found.y[1, -1]

    def off(unknowns):
        x, r = ends(unknowns)
        return x - half * (1 - contraction), r - 1

    # A circular arc of this length and chord gives the start.
    angle = np.sqrt(6 * contraction)
    start = np.log([2 * angle / half / (1 + half * angle / 2), 1 + half * angle / 2])
    found = root(off, start, tol=1e-12)
    k, middle = np.exp(found.x)
    radius = LENGTH / slenderness
    tension = PRESSURE * np.sin(2 * np.pi / FIBRES) * radius**2 / k
    # Axial balance at the middle: F = n T - p n sin(2 pi/n)/2 r0^2.
    return FIBRES * tension - PRESSURE * FIBRES * np.sin(2 * np.pi / FIBRES) / 2 * (middle * radius) ** 2


_WAYS = [
    ("SciPy, elliptic integrals on whole arrays", by_arrays, FEW * 20),
    ("SciPy, elliptic integrals point by point", by_root_finder, FEW),
    ("SciPy, shooting on the ODE point by point", by_shooting, FEWEST),
]


def _import_seconds(name="bulge"):
    program = f"import time; t = time.perf_counter(); import {name}; print(time.perf_counter() - t)"
    return float(subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout)


if __name__ == "__main__":
    main()
