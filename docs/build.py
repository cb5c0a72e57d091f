#!/usr/bin/env python3
"""Builds the book: the pages of this folder, those that the program writes, and what they link to elsewhere in the repository.

    python3 docs/build.py --bulge target/release/bulge --out target/book

Needs mkdocs and matplotlib. Nothing is fetched: the site below OUT/site reads without a network. A link that leads nowhere is an error.
"""

import argparse
import base64
import csv
import json
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "bulge"
matplotlib.rcParams["svg.fonttype"] = "none"
from matplotlib.figure import Figure  # noqa: E402

import figures  # noqa: E402
from matplotlib.font_manager import FontProperties  # noqa: E402
from matplotlib.mathtext import math_to_image  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
LINK = re.compile(r"\]\(([^)#\s]+)(#[^)\s]*)?\)")

# The muscles on which effects are shown, and the test: loops at two pressures, without noise.
MUSCLES = {"braided": "dmsp-20-250", "pleated": "ppam-2-r16"}
PROTOCOL = """
rig = "none"
pause = "10 s"
{extra}
[[block]]
pressures = ["2 bar", "4 bar"]
contraction = "{range}"
shape = "loops"
wave = "triangle"
cycles = {cycles}
period = "50 s"
rows = 80
specimens = {specimens}
"""
PRESSURES = """
pause = "10 s"
[[block]]
shape = "isometric"
contractions = ["3 %", "12 %"]
pressure = "1 bar..5 bar"
wave = "triangle"
cycles = 1
period = "50 s"
rows = 80
"""
RANGES = {"braided": "1 %..20 %", "pleated": "4 %..32 %"}


class Program:
    """The command `bulge`."""

    def __init__(self, path):
        self.path = Path(path).resolve()

    def says(self, *arguments):
        done = subprocess.run([self.path, *map(str, arguments)], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"bulge {' '.join(map(str, arguments))}: {done.stderr}")
        return done.stdout


def commands(program):
    """Every command with its help."""
    help_text = program.says("--help")
    listed = help_text.split("Commands:\n", 1)[1].split("\n\n", 1)[0]
    names = [line.split()[0] for line in listed.splitlines() if re.match(r"  \w", line)]
    text = "# Commands\n\nAs the program prints them (`bulge help COMMAND`).\n"
    for name in [name for name in names if name != "help"]:
        shown = program.says(name, "--help").replace(f"{program.path.name} ", "bulge ")
        text += f"\n## bulge {name}\n\n```text\n{shown.rstrip()}\n```\n"
    return text


def files(program):
    """Every file that the program reads, with every key."""
    text = "# Files, with every key\n\nAs the program prints them (`bulge keys FILE`): what they hold, and what each key means.\n"
    for file in json.loads(program.says("keys", "--json"))["files"]:
        example = json.loads(program.says("keys", file["file"], "--json"))["example"]
        language = "text" if file["file"] == "data" else "toml"
        text += f"\n## {file['file'].capitalize()}\n\n{file['about']}.\n\n```{language}\n{example.rstrip()}\n```\n"
    return text


def laws(program):
    return f"# Force laws of the papers\n\nAs `bulge effects --laws` prints them; S1 to S5 are papers ([sources](theory.md#sources)).\n\n```text\n{program.says('effects', '--laws').rstrip()}\n```\n"


def schemas():
    text = "# JSON documents\n\nWhat commands print with `--json` and write into files: one schema for each name that stands in `schema`.\n\n"
    text += "| schema | of |\n|---|---|\n"
    for path in sorted((ROOT / "docs/schemas").glob("*.json")):
        schema = json.loads(path.read_text())
        says = schema.get("description") or schema.get("title") or ""
        text += f"| [{path.stem}](schemas/{path.name}) | {says.splitlines()[0] if says else ''} |\n"
    return text


def shown(number):
    return f"{number:.4g}"


def value_of(parameter, muscle):
    """A number at which the effect shows: its usual one, or one standard deviation of its prior from where it does nothing."""
    value, off = parameter["typical"], parameter["off"]
    if value == off:
        prior = parameter["prior"]
        value = off + prior[1] if prior else 0.5 * (off + parameter["high"])
    if parameter["multiple_of"]:
        value *= muscle[parameter["multiple_of"]]
    return f"{shown(value)} {parameter['unit']}" if parameter["unit"] != "1" else shown(value)


def rows(folder):
    with open(folder / "data.csv", newline="", encoding="utf-8") as file:
        lines = [line for line in file if not line.startswith("#")]
    read = list(csv.DictReader(lines))
    return [{key: float(value) for key, value in row.items() if key is not None and re.match(r"^-?[\d.]", value)} for row in read]


