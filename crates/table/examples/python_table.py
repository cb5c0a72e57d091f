"""How is a table used from Python? Through the Parquet files of a sweep: read, put on a grid, interpolate.

    pip install pyarrow scipy
    python python_table.py FOLDER     a sweep of a pleated muscle over contraction (up to the limit) and slenderness, with force_f

The pleated muscle pulls with F = p l0^2 a f, a = (n/2 pi) sin(2 pi/n). The feasible contractions end at a limit that falls with every other
axis: no rectangle. Two things make one of it, and a smooth one: the fraction of the limit as the coordinate, and its root, because f grows
as 1/sqrt(contraction) towards the contraction 0; what is interpolated is f times that root.
Expect 544.0 N at a contraction of 0.2, for 110 mm, a radius of 16 mm and 40 fibres at 1 bar. Try next: volume_v, another slenderness.
"""

import json
import math
import pathlib
import sys

import numpy as np
import pyarrow.dataset
from scipy.interpolate import RegularGridInterpolator, make_interp_spline


def read(folder):
    """The feasible rows as columns, and the unit of each column."""
    files = sorted(str(path) for path in pathlib.Path(folder).rglob("*.parquet"))
    if not files:
        raise SystemExit(f"{folder}: no Parquet file in it")
    data = pyarrow.dataset.dataset(files, format="parquet")
    units = {c["name"]: c["unit"] for c in json.loads(data.schema.metadata[b"bulge.columns"])}
    rows = data.to_table()
    rows = rows.filter(rows["infeasible"].is_null())
    return {name: np.asarray(rows[name]) for name in units if name not in ("index", "infeasible")}, units


def interpolated(columns, first, second, output):
    """The output as a function of two axes, of which the first ends at a limit that depends on the second."""
    seconds = np.unique(columns[second])
    limits, lowest, lines = [], 0.0, []
    for value in seconds:
        here = columns[second] == value
        x, order = np.unique(columns[first][here], return_index=True)
        keep = x > 0
        x, y = x[keep], columns[output][here][order][keep]
        if len(x) < 4:
            raise SystemExit(f"only {len(x)} feasible values of {first} at {second} {value}: the grid is too coarse")
        limits.append(x[-1])
        root = np.sqrt(x / x[-1])
        lowest = max(lowest, root[0])
        lines.append(make_interp_spline(root, y * root, k=3))
    # The same roots of fractions for every line: a rectangle.
    roots = np.linspace(lowest, 1.0, 4 * max(len(line.t) for line in lines))
    grid = RegularGridInterpolator((seconds, roots), [line(roots) for line in lines], method="cubic")
    limit = make_interp_spline(seconds, limits, k=3)

    def at(x, value):
        root = math.sqrt(x / limit(value))
        return float(grid((value, root))) / root  # outside the grid: a ValueError, never a guess

    return at


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    columns, units = read(sys.argv[1])
    for name, unit in units.items():
        if name in columns:
            print(f"{name} ({unit}): {columns[name].min():.6g} to {columns[name].max():.6g}")
    f = interpolated(columns, "contraction", "slenderness", "force_f")

    length, fibres, pressure = 0.11, 40, 1e5
    force = pressure * length**2 * fibres / (2 * math.pi) * math.sin(2 * math.pi / fibres) * f(0.2, 6.875)
    print(f"force at a contraction of 0.2 and a slenderness of 6.875: {force:.2f} N")
    assert abs(force - 544.0) < 0.5, "the grid is too coarse, or not that of a pleated muscle"


if __name__ == "__main__":
    main()
