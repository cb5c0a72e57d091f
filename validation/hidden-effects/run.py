"""Runs `bulge diagnose --json`, or another command, on the cases of a suite.

    python run.py DIR RESULTS --bulge PATH [--command diagnose] [--limit SECONDS] [--jobs 2] [--only REGEX] [--again]
        [--among-truth]

A case is a folder with a truth.json; its file `args` holds the arguments of the command, one a line, else these are `data.csv --muscle muscle.toml`.
RESULTS/<case>.json is the answer, times.json the seconds of each case, inputs.json a checksum of the program and the files that it answered on,
failures.json what the program said where there is no answer. A case is skipped if this program has answered on these files already, unless --again
is given. With --among-truth the hidden effects are the only ones that are looked for: what the program can say of them at best; cases that hide none of
the catalogue are left out. Each case runs on one thread; the cases are what runs in parallel. Every file appears whole or not at all. Failures are listed at the end,
and make the exit status 1; after Ctrl-C (exit status 130) the same command goes on where it stopped.
"""

import argparse
import contextlib
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

PART = ".part"
USUAL = ["data.csv", "--muscle", "muscle.toml"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the cases")
    parser.add_argument("results", type=Path, metavar="RESULTS", help="folder of the answers")
    parser.add_argument("--bulge", default="bulge", help="the program to run")
    parser.add_argument("--command", default="diagnose", help="what the program is to do")
    parser.add_argument("--limit", type=float, help="seconds after which a case has failed [default: none]")
    parser.add_argument("--jobs", type=int, default=2, help="cases at a time")
    parser.add_argument("--only", default="", help="regular expression that the names of the cases must contain")
    parser.add_argument("--again", action="store_true", help="run cases that are answered already")
    parser.add_argument("--among-truth", action="store_true", help="look for the hidden effects only")
    arguments = parser.parse_args()
    program = shutil.which(arguments.bulge)
    if program is None:
        parser.error(f"{arguments.bulge!r} is no program; say where it is: --bulge PATH")
    cases = sorted(p.parent for p in arguments.folder.glob("*/truth.json") if re.search(arguments.only, p.parent.name))
    if arguments.among_truth:
        cases = [case for case in cases if _hidden(case)]
    if not cases:
        parser.error(f"{arguments.folder} holds no case called like {arguments.only!r}")
    # A polite request to end is Ctrl-C.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    arguments.results.mkdir(parents=True, exist_ok=True)
    run = Run(os.path.abspath(program), arguments.results, arguments.command, arguments.limit, arguments.among_truth)
    try:
        return run.all(cases, arguments.jobs, arguments.again)
    except KeyboardInterrupt:
        print("stopped; the same command goes on from here", file=sys.stderr)
        return 130


class Run:
    """A program at work on cases: what it answered, how long that took, what is running."""

    def __init__(self, program, results, command, limit, among_truth=False):
        self.program, self.results, self.command, self.limit = program, results, command, limit
        self.among_truth = among_truth
        self.checksum = hashlib.sha256(Path(program).read_bytes()).hexdigest()
        self.times, self.inputs = _numbers(results / "times.json"), _numbers(results / "inputs.json")
        self.failures = _numbers(results / "failures.json")
        self.running, self.stopping = set(), threading.Event()

    def all(self, cases, jobs, again):
        """Runs the cases that are not answered; the exit status."""
        started, failed = time.monotonic(), []
        waiting = [case for case in cases if again or not self._answered(case)]
        # The longest files first, so that none is left to run alone at the end.
        waiting.sort(key=lambda case: -sum(file.stat().st_size for file in _inputs(case)))
        with ThreadPoolExecutor(max_workers=jobs) as pool:
            tasks = {pool.submit(self._diagnose, case): case for case in waiting}
            try:
                for done, task in enumerate(as_completed(tasks), 1):
                    self._note(tasks[task], *task.result(), failed)
                    if done % 50 == 0:
                        print(f"{done} of {len(waiting)} cases, {time.monotonic() - started:.0f} s", file=sys.stderr)
            except BaseException:
                self._stop(pool)
                raise
        for message in sorted(failed):
            print(message, file=sys.stderr)
        there = f"{len(cases) - len(waiting)} were there already, " if len(waiting) < len(cases) else ""
        print(f"{len(cases)} cases in {time.monotonic() - started:.0f} s, {there}{len(failed)} failed")
        return 1 if failed else 0

    def _answered(self, case):
        return (self.results / f"{case.name}.json").exists() and self.inputs.get(case.name) == self._fingerprint(case)

    def _fingerprint(self, case):
        """Checksum of the program and of what it reads."""
        digest = hashlib.sha256((self.checksum + "among truth" * self.among_truth).encode())
        for file in _inputs(case):
            digest.update(hashlib.sha256(file.read_bytes()).digest())
        return digest.hexdigest()

    def _diagnose(self, case):
        """Seconds, and what went wrong or None."""
        words = (case / "args").read_text(encoding="utf-8").splitlines() if (case / "args").exists() else USUAL
        among = ["--among", ",".join(_hidden(case))] if self.among_truth else []
        command = [self.program, self.command, *words, *among, "--json"]
        started = time.monotonic()
        # A session of its own: Ctrl-C reaches this program, which then ends the others.
        process = subprocess.Popen(
            command,
            cwd=case,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={**os.environ, "RAYON_NUM_THREADS": "1"},
            start_new_session=True,
        )
        self.running.add(process)
        if self.stopping.is_set():
            process.terminate()
        try:
            answer, said = process.communicate(timeout=self.limit)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            self.running.discard(process)
            return time.monotonic() - started, f"no answer within {self.limit:g} s"
        self.running.discard(process)
        seconds = time.monotonic() - started
        problem = _problem(process.returncode, answer, said)
        if problem is None:
            _write(self.results / f"{case.name}.json", answer)
        return seconds, problem

    def _note(self, case, seconds, problem, failed):
        """Enters a case in the tables. An earlier answer doesn't outlive a failure."""
        if problem is None:
            self.times[case.name], self.inputs[case.name] = round(seconds, 3), self._fingerprint(case)
            self.failures.pop(case.name, None)
        else:
            failed.append(f"{case.name}: {problem}")
            self.failures[case.name] = problem
            (self.results / f"{case.name}.json").unlink(missing_ok=True)
            self.times.pop(case.name, None)
            self.inputs.pop(case.name, None)
        for name, table in (("times.json", self.times), ("inputs.json", self.inputs), ("failures.json", self.failures)):
            _write(self.results / name, (json.dumps(table, indent=1, sort_keys=True) + "\n").encode())

    def _stop(self, pool):
        self.stopping.set()
        pool.shutdown(wait=False, cancel_futures=True)
        for process in list(self.running):
            with contextlib.suppress(ProcessLookupError):
                process.terminate()


def _hidden(case):
    """Names of the hidden effects that the catalogue has."""
    hidden = json.loads((case / "truth.json").read_text(encoding="utf-8"))["hidden"]
    return [entry["effect"] for entry in hidden if entry["family"]]


def _inputs(case):
    """What the program may read."""
    return sorted(file for file in case.iterdir() if file.is_file() and file.name not in ("truth.json", "unseen.csv"))


def _problem(status, answer, said):
    """What went wrong, in a line; None if the answer is a document."""
    if status < 0:
        return f"ended by {signal.Signals(-status).name}"
    if status > 0:
        return f"exit status {status}: {' '.join(said.decode('utf-8', 'replace').split()) or 'no message'}"
    try:
        json.loads(answer)
    except ValueError as error:
        return f"the answer is no JSON: {error}"
    return None


def _numbers(file):
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}


def _write(file, content):
    """The whole file, or the one that was there before."""
    part = file.with_name(file.name + PART)
    try:
        part.write_bytes(content)
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)


if __name__ == "__main__":
    sys.exit(main())
