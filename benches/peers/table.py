"""A lookup of force and volume beside SciPy's RegularGridInterpolator on a grid of the same table, and beside direct solution.

    python3 benches/peers/table.py

Needs NumPy and SciPy. Errors are relative, at 20000 random points from 1 % of the contraction limit on.
"""

import json
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy.interpolate import RegularGridInterpolator

ROOT = Path(__file__).resolve().parent.parent.parent
POINTS = 20000
ONE_BY_ONE = 2000


def own(*command):
    return subprocess.run(["cargo", "run", "--release", "--quiet", *command], cwd=ROOT, check=True, capture_output=True, text=True).stdout


def grid(table, nodes):
    """Values over the fraction of the limit and the slenderness, from the CSV of the table."""
    text = own("-p", "bulge", "--", "table", "export", str(table), "--to", "csv", "--points", str(nodes))
    names = [name.split(" [")[0] for name in text.splitlines()[0].split(",")]
    rows = np.genfromtxt(text.splitlines()[1:], delimiter=",")
    return {name: rows[:, i] for i, name in enumerate(names)}


def main():
    with tempfile.TemporaryDirectory() as folder:
        figures = json.loads(own("-p", "bulge-benches", "--bin", "lookup", folder))
        table = Path(folder) / "family.bulge"
        print(f"table of {figures['bytes']} bytes, built and certified in {figures['build_s']:.2f} s")
        print(f"{'':44}  per point   largest error   what")
        print(f"{'Bulge, lookup':44}  {figures['lookup_ns']:6.0f} ns   1.0e-06         f, v and their gradients")
        print(f"{'Bulge, lookup, 4096 at once':44}  {figures['many_ns']:6.0f} ns   1.0e-06         f, v and their gradients")
        print(f"{'Bulge, lookup, one slenderness (`curve`)':44}  {figures['curve_ns']:6.0f} ns   1.0e-06         f, v and their gradients")
        print(f"{'Bulge, closed form':44}  {figures['solve_ns']:6.0f} ns                   f, v and their gradients")
        fine = grid(table, 400)
        for nodes in (81, 201):
            peer(grid(table, nodes), fine, nodes)


def peer(columns, fine, nodes):
    """Cubic and linear interpolation of f eps^(1/2) and v over (fraction^(1/2), log slenderness)."""
    slenderness = np.unique(columns["slenderness"])
    limit = np.array([columns["contraction"][columns["slenderness"] == s].max() for s in slenderness])
    root, values = [], []
    fraction = None
    for s, end in zip(slenderness, limit):
        of = columns["slenderness"] == s
        keep = np.isfinite(columns["force_f"][of]) & (columns["contraction"][of] > 0)
        part = np.sqrt(columns["contraction"][of][keep] / end)
        order = np.argsort(part)
        fraction = part[order] if fraction is None else fraction
        values.append(np.stack([columns["force_f"][of][keep][order] * part[order], columns["volume_v"][of][keep][order]], -1))
        root.append(part[order])
    values = np.array(values)
    if any(len(r) != len(fraction) or np.abs(r - fraction).max() > 1e-9 for r in root):
        raise SystemExit("the grid does not follow the limit")
    wanted = (fine["contraction"] > 0) & np.isfinite(fine["force_f"])
    # The peer is told the exact limit.
    of_fine = {s: fine["contraction"][fine["slenderness"] == s].max() for s in np.unique(fine["slenderness"])}
    ends = np.array([of_fine[s] for s in fine["slenderness"]])
    part = np.sqrt(np.clip(fine["contraction"] / ends, 0, 1))
    chosen = np.random.default_rng(1).choice(np.flatnonzero(wanted & (part > 0.1) & (part < 0.99)), POINTS)
    points = np.stack([np.log(fine["slenderness"][chosen]), part[chosen]], -1)
    for method in ("linear", "cubic"):
        interpolator = RegularGridInterpolator((np.log(slenderness), fraction), values, method=method, bounds_error=False, fill_value=None)
        start = time.perf_counter()
        found = interpolator(points)
        together = (time.perf_counter() - start) / len(points)
        start = time.perf_counter()
        for point in points[:ONE_BY_ONE]:
            interpolator(point)
        alone = (time.perf_counter() - start) / ONE_BY_ONE
        error = np.abs(found[:, 0] / part[chosen] / fine["force_f"][chosen] - 1).max()
        name = f"SciPy, {method}, {nodes} x {nodes}"
        print(f"{name + ', 20000 at once':44}  {1e9 * together:6.0f} ns   {error:.1e}         f and v, no gradient")
        print(f"{name + ', one by one':44}  {1e9 * alone:6.0f} ns")


main()
