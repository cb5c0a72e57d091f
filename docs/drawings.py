#!/usr/bin/env python3
"""Draws the pictures of docs/drawings. Shapes of muscles come from the program.

    python3 docs/drawings.py --bulge target/release/bulge

Needs matplotlib. On white, so that they read on dark pages too.
"""

import argparse
import json
import subprocess
import tempfile
import tomllib
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({"svg.hashsalt": "bulge", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 11})
import numpy as np  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.patches import Arc, FancyBboxPatch, Polygon, Rectangle  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs/drawings"
INK, BLUE, RED, GREY, PALE, STEEL = "#1a1a1a", "#1f4e9c", "#c2410c", "#777777", "#dbe7f6", "#566473"


def canvas(width, height, x, y):
    """A figure without axes, in the units of the drawing."""
    figure = Figure(figsize=(width, height), facecolor="white")
    axes = figure.add_axes((0.01, 0.01, 0.98, 0.98))
    axes.set(xlim=x, ylim=y, aspect="equal")
    axes.axis("off")
    return figure, axes


def saved(figure, name):
    path = FOLDER / name
    figure.savefig(path, metadata={"Date": None})
    # Fonts by their family alone: others than DejaVu do as well.
    path.write_text("\n".join(line.rstrip() for line in path.read_text(encoding="utf-8").splitlines()) + "\n", encoding="utf-8")


def arrow(axes, tail, tip, colour=INK, both=False, width=1.3):
    axes.annotate("", tip, tail, arrowprops={"arrowstyle": "<|-|>" if both else "-|>", "color": colour, "linewidth": width, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 12})


def text(axes, at, says, colour=INK, **kwargs):
    axes.text(*at, says, color=colour, **{"ha": "center", "va": "center", **kwargs})


def meridian(bulge, toml, contraction):
    """x and r of a muscle at 2 bar, in mm, and the answer."""
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write(toml)
        file.flush()
        done = subprocess.run([bulge, "shape", file.name, "--pressure", "2 bar", "--contraction", contraction, "--json"], capture_output=True, text=True, check=True)
    answer = json.loads(done.stdout)
    return 1e3 * np.array([p["x_m"] for p in answer["meridian"]]), 1e3 * np.array([p["r_m"] for p in answer["meridian"]]), answer


PLEATED = 'name = "pleated"\nkind = "pleated"\nlength = "110 mm"\nradius = "16 mm"\nfibres = 40\n'
BRAID = 'name = "braid"\nkind = "braided"\nlength = "90 mm"\nradius = "10 mm"\nbraid_angle = "25 deg"\nends = "{ends}"\n'


def fitting(axes, x, radius, side, width=7):
    axes.add_patch(Rectangle((x - width if side < 0 else x, -radius), width, 2 * radius, facecolor=STEEL, edgecolor="none"))


def draw_meridian(bulge):
    x, r, answer = meridian(bulge, PLEATED, "20 %")
    length, middle = x[-1], 0.5 * x[-1]
    figure, axes = canvas(7.4, 4.7, (-34, length + 44), (-63, 62))
    axes.fill_between(x, -r, r, color=PALE, linewidth=0)
    axes.plot(x, r, color=BLUE, linewidth=2.2)
    axes.plot(x, -r, color=BLUE, linewidth=1)
    fitting(axes, 0, 16, -1)
    fitting(axes, length, 16, 1)
    axes.plot([-30, length + 30], [0, 0], color=GREY, linewidth=0.8, linestyle=(0, (8, 3, 2, 3)))
    arrow(axes, (-7, 0), (-27, 0), RED, width=2)
    arrow(axes, (length + 7, 0), (length + 27, 0), RED, width=2)
    text(axes, (-27, 5), "F", RED, ha="left")
    text(axes, (length + 27, 5), "F", RED, ha="right")
    # A point of the meridian.
    at = int(np.searchsorted(x, 0.16 * length))
    slope = np.arctan2(r[at + 1] - r[at - 1], x[at + 1] - x[at - 1])
    axes.plot([x[at], x[at] + 24], [r[at], r[at]], color=GREY, linewidth=0.8)
    axes.plot([x[at] - 4 * np.cos(slope), x[at] + 25 * np.cos(slope)], [r[at] - 4 * np.sin(slope), r[at] + 25 * np.sin(slope)], color=GREY, linewidth=0.8)
    axes.add_patch(Arc((x[at], r[at]), 30, 30, theta1=0, theta2=np.degrees(slope), color=INK, linewidth=1.1))
    text(axes, (x[at] + 19, r[at] + 5.5), "ψ")
    axes.plot(x[at], r[at], "o", color=INK, markersize=4)
    arrow(axes, (x[at], 0), (x[at], r[at]), both=True)
    text(axes, (x[at] - 4, 0.55 * r[at]), "r")
    arrow(axes, (0, -5), (x[at], -5), both=True)
    text(axes, (0.5 * x[at], -9), "x")
    arrow(axes, (middle, 0), (middle, r.max()), both=True)
    text(axes, (middle + 3, 16), "r at mid-length", ha="left")
    arrow(axes, (length + 11, 0), (length + 11, 16), both=True)
    text(axes, (length + 15, 9), "R")
    for place in (0, length):
        axes.plot([place, place], [-18, -57], color=GREY, linewidth=0.6)
    arrow(axes, (0, -54), (length, -54), both=True)
    text(axes, (middle, -59), "l = l₀ (1 − ε)")
    text(axes, (length - 2, 49), "fibre: its length S,\nl₀ in all, is kept", BLUE, ha="left", fontsize=10)
    axes.plot([length - 3, x[np.searchsorted(x, 0.78 * length)]], [46, r[np.searchsorted(x, 0.78 * length)] + 1], color=BLUE, linewidth=0.7)
    text(axes, (middle + 12, -20), "gas at p")
    saved(figure, "meridian.svg")


