"""Long calls: they stop on Ctrl-C, tell how far they are, pass exceptions on, and let other threads run."""

import os
import signal
import subprocess
import sys
import threading
import time

import bulge
import numpy as np
import pytest

BAR = 1e5
#: Some seconds of shooting, if nobody stops it.
CORES = os.cpu_count() or 1
LONG = np.linspace(0.02, 0.3, 45_000 * CORES)
#: Some more.
SWEEP = f"""
muscle = "dmsp-20-250"
outputs = ["force"]
chunk = 256
[axes.contraction]
range = "1 %..30 %"
points = 300
[axes.pressure]
range = "1 bar..5 bar"
points = {80 * CORES}
"""
SHORT = 'muscle = "dmsp-20-250"\noutputs = ["force"]\nchunk = 128\n[axes.contraction]\nrange = "1 %..30 %"\npoints = 2000\n'

RUN_ON = ["evaluate", "sweep"]


@pytest.fixture(autouse=True)
def heard():
    """Ctrl-C is heard also where this process was started in the background, with the signal ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def until_quiet(longest=20.0):
    """Waits until no thread of this process works; returns the processor time that they took."""
    began, worked = time.monotonic(), time.process_time()
    while time.monotonic() - began < longest:
        before = time.process_time()
        time.sleep(0.2)
        if time.process_time() - before < 0.04:
            break
    return time.process_time() - worked


@pytest.fixture(autouse=True)
def quiet():
    """Leaves no work to the next test."""
    yield
    until_quiet()


@pytest.fixture
def ctrl_c():
    """Sends SIGINT to this process after a while; returns the processor time it had taken by then, which nothing else on the machine adds to."""
    sent = []

    def send():
        sent.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)

    timers = []

    def after(seconds):
        timer = threading.Timer(seconds, send)
        timers.append(timer)
        timer.start()
        return sent

    yield after
    for timer in timers:
        timer.cancel()
        timer.join()


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT of a process to itself")
def test_ctrl_c_stops_a_long_evaluation(braid, ctrl_c):
    expected = braid.force(0.1, pressure=BAR)
    sent = ctrl_c(0.3)
    with pytest.raises(KeyboardInterrupt):
        braid.force(LONG, pressure=BAR, method="shooting")
    assert sent and time.process_time() - sent[0] < 1.0
    assert braid.force(0.1, pressure=BAR) == expected
    np.testing.assert_array_equal(braid.force(np.full(200, 0.1), pressure=BAR), expected)


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT of a process to itself")
def test_ctrl_c_stops_a_diagnosis(rubbed, diagnosed, ctrl_c):
    sent = ctrl_c(0.2)
    with pytest.raises(KeyboardInterrupt):
        while True:
            bulge.diagnose(rubbed.data, rubbed.muscle)
    assert time.process_time() - sent[0] < 1.0
    assert bulge.diagnose(rubbed.data, rubbed.muscle).to_json() == diagnosed.to_json()


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT of a process to itself")
def test_ctrl_c_stops_a_sweep_that_can_be_resumed(tmp_path, ctrl_c):
    plan = bulge.Sweep(SWEEP)
    sent = ctrl_c(0.4)
    with pytest.raises(KeyboardInterrupt):
        plan.run(tmp_path / "sweep")
    assert time.process_time() - sent[0] < 1.0
    found = plan.run(tmp_path / "sweep", resume=True, chunks=(0, 4))
    assert found.computed <= 4 and not found.damaged


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT of a process to itself")
@pytest.mark.parametrize("long", [*RUN_ON, "diagnose", "limit"])
def test_ctrl_c_ends_the_work(long, braid, rubbed, tmp_path, ctrl_c):
    plan = bulge.Sweep(SWEEP)
    ctrl_c(0.3)
    with pytest.raises(KeyboardInterrupt):
        if long == "evaluate":
            braid.force(LONG, pressure=BAR, method="shooting")
        elif long == "sweep":
            plan.run(tmp_path / "sweep")
        elif long == "limit":
            braid.contraction_limit(np.linspace(BAR, 5 * BAR, 100_000))
        else:
            while True:
                bulge.diagnose(rubbed.data, rubbed.muscle)
    assert until_quiet() < 1.0


def test_the_interpreter_ends_while_work_is_going_on():
    script = """
