"""The documents of the package are those of the command line (BULGE_COMMAND names it)."""

import bulge
import pytest

FILES = {"columns", "files"}


@pytest.fixture(scope="module")
def trial(tmp_path_factory, rubbed):
    """A folder with data.csv, muscle.toml, protocol.toml."""
    folder = tmp_path_factory.mktemp("trial")
    rubbed.write(folder)
    return folder


@pytest.fixture(scope="module")
def data(trial):
    return bulge.read(trial / "data.csv")


@pytest.fixture
def protocol_file(trial, protocol):
    path = trial / "protocol.toml"
    path.write_text(protocol)
    return path


def without_files(found):
    """A document without names of files."""
    if isinstance(found, dict):
        return {key: without_files(value) for key, value in found.items() if key not in FILES}
    return [without_files(value) for value in found] if isinstance(found, list) else found


@pytest.mark.parametrize("given", [("contraction", "20 %"), ("length", "90 mm"), ("force", "500 N"), ("volume", "300 ml")])
def test_shape(document, given):
    name, value = given
    theirs = document("shape", "ppam-2-r16", "--pressure", "2 bar", f"--{name}", value, "--points", 31)
    ours = bulge.Muscle.preset("ppam-2-r16").shape(pressure="2 bar", points=31, **{name: value})
    assert ours.to_dict() == theirs and len(theirs["meridian"]) == 31


@pytest.mark.parametrize("preset", sorted(bulge.presets()))
def test_shape_of_every_preset(document, preset):
    theirs = document("shape", preset, "--pressure", "3 bar", "--contraction", "12 %", "--method", "shooting")
    assert bulge.Muscle.preset(preset).shape(pressure=3e5, contraction=0.12, method="shooting").to_dict() == theirs


def test_vtk(command, tmp_path):
    command("shape", "dmsp-20-250", "--pressure", "3 bar", "--contraction", "12 %", "--vtk", tmp_path / "theirs.vtp")
    bulge.Muscle.preset("dmsp-20-250").shape(pressure="3 bar", contraction="12 %").write_vtk(tmp_path / "ours.vtp")
    assert (tmp_path / "ours.vtp").read_bytes() == (tmp_path / "theirs.vtp").read_bytes()


def test_presets(command):
    for name in bulge.presets():
        assert bulge.Muscle.from_toml(command("muscle", name)) == bulge.Muscle.preset(name)


@pytest.mark.parametrize("effects", ["", "bladder-elasticity,coulomb-friction"])
def test_compare(document, trial, data, rubbed, effects):
    theirs = document("compare", trial / "data.csv", "--muscle", trial / "muscle.toml", *(["--with", effects] if effects else []))
    assert bulge.compare(data, rubbed.muscle, effects).to_dict() == theirs


def test_compare_with_a_law(document, trial, data, rubbed):
    theirs = document("compare", trial / "data.csv", "--muscle", trial / "muscle.toml", "--law", "s2-cylinder", "--fit-law", "--rivals")
    assert bulge.compare(data, rubbed.muscle, law="s2-cylinder", fit_law=True, rivals=True).to_dict() == theirs


def test_diagnose(document, trial, data, rubbed):
    theirs = document("diagnose", trial / "data.csv", "--muscle", trial / "muscle.toml", "--seed", 3)
    ours = bulge.diagnose(data, rubbed.muscle, seed=3)
    assert ours.to_dict() == theirs
    # From memory it is the same but for the name of the file.
    assert without_files(bulge.diagnose(rubbed.data, rubbed.muscle, seed=3).to_dict()) == without_files(theirs)
    theirs = document("diagnose", trial / "data.csv", "--muscle", trial / "muscle.toml", "--with", "bladder-elasticity", "--tolerance", "20 N")
    assert bulge.diagnose(data, rubbed.muscle, "bladder-elasticity", tolerance="20 N").to_dict() == theirs


