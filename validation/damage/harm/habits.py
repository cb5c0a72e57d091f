"""What goes wrong with a table: every habit changes columns (SI) and says which rows it touched.

A habit takes a generator of random numbers, the table, the column, and a strength from 0 (mild) to 1 (severe). It returns the table and its damaged
rows, counted from 0. It draws the same random numbers whatever the readings are, so that a table without noise is damaged alike.
"""

import numpy as np

HABITS = {}
"""Kind of damage -> its habits, each (name, column, function)."""
COLUMNS = ("force", "pressure", "length")


def habit(kind, *columns):
    """Enters a function as a habit of that kind, once for each column."""

    def entered(function):
        name = function.__name__.strip("_").replace("_", "-")
        HABITS.setdefault(kind, []).extend((name, column, function) for column in columns)
        return function

    return entered


def between(low, high, strength):
    """From low to high on a logarithmic scale."""
    return float(low * (high / low) ** strength)


def span(values):
    """Range of a column, without the extremes."""
    low, high = np.nanquantile(values, (0.01, 0.99))
    return float(high - low)


def stretch(rng, table, share):
    """Neighbouring rows, about that share of all."""
    count = len(table["force"])
    width = min(max(4, round(share * count)), count - 8)
    start = int(rng.integers(4, count - width - 3))
    return np.arange(start, start + width)


def sweep(rng, table):
    """Rows of one sweep; of a test in one piece, a quarter of it."""
    names = np.unique(table["sweep"])
    pick = rng.random()
    if len(names) > 1:
        return np.flatnonzero(table["sweep"] == names[int(pick * len(names))])
    quarter = len(table["force"]) // 4
    return np.arange(quarter) + int(pick * 3.99) * quarter


def some(rng, table, share):
    """Single rows, not the first nor the last ones."""
    count = len(table["force"])
    return np.sort(rng.choice(np.arange(3, count - 3), max(2, round(share * count)), replace=False))


def taken(table, order):
    """Rows in another order, or some of them."""
    return {name: values[order] for name, values in table.items()}


def _hit(rng, table, column, strength, rows):
    """Spikes of 1 to 60 % of the range; in half of all tests to one side."""
    height = span(table[column]) * between(0.01, 0.6, strength) * rng.uniform(0.6, 1.4, len(rows))
    sides = rng.choice([-1.0, 1.0], len(rows)) if rng.random() < 0.5 else rng.choice([-1.0, 1.0])
    table[column][rows] += sides * height
    return table, rows


@habit("spikes", *COLUMNS)
def _isolated(rng, table, column, strength):
    """Single rows."""
    return _hit(rng, table, column, strength, some(rng, table, rng.uniform(0.003, 0.02)))


@habit("spikes", *COLUMNS)
def _pairs(rng, table, column, strength):
    """Two rows each."""
    rows = some(rng, table, rng.uniform(0.003, 0.015))
    return _hit(rng, table, column, strength, np.unique(np.r_[rows, rows + 1]))


@habit("spikes", *COLUMNS)
def _bursts(rng, table, column, strength):
    """Four to nine rows each, of either sign: a relay, a motor."""
    starts = some(rng, table, rng.uniform(0.002, 0.006))
    rows = np.unique(np.concatenate([start + np.arange(int(rng.integers(4, 10))) for start in starts]))
    return _hit(rng, table, column, strength, rows[rows < len(table["force"]) - 1])


ZERO = {"force": (0.5, 40.0), "pressure": (4e2, 2e4), "length": (5e-5, 2e-3)}
"""A zero that moved: mild and severe."""


@habit("shifted", *COLUMNS)
def _zero_of_a_sweep(rng, table, column, strength):
    """The amplifier was balanced anew before one sweep."""
    rows = sweep(rng, table)
    table[column][rows] += between(*ZERO[column], strength) * rng.choice([-1.0, 1.0])
    return table, rows


@habit("slip", *COLUMNS)
def _to_the_end(rng, table, column, strength):
    """A clamp slips, a cell is knocked, a plug is moved: what comes after is off, to the end of the record."""
    start = int(rng.uniform(0.15, 0.85) * len(table["force"]))
    rows = np.arange(start, len(table["force"]))
    table[column][rows] += between(*ZERO[column], strength) * rng.choice([-1.0, 1.0])
    return table, rows