def draw_braid():
    figure, axes = canvas(7.4, 3.4, (0, 148), (-4, 64))
    # Left: a cell of the braid, unrolled; the meridian runs to the right.
    centre, theta, side = np.array([34.0, 32.0]), np.radians(33), 27
    along = side * np.array([np.cos(theta), np.sin(theta)])
    across = side * np.array([np.cos(theta), -np.sin(theta)])
    for direction, other in ((along, across), (across, along)):
        for shift in (-0.5, 0.5):
            start, end = centre + shift * other - 0.78 * direction, centre + shift * other + 0.78 * direction
            axes.plot(*zip(start, end), color=BLUE, linewidth=3, solid_capstyle="round")
    axes.plot([2, 68], [centre[1]] * 2, color=GREY, linewidth=0.8, linestyle=(0, (8, 3, 2, 3)))
    corner = centre - 0.5 * (along + across)
    axes.add_patch(Arc(corner, 28, 28, theta1=0, theta2=np.degrees(theta), color=INK, linewidth=1.1))
    text(axes, corner + [17.5, 4.6], "θ")
    tip = centre + 0.5 * (along + across)
    arrow(axes, tip + 0.27 * along, tip + 0.62 * along, RED, width=2)
    text(axes, tip + 0.62 * along + [0, 3.2], "T", RED)
    arrow(axes, tip + 0.27 * across, tip + 0.62 * across, RED, width=2)
    text(axes, tip + 0.62 * across - [0, 3.2], "T", RED)
    text(axes, (34, 61), "one cell of the braid, unrolled", fontsize=10)
    text(axes, (34, 29), "meridian", GREY, fontsize=9)
    text(axes, (34, 2), "sin θ = q r/(1 + e)", fontsize=10)
    # Right: an element of the wall.
    box = np.array([[96, 20], [122, 20], [122, 46], [96, 46]], dtype=float)
    axes.add_patch(Polygon(box, closed=True, facecolor=PALE, edgecolor=BLUE, linewidth=1.5))
    for shift in (9, 13, 17):
        arrow(axes, (96, 20 + shift), (85, 20 + shift), RED)
        arrow(axes, (122, 20 + shift), (133, 20 + shift), RED)
        arrow(axes, (96 + shift, 20), (96 + shift, 10), RED)
        arrow(axes, (96 + shift, 46), (96 + shift, 56), RED)
    text(axes, (141, 33), "N/(2 π r)", RED, fontsize=10)
    text(axes, (120, 57), "hoop force\nh/(2 π)", RED, fontsize=10, ha="left", va="top")
    text(axes, (109, 33), "p, from\nbehind", fontsize=10)
    text(axes, (109, 61), "an element of the wall: forces per length", fontsize=10)
    text(axes, (109, 2), "without rubber: N = n T cos θ", fontsize=10)
    saved(figure, "braid.svg")


