"""Forms of what the rig adds: give of frame and fittings, leaks, regulators, load cells that bend or are late, fibres that go slack.

Give: Hertz 1882, deflection ~ F^(2/3); bolts that stiffen; play that closes. Pressure: losses of a thin line by Poiseuille's law for a gas (squares of
absolute pressures), by a turbulent one, by a leak that opens. Regulator: turbulent valve, second order, dead zone. Load cell: exponential, saturating,
two slopes. Late force: one and two poles, dead time and a pole, moving average. Slack: mean of max(f, 0) over other distributions than the normal one.
"""

import numpy as np

from .forms import Form
from .history import lag

ATMOSPHERE = 101325.0


# Give: contraction that is lost under a load [N], for an amplitude in 1/N.


def _hertz(load, amplitude, c):
    size = np.abs(load)
    return amplitude * np.sign(load) * c["force"] * (size / c["force"] + 1e-4) ** c["power"]


def _draw_hertz(rng, scales):
    return {"power": rng.uniform(0.6, 0.75), "force": scales.force}


def _bolts(load, amplitude, c):
    return amplitude * load * (c["floor"] + (1.0 - c["floor"]) / (1.0 + np.abs(load) / c["force"]))


def _draw_bolts(rng, scales):
    return {"floor": rng.uniform(0.2, 0.5), "force": scales.force * rng.uniform(0.25, 0.6)}


def _play(load, amplitude, c):
    return amplitude * (load + c["play"] * np.tanh(load / c["force"]))


def _draw_play(rng, scales):
    return {"play": scales.force * rng.uniform(0.2, 0.6), "force": scales.force * rng.uniform(0.08, 0.3)}


def _yielding(load, amplitude, c):
    """Gives more and more: 1 + b F/F_ref."""
    return amplitude * load * (1.0 + c["rise"] * np.abs(load) / c["force"])


def _draw_yielding(rng, scales):
    return {"rise": rng.uniform(0.4, 1.0), "force": scales.force}


def _slipping(load, amplitude, c):
    """Holds up to a tension, then gives: softened over a fifth of it."""
    width = 0.2 * c["hold"]
    return amplitude * width * np.logaddexp(0.0, (load - c["hold"]) / width)


def _draw_slipping(rng, scales):
    return {"hold": scales.force * rng.uniform(0.3, 0.8)}


# Pressure: the change of the pressure that acts [Pa].


def _poiseuille(state, amplitude, c):
    """Flow through the leak ~ p, loss in the line by squares of absolute pressures: -A p (p + 2 p_a)/(p_r + 2 p_a)."""
    p = state.pressure
    return -amplitude * p * (p + 2.0 * ATMOSPHERE) / (c["pressure"] + 2.0 * ATMOSPHERE)


def _draw_reference(rng, scales):
    return {"pressure": 0.7 * scales.pressure}


def _turbulent_leak(state, amplitude, c):
    """A mass flow ~ p through a rough or smooth line (Blasius 1913: power 1.75), whose gas is the denser the higher the absolute pressure."""
    p, usual = state.pressure, c["pressure"]
    return -amplitude * usual * np.abs(p / usual) ** c["power"] * (usual + ATMOSPHERE) / (np.abs(p) + ATMOSPHERE)


def _draw_turbulent_leak(rng, scales):
    return {"pressure": 0.7 * scales.pressure, "power": rng.uniform(1.7, 2.0)}


def _opening_leak(state, amplitude, c):
    width = 0.1 * c["pressure"]
    return -amplitude * width * np.logaddexp(0.0, (state.pressure - c["opens"]) / width)


def _draw_opening_leak(rng, scales):
    return {"pressure": 0.7 * scales.pressure, "opens": scales.pressure * rng.uniform(0.2, 0.45)}


def _demand(state):
    """Rate at which the gas in the muscle asks for more [Pa/s]: p' + (p + p_a) V'/V."""
    volume = np.log(state.static.volume(state.pressure, state.contraction))
    return state.rates(state.pressure) + (state.pressure + ATMOSPHERE) * state.rates(volume)


