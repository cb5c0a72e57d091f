"""Prints how often the families of the forms suite can be told right at best, by who knows noise and forms (`simulator/forms_bound.py`).

    python bound.py --seed 1 [--only REGEX] [--jobs 2] [--json FILE]

A case of one to three known effects takes 5 to 15 seconds. *Possible*: its very shape is known. *By its forms*: only its forms are, as those of all rivals.
"""

import argparse
import json
import os
import re
import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

from simulator import forms_bound, forms_suite  # noqa: E402
from simulator.forms_metrics import KNOWN  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="seed of the suite")
    parser.add_argument("--only", default="", help="regular expression that the names of the cases must contain")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures of every case")
    arguments = parser.parse_args()
    orders = [one for one in forms_suite.orders() if one.kind in KNOWN and re.search(arguments.only, one.name)]
    if not orders:
        parser.error(f"no case of known effects is called like {arguments.only!r}")
    with ProcessPoolExecutor(max_workers=arguments.jobs) as pool:
        found = list(pool.map(partial(forms_bound.bound, seed=arguments.seed), orders))
    if arguments.json:
        arguments.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    groups = {}
    for one in found:
        groups.setdefault(f"one effect, d {one['strength']:g}" if one["kind"] == "one" else f"{one['kind']} effects", []).append(one)
        if one["kind"] == "one":
            groups.setdefault("one effect, all", []).append(one)
    print(f"{'':24s}{'possible':>10s}{'by its forms':>14s}{'cases':>7s}")
    for title, some in groups.items():
        possible, by_form = (sum(one[key] for one in some) / len(some) for key in ("possible", "by_form"))
        print(f"{title:24s}{100.0 * possible:9.0f} %{100.0 * by_form:12.0f} %{len(some):7d}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
