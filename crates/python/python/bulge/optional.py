"""Libraries that are there or not."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def need(module: str, what: str, extra: str) -> Any:
    """A library, or an error that says what it is needed for and how to get it."""
    try:
        return import_module(module)
    except ImportError:
        package = module.split(".")[0]
        raise ImportError(f"{what} needs {package}: pip install {package}, or bulge[{extra}]") from None
