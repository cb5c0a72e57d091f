"""Model against measurement: what is hidden in simulated measurements is found, with its number."""

import json
import pickle
import xml.etree.ElementTree as xml

import bulge
import numpy as np
import pytest

BAR = 1e5
HIDDEN = {"coulomb-friction": (14.0, "force", 1.0), "bladder-elasticity": (0.3, "modulus", 1.0)}


def test_the_same_seed_gives_the_same_bytes(cylinder, protocol, rubbed, tmp_path):
    hidden = {"coulomb-friction": "14 N", "bladder-elasticity": "0.3 MPa"}
    again = bulge.simulate(cylinder, protocol, hidden, seed=7)
    assert (again.csv, again.to_dict(), again.muscle) == (rubbed.csv, rubbed.to_dict(), rubbed.muscle)
    assert bulge.simulate(cylinder, protocol, hidden, seed=8).csv != rubbed.csv
    for same in [
        ["coulomb-friction=14 N", "bladder-elasticity=0.3 MPa"],
        "coulomb-friction=14 N,bladder-elasticity=0.3 MPa",
        {"coulomb-friction": {"force": "14 N"}, "bladder-elasticity": ("0.3 MPa",)},
    ]:
        assert bulge.simulate(cylinder, protocol, same, seed=7).csv == rubbed.csv
    (tmp_path / "protocol.toml").write_text(protocol)
    assert bulge.simulate(cylinder, tmp_path / "protocol.toml", hidden, seed=7).csv == rubbed.csv


def test_simulated_measurements_are_the_model_with_noise(cylinder, protocol, rubbed):
    data = rubbed.data.columns
    assert rubbed.rows == len(rubbed.data) == 180 and rubbed.seed == 7 and rubbed.muscle == cylinder
    assert {e["effect"]: e["numbers"][0]["value"] for e in rubbed.effects} == {"coulomb-friction": 14.0, "bladder-elasticity": 0.3}
    np.testing.assert_array_equal(np.unique(data["pressure_pa"]), [2 * BAR, 3 * BAR, 4 * BAR])
    rubber = bulge.Muscle(
        kind="braided", length="250 mm", radius="10.725 mm", braid_angle="25 deg", ends="cylinder", wall="2 mm", effects={"bladder-elasticity": {"c10": 3e5}}
    )
    rest = data["force_n"] - rubber.force(data["contraction"], pressure=data["pressure_pa"])
    turning = np.sign(np.gradient(data["contraction"]))
    inner = (data["contraction"] > 0.02) & (data["contraction"] < 0.19)
    # Friction works against the motion: it takes from the force while the muscle shortens.
    for direction in (1, -1):
        assert np.mean(rest[inner & (turning == direction)]) == pytest.approx(-14 * direction, abs=1.0)
    assert np.std((rest + 14 * turning)[inner & (turning != 0)]) == pytest.approx(2.0, rel=0.25)


def test_the_error_falls_as_effects_are_added(rubbed):
    found = bulge.compare(rubbed.data, rubbed.muscle, ["bladder-elasticity", "coulomb-friction"])
    errors = [rung["rmse_n"] for rung in found.ladder]
    assert [rung["added"] for rung in found.ladder] == [None, "bladder-elasticity", "coulomb-friction"]
    data = rubbed.data.columns
    stated = data["force_n"] - rubbed.muscle.force(data["contraction"], pressure=data["pressure_pa"])
    # The error of the first rung may have the zero of the load cell fitted, no more.
    assert np.std(stated) * 0.99 < errors[0] <= np.sqrt(np.mean(stated**2)) * (1 + 1e-9)
    assert errors[0] > 40 > 16 > errors[1] > 10 > 2.3 > errors[2] > 1.7
    assert found.ladder[2]["held_out_rmse_n"] == pytest.approx(errors[2], rel=0.1)
    assert "+ coulomb-friction" in repr(found) and f"{errors[1]:.3g}" in repr(found) and "<table>" in found._repr_html_()
    assert bulge.compare(rubbed.data.to_pandas(), rubbed.muscle, "bladder-elasticity, coulomb-friction").ladder[2]["rmse_n"] == pytest.approx(errors[2], rel=1e-12)


