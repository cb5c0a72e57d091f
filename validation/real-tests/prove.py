"""Everything in one command: writes the tests, runs `bulge compare` and `bulge diagnose` on them, prints the tables.

    python prove.py --seed 1 --bulge PATH [--out DIR] [--plain] [--jobs 2] [--only REGEX] [--limit 120] [--again] [--readme]

DIR/suite holds the tests, DIR/diagnose and DIR/compare the answers, DIR/score.md the tables. --plain writes all data as the contract's CSV: what is
left is diagnosis, without the reading of dialects. --readme puts the tables into README.md between its markers. The exit status is 1 if a test has
no answer; those that have are scored all the same.
"""

import argparse
import subprocess
import sys
from pathlib import Path

import bench  # noqa: F401
from bench.scores import answers, into_page, tables

HERE = Path(__file__).resolve().parent
RUN = HERE.parent / "hidden-effects" / "run.py"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="another seed gives other muscles, rigs, amplitudes and noise")
    parser.add_argument("--bulge", default="bulge", help="the program to prove")
    parser.add_argument("--out", type=Path, help="folder of everything that is written [default: target/real-tests/seed-SEED or ...-plain]")
    parser.add_argument("--plain", action="store_true", help="all data as the contract's CSV")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--only", default="", help="regular expression that the names of the cases must contain")
    parser.add_argument("--limit", type=float, default=120.0, help="seconds after which a test counts as not answered")
    parser.add_argument("--again", action="store_true", help="run the program on tests that it has answered already")
    parser.add_argument("--score", action="store_true", help="score what is there and run nothing")
    parser.add_argument("--readme", action="store_true", help="put the tables into README.md")
    arguments = parser.parse_args()
    name = f"seed-{arguments.seed}{'-plain' if arguments.plain else ''}"
    out = (arguments.out or HERE.parents[1] / "target" / "real-tests" / name).resolve()
    suite, status = out / "suite", 0
    if not arguments.score:
        status = _run(arguments, suite, out)
    found = answers(suite, out / "diagnose", out / "compare")
    version = subprocess.run([arguments.bulge, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    files = "all written as the contract's CSV" if arguments.plain else "each in its dialect"
    told = f"{version}, seed {arguments.seed}, {len(found)} tests, {files}"
    text = tables(found, f"{told}; one thread a test, {arguments.limit:g} s at most.")
    (out / "score.md").write_text(text + "\n", encoding="utf-8")
    print(text)
    if arguments.readme:
        into_page(HERE / "README.md", "plain" if arguments.plain else "dialects", text)
    return 1 if status or any(one.document is None for one in found) else 0


def _run(arguments, suite, out):
    """Writes the tests and runs both commands; 1 if some were not answered."""
    some, jobs = ["--only", arguments.only], ["--jobs", str(arguments.jobs)]
    plain = ["--plain"] if arguments.plain else []
    again = ["--again"] if arguments.again else []
    status = _call([HERE / "generate.py", "--seed", arguments.seed, "--out", suite, *some, *jobs, *plain])
    for command in ("compare", "diagnose"):
        limits = ["--bulge", arguments.bulge, "--command", command, "--limit", arguments.limit]
        status |= _call([RUN, suite, out / command, *limits, *some, *jobs, *again])
    return status


def _call(words):
    return subprocess.call([sys.executable, *(str(word) for word in words)])


if __name__ == "__main__":
    sys.exit(main())
