"""Measurements: read from files or data frames."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from bulge import _bulge
from bulge.optional import need
from bulge.units import FloatArray, Quantity, si

if TYPE_CHECKING:
    from bulge.muscle import Muscle


class Data:
    """A checked set of measurements; :func:`bulge.read` makes one. ``len(data)`` is the number of rows."""

    __slots__ = ("_native", "_source")

    def __init__(self, native: _bulge.Data, source: tuple[str, Any, str | None, Muscle | None, bool]) -> None:
        #: Where it comes from: ("files", paths, columns, muscle, force_may_lack) or ("csv", (text, origin), columns, muscle, force_may_lack).
        self._native, self._source = native, source

    @property
    def is_path(self) -> bool:
        """Whether the rows follow each other in time; else they are a static map."""
        return self._native.is_path

    @property
    def has_force(self) -> bool:
        """Whether a force was measured; see ``force_may_lack`` of :func:`bulge.read`."""
        return self._native.has_force

    @property
    def n_sweeps(self) -> int:
        """Number of uninterrupted runs."""
        return self._native.n_sweeps

    @property
    def files(self) -> list[str]:
        """Names of the files."""
        return self._native.files

    @property
    def sha256(self) -> str:
        """Fingerprint of the files."""
        return self._native.sha256

    @property
    def reading(self) -> dict[str, Any]:
        """How the files were read: what each of the ``columns`` was taken for (and whether this was guessed), which rows were ``set_apart``, ``notes``."""
        found: dict[str, Any] = json.loads(self._native.reading())
        return found

    @property
    def columns(self) -> dict[str, Any]:
        """Arrays by name, in SI: ``pressure_pa``, ``contraction`` or ``length_m``, ``force_n`` (where it was measured), ``time_s``, ..., ``sweep``, ``specimen``."""
        found = self._native.columns()
        found["specimen"] = np.array(found["specimen"])
        if not self.is_path:
            # A map has none; with labels it would be read as a path.
            del found["sweep"]
        return found

    def to_pandas(self) -> Any:
        """The columns as a DataFrame."""
        return need("pandas", "a data frame", "pandas").DataFrame(self.columns)

    def quality(self, length: Quantity | None = None) -> list[str]:
        """What is noteworthy about the data, in sentences; of a muscle of the length l0 [m], if that is given."""
        return self._native.quality(None if length is None else si(length, "m", "length"))

    def plot(self, ax: Any = None) -> Any:
        """Draws force against motion, a colour for each sweep; returns the axes (matplotlib)."""
        from bulge.plots import measured

        if not self.has_force:
            raise _bulge.InputError("no force was measured: there is nothing to draw over the motion")
        return measured(self, ax)

    def __len__(self) -> int:
        return len(self._native)

    def __repr__(self) -> str:
        columns = self.columns
        force: FloatArray | None = columns.get("force_n")
        pressure: FloatArray = columns["pressure_pa"]
        kind = f"{self.n_sweeps} sweeps" if self.is_path else "a static map"
        return (
            f"<Data {', '.join(self.files)}: {len(self)} rows, {kind}, {pressure.min() / 1e5:.3g} to {pressure.max() / 1e5:.3g} bar, "
            + ("no force>" if force is None else f"{force.min():.3g} to {force.max():.3g} N>")
        )

    def __reduce__(self) -> Any:
        return (_data_again, (*self._source, self.sha256))


def _data_of(kind: str, source: Any, columns: str | None, muscle: Muscle | None, force_may_lack: bool = False) -> Data:
    native = None if muscle is None else muscle._native
    if kind == "files":
        paths = [os.path.abspath(name) for name in source]
        return Data(_bulge.Data.read(source, columns, native, force_may_lack), (kind, paths, columns, muscle, force_may_lack))
    text, origin = source
    return Data(_bulge.Data.from_csv(text, origin, columns, native, force_may_lack), (kind, source, columns, muscle, force_may_lack))


def _data_again(kind: str, source: Any, columns: str | None, muscle: Muscle | None, force_may_lack: bool, sha256: str) -> Data:
    """Unpickled: files are read again, and must be what they were."""
    data = _data_of(kind, source, columns, muscle, force_may_lack)
    if data.sha256 != sha256:
        raise _bulge.InputError(f"{', '.join(data.files)} changed while these measurements travelled: read them again")
    return data


def _mapping(columns: str | Mapping[str, str] | None) -> str | None:
    """What is said of columns as one text."""
    if columns is None or isinstance(columns, str):
        return columns
    if not columns:
        return None

    def entry(quantity: str, column: str) -> str:
        name = column.strip()
        return f'{quantity}=-"{name[1:].strip()}"' if name.startswith("-") else f'{quantity}="{name}"'

    return ",".join(entry(quantity, column) for quantity, column in columns.items())


def read(
    source: Any, *more: Any, columns: str | Mapping[str, str] | None = None, muscle: Muscle | None = None, force_may_lack: bool = False
) -> Data:
    """Measurements from a file of text, Excel, MATLAB or Parquet, several of them (one analysis), or a pandas DataFrame.

    Columns are named with their unit: ``pressure [bar]``, ``contraction [%]`` or ``length [mm]``, ``force [N]``, ``time [s]`` and so on, as in a
    file; a frame may also have the SI names of :attr:`Data.columns`. Other names are guessed (:attr:`Data.reading` says what was), unless
    ``columns`` settles them: ``"force=Force_N [N], displacement=-Weg"``, or a mapping of the same. A displacement, and a pressure or length without
    any unit, are only understood with the ``muscle``. With ``force_may_lack`` there need be no force: such rows are for :func:`bulge.predict`.
    Raises :class:`bulge.InputError` with the line and the cure.
    """
    if isinstance(source, Data):
        return source
    mapping = _mapping(columns)
    if hasattr(source, "to_csv") and hasattr(source, "columns"):
        if more:
            raise _bulge.InputError("one data frame at a time: join them first, with a column `sweep` or `specimen`")
        return _data_of("csv", (_text(source), "the data frame"), mapping, muscle, force_may_lack)
    if isinstance(source, Mapping):
        raise _bulge.InputError("a mapping is no table of measurements: make it a frame, pandas.DataFrame(...)")
    try:
        paths: Iterable[Any] = [source, *more] if isinstance(source, (str, os.PathLike)) else [*source, *more]
        names = [os.fspath(path) for path in paths]
    except TypeError:
        raise _bulge.InputError(f"{source!r} is neither the name of a file, nor a list of such names, nor a data frame") from None
    if not names:
        raise _bulge.InputError("no file is named: give the name of a CSV file")
    return _data_of("files", names, mapping, muscle, force_may_lack)


def measured(source: Any, muscle: Muscle) -> Data:
    """Measurements of a muscle that have a force, to compare with."""
    data = read(source, muscle=muscle)
    if not data.has_force:
        raise _bulge.InputError(f"{', '.join(data.files)}: no force was measured there: only bulge.predict takes such rows")
    return data


#: SI names of :attr:`Data.columns` as headings of a file.
_HEADINGS = {
    "pressure_pa": "pressure [Pa]", "length_m": "length [m]", "force_n": "force [N]", "time_s": "time [s]", "temperature_k": "temperature [K]",
    "diameter_m": "diameter [m]", "volume_m3": "volume [m^3]", "force_sd_n": "force_sd [N]",
}  # fmt: skip


def _text(frame: Any) -> str:
    """A frame as a CSV file. A frame from :meth:`Data.to_pandas` comes back as it was."""
    if any(name is not None for name in frame.index.names):
        # A named index is a column, such as the time.
        frame = frame.reset_index()
    frame = frame.rename(columns=_HEADINGS)
    text: str = frame.to_csv(index=False)
    return text


#: What may be given as measurements.
DataLike = Any