def test_a_fit_recovers_what_is_hidden(rubbed, cylinder):
    found = bulge.fit(rubbed.data, rubbed.muscle, list(HIDDEN))
    numbers = {p["effect"]: p for p in found.fit["parameters"]}
    for effect, (true, name, widest) in HIDDEN.items():
        p = numbers[effect]
        assert p["name"] == name and p["low"] <= true <= p["high"] and p["high"] - p["low"] < widest
        assert p["value"] == pytest.approx(true, rel=0.03)
    assert found.before_rmse_n > 40 and found.rmse_n == pytest.approx(2.0, rel=0.2)
    learnt = found.learnt
    true = bulge.Muscle(
        kind="braided", length="250 mm", radius="10.725 mm", braid_angle="25 deg", ends="cylinder", wall="2 mm", effects={"bladder-elasticity": {"c10": 3e5}}
    )
    e = np.linspace(0.01, 0.2, 9)[:, None]
    p = np.array([2.5, 5.0]) * BAR
    np.testing.assert_allclose(learnt.force(e, pressure=p), true.force(e, pressure=p), atol=5.0)
    assert np.abs(cylinder.force(e, pressure=p) - true.force(e, pressure=p)).max() > 40
    assert pickle.loads(pickle.dumps(found)).learnt == learnt
    # The muscle that has learnt lacks nothing.
    assert bulge.compare(rubbed.data, learnt).ladder[0]["rmse_n"] == pytest.approx(found.rmse_n, rel=0.02)


def test_the_hidden_effects_are_named(rubbed, diagnosed):
    assert diagnosed.verdict == "missing" and set(diagnosed.names) == set(HIDDEN)
    for missing in diagnosed.missing:
        true, name, _ = HIDDEN[missing["effect"]]
        number = missing["parameters"][name]
        assert number["low"] <= true <= number["high"] and 0.5 < missing["confidence"] <= 1 and missing["effect"] in missing["class"]
    assert any("bladder-elasticity" in line for line in diagnosed.says)
    assert "coulomb-friction" in repr(diagnosed) and diagnosed.ladder[-1]["adequate"]
    assert bulge.diagnose(rubbed.data, rubbed.muscle, seed=1).to_json() == diagnosed.to_json()


def test_what_is_known_is_not_missing(rubbed):
    found = bulge.diagnose(rubbed.data, rubbed.muscle, "bladder-elasticity")
    assert found.names == ["coulomb-friction"]
    among = bulge.diagnose(rubbed.data, rubbed.muscle, "bladder-elasticity", among=["coulomb-friction", "creep"])
    assert among.names == ["coulomb-friction"] and {c["effect"] for c in among.to_dict()["candidates"]} == {"coulomb-friction", "creep"}
    with pytest.raises(bulge.InputError, match="frictoin"):
        bulge.diagnose(rubbed.data, rubbed.muscle, among="frictoin")
    # 14 N of friction are no matter where 100 N are none.
    assert bulge.diagnose(rubbed.data, rubbed.muscle, tolerance="100 N").verdict == "adequate"
    with pytest.raises(bulge.InputError, match="tolerance"):
        bulge.diagnose(rubbed.data, rubbed.muscle, tolerance=-1.0)


def test_nothing_hidden_is_adequate(cylinder, protocol):
    plain = bulge.simulate(cylinder, protocol, seed=3)
    found = bulge.diagnose(plain.data, plain.muscle)
    assert (found.verdict, found.names, plain.effects) == ("adequate", [], [])
    assert "hidden: nothing" in repr(plain)


def hose(eps, k, eps_free):
    """An effect of one's own."""
    return -k * np.maximum(eps - eps_free, 0)