def difference(program, effect, kind, protocol, temporary):
    """The change of the force by an effect, row by row of the same test, and the numbers that it had."""
    stated = tomllib.loads(program.says("muscle", MUSCLES[kind]))
    sizes = {"radius": float(stated["radius"].split()[0]), "fibres": stated.get("fibres", 1)}
    sizes["fitting_radius"] = sizes["radius"]
    numbers = [f"{effect['name']}.{p['key']}={value_of(p, sizes)}" for p in effect["parameters"]] or [effect["name"]]
    path = temporary / f"{effect['name']}.toml"
    path.write_text(protocol)
    found = []
    for name, hidden in [("with", ["--with", ",".join(numbers)]), ("without", [])]:
        folder = temporary / f"{effect['name']}-{name}"
        program.says("simulate", MUSCLES[kind], "--protocol", path, "--out", folder, "--seed", 1, *hidden)
        found.append(rows(folder))
    return found, numbers


def signature(program, effect, temporary):
    """A picture of what the effect does to the force, and the sentence below it."""
    kind = effect["kind"] or "braided"
    held = effect["needs"] == "pressure-path"
    cycles = 3 if effect["needs"] == "cycles" else 1
    specimens = 3 if effect["needs"] == "specimens" else 1
    extra = 'warming = "20 K"' if effect["needs"] == "temperature" else ""
    protocol = PRESSURES if held else PROTOCOL.format(extra=extra, range=RANGES[kind], cycles=cycles, specimens=specimens)
    (changed, base), numbers = difference(program, effect, kind, protocol, temporary)
    figure = Figure(figsize=(5.4, 2.6), layout="constrained")
    axes = figure.add_subplot()
    across = "pressure [bar]" if held else "contraction [%]"
    colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]
    sweeps = sorted({row.get("sweep", 1) for row in base})
    for sweep, colour in zip(sweeps, colours):
        one = {row["time [s]"]: row for row in base if row.get("sweep", 1) == sweep}
        other = [row for row in changed if row.get("sweep", 1) == sweep and row["time [s]"] in one]
        points = [(row[across], row["force [N]"] - one[row["time [s]"]]["force [N]"]) for row in other]
        if points:
            middle = next(iter(one.values()))
            label = f"at {middle['contraction [%]']:.0f} %" if held else f"at {round(middle['pressure [bar]'])} bar"
            axes.plot(*zip(*points), color=colour, linewidth=1.4, label=label)
    axes.axhline(0, color="#888888", linewidth=0.7)
    axes.set_xlabel(across)
    axes.set_ylabel("change of force [N]")
    axes.legend(frameon=False, fontsize=8)
    command = f"bulge simulate {MUSCLES[kind]} --with \"{','.join(numbers)}\""
    return figure, f"Force with the effect less that without, in {'filling and venting at held length' if held else 'loops'}: `{command}`."


def effects(program, pages):
    """The catalogue: each effect with its card and a picture of its signature."""
    listed = json.loads(program.says("effects", "--json"))["effects"]
    pictures = pages / "signatures"
    pictures.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        drawn = list(pool.map(lambda effect: signature(program, effect, Path(folder)), listed))
    text = "# Catalogue of effects\n\nEvery effect that a diagnosis looks for: what it does, its numbers with their bounds, what is confused with it and what tells\n"
    text += "them apart. Written from the cards of the program (`bulge effects NAME`). S1 to S5 are papers ([sources](theory.md#sources)).\n"
    group = None
    for effect, (figure, caption) in zip(listed, drawn):
        figure.savefig(pictures / f"{effect['name']}.svg", metadata={"Date": None})
        if effect["group"] != group:
            group = effect["group"]
            text += f"\n## {group.capitalize()}\n"
        text += f"\n### {effect['name']}\n\n**{effect['title']}.** {effect['about']}\n\n```text\n{effect['equation']}\n```\n\n"
        text += f"![Signature of {effect['name']}](signatures/{effect['name']}.svg)\n\n{caption}\n\n"
        if effect["parameters"]:
            text += "| number | unit | bounds | usually | is |\n|---|---|---|---|---|\n"
        for p in effect["parameters"]:
            of = f" times the {p['multiple_of'].replace('_', ' ')}" if p["multiple_of"] else ""
            text += f"| `{p['key']}` | {p['unit']} | {shown(p['low'])} to {shown(p['high'])}{of} | {shown(p['typical'])} | {p['about']} |\n"
        twins = "; ".join(f"[{twin['name']}](#{twin['name']}) ({twin['how']})" for twin in effect["twins"])
        facts = [("Looks like", twins), ("Told apart by", effect["separate"]), ("Muscles", effect["kind"] or "pleated and braided"),
                 ("Needs", effect["needs"]), ("Source", effect["source"])]
        text += "\n" + "".join(f"- {name}: {says}\n" for name, says in facts if says)
    return text


