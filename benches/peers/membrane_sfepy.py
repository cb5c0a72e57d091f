"""Runs the balloon that sfepy ships as its check of the membrane term, in the folder it is called in, and prints one line of JSON. Called by membrane.py.

A ball of Mooney-Rivlin skin (R = 1, H = 0.01) filled with an incompressible fluid, of 1110 tetrahedra, its volume prescribed in steps, stretched from 1 to 6; the
pressure is compared with the closed form of the sphere.
"""

import json
import time
from pathlib import Path

import sfepy
from sfepy.applications import solve_pde
from sfepy.base.base import output
from sfepy.postprocess.time_history import extract_time_history

# What the example takes: thickness over radius and the two moduli.
THIN, FIRST, SECOND = 1e-2, 3e5, 3e4


def closed_form(stretch: float) -> float:
    """Pressure of a sphere of Mooney-Rivlin skin."""
    return 4 * THIN * (1 / stretch - stretch**-7) * (FIRST + SECOND * stretch**2)


def main() -> None:
    output.set_output(quiet=True)
    start = time.process_time()
    solve_pde(Path(sfepy.__file__).parent / "examples/large_deformation/balloon.py")
    seconds = time.process_time() - start
    history, steps = extract_time_history("unit_ball.h5", "p e 0", verbose=False)
    pairs = list(zip(1.0 + steps.times, history["p"][0].ravel()))
    off = max(abs(abs(pressure) / closed_form(stretch) - 1) for stretch, pressure in pairs if stretch > 1.1)
    print(json.dumps({"version": sfepy.__version__, "seconds": seconds, "steps": len(pairs), "pressure": float(off)}))


if __name__ == "__main__":
    main()
