"""Shape, force and volume of pneumatic artificial muscles, and which physical effect a model of one lacks.

>>> import bulge
>>> muscle = bulge.Muscle.preset("ppam-2-r16")
>>> print(f"{muscle.force(contraction='20 %', pressure='1 bar'):.1f} N")
544.0 N

Numbers without a unit are SI (a contraction is a fraction); text has a unit: ``"110 mm"``, ``"2 bar"``, ``"20 %"``. What is computed is SI, and
its name ends in its unit where it has one (``force_n``). Arrays broadcast as in NumPy, and long calls use all cores, let other threads run, and
stop on Ctrl-C.

- :class:`Muscle`: what it is; its shape, force, volume and stiffness,
- :func:`read`: measurements, :func:`compare`, :func:`diagnose`, :func:`fit`, :func:`predict`, :func:`plan`, :func:`next_experiment`,
  :func:`simulate`,
- :class:`Effect`: a physical effect of one's own, :func:`effects`: the catalogue,
- :func:`size`, :func:`joint`, :mod:`bulge.air`, :func:`sense`, :func:`heat`: muscles put to use, :func:`membrane`: finite elements,
- :class:`Sweep`, :class:`Table`: families of muscles as data sets and as certified tables,
- :mod:`bulge.distributed`: the same on Dask.
"""

from bulge import air
from bulge._bulge import BulgeError, InputError, NoSolutionError, NotConvergedError, version as _version
from bulge.design import Heat, Joint, MembraneRun, Sensing, Sizing, heat, joint, membrane, sense, size
from bulge.effects import Effect, EffectCard, Parameter, effects, quantity, read_effects
from bulge.inference import (
    Comparison,
    Diagnosis,
    Fit,
    NextExperiment,
    Plan,
    Posterior,
    Simulation,
    compare,
    diagnose,
    fit,
    next_experiment,
    plan,
    simulate,
)
from bulge.measurements import Data, read
from bulge.muscle import Muscle, Shape, Surface, presets
from bulge.prediction import Prediction, predict
from bulge.results import Result
from bulge.sweeps import Sweep, read_sweep, sweep, sweep_example
from bulge.tables import Table
from bulge.units import si

__version__: str = _version()

__all__ = [
    "BulgeError",
    "Comparison",
    "Data",
    "Diagnosis",
    "Effect",
    "EffectCard",
    "Fit",
    "Heat",
    "InputError",
    "Joint",
    "MembraneRun",
    "Muscle",
    "NextExperiment",
    "NoSolutionError",
    "NotConvergedError",
    "Parameter",
    "Plan",
    "Posterior",
    "Prediction",
    "Result",
    "Sensing",
    "Shape",
    "Simulation",
    "Sizing",
    "Surface",
    "Sweep",
    "Table",
    "__version__",
    "air",
    "compare",
    "diagnose",
    "effects",
    "fit",
    "heat",
    "joint",
    "membrane",
    "next_experiment",
    "plan",
    "predict",
    "presets",
    "quantity",
    "read",
    "read_effects",
    "read_sweep",
    "sense",
    "si",
    "simulate",
    "size",
    "sweep",
    "sweep_example",
]
