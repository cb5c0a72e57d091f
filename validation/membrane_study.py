"""The second-generation PPAM by membrane finite elements, beside the meridian and the measured muscle: force and volume over contraction at
1, 2 and 3 bar, and the radius and the circumference of the cloth that come nearest to what was measured.

    python validation/membrane_study.py [--bulge PROGRAM] [--picture FILE.png]

The picture needs matplotlib; the fit needs nothing. Measured: Verrelst et al. (2006), Table 1, in N per bar at l0 = 110 mm (the coefficients of
their fit, evaluated; 1 bar). Assumed: 40 fibres of 12 kN, cloth of 50 kN/m, as in meshes/ppam.toml.
"""

import argparse
import csv
import json
import math
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MEASURED = {0.05: 1524.0, 0.10: 1047.0, 0.20: 540.0, 0.30: 211.0}
MUSCLE = 'name = "pleated"\nkind = "pleated"\nlength = "110 mm"\nradius = "{radius} mm"\nfibres = 40\n'
CASE = """
[mesher]
kind = "pleated"
muscle = "muscle.toml"
circumference = "{cloth} mm"
cells = [{cells}]
[[material]]
name = "cloth"
law = "st-venant"
thickness = "0.1 mm"
young = "500 MPa"
poisson = 0.3
[[part]]
group = "cloth"
kind = "membrane"
material = "cloth"
warp = [0, 1, 0]
[[part]]
group = "fibre"
kind = "cable"
stiffness = "12 kN"
[[step]]
pressure = "1 bar"
contraction = "5 %"
[[step]]
contraction = "30 %"
states = 5
"""


def run(program: str, *arguments: str) -> str:
    """What Bulge prints."""
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout


def forces(program: str, radius: float, cloth: float, cells: str = "8, 30") -> list[float]:
    """Elements at the measured contractions, 1 bar, in N."""
    with tempfile.TemporaryDirectory() as folder:
        case = Path(folder) / "case.toml"
        (Path(folder) / "muscle.toml").write_text(MUSCLE.format(radius=radius))
        case.write_text(CASE.format(cloth=cloth, cells=cells))
        document = json.loads(run(program, "membrane", str(case), "--out", str(Path(folder) / "out"), "--json"))
        found = {round(state["contraction"], 4): state["force_n"] for state in document["states"]}
        return [found[contraction] for contraction in MEASURED]


def rms(values: list[float]) -> float:
    """Root of the mean square."""
    return math.sqrt(sum(value * value for value in values) / len(values))


def fit(program: str, guess: tuple[float, float]) -> None:
    """Gauss and Newton over the radius of the fibres and the circumference of the cloth, with derivatives by differences."""

    def residuals(at: tuple[float, float]) -> list[float]:
        return [a - b for a, b in zip(forces(program, *at), MEASURED.values())]

    at, now = guess, residuals(guess)
    for _ in range(12):
        slopes = []
        for i, h in enumerate((0.05, 1.0)):
            moved = list(at)
            moved[i] += h
            slopes.append([(a - b) / h for a, b in zip(residuals(tuple(moved)), now)])
        (a, b), c = (sum(x * x for x in slopes[0]), sum(x * y for x, y in zip(*slopes))), sum(y * y for y in slopes[1])
        right = [-sum(x * r for x, r in zip(slope, now)) for slope in slopes]
        det = a * c - b * b
        step = [(c * right[0] - b * right[1]) / det, (a * right[1] - b * right[0]) / det]
        length = 1.0
        while length > 0.05:
            trial = (at[0] + length * step[0], at[1] + length * step[1])
            try:
                after = residuals(trial)
            except subprocess.CalledProcessError:
                # A cloth that doesn't reach round its fibres.
                after = [math.inf]
            if rms(after) < rms(now):
                break
            length *= 0.5
        if rms(after) >= rms(now) * (1 - 1e-3):
            break
        at, now = trial, after
    # Two numbers from four: what the misfit itself says of them.
    spread = math.sqrt(sum(r * r for r in now) / (len(now) - 2))
    errors = spread * math.sqrt(c / det), spread * math.sqrt(a / det)
    print(f"nearest to Table 1: fibres at {at[0]:.2f} +- {errors[0]:.2f} mm, cloth {at[1]:.0f} +- {errors[1]:.0f} mm round "
          f"(no fold left at {at[1] / math.tau:.1f} mm): misfit {rms(now):.1f} N, at each: {', '.join(f'{r:+.0f}' for r in now)}")


