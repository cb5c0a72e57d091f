"""Figures of sweeps on Dask, on one machine:

    pip install "bulge[distributed]"
    python crates/python/measure_distributed.py [--points 10000000] [--rounds 3] [--kills 5] [--folder DIR] [--as-shipped]

Two workers against one, on a LocalCluster with one thread each and no other alive; what a task costs the scheduler; a run in which workers are killed
(SIGKILL) while it goes on, against one in peace, byte by byte. The folder needs about 75 bytes per point.

Two workers on two cores leave none to Dask's own threads, which sample the stacks of its workers and watch its event loops 50 to 100 times a second:
these two habits are set to rest here (QUIET), unless --as-shipped.
"""

import argparse
import contextlib
import hashlib
import logging
import os
import random
import shutil
import signal
import statistics
import tempfile
import threading
import time
from pathlib import Path

import dask
from dask.distributed import Client, LocalCluster

import bulge
import bulge.distributed

QUIET = {"distributed.worker.profile.enabled": False, "distributed.admin.tick.interval": "500ms"}

TEXT = """
name = "pleated family"
muscle = "ppam-2-r16"
pressure = "1 bar"
outputs = ["force_f", "volume_v"]
design = "grid"

[axes.contraction]
range = "0.5 %..limit"
points = 1000

[axes.slenderness]
range = "2..100"
points = {muscles}
spacing = "log"
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=10_000_000)
    parser.add_argument("--kills", type=int, default=5)
    parser.add_argument("--rounds", type=int, default=3, help="of one worker and two, in turn")
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--as-shipped", action="store_true", help="Dask's own settings")
    arguments = parser.parse_args()
    if not arguments.as_shipped:
        dask.config.set(QUIET)
    plan = bulge.Sweep(TEXT.format(muscles=max(1, arguments.points // 1000)))
    print(plan)
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
        folder = Path(folder)
        seconds, tasks = {1: [], 2: []}, {}
        for number in range(arguments.rounds):
            for n in seconds:
                with _cluster(n) as client:
                    place = folder / f"{n}-{number}"
                    found = bulge.distributed.sweep(plan, place, client)
                seconds[n].append(found.seconds)
                tasks[n] = found.tasks
                print(f"  {n} worker(s): {found.seconds:.2f} s, {found.tasks} tasks, {found.points / found.seconds / n:.3g} points per second and worker")
                if place.name != "2-0":
                    shutil.rmtree(place)
        one, two = (min(seconds[n]) for n in (1, 2))
        middle = statistics.median(seconds[1]) / statistics.median(seconds[2])
        print(f"two workers are {one / two:.2f} times as fast as one by the best runs, {middle:.2f} by those in the middle\n")
        with _cluster(1) as client:
            cost = _cost_of_a_task(client)
        per_task = 2 * statistics.median(seconds[2]) / tasks[2]
        print(f"a task costs the scheduler {1e3 * cost:.1f} ms, and takes {per_task:.2f} s: {100 * cost / per_task:.2f} %\n")
        with _cluster(2) as client:
            killer = _Killer(client, arguments.kills, two)
            killer.start()
            started = time.monotonic()
            again = bulge.distributed.sweep(plan, folder / "killed", client)
            killer.stop()
            print(f"{killer.done} workers killed: {time.monotonic() - started:.2f} s, complete: {again.is_complete}")
        peace, war = _hashes(folder / "2-0"), _hashes(folder / "killed")
        print(f"the same bytes: {peace == war} ({len(peace)} files)")
        plan.run(folder / "alone")
        print(f"the same bytes as without Dask: {peace == _hashes(folder / 'alone')}")
        assert peace and peace == war and killer.done == arguments.kills


@contextlib.contextmanager
def _cluster(workers):
    """A client of a cluster of its own, whose workers have imported bulge."""
    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None, silence_logs=logging.CRITICAL) as cluster, Client(cluster) as client:
        _warm(client)
        yield client


def _warm(client):
    """Workers have imported bulge."""
    for future in client.map(_nothing, range(8), pure=False):
        future.result()


def _nothing(_):
    import bulge.distributed  # noqa: F401


def _cost_of_a_task(client, count=1000):
    started = time.monotonic()
    client.gather(client.map(_nothing, range(count), pure=False))
    return (time.monotonic() - started) / count


class _Killer(threading.Thread):
    """Kills a random worker at random moments of a run."""

    def __init__(self, client, kills, seconds):
        super().__init__(daemon=True)
        self.client, self.kills, self.pause = client, kills, seconds / (kills + 1)
        self.done, self.stopped = 0, threading.Event()

    def run(self):
        generator = random.Random(1)
        while self.done < self.kills and not self.stopped.wait(self.pause * generator.uniform(0.5, 1.0)):
            pids = list(self.client.run(os.getpid).values())
            if pids:
                os.kill(generator.choice(pids), signal.SIGKILL)
                self.done += 1

    def stop(self):
        self.stopped.set()
        self.join()


def _hashes(folder):
    files = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != ".lock")
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


if __name__ == "__main__":
    main()
