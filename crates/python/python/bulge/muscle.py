"""Muscles: from files, presets or numbers; their shape, and their force, volume and stiffness over arrays."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from bulge import _bulge
from bulge.effects import OwnEffects, own_text
from bulge.optional import need
from bulge.progress import Progress, callback
from bulge.results import Result
from bulge.texts import count, quoted, write_whole
from bulge.units import FloatArray, Quantities, Quantity, si, si_array

#: SI units of what a muscle file states beside the numbers of the muscle.
_INSTRUMENT_UNITS = {"force": "N", "pressure": "Pa", "length": "m", "time": "s", "temperature": "K"}
#: SI units of what is varied beside the numbers of the muscle.
_STATE_UNITS = {"contraction": "%", "pressure": "Pa", "slenderness": "1", "elastic_group": "1"}
_GIVEN = {"contraction": "%", "length": "m", "force": "N", "volume": "m^3"}


def _of_muscle(native: _bulge.Muscle, name: str, value: Quantity) -> float:
    """A number of a muscle in SI."""
    # An unknown name is refused before its value is looked at.
    native.get(name)
    return si(value, effect_units("").get(name, "1"), name)


class Muscle:
    """A pleated or braided muscle, with the effects that its file states.

    By keyword, with the names of a muscle file; numbers are SI, text has a unit, and may have a width (``"110 mm +- 0.2 mm"``):

    >>> import bulge
    >>> muscle = bulge.Muscle(kind="pleated", length="110 mm", radius=0.016, fibres=40, fibre={"stiffness": "12 kN"})
    >>> shape = muscle.shape(pressure="2 bar", contraction="20 %")
    >>> print(f"{shape.force_n:.0f} N, largest diameter {2e3 * shape.max_radius_m:.1f} mm")
    1041 N, largest diameter 77.5 mm

    - ``name``, ``kind`` ("pleated" or "braided"), ``length`` [m], ``radius`` [m], ``fibres`` (a number, or "continuous"), ``braid_angle`` [rad], ``ends`` ("clamped" or
      "cylinder"), ``fibre`` ({"stiffness": [N], "section": [m^2]}), ``wall`` [m],
    - ``effects``: ``{"bladder-elasticity": {"c10": "0.2 MPa"}}``, each with the keys of its card (:func:`bulge.effects`),
    - ``instruments``: ``{"force": {"noise": "4 N", "zero": "1 N", "gain": "0.1 %"}}``,
    - ``own``: effects of one's own that ``effects`` may name,
    - ``specimens``: what is measured together and differs, ``{"short": {"length": "60 mm"}}``, by the names of :meth:`number`.
    """

    __slots__ = ("_native",)

    def __init__(
        self,
        *,
        kind: str,
        length: Quantity,
        radius: Quantity,
        name: str = "muscle",
        fibres: int | str | None = None,
        braid_angle: Quantity | None = None,
        ends: str | None = None,
        fibre: Mapping[str, Quantity] | None = None,
        wall: Quantity | None = None,
        effects: Mapping[str, Mapping[str, Quantity]] | None = None,
        instruments: Mapping[str, Mapping[str, Quantity]] | None = None,
        own: OwnEffects = None,
        specimens: Mapping[str, Mapping[str, Quantity]] | None = None,
    ) -> None:
        own_effects = own_text(own)
        lines = [f"name = {quoted(name)}", f"kind = {quoted(kind)}"]
        for key, value, unit in [("length", length, "m"), ("radius", radius, "m"), ("braid_angle", braid_angle, "rad"), ("wall", wall, "m")]:
            if value is not None:
                lines.append(f"{key} = {_written(value, unit, key)}")
        if fibres is not None:
            lines.append("fibres = " + (quoted(fibres) if isinstance(fibres, str) else str(count("fibres", fibres, 1))))
        if ends is not None:
            lines.append(f"ends = {quoted(ends)}")
        if fibre is not None:
            units = {"stiffness": "N", "section": "m^2"}
            lines.append("fibre = " + _inline({key: _written(value, units.get(key, "1"), f"fibre {key}") for key, value in fibre.items()}))
        known = effect_units(own_effects)
        for effect, numbers in (effects or {}).items():
            lines.append(f"[effects.{quoted(effect)}]")
            lines += [f"{quoted(key)} = {_written(value, known.get(f'{effect}.{key}', '1'), f'{effect}.{key}')}" for key, value in numbers.items()]
        if instruments:
            lines.append("[instruments]")
            for instrument, widths in instruments.items():
                unit = _INSTRUMENT_UNITS.get(instrument, "1")
                entries = {key: _written(value, "1" if key == "gain" else unit, f"{instrument} {key}") for key, value in widths.items()}
                lines.append(f"{quoted(instrument)} = {_inline(entries)}")
        native = _bulge.Muscle.from_text("\n".join(lines) + "\n", name, own_effects)
        for specimen, numbers in (specimens or {}).items():
            native = native.with_specimen(specimen, [(key, _of_muscle(native, key, value)) for key, value in numbers.items()])
        self._native = native

    @classmethod
    def _of(cls, native: _bulge.Muscle) -> Muscle:
        made = cls.__new__(cls)
        made._native = native
        return made

    @classmethod
    def from_toml(cls, source: str | os.PathLike[str], own: OwnEffects = None) -> Muscle:
        """A muscle from a muscle file, or from its text (which has line breaks)."""
        if isinstance(source, str) and "\n" in source:
            return cls._of(_bulge.Muscle.from_text(source, "muscle", own_text(own)))
        if source in presets() and not Path(source).exists():
            raise _bulge.InputError(f"there is no file `{source}`; the shipped muscle of that name is bulge.Muscle.preset({json.dumps(source)})")
        return cls._of(_bulge.Muscle.from_file(os.fspath(source), own_text(own)))

    @classmethod
    def preset(cls, name: str, own: OwnEffects = None) -> Muscle:
        """A shipped muscle; :func:`bulge.presets` lists them."""
        return cls._of(_bulge.Muscle.preset(name, own_text(own)))

    @property
    def name(self) -> str:
        """Its name."""
        return self._native.name

    @property
    def kind(self) -> str:
        """"pleated" or "braided"."""
        return self._native.kind

    @property
    def effects(self) -> list[str]:
        """Names of the effects that it states."""
        return self._native.effects

    @property
    def specimens(self) -> list[str]:
        """Names of the specimens that have numbers of their own: ``[specimens.NAME]`` in the muscle file."""
        return self._native.specimens

    def specimen(self, name: str) -> Muscle:
        """The muscle that a specimen is, with the effects of the muscle; any name that is not one of ``specimens`` raises :class:`bulge.InputError`."""
        return Muscle._of(self._native.specimen(name))

    def number(self, name: str) -> float | None:
        """A number of the muscle in SI; None if this muscle has none of that name.

        Names are those of sweeps: length, radius, fitting_radius, braid_angle, fibres, pleat_depth, misalignment, fibre_stiffness, c10, c01, wall,
        gas_wall, hoop_stiffness, unfolded_radius, cloth_circumference. Any other raises :class:`bulge.InputError`.
        """
        return self._native.get(name)

    def replace(self, **numbers: Quantity) -> Muscle:
        """The muscle with other numbers, by the names of :meth:`number`: ``muscle.replace(radius="17 mm", fibres=36)``."""
        native = self._native
        for name, value in numbers.items():
            native = native.with_number(name, _of_muscle(native, name, value))
        return Muscle._of(native)

    def to_toml(self, path: str | os.PathLike[str] | None = None) -> str:
        """The muscle file; written to ``path``, if that is given."""
        text = self._native.to_toml()
        if path is not None:
            write_whole(path, text.encode())
        return text

    def shape(
        self,
        *,
        pressure: Quantity,
        contraction: Quantity | None = None,
        length: Quantity | None = None,
        force: Quantity | None = None,
        volume: Quantity | None = None,
        method: str = "auto",
        points: int = 101,
    ) -> Shape:
        """One equilibrium, at a gauge pressure [Pa] and one of contraction (a fraction), length [m], force [N] or volume [m^3].

        ``method`` is "auto", "closed-form" or "shooting"; ``points`` of the meridian. Raises :class:`bulge.NoSolutionError` beyond the limit.
        """
        given = {"contraction": contraction, "length": length, "force": force, "volume": volume}
        stated = [(name, value) for name, value in given.items() if value is not None]
        if len(stated) != 1:
            raise _bulge.InputError("give one of contraction, length, force and volume" + (", not several" if stated else ""))
        name, value = stated[0]
        native = self._native.shape(si(pressure, "Pa", "pressure"), name, si(value, _GIVEN[name], name), method, count("points", points, 3))
        return Shape(native)

    def contraction_limit(self, pressure: Quantities, method: str = "auto") -> Any:
        """The contraction at which the muscle pulls no more, at each gauge pressure [Pa]; of other muscles ask ``muscle.replace(...)``."""
        p = si_array(pressure, "Pa", "pressure")
        if isinstance(p, float):
            return float(self._native.contraction_limit(np.array([p]), method)[0])
        return self._native.contraction_limit(np.ascontiguousarray(p).ravel(), method).reshape(p.shape)

    def evaluate(
        self,
        outputs: str | Iterable[str],
        contraction: Quantities,
        *,
        pressure: Quantities | None = None,
        method: str = "auto",
        errors: str = "raise",
        progress: Progress = None,
        numbers: Mapping[str, Quantities] | None = None,
        **more: Quantities,
    ) -> Any:
        """Outputs at arrays of contraction, pressure and numbers of the muscle, which broadcast against each other.

        ``outputs`` is a name or a list of "force" [N], "volume" [m^3], "stiffness" dF/dl [N/m], "stiffness_isothermal", "stiffness_adiabatic",
        "force_f" F/(p l0^2 a), "volume_v" V/l0^3, "max_radius" [m], "radius_ratio", "fibre_tension" [N], "fibre_strain", "end_slope" [rad],
        "force_by_contraction", "force_by_pressure" and the like, in SI. Numbers that vary are given by name: ``slenderness=`` (l0/R; the radius
        changes), ``radius=``, ``fibres=``, ``braid_angle=``, ``fibre_stiffness=``, ``elastic_group=`` (p sin(2 pi/n) R^2/EA); those of effects in
        ``numbers={"bladder-elasticity.c10": ...}``. Effects of a history (friction, creep) act as at rest.

        One name gives an array (a float for floats), a list gives a dict. Dimensionless outputs of muscles that don't depend on the pressure need
        none. Where there is no equilibrium at which the muscle pulls, the first such point is named by the exception that :meth:`shape` raises for
        it (beyond the limit :class:`bulge.NoSolutionError`); ``errors="coerce"`` gives NaN there. ``progress`` is True for a bar, or a function of (share, what).
        """
        if errors not in ("raise", "coerce"):
            raise _bulge.InputError(f"errors: {errors!r} is neither \"raise\" nor \"coerce\"")
        names = [outputs] if isinstance(outputs, str) else list(outputs)
        varied: dict[str, float | FloatArray] = {"contraction": si_array(contraction, "%", "contraction")}
        if pressure is not None:
            varied["pressure"] = si_array(pressure, "Pa", "pressure")
        elif any(name not in _PRESSURELESS for name in names):
            raise _bulge.InputError(f"pressure: give the gauge pressure for {', '.join(names)}, such as pressure=\"2 bar\"")
        known = effect_units(self._native.own)
        for name, value in {**(numbers or {}), **more}.items():
            if name in ("contraction", "pressure"):
                raise _bulge.InputError(f"{name} is given twice")
            varied[name] = si_array(value, _STATE_UNITS.get(name) or known.get(name, "1"), name)
        for one, other in [("radius", "slenderness"), ("fibre_stiffness", "elastic_group")]:
            if one in varied and other in varied:
                raise _bulge.InputError(f"{one} and {other} say the same thing twice: give one of them")
        shape = common_shape(varied)
        if errors == "raise":
            _check_numbers(varied)
        base = varied.get("pressure")
        if isinstance(base, float):
            del varied["pressure"]
        else:
            base = None
        count = int(np.prod(shape, dtype=np.int64))
        axes = [(name, value if isinstance(value, float) else _flat(value, shape)) for name, value in varied.items()]
        with callback(progress, ", ".join(names)) as told:
            arrays, failed, reasons = self._native.evaluate(names, axes, count, base, method, told)
        if failed and errors == "raise":
            row, why = reasons[0]
            where = f" at index {tuple(int(i) for i in np.unravel_index(row, shape))}" if shape else ""
            many = f"{failed} of {count} points; the first{where}: " if count > 1 else ""
            hint = "; errors=\"coerce\" gives NaN at such points" if count > 1 else ""
            raise type(why)(f"{self.name}: {many}{why}{hint}")
        found = [array.reshape(shape) if shape else float(array[0]) for array in arrays]
        return found[0] if isinstance(outputs, str) else dict(zip(names, found))

    def force(self, contraction: Quantities, *, pressure: Quantities, **options: Any) -> Any:
        """Axial force [N] over arrays of contraction, pressure and further numbers: see :meth:`evaluate`."""
        return self.evaluate("force", contraction, pressure=pressure, **options)

    def volume(self, contraction: Quantities, *, pressure: Quantities | None = None, **options: Any) -> Any:
        """Enclosed volume [m^3], circular sections: see :meth:`evaluate`. Only that of muscles whose shape depends on the pressure needs one."""
        return self.evaluate("volume", contraction, pressure=pressure, **options)

    def stiffness(self, contraction: Quantities, *, pressure: Quantities, gas: str = "open", **options: Any) -> Any:
        """Stiffness dF/dl [N/m]: at constant pressure ("open"), or with the gas shut in ("isothermal", "adiabatic"): see :meth:`evaluate`."""
        outputs = {"open": "stiffness", "isothermal": "stiffness_isothermal", "adiabatic": "stiffness_adiabatic"}
        if gas not in outputs:
            raise _bulge.InputError(f"gas: {gas!r} is none of {', '.join(outputs)}")
        return self.evaluate(outputs[gas], contraction, pressure=pressure, **options)

    def curve(self, pressure: Quantities, *, points: int = 101, start: Quantity | None = None, method: str = "auto") -> Any:
        """Isobaric characteristics as a pandas DataFrame: force, volume and stiffness from ``start`` to the limit at each pressure."""
        pandas = need("pandas", "a table of characteristics", "pandas")
        frames = []
        points = count("points", points, 2)
        if np.size(si_array(pressure, "Pa", "pressure")) == 0:
            raise _bulge.InputError("pressure: no pressure is given")
        for p in np.atleast_1d(np.asarray(si_array(pressure, "Pa", "pressure"))):
            limit = self.contraction_limit(float(p), method)
            singular = self.kind == "pleated" and self.number("fibre_stiffness") is None
            first = si(start, "%", "start") if start is not None else (0.01 * limit / 0.4 if singular else 0.0)
            contraction = np.linspace(first, limit, points)
            found = self.evaluate(["force", "volume", "stiffness", "max_radius"], contraction, pressure=float(p), method=method, errors="coerce")
            columns = {
                "pressure_pa": np.full(points, p), "contraction": contraction, "force_n": found["force"], "volume_m3": found["volume"],
                "stiffness_n_per_m": found["stiffness"], "max_radius_m": found["max_radius"],
            }  # fmt: skip
            frames.append(pandas.DataFrame(columns))
        return pandas.concat(frames, ignore_index=True)

    def plot(self, pressure: Quantities, *, points: int = 101, ax: Any = None) -> Any:
        """Draws force against contraction at each pressure; returns the axes (matplotlib)."""
        from bulge.plots import characteristics

        return characteristics(self, pressure, points, ax)

    def __repr__(self) -> str:
        numbers = ", ".join(
            f"{label} {_short(value * scale)} {unit}".rstrip()
            for label, key, scale, unit in [("l0", "length", 1e3, "mm"), ("R", "radius", 1e3, "mm"), ("n", "fibres", 1, ""), ("alpha0", "braid_angle", 180 / np.pi, "deg")]
            if (value := self._native.get(key)) is not None
        )
        effects = f", effects {', '.join(self.effects)}" if self.effects else ""
        return f"<Muscle {self.name}: {self.kind}, {numbers}{effects}>"

    def _repr_html_(self) -> str:
        import html

        return f"<pre>{html.escape(self.to_toml())}</pre>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Muscle) and (self.to_toml(), self._native.own) == (other.to_toml(), other._native.own)

    def __hash__(self) -> int:
        return hash((self.to_toml(), self._native.own))

    def __reduce__(self) -> Any:
        return (_muscle_of, (self.to_toml(), self._native.own))


def _muscle_of(text: str, own: str) -> Muscle:
    return Muscle._of(_bulge.Muscle.from_text(text, "muscle", own))


#: Outputs that have no pressure in them.
_PRESSURELESS = frozenset(["force_f", "volume_v", "volume", "volume_polygon", "max_radius", "radius_ratio", "end_slope", "force_f_by_contraction", "volume_v_by_contraction", "volume_by_contraction"])  # fmt: skip


class Shape(Result):
    """An equilibrium: the document of ``bulge shape --json`` (``force_n``, ``length_m``, ``contraction``, ``volume_m3``, ``max_radius_m``, ...)."""

    _what = "shape"

    def __init__(self, native: _bulge.Shape) -> None:
        super().__init__(json.loads(native.document()))
        self._native: _bulge.Shape | None = native
        self._meridian: dict[str, FloatArray] = native.meridian()

    @property
    def meridian(self) -> dict[str, FloatArray]:
        """The meridian from the left fitting to the right one: arrays ``x_m``, ``r_m``, ``slope_rad``, ``braid_angle_rad``, ``fibre_tension_n``,
        ``fibre_strain``, ``membrane_force_n_per_m``, ``fibre_length_m``, ``turn_rad``."""
        return self._meridian

    def surface(self, surface: str | None = None, *, cloth: Quantity | None = None, facets: int | None = None) -> Surface:
        """The bulging surface: "pleats" between the fibres or of "revolution" [default: pleats for pleated muscles]; ``cloth`` is the
        circumference of the unfolded cloth [m], ``facets`` the segments of a pleat (or around the axis)."""
        width = None if cloth is None else si(cloth, "m", "cloth")
        return Surface(**self._whole().surface(surface, width, None if facets is None else count("facets", facets, 4)))

    def write_vtk(self, path: str | os.PathLike[str], surface: str | None = None, *, cloth: Quantity | None = None) -> None:
        """Writes the surface for ParaView (.vtp)."""
        self._whole().write_vtk(os.fspath(path), surface, None if cloth is None else si(cloth, "m", "cloth"))

    def plot(self, ax: Any = None) -> Any:
        """Draws the meridian; returns the axes (matplotlib)."""
        from bulge.plots import meridian

        return meridian(self, ax)

    def _whole(self) -> _bulge.Shape:
        if self._native is None:
            raise _bulge.InputError("this shape has travelled and left its surface behind: compute it again with Muscle.shape")
        return self._native

    def _lines(self) -> list[str]:
        d = self._document
        return [
            f"{d['muscle']} at {d['pressure_pa'] / 1e5:.4g} bar",
            f"force {d['force_n']:.6g} N, contraction {100 * d['contraction']:.5g} %, length {1e3 * d['length_m']:.5g} mm",
            f"volume {1e6 * d['volume_m3']:.5g} ml, largest radius {1e3 * d['max_radius_m']:.5g} mm, fibre tension {d['fibre_tension_n']:.5g} N",
            f"stiffness {1e-3 * d['stiffness_n_per_m']:.4g} N/mm; {d['method']}",
        ]

    def __reduce__(self) -> Any:
        return (_shape_of, (self._document, self._meridian))


def _shape_of(document: dict[str, Any], meridian: dict[str, FloatArray]) -> Shape:
    made = Shape.__new__(Shape)
    Result.__init__(made, document)
    made._native, made._meridian = None, meridian
    return made


@dataclass(frozen=True, eq=False)
class Surface:
    """A bulging surface as arrays, x along the axis.

    ``points`` (n, 3) [m]; ``quads`` (m, 4) and ``fibres`` (k, stations) are places in it; ``point_data`` has an array of n by name, ``cell_data``
    one of k + m (first the fibres, then the quadrangles).
    """

    points: FloatArray
    quads: npt.NDArray[np.int64]
    fibres: npt.NDArray[np.int64]
    point_data: dict[str, FloatArray]
    cell_data: dict[str, npt.NDArray[Any]]

    def to_pyvista(self) -> Any:
        """A ``pyvista.PolyData``: lines for the fibres, faces for the cloth."""
        pyvista = need("pyvista", "a pyvista mesh", "all")
        mesh = pyvista.PolyData(self.points, faces=_cells(self.quads), lines=_cells(self.fibres))
        for name, values in self.point_data.items():
            mesh.point_data[name] = values
        for name, values in self.cell_data.items():
            mesh.cell_data[name] = values
        return mesh

    def to_meshio(self) -> Any:
        """A ``meshio.Mesh`` of the cloth, with a line for each piece of a fibre."""
        meshio = need("meshio", "a meshio mesh", "all")
        k = len(self.fibres)
        pieces = np.stack([self.fibres[:, :-1], self.fibres[:, 1:]], axis=-1).reshape(-1, 2) if k else np.empty((0, 2), dtype=np.int64)
        per_fibre = self.fibres.shape[1] - 1 if k else 0
        cell_data = {name: [np.repeat(values[:k], per_fibre), values[k:]] for name, values in self.cell_data.items()}
        return meshio.Mesh(self.points, [("line", pieces), ("quad", self.quads)], point_data=dict(self.point_data), cell_data=cell_data)


def _cells(cells: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Cells as VTK counts them: the number of vertices before each."""
    return np.hstack([np.full((len(cells), 1), cells.shape[1], dtype=np.int64), cells]).ravel()


