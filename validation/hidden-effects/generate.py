"""Writes the suite of simulated measurements with hidden effects.

    python generate.py --seed 1 --out DIR [--suite exact|forms] [--exact-widths] [--only REGEX] [--jobs 2]
    python generate.py --check

Every case becomes DIR/<case>/data.csv, muscle.toml, unseen.csv and truth.json. The same seed gives the same bytes, whatever --only and --jobs say.
"""

import argparse
import os
import re
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

# One thread per process: the matrices are small, and the cases are what runs in parallel.
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

from simulator import case, check, forms_case, forms_suite, suite  # noqa: E402

SUITES = {"exact": (suite.orders, case.build), "forms": (forms_suite.orders, forms_case.build)}
"""Orders of a suite, and what builds one."""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="another seed gives other muscles, amplitudes and noise")
    parser.add_argument("--out", type=Path, help="folder of the cases")
    parser.add_argument("--suite", choices=SUITES, default="exact", help="effects as the catalogue has them, or in forms of their own")
    parser.add_argument("--exact-widths", action="store_true", help="state widths of 0 where the geometry has none")
    parser.add_argument("--only", default="", help="regular expression that the names of the cases must contain")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--list", action="store_true", help="print the names of the cases and stop")
    parser.add_argument("--check", action="store_true", help="check the generator itself and stop")
    arguments = parser.parse_args()
    if arguments.check:
        return check.run()
    orders, build = SUITES[arguments.suite]
    chosen = [order for order in orders() if re.search(arguments.only, order.name)]
    if arguments.list:
        print("\n".join(order.name for order in chosen))
        return 0
    if arguments.out is None:
        parser.error("say where the cases go: --out DIR")
    if not chosen:
        parser.error(f"no case is called like {arguments.only!r}; --list prints the names")
    return _generate(chosen, build, arguments)


def _generate(chosen, build, arguments):
    started, failed = time.monotonic(), []
    with ProcessPoolExecutor(max_workers=arguments.jobs) as pool:
        # The largest cases first, so that none is left to run alone at the end.
        queue = sorted(chosen, key=lambda order: order.size != "dense")
        more = (True,) if arguments.exact_widths else ()
        running = {pool.submit(build, order, arguments.seed, arguments.out, *more): order for order in queue}
        for done, future in enumerate(as_completed(running), 1):
            if future.exception() is not None:
                failed.append(f"{running[future].name}: {future.exception()}")
            if done % 50 == 0:
                print(f"{done} of {len(chosen)} cases, {time.monotonic() - started:.0f} s", file=sys.stderr)
    for message in failed:
        print(message, file=sys.stderr)
    print(f"{len(chosen) - len(failed)} cases in {time.monotonic() - started:.0f} s, {len(failed)} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
