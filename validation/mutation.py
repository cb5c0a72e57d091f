"""Mutation tests: what share of small faults in a crate its own tests catch.

    python validation/mutation.py numerics [--sample 200] [--anew]       # samples until there are 200
    python validation/mutation.py numerics --again                       # those that survived before, after tests were written
    python validation/mutation.py numerics --others --sample 100         # others, for which no test was written: what the crate's tests are worth
    python validation/docs_table.py mutation [--check]                   # the table in docs/hardening.md

A mutant is the crate with one operator exchanged, one result replaced or one match arm removed. cargo-mutants 27 lists them (`cargo install cargo-mutants`); of
all a seeded sample is tested. All of them are compiled at once: a function with mutants has a body for each, and BULGE_MUTANT chooses one as the tests run
(mutant schemata, Untch, Offutt and Harrold 1993). What the compiler refuses in this form, constant functions and differing opaque types, is compiled alone.
Each test of the crate first runs alone, which tells how long it takes and which mutated functions it calls. For a mutant only the tests that call its function
run, the fastest first, until one fails: then the mutant is caught. It works in a clone of HEAD below target/mutation, and keeps what it found in
validation/mutation.json after every batch: counts, and the names of the mutants that survive. A run that was stopped goes on from there.
"""

import argparse
import json
import os
import random
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
KEPT = ROOT / "validation/mutation.json"

BATCH = 100

PATIENCE = 8.0
"""How many times longer than without a fault a test may take: a loop without an end counts as caught."""

QUICK_S = 0.3
"""Tests that take less run together in one process: a process for each would take longer than they do."""

SWITCH = """
#[doc(hidden)]
pub(crate) mod mutant {
    extern crate std;
    use std::io::Write;
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicBool, Ordering};

    static CALLED: [AtomicBool; 1000] = [const { AtomicBool::new(false) }; 1000];

    // The number of the chosen mutant. `function` is the first number of those in the calling function: with
    // BULGE_MUTANT_CALLS it is added to that file, once.
    pub(crate) fn chosen(function: usize) -> u32 {
        static CHOSEN: OnceLock<u32> = OnceLock::new();
        static CALLS: OnceLock<Option<std::ffi::OsString>> = OnceLock::new();
        if let Some(path) = CALLS.get_or_init(|| std::env::var_os("BULGE_MUTANT_CALLS")) {
            if !CALLED[function].swap(true, Ordering::Relaxed) {
                let mut file = std::fs::OpenOptions::new().append(true).create(true).open(path).unwrap();
                file.write_all(std::format!("{function}\\n").as_bytes()).unwrap();
            }
        }
        *CHOSEN.get_or_init(|| std::env::var("BULGE_MUTANT").ok().and_then(|text| text.parse().ok()).unwrap_or(0))
    }
}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("crate", help="without `bulge-`")
    parser.add_argument("--sample", type=int, default=200, help="how many mutants")
    parser.add_argument("--anew", action="store_true", help="forget the sample that there is")
    parser.add_argument("--again", action="store_true", help="run only those that survived before")
    parser.add_argument("--others", action="store_true", help="another sample, kept beside the first")
    parser.add_argument("--budget", type=float, help="seconds of tests for a mutant: more may survive, which --again looks at with all tests")
    parser.add_argument("--tests", default="", help="regular expression: run only tests whose names contain it, such as new ones with --again")
    arguments = parser.parse_args()
    if shutil.which("cargo-mutants") is None:
        parser.error("cargo-mutants isn't installed: cargo install cargo-mutants --locked")
    if not (ROOT / "crates" / arguments.crate).is_dir():
        parser.error(f"there is no crate `{arguments.crate}` below crates/")
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    row = f"{arguments.crate}, others" if arguments.others else arguments.crate
    before = kept.get(row)
    if arguments.again and before is None:
        parser.error(f"`{row}` has not been sampled yet: leave out --again")
    crate = Crate(arguments.crate, arguments.tests, arguments.budget or float("inf"))
    if arguments.again:
        # Lines move; what is done to which function stays, and of several such places the nearest is meant.
        chosen = [nearest for name in before["survived"] if (nearest := _nearest(name, crate.mutants)) is not None]
        _, survived = crate.tested(chosen)
        counts = {**before, "survived": sorted(survived)}
        _keep(row, counts)
    else:
        empty = {"mutants": 0, "sample": 0, "unviable": 0, "survived": []}
        counts = empty if arguments.anew or before is None else before
        while counts["sample"] < min(arguments.sample, len(crate.mutants)):
            batch = random.Random(f"{row} from {counts['sample']}").sample(crate.mutants, min(BATCH, len(crate.mutants)))
            unviable, survived = crate.tested(batch)
            counts = {
                "mutants": len(crate.mutants),
                "sample": counts["sample"] + len(batch),
                "unviable": counts["unviable"] + unviable,
                "survived": sorted({*counts["survived"], *survived}),
            }
            _keep(row, counts)
    print("\n".join([f"{len(counts['survived'])} of {counts['sample'] - counts['unviable']} that can be built survive:", *counts["survived"]]))
    return 0


def _keep(row, counts):
    # Another crate may have been added since.
    kept = {**(json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}), row: counts}
    KEPT.write_text(json.dumps(dict(sorted(kept.items())), indent=1) + "\n", encoding="utf-8")


def _nearest(name, mutants):
    """The mutant of this name, or the nearest one that does the same to the same function; none if there is none any more."""
    kept, place = _parts(name)
    same = [mutant for mutant in mutants if _parts(mutant["name"])[0] == kept]
    return min(same, key=lambda mutant: [abs(a - b) for a, b in zip(_parts(mutant["name"])[1], place, strict=True)], default=None)


def _parts(name):
    """A mutant's name without its place, and that place."""
    place = re.search(r":(\d+):(\d+):", name)
    return name.replace(place[0], ":", 1), [int(place[1]), int(place[2])]


