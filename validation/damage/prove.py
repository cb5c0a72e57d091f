"""Everything in one command: writes the sets, runs `bulge diagnose` on them, keeps the answers, prints the tables.

    python prove.py --seed 1 --bulge PATH [--out DIR] [--jobs 2] [--only REGEX] [--limit 600] [--again] [--readme]
    python prove.py --check [--bulge PATH] [--every 60]

DIR/suite holds the sets, DIR/results the answers, DIR/score.md the tables, DIR/wrong.txt every set that is wrongly named, unknown or unanswered.
--readme keeps the answers in answers/seed-SEED.jsonl.gz and puts the tables into README.md between its markers. --check scores the kept answers and
fails if README.md has other tables; with a program it also makes every so many sets anew, and fails if a verdict or a first name differs.
"""

import argparse
import gzip
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import harm  # noqa: F401
from answers import answer as claims_of
from bench.scores import into_page
from harm.scores import Result, tables, wrong

HERE = Path(__file__).resolve().parent
RUN = HERE.parent / "hidden-effects" / "run.py"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="another seed gives other muscles, tests, damage and noise")
    parser.add_argument("--bulge", help="the program to prove")
    parser.add_argument("--out", type=Path, help="folder of everything that is written [default: target/damage/seed-SEED]")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--only", default="", help="regular expression that the names of the sets must contain")
    parser.add_argument("--limit", type=float, default=600.0, help="seconds after which a set counts as not answered")
    parser.add_argument("--again", action="store_true", help="run the program on sets that it has answered already")
    parser.add_argument("--score", action="store_true", help="score what is there and run nothing")
    parser.add_argument("--readme", action="store_true", help="keep the answers, and put the tables into README.md")
    parser.add_argument("--check", action="store_true", help="check README.md against the kept answers")
    parser.add_argument("--every", type=int, default=60, help="with --check and --bulge: every so many sets are made anew")
    arguments = parser.parse_args()
    kept = HERE / "answers" / f"seed-{arguments.seed}.jsonl.gz"
    if arguments.check:
        return _check(arguments, kept)
    out = (arguments.out or HERE.parents[1] / "target" / "damage" / f"seed-{arguments.seed}").resolve()
    status = 0 if arguments.score else _run(arguments, out)
    head = {"seed": arguments.seed, "program": _version(arguments.bulge)}
    lines = _lines(out / "suite", out / "results")
    text = _tables(head, lines)
    (out / "score.md").write_text(text + "\n", encoding="utf-8")
    (out / "wrong.txt").write_text("\n".join(wrong([Result(**line) for line in lines])) + "\n", encoding="utf-8")
    print(text)
    if arguments.readme:
        content = "".join(json.dumps(line, separators=(",", ":"), sort_keys=True) + "\n" for line in [head, *lines])
        kept.parent.mkdir(exist_ok=True)
        # Without the time of writing: the same answers are the same bytes.
        kept.write_bytes(gzip.compress(content.encode(), 9, mtime=0))
        into_page(HERE / "README.md", "scores", text)
    return status


def _run(arguments, out):
    """Writes the sets and runs the program on them; 1 if one failed. A refusal is an answer here."""
    some, again = ["--only", arguments.only, "--jobs", arguments.jobs], ["--again"] if arguments.again else []
    status = _call([HERE / "generate.py", "--seed", arguments.seed, "--out", out / "suite", *some])
    _call([RUN, out / "suite", out / "results", "--bulge", arguments.bulge or "bulge", "--limit", arguments.limit, *some, *again])
    return status


def _call(words):
    return subprocess.call([sys.executable, *(str(word) for word in words)])


def _version(program):
    return subprocess.run([program or "bulge", "--version"], capture_output=True, text=True, check=True).stdout.strip()


def _lines(suite, results):
    """Truth and answer of every set that was run."""
    times, problems = (json.loads((results / name).read_text(encoding="utf-8")) for name in ("times.json", "failures.json"))
    lines = []
    for file in sorted(suite.glob("*/truth.json")):
        case = file.parent.name
        if case in times or case in problems:
            found = results / f"{case}.json"
            answer = _answer(json.loads(found.read_text(encoding="utf-8"))) if found.exists() else None
            truth = json.loads(file.read_text(encoding="utf-8"))
            lines.append({"truth": truth, "answer": answer, "problem": problems.get(case), "seconds": times.get(case)})
    return lines


def _answer(document):
    """What is scored of a diagnosis: verdict and claims, and all that is said of the readings."""
    data, claims = document["data"], claims_of(document)
    kept = {"verdict": claims["verdict"], "missing": [{key: one[key] for key in ("effect", "class", "confidence")} for one in claims["missing"]]}
    kept |= {"left_out": data["left_out"], "set_apart": [{**one, "file": one["file"]} for one in data["set_apart"][:200]], "quality": data["quality"]}
    kept["findings"] = [{"kind": one["kind"], "says": one["says"]} for one in data["findings"]]
    return {**kept, "warnings": document["warnings"], "hints": document["remaining"]["hints"], "jump": document["remaining"].get("jump"), "says": document["says"]}


def _tables(head, lines):
    return tables([Result(**line) for line in lines], f"{head['program']}, seed {head['seed']}, {len(lines)} sets; one thread a set.")


def _check(arguments, kept):
    head, *lines = (json.loads(line) for line in gzip.decompress(kept.read_bytes()).decode().splitlines())
    wrongs = [] if _tables(head, lines) in (HERE / "README.md").read_text(encoding="utf-8") else ["README.md has other tables than the kept answers give"]
    if arguments.bulge:
        wrongs += _anew(arguments, head["seed"], lines[:: arguments.every])
    for line in wrongs:
        print(f"{kept.name}: {line}; run prove.py --readme", file=sys.stderr)
    if not wrongs:
        print(f"{kept.name}: {len(lines)} sets, all as committed")
    return 1 if wrongs else 0


def _anew(arguments, seed, lines):
    """What differs in sets that are made and answered once more."""
    with tempfile.TemporaryDirectory() as name:
        arguments.seed, arguments.again = seed, False
        arguments.only = "^(" + "|".join(line["truth"]["case"] for line in lines) + ")$"
        _run(arguments, Path(name))
        fresh = {line["truth"]["case"]: Result(**line) for line in _lines(Path(name) / "suite", Path(name) / "results")}
    differing = []
    for old in (Result(**line) for line in lines):
        new = fresh[old.truth["case"]]
        if (old.outcome, old.first, old.naming) != (new.outcome, new.first, new.naming):
            differing.append(f"{old.truth['case']} is {new.outcome} ({new.first}), not {old.outcome} ({old.first})")
    return differing


if __name__ == "__main__":
    sys.exit(main())