# What stands in formulas within lines of text, where no picture is drawn. Longer names come first.
SIGNS = {
    r"\varepsilon": "ε", r"\partial": "∂", r"\lambda": "λ", r"\alpha": "α", r"\kappa": "κ", r"\theta": "θ", r"\Delta": "Δ", r"\infty": "∞", r"\mathrm{d}": "d",
    r"\tfrac12": "½", r"\qquad": " ", r"\bigl": "", r"\bigr": "", r"\sim": "~", r"\int": "∫", r"\sin": "sin ", r"\tan": "tan ", r"\cos": "cos ", r"\pi": "π",
    r"\pm": "±", r"\to": "→", r"\,": " ", "<": "&lt;",
}  # fmt: skip


def inline(formula):
    """A formula within a line, in HTML."""
    text = formula
    for name, sign in SIGNS.items():
        text = text.replace(name, sign)
    if "\\" in text:
        raise SystemExit(f"SIGNS lacks something of ${formula}$")
    for mark, tag in (("_", "sub"), ("^", "sup")):
        text = re.sub(rf"\{mark}(?:{{([^}}]*)}}|(.))", lambda match: f"<{tag}>{match.group(1) or match.group(2)}</{tag}>", text)
    return f"<em>{text.replace(' <su', '<su')}</em>"


def formulas(text, name, folder):
    """A text with its formulas: drawn where they stand alone, in HTML within lines. Nothing that sets them in the browser is fetched."""

    def alone(match):
        drawn = f"{name}-{alone.count}.svg"
        alone.count += 1
        formula = " ".join(match.group(1).split())
        for has, takes in ((r"\tfrac", r"\frac"), (r"\Bigl(", "("), (r"\Bigr)", ")")):
            formula = formula.replace(has, takes)
        math_to_image(f"${formula}$", folder / drawn, prop=FontProperties(size=13), dpi=72, format="svg")
        return f"![{match.group(1).strip()}]({drawn})"

    alone.count = 0
    text = re.sub(r"\$\$(.+?)\$\$", alone, text, flags=re.DOTALL)
    return re.sub(r"\$([^$\n][^$]*)\$", lambda match: inline(match.group(1)), text)


def notebook(path, folder, link):
    """A notebook as a page: its text, its code, and the outputs that it holds. Pictures are written into the folder."""
    lines = []
    for at, cell in enumerate(json.loads(path.read_text(encoding="utf-8"))["cells"]):
        source = "".join(cell["source"]).rstrip()
        if cell["cell_type"] == "markdown":
            lines += [formulas(LINK.sub(link, source), f"{path.stem}-formula-{at}", folder), ""]
            continue
        lines += ["```python", source, "```", ""]
        for output in cell["outputs"]:
            data = output.get("data", {})
            if "image/png" in data:
                picture = f"{path.stem}-{at}.png"
                (folder / picture).write_bytes(base64.b64decode("".join(data["image/png"])))
                lines += [f"![Output of the cell]({picture})", ""]
            elif shown := "".join(output.get("text", data.get("text/plain", ""))).rstrip():
                lines += ["```text", shown, "```", ""]
    return "\n".join(lines)


def staged(pages):
    """Copies the pages, and whatever they link to outside of this folder, with the links moved along."""
    waiting, done = [], {}

    def place(path):
        """Where a file of the repository lies in the book."""
        docs = ROOT / "docs"
        inside = path.relative_to(docs) if path.is_relative_to(docs) else Path("repository") / path.relative_to(ROOT)
        return pages / inside

    def link(page, match):
        target, anchor = match.group(1), match.group(2) or ""
        if "://" in target or target.startswith("mailto:"):
            return match.group(0)
        path = (page.parent / target).resolve()
        if not path.exists():
            raise SystemExit(f"{page.relative_to(ROOT)}: the link to {target} leads nowhere")
        if path == ROOT / "docs/schemas":
            return "](json.md)"
        if path not in done:
            done[path] = place(path).with_suffix(".md") if path.suffix == ".ipynb" else place(path)
            waiting.append(path)
        there = Path(*([".."] * len(place(page).parent.relative_to(pages).parts))) / done[path].relative_to(pages)
        return f"]({there}{anchor})"

    for page in sorted((ROOT / "docs").glob("*.md")):
        done[page] = place(page)
        waiting.append(page)
    while waiting:
        path = waiting.pop()
        done[path].parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".ipynb":
            done[path].write_text(notebook(path, done[path].parent, lambda match: link(path, match)))
        elif path.suffix == ".md":
            done[path].write_text(LINK.sub(lambda match: link(path, match), path.read_text()))
        else:
            shutil.copyfile(path, done[path])


