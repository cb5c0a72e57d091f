"""What goes wrong with a table: each habit picks rows and spoils them in a column (SI).

A pick and a deed take a generator of random numbers, the table, the column, and a strength from 0 (mild) to 1 (severe); a pick returns rows, counted
from 0, a deed changes them in place. A habit that adds, removes or finds its own rows returns the table and the rows. All draw the same random numbers
whatever the readings are, so that a table without noise is damaged alike.
"""

import numpy as np

COLUMNS = ("force", "pressure", "length")


def between(low, high, strength):
    """From low to high on a logarithmic scale."""
    return float(low * (high / low) ** strength)


def stretch(rng, table, share):
    """Neighbouring rows, about that share of all."""
    count = len(table["force"])
    width = min(max(4, round(share * count)), count - 8)
    start = int(rng.integers(4, count - width - 3))
    return np.arange(start, start + width)


def some(rng, table, share):
    """Single rows, not the first nor the last ones."""
    count = len(table["force"])
    return np.sort(rng.choice(np.arange(3, count - 3), max(2, round(share * count)), replace=False))


def taken(table, order):
    """Rows in another order, or some of them."""
    return {name: values[order] for name, values in table.items()}


def runs(rows):
    """Rows as pieces without a gap."""
    return np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1)


def channels(column):
    """The columns that are meant."""
    return COLUMNS if column == "all" else (column,)


# Picks of rows.


def everywhere(rng, table, column, strength):
    """All rows."""
    return np.arange(len(table["force"]))


def groups(least, most, shortest, longest):
    """A pick of single rows, pairs or bursts: so many rows each, beginning at this share of all rows."""

    def pick(rng, table, column, strength):
        starts = some(rng, table, rng.uniform(least, most))
        rows = np.unique(np.concatenate([start + np.arange(int(rng.integers(shortest, longest + 1))) for start in starts]))
        return rows[rows < len(table["force"]) - 1]

    return pick


def one_sweep(rng, table, column, strength):
    """All of one sweep; of a test in one piece, a quarter of it."""
    names, pick = np.unique(table["sweep"]), rng.random()
    if len(names) > 1:
        return np.flatnonzero(table["sweep"] == names[int(pick * len(names))])
    quarter = len(table["force"]) // 4
    return np.arange(quarter) + int(pick * 3.99) * quarter


def of_one_sweep(rng, table, column, strength):
    """A part of a sweep, or, if severe, all of it."""
    rows = one_sweep(rng, table, column, strength)
    return rows[: max(round(between(0.05, 1.0, min(2.0 * strength, 1.0)) * len(rows)), 3)]


def ending(pick, low, high):
    """The last part of a pick, from some row between these shares of it on."""

    def last(rng, table, column, strength):
        rows = pick(rng, table, column, strength)
        return rows[int(rng.uniform(low, high) * len(rows)) :]

    return last


def pieces(number, low, high):
    """A pick of pieces of neighbouring rows, each this share of all, mild and severe."""
    return lambda rng, table, column, strength: np.unique(
        np.concatenate([stretch(rng, table, between(low, high, strength)) for _ in range(number)])
    )


def lines(low, high):
    """A pick of single rows, this share of all, mild and severe."""
    return lambda rng, table, column, strength: some(rng, table, between(low, high, strength))


def loose(rng, table, column, strength):
    """Row by row, or for a while: a loose plug."""
    rows = lines(0.003, 0.08)(rng, table, column, strength)
    return pieces(3, 0.004, 0.05)(rng, table, column, strength) if rng.random() < 0.5 else rows


def one_file(rng, table, column, strength):
    """One file of five."""
    return np.flatnonzero(table["file"] == float(rng.integers(1, 6)))


def leaking(rng, table, column, strength):
    """While the pressure sags."""
    return np.flatnonzero(table["leaking"])


