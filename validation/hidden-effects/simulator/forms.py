"""Other forms of the catalogue's loose effects: what a form is, what it sees of a test, and the list of all.

A form has the mechanism of its effect and another formula than the catalogue's card. It acts at one stage of the simulated test:

    shape     replaces parts of the equilibrium: energy of the bladder, law of the fibres, energy of the cloth, lengths of the fibres
    pressure  changes the pressure that acts, against the reading [Pa]
    give      contraction that frame or fittings give way under a load [1]
    wall      changes the static force [N], before friction
    motion    changes the force by the path's past or speed [N]
    later     changes the force by time and warmth [N]
    reading   changes what the load cell shows [N]

Every form is linear in the amplitude or nearly so, and means the same at the reference point as the effect's amplitude in `effects.py`.
Constants are drawn once per case from `Scales`. The forms of an effect are dealt out to three folds, for tests that leave one form out.
"""

from dataclasses import dataclass, field

import numpy as np

FOLDS = 3


@dataclass(frozen=True)
class Scales:
    """Sizes of a test before anything is hidden: stroke [1], fastest and slowest typical rate [1/s], highest pressure [Pa], largest force [N],
    lengths of a run and of the session [s], stated and largest radius [m], and the number of loops."""

    stroke: float
    fast: float
    slow: float
    pressure: float
    force: float
    run: float
    session: float
    radius: float
    largest: float
    loops: float


@dataclass
class State:
    """What a form sees: the path of readings, the force map, and the true pressure, contraction and force row by row."""

    path: object
    static: object
    pressure: np.ndarray
    contraction: np.ndarray
    force: np.ndarray | None = None
    bare: object = None
    muscle: object = None

    @property
    def across(self):
        """Contraction from 0 to 1 over the test's range."""
        span = np.ptp(self.path.contraction)
        return (self.path.contraction - self.path.contraction.min()) / (span or 1.0)

    @property
    def tension(self):
        """Axial tension across the equator [N]."""
        return self.static.tension(self.pressure, self.contraction)

    def rates(self, signal):
        """Time derivative of a signal, run by run."""
        result = np.zeros(len(signal))
        for run in self.path.runs:
            if run.stop - run.start > 2:
                result[run] = np.gradient(signal[run], self.path.time[run])
        return result


@dataclass(frozen=True)
class Form:
    """`act(state, amplitude, constants)` returns the change at `stage`; `draw(rng, scales)` the constants."""

    effect: str
    name: str
    stage: str
    draw: object
    act: object


@dataclass(frozen=True)
class Drawn:
    """A form with the constants of one case."""

    form: Form
    constants: dict = field(default_factory=dict, hash=False)

    def act(self, state, amplitude):
        """What the form does at this amplitude."""
        return self.form.act(state, amplitude, self.constants)


def all_forms():
    """Forms by effect, in a fixed order."""
    from . import forms_motion, forms_rig, forms_time, forms_wall

    found = {}
    for module in (forms_motion, forms_time, forms_wall, forms_rig):
        for form in module.FORMS:
            found.setdefault(form.effect, []).append(form)
    return found


def fold(form):
    """Number of the fold, 0 to 2, by the place of the form in the list of its effect."""
    return [one.name for one in all_forms()[form.effect]].index(form.name) % FOLDS
