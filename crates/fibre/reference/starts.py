"""Fits the starting values of the closed form (src/closed_form/starts.rs): python3 crates/fibre/reference/starts.py

Needs NumPy. For an amplitude phi and a parameter m the integrals give the contraction and the slenderness,

    eps = 2 m D/F        L = F/(sqrt(m) cos phi)        X = eps L^2

so points of the surface need no solving. With t0^4 = X (1.5 + 0.98 sqrt X + 0.1643 X), u = atan(t0)/(pi/2), v = 2 eps, two
polynomials in u and v of total degree 7 are fitted to tan(phi)/t0 and F/atan(t0), by least squares with weights that
make the largest error small. Integrals by Gauss's rule with 64 nodes, which is exact to rounding here.
"""

import sys

import numpy as np

DEGREE = 7
MOST = 0.53  # m; the force vanishes at 1/2


def chebyshev(count, low, high):
    return low + (high - low) * (1 - np.cos(np.linspace(0, np.pi, count))) / 2


phi, m = np.meshgrid(np.arcsin(np.sqrt(chebyshev(81, 1e-6, 1 - 1e-8))), chebyshev(41, 1e-7, MOST), indexing="ij")
nodes, weights = np.polynomial.legendre.leggauss(64)
theta = phi[..., None] * (nodes + 1) / 2
root = np.sqrt(1 - m[..., None] * np.sin(theta) ** 2)
f = (weights / root).sum(-1) * phi / 2
d = (weights * np.sin(theta) ** 2 / root).sum(-1) * phi / 2
t = np.tan(phi)
eps = 2 * m * d / f
x = eps * (f / (np.sqrt(m) * np.cos(phi))) ** 2
t0 = (x * (1.5 + 0.98 * np.sqrt(x) + 0.1643 * x)) ** 0.25
u, v = np.arctan(t0) / (np.pi / 2), 2 * eps
terms = [(i, j) for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i)]
# Fitted as Chebyshev polynomials of 2u - 1 and 2v - 1, which is well conditioned, and written as powers of u and v.
basis = np.stack([(np.cos(i * np.arccos(2 * u - 1)) * np.polynomial.chebyshev.chebval(2 * v - 1, [0] * j + [1])).ravel() for i, j in terms], 1)


def powers(n):
    shifted = np.polynomial.chebyshev.Chebyshev.basis(n, [0, 1]).convert(kind=np.polynomial.Polynomial, domain=[-1, 1], window=[-1, 1])
    return np.pad(shifted.coef, (0, DEGREE + 1 - len(shifted.coef)))


for name, target in (("TANGENT", t / t0), ("LENGTH", f / np.arctan(t0))):
    weight = np.ones(target.size)
    for _ in range(60):
        found = np.linalg.lstsq(basis * weight[:, None], target.ravel() * weight, rcond=None)[0]
        error = np.abs(basis @ found - target.ravel())
        weight *= np.sqrt(error / error.max() + 0.05)
        weight /= weight.max()
    plain = sum(c * np.outer(powers(j), powers(i)) for c, (i, j) in zip(found, terms))
    print(f"{name}: largest error {error.max():.1e}", file=sys.stderr)
    print(f"const {name}: [[f64; {DEGREE + 1}]; {DEGREE + 1}] = [")
    for row, of_v in enumerate(plain):
        cells = [f"{c:.10f}" if k + row <= DEGREE else "0.0" for k, c in enumerate(of_v)]
        print("    [" + ", ".join(cells) + "],")
    print("];")
