"""Rows as they should not be: each kind changes a table (columns in SI) and says which rows, counted from 1 below the header."""

import numpy as np

ALL = ("shifted", "duplicates", "nan", "blank", "spikes", "frozen", "clipped", "mislabelled", "negative-pressure")
"""In this order: what inserts rows comes first."""


def damaged(rng, table, kinds, noise):
    """The table with these kinds of damage, and the list for the truth file; `noise` is that of the force [N]."""
    table, said = {name: values.copy() for name, values in table.items()}, []
    for kind in ALL:
        if kind in kinds:
            table, rows = _KINDS[kind](rng, table, noise)
            if len(rows):
                said.append({"kind": kind, "rows": [int(row) + 1 for row in rows]})
    return table, said


def _some(rng, table, share):
    count = len(table["force"])
    return np.sort(rng.choice(np.arange(2, count - 2), max(2, round(share * count)), replace=False))


def _shifted(rng, table, noise):
    """All of one sweep is 4 to 8 standard deviations off: the amplifier was balanced anew."""
    sweeps = np.unique(table["sweep"])
    rows = np.flatnonzero(table["sweep"] == sweeps[int(rng.integers(len(sweeps)))])
    table["force"][rows] += noise * rng.uniform(4.0, 8.0) * rng.choice([-1.0, 1.0])
    return table, rows


def _duplicates(rng, table, _):
    """Rows that the logger wrote twice."""
    rows = _some(rng, table, 0.006)
    order = np.sort(np.r_[np.arange(len(table["force"])), rows])
    return {name: values[order] for name, values in table.items()}, np.flatnonzero(np.diff(order, prepend=-1) == 0)


def _nan(rng, table, _):
    """One reading of a row is missing."""
    rows = _some(rng, table, 0.01)
    names = np.array(["force", "pressure", "length"])[rng.integers(0, 3, len(rows))]
    for row, name in zip(rows, names):
        for one in ("length", "contraction", "displacement") if name == "length" else (name,):
            table[one][row] = np.nan
    return table, rows


def _blank(rng, table, _):
    """A row without anything."""
    rows = _some(rng, table, 0.004)
    for values in table.values():
        values[rows] = np.nan
    return table, rows


def _spikes(rng, table, noise):
    """1 to 2 % of rows are 15 to 25 standard deviations off, to either side."""
    rows = _some(rng, table, rng.uniform(0.01, 0.02))
    table["force"][rows] += noise * rng.uniform(15.0, 25.0, len(rows)) * rng.choice([-1.0, 1.0], len(rows))
    return table, rows


def _frozen(rng, table, _):
    """The force channel repeats its last reading for a while."""
    count = len(table["force"])
    width = max(5, round(rng.uniform(0.01, 0.03) * count))
    start = int(rng.integers(5, count - width - 5))
    if np.isfinite(table["force"][start]):
        table["force"][start : start + width] = np.where(np.isfinite(table["force"][start : start + width]), table["force"][start], np.nan)
    return table, np.arange(start + 1, start + width)


def _clipped(rng, table, _):
    """The amplifier ends below the largest forces."""
    level = np.nanquantile(table["force"], rng.uniform(0.96, 0.985))
    rows = np.flatnonzero(table["force"] > level)
    table["force"][rows] = level
    return table, rows


def _mislabelled(rng, table, _):
    """The last rows of a sweep bear the number of the next."""
    ends = np.flatnonzero(np.diff(table["sweep"]) != 0)
    rows = np.concatenate([np.arange(max(end - int(rng.integers(0, 3)), 0), end + 1) for end in ends]) if len(ends) else np.array([], int)
    rows = rows[np.isfinite(table["sweep"][rows])]
    for row in rows[::-1]:
        after = table["sweep"][row + 1]
        table["sweep"][row] = after if np.isfinite(after) else table["sweep"][row]
    return table, rows


def _negative_pressure(rng, table, _):
    """A zero below zero shows where the muscle is vented."""
    rows = np.flatnonzero(table["pressure"] < 1500.0)
    table["pressure"][rows] = -np.abs(rng.normal(240.0, 60.0, len(rows)))
    return table, rows


_KINDS = {
    "shifted": _shifted,
    "duplicates": _duplicates,
    "nan": _nan,
    "blank": _blank,
    "spikes": _spikes,
    "frozen": _frozen,
    "clipped": _clipped,
    "mislabelled": _mislabelled,
    "negative-pressure": _negative_pressure,
}
