"""Sweeps of families of muscles: into a folder of Parquet files, and into a certified table."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from bulge import _bulge
from bulge.optional import need
from bulge.progress import Progress, callback
from bulge.results import Result
from bulge.texts import count, read_text, write_whole
from bulge.tables import Table


def sweep_example() -> str:
    """A sweep file with every key."""
    return _bulge.sweep_example()


class Sweep:
    """A sweep file, read and checked: axes, design, outputs, chunks.

    ``Sweep.read("sweep.toml")``, or ``Sweep(text)`` of such a file (:func:`bulge.sweep_example` shows every key). It can be pickled, with its
    muscle: processes that don't see the muscle file run the same chunks.
    """

    __slots__ = ("_native",)

    def __init__(self, text: str, *, folder: str | os.PathLike[str] | None = None) -> None:
        self._native = _bulge.Sweep.from_text(text, "sweep", None if folder is None else os.fspath(folder))

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Sweep:
        """From a sweep file."""
        text = read_text(path)
        return cls._of(_bulge.Sweep.from_text(text, os.fspath(path), os.fspath(Path(path).parent)))

    @classmethod
    def _of(cls, native: _bulge.Sweep) -> Sweep:
        made = cls.__new__(cls)
        made._native = native
        return made

    @property
    def name(self) -> str:
        """Its name."""
        return self._native.name

    @property
    def n_points(self) -> int:
        """Number of points; 0 if only a table is wanted."""
        return self._native.points

    @property
    def n_chunks(self) -> int:
        """Number of chunks."""
        return self._native.chunks

    @property
    def chunk_points(self) -> int:
        """Points of one chunk."""
        return self._native.chunk

    @property
    def columns(self) -> dict[str, str]:
        """Names and units of axes and outputs."""
        return dict(self._native.columns)

    @property
    def has_table(self) -> bool:
        """Whether it wishes a table."""
        return self._native.has_table

    def run(
        self,
        folder: str | os.PathLike[str],
        *,
        resume: bool = False,
        chunks: tuple[int, int] | None = None,
        csv: bool = False,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Result:
        """Runs the points into a folder, on all cores: what ``bulge sweep`` writes, the same bytes.

        ``resume`` goes on with what is there; ``chunks=(100, 200)`` are those only (several processes may share a folder; ``resume`` completes it).
        Ctrl-C loses the chunks in flight at most. Returns the document: points, infeasible, chunks, computed, damaged, is_complete.
        """
        if chunks is not None:
            if isinstance(chunks, str) or len(chunks) != 2:
                raise _bulge.InputError(f"chunks: {chunks!r}: give the first and the one after the last, such as (100, 200)")
            chunks = (count("chunks", chunks[0], 0), count("chunks", chunks[1], 0))
        with callback(progress, self.name) as told:
            own = None if threads is None else count("threads", threads, 1, 1024)
            text = self._native.run(os.fspath(folder), resume, chunks, csv, [], own, told)
        return Result(json.loads(text))

    def table(self, progress: Progress = None) -> Table:
        """Builds the table that the sweep wishes, and certifies it."""
        with callback(progress, self.name) as told:
            content, _, is_met = self._native.table(told)
        made = Table(content)
        if not is_met:
            import warnings

            warnings.warn("the size limit came first: the table does not meet its tolerance", stacklevel=2)
        return made

    def __repr__(self) -> str:
        chunks = "1 chunk" if self.n_chunks == 1 else f"{self.n_chunks} chunks"
        size = f"{self.n_points} points in {chunks}" if self.n_points else "a table only"
        return f"<Sweep {self.name}: {', '.join(self.columns)}; {size}>"

    def __reduce__(self) -> Any:
        return (_sweep_of, (self._native.text, self._native.muscle))


def _sweep_of(text: str, muscle: str) -> Sweep:
    return Sweep._of(_bulge.Sweep.with_muscle(text, muscle))


def as_sweep(spec: Any) -> Sweep:
    """A sweep from what a user gives: a sweep, the name of a file, or its text."""
    if isinstance(spec, Sweep):
        return spec
    if isinstance(spec, str) and "\n" in spec:
        return Sweep(spec)
    return Sweep.read(spec)


class Swept(Result):
    """What a sweep has left in its folder: ``points`` and ``table`` are the documents of the two, or None."""

    _what = "sweep"

    def _lines(self) -> list[str]:
        d = self._document
        lines = [f"{d['name']} in {d['folder']}"]
        for part, about in [(d.get("points"), ["points", "infeasible", "chunks", "computed", "is_complete"]), (d.get("table"), ["form", "bytes", "is_met"])]:
            if part:
                lines.append(", ".join(f"{key} {part[key]}" for key in about if key in part))
        return lines


def sweep(
    spec: Any,
    folder: str | os.PathLike[str],
    *,
    resume: bool = False,
    csv: bool = False,
    progress: Progress = None,
) -> Swept:
    """Runs a sweep (file, text or :class:`Sweep`) into a folder with its points and its table: what ``bulge sweep`` does."""
    plan = as_sweep(spec)
    found: dict[str, Any] = {"name": plan.name, "folder": os.fspath(folder), "points": None, "table": None}
    if plan.n_points:
        found["points"] = plan.run(folder, resume=resume, csv=csv, progress=progress).to_dict()
    if plan.has_table:
        found["table"] = write_table(plan, Path(folder), progress)
    return Swept(found)


def write_table(plan: Sweep, folder: Path, progress: Progress = None) -> dict[str, Any]:
    """Builds the table of a sweep, and writes table.bulge and table.json."""
    with callback(progress, plan.name) as told:
        content, description, is_met = plan._native.table(told)
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / "table.bulge", content)
    write_whole(folder / "table.json", description.encode())
    document: dict[str, Any] = json.loads(description)
    return {**document, "is_met": is_met}


def read_sweep(folder: str | os.PathLike[str], columns: list[str] | None = None) -> Any:
    """The points of a sweep's folder as a pandas DataFrame, in their order; ``infeasible`` has the reason where there is no equilibrium."""
    need("pandas", "a data frame", "pandas")
    parquet = need("pyarrow.parquet", "reading Parquet", "all")
    return parquet.read_table(Path(folder) / "points", columns=columns).to_pandas()
