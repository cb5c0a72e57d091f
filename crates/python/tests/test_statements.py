"""Rows left out, numbers held, bounded or tied, and predictions: numbers of the documents, those of files without the rows, and the command's."""

import pickle

import bulge
import numpy as np
import pytest

TRIO = ["bladder-elasticity", "coulomb-friction"]


@pytest.fixture(scope="module")
def trial(tmp_path_factory, rubbed):
    """A folder with data.csv and muscle.toml."""
    folder = tmp_path_factory.mktemp("stated")
    rubbed.write(folder)
    return folder


def held_number(rung, effect, name):
    (found,) = [number for number in rung["held"] if (number["effect"], number["name"]) == (effect, name)]
    return found


def fitted_number(rung, effect, name):
    (found,) = [number for number in rung["fit"]["parameters"] if (number["effect"], number["name"]) == (effect, name)]
    return found


@pytest.mark.parametrize("value", ["0.37 MPa", 0.37e6, np.float64(0.37e6), "370 kPa"])
def test_a_held_number_is_held(rubbed, value):
    found = bulge.compare(rubbed.data, rubbed.muscle, TRIO, hold={"bladder-elasticity.modulus": value})
    number = held_number(found.ladder[2], "bladder-elasticity", "modulus")
    assert number["value"] == 0.37 and number["unit"] == "MPa" and number["how"] == "held"
    free = bulge.compare(rubbed.data, rubbed.muscle, TRIO)
    assert not free.ladder[2]["held"] and found.ladder[2]["rmse_n"] > 1.05 * free.ladder[2]["rmse_n"]
    assert found.ladder[2]["fitted"] == free.ladder[2]["fitted"] - 1
    # The name of the effect will do where it has one number.
    assert bulge.compare(rubbed.data, rubbed.muscle, TRIO, hold={"bladder-elasticity": value}).to_json() == found.to_json()


def test_a_bounded_number_stays_between_its_bounds(rubbed):
    free = fitted_number(bulge.compare(rubbed.data, rubbed.muscle, TRIO).ladder[2], "coulomb-friction", "force")
    assert free["value"] == pytest.approx(14.0, abs=1.0)
    for bounds in [(5, 10.0), ("5 N", "10 N"), "5..10 N", ["5 N", 10]]:
        found = bulge.compare(rubbed.data, rubbed.muscle, TRIO, bound={"coulomb-friction.force": bounds})
        number = fitted_number(found.ladder[2], "coulomb-friction", "force")
        assert (number["value"], number["at_bound"]) == (pytest.approx(10.0, abs=1e-9), "upper")


def test_a_tied_number_has_the_value_of_the_other(rubbed):
    two, tie = ["bladder-axial", "coulomb-friction"], {"coulomb-friction.force": "bladder-axial.stiffness"}
    free, found = (bulge.compare(rubbed.data, rubbed.muscle, two, tie=stated) for stated in (None, tie))
    tied, other = held_number(found.ladder[2], "coulomb-friction", "force"), fitted_number(found.ladder[2], "bladder-axial", "stiffness")
    assert tied["value"] == other["value"] > 0 and (tied["how"], tied["to"]) == ("tied", "bladder-axial.stiffness")
    assert found.ladder[2]["fitted"] == free.ladder[2]["fitted"] - 1 and found.ladder[2]["rmse_n"] > free.ladder[2]["rmse_n"]


def test_rows_left_out_are_those_of_a_file_without_them(rubbed, trial, tmp_path):
    lines = (trial / "data.csv").read_text().splitlines(keepends=True)
    # The last sweep; two lines stand before the rows.
    first = 3 + 120
    shorter = tmp_path / "shorter.csv"
    shorter.write_text("".join(lines[: first - 1]))
    theirs = bulge.compare(shorter, rubbed.muscle, TRIO)
    assert len(bulge.read(shorter)) == 120
    everything = bulge.compare(rubbed.data, rubbed.muscle, TRIO)
    for exclude in [f"{first}-{len(lines)}", range(first, len(lines) + 1), [f"{first}-{len(lines) - 1}", len(lines)], np.arange(first, len(lines) + 1)]:
        ours = bulge.compare(rubbed.data, rubbed.muscle, TRIO, exclude=exclude)
        assert (ours.data["used"], theirs.data["used"]) == (120, 120)
        for rung, other, whole in zip(ours.ladder, theirs.ladder, everything.ladder):
            assert rung["rmse_n"] == pytest.approx(other["rmse_n"], rel=1e-6)
            assert abs(whole["rmse_n"] / other["rmse_n"] - 1) > 1e-3
        for effect, name in [("bladder-elasticity", "modulus"), ("coulomb-friction", "force")]:
            numbers = [fitted_number(found.ladder[2], effect, name) for found in (ours, theirs)]
            assert numbers[0]["value"] == pytest.approx(numbers[1]["value"], rel=1e-5)
    assert [left["why"] for left in ours.data["left_out"]] == ["excluded by hand"]


