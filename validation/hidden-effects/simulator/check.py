"""Self-test of the generator and the score: limits, identities, noise laws, detectability, files. Every check prints its error and its tolerance."""

import tempfile
from pathlib import Path as Folder

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipeinc, ellipkinc

from . import forms_check, history, muscle, protocols, score_check
from . import path as paths
from .case import build
from .detectability import Metric
from .meridian import Body, Rubber, profile, solve
from .muscle import Muscle, Sheet
from .noise import Law, apply_inverse
from .section import Cloth, Section
from .suite import Order
from .surface import Shape, Window, force_map
from .world import World

ALPHA = np.radians(25.0)


def run():
    """Runs all checks; 0 if all pass, 1 otherwise."""
    checks = [
        ("pleats: force by elliptic integrals, F(phi|m) and E(phi|m) of SciPy", _elliptic, 1e-9),
        ("long clamped braid tends to the cylinder", _long_braid, 2e-3),
        ("virtual work F = -p dV/dl, pleats", lambda: _virtual_work(_pleats()), 1e-6),
        ("virtual work F = -p dV/dl, clamped braid", lambda: _virtual_work(_braid(0.12)), 1e-6),
        ("virtual work F = -p dV/dl, lobes", lambda: _virtual_work(_pleats(section=Section(fibres=40, circumference=0.45))), 1e-4),
        ("work with energy F = d(U - pV)/dl, rubber that hardly stretches", _stiff_limit, 1e-4),
        ("stiff fibres tend to inextensible ones, braid", _stiff_fibres, 1e-5),
        ("cloth that never unfolds changes nothing", _idle_cloth, 1e-9),
        ("splines between the nodes against equilibria, cloth that unfolds within", _splines, 5e-5),
        ("state of friction against its differential equation (SciPy)", _dahl, 1e-7),
        ("first-order lag of a ramp is a delay by tau", _lag, 1e-9),
        ("noise: variance of samples against the law", _noise_variance, 0.05),
        ("noise: inverse times covariance is the identity", _noise_inverse, 1e-8),
        ("detectability of an offset in white noise is A sqrt(n)/s", _plain_detectability, 1e-9),
        ("detectability reached by built cases", _reached, 0.05),
        ("muscle file read back", _files, 1e-9),
        ("score: Wilson's interval against printed numbers", score_check.printed_interval, 5e-5),
        ("score: top-1, class and names that are no claims", score_check.claims, 1e-12),
        ("score: alarms without names where nothing is hidden", score_check.quiet, 1e-12),
        *forms_check.CHECKS,
    ]
    failed = 0
    for title, check, tolerance in checks:
        error = check()
        passed = error <= tolerance
        failed += not passed
        print(f"{'pass' if passed else 'FAIL'}  {title}: {error:.2g} (tolerance {tolerance:g})")
    print(f"{len(checks) - failed} passed, {failed} failed")
    return 1 if failed else 0


def _pleats(section=Section(fibres=40), **more):
    return Body("pleated", 0.11, 0.016, 0.0, section, **more)


def _braid(length, **more):
    return Body("braided", length / np.cos(ALPHA), 0.01, np.sin(ALPHA) / 0.01, Section(), **more)


def _elliptic():
    """l/l0 = 2 E/F - 1 and F/(sqrt(m) cos phi) = l0/R fix m and phi; then F = p n sin(2 pi/n) (1 - 2 m) R^2/(4 m cos^2 phi)."""
    radius, length, fibres, pressure = 0.016, 0.11, 40, 1e5
    worst = 0.0
    for contraction in (0.05, 0.1, 0.2, 0.3):

        def amplitude(m):
            return brentq(lambda phi: ellipkinc(phi, m) / (np.sqrt(m) * np.cos(phi)) - length / radius, 1e-3, np.pi / 2 - 1e-6, xtol=1e-15)

        def miss(m):
            phi = amplitude(m)
            return ellipeinc(phi, m) / ellipkinc(phi, m) - (1.0 - contraction / 2.0)

        m = brentq(miss, 1e-3, 0.5, xtol=1e-15)
        phi = amplitude(m)
        exact = pressure * fibres * np.sin(2 * np.pi / fibres) * (1 - 2 * m) * radius**2 / (4 * m * np.cos(phi) ** 2)
        found = solve(_pleats(), pressure, length * (1 - contraction)).force
        worst = max(worst, abs(float(found) / exact - 1.0))
    return worst


