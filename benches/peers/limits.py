"""The kernels of `limits` by other libraries: SciPy, and Boost.Math where a compiler and its headers are. Prints for each the fastest of them: kernel,
what computes it, nanoseconds of one.

    python3 benches/peers/limits.py          # the program `limits` runs it, where Python has NumPy and SciPy

Many in one call are arrays of 4096. Each time is the least of some rounds: what else runs on the machine only adds to it.
"""

import tempfile
import time

import numpy as np
from compare import build_boost, run
from pleated_scipy import SLENDERNESS, closed_form, contraction, shooting
from scipy.interpolate import RectBivariateSpline
from scipy.special import ellipeinc, ellipkinc

MANY = 4096
ROUNDS = 5
#: Equilibria one by one: by fsolve, and by shooting, which takes milliseconds.
FEW = {closed_form: 200, shooting: 20}
#: Steps of Newton's method from the start that fsolve has, of which the first ones are halved.
STEPS, HALVED = 12, 2
#: Nodes of a spline to each side; the time of a lookup hardly depends on them.
NODES = 81


def least_ns(call, calls):
    def one():
        start = time.perf_counter()
        call()
        return 1e9 * (time.perf_counter() - start) / calls

    return min(one() for _ in range(ROUNDS))


def pairs():
    random = np.random.default_rng(1)
    phi, m = random.uniform(0.1, 1.5, MANY), random.uniform(0.05, 0.5, MANY)
    return least_ns(lambda: (ellipkinc(phi, m), ellipeinc(phi, m)), MANY)


def one_by_one(solve):
    count = FEW[solve]
    places = [contraction(i * 1000 // count) for i in range(count)]
    return least_ns(lambda: [solve(eps) for eps in places], count)


def boost():
    """Newton's method on Boost.Math's integrals in double, nanoseconds; none without Boost."""
    with tempfile.TemporaryDirectory() as folder:
        command, _ = build_boost(folder, ["-DBOOST_MATH_PROMOTE_DOUBLE_POLICY=false"])
        return [1e3 * us for us, *_ in run(command).values()] if command else []


def forces(eps):
    """The force of many contractions: Newton's method with derivatives by differences, all at once."""

    def residuals(m, phi):
        scale = np.sqrt(m) * np.cos(phi)
        f, e = ellipkinc(phi, m), ellipeinc(phi, m)
        return np.array(((e - f / 2) / scale - SLENDERNESS * (1 - eps) / 2, f / scale - SLENDERNESS))

    m, phi = np.full_like(eps, 0.3), np.full_like(eps, 1.2)
    for step in range(STEPS):
        here = residuals(m, phi)
        (a, c), (b, d) = ((residuals(m + h, phi + k) - here) / 1e-7 for h, k in ((1e-7, 0), (0, 1e-7)))
        by = 0.5 if step < HALVED else 1.0
        det = a * d - b * c
        m = np.clip(m - by * (d * here[0] - b * here[1]) / det, 1e-6, 0.5)
        phi = np.clip(phi - by * (a * here[1] - c * here[0]) / det, 0.01, 1.57)
    return np.pi / 2 * (1 - 2 * m) / (m * np.cos(phi) ** 2 * SLENDERNESS**2)


def many_forces():
    eps = np.array([contraction(i * 999 / (MANY - 1)) for i in range(MANY)])
    found, exact = forces(eps), [closed_form(one) for one in eps[:: MANY // 16]]
    if np.abs(found[:: MANY // 16] - exact).max() > 1e-9:
        raise SystemExit("Newton's method of many contractions ended elsewhere")
    return least_ns(lambda: forces(eps), MANY)


def lookups():
    """Two splines with their gradients, one by one and many in one call."""
    nodes = np.linspace(0, 1, NODES)
    splines = [RectBivariateSpline(nodes, nodes, f(nodes[:, None] + 2 * nodes)) for f in (np.sin, np.cos)]
    x, y = np.random.default_rng(2).uniform(0, 1, (2, MANY))

    def look(x, y):
        return [spline.ev(x, y, *by) for spline in splines for by in ((0, 0), (1, 0), (0, 1))]

    few = list(zip(x[:100], y[:100]))
    return least_ns(lambda: [look(*point) for point in few], len(few)), least_ns(lambda: look(x, y), MANY)


def main():
    one, many = lookups()
    closed = ("SciPy, `fsolve` on these integrals", one_by_one(closed_form))
    closed = min([closed, *(("Boost.Math in double, Newton's method", ns) for ns in boost())], key=lambda peer: peer[1])
    rows = (
        ("pair of elliptic integrals", "SciPy's `ellipkinc` and `ellipeinc` of arrays", pairs()),
        ("equilibrium in closed form", *closed),
        ("equilibrium in closed form, many in one call", "NumPy, Newton's method on arrays of SciPy's integrals", many_forces()),
        ("pleated muscle by shooting, checked by an integration of the ODE", "SciPy, `fsolve` on `solve_ivp`", one_by_one(shooting)),
        ("lookup, one by one", "SciPy's `RectBivariateSpline.ev`", one),
        ("lookup, many in one call", "SciPy's `RectBivariateSpline.ev` of arrays", many),
    )
    for row in rows:
        print(*row, sep="\t")


if __name__ == "__main__":
    main()
