"""Times the fit of four effects to 10^4 simulated rows here and with NumPy, SciPy and lmfit, in one session, and prints the ratio.

    python3 benches/peers/fit.py [rounds]

The same model on the same rows: the pleated muscle in closed form (S1 eqs. 24 to 28) with elastic fibres, Coulomb friction, viscous damping and a
zero error of the length. Directions and rates come with the rows. SciPy's elliptic integrals are evaluated for all rows at once, and Newton's method
solves all rows at once, with differences or with derivatives worked out by hand; lmfit takes the derivatives by the four numbers by differences.
Bulge's time includes directions, rates and noise, eight starting points on fewer rows, the fit to all rows, and the intervals. Ends with an
error if a number differs from Bulge's by more than a fiftieth of its standard error.
"""

import statistics
import sys
import tempfile
import time
from pathlib import Path

from compare import build_own, run

try:
    import lmfit
    import numpy as np
    from scipy.special import ellipeinc, ellipkinc
except ImportError as error:
    sys.exit(f"{error.name} is not installed for this Python: python3 -m pip install numpy scipy lmfit")

LENGTH, RADIUS, FIBRES = 0.11, 0.016, 40
SLENDERNESS = LENGTH / RADIUS
# Relative change of a row's unknowns at which its equilibrium is taken as found.
ENOUGH = 1e-7
# Numbers in SI: name, start, bounds, box of starting points.
NUMBERS = [
    ("friction", 12.0, 0.0, 200.0, (0.0, 200.0)),
    ("damping", 4000.0, 0.0, 1e5, (0.0, 4e4)),
    ("compliance", 2e-6, 0.0, 5e-5, (0.0, 2e-5)),
    ("offset", 0.0, -0.02, 0.02, (-3e-3, 8e-3)),
]


def integrals(m, phi):
    """F, E and c = sqrt(m) cos phi."""
    return ellipkinc(phi, m), ellipeinc(phi, m), np.sqrt(m) * np.cos(phi)


def exact(m, phi, equations):
    """The equations and their derivatives by ln m and phi, derived by hand."""
    half, length, kappa = equations
    s, co = np.sin(phi), np.cos(phi)
    delta = np.sqrt(1 - m * s * s)
    f, e, c = integrals(m, phi)
    f_m = (e / (1 - m) - f - m * s * co / ((1 - m) * delta)) / 2
    e_m = (e - f) / 2
    c_p = -np.sqrt(m) * s
    stiff = length * (1 - kappa / c**2)
    value = e - f / 2 - half * c, f - length * (c + kappa / c)
    by_m = e_m - f_m / 2 - half * c / 2, f_m - stiff * c / 2
    by_phi = delta - 0.5 / delta - half * c_p, 1 / delta - stiff * c_p
    return value, by_m, by_phi


def by_differences(m, phi, equations):
    """The same with differences, as one writes it first."""
    half, length, kappa = equations

    def value(m, phi):
        f, e, c = integrals(m, phi)
        return np.array((e - f / 2 - half * c, f - length * (c + kappa / c)))

    here, step = value(m, phi), 1e-7
    return here, (value(m * np.exp(step), phi) - here) / step, (value(m, phi + step) - here) / step


def force(pressure, eps, compliance, jacobian):
    """Force of the elastic pleated muscle at each row, by Newton's method on (ln m, phi) for all rows at once.

    (E - F/2)/c = (L/2)(1 - eps),  F/c = L (1 + T/EA),  c = sqrt(m) cos phi,  T/EA = kappa/c^2
    """
    kappa = pressure * np.sin(2 * np.pi / FIBRES) * RADIUS**2 / 4 * compliance * FIBRES
    # A search may try an offset at which fibres alone would hold the muscle; there the force is merely large.
    eps = np.maximum(eps, 2e-3)
    equations = SLENDERNESS * (1 - eps) / 2, SLENDERNESS, kappa
    phi, m = np.arctan(SLENDERNESS * np.sqrt(eps)), np.clip(2.2 * eps, 1e-3, 0.45)
    for _ in range(60):
        (g, h), (a, c), (b, d) = jacobian(m, phi, equations)
        det = a * d - b * c
        step_m, step_phi = (g * d - b * h) / det, (a * h - g * c) / det
        size = np.maximum(np.abs(step_m), np.abs(step_phi) / (np.pi / 2 - phi))
        part = 0.5 / np.maximum(size, 0.5)
        m, phi = np.minimum(m * np.exp(-part * step_m), 0.9), phi - part * step_phi
        if np.max(size) < ENOUGH:
            break
    f = np.pi / 2 * (1 - 2 * m) / (m * np.cos(phi) ** 2)
    return pressure * FIBRES / (2 * np.pi) * np.sin(2 * np.pi / FIBRES) * RADIUS**2 * f


def fit(rows, jacobian, starts):
    """The best fit of those from `starts` starting points: the usual one, then points of the plausible box."""
    pressure, eps, direction, rate, measured = rows

    def residuals(numbers):
        v = numbers.valuesdict()
        model = force(pressure, eps + v["offset"] / LENGTH, v["compliance"], jacobian)
        return model - v["friction"] * direction - v["damping"] * rate - measured

    random, best = np.random.default_rng(1), None
    for start in range(starts):
        numbers = lmfit.Parameters()
        for name, value, low, high, box in NUMBERS:
            numbers.add(name, value=random.uniform(*box) if start else value, min=low, max=high)
        found = lmfit.minimize(residuals, numbers, method="least_squares", x_scale="jac")
        if best is None or found.chisqr < best.chisqr:
            best = found
    return best


# Name, derivatives, starting points.
PEERS = [
    ("SciPy, lmfit, differences, 1 start", by_differences, 1),
    ("SciPy, lmfit, derived by hand, 1 start", exact, 1),
    ("SciPy, lmfit, derived by hand, 8 starts", exact, 8),
]


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    program = build_own("fit")
    own, times, found = [], {name: [] for name, *_ in PEERS}, {}
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "rows.csv")
        for _ in range(rounds):
            lines = run([*program, path])
            bulge = next(numbers for name, numbers in lines.items() if name.startswith("fit"))
            own.append(bulge[0])
            rows = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
            for name, jacobian, starts in PEERS:
                start = time.perf_counter()
                found[name] = fit(rows, jacobian, starts)
                times[name].append(time.perf_counter() - start)
    seconds = statistics.median(own)
    print(f"{'four effects, 10^4 rows':<42} {'seconds':>9} {'ratio':>8}")
    print(f"{'Bulge, 8 starts':<42} {seconds:>9.3f}")
    wrong = []
    for name, *_ in PEERS:
        peer = statistics.median(times[name])
        print(f"{name:<42} {peer:>9.3f} {peer / seconds:>6.1f} x")
        for (number, *_), value in zip(NUMBERS, bulge[1:]):
            other = found[name].params[number]
            print(f"    {number:<12} {other.value:>14.8g} +- {other.stderr:<8.2g} Bulge {value:.8g}")
            if not abs(other.value - value) < 0.02 * other.stderr:
                wrong.append(f"{number} of {name}")
    if wrong:
        sys.exit(f"these numbers differ from Bulge's: {', '.join(wrong)}")


if __name__ == "__main__":
    main()
