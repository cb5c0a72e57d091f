"""A (learnt) muscle on new rows: the document of ``bulge predict --json``."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from bulge import _bulge
from bulge.effects import OwnEffects, own_text
from bulge.measurements import DataLike, read
from bulge.muscle import Muscle
from bulge.optional import need
from bulge.results import Result, number
from bulge.statements import Lines, lines


class Prediction(Result):
    """The force of a muscle at rows that it wasn't fitted to: the document of ``bulge predict --json``.

    ``against`` compares with measured forces, where there are any; ``uncertain`` lists the numbers whose doubt widens the intervals;
    ``without_state`` counts rows without an equilibrium; ``warnings`` are to be read before the numbers.
    """

    _what = "prediction"

    @property
    def columns(self) -> dict[str, Any]:
        """Arrays by name, each of shape ``(rows,)``, in the order of the data.

        ``file``, ``line`` (or number of the row, from 1), ``sweep`` (of a path), ``specimen``, ``time_s`` (where it was read), ``pressure_pa``, ``contraction``, ``force_n``
        (predicted), ``sd_n`` (its standard deviation by the doubt about its numbers), ``low_n`` and ``high_n`` (95 % of the readings lie between),
        ``measured_n`` and ``residual_n`` (measured less predicted; where a force was measured). What is unknown is NaN.
        """
        rows = self._document["columns"]
        names = {"file": self._document["files"], "sweep": rows["sweeps"], "specimen": rows["specimens"]}
        found: dict[str, Any] = {}
        for name, values in rows.items():
            if values is None or name in ("sweeps", "specimens"):
                continue
            if name in names:
                of = names[name]
                if of is not None:
                    found[name] = np.array(of)[np.array(values, dtype=np.int64)]
            elif name == "line":
                found[name] = np.array(values, dtype=np.int64)
            else:
                found[name] = np.array(values, dtype=np.float64)
        return found

    def to_pandas(self) -> Any:
        """The columns as a DataFrame."""
        return need("pandas", "a data frame", "pandas").DataFrame(self.columns)

    def _lines(self) -> list[str]:
        d = self._document
        without = d["without_state"]
        lines = [f"{d['muscle']} predicted on {', '.join(d['files'])}: {d['rows'] - (without['rows'] if without else 0)} of {d['rows']} rows have a state"]
        if without:
            lines.append(f"without a state: line {without['lines']}: {without['why']}")
        if d["against"]:
            a = d["against"]
            within = "" if a["coverage"] is None else f", {100 * a['coverage']:.1f} % within their intervals"
            lines.append(f"against {a['rows']} measured forces: RMS error {number(a['rmse_n'], 3)} N, mean {number(a['bias_n'], 3)} N{within}")
        return lines + [f"! {warning}" for warning in d["warnings"]]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        rows = [
            [f"{n['effect']} {n['name']}", number(n["value"]), number(n["sd"], 2), "" if n["unit"] == "1" else n["unit"], number(n["moves_n"], 3)]
            for n in self._document["uncertain"]
        ]
        return [(["in doubt", "value", "+-", "unit", "moves [N]"], rows)]


def predict(data: DataLike, muscle: Muscle, *, own: OwnEffects = None, exclude: Lines = None) -> Prediction:
    """The force of new rows, with intervals by what the muscle knows of its numbers: what ``bulge predict`` does.

    ``muscle`` is usually one that has learnt (``bulge.fit(...).learnt``); ``data`` is what :func:`bulge.read` takes, and may have no force. Rows of
    the lines ``exclude`` are predicted, and left out of the errors. Raises :class:`bulge.InputError`: an effect that isn't known, a muscle of
    another size, lines without a row.

    >>> import bulge
    >>> learnt = bulge.fit("data.csv", bulge.Muscle.preset("dmsp-20-250"), "coulomb-friction").learnt  # doctest: +SKIP
    >>> bulge.predict("new.csv", learnt).columns["force_n"]  # doctest: +SKIP
    """
    rows = read(data, muscle=muscle, force_may_lack=True)
    return Prediction(json.loads(_bulge.predict(rows._native, muscle._native, own_text(own), lines(exclude))))
