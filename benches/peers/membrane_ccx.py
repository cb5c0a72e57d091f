"""The clamped tube of rubber as a thin solid of revolution (CAX8R) for CalculiX: writes the deck, reads what it printed. Called by membrane.py.

The wall is THICKNESS thick with the same stiffness per length, nearly incompressible, the pressure on its inside; its middle line is held at both
ends, where it is free to turn, as a membrane is. The error of the force is of the order of thickness over radius.
"""

import math

RADIUS, LENGTH, STIFFNESS, PRESSURE = 10.0, 60.0, 0.4, 0.03
THICKNESS = 0.1
# Bulk to shear modulus.
BULK = 2e4
GRADING = 3.0
# CalculiX solves a wedge of two degrees.
WEDGES = 180


def graded(t: float) -> float:
    """0 to 1 onto itself, finer towards both ends: a cubic with slope 1/GRADING there."""
    slope = 1.0 / GRADING
    return t * (slope + t * (1.0 - slope) * (3.0 - 2.0 * t))


def deck(elements: int) -> str:
    """One row of 8-node elements along the tube: x is the radius, y the axis. `elements` must be even."""
    ends = [LENGTH * graded(k / elements) for k in range(elements + 1)]
    rows = [z for a, b in zip(ends, ends[1:]) for z in (a, (a + b) / 2)] + ends[-1:]
    places = [(i, j) for j in range(len(rows)) for i in range(3) if i != 1 or j % 2 == 0]
    number = {place: n for n, place in enumerate(places, 1)}
    nodes = [f"{number[i, j]},{RADIUS + THICKNESS * (i - 1) / 2!r},{rows[j]!r}" for i, j in places]
    ring = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    cells = [f"{k + 1}," + ",".join(str(number[i, 2 * k + j]) for i, j in ring) for k in range(elements)]
    shear = STIFFNESS / THICKNESS
    lines = ["*NODE", *nodes, "*ELEMENT,TYPE=CAX8R,ELSET=WALL", *cells]
    for name, row in (("FIRST", 0), ("MIDDLE", elements), ("LAST", 2 * elements)):
        lines += [f"*NSET,NSET={name}", str(number[1, row])]
    lines += ["*MATERIAL,NAME=RUBBER", "*HYPERELASTIC,NEO HOOKE", f"{shear / 2!r},{2 / (BULK * shear)!r}"]
    lines += ["*SOLID SECTION,ELSET=WALL,MATERIAL=RUBBER", "*BOUNDARY", "FIRST,1,2", "LAST,1,2"]
    # Steps of its own choice, from a fifth of the load on.
    lines += ["*STEP,NLGEOM,INC=1000", "*STATIC", "0.2,1.", "*DLOAD", f"WALL,P4,{PRESSURE!r}"]
    lines += ["*NODE PRINT,NSET=MIDDLE,FREQUENCY=1000", "U", "*NODE PRINT,NSET=LAST,TOTALS=ONLY,FREQUENCY=1000", "RF", "*END STEP"]
    return "\n".join(lines) + "\n"


def found(printed: str) -> tuple[float, float]:
    """Radius at half length and force on the end with the pressure on the plug inside the wall, from the .dat file."""
    rows = [line.split() for line in printed.splitlines()]
    displacement = next(row for row in rows if len(row) == 4 and row[0].isdigit())
    reaction = rows[next(n for n, row in enumerate(rows) if row[:2] == ["total", "force"]) + 2]
    inside = RADIUS - THICKNESS / 2
    return RADIUS + float(displacement[1]), WEDGES * float(reaction[1]) - math.pi * PRESSURE * inside**2
