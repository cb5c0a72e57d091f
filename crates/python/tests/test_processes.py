"""What happens around a call: callbacks that call again, forked children, copies, other processes."""

import copy
import multiprocessing
import pickle
import threading

import bulge
import numpy as np
import pytest

CONTRACTION = np.linspace(0.05, 0.2, 1000)


def test_a_callback_runs_on_the_callers_thread_and_may_call_again(ppam):
    heard = []

    def told(share, what):
        heard.append((threading.current_thread(), share, float(ppam.force(CONTRACTION, pressure=1e5)[0])))

    ppam.force(np.tile(CONTRACTION, 200), pressure=1e5, progress=told)
    threads, shares, forces = zip(*heard)
    assert set(threads) == {threading.current_thread()} and shares[-1] == 1.0
    assert set(forces) == {ppam.force(0.05, pressure=1e5)}


def _child(muscle, answers):
    answers.put(float(muscle.force(CONTRACTION, pressure=1e5).sum()))


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="nothing forks here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_child_has_threads_of_its_own(ppam):
    expected = float(ppam.force(CONTRACTION, pressure=1e5).sum())
    fork = multiprocessing.get_context("fork")
    answers = fork.Queue()
    child = fork.Process(target=_child, args=(ppam, answers))
    child.start()
    assert answers.get(timeout=20) == expected
    child.join(20)
    assert child.exitcode == 0


TUBE = """
name = "tube"
[mesher]
kind = "tube"
radius = "10 mm"
length = "60 mm"
cells = [20]
order = 2
[[material]]
name = "rubber"
law = "neo-hooke"
thickness = "1 mm"
shear = "0.4 MPa"
[[part]]
group = "wall"
kind = "sheet"
material = "rubber"
[[step]]
pressure = "30 kPa"
states = 2
"""


def _writing_child(out, answers):
    answers.put(len(bulge.membrane(TUBE, out).to_dict()["states"]))


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="nothing forks here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_child_writes_as_its_parent_did(tmp_path):
    """States are written by a thread, which must not wait for threads that a child doesn't have."""
    expected = len(bulge.membrane(TUBE, tmp_path / "parent").to_dict()["states"])
    fork = multiprocessing.get_context("fork")
    answers = fork.Queue()
    child = fork.Process(target=_writing_child, args=(tmp_path / "child", answers))
    child.start()
    assert answers.get(timeout=20) == expected == 2
    child.join(20)
    assert child.exitcode == 0
    names = [sorted(file.name for file in (tmp_path / who).iterdir()) for who in ("parent", "child")]
    assert names[0] == names[1]


@pytest.mark.parametrize("output", ["volume", "force_f", "volume_v", "max_radius"])
def test_no_pressure_is_made_up(ppam, output):
    """Where nothing stretches the pressure does nothing; where something does, it is asked for."""
    assert ppam.evaluate(output, 0.2) == pytest.approx(ppam.evaluate(output, 0.2, pressure=3e5), rel=1e-12)
    stretching = bulge.Muscle(kind="pleated", length="110 mm", radius=0.016, fibres=40, fibre={"stiffness": "1 kN"})
    bladder = bulge.Muscle(
        kind="braided", length="250 mm", radius="10 mm", braid_angle="25 deg", wall="2 mm", effects={"bladder-elasticity": {"c10": "0.2 MPa"}}
    )
    for muscle in (stretching, bladder):
        with pytest.raises(bulge.InputError, match="pressure: the shape of this muscle depends on it"):
            muscle.evaluate(output, 0.1)
        assert muscle.evaluate(output, 0.1, pressure=3e5) != pytest.approx(muscle.evaluate(output, 0.1, pressure=1e5), rel=1e-3)
    with pytest.raises(bulge.InputError, match="depends on it"):
        ppam.evaluate(output, 0.2, fibre_stiffness=1000.0)
    # The elastic group says how much the fibres stretch, at any pressure.
    group = {"elastic_group": 1e-3}
    assert stretching.evaluate(output, 0.2, **group) == pytest.approx(stretching.evaluate(output, 0.2, pressure=7e5, **group), rel=1e-9)


def test_copies_keep_their_report_and_pickles_their_numbers(rubbed):
    found = bulge.compare(rubbed.data, rubbed.muscle)
    assert copy.deepcopy(copy.copy(found)).to_html() == found.to_html()
    travelled = pickle.loads(pickle.dumps(found))
    assert travelled.to_dict() == found.to_dict()
    with pytest.raises(bulge.InputError, match="left its report behind"):
        travelled.to_html()


def test_measurements_that_changed_on_their_way_are_refused(tmp_path, monkeypatch):
    file = tmp_path / "data.csv"
    file.write_text("pressure [bar],contraction [%],force [N]\n1,5,100\n1,6,90\n")
    monkeypatch.chdir(tmp_path)
    travelling = pickle.dumps(bulge.read("data.csv"))
    monkeypatch.chdir("/")
    assert len(pickle.loads(travelling)) == 2
    file.write_text("pressure [bar],contraction [%],force [N]\n1,5,100\n")
    with pytest.raises(bulge.InputError, match="changed while these measurements travelled"):
        pickle.loads(travelling)


def test_a_named_index_is_a_column():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"time [s]": [0, 1, 2], "pressure [bar]": [1, 1, 1], "contraction [%]": [5, 6, 7], "force [N]": [100, 90, 80]})
    assert bulge.read(frame.set_index("time [s]")).columns["time_s"].tolist() == [0, 1, 2]


def test_own_effects_may_be_stated_twice_in_any_order():
    parameters = {"k": bulge.Parameter("N", typical="5 N", low=0, high="1 kN", prior=("5 N", "2 N"))}
    one, other = (bulge.Effect(name, "-k * eps", parameters=parameters) for name in ("aa-effect", "bb-effect"))
    muscle = bulge.Muscle(kind="pleated", length=0.11, radius=0.016, fibres=40, own=[one, other], effects={"aa-effect": {"k": 5.0}})
    protocol = '[[block]]\npressures = ["1 bar", "2 bar", "3 bar"]\ncontraction = "5 %..25 %"\nshape = "static"\nrows = 20\n[noise]\nforce = "1 N"\n'
    made = bulge.simulate(muscle, protocol, {"bb-effect": 50.0}, own=[other, one], seed=2)
    learnt = bulge.fit(made.data, made.muscle, "bb-effect", own=[other, one]).learnt
    assert sorted(learnt.effects) == ["aa-effect", "bb-effect"]
    assert parameters["k"].prior == (5.0, 2.0) and parameters["k"].high == 1000.0


def test_quantities_keep_their_unit_in_powers():
    area = bulge.quantity("2 mm") ** 2
    assert float(area) == pytest.approx(4e-6)
    effect = bulge.Effect("own", lambda length, k: k * length**2 / area, parameters={"k": bulge.Parameter("N")})
    assert "[mm]" in effect.expression
    with pytest.raises(bulge.InputError, match="more than 16000 characters"):
        bulge.Effect("long", _doubling, parameters={"k": bulge.Parameter("N")})


def _doubling(eps, k):
    for _ in range(40):
        eps = eps + np.sin(eps)
    return k * eps
