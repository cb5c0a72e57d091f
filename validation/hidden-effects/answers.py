"""Answers of a whole suite in one file, which is committed: from it the rates are scored anew, and a fixed part of it is computed again.

    python answers.py keep SUITE RESULTS FILE.jsonl.gz --suite exact|forms --seed SEED --bulge PATH      # what run.py wrote
    python answers.py check FILE.jsonl.gz --bulge PATH [--every 60] [--jobs 2]

A line holds a case: its truth, what is scored of the answer, the answers of the usual methods. `check` makes every so many cases anew,
from the seed to the answer, and fails where a truth, a verdict, a name, a class or a confidence (by more than 0.02) isn't that of the file: then the
program or the generator has changed, and the suite has to be run again (prove.py), kept, and its tables written (validation/docs_table.py).
"""

import argparse
import gzip
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
OF_CLAIM = ("effect", "class", "family", "level", "confidence", "confidence_mechanism", "confidence_form")
OF_NUMBER = ("value", "low", "high", "unit")
OF_RUNG = ("added", "bent", "held_out_rmse_n", "rmse_n")
CLOSE = 0.02
"""Confidences that differ by less are the same: they are counted in simulations."""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    keeping = commands.add_parser("keep")
    keeping.add_argument("folder", type=Path, metavar="SUITE")
    keeping.add_argument("results", type=Path, metavar="RESULTS")
    keeping.add_argument("file", type=Path, metavar="FILE")
    keeping.add_argument("--suite", choices=("exact", "forms"), default="exact")
    keeping.add_argument("--seed", type=int, required=True)
    keeping.add_argument("--among-truth", action="store_true", help="the hidden effects were the only ones that were looked for")
    keeping.add_argument("--only", default="", help="regular expression that the names of the cases must contain")
    keeping.add_argument("--bulge", required=True, help="the program that answered")
    checking = commands.add_parser("check")
    checking.add_argument("file", type=Path, metavar="FILE")
    checking.add_argument("--bulge", required=True)
    checking.add_argument("--every", type=int, default=60, help="every so many cases are made anew")
    checking.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    return keep(arguments) if arguments.command == "keep" else check(arguments)


