"""The muscle as its file states it, and the muscle file (TOML, quantities with units)."""

import re
import tomllib
from dataclasses import dataclass, field, replace

import numpy as np

_UNITS = {"mm": 1e-3, "m": 1.0, "um": 1e-6, "deg": np.pi / 180.0, "kN": 1e3, "N": 1.0, "MPa": 1e6, "kPa": 1e3, "Pa": 1.0, "%": 1e-2}


@dataclass(frozen=True)
class Sheet:
    """Standard deviations that the data sheet of one instrument states, SI; 0: not stated. `gain` is relative."""

    noise: float = 0.0
    zero: float = 0.0
    gain: float = 0.0


@dataclass(frozen=True)
class Muscle:
    """Stated geometry [m, rad], material and instruments; `fibre_stiffness` is EA of one fibre [N]; `widths` are the standard deviations stated with `+-`."""

    name: str
    kind: str
    length: float
    radius: float
    fibres: int | None = None
    braid_angle: float | None = None
    ends: str = "clamped"
    wall: float | None = None
    bladder: tuple | None = None
    widths: dict = field(default_factory=dict)
    force: Sheet = Sheet()
    pressure: Sheet = Sheet()
    stroke: Sheet = Sheet()
    fibre_stiffness: float | None = None

    def without_instruments(self):
        """The same muscle on a rig about which nothing is stated."""
        return replace(self, force=Sheet(), pressure=Sheet(), stroke=Sheet())

    def toml(self, exact=False):
        """The muscle file; `exact` states widths of 0 where there are none: what is stated is true."""
        lines = [f'name = "{self.name}"', f'kind = "{self.kind}"', f"length = {self._sized('length', 1e-3, 'mm', exact)}"]
        lines.append(f"radius = {self._sized('radius', 1e-3, 'mm', exact)}")
        if self.fibres is not None:
            lines.append(f"fibres = {self.fibres}")
        if self.fibre_stiffness is not None:
            lines.append(f'fibre = {{ stiffness = "{self.fibre_stiffness / 1e3:.10g} kN", section = "0.1 mm^2" }}')
        if self.kind == "braided":
            lines.append(f"braid_angle = {self._sized('braid_angle', np.pi / 180.0, 'deg', exact)}")
            lines.append(f'ends = "{self.ends}"')
            if self.wall is not None:
                lines.append(f"wall = {self._sized('wall', 1e-3, 'mm', exact)}")
        if self.bladder is not None:
            c10, c01 = (value / 1e6 for value in self.bladder)
            lines += ["", "[effects.bladder-elasticity]", f'c10 = "{c10:.10g} MPa"', f'c01 = "{c01:.10g} MPa"']
        tables = [("force", self.force, 1.0, "N"), ("pressure", self.pressure, 1.0, "Pa"), ("length", self.stroke, 1e-3, "mm")]
        rows = [f"{name} = {_sheet(sheet, size, unit)}" for name, sheet, size, unit in tables if sheet != Sheet()]
        if rows:
            lines += ["", "[instruments]", *rows]
        return "\n".join(lines) + "\n"

    def _sized(self, name, size, unit, exact=False):
        width = self.widths.get(name, 0.0)
        text = f"{getattr(self, name) / size:.10g} {unit}"
        return f'"{text} +- {width / size:.6g} {unit}"' if width or exact else f'"{text}"'


def _sheet(sheet, size, unit):
    parts = [f'{key} = "{value / size:.6g} {unit}"' for key, value in (("noise", sheet.noise), ("zero", sheet.zero)) if value]
    if sheet.gain:
        parts.append(f'gain = "{sheet.gain * 100:.6g} %"')
    return "{ " + ", ".join(parts) + " }"


def read(path):
    """Reads a muscle file that `Muscle.toml` wrote."""
    with open(path, "rb") as file:
        table = tomllib.load(file)
    widths = {}

    def number(key):
        if key not in table:
            return None
        value, width = _quantity(table[key])
        if width:
            widths[key] = width
        return value

    bladder = table.get("effects", {}).get("bladder-elasticity")
    sheets = {name: _read_sheet(table.get("instruments", {}).get(name, {})) for name in ("force", "pressure", "length")}
    return Muscle(
        name=table["name"],
        kind=table["kind"],
        length=number("length"),
        radius=number("radius"),
        fibres=table.get("fibres"),
        braid_angle=number("braid_angle"),
        ends=table.get("ends", "clamped"),
        wall=number("wall"),
        bladder=bladder and (_quantity(bladder["c10"])[0], _quantity(bladder["c01"])[0]),
        widths=widths,
        force=sheets["force"],
        pressure=sheets["pressure"],
        stroke=sheets["length"],
        fibre_stiffness=_quantity(table["fibre"]["stiffness"])[0] if "fibre" in table else None,
    )


def _read_sheet(table):
    return Sheet(**{key: _quantity(text)[0] for key, text in table.items()})


def _quantity(text):
    values = [float(number) * _UNITS[unit] for number, unit in re.findall(r"([-+\d.eE]+) ([a-zA-Z%]+)", text.replace("+-", ";"))]
    return values[0], values[1] if len(values) > 1 else 0.0
