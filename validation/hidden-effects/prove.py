"""The whole proof in one command: builds the suite, runs the usual methods and Bulge on it, and prints the table of the scores.

    python prove.py --seed 1 --bulge PATH [--suite exact|forms] [--out DIR] [--jobs 2] [--only REGEX] [--again]

DIR/suite holds the cases, DIR/results the answers, DIR/score.json all numbers, DIR/score.md the table. The exit status is 1 if a case could not be built
or answered; what was answered is scored all the same.
"""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
GOES_ON = {"generate.py": 1, "run.py": 1}
"""Status of a stage that failed on some cases: the others are scored."""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="another seed gives other muscles, amplitudes and noise")
    parser.add_argument("--suite", choices=("exact", "forms"), default="exact", help="effects as the catalogue has them, or in forms of their own")
    parser.add_argument("--exact-widths", action="store_true", help="state widths of 0 where the geometry has none")
    parser.add_argument("--bulge", default="bulge", help="the program to prove")
    parser.add_argument("--out", type=Path, help="folder of everything that is written [default: out/hidden-effects/seed-SEED, out/hidden-effects/forms-SEED]")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--only", default="", help="regular expression that the names of the cases must contain")
    parser.add_argument("--again", action="store_true", help="run Bulge on cases that it has answered already")
    arguments = parser.parse_args()
    formed = arguments.suite == "forms"
    out = arguments.out or Path("out") / "hidden-effects" / f"{'forms' if formed else 'seed'}-{arguments.seed}"
    suite, results, numbers, table = out / "suite", out / "results", out / "score.json", out / "score.md"
    some = ["--only", arguments.only]
    jobs = ["--jobs", str(arguments.jobs)]
    widths = ["--exact-widths"] if arguments.exact_widths else []
    again = ["--again"] if arguments.again else []
    stages = (
        ["generate.py", "--seed", str(arguments.seed), "--suite", arguments.suite, "--out", suite, *some, *jobs, *widths],
        # The usual methods know exact signatures alone: they have nothing to say about forms.
        *([] if formed else [["baselines.py", suite, *some, *jobs]]),
        ["run.py", suite, results, "--bulge", arguments.bulge, *some, *jobs, *again],
        ["score.py", suite, results, *some, "--json", numbers, "--table", table],
    )
    failed, seconds = False, {}
    for script, *rest in stages:
        started = time.monotonic()
        status = _call([sys.executable, HERE / script, *rest])
        seconds[script.removesuffix(".py")] = round(time.monotonic() - started, 1)
        if status not in (0, GOES_ON.get(script, 0)):
            print(f"{script} ended with status {status}: nothing was scored", file=sys.stderr)
            return status
        failed |= status != 0
    document = json.loads(numbers.read_text(encoding="utf-8"))
    stated = {"suite": arguments.suite, "seed": arguments.seed, "only": arguments.only, "jobs": arguments.jobs, "seconds": seconds}
    numbers.write_text(json.dumps({**stated, **document}, indent=1) + "\n", encoding="utf-8")
    return 1 if failed else 0


def _call(command):
    """Exit status of a stage. After Ctrl-C it gets the time to end what it runs."""
    process = subprocess.Popen([str(word) for word in command])
    try:
        return process.wait()
    except KeyboardInterrupt:
        process.wait()
        return 130


if __name__ == "__main__":
    sys.exit(main())