class Crate:
    """A crate in a clone of HEAD, what its tests take without a fault, and its mutants."""

    def __init__(self, name, only, budget_s):
        self.only, self.budget_s = re.compile(only), budget_s
        self.tree = ROOT / "target/mutation/tree"
        if not self.tree.exists():
            subprocess.run(["git", "clone", "--quiet", "--shared", ROOT, self.tree], check=True)
        self._git("fetch", "--quiet", "origin", "HEAD")
        self._git("reset", "--quiet", "--hard", "FETCH_HEAD")
        self.package = f"bulge-{name}"
        self.folder = self.tree / "crates" / name
        words = ["cargo", "mutants", "--list", "--json", "--package", self.package]
        listed = subprocess.run(words, cwd=self.tree, check=True, capture_output=True, text=True).stdout
        self.mutants = sorted(json.loads(listed), key=lambda mutant: mutant["name"])
        print(f"{self.package}: {len(self.mutants)} mutants", flush=True)

    def tested(self, mutants):
        """How many can't be built, and the names of those that survive."""
        together, alone = self._compiled_together(mutants)
        survived, unviable = [], 0
        tests = self._tests()
        print(f"{len(tests)} tests, {sum(test.seconds for test in tests):.0f} s alone", flush=True)
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            running = {pool.submit(self._survives, number, tests): mutant["name"] for number, mutant in together.items()}
            for done in as_completed(running):
                survived += [running[done]] if done.result() else []
                print(f"{'SURVIVES' if done.result() else 'caught'}: {running[done]}", flush=True)
        for mutant in alone:
            self._write({mutant["file"]: [mutant]}, {})
            if self._errors():
                unviable += 1
                continue
            programs = {_stem(program): program for program in self._built()}
            lives = self._survives(0, [test._replace(program=programs[_stem(test.program)], calls=None) for test in tests])
            survived += [mutant["name"]] if lives else []
            print(f"{'SURVIVES' if lives else 'caught'}, alone: {mutant['name']}", flush=True)
        self._git("checkout", "--quiet", ".")
        return unviable, survived

    def _tests(self):
        """All tests, the fastest first, with what each takes and calls when it runs alone."""
        named = []
        for program in self._built():
            listed = subprocess.run([program, "--list", "--format", "terse"], cwd=self.folder, check=True, capture_output=True, text=True).stdout
            ignored = subprocess.run([program, "--list", "--format", "terse", "--ignored"], cwd=self.folder, check=True, capture_output=True, text=True).stdout
            lines = sorted({*listed.splitlines()} - {*ignored.splitlines()})
            names = [line.removesuffix(": test") for line in lines if line.endswith(": test")]
            named += [(program, name) for name in names if self.only.search(name)]

        def alone(name):
            calls = self.tree / "target/mutant-calls" / name[1].replace("::", "-")
            calls.parent.mkdir(parents=True, exist_ok=True)
            calls.unlink(missing_ok=True)
            begun = time.monotonic()
            if not self._passes(name[0], [name[1]], 0, None, {"BULGE_MUTANT_CALLS": str(calls)}):
                sys.exit(f"{name[1]} fails without a fault if there is a choice of bodies")
            seconds = time.monotonic() - begun
            return Test(*name, seconds, frozenset(map(int, calls.read_text(encoding="utf-8").split())) if calls.exists() else frozenset())

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            return sorted(pool.map(alone, named), key=lambda test: test.seconds)

    def _survives(self, number, tests):
        """Whether all tests pass that call the function of a mutant; without calls all tests run."""
        tests = [test for test in tests if test.calls is None or self.called[number] in test.calls]
        quick = {}
        for test in tests:
            if test.seconds < QUICK_S:
                quick.setdefault(test.program, []).append(test)
        spent = 0.0
        for group in [*quick.values(), *([test] for test in tests if test.seconds >= QUICK_S)]:
            seconds = sum(test.seconds for test in group)
            if spent + seconds > self.budget_s:
                break
            if not self._passes(group[0].program, [test.name for test in group], number, 5.0 + PATIENCE * seconds, {}):
                return False
            spent += seconds
        return True

    def _git(self, *words):
        subprocess.run(["git", "-C", str(self.tree), *words], check=True)

    def _compiled_together(self, mutants):
        """Numbers with the mutants that a choice of bodies can be made of, and the others; the sources are written."""
        together = {number: mutant for number, mutant in enumerate(mutants, 1) if mutant["function"] is not None}
        alone = [mutant for mutant in mutants if mutant["function"] is None]
        while together:
            places = self._write({}, together)
            errors = self._errors()
            if not errors:
                break
            refused = _standing_at(errors, places["body"]) or _standing_at(errors, places["function"])
            if not refused:
                sys.exit(f"the compiler refuses what is no mutant: {errors}")
            alone += [together.pop(number) for number in sorted(refused)]
        return together, alone

    def _write(self, alone, together):
        """Writes the sources with these mutants, and returns where the body of each and its function stand: file, first and last line."""
        self._git("checkout", "--quiet", ".")
        places = {"body": {}, "function": {}}
        self.called = {}
        for file, chosen in alone.items():
            path = self.tree / file
            source = Source(path.read_text(encoding="utf-8"))
            path.write_text(source.changed(0, len(source.text), chosen[0]), encoding="utf-8")
        for file in {mutant["file"] for mutant in together.values()}:
            source = Source((self.tree / file).read_text(encoding="utf-8"))
            text, bodies, functions, called = source.with_bodies({number: mutant for number, mutant in together.items() if mutant["file"] == file})
            (self.tree / file).write_text(text, encoding="utf-8")
            places["body"].update({number: (file, *lines) for number, lines in bodies.items()})
            places["function"].update({number: (file, *lines) for number, lines in functions.items()})
            self.called.update(called)
        if together:
            with (self.folder / "src/lib.rs").open("a", encoding="utf-8") as library:
                library.write(SWITCH)
        return places

    def _cargo(self, *words):
        environment = {**os.environ, "CARGO_INCREMENTAL": "1", "CARGO_PROFILE_DEV_DEBUG": "false"}
        words = ["cargo", *words, "--package", self.package, "--message-format", "json", "--quiet"]
        done = subprocess.run(words, cwd=self.tree, env=environment, capture_output=True, text=True, check=False)
        return done, [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]

    def _errors(self):
        """Files and lines that the compiler complains about."""
        done, messages = self._cargo("check", "--lib")
        if done.returncode == 0:
            return []
        found = []
        for message in messages:
            if message["reason"] == "compiler-message" and message["message"]["level"] == "error":
                for span in message["message"]["spans"]:
                    while span is not None:
                        found.append((span["file_name"], span["line_start"]))
                        span = (span["expansion"] or {}).get("span")
        return found or [(done.stderr, 0)]

    def _built(self):
        """The crate's test programs."""
        done, messages = self._cargo("test", "--lib", "--bins", "--tests", "--no-run")
        if done.returncode != 0:
            sys.exit(f"the tests can't be built: {done.stderr} {done.stdout[-4000:]}")
        return [message["executable"] for message in messages if message["reason"] == "compiler-artifact" and message["profile"]["test"] and message["executable"]]

    def _passes(self, program, names, number, limit_s, variables):
        """Whether these tests of a program pass; it is ended at the first that fails."""
        threads = {"RUST_TEST_THREADS": "1", "RAYON_NUM_THREADS": "1"}
        environment = {**os.environ, "BULGE_MUTANT": str(number), "CARGO_MANIFEST_DIR": str(self.folder), **threads, **variables}
        begun = time.monotonic()
        with subprocess.Popen([program, "--exact", *names], cwd=self.folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as running:
            os.set_blocking(running.stdout.fileno(), False)
            printed = b""
            while (status := running.poll()) is None:
                printed += running.stdout.read() or b""
                if b"... FAILED" in printed or (limit_s is not None and time.monotonic() - begun > limit_s):
                    running.kill()
                    status = 1
                    break
                time.sleep(0.01)
        if status != 0:
            # What a property test writes down when it fails would help to catch the next mutant.
            self._git("clean", "--quiet", "--force", "-d", "crates")
        return status == 0


class Test(NamedTuple):
    """A test, how long it takes, and the first numbers of the mutated functions that it calls; None if nobody knows."""

    program: str
    name: str
    seconds: float
    calls: frozenset | None


def _standing_at(errors, places):
    return {number for file, line in errors for number, (its, first, last) in places.items() if file == its and first <= line <= last}


def _stem(program):
    return re.sub(r"-[0-9a-f]+$", "", Path(program).name)


class Source:
    """The text of a file, and where its lines begin."""

    def __init__(self, text):
        self.text = text
        self.lines = [0]
        for line in text.splitlines(keepends=True):
            self.lines.append(self.lines[-1] + len(line))

    def place(self, at):
        return self.lines[at["line"] - 1] + at["column"] - 1

    def span(self, span):
        return self.place(span["start"]), self.place(span["end"])

    def changed(self, start, end, mutant):
        """The text from `start` to `end` with the fault of a mutant."""
        first, last = self.span(mutant["span"])
        return f"{self.text[start:first]} {mutant['replacement']} {self.text[last:end]}"

    def with_bodies(self, mutants):
        """The text in which each function with mutants chooses among bodies, the lines of the mutants' bodies and of their functions, and for each mutant the
        first of its function."""
        spans = {number: self.span(mutant["function"]["span"]) for number, mutant in mutants.items()}
        # A function within a function is changed with the outer one.
        outer = {number: min(other for other in spans.values() if other[0] <= span[0] and span[1] <= other[1]) for number, span in spans.items()}
        text, at, bodies, functions, called = "", 0, {}, {}, {}
        for start, end in sorted(set(outer.values())):
            body = _brace(self.text, start)
            numbers = [number for number, span in outer.items() if span == (start, end)]
            listed = ", ".join(map(str, numbers))
            text += self.text[at:start]
            head = text.count("\n") + 1
            text += f"{self.text[start:body]}{{ match crate::mutant::chosen({min(numbers)}) {{ number if ![{listed}].contains(&number) => {self.text[body:end]}"
            for number in numbers:
                text += f"\n{number} => "
                first = text.count("\n") + 1
                text += self.changed(body, end, mutants[number])
                bodies[number] = (first, text.count("\n") + 1)
            text += "\n_ => unreachable!() } }"
            functions.update(dict.fromkeys(numbers, (head, text.count("\n") + 1)))
            called.update(dict.fromkeys(numbers, min(numbers)))
            at = end
        return text + self.text[at:], bodies, functions, called


def _brace(text, at):
    """Where the body of the function that begins at `at` opens: comments, attributes and arguments come before."""
    depth = 0
    while True:
        if match := re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\])*"', re.DOTALL).match(text, at):
            at = match.end()
            continue
        letter = text[at]
        if letter == "{" and depth == 0:
            return at
        depth += (letter in "([{") - (letter in ")]}")
        at += 1


if __name__ == "__main__":
    sys.exit(main())
