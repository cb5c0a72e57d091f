"""Sweeps and suites of diagnoses on Dask: a LocalCluster on one machine, or any cluster that ``dask.distributed.Client`` talks to (Slurm through
dask-jobqueue, Kubernetes, ...).

The engine is Dask's. What is here is what a task is: a range of chunks of a sweep, or one diagnosis. Chunks are pure functions of their number, and
each is written whole under its own name, so tasks may die, be repeated, or run twice without harm. What counts as done stands on disk: the promise
that is written after a chunk's file, with its hash.

    from dask.distributed import Client
    import bulge.distributed

    bulge.distributed.sweep("sweep.toml", "result", Client())           # the same bytes as `bulge sweep sweep.toml --out result`

Where workers have all cores of a machine, Dask's own watch over them costs some per cent. It can be set to rest before a LocalCluster starts:
``dask.config.set({"distributed.worker.profile.enabled": False, "distributed.admin.tick.interval": "500ms"})``.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import os
import posixpath
import time
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from bulge import _bulge
from bulge.inference import Diagnosis, diagnose
from bulge.measurements import read
from bulge.muscle import Muscle
from bulge.optional import need
from bulge.progress import Progress, callback
from bulge.results import Result
from bulge.sweeps import Sweep, as_sweep, write_table
from bulge.texts import count, write_whole

#: Seconds that a task should take: what a scheduler costs, some milliseconds per task, is then about a hundredth.
TASK_SECONDS = 0.5
#: How often a task is handed out again that Dask has given up, each time after the deaths of 4 workers (its setting ``allowed-failures``, and 1).
MOST_RETURNS = 4
#: Stores in which a file that is put appears whole or not at all.
WHOLE = {"s3", "s3a", "gs", "gcs", "az", "abfs", "adl", "oss"}
#: How often the threads of the cluster are counted.
COUNT_SECONDS = 1.0
#: Tasks in flight per thread of the cluster: enough that no worker waits, few enough that a scheduler holds 10^9 points easily.
IN_FLIGHT = 4


def sweep(
    spec: Any,
    folder: str | os.PathLike[str],
    client: Any = None,
    *,
    resume: bool = False,
    csv: bool = False,
    chunks_per_task: int | None = None,
    storage_options: Mapping[str, Any] | None = None,
    progress: Progress = None,
) -> Result:
    """Runs a sweep on a Dask cluster: the same bytes as ``bulge sweep`` on one machine, whatever the number of workers.

    ``spec`` is a sweep file, its text or a :class:`bulge.Sweep`; ``folder`` is one that all workers share, or a URL of an fsspec store
    (``"s3://bucket/run"``, with ``storage_options``). ``client`` is a ``dask.distributed.Client`` [default: the current one]. ``chunks_per_task``
    is chosen so that a task takes about half a second. ``resume`` goes on with what is there. A worker that dies costs the chunks in flight; a range
    whose workers die again and again is named and given up.

    Returns the document: points, infeasible, chunks, computed, is_complete, seconds, tasks, chunks_per_task; and the table, if the sweep wishes one.
    """
    plan = as_sweep(spec)
    if not plan.n_points:
        raise _bulge.InputError("this sweep has no points, only a table: bulge.sweep builds it on one machine")
    place = os.fspath(folder)
    if chunks_per_task is not None:
        count("chunks_per_task", chunks_per_task, 1)
    store: _Folder | _Store
    if "://" in place:
        store = _Store(plan, place, csv, dict(storage_options or {}))
    elif storage_options:
        raise _bulge.InputError(f"storage_options are those of a store, such as s3://bucket/run: {place} is a folder")
    else:
        store = _Folder(plan, os.path.abspath(place), csv)
    with _connected(client) as client:
        return _sweep(plan, place, store, client, resume, chunks_per_task, progress)


def _sweep(
    plan: Sweep, place: str, store: _Folder | _Store, client: Any, resume: bool, chunks_per_task: int | None, progress: Progress
) -> Result:
    started = time.monotonic()
    store.begin(resume)
    threads = _Threads(client)
    pace = _Pace(plan.n_chunks, threads, chunks_per_task)
    computed = finished = tasks = 0
    with callback(progress, plan.name) as told:
        for (a, b), answer in _run(client, store.task(), pace.ranges(), f"bulge-sweep-{_slug(plan.name)}", threads):
            pace.hear(b - a, answer)
            store.take(answer)
            computed += answer["computed"]
            finished += b - a
            tasks += 1
            if told is not None:
                told(finished / plan.n_chunks, "points")
    document = store.finish()
    document |= {"computed": computed, "seconds": time.monotonic() - started, "tasks": tasks, "chunks_per_task": pace.longest}
    if plan.has_table:
        document["table"] = store.table()
    return Result({"name": plan.name, "folder": place, **document})


def suite(
    cases: str | os.PathLike[str],
    results: str | os.PathLike[str],
    client: Any = None,
    *,
    again: bool = False,
    progress: Progress = None,
    **options: Any,
) -> Result:
    """Diagnoses every case of a suite of hidden effects on a Dask cluster.

    ``cases`` is a folder of folders, each with data.csv and muscle.toml; ``results`` gets ``<case>.json``, the document of ``bulge diagnose --json``
    with paths as given here, and cases that have one are skipped unless ``again``. ``options`` are those of :func:`bulge.diagnose`. Returns the
    document: cases, answered, failed (a sentence for each case that has none), seconds.
    """
    started = time.monotonic()
    folders = sorted(path.parent for path in Path(cases).glob("*/muscle.toml") if (path.parent / "data.csv").exists())
    if not folders:
        raise _bulge.InputError(f"{os.fspath(cases)} holds no folder with data.csv and muscle.toml")
    into = Path(results)
    into.mkdir(parents=True, exist_ok=True)
    waiting = [folder for folder in folders if again or not (into / f"{folder.name}.json").exists()]
    # The longest files first, so that none is left to run alone at the end.
    waiting.sort(key=lambda folder: -(folder / "data.csv").stat().st_size)
    failed: dict[str, str] = {}
    with _connected(client) as client, callback(progress, "suite") as told:
        names = [str(folder) for folder in waiting]
        for done, (name, answer) in enumerate(_run(client, _Case(options), names, "bulge-diagnose", raises=False), 1):
            file = into / f"{Path(name).name}.json"
            if isinstance(answer, str):
                write_whole(file, answer.encode())
            else:
                # An answer of an earlier run would pass for one of this.
                file.unlink(missing_ok=True)
                failed[file.stem] = f"{answer}" if isinstance(answer, _bulge.BulgeError) else f"{type(answer).__name__}: {answer}"
            if told is not None:
                told(done / len(waiting), file.stem)
    return Result({
        "cases": len(folders),
        "answered": len(waiting) - len(failed),
        "failed": failed,
        "seconds": time.monotonic() - started,
    })


def diagnose_all(cases: Iterable[Mapping[str, Any]], client: Any = None, *, progress: Progress = None) -> list[Diagnosis]:
    """Diagnoses on a Dask cluster: ``cases`` are the arguments of :func:`bulge.diagnose` by name, such as ``{"data": ..., "muscle": ...}``.

    Measurements and muscles travel as texts, files by their names. Answers come in the order of the cases, with their numbers and without their
    reports (:meth:`Diagnosis.report`), which stay where they were made; the first error is raised.
    """
    orders = [{**case, "data": read(case["data"])} for case in cases]
    found: dict[int, Diagnosis] = {}
    with _connected(client) as client, callback(progress, "diagnose") as told:
        for (place, _), answer in _run(client, _ordered, enumerate(orders), "bulge-diagnose"):
            found[place] = answer
            if told is not None:
                told(len(found) / len(orders), "diagnoses")
    return [found[place] for place in range(len(orders))]


class _Case:
    """The diagnosis of a case's folder, as a task."""

    def __init__(self, options: Mapping[str, Any]) -> None:
        self.options = dict(options)

    def __call__(self, folder: str) -> str:
        muscle = Muscle.from_toml(os.path.join(folder, "muscle.toml"))
        # A task is one thread's work: the cluster has as many tasks as threads.
        found = diagnose(os.path.join(folder, "data.csv"), muscle, **{"threads": 1, **self.options})
        return found.to_json() + "\n"


