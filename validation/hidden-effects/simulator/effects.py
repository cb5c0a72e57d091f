"""The effects that can be hidden: basic names of the catalogue, the amplitude that scales each, and what a test must have to show it."""

from dataclasses import dataclass

BOTH = ("pleated", "braided")
PLEATED = ("pleated",)
BRAIDED = ("braided",)


@dataclass(frozen=True)
class Effect:
    """`scale` is a typical amplitude, `limit` the largest that is still plausible, both in `unit` (SI); `sign` +1: never negative.

    `needs`: motion (a path in time), rate (two speeds), specimens, temperature, rubber (a bladder in the muscle file), cloth-range (the muscle
    must reach its cloth). `structural`: the equilibrium itself changes. `size` power: the signature grows like amplitude^power. `fixed`: nature
    sets the size. `reported`: name and unit of the parameter in a diagnosis if it is defined as the amplitude is here, with the factor to that unit.
    """

    name: str
    kinds: tuple
    scale: float
    limit: float
    unit: str
    sign: int = 0
    needs: tuple = ()
    structural: bool = False
    power: float = 1.0
    fixed: bool = False
    rig: bool = False
    reported: tuple | None = None


def _structural(name, kinds, scale, limit, unit, **more):
    return Effect(name, kinds, scale, limit, unit, structural=True, **more)


def _rig(name, scale, limit, unit, **more):
    return Effect(name, BOTH, scale, limit, unit, rig=True, **more)


CATALOGUE = {
    effect.name: effect
    for effect in (
        _structural("end-radius", BOTH, 3e-4, 4e-3, "m"),
        _structural("fibre-count", PLEATED, 1.0, 12.0, "1"),
        _structural("pleat-depth", PLEATED, 3e-4, 5e-3, "m", sign=1, reported=("depth", "mm", 1e3)),
        _structural("lobes", PLEATED, 1.0, 1.0, "1", sign=1, fixed=True),
        _structural("fibre-misalignment", PLEATED, 0.03, 0.2, "rad", sign=1, power=2.0, reported=("angle", "deg", 57.29577951308232)),
        _structural("uneven-fibres", PLEATED, 2e-3, 0.012, "1", sign=1, power=2.0),
        _structural("fibre-stretch", BOTH, 3e-7, 5e-6, "1/N", sign=1, reported=("compliance", "%/kN", 1e5)),
        _structural(
            "limited-unfolding", PLEATED, 5e3, 3e5, "N/m", sign=1, needs=("cloth-range",), reported=("hoop_stiffness", "kN/m", 1e-3)
        ),
        _structural("braid-angle-error", BRAIDED, 2e-3, 0.05, "rad"),
        _structural("end-taper", BRAIDED, 1.0, 1.0, "1", sign=1, fixed=True),
        _structural("wall-thickness", BRAIDED, 1e-4, 2e-3, "m", sign=1, reported=("thickness", "mm", 1e3)),
        _structural("bladder-elasticity", BRAIDED, 5e3, 2.5e5, "Pa", sign=1),
        Effect("membrane-axial", BOTH, 10.0, 2e3, "N", sign=1),
        Effect("coulomb-friction", BOTH, 1.0, 80.0, "N", sign=1, needs=("motion",), reported=("force", "N", 1.0)),
        Effect("pressure-friction", BOTH, 5e-6, 5e-4, "m^2", sign=1, needs=("motion",), reported=("coefficient", "N/bar", 1e5)),
        Effect("force-friction", BOTH, 2e-3, 0.15, "1", sign=1, needs=("motion",), reported=("share", "%", 100.0)),
        Effect("presliding-hysteresis", BOTH, 1.5, 80.0, "N", sign=1, needs=("motion",)),
        Effect("viscous-damping", BOTH, 300.0, 1e5, "N s", sign=1, needs=("motion", "rate")),
        Effect("creep", BOTH, 0.5, 60.0, "N", sign=1, needs=("motion", "dwell")),
        Effect("stress-softening", BOTH, 0.05, 0.8, "1", sign=1, needs=("motion", "cycles")),
        Effect("pressure-threshold", BOTH, 500.0, 3e4, "Pa", sign=1, reported=("pressure", "kPa", 1e-3)),
        Effect("temperature", BOTH, 3e-4, 0.01, "1/K", needs=("temperature",)),
        Effect("low-load-slack", BOTH, 20.0, 300.0, "N", sign=1, power=2.0, needs=("low-load",)),
        _rig("force-offset", 1.0, 100.0, "N", reported=("offset", "N", 1.0)),
        _rig("force-gain", 3e-3, 0.15, "1", reported=("gain", "%", 100.0)),
        _rig("force-nonlinearity", 2e-6, 2e-4, "1/N", reported=("curvature", "%/kN", 1e5)),
        _rig("force-drift", 1e-3, 0.2, "N/s", needs=("motion",), reported=("rate", "N/h", 3600.0)),
        _rig("force-lag", 0.1, 5.0, "s", sign=1, needs=("motion", "rate"), reported=("time", "s", 1.0)),
        _rig("pressure-offset", 400.0, 3e4, "Pa", reported=("offset", "kPa", 1e-3)),
        _rig("pressure-gain", 3e-3, 0.15, "1", reported=("gain", "%", 100.0)),
        _rig("length-zero-error", 5e-5, 4e-3, "m", reported=("offset", "mm", 1e3)),
        _rig("displacement-gain", 3e-3, 0.1, "1", reported=("gain", "%", 100.0)),
        _rig("frame-compliance", 3e-8, 3e-6, "m/N", sign=1, reported=("compliance", "um/N", 1e6)),
        _rig("end-slip", 1e-8, 3e-6, "m/N", sign=1, reported=("compliance", "um/N", 1e6)),
        _rig("regulator-lag", 0.1, 5.0, "s", sign=1, needs=("motion", "rate"), reported=("time", "s", 1.0)),
        Effect("specimen-spread", BOTH, 3e-3, 0.1, "1", sign=1, needs=("motion", "specimens")),
    )
}
"""Effects by name. Lobes and end-taper are there or not: their amplitude is 1."""