def test_reports(command, trial, data, rubbed, tmp_path):
    command("diagnose", trial / "data.csv", "--muscle", trial / "muscle.toml", "--out", tmp_path / "theirs")
    bulge.diagnose(data, rubbed.muscle).report(tmp_path / "ours")
    names = sorted(path.name for path in (tmp_path / "theirs").iterdir())
    assert sorted(path.name for path in (tmp_path / "ours").iterdir()) == names
    for name in names:
        if not name.endswith(".json"):
            assert (tmp_path / "ours" / name).read_bytes() == (tmp_path / "theirs" / name).read_bytes(), name


def test_fit(document, trial, data, rubbed):
    theirs = document("fit", trial / "data.csv", "--muscle", trial / "muscle.toml", "--with", "bladder-elasticity,coulomb-friction")
    assert bulge.fit(data, rubbed.muscle, ["bladder-elasticity", "coulomb-friction"]).to_dict() == theirs


def test_plan(document, trial, rubbed, protocol_file, protocol):
    theirs = document("plan", "--muscle", trial / "muscle.toml", "--protocol", protocol_file)
    assert bulge.plan(rubbed.muscle, protocol_file).to_dict() == theirs == bulge.plan(rubbed.muscle, protocol).to_dict()


@pytest.mark.parametrize("limits", [{}, {"pressure": "1 bar..6 bar", "contraction": "0 %..25 %"}])
def test_next_experiment(document, trial, data, rubbed, limits):
    stated = [text for name, value in limits.items() for text in (f"--{name}", value)]
    theirs = document("next", trial / "data.csv", "--muscle", trial / "muscle.toml", *stated, "--seed", 2)
    assert bulge.next_experiment(data, rubbed.muscle, seed=2, **limits).to_dict() == theirs


def test_simulate(document, cylinder, protocol_file, trial, tmp_path):
    hidden = "coulomb-friction=14 N,bladder-elasticity=0.3 MPa"
    theirs = document("simulate", trial / "muscle.toml", "--protocol", protocol_file, "--with", hidden, "--seed", 11, "--out", tmp_path / "theirs")
    ours = bulge.simulate(cylinder, protocol_file, hidden, seed=11)
    assert ours.to_dict() == theirs
    ours.write(tmp_path / "ours")
    for name in ["data.csv", "muscle.toml"]:
        assert (tmp_path / "ours" / name).read_bytes() == (tmp_path / "theirs" / name).read_bytes()


def test_own_effects(document, trial, data, rubbed, tmp_path):
    effect = bulge.Effect("hose", lambda eps, k: -k * eps, parameters={"k": bulge.Parameter("N", typical=50, low=0, high=500)})
    (tmp_path / "own.toml").write_text(effect.to_toml())
    theirs = document("fit", trial / "data.csv", "--muscle", trial / "muscle.toml", "--with", "bladder-elasticity,hose", "--effects", tmp_path / "own.toml")
    for own in [effect, tmp_path / "own.toml"]:
        assert bulge.fit(data, rubbed.muscle, "bladder-elasticity,hose", own=own).to_dict() == theirs


def test_effect_cards(document):
    for name in ["coulomb-friction", "bladder-elasticity"]:
        assert bulge.effects(name).to_dict() == document("effects", name)["effect"]


def test_table(document, small_table, tmp_path):
    table = bulge.Sweep(small_table).table()
    (tmp_path / "table.bulge").write_bytes(table.to_bytes())
    assert table.to_dict() == document("table", "info", tmp_path / "table.bulge")


def test_refusals_are_the_same_sentences(command):
    import os
    import subprocess

    wrong = [os.environ["BULGE_COMMAND"], "shape", "ppam-2-r16", "--pressure", "1 bar", "--contraction", "70 %"]
    said = subprocess.run(wrong, capture_output=True, text=True, check=False)
    with pytest.raises(bulge.NoSolutionError) as caught:
        bulge.Muscle.preset("ppam-2-r16").shape(pressure="1 bar", contraction="70 %")
    assert said.returncode == 3 and str(caught.value) in said.stderr