NUMBERS = {"k": bulge.Parameter("N", typical=100, low=0, high=2000), "eps_free": bulge.Parameter("1", typical=0.1, low=0.05, high=0.15)}


def test_an_effect_of_ones_own_is_simulated_fitted_and_found(cylinder, protocol):
    traced = bulge.Effect("hose", hose, parameters=NUMBERS, title="Hose")
    written = bulge.Effect("hose", "(-k) * max(eps - eps_free, 0)", parameters=NUMBERS, title="Hose")
    hidden = {"hose": {"k": "900 N", "eps_free": "0.1"}}
    made, same = (bulge.simulate(cylinder, protocol, hidden, own=own, seed=5) for own in (traced, written))
    assert made.csv == same.csv
    fits = [bulge.fit(made.data, cylinder, "hose", own=own) for own in (traced, written)]
    assert fits[0].to_json() == fits[1].to_json()
    numbers = {p["name"]: p for p in fits[0].fit["parameters"] if p["effect"] == "hose"}
    assert numbers["k"]["low"] <= 900 <= numbers["k"]["high"] and numbers["eps_free"]["value"] == pytest.approx(0.1, abs=0.01)
    learnt = fits[0].learnt
    assert learnt.force(0.2, pressure=3 * BAR) - cylinder.force(0.2, pressure=3 * BAR) == pytest.approx(-90, abs=4)
    found = [bulge.diagnose(made.data, cylinder, own=own) for own in (traced, written)]
    assert found[0].to_json() == found[1].to_json() and found[0].verdict == "missing"
    assert "hose" in [name for missing in found[0].missing for name in missing["class"]]


@pytest.fixture(scope="module")
def sprung(cylinder, protocol):
    """A spring that stiffens, which the catalogue has as a straight one."""
    spring = bulge.Effect("spring", "-k * eps * (1 + 20 * eps^2)", parameters={"k": bulge.Parameter("N", typical=1500, low=0, high=5000)})
    return bulge.simulate(cylinder, protocol, {"spring": "1500 N"}, own=spring, seed=5)


def test_the_form_that_the_data_want_is_an_effect_of_ones_own(sprung, cylinder, tmp_path):
    fitted = bulge.fit(sprung.data, cylinder, "bladder-axial", form_error=True)
    (bent,) = fitted.bent
    assert (bent["effect"], bent["written"]) == ("bladder-axial", "bladder-axial-bent") and bent["says"] in repr(fitted)
    # What no straight line through the origin follows of the spring; zeros of the rig take a little of it.
    e = sprung.data.columns["contraction"]
    force = 1500 * e * (1 + 20 * e**2)
    rest = force - e * (force @ e) / (e @ e)
    assert bent["newtons"] == pytest.approx(np.sqrt(np.mean(rest**2)), rel=0.3)
    # A share in units of the noise, part of which is correlated or the rig's.
    assert bent["share"] == pytest.approx(bent["newtons"] / np.sqrt(np.mean(force**2)), rel=1.0) and bent["share"] > 0.05
    straight = bulge.compare(sprung.data, cylinder, "bladder-axial").ladder[1]["rmse_n"]
    own = bulge.compare(sprung.data, cylinder, "bladder-axial-bent", own=fitted.drawn)
    assert own.ladder[1]["rmse_n"] == pytest.approx(2.0, rel=0.2) and straight > 1.5 * own.ladder[1]["rmse_n"]
    # As a file, as the command line writes it, and elsewhere.
    file = tmp_path / "bent.toml"
    file.write_text(fitted.drawn)
    assert bulge.compare(sprung.data, cylinder, "bladder-axial-bent", own=file).to_json() == own.to_json()
    assert "95 % interval" in fitted.drawn and fitted.to_dict()["drawn"]["forms"][0]["toml"] == fitted.drawn
    travelled = pickle.loads(pickle.dumps(fitted))
    assert (travelled.drawn, travelled.bent, travelled.learnt) == (fitted.drawn, fitted.bent, fitted.learnt)