def presets() -> dict[str, str]:
    """Shipped muscles: name and what it is."""
    return {name: about for name, about, _ in _bulge.presets()}


@lru_cache(maxsize=16)
def effect_units(own: str) -> dict[str, str]:
    """SI units of the numbers of muscles and effects."""
    return dict(_bulge.units_of(own))


def common_shape(varied: Mapping[str, float | FloatArray]) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(*(np.shape(value) for value in varied.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {np.shape(value)}" for name, value in varied.items() if np.ndim(value))
        raise _bulge.InputError(f"these arrays don't broadcast: {shapes}") from None


def _check_numbers(varied: Mapping[str, float | FloatArray]) -> None:
    """Refuses what is no question: numbers that are none, pressures that don't press, parts of fibres."""
    for name, value in varied.items():
        wrong = ~np.isfinite(value)
        must = "a finite number"
        if not wrong.any() and name == "pressure":
            wrong, must = np.asarray(value) <= 0, "greater than 0"
        elif not wrong.any() and name == "fibres":
            wrong, must = np.asarray(value) % 1 != 0, "a whole number"
        if np.any(wrong):
            place = tuple(int(i) for i in np.argwhere(np.atleast_1d(wrong))[0])
            found = float(np.atleast_1d(value)[place])
            where = f" at index {place}" if np.ndim(value) else ""
            raise _bulge.InputError(f"{name}: {found}{where}: it must be {must}")


def _written(value: Quantity, unit: str, name: str) -> str:
    """A value of a muscle file."""
    if isinstance(value, str):
        return quoted(value)
    number = si(value, unit, name)
    if not np.isfinite(number):
        raise _bulge.InputError(f"{number} is no number that a muscle can have")
    return json.dumps(f"{number!r} {unit}") if unit != "1" else repr(number)


def _inline(entries: Mapping[str, str]) -> str:
    return "{ " + ", ".join(f"{quoted(key)} = {value}" for key, value in entries.items()) + " }"


def _flat(value: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    return np.ascontiguousarray(np.broadcast_to(value, shape)).reshape(-1)


def _short(value: float) -> str:
    return f"{value:.5g}"