def of_a_specimen(rng, table, column, strength):
    """A whole sweep of one specimen; half of it if there is no other."""
    rows = np.flatnonzero(table["specimen"] == float(rng.integers(1, 4)))
    chosen = rows[table["sweep"][rows] == rng.choice(np.unique(table["sweep"][rows]))]
    return chosen if len(chosen) < len(rows) else chosen[: len(rows) // 2]


# Deeds.

ZERO = {"force": (0.5, 40.0), "pressure": (4e2, 2e4), "length": (5e-5, 2e-3)}
"""A zero that moved: mild and severe."""
UNITS = {
    "pressure": {"psi": 14.503773773, "kPa": 100.0},
    "length": {"cm": 0.1, "inch": 1.0 / 25.4},
    "force": {"kgf": 1.0 / 9.80665, "lbf": 1.0 / 4.4482216},
}
"""Numbers in these units under the heading of the others: bar, mm, N."""


def hit(rng, table, column, strength, rows):
    """Spikes of 1 to 60 % of the range; in half of all tests to one side."""
    low, high = np.quantile(table[column], (0.01, 0.99))
    height = (high - low) * between(0.01, 0.6, strength) * rng.uniform(0.6, 1.4, len(rows))
    sides = rng.choice([-1.0, 1.0], len(rows)) if rng.random() < 0.5 else rng.choice([-1.0, 1.0])
    table[column][rows] += sides * height


def offset(rng, table, column, strength, rows):
    """The amplifier was balanced anew, a clamp slipped, a cell was knocked."""
    table[column][rows] += between(*ZERO[column], strength) * rng.choice([-1.0, 1.0])


def freeze(rng, table, column, strength, rows):
    """The last reading again: a bus that hangs."""
    for piece in runs(rows):
        for name in channels(column):
            table[name][piece] = table[name][max(piece[0] - 1, 0)]


def bridge(rng, table, column, strength, rows):
    """A straight line across each gap, written by the evaluation."""
    for piece in runs(rows):
        ends = [piece[0] - 1, piece[-1] + 1]
        table[column][piece] = np.interp(piece, ends, table[column][ends])


def become(what):
    """A deed that makes other readings of those of the rows."""

    def deed(rng, table, column, strength, rows):
        for name in channels(column):
            table[name][rows] = what(rng, table[name][rows])

    return deed


def overwrite(rng, table, column, strength, rows):
    """Other rows were copied over these."""
    source = (rows + int(rng.uniform(0.25, 0.75) * len(table["force"]))) % len(table["force"])
    for name in channels(column):
        table[name][rows] = table[name][source]


def rename(rng, table, column, strength, rows):
    """The name of the next specimen."""
    table["specimen"][rows] = table["specimen"][rows] % 3 + 1.0


def other_unit(rng, table, column, strength, rows):
    """psi for bar, centimetres for millimetres, kilograms for newtons."""
    table[column][rows] *= UNITS[column][str(rng.choice(sorted(UNITS[column])))]


def supply(rng, table, column, strength, rows):
    """The sensor sits at the supply, before the leak."""
    table[column][rows] = table["supply"][rows]


# Habits that add, remove or find their own rows.


def clipped(top, soft):
    """The amplifier ends below the largest or above the smallest readings; or bends before, and they approach a ceiling."""

    def habit(rng, table, column, strength):
        values, share = table[column], between(*((0.05, 0.3) if soft else (0.01, 0.2)), strength)
        level = float(np.quantile(values, 1.0 - share if top else share))
        rows = np.flatnonzero(values > level if top else values < level)
        room = max(float(np.max(values)) - level, 1e-9) * between(2.0, 0.4, strength)
        values[rows] = level + room * np.tanh((values[rows] - level) / room) if soft else level
        return table, rows

    return habit


def rows_twice(rng, table, column, strength):
    """The logger writes a row again."""
    order = np.sort(np.r_[np.arange(len(table["force"])), some(rng, table, between(0.005, 0.15, strength))])
    return taken(table, order), np.flatnonzero(np.diff(order, prepend=-1) == 0)


def sweep_twice(rng, table, column, strength):
    """A sweep is written again at the end, with times that go on."""
    rows, count = one_sweep(rng, table, column, strength), len(table["force"])
    table = taken(table, np.r_[np.arange(count), rows])
    table["time"][count:] += table["time"][count - 1] - table["time"][count] + np.median(np.diff(table["time"]))
    table["sweep"][count:] = np.max(table["sweep"]) + 1.0
    return table, np.arange(count, count + len(rows))


def exchange_words(rng, table, column, strength):
    """The words for loading and unloading are exchanged, in one sweep or in all."""
    rows = one_sweep(rng, table, column, strength) if strength < 0.5 else np.arange(len(table["force"]))
    table[column][rows] *= -1.0
    return table, rows


def exchange_specimens(rng, table, column, strength):
    """Two specimens have changed their names."""
    one, other = (float(k) for k in rng.choice([1, 2, 3], 2, replace=False))
    old = table["specimen"].copy()
    table["specimen"][old == one], table["specimen"][old == other] = other, one
    return table, np.flatnonzero(table["specimen"] != old)


def turn_one_channel(rng, table, column, strength):
    """Loading beside unloading: one channel of a sweep, or of a third of it, runs backwards."""
    rows = one_sweep(rng, table, column, strength)
    rows = rows[: max(len(rows) // 3, 6)] if strength < 0.5 else rows
    table[column][rows] = table[column][rows[::-1]]
    return table, rows


def by_samples(rng, table, column, strength):
    """One channel is late by one to thirty samples, everywhere."""
    late = round(between(1, 30, strength))
    for label in np.unique(table["sweep"]):
        rows = np.flatnonzero(table["sweep"] == label)
        table[column][rows] = table[column][rows[np.maximum(np.arange(len(rows)) - late, 0)]]
    return table, np.arange(len(table["force"]))


def resampled(rng, table, column, strength):
    """One channel comes every few rows only: held in between, or joined by lines."""
    every, rows = round(between(3, 40, strength)), np.arange(len(table["force"]))
    known = rows[::every]
    drawn = rng.random() < 0.5
    table[column] = np.interp(rows, known, table[column][known]) if drawn else table[column][rows // every * every]
    return table, rows


def lost(rng, table, column, strength):
    """Packets are missing; the clock goes on, or its times are counted from the rows that are left."""
    step, start = float(np.median(np.diff(table["time"]))), table["time"][0]
    gone = np.concatenate([stretch(rng, table, between(0.02, 0.1, strength)) for _ in range(3)])
    left = np.setdiff1d(np.arange(len(table["force"])), gone)
    table = taken(table, left)
    if column == "time":
        table["time"] = start + step * np.arange(len(left))
    return table, np.flatnonzero(np.diff(left, prepend=-1) > 1)


def sorted_rows(rng, table, column, strength):
    """A spreadsheet sorted the rows by one column; the times went along, or were written anew."""
    order = np.argsort(table[str(rng.choice(COLUMNS))], kind="stable")
    times = table["time"].copy()
    table = taken(table, order)
    if column == "time":
        table["time"] = times
    return table, np.arange(len(order))


def thousands(rng, table, column, strength):
    """1,234.5 became 1.2345 wherever there was a thousand."""
    rows = np.flatnonzero(table[column] >= np.quantile(table[column], between(0.98, 0.8, strength)))
    table[column][rows] *= 1e-3
    return table, rows


def stuck_bit(rng, table, column, strength):
    """One bit of a 14-bit converter is always set or never, from some row on."""
    low, step = float(np.min(table[column])), 1.3 * float(np.ptp(table[column])) / 2**14
    bit = 2 ** round(3 + 8 * strength)
    counts = np.floor((table[column] - low) / max(step, 1e-12)).astype(int)
    stuck = counts | bit if rng.random() < 0.5 else counts & ~bit
    rows = np.flatnonzero(stuck != counts)
    later = rows[rows >= rng.choice([0.0, 0.0, 0.4]) * len(counts)]
    rows = later if len(later) else rows
    table[column][rows] += (stuck - counts)[rows] * step
    return table, rows


BOTH = ("force", "pressure")
HABITS = {
    "spikes": [
        ("isolated", COLUMNS, groups(0.003, 0.02, 1, 1), hit),
        ("pairs", COLUMNS, groups(0.003, 0.015, 2, 2), hit),
        # A relay, a motor.
        ("bursts", COLUMNS, groups(0.002, 0.006, 4, 9), hit),
    ],
    "shifted": [("zero-of-a-sweep", COLUMNS, one_sweep, offset)],
    "slip": [
        ("to-the-end", COLUMNS, ending(everywhere, 0.15, 0.85), offset),
        ("to-the-end-of-the-sweep", COLUMNS, ending(one_sweep, 0.2, 0.8), offset),
    ],
    "frozen": [("held", (*COLUMNS, "all"), pieces(1, 0.01, 0.2), freeze), ("stutters", COLUMNS, pieces(4, 0.01, 0.06), freeze)],
    "clipped": [("top", BOTH, clipped(True, False)), ("bottom", BOTH, clipped(False, False)), ("softly", BOTH, clipped(True, True))],
    "duplicated": [
        ("rows-twice", ("all",), rows_twice),
        ("sweep-twice", ("all",), sweep_twice),
        ("block-over-another", ("all", "force"), pieces(1, 0.02, 0.15), overwrite),
    ],
    "swapped": [
        ("labels", ("direction",), exchange_words),
        ("backwards", ("all",), one_sweep, become(lambda rng, values: values[::-1])),
        ("one-channel-backwards", COLUMNS, turn_one_channel),
        ("branches", ("all",), one_sweep, become(lambda rng, values: np.roll(values, len(values) // 2))),
    ],
    "mislabelled": [
        ("block", ("specimen",), pieces(1, 0.02, 0.2), rename),
        ("whole-sweep", ("specimen",), of_a_specimen, rename),
        ("exchanged", ("specimen",), exchange_specimens),
    ],
    "late": [("by-samples", COLUMNS, by_samples), ("resampled", BOTH, resampled)],
    "gaps": [("lost", ("all",), lost), ("lost-without-a-trace", ("time",), lost), ("bridged", COLUMNS, pieces(3, 0.01, 0.06), bridge)],
    "leak": [
        ("seen", ("pressure",), leaking, become(lambda rng, values: values)),
        ("unseen", ("pressure",), leaking, supply),
        ("unread", ("pressure",), leaking, freeze),
    ],
    "unit": [("unit", COLUMNS, one_file, other_unit), ("absolute", ("pressure",), one_file, become(lambda rng, values: values + 101325.0))],
    "sorted": [
        ("with-times", ("all",), sorted_rows),
        ("without-times", ("time",), sorted_rows),
        ("one-column", COLUMNS, pieces(1, 0.03, 0.5), become(lambda rng, values: np.sort(values))),
    ],
    "flipped": [("sign", COLUMNS, of_one_sweep, become(lambda rng, values: -values))],
    "decimals": [
        # 12,34 became 1234: in some rows; in what was typed in, either way.
        ("comma-lost", COLUMNS, lines(0.003, 0.1), become(lambda rng, values: values * 10.0 ** rng.integers(1, 4))),
        ("comma-of-a-sweep", COLUMNS, one_sweep, become(lambda rng, values: values * 10.0 ** rng.choice([-1, 1, 2]))),
        ("thousands", ("force",), thousands),
    ],
    "dropout": [("zeros", (*COLUMNS, "all"), loose, become(lambda rng, values: 0.0 * values))],
    "stuck-bit": [("bit", COLUMNS, stuck_bit)],
}
"""Kind of damage -> habits: name, columns, and a pick with a deed, or a habit that does both."""


def listed(kind):
    """(habit, column) of a kind, one after the other."""
    return [(name, column) for name, columns, *_ in HABITS[kind] for column in columns]


def harmed(rng, table, kind, habit, column, strength):
    """A damaged copy of the table, and the damaged rows."""
    table = {name: values.copy() for name, values in table.items()}
    first, *deed = next(ways for name, columns, *ways in HABITS[kind] if name == habit and column in columns)
    if not deed:
        return first(rng, table, column, strength)
    rows = first(rng, table, column, strength)
    deed[0](rng, table, column, strength, rows)
    return table, rows
