"""Scores diagnoses against the truth of a suite, beside the baselines.

    python score.py DIR RESULTS [--only REGEX] [--json FILE] [--table FILE]

RESULTS holds <case>.json, each the output of `bulge diagnose --json` on DIR/<case>/data.csv, and optionally times.json {"case": seconds}.
Prints a Markdown table: value [Wilson 95 % interval] (number of cases). Rates count a case that was not named as not right; cases without an answer
count in the first row alone.
"""

import argparse
import json
import re
import sys
from pathlib import Path

from simulator.answers import baselines, diagnoses, truths
from simulator.metrics import measure


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("results", type=Path, nargs="?", help="without it only the baselines are scored")
    parser.add_argument("--only", default="")
    parser.add_argument("--json", type=Path, help="write all numbers to this file")
    parser.add_argument("--table", type=Path, help="write the table to this file")
    arguments = parser.parse_args()
    known = {case: truth for case, truth in truths(arguments.folder).items() if re.search(arguments.only, case)}
    if not known:
        parser.error(f"{arguments.folder} holds no case called like {arguments.only!r}")
    methods = {"diagnose": measure(diagnoses(known, arguments.results))} if arguments.results else {}
    methods.update({name: measure(answers) for name, answers in baselines(known, arguments.folder).items()})
    if not methods:
        parser.error("nothing to score: give RESULTS, or run baselines.py first")
    table = _table(methods)
    print(table)
    if arguments.table:
        arguments.table.write_text(table + "\n", encoding="utf-8")
    if arguments.json:
        arguments.json.write_text(json.dumps({"cases": len(known), "methods": methods}, indent=1) + "\n", encoding="utf-8")
    return 0


def _table(methods):
    titles = []
    for rows in methods.values():
        titles += [row["measure"] for row in rows if row["measure"] not in titles]
    lines = ["| measure | " + " | ".join(methods) + " |", "|---" * (len(methods) + 1) + "|"]
    for title in titles:
        cells = [_cell(next((row for row in rows if row["measure"] == title), None)) for rows in methods.values()]
        if any(cells):
            lines.append(f"| {title} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _cell(row):
    if row is None or row["value"] is None:
        return ""
    if row.get("rate"):
        return f"{row['value']:.1%} [{row['low']:.1%}, {row['high']:.1%}] ({row['n']})"
    bounds = f" [{row['low']:.2f}, {row['high']:.2f}]" if "low" in row else ""
    return f"{row['value']:.3g}{bounds} ({row['n']})"


if __name__ == "__main__":
    sys.exit(main())