def draw_ends(bulge):
    figure, axes = canvas(7.4, 5.4, (-22, 116), (-27, 77))
    for ends, height, says in (("clamped", 52, 'ends = "clamped": the fittings hold the braid at its radius r₀'), ("cylinder", 0, 'ends = "cylinder": one radius everywhere, as in the textbook')):
        x, r, answer = meridian(bulge, BRAID.format(ends=ends), "20 %")
        length = 72.0
        axes.fill_between(x, height - r, height + r, color=PALE, linewidth=0)
        for sign in (1, -1):
            axes.plot(x, height + sign * r, color=BLUE, linewidth=2.2)
        axes.plot([-12, length + 12], [height, height], color=GREY, linewidth=0.8, linestyle=(0, (8, 3, 2, 3)))
        for place, side in ((0, -1), (length, 1)):
            radius = 10 if ends == "clamped" else r.max()
            axes.add_patch(Rectangle((place - 6 if side < 0 else place, height - radius), 6, 2 * radius, facecolor=STEEL if ends == "clamped" else "none", edgecolor=STEEL, linestyle="-" if ends == "clamped" else "--"))
        arrow(axes, (0.5 * length, height), (0.5 * length, height + r.max()), both=True)
        text(axes, (0.5 * length + 2, height + 8), f"{r.max():.1f} mm", ha="left", fontsize=10)
        text(axes, (0.5 * length, height + 22.5), says, fontsize=10)
        arrow(axes, (length + 6, height), (length + 20, height), RED, width=2)
        text(axes, (length + 22, height), f"{answer['force_n']:.0f} N", RED, ha="left")
    arrow(axes, (-10, 52), (-10, 62), both=True)
    text(axes, (-15, 57), "r₀")
    text(axes, (36, -24), "l₀ = 90 mm, r₀ = 10 mm, α₀ = 25°, 2 bar, contracted by 20 %", GREY, fontsize=10)
    saved(figure, "ends.svg")


def draw_free_body(bulge):
    x, r, _ = meridian(bulge, PLEATED, "20 %")
    length, cut = x[-1], 0.42 * x[-1]
    keep = x >= cut
    x, r = x[keep], r[keep]
    slope = np.arctan2(r[1] - r[0], x[1] - x[0])
    figure, axes = canvas(7.4, 4.2, (0, 160), (-53, 53))
    shift = 12
    x = x - cut + shift + 20
    end = x[-1]
    axes.fill_between(x, -r, r, color=PALE, linewidth=0)
    for sign in (1, -1):
        axes.plot(x, sign * r, color=BLUE, linewidth=2.2)
        arrow(axes, (x[0], sign * r[0]), (x[0] - 20 * np.cos(slope), sign * (r[0] - 20 * np.sin(slope))), RED, width=2)
    axes.plot([x[0]] * 2, [-r[0], r[0]], color=GREY, linewidth=0.9, linestyle="--")
    for height in np.linspace(-32, 32, 6):
        arrow(axes, (x[0] + 1, height), (x[0] + 12, height), INK)
    fitting(axes, end, 16, 1, 8)
    axes.plot([6, end + 8], [0, 0], color=GREY, linewidth=0.8, linestyle=(0, (8, 3, 2, 3)))
    arrow(axes, (end + 8, 0), (end + 30, 0), RED, width=2)
    text(axes, (end + 32, 0), "F", RED, ha="left")
    text(axes, (x[0] + 15, 13), "p A", ha="left")
    text(axes, (x[0] - 17, r[0] + 6), "N", RED)
    text(axes, (end + 8, 44), "along the axis:  N cos ψ = F + p A", ha="left", fontsize=10)
    text(axes, (end + 8, 35), "over a small stroke:  p dV = −F dl", ha="left", fontsize=10)
    text(axes, (end + 8, -38), "l grows to the right;\nthe gas does the work p dV,\nthe rod is pulled in by −dl", GREY, ha="left", fontsize=10)
    saved(figure, "free-body.svg")


def draw_ladder():
    figure = Figure(figsize=(7.4, 3.2), facecolor="white")
    axes = figure.add_axes((0.25, 0.2, 0.72, 0.72))
    names = ["equilibrium", "+ bladder-elasticity", "+ coulomb-friction"]
    errors = [56.2, 14.2, 2.08]
    held = [70.7, 14.3, 2.14]
    for at, (name, error, out) in enumerate(zip(names, errors, held)):
        y = len(names) - at
        axes.barh(y, error, height=0.5, color=BLUE if at else GREY)
        axes.plot([out] * 2, [y - 0.33, y + 0.33], color=RED, linewidth=2)
        axes.text(max(error, out) * 1.06, y, f"{error:g} N", va="center", color=INK, fontsize=10)
    axes.axvline(2.09, color=INK, linewidth=1, linestyle="--")
    axes.text(2.0, 0.36, "noise floor", ha="right", va="center", fontsize=10)
    axes.set(xscale="log", xlim=(0.8, 150), ylim=(0.2, 3.6), xlabel="error of the force: root mean square [N]")
    axes.set_yticks([3, 2, 1], names)
    axes.tick_params(axis="y", length=0)
    axes.text(95, 0.72, "bar: on the data fitted\nred: on data held out", ha="right", va="center", fontsize=9.5, color=GREY)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
    saved(figure, "ladder.svg")


