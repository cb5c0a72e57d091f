"""Runs the notebooks beside this file, or those that are named, each in a temporary folder of its own; nothing is stored.

    python run.py [NOTEBOOK ...]

One line for each notebook; status 1, with the cell and the error, if one fails. Needs nbclient and ipykernel.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
import tempfile
import time
from pathlib import Path

import nbformat
from jupyter_client import AsyncKernelManager
from jupyter_client.kernelspec import KernelSpecManager
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, CellTimeoutError, DeadKernelError

#: Seconds for one cell.
TIMEOUT = 600


def kernel_manager(folder: Path) -> AsyncKernelManager:
    """A manager of kernels that run the interpreter of this script, whichever are installed; their specification lies in ``folder``."""
    home = folder / "python3"
    home.mkdir()
    spec = {"argv": [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}", "--log-level=ERROR"], "display_name": "Python 3", "language": "python"}
    (home / "kernel.json").write_text(json.dumps(spec), encoding="utf-8")
    # Only this folder is looked at: another kernel of this name can't come first.
    found = KernelSpecManager(kernel_dirs=[str(folder)], ensure_native_kernel=False)
    return AsyncKernelManager(kernel_name="python3", kernel_spec_manager=found)


def failure(error: Exception, notebook: nbformat.NotebookNode) -> str:
    """What went wrong, and in which cell."""
    if not isinstance(error, CellExecutionError):
        return f"{type(error).__name__}: {error}"
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            if output.output_type == "error":
                trace = re.sub(r"\x1b\[[0-9;]*m", "", "\n".join(output.traceback))
                return f"cell {cell.id}:\n{cell.source}\n\n{trace}"
    return str(error)


def run(path: Path) -> str | None:
    """Executes a notebook; returns what failed, if something did."""
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as specs, tempfile.TemporaryDirectory() as folder:
        client = NotebookClient(notebook, km=kernel_manager(Path(specs)), timeout=TIMEOUT, resources={"metadata": {"path": folder}})
        try:
            client.execute()
        except (CellExecutionError, CellTimeoutError, DeadKernelError) as error:
            return failure(error, notebook)
    return None


def main() -> int:
    parser = argparse.ArgumentParser(description="Runs notebooks, each in a temporary folder.")
    parser.add_argument("notebooks", nargs="*", type=Path, metavar="NOTEBOOK", help="default: all beside this file")
    paths = parser.parse_args().notebooks or sorted(Path(__file__).resolve().parent.glob("*.ipynb"))
    # Kernels run elsewhere: relative entries would lose their meaning there.
    if os.environ.get("PYTHONPATH"):
        os.environ["PYTHONPATH"] = os.pathsep.join(os.path.abspath(entry) for entry in os.environ["PYTHONPATH"].split(os.pathsep) if entry)
    has_failed = False
    for path in paths:
        start = time.perf_counter()
        failed = run(path)
        print(f"{path.name}: {'FAILED' if failed else 'ok'}, {time.perf_counter() - start:.1f} s", flush=True)
        if failed:
            print(failed, file=sys.stderr, flush=True)
            has_failed = True
    return 1 if has_failed else 0


if __name__ == "__main__":
    sys.exit(main())
