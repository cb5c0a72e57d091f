"""What a question costs here and with what people would use instead, in one run: the ratios that a change may not make worse.

    python benches/ratios.py --bulge PATH [--write | --check]

Needs NumPy, SciPy and lmfit. Each pair is timed in turns, the best of three counts. `--write` puts the figures with date and machine into benches/ratios.json, from
which validation/docs_table.py writes the tables; `--check` fails where a ratio has fallen by a third against that file. Times differ between
machines, ratios much less.
"""

import argparse
import datetime
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROUNDS = 3
FALL = 2 / 3
sys.path.insert(0, str(HERE / "peers"))


class Program:
    """The command `bulge`, on one thread."""

    def __init__(self, path):
        self.path = str(Path(path).resolve())

    def seconds(self, *arguments):
        """Wall time of a call."""
        words = [self.path, *map(str, arguments)]
        started = time.perf_counter()
        subprocess.run(words, check=True, capture_output=True, env={**os.environ, "RAYON_NUM_THREADS": "1"})
        return time.perf_counter() - started


def of_sweep(program, folder):
    """Equilibria of a pleated muscle: a sweep with its files against `fsolve` on the elliptic equations, each point from a fixed start."""
    from pleated_scipy import CONTRACTIONS, closed_form, contraction

    sweep = HERE / "sweeps/pleated.toml"
    points = 1_000_000

    def own():
        out = Path(folder) / f"sweep-{time.monotonic_ns()}"
        return program.seconds("sweep", sweep, "--out", out) / points

    def peer():
        started = time.perf_counter()
        for i in range(0, CONTRACTIONS, 2):
            closed_form(contraction(i))
        return (time.perf_counter() - started) / len(range(0, CONTRACTIONS, 2))

    return own, peer


def of_curve(program, folder):
    """Equilibria by the ODE: a curve with its file against `fsolve` on `solve_ivp` (DOP853)."""
    from pleated_scipy import CONTRACTIONS, contraction, shooting

    points = 3 * 4001
    command = ["curve", "ppam-2-r16", "--method", "shooting", "--pressure", "1 bar,2 bar,3 bar", "--points", 4001, "--csv", Path(folder) / "curve.csv"]

    def own():
        return program.seconds(*command) / points

    def peer():
        few = range(0, CONTRACTIONS, 20)
        started = time.perf_counter()
        for i in few:
            shooting(contraction(i))
        return (time.perf_counter() - started) / len(few)

    return own, peer


def of_fit(program, folder):
    """Four effects fitted to 10^4 rows: `bulge fit` from eight starts with its file, against lmfit from one, its Jacobian of the equilibrium derived by hand."""
    import numpy as np
    from fit import exact, fit

    folder = Path(folder) / "fit"
    folder.mkdir()
    protocol = folder / "protocol.toml"
    protocol.write_text(PROTOCOL, encoding="utf-8")
    hidden = "coulomb-friction=12 N,viscous-damping=40 N s/%,fibre-stretch,length-zero-error=0.3 mm"
    program.seconds("simulate", "ppam-2-r16", "--protocol", protocol, "--with", hidden, "--out", folder)
    data = folder / "data.csv"
    lines = [line for line in data.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    names = [name.split(" [")[0] for name in lines[0].split(",")]
    units = {"pressure": 1e5, "contraction": 0.01}
    column = {name: np.genfromtxt(lines[1:], delimiter=",", usecols=i) * units.get(name, 1.0) for i, name in enumerate(names)}
    rate = np.zeros(len(column["time"]))
    for sweep in np.unique(column["sweep"]):
        of = column["sweep"] == sweep
        rate[of] = np.gradient(column["contraction"][of], column["time"][of])
    rows = (column["pressure"], column["contraction"], np.sign(rate), rate, column["force"])
    command = ["fit", data, "--muscle", folder / "muscle.toml", "--with", EFFECTS, "--out", folder / "learnt.toml"]

    def peer():
        started = time.perf_counter()
        fit(rows, exact, 1)
        return time.perf_counter() - started

    return lambda: program.seconds(*command), peer


EFFECTS = "coulomb-friction,viscous-damping,fibre-stretch,length-zero-error"
PROTOCOL = """
[[block]]
pressures = ["1 bar", "1.5 bar", "2 bar", "2.5 bar", "3 bar"]
contraction = "5 %..30 %"
shape = "loops"
wave = "sine"
cycles = 4
period = "20 s"
rows = 500
[noise]
force = "2 N"
"""
QUESTIONS = {
    "one equilibrium, closed form (`bulge sweep` of 10^6 points with its files)": ("SciPy, `fsolve` on elliptic integrals", of_sweep),
    "one equilibrium by shooting (`bulge curve` of 12003 points with its file)": ("SciPy, `fsolve` on `solve_ivp`", of_curve),
    "fit of four effects to 10^4 rows, eight starts (`bulge fit`)": ("lmfit, Jacobian by hand, one start", of_fit),
}


def measured(program):
    """All questions, each with the best time of either side."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for question, (peer_is, build) in QUESTIONS.items():
            sides = build(program, folder)
            times = [[side() for side in sides] for _ in range(ROUNDS)]
            own_s, peer_s = (min(column) for column in zip(*times))
            rows.append({"question": question, "own_s": own_s, "peer_is": peer_is, "peer_s": peer_s, "ratio": peer_s / own_s})
            print(f"{question}: {1e6 * own_s:.3g} us, {peer_is} {1e6 * peer_s:.3g} us: {peer_s / own_s:.3g} times")
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bulge", default="target/release/bulge")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    rows = measured(Program(arguments.bulge))
    file = HERE / "ratios.json"
    if arguments.write:
        stated = {"date": f"{datetime.date.today():%d %B %Y}".lstrip("0"), "machine": f"one core, {os.cpu_count()}-core {platform.machine()} {platform.system()}"}
        file.write_text(json.dumps({**stated, "command": "python benches/ratios.py --bulge PATH --write", "rows": rows}, indent=1) + "\n", encoding="utf-8")
    if arguments.check:
        before = {row["question"]: row["ratio"] for row in json.loads(file.read_text(encoding="utf-8"))["rows"]}
        slow = [row for row in rows if row["ratio"] < FALL * before.get(row["question"], 0.0)]
        for row in slow:
            print(f"{row['question']}: {row['ratio']:.3g} times as fast as {row['peer_is']}, {before[row['question']]:.3g} times before", file=sys.stderr)
        return 1 if slow else 0
    return 0


if __name__ == "__main__":
    sys.exit(main())
