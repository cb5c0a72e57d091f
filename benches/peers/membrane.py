"""Membranes with dolfinx, CalculiX and sfepy beside Bulge, in one session, in CPU seconds on one thread; prints a table in Markdown.

    python3 benches/peers/membrane.py [rounds]

The tube: R = 10 mm, L = 60 mm, clamped, neo-Hookean, 0.4 N/mm, 30 kPa; errors of the radius at half length and of the force against shooting at 1e-13.
Nothing is installed here; a peer that is missing is left out with a word:
- dolfinx 0.5 under Debian's own /usr/bin/python3 (Debian 12: python3-dolfinx), with the same cells as Bulge; its forms are compiled in a first run, told apart,
- CalculiX (Debian: calculix-ccx), which has no clock for its solve: the whole process stands for it,
- sfepy for the Python that runs this (PyPI: sfepy); its own balloon, for which the program of the benches has no case,
- mem4py, the peer of the airbag, is in no package index; that case has none here.

dolfinx takes the fewest pressures at which its plain Newton iteration was found to converge; CalculiX and sfepy choose their own steps. The shortest of
the rounds counts. Bulge's solve is the time its program prints, the shortest of its runs, with reading the case and making the mesh (elapsed, so no less
than its CPU seconds); its process is an empty run of the program and one solve.
Ends with an error if a peer fails, or its tube is off by more than 1 % in radius or 2 % in force.
"""

import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import membrane_ccx
from compare import HERE, build_own

DEBIAN = "/usr/bin/python3"
RADIUS, FORCE = 14.1387458746, -4.5093718857
REVOLVED, TRIANGLES, AIRBAG = "tube, 30 quadratic elements of revolution", "tube, 24 x 48 cells of triangles", "square airbag, 3200 triangles"
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS", "CCX_NPROC_EQUATION_SOLVER")
LIMITS = 1e-2, 2e-2


@dataclass
class Row:
    """A line of the table: CPU seconds, what was reached, and the case of Bulge's with which it is compared."""

    name: str
    solve: float
    process: float
    reached: str
    rival: str | None = None


def run(command: list[str], folder: str, **more: str) -> tuple[str, float]:
    """What a program prints, and its CPU seconds with those of its children, on one thread."""
    environment = os.environ | dict.fromkeys(THREADS, "1") | more
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=out, stderr=said, text=True)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0), said.seek(0)
        text = out.read()
        if process.returncode != 0:
            lines = (said.read().strip() or text.strip() or "no word").splitlines()
            raise RuntimeError(f"{Path(command[0]).name} ended with {process.returncode}: {lines[-1]}")
    return text, usage.ru_utime + usage.ru_stime


def tube(radius: float, force: float) -> str:
    """Both errors of a tube in words; it must be the same tube."""
    off = radius / RADIUS - 1, force / FORCE - 1
    if not all(abs(value) < limit for value, limit in zip(off, LIMITS)):
        raise RuntimeError(f"another tube: radius {off[0]:.1e}, force {off[1]:.1e}")
    return f"radius {off[0]:.1e}, force {off[1]:.1e}"


def bulge(rounds: int) -> list[Row]:
    """Bulge's own cases: the time is in the fifth column, in seconds, and the error in the last."""
    [program] = build_own("membrane")
    rows = []
    for name in (REVOLVED, TRIANGLES, AIRBAG):
        best, reached = math.inf, ""
        for _ in range(rounds):
            columns = run([program, name], str(HERE))[0].splitlines()[0].split("\t")
            best = min(best, float(columns[4].removesuffix(" s")))
            reached = columns[-1]
        empty = min(run([program, "no such case"], str(HERE))[1] for _ in range(rounds))
        rows.append(Row(f"Bulge, {name}", best, empty + best, reached, name))
    return rows


