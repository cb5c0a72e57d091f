"""Texts of files: read, quoted, written; and whole numbers."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from bulge import _bulge


def read_text(path: str | os.PathLike[str]) -> str:
    """The text of a file."""
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise _bulge.InputError(f"{os.fspath(path)}: {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise _bulge.InputError(f"{os.fspath(path)}: byte {error.start} is not UTF-8 text; save the file as plain text with the encoding UTF-8") from None


def write_whole(path: str | os.PathLike[str], content: bytes) -> None:
    """Writes a file so that it appears whole or not at all."""
    _bulge.Sweep.write(os.fspath(path), content)


def quoted(text: str) -> str:
    """Text as TOML has it."""
    if any("\ud800" <= c <= "\udfff" for c in text):
        raise _bulge.InputError(f"{text!r} is no text: it has half a character")
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def count(name: str, value: Any, least: int, most: int = 2**31) -> int:
    """A whole number that is neither too small nor too large."""
    try:
        whole = int(value)
        if whole == value and least <= whole <= most and not isinstance(value, (bool, str)):
            return whole
    except (TypeError, ValueError, OverflowError):
        pass
    limit = "or more" if most >= 2**31 else f"to {most}"
    raise _bulge.InputError(f"{name}: {value!r}: give a whole number of {least} {limit}")