def _ordered(order: tuple[int, dict[str, Any]]) -> Diagnosis:
    """One diagnosis of a list, as a task."""
    return diagnose(**{"threads": 1, **order[1]})


class _Threads:
    """Threads of a cluster: it may grow, and shrink, while it works."""

    def __init__(self, client: Any) -> None:
        self.client, self.asked, self.number = client, -math.inf, 1

    def __call__(self) -> int:
        now = time.monotonic()
        if now - self.asked > COUNT_SECONDS:
            self.number, self.asked = max(1, sum(self.client.nthreads().values())), now
        return self.number


class _Pace:
    """How many chunks make a task: one at first, then as many as take TASK_SECONDS by the times of those that are done, and fewer and fewer
    towards the end, so that all threads end together."""

    def __init__(self, n_chunks: int, threads: Callable[[], int], chunks: int | None) -> None:
        self.n_chunks, self.threads = n_chunks, threads
        self.chunks, self.fixed = chunks or 1, chunks is not None
        #: Most chunks that a task had.
        self.longest = 0

    def ranges(self) -> Iterator[tuple[int, int]]:
        """Ranges of chunks, each as long as is known to be right when it is asked for."""
        start = 0
        while start < self.n_chunks:
            left = self.n_chunks - start
            # Half of what would be each thread's share of the rest.
            share = left if self.fixed else math.ceil(left / (2 * self.threads()))
            end = start + min(self.chunks, share, left)
            self.longest = max(self.longest, end - start)
            yield start, end
            start = end

    def hear(self, chunks: int, answer: dict[str, Any]) -> None:
        """The time of a task. One whose chunks were there took none, which says nothing of the others."""
        if not self.fixed and answer["computed"] == chunks:
            self.chunks = math.ceil(TASK_SECONDS * chunks / max(answer["seconds"], 1e-6))