@habit("slip", *COLUMNS)
def _to_the_end_of_the_sweep(rng, table, column, strength):
    """The same, put right before the next sweep."""
    rows = sweep(rng, table)
    rows = rows[int(rng.uniform(0.2, 0.8) * len(rows)) :]
    table[column][rows] += between(*ZERO[column], strength) * rng.choice([-1.0, 1.0])
    return table, rows


@habit("frozen", *COLUMNS, "all")
def _held(rng, table, column, strength):
    """A channel repeats its last reading: a bus that hangs."""
    rows = stretch(rng, table, between(0.01, 0.2, strength))
    for name in COLUMNS if column == "all" else (column,):
        table[name][rows] = table[name][rows[0] - 1]
    return table, rows


@habit("frozen", *COLUMNS)
def _stutters(rng, table, column, strength):
    """Several short pieces."""
    pieces = [stretch(rng, table, between(0.01, 0.06, strength)) for _ in range(4)]
    for rows in pieces:
        table[column][rows] = table[column][rows[0] - 1]
    return table, np.unique(np.concatenate(pieces))


def _beyond(table, column, share, top):
    """The level beyond which that share of readings lies, and these rows."""
    level = float(np.quantile(table[column], 1.0 - share if top else share))
    return level, np.flatnonzero(table[column] > level if top else table[column] < level)


@habit("clipped", "force", "pressure")
def _top(rng, table, column, strength):
    """The amplifier ends below the largest readings."""
    level, rows = _beyond(table, column, between(0.01, 0.2, strength), True)
    table[column][rows] = level
    return table, rows


@habit("clipped", "force", "pressure")
def _bottom(rng, table, column, strength):
    """It ends above the smallest ones."""
    level, rows = _beyond(table, column, between(0.01, 0.2, strength), False)
    table[column][rows] = level
    return table, rows


@habit("clipped", "force", "pressure")
def _softly(rng, table, column, strength):
    """It bends before it ends: beyond a knee readings approach a ceiling."""
    level, rows = _beyond(table, column, between(0.05, 0.3, strength), True)
    room = max(float(np.max(table[column])) - level, 1e-9) * between(2.0, 0.4, strength)
    table[column][rows] = level + room * np.tanh((table[column][rows] - level) / room)
    return table, rows


@habit("duplicated", "all")
def _rows_twice(rng, table, column, strength):
    """The logger writes a row again."""
    rows = some(rng, table, between(0.005, 0.15, strength))
    order = np.sort(np.r_[np.arange(len(table["force"])), rows])
    return taken(table, order), np.flatnonzero(np.diff(order, prepend=-1) == 0)


@habit("duplicated", "all")
def _sweep_twice(rng, table, column, strength):
    """A sweep is written again at the end, with times that go on."""
    rows = sweep(rng, table)
    count = len(table["force"])
    table = taken(table, np.r_[np.arange(count), rows])
    table["time"][count:] += table["time"][count - 1] - table["time"][count] + np.median(np.diff(table["time"]))
    table["sweep"][count:] = np.max(table["sweep"]) + 1.0
    return table, np.arange(count, count + len(rows))


@habit("duplicated", "all", "force")
def _block_over_another(rng, table, column, strength):
    """A block was copied over other rows, whose times and labels stay."""
    rows = stretch(rng, table, between(0.02, 0.15, strength))
    source = (rows + int(rng.uniform(0.25, 0.75) * len(table["force"]))) % len(table["force"])
    for name in COLUMNS if column == "all" else (column,):
        table[name][rows] = table[name][source].copy()
    return table, rows


@habit("swapped", "direction")
def _labels(rng, table, column, strength):
    """The words for loading and unloading are exchanged, in one sweep or in all."""
    rows = sweep(rng, table) if strength < 0.5 else np.arange(len(table["force"]))
    table["direction"][rows] *= -1.0
    return table, rows


@habit("swapped", "all")
def _backwards(rng, table, column, strength):
    """A sweep is stored from its end, its times not."""
    rows = sweep(rng, table)
    for name in COLUMNS:
        table[name][rows] = table[name][rows[::-1]]
    return table, rows


