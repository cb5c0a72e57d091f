"""Writes the tables of README.md and docs/ that a command prints, between their markers.

    bulge validate --json | python validation/docs_table.py verification [--check]
    python validation/docs_table.py diagnosis [--check]      # from validation/hidden-effects/answers, scored anew
    python validation/docs_table.py forms [--check]          # the same for the forms suite: with the whole catalogue, and with the truth as the only candidate
    python validation/docs_table.py ratios [--check]         # from benches/ratios.json, which benches/ratios.py measures
    python validation/docs_table.py limits [--check]         # from benches/limits.json, which the program `limits` of bulge-benches prints
    python validation/docs_table.py mutation [--check]       # from validation/mutation.json, which validation/mutation.py measures
    python validation/docs_table.py coverage [--check]       # from validation/coverage.json, which validation/coverage.py measures
    python validation/docs_table.py fuzz [--check]           # from fuzz/counts.tsv, to which fuzz/run adds

A table stands between `<!-- table: NAME ... -->` and `<!-- end of table -->`; all else in the file is kept. `--check` writes nothing: its status is 1 if
the page differs. Errors of `verification` at the level of rounding differ between machines and aren't compared. The tables of suites need NumPy and SciPy.
"""

import argparse
import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGES = ("README.md", "docs/diagnose.md", "docs/hardening.md", "docs/speed.md", "docs/verification.md")
ANSWERS = ROOT / "validation/hidden-effects/answers"
PEERS = {"AICc": "aicc", "BIC": "bic", "largest drop": "largest-drop", "lasso": "lasso"}

DIAGNOSIS = (
    ("nothing hidden: anything claimed", "false alarms, nothing hidden", "<= 5 %"),
    ("nothing hidden: a name claimed", "false names, nothing hidden", ""),
    ("rig errors within the data sheets: anything claimed", "false alarms, rig errors within the data sheets", "<= 5 %"),
    ("something is missing is said, d 2 to 4", "detected, d 2 to 4", ""),
    ("the same, d 4 to 8", "detected, d 4 to 8", ""),
    ("the same, d 8 to 16", "detected, d 8 to 16.5", ""),
    ("right class, d >= 4", "class right, d >= 4", ">= 95 %"),
    ("right class, d 8 to 16", "class right, d 8 to 16.5", ""),
    ("of what is named: the hidden effect is in the class, d >= 4", "hidden effect in the class reported, d >= 4", ""),
    ("right first name, d >= 8, no twin in the data", "top-1, d >= 8, no twin in the data", ">= 92 %"),
    ("names in a class, d >= 8", "mean class size, d >= 8", "<= 1.6"),
    ("the same by the truth", "mean class size by the truth (3.29 sigma), same cases", ""),
    ("right class and nothing else named, d >= 4", "class right and nothing else named, d >= 4", ""),
    ("two effects: both found", "pairs: both in the classes", ""),
    ("two that partly cancel: both found", "maskings: both in the classes", ""),
    ("outside the catalogue: called unknown", "outside the catalogue: called unknown", ">= 90 %"),
    ("the same, 8 sigma beyond any two effects", "outside the catalogue, 8 sigma beyond any two effects: called unknown", ""),
    ("outside the catalogue: explained away by a name", "outside the catalogue: adequate under a wrong name", "<= 5 %"),
    ("outside the catalogue: not noticed", "outside the catalogue: not noticed", ""),
    ("held-out error over the noise, right class", "held-out error / noise, after the right class", "<= 1.1"),
    ("95 % intervals that hold the true number", "intervals that hold the true parameter", "95 %"),
    ("first name of the hidden family where its confidence is 0 to 0.5", "right when the confidence is 0 to 0.5", ""),
    ("0.5 to 0.7", "right when the confidence is 0.5 to 0.7", ""),
    ("0.7 to 0.9", "right when the confidence is 0.7 to 0.9", ""),
    ("0.9 and more", "right when the confidence is 0.9 to 0.97", ""),
    ("confidence less rate of such first names", "calibration: mean distance of confidence and rate", "<= 0.05"),
)
"""What the page says, what score.py calls it, and the target."""
FRONT = (
    "false alarms, nothing hidden",
    "detected, d 2 to 4",
    "detected, d 4 to 8",
    "hidden effect in the class reported, d >= 4",
    "top-1, d >= 8, no twin in the data",
    "pairs: both in the classes",
    "outside the catalogue: called unknown",
    "outside the catalogue: adequate under a wrong name",
)
"""Measures that the front page shows, titled as above."""