def test_what_is_stated_is_stated_of_fits_diagnoses_and_next_experiments_too(document, rubbed, trial):
    hold, last = {"bladder-elasticity.modulus": "0.3 MPa"}, "123-182"
    files = [trial / "data.csv", "--muscle", trial / "muscle.toml", "--with", "bladder-elasticity"]
    stated = ["--exclude", last, "--hold", "bladder-elasticity.modulus=0.3 MPa"]
    ours = {"exclude": last, "hold": hold}
    data = bulge.read(trial / "data.csv")
    both = {**ours, "bound": {"coulomb-friction.force": (1, "12 N")}}
    theirs = document("fit", *files[:-1], ",".join(TRIO), *stated, "--bound", "coulomb-friction.force=1 N..12 N")
    fitted = bulge.fit(data, rubbed.muscle, TRIO, **both)
    assert fitted.to_dict() == theirs and "bladder-elasticity" not in {p["effect"] for p in fitted.fit["parameters"]}
    compared = bulge.compare(data, rubbed.muscle, "bladder-elasticity", **ours)
    assert compared.to_dict() == document("compare", *files, *stated)
    found = bulge.diagnose(data, rubbed.muscle, "bladder-elasticity", **ours)
    assert found.to_dict() == document("diagnose", *files, *stated) and found.names == ["coulomb-friction"]
    following = bulge.next_experiment(data, rubbed.muscle, "bladder-elasticity", **ours)
    assert following.to_dict() == document("next", *files, *stated)


def test_mistakes_are_said_in_the_sentences_of_the_library(rubbed):
    data, muscle = rubbed.data, rubbed.muscle
    for stated, words in [
        ({"hold": {"coulomb-frction.force": 14.0}}, "hold: .*did you mean `coulomb-friction`"),
        ({"hold": {"coulomb-frction.force": "14 N"}}, "hold: .*did you mean `coulomb-friction`"),
        ({"hold": {"coulomb-friction.force": "14 bar"}}, "hold: .*is a force.*but `14 bar` is a pressure"),
        ({"hold": {"coulomb-friction.force": -3.0}}, "hold: `-3 N` is out of the bounds of `coulomb-friction`"),
        ({"hold": {"coulomb-friction.force": float("nan")}}, "hold: "),
        ({"hold": {"coulomb-friction.force": None}}, "hold: coulomb-friction.force: None is neither"),
        ({"hold": {"self-heating.time": 30.0}}, "`self-heating.time` is held, but it isn't fitted: the model has no `self-heating`: name it in `with_`"),
        ({"hold": "coulomb-friction.force=14 N"}, "hold: .*no mapping"),
        ({"hold": {"coulomb-friction": 14.0}, "bound": {"coulomb-friction.force": "5..20 N"}}, "bound: .*is held and bounded"),
        ({"bound": {"coulomb-friction.force": (20, 5)}}, "bound: `20 N..5 N` is no range"),
        ({"bound": {"coulomb-friction.force": 5}}, "bound: .*no pair"),
        ({"tie": {"coulomb-friction.force": "bladder-elasticity.modulus"}}, "tie: .*only numbers of the same unit"),
        ({"exclude": "x"}, "lines `x`: it is no line and no range of lines"),
        ({"exclude": "900"}, "lines `900`: no row that can be used stands there"),
        ({"exclude": [0]}, "exclude: 0: give a whole number of 1"),
        ({"exclude": "3-182"}, "exclude: these are all rows"),
    ]:
        for ask in (lambda: bulge.compare(data, muscle, TRIO, **stated), lambda: bulge.fit(data, muscle, TRIO, **stated)):
            with pytest.raises(bulge.InputError, match=words):
                ask()