@habit("swapped", *COLUMNS)
def _one_channel_backwards(rng, table, column, strength):
    """Only one channel of a sweep was turned round: loading beside unloading."""
    rows = sweep(rng, table)
    if strength < 0.5:
        rows = rows[: max(len(rows) // 3, 6)]
    table[column][rows] = table[column][rows[::-1]]
    return table, rows


@habit("swapped", "all")
def _branches(rng, table, column, strength):
    """The second half of a sweep was pasted before the first."""
    rows = sweep(rng, table)
    for name in COLUMNS:
        table[name][rows] = np.roll(table[name][rows], len(rows) // 2)
    return table, rows


@habit("mislabelled", "specimen")
def _block(rng, table, column, strength):
    """Rows of one specimen bear the name of another."""
    return _renamed(rng, table, stretch(rng, table, between(0.02, 0.2, strength)))


@habit("mislabelled", "specimen")
def _whole_sweep(rng, table, column, strength):
    """A whole sweep does."""
    rows = np.flatnonzero(table["specimen"] == float(rng.integers(1, 4)))
    label = rng.choice(np.unique(table["sweep"][rows]))
    chosen = rows[table["sweep"][rows] == label]
    # A specimen with a single sweep keeps half of it.
    return _renamed(rng, table, chosen if len(chosen) < len(rows) else chosen[: len(rows) // 2])


@habit("mislabelled", "specimen")
def _exchanged(rng, table, column, strength):
    """Two specimens have changed their names."""
    one, other = (float(k) for k in rng.choice([1, 2, 3], 2, replace=False))
    old = table["specimen"].copy()
    table["specimen"][old == one], table["specimen"][old == other] = other, one
    return table, np.flatnonzero(table["specimen"] != old)


def _renamed(rng, table, rows):
    new = table["specimen"][rows] % 3 + 1.0
    table["specimen"][rows] = new
    return table, rows


@habit("late", *COLUMNS)
def _by_samples(rng, table, column, strength):
    """One channel is late by one to thirty samples, everywhere."""
    late = round(between(1, 30, strength))
    for label in np.unique(table["sweep"]):
        rows = np.flatnonzero(table["sweep"] == label)
        table[column][rows] = table[column][rows[np.maximum(np.arange(len(rows)) - late, 0)]]
    return table, np.arange(len(table["force"]))


@habit("late", "force", "pressure")
def _resampled(rng, table, column, strength):
    """One channel comes every few rows only: held in between, or joined by lines."""
    every = round(between(3, 40, strength))
    rows = np.arange(len(table["force"]))
    known = rows[::every]
    drawn = rng.random() < 0.5
    table[column] = np.interp(rows, known, table[column][known]) if drawn else table[column][rows // every * every]
    return table, rows


@habit("gaps", "all")
def _lost(rng, table, column, strength):
    """Packets are missing; the clock goes on."""
    gone = np.concatenate([stretch(rng, table, between(0.02, 0.1, strength)) for _ in range(3)])
    left = np.setdiff1d(np.arange(len(table["force"])), gone)
    return taken(table, left), np.flatnonzero(np.diff(left, prepend=-1) > 1)


@habit("gaps", "time")
def _lost_without_a_trace(rng, table, column, strength):
    """The times are counted from the rows that are left."""
    step, start = float(np.median(np.diff(table["time"]))), table["time"][0]
    table, rows = _lost(rng, table, column, strength)
    table["time"] = start + step * np.arange(len(table["force"]))
    return table, rows


@habit("gaps", *COLUMNS)
def _bridged(rng, table, column, strength):
    """A straight line across each gap of one channel, written by the evaluation."""
    pieces = [stretch(rng, table, between(0.01, 0.06, strength)) for _ in range(3)]
    for rows in pieces:
        ends = [rows[0] - 1, rows[-1] + 1]
        table[column][rows] = np.interp(rows, ends, table[column][ends])
    return table, np.unique(np.concatenate(pieces))


@habit("sorted", "all")
def _with_times(rng, table, column, strength):
    """A spreadsheet sorted the rows by one column; the times went along."""
    order = np.argsort(table[str(rng.choice(COLUMNS))], kind="stable")
    return taken(table, order), np.arange(len(order))


@habit("sorted", "time")
def _without_times(rng, table, column, strength):
    """The rows are sorted, and numbered anew: the clock says nothing."""
    times = table["time"].copy()
    table, rows = _with_times(rng, table, column, strength)
    table["time"] = times
    return table, rows


@habit("sorted", *COLUMNS)
def _one_column(rng, table, column, strength):
    """Only one column was marked when a block was sorted."""
    rows = stretch(rng, table, between(0.03, 0.5, strength))
    table[column][rows] = np.sort(table[column][rows])
    return table, rows


@habit("flipped", *COLUMNS)
def _sign(rng, table, column, strength):
    """The sign is turned in one sweep, or in a part of it."""
    rows = sweep(rng, table)
    if strength < 0.5:
        rows = rows[: max(round(between(0.05, 1.0, 2.0 * strength) * len(rows)), 3)]
    table[column][rows] *= -1.0
    return table, rows


@habit("decimals", *COLUMNS)
def _comma_lost(rng, table, column, strength):
    """12,34 became 1234 in some rows."""
    rows = some(rng, table, between(0.003, 0.1, strength))
    table[column][rows] *= 10.0 ** rng.integers(1, 4)
    return table, rows


@habit("decimals", *COLUMNS)
def _comma_of_a_sweep(rng, table, column, strength):
    """The same in a whole sweep, which was typed in."""
    rows = sweep(rng, table)
    table[column][rows] *= 10.0 ** rng.choice([-1, 1, 2])
    return table, rows


@habit("decimals", "force")
def _thousands(rng, table, column, strength):
    """1,234.5 became 1.2345 wherever there was a thousand."""
    rows = np.flatnonzero(table[column] >= np.quantile(table[column], between(0.98, 0.8, strength)))
    table[column][rows] *= 1e-3
    return table, rows


@habit("dropout", *COLUMNS, "all")
def _zeros(rng, table, column, strength):
    """A loose plug: zeros, row by row or for a while."""
    rows = some(rng, table, between(0.003, 0.08, strength))
    if rng.random() < 0.5:
        rows = np.unique(np.concatenate([stretch(rng, table, between(0.004, 0.05, strength)) for _ in range(3)]))
    for name in COLUMNS if column == "all" else (column,):
        table[name][rows] = 0.0
    return table, rows


@habit("stuck-bit", *COLUMNS)
def _bit(rng, table, column, strength):
    """One bit of a 14-bit converter is always set or never, from some row on."""
    low, step = float(np.min(table[column])), 1.3 * float(np.ptp(table[column])) / 2**14
    bit = 2 ** round(3 + 8 * strength)
    counts = np.floor((table[column] - low) / max(step, 1e-12)).astype(int)
    stuck = counts | bit if rng.random() < 0.5 else counts & ~bit
    rows = np.flatnonzero(stuck != counts)
    rows = rows[rows >= rng.choice([0.0, 0.0, 0.4]) * len(counts)]
    table[column][rows] += (stuck - counts)[rows] * step
    return table, rows


@habit("leak", "pressure")
def _seen(rng, table, column, strength):
    """The supply sags, and the sensor shows it: nothing is wrong with the readings."""
    return table, np.flatnonzero(table["leaking"])


@habit("leak", "pressure")
def _unseen(rng, table, column, strength):
    """The sensor sits at the supply, before the leak."""
    rows = np.flatnonzero(table["leaking"])
    table[column][rows] = table["supply"][rows]
    return table, rows


@habit("leak", "pressure")
def _unread(rng, table, column, strength):
    """The reading is held while the pressure falls."""
    rows = np.flatnonzero(table["leaking"])
    table[column][rows] = table[column][max(rows[0] - 1, 0)]
    return table, rows


UNITS = {"pressure": {"psi": 14.503773773, "kPa": 100.0}, "length": {"cm": 0.1, "inch": 1.0 / 25.4}, "force": {"kgf": 1.0 / 9.80665, "lbf": 1.0 / 4.4482216}}
"""Numbers in these units under the heading of the others: bar, mm, N."""


@habit("unit", *COLUMNS)
def _unit(rng, table, column, strength):
    """One file of five holds another unit."""
    rows = np.flatnonzero(table["file"] == float(rng.integers(1, 6)))
    table[column][rows] *= UNITS[column][str(rng.choice(sorted(UNITS[column])))]
    return table, rows


@habit("unit", "pressure")
def _absolute(rng, table, column, strength):
    """One file of five holds absolute pressures."""
    rows = np.flatnonzero(table["file"] == float(rng.integers(1, 6)))
    table[column][rows] += 101325.0
    return table, rows