FORMS = (
    ("one effect, d 8: family right and nothing else named", ">= 95 %"),
    ("one effect, d 12: family right and nothing else named", ">= 95 %"),
    ("one effect, d 40: family right and nothing else named", ">= 95 %"),
    ("one effect, d 120: family right and nothing else named", ">= 95 %"),
    ("one effect, d 300: family right and nothing else named", ">= 95 %"),
    ("one effect, all: family right and nothing else named", ">= 95 %"),
    ("one effect: one claim, the hidden family in its class", ""),
    ("one effect: called unknown", ""),
    ("two effects: both at the level of the family, nothing else named", ">= 85 %"),
    ("three effects: all three at the level of the family, nothing else named", ">= 75 %"),
    ("nothing hidden: quiet", ">= 97 %"),
    ("outside the catalogue: called unknown", ">= 95 %"),
    ("beside a known effect: called unknown", ">= 85 %"),
    ("beside a known effect: called unknown, or the known family alone with structure that remains", ""),
    ("wrong names, of all names (by family)", "<= 3 %"),
    ("claims that are wrong at the level that they state", ""),
    ("calibration of the family: mean distance of confidence and rate", "<= 0.05"),
)
"""What the page says of the forms suite, as score.py calls it, and the target."""


FORMS_FRONT = (
    "one effect, all: family right and nothing else named",
    "two effects: both at the level of the family, nothing else named",
    "nothing hidden: quiet",
    "outside the catalogue: called unknown",
    "wrong names, of all names (by family)",
    "claims that are wrong at the level that they state",
    "family right when its confidence is 0.9 to 0.97",
)
"""What of it stands on the front page."""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("verification", "diagnosis", "forms", "ratios", "limits", "mutation", "coverage", "fuzz"))
    parser.add_argument("--check", action="store_true", help="compare the pages, and write nothing")
    parser.add_argument("--root", type=Path, default=ROOT, help="folder of README.md and docs")
    arguments = parser.parse_args()
    if arguments.what == "verification":
        checks = json.load(sys.stdin)["checks"]
        if not checks:
            parser.error("standard input holds no check: give it the output of `bulge validate --json`")
        tables = {"verification": verification(checks)}
    elif arguments.what == "limits":
        tables = {"limits": limits(json.loads((ROOT / "benches/limits.json").read_text(encoding="utf-8")))}
    elif arguments.what == "ratios":
        measured = json.loads((ROOT / "benches/ratios.json").read_text(encoding="utf-8"))
        tables = {"ratios": ratios(measured), "ratios-front": ratios(measured)}
    elif arguments.what == "mutation":
        kept = ROOT / "validation/mutation.json"
        if not kept.exists():
            parser.error(f"{kept} is not there: run validation/mutation.py for each crate")
        tables = {"mutation": mutation(json.loads(kept.read_text(encoding="utf-8")))}
    elif arguments.what == "coverage":
        kept = ROOT / "validation/coverage.json"
        if not kept.exists():
            parser.error(f"{kept} is not there: run validation/coverage.py")
        tables = {"coverage": coverage(json.loads(kept.read_text(encoding="utf-8"))["inference"])}
    elif arguments.what == "fuzz":
        tables = {"fuzz": fuzz((ROOT / "fuzz/counts.tsv").read_text(encoding="utf-8"))}
    elif arguments.what == "forms":
        scores = scored("forms-79", "forms-79-among-truth")
        tables = {"forms": forms(scores), "forms-front": forms_front(scores[0])}
    else:
        methods = scored("seed-2")[0]["methods"]
        tables = {"diagnosis": diagnosis(methods), "diagnosis-front": front(methods)}
    texts = {}
    for name, table in tables.items():
        paths = [arguments.root / page for page in PAGES if f"<!-- table: {name} " in (arguments.root / page).read_text(encoding="utf-8")]
        if not paths:
            parser.error(f"no page has the marker `<!-- table: {name} ... -->`")
        for path in paths:
            texts[path] = replaced(texts.get(path) or path.read_text(encoding="utf-8"), name, table)
    if arguments.check:
        return _compared(texts)
    for path, text in texts.items():
        path.write_text(text, encoding="utf-8")
        print(f"wrote {path}")
    return 0