def _long_braid():
    contraction, length = np.array([0.05, 0.15, 0.25]), 1.5
    found = solve(_braid(length), 1e5, length * (1 - contraction))
    # The clamps take a length of a few radii: two muscles differ by it, and it cancels from their difference.
    shorter = solve(_braid(1.0), 1e5, 1.0 * (1 - contraction))
    extrapolated = found.force + (found.force - shorter.force) * 2.0
    cylinder = 1e5 * np.pi * 0.01**2 * (3 * ((1 - contraction) / np.tan(ALPHA)) ** 2 - 1 / np.sin(ALPHA) ** 2)
    return float(np.abs(extrapolated / cylinder - 1.0).max())


def _virtual_work(body):
    length = (0.12 if body.kind == "braided" else 0.11) * np.array([0.93, 0.85, 0.8])
    step = 1e-4
    up, down, here = (solve(body, 1e5, length + shift) for shift in (step, -step, 0.0))
    # Richardson's extrapolation of the central difference.
    near_up, near_down = (solve(body, 1e5, length + shift) for shift in (step / 2, -step / 2))
    slope = (4 * (near_up.volume - near_down.volume) / step - (up.volume - down.volume) / (2 * step)) / 3
    return float(np.abs(-1e5 * slope / here.force - 1.0).max())


def _stiff_limit():
    """A clamped net with weak rubber: the change of force is first order in c10 and follows from the energy of the unchanged shape."""
    body, length, step = _braid(0.12), 0.12 * np.array([0.95, 0.85]), 2e-5
    c10, thickness = 50.0, 1e-3
    soft = _braid(0.12, rubber=Rubber(c10, 0.0, 0.01, thickness, float(np.cos(ALPHA))))
    change = solve(soft, 1e5, length).force - solve(body, 1e5, length).force
    energies = [_rubber_energy(body, length + shift, c10, thickness) for shift in (step, -step)]
    expected = (energies[0] - energies[1]) / (2 * step)
    return float(np.abs(change / expected - 1.0).max())


def _rubber_energy(body, length, c10, thickness):
    """int 2 pi r0 t cos(alpha0) c10 (I1 - 3) dS over the shape without rubber, from its profile by an own quadrature."""
    radius, weights = profile(body, 1e5, length)
    a = (1 - (body.turn * radius) ** 2) / np.cos(ALPHA) ** 2
    g = (radius / 0.01) ** 2
    density = 2 * np.pi * 0.01 * thickness * np.cos(ALPHA) * c10 * (a + g + 1 / (a * g) - 3)
    return body.fibre_length * density @ weights


def _stiff_fibres():
    length = 0.12 * np.array([0.95, 0.85])
    stiff = solve(_braid(0.12, stiffness=1e10), 1e5, length).force
    return float(np.abs(stiff / solve(_braid(0.12), 1e5, length).force - 1.0).max())


def _idle_cloth():
    length = 0.11 * np.array([0.95, 0.85])
    cloth = solve(_pleats(cloth=Cloth(1e5, 0.08)), 1e5, length).force
    return float(np.abs(cloth / solve(_pleats(), 1e5, length).force - 1.0).max())


def _splines():
    window = Window((1e5, 4e5), (0.03, 0.33))
    shape = Shape("pleated", 0.11, 0.016, 0.016, fibres=40, compliance=2e-6, cloth=(2e4, 0.045))
    p, eps = np.meshgrid([1.3e5, 2.7e5], [0.05, 0.123, 0.217, 0.301], indexing="ij")
    exact = solve(shape.body(), p, 0.11 * (1 - eps)).force
    return float((np.abs(force_map(shape, window)(p, eps) - exact) / np.abs(exact).max()).max())


def _triangle_path(rows=400):
    return protocols.Plan("triangle", (1e5, 2e5), 0.05, 0.25, rows, (60.0,)).path()