def dolfinx(rounds: int) -> list[Row]:
    """The tube by elements of revolution and by flat triangles."""
    imports = "import dolfinx, mpi4py, petsc4py"
    if not Path(DEBIAN).exists() or subprocess.run([DEBIAN, "-c", imports], capture_output=True).returncode != 0:
        raise FileNotFoundError(f"not installed for {DEBIAN} (Debian 12: python3-dolfinx)")
    # Kind and sizes, then the pressures.
    cases = [
        ("30 P2 of revolution", ["revolution", "30", "2", "4"], REVOLVED),
        ("24 x 12 x 2 triangles", ["triangles", "24", "12", "2"], TRIANGLES),
        ("48 x 24 x 2 triangles", ["triangles", "48", "24", "3"], TRIANGLES),
    ]
    rows = []
    for name, arguments, rival in cases:
        command = [DEBIAN, "-B", str(HERE / "membrane_dolfinx.py"), *arguments]
        with tempfile.TemporaryDirectory() as cache:
            first, *runs = [run(command, cache, XDG_CACHE_HOME=cache) for _ in range(1 + rounds)]
        answers = [json.loads(text.splitlines()[-1]) for text, _ in runs]
        answer = min(answers, key=lambda answer: answer["seconds"])
        process = min(seconds for _, seconds in runs)
        effort = f"{arguments[-1]} pressures, {answer['iterations']} iterations, first run {first[1]:.1f} s"
        reached = f"{tube(answer['radius'], answer['force'])}; {effort}"
        rows.append(Row(f"dolfinx {answer['version']}, {name}", answer["seconds"], process, reached, rival))
    return rows


def calculix(rounds: int) -> list[Row]:
    """The tube as a thin solid of revolution."""
    program = shutil.which("ccx")
    if program is None:
        raise FileNotFoundError("no ccx (Debian: calculix-ccx)")
    with tempfile.TemporaryDirectory() as folder:
        # It says its version and ends with an error.
        version = subprocess.run([program, "-v"], cwd=folder, capture_output=True, text=True).stdout.split()[-1]
        (Path(folder) / "tube.inp").write_text(membrane_ccx.deck(30))
        seconds = min(run([program, "-i", "tube"], folder)[1] for _ in range(rounds))
        radius, force = membrane_ccx.found((Path(folder) / "tube.dat").read_text())
        increments = (Path(folder) / "tube.sta").read_text().splitlines()[-1].split()[1]
    reached = f"{tube(radius, force)}; {increments} increments"
    return [Row(f"CalculiX {version}, 30 CAX8R, H/R = 0.01", seconds, seconds, reached, REVOLVED)]


def sfepy(rounds: int) -> list[Row]:
    """The balloon that comes with it."""
    if subprocess.run([sys.executable, "-c", "import sfepy"], capture_output=True).returncode != 0:
        raise FileNotFoundError("not installed for this Python (PyPI: sfepy)")
    with tempfile.TemporaryDirectory() as folder:
        runs = [run([sys.executable, str(HERE / "membrane_sfepy.py")], folder) for _ in range(rounds)]
    answers = [json.loads(text.splitlines()[-1]) for text, _ in runs]
    solve, process = min(answer["seconds"] for answer in answers), min(seconds for _, seconds in runs)
    answer = answers[0]
    reached = f"pressure {answer['pressure']:.1e}; {answer['steps']} volumes"
    return [Row(f"sfepy {answer['version']}, balloon of 1110 tetrahedra", solve, process, reached)]


def table(rows: list[Row], own: dict[str, Row]) -> None:
    """Ratios are those of the solves, then of the whole processes."""
    print("\n| program | solve, CPU s | process, CPU s | ratio of solves | of processes | error; effort |\n|---|---|---|---|---|---|")
    for row in rows:
        rival = own.get(row.rival or "")
        ratios = [f"{row.solve / rival.solve:.3g}", f"{row.process / rival.process:.3g}"] if rival else ["", ""]
        print(f"| {row.name} | {row.solve:.2g} | {row.process:.2g} | {' | '.join(ratios)} | {row.reached} |")


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    rows = bulge(rounds)
    own = {row.rival: row for row in rows}
    wrong = []
    for name, peer in (("dolfinx", dolfinx), ("CalculiX", calculix), ("sfepy", sfepy)):
        try:
            rows += peer(rounds)
        except FileNotFoundError as missing:
            print(f"skipped {name}: {missing}")
        except RuntimeError as failed:
            print(f"{name} failed: {failed}")
            wrong.append(name)
    print("skipped mem4py (airbag): in no package index")
    table(rows, own)
    if wrong:
        sys.exit(f"these failed: {', '.join(wrong)}")


if __name__ == "__main__":
    main()
