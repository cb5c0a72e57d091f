"""The pleated muscle as one writes it with SciPy: the closed form (S1 eqs. 24 and 25) by fsolve, and shooting with DOP853.

Prints per method: name, microseconds per solve, sum of f over 1000 contractions.
"""

import time
from math import cos, pi, sqrt

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve
from scipy.special import ellipeinc, ellipkinc

SLENDERNESS = 6.875
CONTRACTIONS = 1000


def contraction(i):
    return 0.05 + 0.35 * i / (CONTRACTIONS - 1)


def closed_form(eps):
    def residuals(z):
        m, phi = z
        scale = sqrt(abs(m)) * cos(phi)
        f, e = ellipkinc(phi, m), ellipeinc(phi, m)
        return (e - f / 2) / scale - SLENDERNESS * (1 - eps) / 2, f / scale - SLENDERNESS

    m, phi = fsolve(residuals, (0.3, 1.2), xtol=1e-12)
    return pi / 2 * (1 - 2 * m) / (m * cos(phi) ** 2 * SLENDERNESS**2)


def shooting(eps):
    """theta' = -2 pi r/N along the fibre, N constant (units R, p R^2); unknowns: radius at mid-length and N."""
    half = SLENDERNESS / 2

    def slope(_, y):
        r, _, theta = y
        return np.sin(theta), np.cos(theta), -2 * pi * r / slope.tension

    def end(z):
        slope.tension = z[1]
        run = solve_ivp(slope, (0, half), (z[0], 0, 0), method="DOP853", rtol=1e-11, atol=1e-11)
        return run.y[0, -1] - 1, run.y[1, -1] - half * (1 - eps)

    # A circular arc of the fibre's length.
    angle = sqrt(6 * eps * (1 + 0.3 * eps))
    arc = half / angle
    mid = 1 + arc * (1 - cos(angle))
    mid, tension = fsolve(end, (mid, 2 * pi * mid * arc), xtol=1e-10)
    # F = N - pi r^2 at mid-length; f is F over p (l0/R)^2 R^2.
    return (tension - pi * mid**2) / SLENDERNESS**2


def report(name, solve):
    start = time.perf_counter()
    total = sum(solve(contraction(i)) for i in range(CONTRACTIONS))
    each = (time.perf_counter() - start) * 1e6 / CONTRACTIONS
    print(f"{name}\t{each:.4f}\t{total:.12f}")


if __name__ == "__main__":
    report("SciPy, fsolve on the closed form", closed_form)
    report("SciPy, fsolve on DOP853 shooting", shooting)
