"""Mutation tests: what share of small faults in a crate its own tests catch.

    python validation/mutation.py numerics [--sample 200] [--anew]       # samples 50 at a time until there are 200
    python validation/mutation.py numerics --again                       # those that survived before, after tests were written
    python validation/docs_table.py mutation [--check]                   # the table in docs/hardening.md

A mutant is the crate with one operator exchanged, one result replaced or one match arm removed (cargo-mutants 27, from crates.io: `cargo install cargo-mutants`).
Of all mutants a seeded sample is built, and the crate's own tests run on each: its unit tests first, on those that survive them all of its tests.
cargo-nextest, where it is installed, ends a run with the first test that fails. It works in a clone of HEAD below target/mutation, hours for a large crate, and keeps
what it found in validation/mutation.json after every 50: counts, and the names of the mutants that survive. A run that was stopped goes on from there.
"""

import argparse
import json
import os
import random
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
KEPT = ROOT / "validation/mutation.json"
OUTCOMES = ("caught", "timeout", "missed", "unviable")

BATCH = 50

UNIT_S, ALL_S = 300, 1200
"""Seconds that the unit tests and all tests of a mutant may take: a loop without an end counts as caught."""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("crate", help="without `bulge-`")
    parser.add_argument("--sample", type=int, default=200, help="how many mutants")
    parser.add_argument("--anew", action="store_true", help="forget the sample that there is")
    parser.add_argument("--together", action="store_true", help="all tests at once, for a crate with few unit tests")
    parser.add_argument("--again", action="store_true", help="run only those that survived before")
    arguments = parser.parse_args()
    if shutil.which("cargo-mutants") is None:
        parser.error("cargo-mutants isn't installed: cargo install cargo-mutants --locked")
    if not (ROOT / "crates" / arguments.crate).is_dir():
        parser.error(f"there is no crate `{arguments.crate}` below crates/")
    tree = _clone(ROOT / "target/mutation" / arguments.crate)
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    before = kept.get(arguments.crate)
    if arguments.again and before is None:
        parser.error(f"`{arguments.crate}` has not been sampled yet: leave out --again")
    mutants = _listed(tree, arguments.crate)
    empty = {"mutants": len(mutants), "sample": 0, "unviable": 0, "survived": []}
    if arguments.again:
        # Lines move; what is done to which function stays.
        moved = {_without_place(name) for name in before["survived"] if name not in mutants}
        chosen = [name for name in mutants if name in before["survived"] or _without_place(name) in moved]
        found = _run(tree, arguments.crate, chosen, arguments.together)
        counts = {**before, "survived": sorted(found["missed"])}
        _keep(arguments.crate, counts)
    else:
        counts = empty if arguments.anew or before is None else before
        while counts["sample"] < min(arguments.sample, len(mutants)):
            batch = random.Random(f"{arguments.crate} from {counts['sample']}").sample(mutants, min(BATCH, len(mutants)))
            found = _run(tree, arguments.crate, batch, arguments.together)
            counts = {
                "mutants": len(mutants),
                "sample": counts["sample"] + len(batch),
                "unviable": counts["unviable"] + len(found["unviable"]),
                "survived": sorted({*counts["survived"], *found["missed"]}),
            }
            _keep(arguments.crate, counts)
    print("\n".join([f"{len(counts['survived'])} of {counts['sample'] - counts['unviable']} that can be built survive:", *counts["survived"]]))
    return 0


def _keep(crate, counts):
    # Another crate may have been added since.
    kept = {**(json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}), crate: counts}
    KEPT.write_text(json.dumps(dict(sorted(kept.items())), indent=1) + "\n", encoding="utf-8")


def _clone(tree):
    """A clone with what HEAD has; what it has built stays."""
    if not tree.exists():
        subprocess.run(["git", "clone", "--quiet", "--shared", ROOT, tree], check=True)
    subprocess.run(["git", "-C", tree, "fetch", "--quiet", "origin", "HEAD"], check=True)
    subprocess.run(["git", "-C", tree, "reset", "--quiet", "--hard", "FETCH_HEAD"], check=True)
    return tree


def _listed(tree, crate):
    words = ["cargo", "mutants", "--list", "--colors", "never", "--package", f"bulge-{crate}"]
    return sorted(subprocess.run(words, cwd=tree, check=True, capture_output=True, text=True).stdout.splitlines())


def _without_place(name):
    return re.sub(r":\d+:\d+:", ":", name)


def _run(tree, crate, mutants, together):
    """Names of the mutants by what became of them: by the unit tests, and by all tests for those that survive."""
    found = {"missed": mutants} if together else _tested(tree, crate, mutants, ["--lib"], UNIT_S)
    if not (tree / "crates" / crate / "tests").is_dir():
        return found
    rest = _tested(tree, crate, found.pop("missed"), ["--lib", "--bins", "--tests"], ALL_S)
    return {outcome: [*found.get(outcome, []), *rest[outcome]] for outcome in OUTCOMES}


def _tested(tree, crate, mutants, which, limit_s):
    if not mutants:
        return {outcome: [] for outcome in OUTCOMES}
    out = tree.parent / f"{crate}-found"
    shutil.rmtree(out, ignore_errors=True)
    exactly = "^(" + "|".join(re.escape(name) for name in mutants) + ")$"
    tool = "nextest" if shutil.which("cargo-nextest") else "cargo"
    words = ["cargo", "mutants", "--in-place", "--package", f"bulge-{crate}", "--re", exactly, "--baseline", "skip", "--timeout", limit_s]
    for file in sorted({name.split(":")[0] for name in mutants}):
        words += ["--file", file]
    words += ["--output", out, "--test-tool", tool, "--no-shuffle", "--colors", "never", "--", *which]
    # Its status is 2 or 3 if a mutant survives or takes too long.
    subprocess.run([str(word) for word in words], cwd=tree, env={**os.environ, "CARGO_INCREMENTAL": "1", "CARGO_PROFILE_DEV_DEBUG": "false"}, check=False)
    chosen = set(mutants)
    # `--re` lets mutants that leave out a field of a struct through, whatever their names.
    read = {outcome: [name for name in (out / "mutants.out" / f"{outcome}.txt").read_text(encoding="utf-8").splitlines() if name in chosen] for outcome in OUTCOMES}
    done = sum(len(names) for names in read.values())
    if done != len(mutants):
        sys.exit(f"{done} of {len(mutants)} mutants were tested: see {out}")
    return read


if __name__ == "__main__":
    sys.exit(main())