class _Folder:
    """A sweep in a folder that all workers share."""

    def __init__(self, plan: Sweep, folder: str, csv: bool) -> None:
        self.plan, self.folder, self.csv = plan, folder, csv

    def begin(self, resume: bool) -> None:
        self.plan._native.begin(self.folder, resume, self.csv)

    def task(self) -> Callable[[tuple[int, int]], dict[str, Any]]:
        return _FolderTask(self.plan, self.folder, self.csv)

    def take(self, answer: dict[str, Any]) -> None:
        pass

    def finish(self) -> dict[str, Any]:
        """The manifest. Each chunk was written, or read and its hash compared, by a task of this run."""
        text = self.plan._native.complete(self.folder)
        document: dict[str, Any] = json.loads(text or self.plan._native.run(self.folder, True, None, self.csv, [], None, None))
        return document

    def table(self) -> dict[str, Any]:
        return write_table(self.plan, Path(self.folder))


class _FolderTask:
    """A range of chunks into a shared folder."""

    def __init__(self, plan: Sweep, folder: str, csv: bool) -> None:
        self.plan, self.folder, self.csv = plan, folder, csv

    def __call__(self, chunks: tuple[int, int]) -> dict[str, Any]:
        started = time.monotonic()
        document: dict[str, Any] = json.loads(self.plan._native.run(self.folder, True, chunks, self.csv, [], 1, None))
        return {**document, "seconds": time.monotonic() - started}