def test_a_formula_that_is_exact_has_no_other_form(sprung, cylinder):
    fitted = bulge.fit(sprung.data, cylinder, "radius-error", form_error=True)
    (bent,) = fitted.bent
    assert (fitted.drawn, bent["share"], bent["newtons"], bent["written"]) == ("", 0, 0, None) and "exact" in bent["says"]
    plain = bulge.fit(sprung.data, cylinder, "radius-error")
    assert "drawn" not in plain
    for ask in (lambda: plain.drawn, lambda: plain.bent):
        with pytest.raises(bulge.InputError, match="form_error=True"):
            ask()


def test_an_effect_that_is_bent_has_two_rungs(sprung, cylinder):
    found = bulge.diagnose(sprung.data, cylinder)
    assert [(rung["added"], rung["bent"]) for rung in found.ladder] == [(None, False), ("bladder-axial", False), ("bladder-axial", True)]
    assert found.ladder[1]["rmse_n"] > 1.5 * found.ladder[2]["rmse_n"] and found.ladder[2]["held_out_rmse_n"] is None
    for rung in ("+ bladder-axial, by its formula", "+ bladder-axial, as the data want it"):
        assert rung in repr(found) and rung in found._repr_html_()
    pytest.importorskip("matplotlib").use("Agg")
    assert [bar.get_height() for bar in found.plot().patches] == [rung["rmse_n"] for rung in found.ladder]


def test_the_muscle_of_a_simulation_brings_its_own_effects(cylinder, protocol):
    own = bulge.Effect("hose", hose, parameters=NUMBERS, title="Hose")
    made = bulge.simulate(cylinder, protocol, {"hose": {"k": "900 N", "eps_free": "0.1"}}, own=own, seed=5)
    assert bulge.fit(made.data, made.muscle, "hose").learnt.effects == ["hose"]
    assert bulge.fit(made.data, made.muscle, "hose", own=own).learnt.effects == ["hose"]


def test_laws_and_rivals(rubbed):
    plain, law = bulge.compare(rubbed.data, rubbed.muscle, rivals=True), bulge.compare(rubbed.data, rubbed.muscle, law="s2-cylinder")
    # The law of the cylinder is the equilibrium of the cylinder.
    assert law.ladder[0]["rmse_n"] == pytest.approx(plain.ladder[0]["rmse_n"], rel=1e-6)
    fitted = bulge.compare(rubbed.data, rubbed.muscle, law="s3-eight", fit_law=True)
    assert 13 < fitted.ladder[0]["rmse_n"] < 16
    assert len(plain.rivals) > 3 and not law.rivals
    with pytest.raises(bulge.InputError, match="law: .*colour"):
        bulge.compare(rubbed.data, rubbed.muscle, law="colour")


def test_before_measuring(cylinder, protocol):
    found = bulge.plan(cylinder, protocol)
    limits = {effect["effect"]: effect for effect in found.effects}
    assert (found.rows, found.sweeps) == (180, 3)
    friction = limits["coulomb-friction"]
    # 180 rows with 2 N: friction is seen from about 3.29 sigma on.
    assert friction["unit"] == "N" and friction["detection_limit"] == pytest.approx(3.29 * 2 / np.sqrt(180), rel=0.1)
    half = bulge.plan(cylinder, protocol.replace('force = "2 N"', 'force = "4 N"', 1))
    assert {e["effect"]: e for e in half.effects}["coulomb-friction"]["detection_limit"] == pytest.approx(2 * friction["detection_limit"], rel=0.05)
    assert "coulomb-friction" in repr(found) and "<table>" in found._repr_html_()


def test_the_next_experiment(rubbed):
    found = bulge.next_experiment(rubbed.data, rubbed.muscle, pressure="1 bar..6 bar", contraction=(0.0, 0.2))
    assert found.verdict == "missing" and {m["effect"] for m in found.missing} == set(HIDDEN)
    assert found.says and "coulomb-friction" in found.says and found.says in repr(found)
    for wrong in ["1 bar", "6 bar..1 bar", ("1 bar", "2 N")]:
        with pytest.raises(bulge.InputError, match="pressure"):
            bulge.next_experiment(rubbed.data, rubbed.muscle, pressure=wrong)