def draw_decisions():
    figure, axes = canvas(7.4, 5.6, (0, 148), (0, 112))

    def box(x, y, width, height, title, says, colour=BLUE):
        axes.add_patch(FancyBboxPatch((x, y), width, height, boxstyle="round,pad=0,rounding_size=2", facecolor="#f5f8fc" if colour == BLUE else "#fdf3ec", edgecolor=colour, linewidth=1.3))
        text(axes, (x + 2.5, y + height - 4.2), title, colour, ha="left", fontweight="bold", fontsize=10.5)
        text(axes, (x + 2.5, y + 0.5 * height - 2.7), says, ha="left", fontsize=9)

    box(4, 93, 66, 17, "1  noise", "how much readings scatter,\nfound before any effect is looked at")
    box(4, 68, 66, 17, "2  screen", "every effect, in linear approximation,\nagainst what noise does by chance")
    box(4, 43, 66, 17, "3  confirm", "the best are fitted as they are;\nevidence decides; each may be taken back")
    box(4, 18, 66, 17, "4  adequate?", "is what remains chance or structure?\nif structure: to 2, with the effect added")
    for y in (93, 68, 43):
        arrow(axes, (37, y), (37, y - 8))
    axes.plot([4, 1, 1, 1], [26.5, 26.5, 76.5, 76.5], color=INK, linewidth=1.3)
    arrow(axes, (1, 76.5), (4, 76.5))
    arrow(axes, (70, 26.5), (84, 26.5))
    box(84, 93, 62, 17, "adequate", "the model, as it is, explains the data", RED)
    box(84, 68, 62, 17, "missing", "effects, each with its class\nand its confidence", RED)
    box(84, 43, 62, 17, "unknown", "there is structure, and the catalogue\nhas nothing that explains it", RED)
    box(84, 18, 62, 17, "cannot tell", "the data don't decide; the program\nsays which test would", RED)
    text(axes, (115, 11), "5  the verdict: one of these four", RED, fontsize=10)
    axes.plot([77, 77], [26.5, 101.5], color=INK, linewidth=1.3)
    for y in (51.5, 76.5, 101.5):
        arrow(axes, (77, y), (84, y))
    saved(figure, "decisions.svg")


def imports():
    """Who imports whom, by the manifests; `bulge`, which only re-exports, and what measures and checks the others are left out."""
    found = {}
    for manifest in sorted(ROOT.glob("crates/*/Cargo.toml")):
        name = manifest.parent.name
        if name != "bulge":
            used = tomllib.loads(manifest.read_text(encoding="utf-8")).get("dependencies", {})
            found[name] = {other.removeprefix("bulge-") for other in used if other.startswith("bulge-")} - {"validation"}
    return found


# From the left, so that few arrows cross; the height comes from the imports.
COLUMNS = {
    "muscles": 1.0, "numerics": 2.1, "table": 5.1, "measurements": 0.0, "fibre": 2.1, "membrane": 4.0, "effects": 1.5, "vtk": 3.1,
    "model": 1.5, "inference": 1.0, "design": 4.0, "report": 1.0, "sweep": 4.6, "workbench": 1.5, "python": 3.6, "cli": 2.6,
}  # fmt: skip


def draw_crates():
    """The crates, those below that know nothing of those above; arrows to what is used directly."""
    of = imports()
    level = {}

    def height_of(name):
        if name not in level:
            level[name] = 1 + max(map(height_of, of[name]), default=-1)
        return level[name]

    for name in of:
        height_of(name)
    top = max(level.values())
    figure, axes = canvas(8.4, 0.6 * (top + 1), (-1.3, 2.6 * 5.2 + 1.3), (-0.6, 1.5 * top + 0.6))
    places = {name: (2.6 * COLUMNS[name], 1.5 * height) for name, height in level.items()}
    direct = {name: {other for other in used if not any(other in of[between] for between in used)} for name, used in of.items()}
    for name, used in direct.items():
        x, y = places[name]
        for other in used:
            there = places[other]
            axes.annotate("", (there[0], there[1] + 0.38), (x, y - 0.3), arrowprops={"arrowstyle": "-|>", "color": GREY, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0}, zorder=1)
    for name, (x, y) in places.items():
        axes.add_patch(FancyBboxPatch((x - 1.12, y - 0.33), 2.24, 0.66, boxstyle="round,pad=0.03", facecolor=PALE, edgecolor=BLUE, linewidth=1, zorder=2))
        text(axes, (x, y), name, fontsize=10, zorder=3)
    saved(figure, "crates.svg")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bulge", default="target/release/bulge", help="the program")
    arguments = parser.parse_args()
    FOLDER.mkdir(exist_ok=True)
    draw_meridian(arguments.bulge)
    draw_braid()
    draw_ends(arguments.bulge)
    draw_free_body(arguments.bulge)
    draw_ladder()
    draw_decisions()
    draw_crates()
    print(", ".join(f"{path.name} {path.stat().st_size // 1000} kB" for path in sorted(FOLDER.glob("*.svg"))))


if __name__ == "__main__":
    main()