def _turbulent_valve(state, amplitude, c):
    flow = _demand(state) / c["flow"]
    return -amplitude * c["flow"] * flow * (flow**2 + 1e-3) ** (0.5 * (c["power"] - 1.0))



def _draw_turbulent_valve(rng, scales):
    return {"flow": _usual_flow(scales), "power": rng.uniform(0.6, 0.85) if rng.random() < 0.5 else rng.uniform(1.2, 1.6)}


def _usual_flow(scales):
    """Of the slow test: the volume of a muscle about doubles over its stroke."""
    return (scales.pressure + ATMOSPHERE) * scales.slow * 3.0


def _second_order(state, amplitude, c):
    """The valve's error follows the demand behind two poles: y'' + 2 d w y' + w^2 y = w^2 A q, by implicit steps."""
    demand, result = _demand(state), np.empty(len(state.path))
    w, d = c["frequency"], c["damping"]
    for run in state.path.runs:
        y, v = demand[run.start], 0.0
        times = np.diff(state.path.time[run], prepend=state.path.time[run.start])
        values = []
        for step, q in zip(times.tolist(), demand[run].tolist()):
            if step > 0.0:
                v = (v + step * w * w * (q - y)) / (1.0 + 2.0 * d * w * step + (w * step) ** 2)
                y += step * v
            values.append(y)
        result[run] = values
    return -amplitude * result


def _draw_second_order(rng, scales):
    # Slow enough to be seen between rows: a few per cent of a period.
    period = 2.0 * scales.stroke / scales.fast
    return {"frequency": 2.0 * np.pi / (period * rng.uniform(0.08, 0.2)), "damping": rng.uniform(0.4, 0.9)}


def _dead_zone(state, amplitude, c):
    """A valve that answers beyond a small demand alone, and is slow at large ones: tanh of what is beyond, softened."""
    flow = _demand(state) / c["flow"]
    beyond = flow * flow**2 / (flow**2 + c["dead"] ** 2)
    return -amplitude * c["flow"] * c["most"] * np.tanh(beyond / c["most"])


def _draw_dead_zone(rng, scales):
    return {"flow": _usual_flow(scales), "dead": rng.uniform(0.1, 0.35), "most": rng.uniform(2.0, 6.0)}


# Load cell: the change of the reading [N] for an amplitude in 1/N.


def _exponential(state, amplitude, c):
    """A F^2 at small forces and ever more at large ones: the spring gives way."""
    size = state.force / c["force"]
    return 2.0 * amplitude * c["force"] ** 2 * (np.expm1(size) - size)


def _draw_exponential(rng, scales):
    return {"force": scales.force * rng.uniform(0.25, 0.6)}


def _saturating(state, amplitude, c):
    """A F^2 at small forces, none of it more at large ones: (1 - cos) of the force, to half a wave or nearly."""
    angle = np.pi * c["span"] * state.force / c["force"]
    return 2.0 * amplitude * (c["force"] / (np.pi * c["span"])) ** 2 * (1.0 - np.cos(angle))


def _draw_saturating(rng, scales):
    return {"force": scales.force, "span": rng.uniform(0.5, 0.9)}


def _two_slopes(state, amplitude, c):
    width = 0.05 * c["force"]
    return 2.0 * amplitude * c["force"] * width * np.logaddexp(0.0, (state.force - c["bend"]) / width)


def _draw_two_slopes(rng, scales):
    return {"force": scales.force, "bend": scales.force * rng.uniform(0.35, 0.6)}


def _one_pole(state, amplitude, c):
    return lag(state.path, state.force, amplitude) - state.force if amplitude else 0.0


def _two_poles(state, amplitude, c):
    if not amplitude:
        return 0.0
    first = lag(state.path, state.force, amplitude * c["share"])
    return lag(state.path, first, amplitude * (1.0 - c["share"])) - state.force


def _draw_share(low, high):
    def draw(rng, scales):
        return {"share": rng.uniform(low, high)}

    return draw


