"""Scores diagnoses against the truth of a suite, beside the baselines.

    python score.py DIR RESULTS [--only REGEX] [--json FILE] [--table FILE] [--list-wrong]

RESULTS holds <case>.json, each the output of `bulge diagnose --json` on DIR/<case>/data.csv, and optionally times.json {"case": seconds}.
Prints a Markdown table: value [Wilson 95 % interval] (number of cases). Rates count a case that was not named as not right; cases without an answer
count in the first row alone; in the forms suite they count as not right. The kind of the suite stands in its truths.
"""

import argparse
import json
import re
import sys
from pathlib import Path

from simulator import forms_metrics
from simulator.answers import baselines, diagnoses, truths
from simulator.metrics import measure


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("results", type=Path, nargs="?", help="without it only the baselines are scored")
    parser.add_argument("--only", default="")
    parser.add_argument("--json", type=Path, help="write all numbers to this file")
    parser.add_argument("--table", type=Path, help="write the table to this file")
    parser.add_argument("--list-wrong", action="store_true", help="forms suite: what was hidden and what was named instead, most frequent first")
    arguments = parser.parse_args()
    known = {case: truth for case, truth in truths(arguments.folder).items() if re.search(arguments.only, case)}
    if not known:
        parser.error(f"{arguments.folder} holds no case called like {arguments.only!r}")
    formed = {truth.get("suite") == "forms" for truth in known.values()}
    if len(formed) > 1:
        parser.error(f"{arguments.folder} holds cases of two suites; score them apart: --only REGEX")
    methods = {}
    if arguments.results:
        answered = forms_metrics.answers(known, arguments.results) if True in formed else diagnoses(known, arguments.results)
        methods["diagnose"] = forms_metrics.measure(answered) if True in formed else measure(answered)
    methods.update({name: measure(answers) for name, answers in baselines(known, arguments.folder).items()})
    if not methods:
        parser.error("nothing to score: give RESULTS, or run baselines.py first")
    table = _table(methods)
    print(table)
    if arguments.list_wrong and True in formed and arguments.results:
        print("\n".join(["", "Wrong names:", *forms_metrics.wrong_names(answered), "", "Cases that came out wrong:", *forms_metrics.wrong(answered)]))
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