def keep(arguments):
    """Writes the file; cases without a result are left out, those without an answer have None."""
    times = json.loads((arguments.results / "times.json").read_text(encoding="utf-8"))
    named = arguments.folder / "baselines.json"
    usual = json.loads(named.read_text(encoding="utf-8")) if named.exists() and not arguments.among_truth else {}
    version = subprocess.run([arguments.bulge, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    head = {"suite": arguments.suite, "seed": arguments.seed, "among_truth": arguments.among_truth, "program": version}
    lines = [head]
    for path in sorted(arguments.folder.glob("*/truth.json")):
        case = path.parent.name
        if case not in times or not re.search(arguments.only, case):
            continue
        result = arguments.results / f"{case}.json"
        document = json.loads(result.read_text(encoding="utf-8")) if result.exists() else {}
        truth = json.loads(path.read_text(encoding="utf-8"))
        lines.append({"case": case, "truth": truth, "answer": answer(document), "usual": usual.get(case)})
    text = "".join(json.dumps(line, separators=(",", ":"), sort_keys=True) + "\n" for line in lines)
    arguments.file.parent.mkdir(parents=True, exist_ok=True)
    # Without the time of writing: the same answers are the same bytes.
    arguments.file.write_bytes(gzip.compress(text.encode(), 9, mtime=0))
    print(f"{len(lines) - 1} cases, {arguments.file.stat().st_size} bytes")
    return 0


def answer(document):
    """What is scored of the document of `bulge diagnose --json`; None if there is none."""
    if "verdict" not in document:
        return None
    return {
        "verdict": document["verdict"],
        "missing": [_claim(claim) for claim in document.get("missing") or []],
        "nearest": [_claim(claim) for claim in document.get("nearest") or []],
        "remaining": {"structured": bool((document.get("remaining") or {}).get("structured"))},
        "ladder": [{key: rung[key] for key in OF_RUNG if key in rung} for rung in document.get("ladder") or []],
        "where": [{"variable": place["variable"]} for place in (document.get("where") or [])[:1]],
    }


def _claim(claim):
    kept = {key: claim[key] for key in OF_CLAIM if key in claim}
    numbers = {name: {key: number.get(key) for key in OF_NUMBER} for name, number in (claim.get("parameters") or {}).items()}
    return {**kept, "parameters": numbers}


def read(file):
    """The head of a file, and its cases."""
    lines = [json.loads(line) for line in gzip.decompress(file.read_bytes()).decode().splitlines()]
    return lines[0], lines[1:]


def unpack(file, folder):
    """Puts suite and results where score.py looks for them; the paths of both."""
    head, cases = read(file)
    suite, results = folder / "suite", folder / "results"
    results.mkdir(parents=True)
    for case in cases:
        (suite / case["case"]).mkdir(parents=True)
        (suite / case["case"] / "truth.json").write_text(json.dumps(case["truth"]), encoding="utf-8")
        if case["answer"]:
            (results / f"{case['case']}.json").write_text(json.dumps(case["answer"]), encoding="utf-8")
    usual = {case["case"]: case["usual"] for case in cases if case.get("usual")}
    if usual:
        (suite / "baselines.json").write_text(json.dumps(usual), encoding="utf-8")
    return head, suite, results


def score(file):
    """The scores of the answers in a file, as prove.py writes them into score.json."""
    with tempfile.TemporaryDirectory() as folder:
        head, suite, results = unpack(file, Path(folder))
        numbers = Path(folder) / "score.json"
        command = [sys.executable, HERE / "score.py", suite, results, "--json", numbers]
        subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)
        return {"suite": head["suite"], "seed": head["seed"], "only": "", **json.loads(numbers.read_text(encoding="utf-8"))}


def check(arguments):
    """Makes some cases anew; status 1 if one differs."""
    head, cases = read(arguments.file)
    some = cases[:: arguments.every]
    only = "^(" + "|".join(case["case"] for case in some) + ")$"
    with tempfile.TemporaryDirectory() as name:
        suite, results = Path(name) / "suite", Path(name) / "results"
        jobs = ["--only", only, "--jobs", arguments.jobs]
        among = ["--among-truth"] if head["among_truth"] else []
        for command in (
            ["generate.py", "--seed", head["seed"], "--suite", head["suite"], "--out", suite, "--exact-widths", *jobs],
            ["run.py", suite, results, "--bulge", Path(arguments.bulge).resolve(), *among, *jobs],
        ):
            words = [sys.executable, HERE / command[0], *command[1:]]
            done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
            if done.returncode != 0:
                print(f"{command[0]} ended with status {done.returncode}: {done.stderr}", file=sys.stderr)
                return 1
        wrong = []
        for case in some:
            truth = json.loads((suite / case["case"] / "truth.json").read_text(encoding="utf-8"))
            result = results / f"{case['case']}.json"
            found = answer(json.loads(result.read_text(encoding="utf-8"))) if result.exists() else None
            wrong += [f"{case['case']}: {what}" for what in differences(case, truth, found)]
    for line in wrong:
        print(f"{arguments.file.name}: {line}", file=sys.stderr)
    if wrong:
        print("the committed answers are no longer those of this program: run the suite again (prove.py), and keep it", file=sys.stderr)
        return 1
    print(f"{arguments.file.name}: {len(some)} of {len(cases)} cases made anew, all as committed")
    return 0


def differences(case, truth, found):
    """What of a case is not as it was, in words."""
    said, stated = case["answer"], case["truth"]
    hidden = [[(entry["effect"], entry.get("form"), _rounded(entry.get("amplitude"))) for entry in one["hidden"]] for one in (stated, truth)]
    if hidden[0] != hidden[1]:
        return [f"hides {hidden[1]}, not {hidden[0]}"]
    if (said is None) != (found is None):
        return ["was answered" if found is None else "was not answered"]
    if said is None:
        return []
    words = []
    if said["verdict"] != found["verdict"]:
        words.append(f"the verdict is {found['verdict']}, not {said['verdict']}")
    names = [[(claim["effect"], sorted(claim.get("class") or [])) for claim in one["missing"]] for one in (said, found)]
    if names[0] != names[1]:
        words.append(f"the claims are {names[1]}, not {names[0]}")
        return words
    for one, other in zip(said["missing"], found["missing"]):
        for key in OF_CLAIM[4:]:
            values = one.get(key), other.get(key)
            if all(isinstance(value, float) for value in values) and abs(values[0] - values[1]) > CLOSE:
                words.append(f"{key} of {one['effect']} is {values[1]:.3f}, not {values[0]:.3f}")
    return words


def _rounded(value):
    return float(f"{value:.6g}") if isinstance(value, float) else value


if __name__ == "__main__":
    sys.exit(main())