def _dahl():
    path, delta = _triangle_path(), 4e-3
    state = history.dahl(path, path.contraction, delta, cycled=False)
    up = slice(0, 100)
    exact = solve_ivp(
        lambda x, z: (1.0 - z) ** 1.5 / delta, path.contraction[[0, 99]], [0.0], t_eval=path.contraction[up], rtol=1e-10, atol=1e-12
    )
    return float(np.abs(state[up] - exact.y[0]).max())


def _lag():
    path = _triangle_path()
    ramp = 3.0 * path.since_start
    late = path.since_start > 20.0
    return float(np.abs(history.lag(path, ramp, 0.7) - (ramp - 3.0 * 0.7))[late].max())


def _noise_variance():
    """All parts at once, many runs; heavy tails have a variance that settles slowly."""
    law = Law("mixture", 2.0, correlated=1.5, time=4.0, offset=1.0, heavy=True)
    path = protocols.Plan("sine", tuple(np.linspace(1e5, 2e5, 400)), 0.05, 0.25, 200, (60.0,)).path()
    force, _, _ = law.sample(np.random.default_rng(7), path)
    return abs(float(force.var()) / (4.0 + 2.25 + 1.0) - 1.0)


def _noise_inverse():
    law = Law("mixture", 2.0, correlated=1.5, time=4.0, offset=1.0)
    path = _triangle_path(60)
    variance = np.linspace(3.0, 5.0, len(path))
    covariance = np.diag(variance)
    for run in path.runs:
        gaps = np.abs(np.subtract.outer(path.time[run], path.time[run]))
        covariance[run, run] += 2.25 * np.exp(-gaps / 4.0) + 1.0
    return float(np.abs(apply_inverse(law, path, variance, covariance) - np.eye(len(path))).max())


def _plain_detectability():
    stated = Muscle("check", "pleated", 0.11, 0.016, fibres=40)
    path = _triangle_path()
    world = World(stated, Window((0.8e5, 2.5e5), (0.03, 0.3)))
    metric = Metric(world, path, Law("white", 5.0))
    signature = world.changed({"force-offset": 2.0}).force(path) - metric.base
    return abs(metric.norm(signature) / (2.0 * np.sqrt(len(path)) / 5.0) - 1.0)


def _reached():
    """One case of each family and shape of effect; their d is computed anew from the hidden world by the truth file."""
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for family, effect, target in (
            ("pleated", "end-radius", 4.0),
            ("braided", "bladder-elasticity", 8.0),
            ("pleated", "fibre-misalignment", 16.0),
            ("braided", "coulomb-friction", 6.0),
        ):
            truth = build(Order(f"check-{effect}", "single", family, (effect,), (target,)), 11, Folder(folder))
            worst = max(worst, abs(truth["hidden"][0]["d"] / target - 1.0))
    return worst


def _files():
    stated = Muscle(
        "check",
        "braided",
        0.2,
        0.01,
        80,
        ALPHA,
        "clamped",
        0.002,
        (2e5, 4e4),
        {"length": 2e-4, "braid_angle": np.radians(0.1)},
        Sheet(4.0, 1.0, 1e-3),
        Sheet(30.0, 200.0),
        Sheet(5e-6, 3e-5),
    )
    with tempfile.TemporaryDirectory() as folder:
        name = Folder(folder) / "muscle.toml"
        name.write_text(stated.toml(), encoding="utf-8")
        found = muscle.read(name)
        path = _triangle_path(50)
        paths.write(Folder(folder) / "data.csv", path, path.pressure / 100.0, stated.length)
        again, force = paths.read(Folder(folder) / "data.csv", stated.length)
    numbers = [
        (found.length, 0.2),
        (found.braid_angle, ALPHA),
        (found.widths["length"], 2e-4),
        (found.force.gain, 1e-3),
        (found.stroke.zero, 3e-5),
        (found.bladder[1], 4e4),
    ]
    worst = max(abs(a / b - 1.0) for a, b in numbers)
    return max(
        worst,
        float(np.abs(again.contraction - path.contraction).max()) - 1e-8,
        float(np.abs(force * 100.0 / path.pressure - 1.0).max()) - 1e-5,
    )
