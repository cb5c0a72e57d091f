"""Runs the notebooks beside this file, or those that are named, each in a temporary folder of its own.

    python run.py [--write] [NOTEBOOK ...]

One line for each notebook; status 1, with the cell and the error, if one fails. Notebooks hold their outputs: it fails as well if a cell gives other kinds of
output than it holds (text, pictures). With ``--write`` the outputs are stored: texts without temporary folders, pictures small and in few colours, nothing that
depends on the hour. Cells with the tag ``times`` hold no outputs. Needs nbclient and ipykernel.
"""

from __future__ import annotations

import argparse
import base64
import io
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
#: Most bytes of a notebook with its outputs.
MOST_BYTES = 150_000
#: Resolution of pictures, and the number of their colours.
DPI, COLOURS = 64, 24


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


def small(picture: str) -> str:
    """A PNG in few colours, which suffice for plots."""
    from PIL import Image  # matplotlib needs it: it is there

    image = Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGB")
    packed = io.BytesIO()
    image.quantize(COLOURS, dither=Image.Dither.NONE).save(packed, "PNG", optimize=True)
    return base64.b64encode(packed.getvalue()).decode("ascii")


def stored(outputs: list[nbformat.NotebookNode]) -> list[nbformat.NotebookNode]:
    """The outputs of a cell as a notebook holds them: one stream of text in a row, a picture or plain text of each other output."""
    # Names of temporary folders differ from run to run.
    folder = re.compile(re.escape(tempfile.gettempdir()) + r"/tmp\w+/?")
    kept: list[nbformat.NotebookNode] = []
    for output in outputs:
        if output.output_type == "stream":
            text = folder.sub("", output.text)
            if kept and kept[-1].output_type == "stream" and kept[-1].name == output.name:
                kept[-1].text += text
            else:
                kept.append(nbformat.v4.new_output("stream", name=output.name, text=text))
        elif "image/png" in output.get("data", {}):
            kept.append(nbformat.v4.new_output("display_data", data={"image/png": small(output.data["image/png"])}))
        elif "text/plain" in output.get("data", {}):
            kept.append(nbformat.v4.new_output("display_data", data={"text/plain": folder.sub("", output.data["text/plain"])}))
    return kept


def kinds(outputs: list[nbformat.NotebookNode]) -> list[str]:
    return [output.get("name") or ("picture" if "image/png" in output.data else "text") for output in outputs]


def store(path: Path, notebook: nbformat.NotebookNode) -> str | None:
    """Writes a notebook with the outputs of its run; returns why not, if it is too large."""
    held = nbformat.read(path, as_version=4)
    count = 0
    for cell, ran in zip(held.cells, notebook.cells):
        if cell.cell_type == "code":
            count += 1
            cell.execution_count = count
            cell.outputs = [] if "times" in cell.metadata.get("tags", []) else stored(ran.outputs)
    text = nbformat.writes(held) + "\n"
    if len(text) > MOST_BYTES:
        return f"it would have {len(text)} bytes with its outputs, and {MOST_BYTES} are the most: draw fewer or smaller pictures"
    path.write_text(text, encoding="utf-8")
    return None


def differs(path: Path, notebook: nbformat.NotebookNode) -> str | None:
    """The first cell that gives other kinds of output than the notebook holds."""
    for cell, ran in zip(nbformat.read(path, as_version=4).cells, notebook.cells):
        if cell.cell_type == "code" and "times" not in cell.metadata.get("tags", []):
            held, given = kinds(cell.outputs), kinds(stored(ran.outputs))
            if held != given:
                return f"cell {cell.id} holds the outputs {held} and gives {given}: run with --write"
    return None


def run(path: Path, *, write: bool) -> str | None:
    """Executes a notebook; returns what failed, if something did."""
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as specs, tempfile.TemporaryDirectory() as folder:
        rc = Path(specs) / "matplotlibrc"
        rc.write_text(f"figure.dpi: {DPI}\n", encoding="utf-8")
        os.environ["MATPLOTLIBRC"] = str(rc)
        client = NotebookClient(notebook, km=kernel_manager(Path(specs)), timeout=TIMEOUT, resources={"metadata": {"path": folder}})
        try:
            client.execute()
        except (CellExecutionError, CellTimeoutError, DeadKernelError) as error:
            return failure(error, notebook)
    return store(path, notebook) if write else differs(path, notebook)


def main() -> int:
    parser = argparse.ArgumentParser(description="Runs notebooks, each in a temporary folder.")
    parser.add_argument("notebooks", nargs="*", type=Path, metavar="NOTEBOOK", help="default: all beside this file")
    parser.add_argument("--write", action="store_true", help="store the outputs in the notebooks")
    arguments = parser.parse_args()
    paths = arguments.notebooks or sorted(Path(__file__).resolve().parent.glob("*.ipynb"))
    # Kernels run elsewhere: relative entries would lose their meaning there.
    if os.environ.get("PYTHONPATH"):
        os.environ["PYTHONPATH"] = os.pathsep.join(os.path.abspath(entry) for entry in os.environ["PYTHONPATH"].split(os.pathsep) if entry)
    has_failed = False
    for path in paths:
        start = time.perf_counter()
        failed = run(path, write=arguments.write)
        print(f"{path.name}: {'FAILED' if failed else 'ok'}, {time.perf_counter() - start:.1f} s", flush=True)
        if failed:
            print(failed, file=sys.stderr, flush=True)
            has_failed = True
    return 1 if has_failed else 0


if __name__ == "__main__":
    sys.exit(main())