class _Store:
    """A sweep in an fsspec store: the same names, each file written under another name and moved where the store can, else put at once."""

    def __init__(self, plan: Sweep, url: str, csv: bool, options: dict[str, Any]) -> None:
        self.plan, self.url, self.csv, self.options = plan, url, csv, options
        self.promises: dict[int, str] = {}

    def begin(self, resume: bool) -> None:
        files = _Files(self.url, self.options)
        before, now = files.get("plan.json"), self.plan._native.canonical()
        if before is None:
            files.put("plan.json", now.encode())
        elif before.decode() != now:
            raise _bulge.InputError(f"{self.url} holds another sweep: take another place, or undo the change")
        elif not resume:
            raise _bulge.InputError(f"{self.url} holds this sweep already: add resume=True to go on with it, or take another place")

    def task(self) -> Callable[[tuple[int, int]], dict[str, Any]]:
        return _StoreTask(self.plan, self.url, self.csv, self.options)

    def take(self, answer: dict[str, Any]) -> None:
        self.promises.update(answer["promises"])

    def finish(self) -> dict[str, Any]:
        texts = [self.promises[chunk] for chunk in range(self.plan.n_chunks)]
        _Files(self.url, self.options).put("manifest.json", self.plan._native.manifest(texts).encode())
        promises = [json.loads(text) for text in texts]
        points, infeasible = (sum(promise[key] for promise in promises) for key in ("points", "infeasible"))
        return {"points": points, "infeasible": infeasible, "chunks": self.plan.n_chunks, "damaged": [], "is_complete": True}

    def table(self) -> dict[str, Any]:
        content, description, is_met = self.plan._native.table(None)
        files = _Files(self.url, self.options)
        files.put("table.bulge", content)
        files.put("table.json", description.encode())
        return {**json.loads(description), "is_met": is_met}


class _StoreTask:
    """A range of chunks into a store."""

    def __init__(self, plan: Sweep, url: str, csv: bool, options: dict[str, Any]) -> None:
        self.plan, self.url, self.csv, self.options = plan, url, csv, options

    def __call__(self, chunks: tuple[int, int]) -> dict[str, Any]:
        started = time.monotonic()
        files = _Files(self.url, self.options)
        promises, computed = {}, 0
        for chunk in range(*chunks):
            there = self._standing(files, chunk)
            if there is None:
                # A CSV file that is there already must not stay as it was.
                csv_too = self.csv or files.get(f"csv/{chunk:06}.csv") is not None
                content, csv, there = self.plan._native.piece(chunk, csv_too)
                files.put(f"points/{chunk:06}.parquet", content)
                if csv is not None:
                    files.put(f"csv/{chunk:06}.csv", csv.encode())
                # The promise last: it makes the chunk count.
                files.put(f"chunks/{chunk:06}.json", there.encode())
                computed += 1
            promises[chunk] = there
        return {"promises": promises, "computed": computed, "seconds": time.monotonic() - started}

    def _standing(self, files: _Files, chunk: int) -> str | None:
        """The promise of a chunk that is there, if its files have the hashes that it says."""
        text = files.get(f"chunks/{chunk:06}.json")
        if text is None:
            return None
        try:
            promise = json.loads(text)
            key = hashlib.sha256(self.plan._native.canonical().encode()).hexdigest()
            kept = [(f"points/{chunk:06}.parquet", promise["sha256"])]
            if self.csv or "csv_sha256" in promise:
                kept.append((f"csv/{chunk:06}.csv", promise["csv_sha256"]))
            if promise["plan"] != key or promise["chunk"] != chunk:
                return None
        except (ValueError, KeyError, TypeError):
            return None
        for name, sha256 in kept:
            content = files.get(name)
            if content is None or hashlib.sha256(content).hexdigest() != sha256:
                return None
        return text.decode()