def scored(*names):
    """Scores of the committed answers of suites."""
    sys.path.insert(0, str(ANSWERS.parent))
    from answers import score

    lacking = [name for name in names if not (ANSWERS / f"{name}.jsonl.gz").exists()]
    if lacking:
        sys.exit(f"{ANSWERS / lacking[0]}.jsonl.gz is not there: run the suite (prove.py) and keep its answers (answers.py keep)")
    return [score(ANSWERS / f"{name}.jsonl.gz") for name in names]


def ratios(measured):
    """What each question costs here and with a peer, in one run."""
    lines = [f"| {measured['machine']}, {measured['date']} | Bulge | peer | times |", "|---|---|---|---|"]
    for row in measured["rows"]:
        cells = [row["question"], _time(row["own_s"]), f"{row['peer_is']}: {_time(row['peer_s'])}", f"{float(format(row['ratio'], '.2g')):g}"]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def limits(measured):
    """What each kernel takes beside what its operations need at least, and beside the fastest of other libraries."""
    names = ("a call of", "needs: + x, divisions, roots; bytes", "instructions", "time", "limit as compiled", "limit in four lanes", "the fastest of others")
    lines = ["| " + " | ".join(names) + " |", "|" + "---|" * len(names)]
    for row in measured["rows"]:
        needs = f"{_count(row['arithmetic'])}, {_count(row['divisions'])}, {_count(row['roots'])}; {_count(row['bytes'])}"
        instructions = _count(row["instructions"]) if row["instructions"] else ""
        bounds = [f"{_time(1e-9 * row[key])}: {_rough(row['time_ns'] / row[key])} times" for key in ("compiled_ns", "lanes_ns")]
        peer = f"{row['peer']}: {_time(1e-9 * row['peer_ns'])}, {_rough(row['peer_ns'] / row['time_ns'])} times Bulge's" if row["peer"] else ""
        cells = [f"{row['kernel']} ({row['counted']})", needs, instructions, _time(1e-9 * row["time_ns"]), *bounds, peer]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _rough(number):
    """Two digits, without a power of ten."""
    return f"{float(format(number, '.2g')):g}"


def _count(number):
    return f"{number:.2g}" if number >= 1e5 else f"{number:.0f}"


def mutation(crates):
    """What share of the mutants of each crate its own tests catch."""
    sys.path.insert(0, str(ANSWERS.parent))
    from simulator.wilson import interval

    lines = ["| crate | mutants | sample | not built | survive | caught [Wilson's 95 % interval] |", "|---|---|---|---|---|---|"]
    for crate, counts in crates.items():
        built, survive = counts["sample"] - counts["unviable"], len(counts["survived"])
        low, high = (100 * bound for bound in interval(built - survive, built))
        share = f"{100 * (built - survive) / built:.1f} % [{low:.0f}, {high:.0f}]"
        cells = [crate, str(counts["mutants"]), str(counts["sample"]), str(counts["unviable"]), str(survive), share]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def coverage(modules):
    """What the tests of inference run, folder by folder."""
    lines = ["| modules | lines | of them run | regions | of them run | least covered module, lines |", "|---|---|---|---|---|---|"]
    share = lambda counts, what: counts[what] / max(1, counts[f"all_{what}"])
    folders = sorted({name.split("/")[0] if "/" in name else "" for name in modules})
    for folder in [*folders, None]:
        own = {name: counts for name, counts in modules.items() if folder is None or (name.split("/")[0] if "/" in name else "") == folder}
        sums = {key: sum(counts[key] for counts in own.values()) for key in ("lines", "all_lines", "regions", "all_regions")}
        least = min(own, key=lambda name: share(own[name], "lines"))
        cells = ["**all**" if folder is None else f"`{folder}`" if folder else "others"]
        cells += [str(sums["all_lines"]), f"{100 * share(sums, 'lines'):.1f} %", str(sums["all_regions"]), f"{100 * share(sums, 'regions'):.1f} %"]
        lines.append("| " + " | ".join([*cells, f"`{least}`, {100 * share(own[least], 'lines'):.1f} %"]) + " |")
    return "\n".join(lines)


def fuzz(counts):
    """How many inputs each reader was given."""
    inputs = {}
    for line in counts.splitlines():
        _, target, count = line.split("\t")
        inputs[target] = inputs.get(target, 0) + int(count)
    lines = ["| reader | inputs |", "|---|---|"]
    lines += [f"| {target} | {count:,} |".replace(",", " ") for target, count in sorted(inputs.items(), key=lambda entry: -entry[1])]
    return "\n".join([*lines, f"| **all** | {sum(inputs.values()):,} |".replace(",", " ")])


