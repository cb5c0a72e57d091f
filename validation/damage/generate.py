"""Writes tests in which nothing is missing from the model and the data are damaged.

    python generate.py --seed 1 --out DIR [--only REGEX] [--jobs 2] [--whole]
    python generate.py --list | --check

Every set becomes DIR/<case>/ with its data, muscle.toml, args (what follows `bulge diagnose`, a word a line) and truth.json. --whole writes the same
sets without their damage: what is said of them, the damage has not done.
"""

import argparse
import re
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from harm import case, check
from harm.orders import orders


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="another seed gives other muscles, tests, damage and noise")
    parser.add_argument("--out", type=Path, help="folder of the sets")
    parser.add_argument("--only", default="", help="regular expression that the names of the sets must contain")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--whole", action="store_true", help="without the damage")
    parser.add_argument("--list", action="store_true", help="print the names of the sets and stop")
    parser.add_argument("--check", action="store_true", help="check the generator and the score, and stop")
    arguments = parser.parse_args()
    if arguments.check:
        return check.run()
    chosen = [order for order in orders() if re.search(arguments.only, order.name)]
    if arguments.list:
        print("\n".join(order.name for order in chosen))
        return 0
    if arguments.out is None or not chosen:
        parser.error("say where the sets go: --out DIR" if chosen else f"no set is called like {arguments.only!r}; --list prints the names")
    started, failed = time.monotonic(), []
    with ProcessPoolExecutor(max_workers=arguments.jobs) as pool:
        running = {pool.submit(case.build, order, arguments.seed, arguments.out, arguments.whole): order for order in chosen}
        for future in as_completed(running):
            if future.exception() is not None:
                failed.append(f"{running[future].name}: {type(future.exception()).__name__}: {future.exception()}")
    for message in sorted(failed):
        print(message, file=sys.stderr)
    print(f"{len(chosen) - len(failed)} sets in {time.monotonic() - started:.0f} s, {len(failed)} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
