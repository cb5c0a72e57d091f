"""Tests that went wrong on the way into the file: damage habits on the rigs of `real-tests`, and what counts as naming them."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "real-tests"))
import bench  # noqa: E402, F401