def _time(seconds):
    for size, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")):
        if seconds >= size:
            return f"{seconds / size:.2g} {unit}" if seconds < 99.5 * size else f"{seconds / size:.0f} {unit}"
    return f"{seconds:.2g} s"


def _compared(texts):
    """Status 1 and the lines that differ, errors aside, if a page is not what would be written."""
    status = 0
    for path, text in texts.items():
        if path.read_text(encoding="utf-8") == text:
            continue
        stands, belongs = ([_without_error(line) for line in lines.splitlines()] for lines in (path.read_text(encoding="utf-8"), text))
        for sign, lines, others in (("-", stands, belongs), ("+", belongs, stands)):
            for line in lines:
                if line not in others:
                    print(f"{path}: {sign} {line}", file=sys.stderr)
                    status = 1
    if status:
        print("write it anew by the same command without --check", file=sys.stderr)
    return status


def _without_error(line):
    """`| check | cases | error | tolerance |` without the third cell."""
    return re.sub(r"^(\| .* \| \d+ \|) \S+ (\| \S+ \|)$", r"\1 \2", line)


def replaced(text, name, table):
    """The text with the table between its markers."""
    pattern = re.compile(rf"(<!-- table: {re.escape(name)} [^\n]*-->\n)(.*?)(\n<!-- end of table -->)", re.DOTALL)
    return pattern.sub(lambda match: f"{match[1]}\n{table}\n{match[3]}", text)


def verification(checks):
    lines, group = ["| check | cases | error | tolerance |", "|---|---|---|---|"], None
    for check in checks:
        if check["group"] != group:
            group = check["group"]
            lines.append(f"| **{group}** | | | |")
        lines.append(f"| {check['name']} | {check['cases']} | {_power(check['error'], 0)} | {_power(check['tolerance'], 1)} |")
    return "\n".join(lines)


def _power(value, digits):
    """1e-07, and 1.5e-01 where a digit more says something."""
    return f"{value:.{digits}e}".replace(".0e", "e") if value else "0"


def diagnosis(methods):
    lines = ["| | " + " | ".join(["Bulge", "target", *PEERS]) + " |", "|---" * (len(PEERS) + 3) + "|"]
    for title, measure, target in DIAGNOSIS:
        # What a peer has no classes or confidence for stays empty.
        peers = [_cell(_row(methods.get(name, []), measure), False) for name in PEERS.values()]
        lines.append(f"| {title} | " + " | ".join([_cell(_row(methods["diagnose"], measure), True), target, *peers]) + " |")
    return "\n".join(lines)


def forms(scores):
    rows = [score["methods"]["diagnose"] for score in scores]
    lines = [f"| {scores[0]['cases']} cases | the whole catalogue | the truth alone | target |", "|---|---|---|---|"]
    for measure, target in FORMS:
        # Of what the truth alone could say: the rest is a matter of the whole catalogue.
        asked = rows if measure.split()[0] in ("one", "two", "three") else rows[:1]
        cells = [_cell(_row(row, measure), True) for row in asked]
        lines.append(f"| {measure} | " + " | ".join([*cells, ""][:2]) + f" | {target} |")
    return "\n".join(lines)


def forms_front(score):
    lines = [f"| {score['cases']} cases | |", "|---|---|"]
    for measure in FORMS_FRONT:
        lines.append(f"| {measure} | {_cell(_row(score['methods']['diagnose'], measure), True)} |")
    return "\n".join(lines)


def front(methods):
    lines = ["| | Bulge | BIC, the same files |", "|---|---|---|"]
    for title, measure, _ in DIAGNOSIS:
        if measure in FRONT:
            cells = [_cell(_row(methods["diagnose"], measure), True), _cell(_row(methods[PEERS["BIC"]], measure), False)]
            lines.append(f"| {title} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _row(rows, measure):
    # Behind a confidence stands its mean.
    return next((row for row in rows if row["measure"].split(" (mean ")[0] == measure), None)


def _cell(row, with_interval):
    if row is None or row["value"] is None:
        return ""
    if row.get("rate"):
        interval = f" ({100 * row['low']:.0f} to {100 * row['high']:.0f})" if with_interval else ""
        return f"{100 * row['value']:.0f} %{interval}"
    if "low" in row:
        return f"{row['value']:.2f}" + (f" ({row['low']:.2f} to {row['high']:.2f})" if with_interval else "")
    return f"{row['value']:.3g}"


if __name__ == "__main__":
    sys.exit(main())