class _Files:
    """Files below a URL."""

    def __init__(self, url: str, options: dict[str, Any]) -> None:
        fsspec = need("fsspec", "a store", "distributed")
        try:
            self.system, self.root = fsspec.core.url_to_fs(url, **options)
        except ValueError as error:
            raise _bulge.InputError(f"{url}: {error}") from None
        protocols = self.system.protocol
        known = {protocols} if isinstance(protocols, str) else set(protocols)
        # Object stores show a file when it is whole; elsewhere it is moved into place.
        self.moves = not known & WHOLE
        if "memory" in known:
            raise _bulge.InputError(f"{url}: the memory of one process is no place for the work of several; take a folder or a store")

    def get(self, name: str) -> bytes | None:
        try:
            content: bytes = self.system.cat_file(posixpath.join(self.root, name))
        except FileNotFoundError:
            return None
        return content

    def put(self, name: str, content: bytes) -> None:
        path = posixpath.join(self.root, name)
        self.system.makedirs(posixpath.dirname(path), exist_ok=True)
        if not self.moves:
            self.system.pipe_file(path, content)
            return
        part = posixpath.join(posixpath.dirname(path), f".unfinished-{uuid.uuid4().hex}")
        try:
            self.system.pipe_file(part, content)
            self.system.mv(part, path)
        except BaseException:
            with contextlib.suppress(Exception):
                self.system.rm_file(part)
            raise


def _run(
    client: Any,
    task: Callable[[Any], Any],
    orders: Iterable[Any],
    name: str,
    threads: Callable[[], int] | None = None,
    *,
    raises: bool = True,
) -> Iterator[tuple[Any, Any]]:
    """Orders and their answers, as they come; without ``raises``, the exception of an order that has none. At most IN_FLIGHT tasks per thread are
    with the scheduler; those that it gives up because workers died are handed out again, each MOST_RETURNS times."""
    distributed = need("distributed", "a distributed run", "distributed")
    threads = threads or _Threads(client)
    waiting = iter(orders)
    #: Orders with the scheduler, each with the number of times that it was given back.
    running: dict[Any, tuple[Any, int]] = {}
    stamp = f"{name}-{uuid.uuid4().hex}"
    number = 0

    def submit(order: Any, returns: int = 0) -> Any:
        nonlocal number
        number += 1
        future = client.submit(_call, task, order, key=f"{stamp}-{number}", pure=False)
        running[future] = (order, returns)
        return future

    try:
        first = [submit(order) for _, order in zip(range(IN_FLIGHT * threads()), waiting)]
        completed = distributed.as_completed(first, loop=client.loop, raise_errors=False)
        for future in completed:
            order, returns = running.pop(future)
            error: Any = None
            if future.status == "finished":
                answer = future.result()
                future.release()
            else:
                # A cancelled task was lost with a worker; nothing was wrong with it.
                error = answer = future.exception() if future.status == "error" else None
                if error is None or isinstance(error, distributed.KilledWorker):
                    if returns < MOST_RETURNS:
                        completed.add(submit(order, returns + 1))
                        continue
                    error = answer = _bulge.BulgeError(
                        f"{order} was given up: the workers that it ran on died again and again; look at their logs, and give them more memory"
                    )
                if raises:
                    raise error
            while len(running) < IN_FLIGHT * threads() and (following := next(waiting, _END)) is not _END:
                completed.add(submit(following))
            yield order, answer
    finally:
        client.cancel(list(running))


_END = object()


def _call(task: Callable[[Any], Any], order: Any) -> Any:
    return task(order)


@contextlib.contextmanager
def _connected(client: Any) -> Iterator[Any]:
    """A client: the one given, or the current one. Within a task the thread is given back to the worker while it waits for others."""
    distributed = need("distributed", "a distributed run", "distributed")
    if client is None:
        try:
            client = distributed.get_client()
        except ValueError:
            raise _bulge.InputError("no Dask cluster is known: give a client, such as dask.distributed.Client()") from None
    if getattr(client, "asynchronous", False):
        raise _bulge.InputError("this client is asynchronous: give one that waits, dask.distributed.Client(..., asynchronous=False)")
    try:
        distributed.get_worker()
    except ValueError:
        yield client
        return
    distributed.secede()
    try:
        yield client
    finally:
        distributed.rejoin()


def _slug(name: str) -> str:
    return "".join(c if c.isalnum() else "-" for c in name)[:40]
