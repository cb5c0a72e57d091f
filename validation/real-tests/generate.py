"""Writes the simulated tests of laboratories.

    python generate.py --seed 1 --out DIR [--only REGEX] [--jobs 2] [--plain]
    python generate.py --select DIR
    python generate.py --check

Every test becomes DIR/<case>/ with the data in the dialect of its laboratory, muscle.toml, args (what follows `bulge diagnose`, a word a line) and
truth.json. With --plain all data are written as the contract's CSV, and what is hidden and damaged stays the same.
--select writes the small tests of seed 1 that the program's own tests use.
"""

import argparse
import re
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from bench import case, check
from bench.suite import SELECTED, orders


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="another seed gives other muscles, rigs, amplitudes and noise")
    parser.add_argument("--out", type=Path, help="folder of the cases")
    parser.add_argument("--only", default="", help="regular expression that the names of the cases must contain")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--plain", action="store_true", help="all data as the contract's CSV")
    parser.add_argument(
        "--select", type=Path, metavar="DIR", help="write the small tests that lie beside this program, of seed 1, and stop"
    )
    parser.add_argument("--list", action="store_true", help="print the names of the cases and stop")
    parser.add_argument("--check", action="store_true", help="check the generator itself and stop")
    arguments = parser.parse_args()
    if arguments.check:
        return check.run()
    if arguments.select is not None:
        arguments.seed, arguments.out = 1, arguments.select
        return _generate([order for order in orders() if order.name in SELECTED], arguments)
    chosen = [order for order in orders() if re.search(arguments.only, order.name)]
    if arguments.list:
        print("\n".join(order.name for order in chosen))
        return 0
    if arguments.out is None:
        parser.error("say where the cases go: --out DIR")
    if not chosen:
        parser.error(f"no case is called like {arguments.only!r}; --list prints the names")
    return _generate(chosen, arguments)


def _generate(chosen, arguments):
    started, failed = time.monotonic(), []
    with ProcessPoolExecutor(max_workers=arguments.jobs) as pool:
        queue = sorted(chosen, key=lambda order: -order.rows)
        running = {pool.submit(case.build, order, arguments.seed, arguments.out, arguments.plain): order for order in queue}
        for future in as_completed(running):
            if future.exception() is not None:
                failed.append(f"{running[future].name}: {type(future.exception()).__name__}: {future.exception()}")
    for message in failed:
        print(message, file=sys.stderr)
    print(f"{len(chosen) - len(failed)} cases in {time.monotonic() - started:.0f} s, {len(failed)} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