def _delayed(path, signal, delay):
    """The signal as it was `delay` ago, linear between rows, at rest before each run."""
    result = np.empty(len(path))
    for run in path.runs:
        time = path.time[run]
        result[run] = np.interp(time - delay, time, signal[run])
    return result


def _delay_and_pole(state, amplitude, c):
    if not amplitude:
        return 0.0
    late = _delayed(state.path, state.force, amplitude * c["share"])
    return lag(state.path, late, amplitude * (1.0 - c["share"])) - state.force


def _moving_average(state, amplitude, c):
    """Mean over the last 2 tau, whose centre is tau ago; nine points."""
    if not amplitude:
        return 0.0
    parts = [_delayed(state.path, state.force, 2.0 * amplitude * share) for share in (np.arange(9) + 0.5) / 9.0]
    return np.mean(parts, axis=0) - state.force


# Slack: mean of max(f, 0) over loads f of the fibres that are spread about F with the scale A [N]; what is more than F.


def _slack_uniform(state, amplitude, c):
    width = np.sqrt(3.0) * amplitude
    inside = (np.clip(state.force, -width, width) + width) ** 2 / (4.0 * width)
    return np.where(state.force > width, 0.0, np.where(state.force < -width, -state.force, inside - state.force))


def _slack_laplace(state, amplitude, c):
    scale = amplitude / np.sqrt(2.0)
    return 0.5 * scale * np.exp(-np.abs(state.force) / scale) + np.maximum(-state.force, 0.0)


def _slack_hyperbola(state, amplitude, c):
    """Student's t with two degrees of freedom: (F + sqrt(F^2 + A^2))/2, a long tail."""
    return 0.5 * (np.sqrt(state.force**2 + amplitude**2) - state.force)


def _guarded(act):
    return lambda state, amplitude, c: act(state, amplitude, c) if amplitude else 0.0


def _nothing(rng, scales):
    return {}


FORMS = (
    Form("frame-compliance", "hertz", "give", _draw_hertz, _hertz),
    Form("frame-compliance", "stiffening-bolts", "give", _draw_bolts, _bolts),
    Form("frame-compliance", "play", "give", _draw_play, _play),
    Form("end-slip", "yielding", "give", _draw_yielding, _yielding),
    Form("end-slip", "hertz", "give", _draw_hertz, _hertz),
    Form("end-slip", "holds-then-slips", "give", _draw_slipping, _slipping),
    Form("line-drop", "poiseuille", "pressure", _draw_reference, _poiseuille),
    Form("line-drop", "turbulent", "pressure", _draw_turbulent_leak, _turbulent_leak),
    Form("line-drop", "opening-leak", "pressure", _draw_opening_leak, _opening_leak),
    Form("regulator-lag", "turbulent-valve", "pressure", _draw_turbulent_valve, _turbulent_valve),
    Form("regulator-lag", "second-order", "pressure", _draw_second_order, _second_order),
    Form("regulator-lag", "dead-zone", "pressure", _draw_dead_zone, _dead_zone),
    Form("force-nonlinearity", "exponential", "reading", _draw_exponential, _exponential),
    Form("force-nonlinearity", "saturating", "reading", _draw_saturating, _saturating),
    Form("force-nonlinearity", "two-slopes", "reading", _draw_two_slopes, _two_slopes),
    Form("force-lag", "one-pole", "reading", _nothing, _one_pole),
    Form("force-lag", "two-poles", "reading", _draw_share(0.5, 0.75), _two_poles),
    Form("force-lag", "delay-and-pole", "reading", _draw_share(0.3, 0.6), _delay_and_pole),
    Form("force-lag", "moving-average", "reading", _nothing, _moving_average),
    Form("low-load-slack", "uniform", "reading", _nothing, _guarded(_slack_uniform)),
    Form("low-load-slack", "laplace", "reading", _nothing, _guarded(_slack_laplace)),
    Form("low-load-slack", "hyperbola", "reading", _nothing, _guarded(_slack_hyperbola)),
)
