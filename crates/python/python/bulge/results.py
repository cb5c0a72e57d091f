"""What results have in common: their document, which is that of the command line's ``--json``."""

from __future__ import annotations

import html
import json
from collections.abc import Iterator
from typing import Any


class Result:
    """A result: a JSON document with attributes.

    ``result.to_dict()`` is the document; its keys are attributes and items (``result.verdict``, ``result["verdict"]``). Results can be pickled.
    """

    #: What the document holds, for messages.
    _what = "result"

    def __init__(self, document: dict[str, Any]) -> None:
        self._document = document

    def to_dict(self) -> dict[str, Any]:
        """The document, a new copy of it."""
        copied: dict[str, Any] = json.loads(json.dumps(self._document))
        return copied

    def to_json(self, indent: int | None = 2) -> str:
        """The document as text."""
        return json.dumps(self._document, indent=indent, ensure_ascii=False)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self._document[name]
        except KeyError:
            raise AttributeError(f"this {self._what} has no {name!r}; it has {', '.join(self._document)}") from None

    def __getitem__(self, name: str) -> Any:
        return self._document[name]

    def __contains__(self, name: object) -> bool:
        return name in self._document

    def __iter__(self) -> Iterator[str]:
        return iter(self._document)

    def keys(self) -> list[str]:
        """Names in the document."""
        return list(self._document)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._document]

    def __reduce__(self) -> Any:
        return (type(self), (self._document,))

    def _lines(self) -> list[str]:
        return [f"{key}: {value}" for key, value in self._document.items() if not isinstance(value, (list, dict))]

    def _tables(self) -> list[tuple[list[str], list[list[str]]]]:
        """Headings and rows."""
        return []

    def __repr__(self) -> str:
        parts = ["\n".join(self._lines())]
        parts += [_text_table(heading, rows) for heading, rows in self._tables() if rows]
        return "\n\n".join(part for part in parts if part)

    def _repr_html_(self) -> str:
        lines = [html.escape(line) for line in self._lines()]
        parts = [f"<p><b>{lines[0]}</b></p>" if lines else ""]
        parts += [f"<p>{line}</p>" for line in lines[1:]]
        parts += [_html_table(heading, rows) for heading, rows in self._tables() if rows]
        return f"<div>{''.join(parts)}</div>"


def number(value: Any, digits: int = 4) -> str:
    """A number for people."""
    if value is None:
        return "-"
    if isinstance(value, str):
        return value
    return f"{float(value):.{digits}g}"


def rung_names(ladder: list[dict[str, Any]], base: str) -> list[str]:
    """Names of the rungs of a ladder: an effect that is bent has two, by its formula and as the data want it."""

    def effects(rung: dict[str, Any]) -> set[str]:
        return set((rung["added"] or "").split(" + ")) - {""}

    bent = {effect for rung in ladder if rung.get("bent") for effect in effects(rung)}

    def name(rung: dict[str, Any]) -> str:
        own = effects(rung)
        if not own:
            return base
        one = len(own) == 1
        if rung.get("bent"):
            form = ", as the data want it" if one else ", as the data want them"
        elif own & bent:
            form = ", by its formula" if one else ", by their formulas"
        else:
            form = ""
        return f"+ {rung['added']}{form}"

    return [name(rung) for rung in ladder]


def _text_table(heading: list[str], rows: list[list[str]]) -> str:
    widths = [max(len(row[c]) for row in [heading, *rows]) for c in range(len(heading))]

    def line(row: list[str]) -> str:
        # Names to the left, numbers to the right.
        cells = [f"{cell:<{width}}" if c == 0 else f"{cell:>{width}}" for c, (cell, width) in enumerate(zip(row, widths))]
        return ("  " + "  ".join(cells)).rstrip()

    return "\n".join(line(row) for row in [heading, *rows])


def _html_table(heading: list[str], rows: list[list[str]]) -> str:
    head = "".join(f"<th>{html.escape(cell)}</th>" for cell in heading)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
