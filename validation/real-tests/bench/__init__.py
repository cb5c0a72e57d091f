"""Whole tests as laboratories make them: rigs, hysteresis, instruments, damaged rows and file dialects, on the equilibria of `hidden-effects/simulator`."""

import os
import sys
from pathlib import Path

# One thread per process: the matrices are small, and the cases are what runs in parallel.
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "hidden-effects"))
