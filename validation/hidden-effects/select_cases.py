"""Copies the small fixed selection of a suite that the Rust tests run on.

    python select_cases.py DIR OUT

The rule looks at truth.json alone, never at an answer. Of each kind the pleated and the braided cases take turns; each turn takes the first case by
name that meets the wish of its kind (`WISHES`) and hides no effect that a chosen case of its kind hides already. A family that has no more such cases
leaves its turns to the other.

OUT/<case> gets data.csv, muscle.toml and a truth.json with case, kind, family, expected and hidden: effect, d, acceptable and class. d is what the
score goes by: beside the other hidden effects, and for an effect outside the catalogue beyond the two effects that explain most of it. Under acceptable are
all names that count as right, the variants of an effect too, so that a reader needs no table of names.
"""

import argparse
import json
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

from simulator.answers import clarity, truths, variants

MOST_BYTES = 2_500_000
NEARLY = 0.95
"""Amplitudes meet the wanted d within 2 %."""


@dataclass(frozen=True)
class Wish:
    """How many cases of a kind, with which least d of every hidden effect; `alone`: nothing else may be in the true class.

    Few rows keep the tests short; of singles that are clear and alone, too few effects have fewer than 700.
    """

    count: int
    least_d: float = 0.0
    alone: bool = False
    most_rows: int = 700

    def fits(self, truth):
        """Whether a case is one of those wished for."""
        entries = truth["hidden"]
        clear = all(clarity(entry) >= NEARLY * self.least_d for entry in entries)
        return truth["rows"] <= self.most_rows and clear and (not self.alone or all(entry["class"] == [entry["effect"]] for entry in entries))


WISHES = {
    "null": Wish(6),
    "rig-within": Wish(2),
    "single": Wish(12, 8.0, alone=True, most_rows=900),
    "rig-beyond": Wish(2),
    "confusable": Wish(3),
    "pair": Wish(3, 6.0),
    "unknown": Wish(3, 11.0),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the cases")
    parser.add_argument("out", type=Path, metavar="OUT", help="folder of the selection; it must be new or empty")
    arguments = parser.parse_args()
    if arguments.out.exists() and any(arguments.out.iterdir()):
        parser.error(f"{arguments.out} is not empty; delete it first, so that no older case stays")
    chosen = select(truths(arguments.folder))
    size = sum(_copy(arguments.folder / truth["case"], arguments.out / truth["case"], truth) for truth in chosen)
    short = [f"{kind}: {found} of {wish.count}" for kind, wish in WISHES.items() if (found := _count(chosen, kind)) < wish.count]
    print(f"{len(chosen)} cases, {size / 1e6:.2f} MB in {arguments.out}")
    for complaint in short:
        print(f"too few cases of {complaint}", file=sys.stderr)
    if size > MOST_BYTES:
        print(f"larger than {MOST_BYTES / 1e6:g} MB", file=sys.stderr)
    return 1 if short or size > MOST_BYTES else 0


def select(known):
    """Truths of the chosen cases, kind by kind."""
    return [truth for kind, wish in WISHES.items() for truth in _of_kind(known, kind, wish)]


def _of_kind(known, kind, wish):
    fitting = [truth for _, truth in sorted(known.items()) if truth["kind"] == kind and wish.fits(truth)]
    waiting = {family: [truth for truth in fitting if truth["family"] == family] for family in ("pleated", "braided")}
    chosen, taken = [], set()
    while len(chosen) < wish.count and any(waiting.values()):
        for queue in waiting.values():
            new = next((truth for truth in queue if not taken & _hidden(truth)), None)
            queue[:] = queue[queue.index(new) + 1 :] if new else []
            if new and len(chosen) < wish.count:
                chosen.append(new)
                taken |= _hidden(new)
    return chosen


def _hidden(truth):
    return {entry["effect"] for entry in truth["hidden"]}


def _count(chosen, kind):
    return sum(truth["kind"] == kind for truth in chosen)


def _copy(case, target, truth):
    """Copies a case; its size in bytes."""
    target.mkdir(parents=True)
    for name in ("data.csv", "muscle.toml"):
        shutil.copyfile(case / name, target / name)
    entries = [
        {"effect": entry["effect"], "d": round(clarity(entry), 3), "acceptable": variants(entry["acceptable"]), "class": entry["class"]}
        for entry in truth["hidden"]
    ]
    reduced = {**{name: truth[name] for name in ("case", "kind", "family", "expected")}, "hidden": entries}
    (target / "truth.json").write_text(json.dumps(reduced, indent=1) + "\n", encoding="utf-8")
    return sum(file.stat().st_size for file in target.iterdir())


if __name__ == "__main__":
    sys.exit(main())