@pytest.fixture(scope="module")
def learnt(rubbed):
    """The muscle that has learnt from the first two pressures."""
    return bulge.fit(rubbed.data, rubbed.muscle, TRIO, exclude="123-182").learnt


def test_a_prediction_is_that_of_the_command(document, command, rubbed, trial, learnt, tmp_path):
    learnt.to_toml(tmp_path / "learnt.toml")
    data = trial / "data.csv"
    for more, exclude in [([], None), (["--exclude", "123-182"], "123-182")]:
        theirs = document("predict", data, "--muscle", tmp_path / "learnt.toml", *more)
        found = bulge.predict(data, learnt, exclude=exclude)
        assert found.to_dict() == theirs
        assert pickle.loads(pickle.dumps(found)).to_dict() == theirs
    assert (bulge.predict(data, learnt).against["rows"], found.against["rows"]) == (180, 120)
    command("predict", data, "--muscle", tmp_path / "learnt.toml", "--out", tmp_path / "rows.csv")
    table = pytest.importorskip("pandas").read_csv(tmp_path / "rows.csv")
    columns = bulge.predict(data, learnt).columns
    for name, heading in [("force_n", "model force [N]"), ("low_n", "low [N]"), ("residual_n", "residual [N]"), ("line", "line"), ("sweep", "sweep")]:
        np.testing.assert_array_equal(columns[name].astype(str), table[heading].to_numpy(columns[name].dtype).astype(str))


def test_a_prediction_of_rows_that_were_not_fitted(rubbed, learnt):
    found = bulge.predict(rubbed.data, learnt)
    columns, data = found.columns, rubbed.data.columns
    inner = np.arange(180) >= 120
    np.testing.assert_array_equal(columns["measured_n"], data["force_n"])
    np.testing.assert_allclose(columns["residual_n"], data["force_n"] - columns["force_n"], atol=1e-9)
    np.testing.assert_array_equal(columns["line"], np.arange(3, 183))
    # What was hidden is predicted at the pressure that wasn't fitted, as far as the noise goes: 2 N.
    assert np.sqrt(np.mean(columns["residual_n"][inner] ** 2)) == pytest.approx(2.0, rel=0.4)
    assert found.against["rmse_n"] == pytest.approx(np.sqrt(np.mean(columns["residual_n"] ** 2)), rel=1e-9)
    within = np.mean((columns["measured_n"] >= columns["low_n"]) & (columns["measured_n"] <= columns["high_n"]))
    assert within == pytest.approx(found.against["coverage"], abs=1e-9) and within > 0.9
    assert {number["effect"] for number in found.uncertain} >= set(TRIO)
    assert "180 of 180 rows have a state" in repr(found) and "moves [N]" in repr(found)
    assert found.to_pandas()["force_n"].to_numpy() == pytest.approx(columns["force_n"])
    plain = bulge.predict(rubbed.data, rubbed.muscle)
    assert plain.against["rmse_n"] > 40 and any("fitted" in warning for warning in plain.warnings)


def test_rows_without_a_force_are_predicted_alike(rubbed, learnt, tmp_path):
    pandas = pytest.importorskip("pandas")
    frame = rubbed.data.to_pandas().drop(columns="force_n")
    with pytest.raises(bulge.InputError, match="force"):
        bulge.read(frame)
    silent = bulge.read(frame, force_may_lack=True)
    assert not silent.has_force and "force_n" not in silent.columns and "no force" in repr(silent)
    found, whole = bulge.predict(silent, learnt), bulge.predict(rubbed.data, learnt)
    np.testing.assert_allclose(found.columns["force_n"], whole.columns["force_n"], rtol=1e-9)
    assert found.against is None and not {"measured_n", "residual_n"} & set(found.columns)
    assert not pickle.loads(pickle.dumps(silent)).has_force and isinstance(found.to_pandas(), pandas.DataFrame)
    for ask in (lambda: bulge.compare(silent, learnt), lambda: bulge.fit(silent, learnt, TRIO), lambda: bulge.diagnose(silent, learnt), silent.plot):
        with pytest.raises(bulge.InputError, match="no force was measured"):
            ask()