import bulge, numpy, threading
muscle = bulge.Muscle.preset("dmsp-20-250")
thread = threading.Thread(target=lambda: muscle.force(numpy.linspace(0.02, 0.3, 400000), pressure=1e5), daemon=True)
thread.start()
thread.join(0.3)
print("end")
"""
    began = time.monotonic()
    made = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=30, check=False)
    assert (made.stdout.strip(), made.returncode) == ("end", 0), made.stderr
    assert time.monotonic() - began < 8


def steps_of(call):
    """What a call tells of its progress."""
    told = []
    found = call(lambda share, what: told.append((share, what)))
    return found, told


def test_progress_rises_to_one(braid, rubbed, tmp_path):
    plan = bulge.Sweep(SHORT)
    # How often a call tells depends on how fast the machine is; only the first takes seconds on any.
    for call, least in [
        (lambda told: braid.force(LONG[::2], pressure=BAR, method="shooting", progress=told), 2),
        (lambda told: bulge.diagnose(rubbed.data, rubbed.muscle, progress=told), 1),
        (lambda told: bulge.next_experiment(rubbed.data, rubbed.muscle, progress=told), 1),
        (lambda told: plan.run(tmp_path / "sweep", progress=told), 1),
    ]:
        _, told = steps_of(call)
        shares = [share for share, _ in told]
        assert len(told) >= least and shares == sorted(shares) and shares[0] >= 0 and shares[-1] == 1.0
        assert all(isinstance(what, str) and what for _, what in told)


def test_progress_of_a_table_rises_to_one(small_table):
    _, told = steps_of(lambda told: bulge.Sweep(small_table).table(progress=told))
    assert told and told[-1][0] == 1.0


def test_progress_changes_nothing(braid, rubbed, diagnosed):
    quiet = braid.force(LONG[::1000], pressure=BAR)
    np.testing.assert_array_equal(braid.force(LONG[::1000], pressure=BAR, progress=lambda share, what: None), quiet)
    np.testing.assert_array_equal(braid.force(LONG[::1000], pressure=BAR, progress=True), quiet)
    assert bulge.diagnose(rubbed.data, rubbed.muscle, progress=True).to_json() == diagnosed.to_json()


def test_an_exception_of_the_callback_is_raised_by_the_call(braid, rubbed, diagnosed, tmp_path):
    class Enough(Exception):
        pass

    def tell(share, what):
        raise Enough(what)

    plan = bulge.Sweep(SHORT)
    for call in [
        lambda: braid.force(LONG[::2], pressure=BAR, progress=tell),
        lambda: braid.force(LONG[:3], pressure=BAR, progress=tell),
        lambda: bulge.diagnose(rubbed.data, rubbed.muscle, progress=tell),
        lambda: plan.run(tmp_path / "sweep", progress=tell),
    ]:
        began = time.monotonic()
        with pytest.raises(Enough):
            call()
        assert time.monotonic() - began < 5
    assert plan.run(tmp_path / "sweep", resume=True).is_complete
    assert bulge.diagnose(rubbed.data, rubbed.muscle).to_json() == diagnosed.to_json()
    with pytest.raises(TypeError):
        braid.force(LONG[:3], pressure=BAR, progress=lambda: None)


@pytest.mark.parametrize("long", [*RUN_ON, "diagnose"])
def test_an_exception_stops_the_work(long, braid, rubbed, tmp_path):
    raised = []

    def tell(share, what):
        if share > 0:
            raised.append(time.monotonic())
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        if long == "evaluate":
            braid.force(LONG, pressure=BAR, method="shooting", progress=tell)
        elif long == "sweep":
            bulge.Sweep(SWEEP).run(tmp_path / "sweep", progress=tell)
        else:
            bulge.diagnose(rubbed.data, rubbed.muscle, progress=tell)
    assert time.monotonic() - raised[0] < 1.0 and len(raised) == 1


def test_other_threads_run_meanwhile(braid, rubbed):
    # A thread that counts while a call is on, against what it counts while nothing is.
    for call in [lambda: braid.force(LONG[::6], pressure=BAR, method="shooting"), lambda: [bulge.diagnose(rubbed.data, rubbed.muscle) for _ in range(1)]]:
        ticks, done = [], threading.Event()

        def tick(ticks=ticks, done=done):
            while not done.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.005)

        thread = threading.Thread(target=tick)
        thread.start()
        began = time.monotonic()
        call()
        ended = time.monotonic()
        done.set()
        thread.join()
        during = [t for t in ticks if began < t < ended]
        assert ended - began > 0.1, "too short to see anything"
        assert len(during) > 0.2 * (ended - began) / 0.005