@pytest.mark.parametrize("kind", ["diagnosis", "compare"])
def test_reports(kind, rubbed, diagnosed, tmp_path):
    found = diagnosed if kind == "diagnosis" else bulge.compare(rubbed.data, rubbed.muscle, "coulomb-friction")
    page = found.report(tmp_path / "report")
    assert page == tmp_path / "report" / "report.html" and page.read_text(encoding="utf-8") == found.to_html()
    assert "coulomb-friction" in found.to_html()
    # The only script that may run is the one of the plots, by its hash, and nothing is loaded from elsewhere.
    assert "script-src 'sha256-" in found.to_html() and "default-src 'none'" in found.to_html() and " src=\"http" not in found.to_html()
    assert json.loads((tmp_path / "report" / f"{kind}.json").read_text()) == found.to_dict()
    drawings = found.svgs()
    assert {"ladder", "residual-map"} <= set(drawings)
    for name, svg in drawings.items():
        assert xml.fromstring(svg).tag.endswith("svg") and (tmp_path / "report" / f"{name}.svg").read_text(encoding="utf-8") == svg
    assert not list((tmp_path / "report").glob(".unfinished*"))


def test_results_travel(rubbed, diagnosed, cylinder, protocol):
    for found in [diagnosed, bulge.compare(rubbed.data, rubbed.muscle), bulge.plan(cylinder, protocol), rubbed]:
        other = pickle.loads(pickle.dumps(found))
        assert other.to_dict() == found.to_dict() and repr(other) == repr(found) and type(other) is type(found)
    assert pickle.loads(pickle.dumps(diagnosed)).says == diagnosed.says
    assert pickle.loads(pickle.dumps(rubbed)).data.sha256 == rubbed.data.sha256
    with pytest.raises(bulge.InputError, match="left its report behind"):
        pickle.loads(pickle.dumps(diagnosed)).to_html()
    copied = diagnosed.to_dict()
    copied["missing"].clear()
    assert diagnosed.missing


def test_a_simulation_as_files(rubbed, tmp_path):
    rubbed.write(tmp_path / "trial")
    assert bulge.read(tmp_path / "trial" / "data.csv").sha256 == rubbed.data.sha256
    assert bulge.Muscle.from_toml(tmp_path / "trial" / "muscle.toml") == rubbed.muscle
    assert json.loads((tmp_path / "trial" / "truth.json").read_text()) == rubbed.to_dict()


def test_mistakes_are_said_with_their_cure(rubbed, cylinder, protocol):
    for wrong, words in [
        (lambda: bulge.fit(rubbed.data, rubbed.muscle, []), "name the effects"),
        (lambda: bulge.fit(rubbed.data, rubbed.muscle, "coulomb-frction"), "coulomb-friction"),
        (lambda: bulge.compare("none.csv", cylinder), r"none\.csv"),
        (lambda: bulge.simulate(cylinder, protocol, "coulomb-friction=14 bar"), "coulomb-friction|force"),
        (lambda: bulge.simulate(cylinder, "none.toml"), r"none\.toml"),
        (lambda: bulge.plan(cylinder, protocol.replace("rows", "lines")), "lines"),
    ]:
        with pytest.raises(bulge.InputError, match=words):
            wrong()