# Tables break their lines instead of running out of the page, which is as wide as what the program prints.
STYLE = ".wy-table-responsive table td, .wy-table-responsive table th { white-space: normal }\n.wy-nav-content { max-width: 1040px }\n"

# Notebooks, in the order in which they are read, with their titles.
NOTEBOOKS = [
    {"Notebook: shapes": "repository/crates/python/notebooks/shape-study.md"},
    {"Notebook: a hidden effect": "repository/crates/python/notebooks/hidden-effect.md"},
    {"Notebook: a drawn form": "repository/crates/python/notebooks/drawn-form.md"},
    {"Notebook: a table for a controller": "repository/crates/python/notebooks/controller-table.md"},
]

CONFIG = {
    "site_name": "Bulge",
    "site_description": "Shape, force and volume of pneumatic artificial muscles",
    "use_directory_urls": False,
    "theme": {"name": "readthedocs", "highlightjs": False, "include_homepage_in_sidebar": True},
    "extra_css": ["book.css"],
    "plugins": ["search"],
    "validation": {"links": {"anchors": "warn", "absolute_links": "warn", "not_found": "warn"}, "nav": {"omitted_files": "info"}},
    "nav": [
        {"Contents": "README.md"},
        {"Tutorials": [
            {"The shape of a muscle": "tutorial-shape.md"},
            {"A hidden effect": "tutorial-hidden-effect.md"},
            {"An isometric test": "tutorial-isometric.md"},
            {"Sizing a muscle and a joint": "tutorial-sizing.md"},
            {"A table for a controller": "tutorial-table.md"},
            {"A sweep on a cluster": "tutorial-cluster.md"},
            *NOTEBOOKS,
        ]},
        {"Using it": [
            {"The workbench": "workbench.md"},
            {"Muscles": "muscles.md"},
            {"Model against measurement": "compare.md"},
            {"What is missing": "diagnose.md"},
            {"A formula from the drawn form": "drawn-form.md"},
            {"What moves": "what-moves.md"},
            {"Design": "design.md"},
            {"Tables": "tables.md"},
            {"Sweeps on many machines": "sweeps.md"},
            {"Membranes": "membranes.md"},
            {"Python": "python.md"},
        ]},
        {"Data": [{"Files": "data-files.md"}, {"Sweeps and rows": "sweeps-and-rows.md"}, {"Specimens": "specimens.md"}]},
        {"Theory and method": [
            {"How Bulge decides": "method.md"},
            {"Theory": "theory.md"},
            {"Shape effects": "catalogue-shape-effects.md"},
            {"Noise": "noise.md"},
            {"Domain": "domain.md"},
        ]},
        {"Reference": [
            {"Commands": "commands.md"},
            {"Files, with every key": "files.md"},
            {"Catalogue of effects": "effects.md"},
            {"Force laws": "laws.md"},
            {"JSON documents": "json.md"},
        ]},
        {"How right, how fast": [{"Verification": "verification.md"}, {"Hardening": "hardening.md"}, {"Speed": "speed.md"}, {"Where each figure comes from": "figures.md"}]},
        {"Contributing": [{"How to contribute": "repository/CONTRIBUTING.md"}, {"Recipes": "contributing-recipes.md"}, {"Architecture": "architecture.md"}]},
    ],
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bulge", default="target/release/bulge", help="the program")
    parser.add_argument("--out", default="target/book", type=Path, help="folder of the book")
    arguments = parser.parse_args()
    program = Program(arguments.bulge)
    pages = arguments.out / "pages"
    shutil.rmtree(arguments.out, ignore_errors=True)
    pages.mkdir(parents=True)
    staged(pages)
    rows, missing = figures.collected()
    if missing:
        raise SystemExit("\n".join(missing))
    written = {
        "commands.md": commands(program),
        "files.md": files(program),
        "laws.md": laws(program),
        "json.md": schemas(),
        "effects.md": effects(program, pages),
        "figures.md": figures.page(rows),
    }
    for name, text in written.items():
        (pages / name).write_text(text)
    shutil.copytree(ROOT / "docs/schemas", pages / "schemas", dirs_exist_ok=True)
    (pages / "book.css").write_text(STYLE)
    config = arguments.out / "mkdocs.yml"
    # JSON is YAML.
    config.write_text(json.dumps({**CONFIG, "docs_dir": "pages", "site_dir": "site"}, indent=1))
    subprocess.run([sys.executable, "-m", "mkdocs", "build", "--quiet", "--strict", "--config-file", config], check=True)
    print(f"{len(list(pages.rglob('*.md')))} pages, {len(list((arguments.out / 'site').rglob('*.html')))} of them built below {arguments.out / 'site'}")


if __name__ == "__main__":
    main()
