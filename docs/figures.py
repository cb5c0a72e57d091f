#!/usr/bin/env python3
"""Where every figure of README and book comes from.

    python3 docs/figures.py [--check]

A table of figures stands between `<!-- table: NAME (COMMAND) -->` and `<!-- end of table -->` if a command writes it, or right below
`<!-- measured: DATE; MACHINE; COMMAND -->` (a `-` where the clock doesn't matter) or `<!-- source: WHERE -->` (published, or defined in the code). A picture is in the
list below. Prints the page `figures.md` of the book; with --check it prints nothing but what has no origin, and the status is 1 if there is such.
"""

import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGES = ["README.md", *sorted(str(path.relative_to(ROOT)) for path in (ROOT / "docs").glob("*.md"))]

PICTURES = {
    "crates/workbench/pictures/workbench.png": "python3 validation/workbench_check.py --bulge PATH --tour DIR --pictures DIR",
    "crates/workbench/pictures/workbench-narrow.png": "python3 validation/workbench_check.py --bulge PATH --tour DIR --pictures DIR",
    "crates/vtk/pictures/ppam.png": "python3 validation/vtk_check.py FILE.vtp --picture FILE.png",
    "crates/report/pictures/ladder.svg": "bulge demo (step 3: report/ladder.svg)",
    "crates/report/pictures/ppam-characteristics.svg": "bulge demo (ppam-characteristics.svg)",
    "crates/design/pictures/heat.svg": "bulge heat --plot heat.svg",
    "crates/design/pictures/size.svg": "bulge size --force \"500 N\" --stroke \"50 mm\" --plot size.svg",
    "crates/membrane/pictures/bulges.png": "python3 validation/membrane_check.py FILE.vtu --picture FILE.png",
    "crates/membrane/pictures/study.png": "python3 validation/membrane_study.py",
    "docs/what-moves.svg": "drawn by hand",
}
FOLDERS = {"docs/drawings/": "python3 docs/drawings.py --bulge PATH"}
"""Pictures below a folder that one command draws."""

CI = (ROOT / ".ci/run").read_text(encoding="utf-8")
MARKER = re.compile(r"<!-- (table|measured|source): (.*) -->$")
RULE = re.compile(r"^\|[-| :]+\|$")
FIGURE = re.compile(r"^[<>~+-]?\s*\d")
IMAGE = re.compile(r"!\[[^\]]*\]\(([^)\s]+)\)")
SHARE = 1 / 3
"""Part of the cells beside the first column that are figures in a table of figures."""


def tables(text):
    """Line, heading, body and the marker above of each table."""
    lines, marker, inside = text.splitlines(), None, None
    k = 0
    while k < len(lines):
        found = MARKER.match(lines[k].strip())
        if found:
            marker = found.groups()
            inside = marker if marker[0] == "table" else None
        elif lines[k].strip() == "<!-- end of table -->":
            inside = None
        elif RULE.match(lines[k]) and k > 0:
            start = k
            while k + 1 < len(lines) and lines[k + 1].startswith("|"):
                k += 1
            yield start, lines[start - 1], lines[start + 1 : k + 1], inside or marker
            marker = None
        elif lines[k].strip() and not lines[k].startswith("|"):
            marker = None
        k += 1


def is_of_figures(body):
    cells = [cell.strip(" `*") for row in body for cell in row.strip("|").split("|")[1:]]
    filled = [cell for cell in cells if cell]
    return bool(filled) and sum(bool(FIGURE.match(cell)) for cell in filled) >= SHARE * len(filled)


def pictures(page, text):
    """Pictures of a page, from the root."""
    for target in IMAGE.findall(text):
        path = ((ROOT / page).parent / target).resolve()
        yield str(path.relative_to(ROOT))


def quoted(command):
    """As code, unless it has some in it."""
    return command if "`" in command else f"`{command}`"


def is_compared(command):
    """Whether CI makes a table again."""
    asked = re.search(r"docs_table\.py (\w+)", command)
    return bool(asked) and re.search(rf"docs_table\.py {asked[1]} --check", CI) is not None


def command_of(picture):
    folder = next((command for folder, command in FOLDERS.items() if picture.startswith(folder)), None)
    return PICTURES.get(picture) or folder


def collected():
    """Rows of the page, and what has no origin."""
    rows, missing = [], []
    for page in PAGES:
        text = (ROOT / page).read_text(encoding="utf-8")
        for line, heading, body, marker in tables(text):
            if marker is None:
                if is_of_figures(body):
                    missing.append(f"{page}:{line}: the table {heading.strip()} says nothing of where its figures come from")
                continue
            what, origin = marker
            title = heading.strip("| ").split("|")[0].strip() or heading.strip("| ").replace("|", ",").strip()
            if what == "table":
                name, _, command = origin.partition(" (")
                rows.append((page, f"table {name}", quoted(command.rstrip(")")), "written by the command" + ", compared in CI" * is_compared(command)))
            elif what == "measured":
                parts = [part.strip() for part in origin.split(";", 2)]
                if len(parts) != 3:
                    missing.append(f"{page}:{line}: `measured: {origin}` has not three parts: date; machine; command")
                    continue
                date, machine, command = parts
                how = "measured" + (f" {date}" if date != "-" else "") + (f", {machine}" if machine != "-" else "")
                rows.append((page, f"table {title}", quoted(command), how))
            else:
                rows.append((page, f"table {title}", origin, "published or defined"))
        for picture in pictures(page, text):
            command = command_of(picture)
            if command is None:
                missing.append(f"{page}: no command is known for the picture {picture}")
            else:
                rows.append((page, f"picture {Path(picture).name}", quoted(command), "drawn"))
    unused = [picture for picture in PICTURES if not (ROOT / picture).exists()]
    return rows, missing + [f"there is no picture {picture}" for picture in unused]


def page(rows):
    """The page of the book."""
    text = "# Where each figure comes from\n\nWritten from the marks in README and book. Outputs in tutorials and the snippets in Python are made again by every run of CI, and so\n"
    text += "are the tables of which that is said; what depends on the clock carries its date, machine and command.\n\n"
    text += "| page | figure | command or source | how |\n|---|---|---|---|\n"
    for where, what, command, how in rows:
        link = f"[{where}]({'repository/README.md' if where == 'README.md' else Path(where).name})"
        cells = [link, what, command, how]
        text += "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    rows, missing = collected()
    for line in missing:
        print(line, file=sys.stderr)
    if not arguments.check:
        print(page(rows), end="")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
