"""The path of a test: what the sensors would read without noise, row by row, and its uninterrupted runs."""

import csv
from dataclasses import dataclass
from functools import cached_property

import numpy as np

REFERENCE_TEMPERATURE = 20.0
_BAR, _KPA = 1e5, 1e3


@dataclass
class Path:
    """Readings in SI (temperature in degrees Celsius); `rate` is d(contraction)/dt. `timed` is False for a static map: one run, no order."""

    pressure: np.ndarray
    contraction: np.ndarray
    rate: np.ndarray
    time: np.ndarray
    sweep: np.ndarray
    cycle: np.ndarray
    specimen: np.ndarray
    temperature: np.ndarray
    timed: bool = True
    shows_cycle: bool = False
    shows_specimen: bool = False
    shows_temperature: bool = False

    def __len__(self):
        return len(self.pressure)

    @cached_property
    def runs(self):
        """Slices of the uninterrupted runs."""
        if not self.timed:
            return [slice(0, len(self))]
        starts = np.flatnonzero(np.r_[True, self.sweep[1:] != self.sweep[:-1]])
        return [slice(a, b) for a, b in zip(starts, np.r_[starts[1:], len(self)])]

    @cached_property
    def since_start(self):
        """Time since the start of the run [s]."""
        result = np.empty(len(self))
        for run in self.runs:
            result[run] = self.time[run] - self.time[run.start]
        return result

    @cached_property
    def travel(self):
        """Contraction travelled by the specimen so far, over all its runs, in units of full loops."""
        result = np.empty(len(self))
        done = {}
        span = 2.0 * np.ptp(self.contraction)
        for run in self.runs:
            steps = np.abs(np.diff(self.contraction[run], prepend=self.contraction[run.start]))
            name = self.specimen[run.start]
            result[run] = done.get(name, 0.0) + np.cumsum(steps)
            done[name] = result[run.stop - 1]
        return result / span


def write(file_name, path, force, muscle_length, pressure_unit="bar", motion="contraction"):
    """Writes rows as CSV with the columns that Bulge reads. `path` holds the readings as they are recorded."""
    size = _BAR if pressure_unit == "bar" else _KPA
    columns = [(f"pressure [{pressure_unit}]", [f"{v:.7g}" for v in path.pressure / size])]
    if motion == "contraction":
        columns.append(("contraction [%]", [f"{v:.6f}" for v in path.contraction * 100.0]))
    else:
        columns.append(("length [mm]", [f"{v:.5f}" for v in muscle_length * (1.0 - path.contraction) * 1e3]))
    columns.append(("force [N]", [f"{v:.6g}" for v in force]))
    if path.timed:
        columns.append(("time [s]", [f"{v:.4f}" for v in path.time]))
        columns.append(("sweep", [str(v) for v in path.sweep]))
    if path.shows_specimen:
        columns.append(("specimen", [str(v) for v in path.specimen]))
    if path.shows_cycle:
        columns.append(("cycle", [str(v) for v in path.cycle]))
    if path.shows_temperature:
        columns.append(("temperature [degC]", [f"{v:.2f}" for v in path.temperature]))
    with open(file_name, "w", encoding="utf-8", newline="\n") as file:
        file.write(",".join(name for name, _ in columns) + "\n")
        file.write("\n".join(map(",".join, zip(*(values for _, values in columns)))) + "\n")


def read(file_name, muscle_length):
    """Reads what `write` wrote: the path (rates by differences) and the force."""
    with open(file_name, encoding="utf-8", newline="") as file:
        rows = csv.reader(file)
        header = next(rows)
        table = dict(zip(header, zip(*rows)))
    count = len(table["force [N]"])

    def column(name, default):
        return np.array(table[name], float) if name in table else np.full(count, default)

    pressure = column("pressure [bar]", np.nan) * _BAR if "pressure [bar]" in table else column("pressure [kPa]", np.nan) * _KPA
    contraction = (
        column("contraction [%]", np.nan) / 100.0
        if "contraction [%]" in table
        else 1.0 - column("length [mm]", np.nan) / 1e3 / muscle_length
    )
    path = Path(
        pressure=pressure,
        contraction=contraction,
        rate=np.zeros(count),
        time=column("time [s]", 0.0),
        sweep=column("sweep", 1).astype(int),
        cycle=column("cycle", 0).astype(int),
        specimen=column("specimen", 1).astype(int),
        temperature=column("temperature [degC]", REFERENCE_TEMPERATURE),
        timed="time [s]" in table,
        shows_cycle="cycle" in table,
        shows_specimen="specimen" in table,
        shows_temperature="temperature [degC]" in table,
    )
    if path.timed:
        for run in path.runs:
            path.rate[run] = np.gradient(contraction[run], path.time[run])
    return path, column("force [N]", np.nan)
