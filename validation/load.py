"""Loads the workbench, a sweep and a diagnosis, and prints what came of it: requests lost, memory, time.

    python validation/load.py --bulge target/release/bulge [--clients 50] [--seconds 60] [--points 100000000] [--rows 1000000] [--seed 1] [--only PART]

- `workbench`: clients that switch effects, move sliders, read comparisons, rows and shapes, and diagnose, all of one session at once. None may be left
  without an answer, no answer may be an error of the server, and the session is whole afterwards.
- `sweep`: two workers share the chunks of a grid of closed forms; one or the other is killed (SIGKILL) at random times and begun again, until all is done.
  Then every chunk has its hash, and rows here and there are those of a sweep of their own.
- `diagnosis`: so many rows of a braid with a hidden effect, which has to be named.

Memory is the largest that a process has had (VmHWM); where it counts, the same is done with a tenth, which must not need much less. Needs Linux and, for the
sweep, pyarrow. The exit status is 1 if anything failed.
"""

import argparse
import json
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
from pathlib import Path

FLAT = 1.5
"""Memory for ten times as much over that for once as much, beside what the rows themselves take."""
ROW = 500
"""Bytes that a row of measurements may take (`COMPARED` and `DIAGNOSED` of the library)."""
EFFECTS = ["end-taper", "bladder-elasticity", "coulomb-friction", "viscous-damping", "radius-error"]
SWEEP = """muscle = "ppam-2-r16"
outputs = ["force_f", "volume_v"]
[axes.contraction]
range = "0.5 %..limit"
points = {contraction}
[axes.slenderness]
range = "2..100"
points = {slenderness}
spacing = "log"
"""
SIDE = 10_000
"""Points along the contraction."""
PROTOCOL = """[noise]
force = "2 N"
[[block]]
shape = "loops"
pressures = ["2 bar", "3 bar", "4 bar", "5 bar"]
contraction = "1 %..18 %"
period = "40 s"
cycles = {cycles}
rows = 2500
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bulge", required=True, help="the program")
    parser.add_argument("--clients", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=60.0, help="how long the clients go on")
    parser.add_argument("--points", type=int, default=10**8, help="of the sweep")
    parser.add_argument("--rows", type=int, default=10**6, help="of the diagnosis")
    parser.add_argument("--seed", type=int, default=1, help="of what clients do, and of when workers are killed")
    parser.add_argument("--only", choices=["workbench", "sweep", "diagnosis"], help="one part")
    arguments = parser.parse_args()
    arguments.bulge = str(Path(arguments.bulge).resolve())
    parts = {"workbench": workbench, "sweep": sweep, "diagnosis": diagnosis}
    lines, failed = [], []
    for name, part in parts.items():
        if arguments.only in (None, name):
            with tempfile.TemporaryDirectory(prefix="bulge-load-") as folder:
                line, troubles = part(arguments, Path(folder))
            lines.append(line)
            failed += [f"{name}: {trouble}" for trouble in troubles]
    print("| load | done | time | largest memory | lost or wrong |\n|---|---|---|---|---|")
    print("\n".join(lines))
    for trouble in failed:
        print(trouble, file=sys.stderr)
    return 1 if failed else 0


def megabytes(pid):
    """The largest memory that a running process has had."""
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) / 1024
    return 0.0


class Watched:
    """A command, with the largest memory that it has had so far."""

    def __init__(self, words, folder):
        self.process = subprocess.Popen([str(word) for word in words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.most = 0.0
        self.said = ""
        threading.Thread(target=self._watch, daemon=True).start()

    def _watch(self):
        while self.process.poll() is None:
            try:
                self.most = max(self.most, megabytes(self.process.pid))
            except (OSError, ValueError):
                return
            time.sleep(0.05)

    def ends(self):
        """Waits for the end; the exit status."""
        self.said = self.process.communicate()[0]
        return self.process.returncode


def workbench(arguments, folder):
    """Clients of one session."""
    server = subprocess.Popen(
        [arguments.bulge, "open", "--no-browser", "--json", "--session", str(folder / "session")], stdout=subprocess.PIPE, text=True
    )
    address = json.loads(server.stdout.readline())["address"]
    state = {"answered": 0, "refused": 0, "diagnoses": 0}
    troubles, lock = [], threading.Lock()

    def ask(method, call, body=None, limit=300):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(address + call, data=data, method=method)
        try:
            with urllib.request.urlopen(request, timeout=limit) as answer:
                text, status = answer.read(), answer.status
        except urllib.error.HTTPError as error:
            text, status = error.read(), error.code
        with lock:
            state["answered"] += 1
            state["refused"] += status in (400, 404, 422)
            if status >= 500 or not text:
                troubles.append(f"{method} {call}: {status} {text[:200]!r}")
        return status, text

    def client(number):
        rng = random.Random(f"{arguments.seed}-{number}")
        end = time.monotonic() + arguments.seconds
        while time.monotonic() < end:
            what = rng.random()
            try:
                if what < 0.35:
                    chosen = rng.sample(EFFECTS, rng.randint(0, 3))
                    ask("PUT", "api/session", {"effects": [{"name": name} for name in chosen], "goes_on": rng.random() < 0.3})
                elif what < 0.6:
                    ask("GET", f"api/comparison?held_out={rng.randint(0, 1)}")
                elif what < 0.75:
                    ask("GET", rng.choice(["api/session", "api/rows.csv", "api/effects", "api/protocol"]))
                elif what < 0.85:
                    ask("GET", f"api/shape?pressure={rng.uniform(1e5, 4e5):.0f}&contraction={rng.uniform(0.0, 0.15):.3f}")
                elif what < 0.95:
                    ask("POST", rng.choice(["api/undo", "api/redo"]))
                else:
                    status, text = ask("POST", "api/diagnose")
                    ended = b"event: result" in text or b"event:result" in text or b"failed" in text
                    with lock:
                        state["diagnoses"] += 1
                        if status == 200 and not ended:
                            troubles.append(f"a diagnosis that never ended: {text[-200:]!r}")
            except (OSError, ValueError) as error:
                with lock:
                    troubles.append(f"client {number}: no answer: {error}")

    def crowd(count):
        clients = [threading.Thread(target=client, args=(number,)) for number in range(count)]
        for one in clients:
            one.start()
        for one in clients:
            one.join()

    start = time.monotonic()
    crowd(arguments.clients)
    first = megabytes(server.pid)
    crowd(arguments.clients)
    second, seconds = megabytes(server.pid), time.monotonic() - start
    status, text = ask("GET", "api/session")
    if status != 200 or not isinstance(json.loads(text), dict):
        troubles.append(f"the session afterwards: {status}")
    if second > FLAT * first:
        troubles.append(f"memory grew from {first:.0f} to {second:.0f} MB when the same was done again")
    server.send_signal(signal.SIGINT)
    if server.wait(timeout=60) not in (0, 130):
        troubles.append(f"the server ended with {server.returncode}")
    done = f"{state['answered']} requests of {arguments.clients} clients, {state['diagnoses']} of them diagnoses, {state['refused']} refused with a sentence"
    return f"| workbench | {done} | {seconds:.0f} s | {first:.0f} MB, again {second:.0f} MB | {len(troubles)} |", troubles


def sweep(arguments, folder):
    """Two workers that are killed."""
    import pyarrow.parquet as parquet

    rng, troubles = random.Random(arguments.seed), []
    rows = max(arguments.points // SIDE, 2)
    (folder / "sweep.toml").write_text(SWEEP.format(contraction=SIDE, slenderness=rows))
    chunks = -(-SIDE * rows // 65_536)
    halves = [f"0..{chunks // 2}", f"{chunks // 2}..{chunks}"]
    start, kills, most = time.monotonic(), 0, 0.0
    out = folder / "out"

    def worker(part):
        return Watched([arguments.bulge, "sweep", "sweep.toml", "--out", out, "--chunks", part, "--resume"], folder)

    workers = {part: worker(part) for part in halves}
    while workers:
        time.sleep(rng.uniform(0.5, 6.0))
        for part in list(workers):
            one = workers[part]
            if one.process.poll() is None:
                continue
            status = one.ends()
            most = max(most, one.most)
            if status == 0:
                del workers[part]
            elif status == -signal.SIGKILL:
                workers[part] = worker(part)
            else:
                troubles.append(f"worker {part} ended with {status}: {one.said[-500:]}")
                del workers[part]
        alive = [part for part in workers if workers[part].process.poll() is None]
        if alive and rng.random() < 0.7:
            workers[rng.choice(alive)].process.kill()
            kills += 1
    end = Watched([arguments.bulge, "sweep", "sweep.toml", "--out", out, "--resume"], folder)
    if end.ends():
        troubles.append(f"completing it ended with {end.process.returncode}: {end.said[-500:]}")
    most, seconds = max(most, end.most), time.monotonic() - start
    files = sorted((out / "points").glob("*.parquet"))
    count = sum(parquet.ParquetFile(file).metadata.num_rows for file in files)
    if count != SIDE * rows or len(files) != chunks:
        troubles.append(f"{count} points in {len(files)} files, not {SIDE * rows} in {chunks}")
    left = [path.name for path in (out / "points").iterdir() if path.suffix != ".parquet"]
    if left:
        troubles.append(f"left behind: {left[:5]}")
    # The same chunk of a sweep that nobody disturbed has the same bytes.
    some = rng.sample(range(chunks), min(3, chunks))
    for chunk in some:
        alone = folder / f"alone-{chunk}"
        words = [arguments.bulge, "sweep", "sweep.toml", "--out", alone, "--chunks", f"{chunk}..{chunk + 1}"]
        if Watched(words, folder).ends():
            troubles.append(f"chunk {chunk} on its own failed")
            continue
        [own] = (alone / "points").glob("*.parquet")
        if own.read_bytes() != (out / "points" / own.name).read_bytes():
            troubles.append(f"chunk {chunk} has other bytes than on its own")
    return f"| sweep | {count} points in {len(files)} chunks, two workers, {kills} kills | {seconds:.0f} s | {most:.0f} MB | {len(troubles)} |", troubles


def diagnosis(arguments, folder):
    """Many rows, and a tenth of them."""
    troubles, memory = [], []
    for number, rows in enumerate((arguments.rows // 10, arguments.rows)):
        (folder / "protocol.toml").write_text(PROTOCOL.format(cycles=max(rows // 10_000, 1)))
        trial = folder / f"trial-{number}"
        words = [arguments.bulge, "simulate", "dmsp-20-250", "--protocol", "protocol.toml", "--with", "coulomb-friction=14 N", "--out", trial]
        made = Watched(words, folder)
        if made.ends():
            return "", [f"simulate: {made.said}"]
        start = time.monotonic()
        found = Watched([arguments.bulge, "diagnose", trial / "data.csv", "--muscle", trial / "muscle.toml", "--json"], folder)
        if found.ends():
            return "", [f"diagnose: {found.said[-500:]}"]
        seconds = time.monotonic() - start
        answer = json.loads(found.said[found.said.index("{") :])
        names = [missing["effect"] for missing in answer["missing"]]
        count = answer["data"]["rows"]
        if names != ["coulomb-friction"]:
            troubles.append(f"{count} rows: {answer['verdict']}, {names}")
        memory.append((count, found.most))
    (few, small), (many, large) = memory
    if large - small > ROW * (many - few) / 2**20 * FLAT:
        troubles.append(f"{many} rows take {large:.0f} MB, {few} rows {small:.0f} MB")
    return f"| diagnosis | {many} rows | {seconds:.0f} s | {large:.0f} MB ({small:.0f} MB for {few} rows) | {len(troubles)} |", troubles


if __name__ == "__main__":
    sys.exit(main())