def test_residuals_are_rows(rubbed):
    found = bulge.compare(rubbed.data, rubbed.muscle, ["bladder-elasticity", "coulomb-friction"])
    columns, data = found.columns, rubbed.data.columns
    assert found.residuals.shape == (180,) and columns["counts"].all()
    np.testing.assert_array_equal(columns["measured_n"], data["force_n"])
    np.testing.assert_array_equal(found.residuals, columns["measured_n"] - columns["model_n"])
    for name, rung in [("base_n", 0), ("model_n", -1)]:
        rms = np.sqrt(np.mean((columns["measured_n"] - columns[name]) ** 2))
        assert rms == pytest.approx(found.ladder[rung]["rmse_n"], rel=1e-9)
    np.testing.assert_allclose(columns["pressure_pa"], data["pressure_pa"], rtol=1e-12)
    assert set(columns["line"]) == set(range(3, 183)) and len(set(columns["sweep"])) == 3
    frame = found.to_pandas() if pytest.importorskip("pandas") else None
    assert {"line", "sweep", "contraction", "pressure_pa", "measured_n", "model_n", "residual_n"} <= set(frame.columns)
    with pytest.raises(bulge.InputError, match="left its report behind"):
        pickle.loads(pickle.dumps(found)).residuals


def test_a_fit_has_rows_and_a_plot(rubbed):
    fitted = bulge.fit(rubbed.data, rubbed.muscle, ["bladder-elasticity", "coulomb-friction"], exclude="123-182")
    columns = fitted.columns
    assert columns["counts"].sum() == 120 and fitted.residuals.shape == (180,)
    rms = np.sqrt(np.mean(fitted.residuals[columns["counts"]] ** 2))
    assert rms == pytest.approx(fitted.rmse_n, rel=1e-9) and len(fitted.to_pandas()) == 180
    pytest.importorskip("matplotlib").use("Agg")
    assert len(fitted.plot().lines) == 6
    with pytest.raises(bulge.InputError, match="left its rows behind"):
        pickle.loads(pickle.dumps(fitted)).plot()


def test_plots(rubbed, diagnosed):
    pytest.importorskip("matplotlib").use("Agg")
    ax = diagnosed.plot()
    assert [bar.get_height() for bar in ax.patches] == [rung["rmse_n"] for rung in diagnosed.ladder]
    assert len(bulge.compare(rubbed.data, rubbed.muscle, "coulomb-friction").plot().lines) == 9


def test_how_sure_a_fit_is(cylinder, protocol):
    # A third of the rows: every draw of the posterior solves each of them.
    fewer = protocol.replace("rows = 30", "rows = 10")
    rubbed = bulge.simulate(cylinder, fewer, {"coulomb-friction": "14 N", "bladder-elasticity": "0.3 MPa"}, seed=7)
    fitted = bulge.fit(rubbed.data, rubbed.muscle, ["bladder-elasticity", "coulomb-friction"])
    # The zero of the load cell is fitted along, within its data sheet.
    assert fitted.names == ["bladder-elasticity.modulus [MPa]", "coulomb-friction.force [N]", "force-offset.offset [N]"]
    sd = np.sqrt(np.diag(fitted.covariance))
    np.testing.assert_allclose(fitted.covariance / np.outer(sd, sd), fitted.correlation, atol=1e-9)
    for p, one in zip(fitted.fit["parameters"], sd):
        assert (p["high"] - p["low"]) / (2 * one) == pytest.approx(1.97, abs=0.05)
    found = fitted.posterior(seed=3)
    assert found.names == fitted.names and found.draws.shape == (found.count, 3)
    np.testing.assert_allclose((found.draws.mean(axis=0) - [p["value"] for p in fitted.fit["parameters"]]) / sd, 0, atol=0.2)
    np.testing.assert_allclose(found.draws.std(axis=0), sd, rtol=0.15)
    np.testing.assert_array_equal(fitted.posterior(seed=3).draws, found.draws)
    assert xml.fromstring(found.svg).tag.endswith("svg") and "coulomb-friction.force" in repr(found)
    again = pickle.loads(pickle.dumps(found))
    np.testing.assert_array_equal(again.draws, found.draws)
    robust = bulge.fit(rubbed.data, rubbed.muscle, "coulomb-friction", loss="huber")
    assert robust.fit["loss"] == "huber"
    with pytest.raises(bulge.InputError, match="soft-l1"):
        bulge.fit(rubbed.data, rubbed.muscle, "coulomb-friction", loss="hubert")
