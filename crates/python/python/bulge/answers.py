"""What the answers of a design have in common: their document, and what the command draws."""

from __future__ import annotations

import json
from typing import Any

from bulge import _bulge
from bulge.optional import need
from bulge.results import Result


class Answer(Result):
    """An answer that can draw itself. Pickled, it keeps its numbers and leaves its drawing behind."""

    def __init__(self, native: _bulge.Answer | None, document: dict[str, Any] | None = None) -> None:
        super().__init__(json.loads(native.document()) if native is not None and document is None else (document or {}))
        self._native = native

    def plot(self, ax: Any = None) -> Any:
        """Draws what the command draws; returns the axes (matplotlib)."""
        from bulge.plots import lines

        if self._native is None:
            raise _bulge.InputError(f"this {self._what} has travelled and left its drawing behind: make it again where it is drawn")
        return lines(self._native.drawing(), ax)

    def _rows(self) -> list[dict[str, Any]]:
        """The rows that :meth:`to_pandas` returns."""
        return []

    def to_pandas(self) -> Any:
        """The rows as a DataFrame, one column for each number."""
        return frame(self._rows())

    def __copy__(self) -> Any:
        return self

    def __deepcopy__(self, memo: Any) -> Any:
        return self

    def __reduce__(self) -> Any:
        return (type(self), (None, self._document))


def frame(rows: list[dict[str, Any]]) -> Any:
    """Rows as a DataFrame."""
    return need("pandas", "a data frame", "pandas").DataFrame(rows)


def plain(row: dict[str, Any]) -> dict[str, Any]:
    """A row without lists and nested objects."""
    return {key: value for key, value in row.items() if not isinstance(value, (list, dict))}