def study(program: str) -> tuple[list[dict[str, float]], dict[str, list[dict[str, float]]]]:
    """The states of meshes/ppam.toml, and the meridian's curves for both radii."""
    with tempfile.TemporaryDirectory() as folder:
        run(program, "membrane", str(ROOT / "meshes" / "ppam.toml"), "--out", folder)
        with (Path(folder) / "states.csv").open() as file:
            states = [{key.split(" ")[0]: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    meridian = {}
    for muscle in ("ppam-2-r11.5", "ppam-2-r16"):
        meridian[muscle] = []
        for bar in (1, 2, 3):
            for percent in range(2, 37):
                found = json.loads(run(program, "shape", muscle, "--pressure", f"{bar} bar", "--contraction", f"{percent} %", "--json"))
                meridian[muscle].append({"pressure": 1e5 * bar, **{key: found[key] for key in ("contraction", "force_n", "volume_m3")}})
    return states, meridian


def table(states: list[dict[str, float]], meridian: dict[str, list[dict[str, float]]]) -> None:
    """Elements over the meridian of the fibres' own radius."""
    print("contraction   " + "   ".join(f"F/F_meridian, V/V_meridian at {bar} bar" for bar in (1, 2, 3)))
    for percent in (5, 10, 15, 20, 25, 30, 35):
        cells = []
        for bar in (1, 2, 3):
            def near(rows: list[dict[str, float]]) -> dict[str, float]:
                return next(row for row in rows if abs(row["contraction"] - percent / 100) < 1e-6 and abs(row["pressure"] - 1e5 * bar) < 1)

            a, b = near(states), near(meridian["ppam-2-r11.5"])
            cells.append(f"{a['force'] / b['force_n']:12.4f} {a['volume'] / b['volume_m3']:18.4f}")
        print(f"{percent:9} %   " + "   ".join(f"{cell:33}" for cell in cells))


def picture(path: str, states: list[dict[str, float]], meridian: dict[str, list[dict[str, float]]]) -> None:
    """Force and volume over contraction."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, 2, figsize=(10, 4.2), constrained_layout=True)
    for bar, colour in ((1, "#1b6ca8"), (2, "#c0562f"), (3, "#3d7f3d")):
        of = [row for row in states if abs(row["pressure"] - 1e5 * bar) < 1]
        line = [row for row in meridian["ppam-2-r11.5"] if abs(row["pressure"] - 1e5 * bar) < 1]
        for axis, mine, theirs, unit in ((axes[0], "force", "force_n", 1e-3), (axes[1], "volume", "volume_m3", 1e6)):
            axis.plot([100 * row["contraction"] for row in line], [unit * row[theirs] for row in line], color=colour, lw=1.2, label=f"meridian, {bar} bar")
            axis.plot([100 * row["contraction"] for row in of], [unit * row[mine] for row in of], ".", color=colour, ms=5, label=f"elements, {bar} bar")
        axes[0].plot([100 * x for x in MEASURED], [1e-3 * bar * y for y in MEASURED.values()], "x", color=colour, ms=7, label="measured (S1)" if bar == 1 else None)
    axes[0].set(xlabel="contraction [%]", ylabel="force [kN]", xlim=(0, 36), ylim=(-0.2, 5.2))
    axes[1].set(xlabel="contraction [%]", ylabel="volume [ml]", xlim=(0, 36))
    axes[0].legend(fontsize=8, frameon=False)
    for axis in axes:
        axis.spines[["top", "right"]].set_visible(False)
        axis.grid(alpha=0.25)
    figure.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bulge", default=str(ROOT / "target" / "release" / "bulge"))
    parser.add_argument("--picture")
    arguments = parser.parse_args()
    states, meridian = study(arguments.bulge)
    table(states, meridian)
    fit(arguments.bulge, (16.5, 310.0))
    if arguments.picture:
        picture(arguments.picture, states, meridian)


if __name__ == "__main__":
    main()
