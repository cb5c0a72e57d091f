#!/usr/bin/env python3
"""Runs the snippets of the book, and checks the outputs that the pages show.

    python3 docs/snippets.py --bulge target/release/bulge [--python INTERPRETER] [--write] [PAGE ...]

Without pages: docs/tutorial-*.md, the blocks of all other pages of docs/ that are marked, and, with an interpreter that has the package bulge, those of
docs/python.md and README.md in Python. The blocks of a page run in order in one temporary folder, with the program on the path as `bulge` and the root of
the repository in REPOSITORY. Status 1, with page and line, if one fails; at the end the number of blocks that were run.

What is done with a block

- `sh` runs in bash; a command that fails ends the block, and the check fails.
- `python` runs with the interpreter of --python, all blocks of a page one after the other in one process each, with the names of the blocks before them. Without
  --python it is skipped, and counted as such. So is an `sh` block below `<!-- needs: python -->`, which finds that interpreter as `python`.
- A block of any other language whose first line is the comment `# file: NAME` (in C `/* file: NAME */`), which readers see, or that stands below
  `<!-- file: NAME -->`, is written into the folder as that file.
- `text` right below a block that ran (nothing but blank lines between) is what that printed: standard output and errors together.
- Blocks below `<!-- not run: REASON -->` are left alone.
- `<!-- before: COMMAND -->` is a command that the page doesn't show. It stands alone on its line.

Which blocks run: all of a tutorial. Of the reference pages, whose blocks are mostly fragments, those below `<!-- run -->` or `<!-- file: NAME -->`; and in docs/python.md and README.md
all that are Python.

What is compared

Lines in order. A line `...` stands for any number of lines, none included; so does the place above the first line and below the last, if `...` stands there.
Spaces are compared as one. Words must agree. Numbers agree within one part in a hundred, or within one unit of the last place that is shown, and all numbers
below 1e-9 are alike: last digits differ between machines. Lines about times (`took`, `elapsed`, `in` or `per` with a number of
ns, us, ms or s; `points per second`) need agree in their words only.

--write puts what was printed in place of what is shown: line by line where the words agree, else the whole output, to be shortened by hand.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
TIMING = re.compile(r"\b(took|elapsed|in|per)\b.*\d ?(ns|us|ms|s)\b|points/s|points per second")
FENCE = re.compile(r"^(\s*)```(\w*)\s*$")
MARK = re.compile(r"^\s*<!--\s*(run|not run|file|needs|before)(?::\s*(.*?))?\s*-->\s*$")
TIMEOUT = 300

# What the first blocks of a page find in their folder.
PREPARED = {
    "README.md": {
        "bulge-demo/hidden/data.csv": "crates/cli/data/hidden/data.csv",
        "bulge-demo/hidden/muscle.toml": "crates/cli/data/hidden/muscle.toml",
    },
    "docs/python.md": {
        "data.csv": "crates/cli/data/hidden/data.csv",
        "new.csv": "crates/cli/data/hidden/data.csv",
        "my.toml": "crates/cli/data/hidden/muscle.toml",
        "case.toml": "meshes/tube.toml",
    },
}

# Blocks that aren't run, by how they begin, where the page has no mark: their data or their muscle are others than those of the blocks before them.
FRAGMENTS = {"docs/python.md": ("bulge.compare(data, muscle, [", "fitted = bulge.fit(data, muscle,")}


@dataclass
class Block:
    """A fenced block: where it begins and ends (lines of the fences, from 0), and the marks above it."""

    language: str
    first: int
    last: int
    lines: list
    marks: dict = field(default_factory=dict)
    # The first line that isn't blank above it belongs to the block before.
    follows: bool = False


def blocks_of(text):
    found, marks, current, indent, follows = [], {}, None, "", False
    for at, line in enumerate(text.splitlines()):
        fence = FENCE.match(line)
        if current is None:
            mark = MARK.match(line)
            if fence:
                indent = fence.group(1)
                current = Block(fence.group(2), at, at, [], marks, follows)
                marks = {}
            elif mark and mark.group(1) == "before":
                found.append(Block("before", at, at, [mark.group(2)]))
                follows = False
            elif mark:
                marks[mark.group(1)] = mark.group(2) or ""
            elif line.strip():
                marks, follows = {}, False
        elif fence and not fence.group(2):
            current.last = at
            found.append(current)
            current, follows = None, True
        else:
            current.lines.append(line.removeprefix(indent))
    return found


def words(line):
    """A line with its numbers taken out, spaces as one."""
    return re.sub(r"[\s─-╿⠀-⣿]+", " ", NUMBER.sub("#", line)).strip()


def last_place(number):
    """One unit of the last digit that is written."""
    mantissa, _, exponent = number.lower().partition("e")
    decimals = len(mantissa.partition(".")[2]) if "." in mantissa else 0
    return 10.0 ** (int(exponent or 0) - decimals)


def agree(shown, printed):
    if words(shown) != words(printed):
        return False
    if TIMING.search(shown):
        return True
    for a, b in zip(NUMBER.findall(shown), NUMBER.findall(printed)):
        x, y = float(a), float(b)
        if max(abs(x), abs(y)) > 1e-9 and abs(x - y) > 1.001 * max(0.01 * max(abs(x), abs(y)), last_place(a)):
            return False
    return True


def trimmed(lines):
    lines = [line.rstrip() for line in lines]
    while lines and not lines[-1]:
        lines.pop()
    while lines and not lines[0]:
        lines.pop(0)
    return lines


def segments(shown):
    """Runs of lines between `...`."""
    runs = [[]]
    for line in shown:
        if line.strip() == "...":
            runs.append([])
        else:
            runs[-1].append(line)
    return runs


def place(shown, printed, same):
    """Where the runs of the shown lines lie in the printed ones: the first line of each; or the first run that lies nowhere."""
    at, places = 0, []
    runs = segments(shown)
    if printed and not any(trimmed(run) for run in runs):
        return None, ["(nothing is shown)"]
    for i, run in enumerate(runs):
        run = trimmed(run)
        last = i == len(runs) - 1
        starts = range(at, len(printed) - len(run) + 1)
        if i == 0:
            starts = starts[:1]
        if last and run:
            # The last run ends the output; without `...` at all it is the output.
            starts = [s for s in starts if s == len(printed) - len(run)]
        start = next((s for s in starts if all(same(a, b) for a, b in zip(run, printed[s:]))), None)
        if start is None:
            return None, run
        places.append(start)
        at = start + len(run)
    return places, None


def rewritten(shown, printed):
    """What is shown with the numbers that were printed; the whole output where the words differ."""
    places, _ = place(shown, printed, lambda a, b: words(a) == words(b))
    if places is None:
        return printed
    lines = []
    for i, (run, start) in enumerate(zip(segments(shown), places)):
        lines += (["..."] if i else []) + printed[start : start + len(trimmed(run))]
    return lines


class Failed(Exception):
    pass


class Page:
    def __init__(self, path, arguments, programs):
        self.path, self.arguments, self.programs = path, arguments, programs
        self.name = str(path.relative_to(ROOT)) if path.is_relative_to(ROOT) else str(path)
        self.text = path.read_text(encoding="utf-8")
        self.ran, self.compared, self.skipped = 0, 0, 0
        self.python = ""

    def wanted(self, block):
        if "not run" in block.marks or (block.lines and block.lines[0].startswith(FRAGMENTS.get(self.name, ()) or "\0")):
            return False
        if self.path.name.startswith("tutorial-") or "run" in block.marks or "file" in block.marks:
            return True
        return block.language == "python" and self.name in ("docs/python.md", "README.md")

    def environment(self):
        path = [str(self.programs), os.environ["PATH"]]
        return {**os.environ, "PATH": os.pathsep.join(path), "REPOSITORY": str(ROOT), "COLUMNS": "120", "MPLBACKEND": "Agg", "LC_ALL": "C.UTF-8", "NO_COLOR": "1"}

    def call(self, command, folder, line):
        try:
            done = subprocess.run(command, cwd=folder, env=self.environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=TIMEOUT)
        except subprocess.TimeoutExpired:
            raise Failed(f"{self.name}:{line}: takes longer than {TIMEOUT} s") from None
        printed = done.stdout.decode("utf-8", "replace")
        if done.returncode != 0:
            raise Failed(f"{self.name}:{line}: status {done.returncode}\n{printed}")
        return printed

    def run(self, block, folder):
        """What a block prints; None if it isn't one that runs."""
        line = block.first + 1
        code = "\n".join(block.lines) + "\n"
        if block.language in ("sh", "before"):
            if "needs" in block.marks and not self.arguments.python:
                self.skipped += 1
                return None
            return self.call(["bash", "-eu", "-o", "pipefail", "-c", code], folder, line)
        if block.language == "python" and "file" not in block.marks:
            if not self.arguments.python:
                self.skipped += 1
                return None
            # The blocks before run again, silently: their names are there, and nothing is pickled.
            script = folder / ".snippet.py"
            quiet = "import contextlib as _c, io as _i\nwith _c.redirect_stdout(_i.StringIO()):\n    exec(compile(_before, 'before', 'exec'), globals())\n" if self.python else ""
            script.write_text(f"_before = {self.python!r}\n{quiet}exec(compile({code!r}, {f'{self.name}:{line}'!r}, 'exec'), globals())\n", encoding="utf-8")
            printed = self.call([self.arguments.python, str(script)], folder, line)
            self.python += code
            return printed
        return None

    def write(self, block, folder):
        name, lines = block.marks.get("file"), block.lines
        if name is None and lines and (match := re.match(r"(?:#|//|/\*)\s*file:\s*(\S+)\s*(?:\*/)?\s*$", lines[0])):
            name = match.group(1)
        if name:
            file = folder / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("\n".join(lines) + "\n", encoding="utf-8")
            self.ran += 1

    def check(self):
        """Runs the page; returns what failed, and its text as it should be."""
        lines = self.text.splitlines()
        changes, failed = [], []
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            for name, source in PREPARED.get(self.name, {}).items():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                (folder / name).write_bytes((ROOT / source).read_bytes())
            printed = None
            for block in blocks_of(self.text):
                if block.language == "text" and block.follows and printed is not None and "not run" not in block.marks:
                    got, shown = trimmed(printed.splitlines()), trimmed(block.lines)
                    places, run = place(shown, got, agree)
                    self.compared += 1
                    if places is None and self.arguments.write:
                        indent = FENCE.match(lines[block.first]).group(1)
                        changes.append((block, [indent + line if line else "" for line in rewritten(shown, got)]))
                    elif places is None:
                        missing = "\n".join(f"    {line}" for line in run[:12])
                        failed.append(f"{self.name}:{block.first + 1}: what is shown isn't what was printed. Not found:\n{missing}\n  printed:\n" + "\n".join(f"    {line}" for line in got))
                    printed = None
                    continue
                printed = None
                if block.language != "before" and not self.wanted(block):
                    continue
                if block.language not in ("sh", "python", "before", "text") or "file" in block.marks:
                    self.write(block, folder)
                    continue
                try:
                    printed = self.run(block, folder)
                except Failed as error:
                    failed.append(str(error))
                    break
                if printed is not None and block.language != "before":
                    self.ran += 1
        for block, new in reversed(changes):
            lines[block.first + 1 : block.last] = new
        return failed, "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bulge", default="target/release/bulge", type=Path, help="the program")
    parser.add_argument("--python", help="an interpreter that has the package bulge")
    parser.add_argument("--write", action="store_true", help="put what was printed in place of what is shown")
    parser.add_argument("pages", nargs="*", type=Path, metavar="PAGE")
    arguments = parser.parse_args()
    if arguments.python:
        arguments.python = os.path.abspath(arguments.python)
    paths = [path.resolve() for path in arguments.pages]
    if not paths:
        # The long ones first.
        paths = sorted((ROOT / "docs").glob("*.md"), key=lambda path: (not path.name.startswith("tutorial-"), -path.stat().st_size))
        paths.append(ROOT / "README.md")
    with tempfile.TemporaryDirectory() as temporary:
        programs = Path(temporary)
        (programs / "bulge").symlink_to(arguments.bulge.resolve(strict=True))
        if arguments.python:
            (programs / "python").write_text(f'#!/bin/sh\nexec "{arguments.python}" "$@"\n')
            (programs / "python").chmod(0o755)
        pages = [Page(path, arguments, programs) for path in paths]
        with ThreadPoolExecutor(2) as pool:
            results = list(pool.map(Page.check, pages))
    has_failed = False
    for page, (failed, text) in zip(pages, results):
        if arguments.write and text != page.text:
            page.path.write_text(text, encoding="utf-8")
            print(f"{page.name}: written")
        for failure in failed:
            print(failure, file=sys.stderr)
            has_failed = True
    ran, compared, skipped = (sum(getattr(page, name) for page in pages) for name in ("ran", "compared", "skipped"))
    of = sum(1 for page in pages if page.ran)
    print(f"{ran} blocks of {of} pages run or written, {compared} outputs compared, {skipped} skipped for want of --python")
    return 1 if has_failed else 0


if __name__ == "__main__":
    sys.exit(main())
