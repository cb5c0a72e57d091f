"""Sweeps and tables: the same bytes however they are run, the numbers of direct evaluation, certified errors that hold."""

import hashlib
import pickle

import bulge
import numpy as np
import pytest

POINTS = """
name = "family"
muscle = "ppam-2-r16"
outputs = ["force_f", "volume_v", "max_radius"]
chunk = 64
[axes.contraction]
range = "0.5 %..50 %"
points = 21
[axes.slenderness]
range = "4..10"
points = 11
"""
TABLE = """
name = "table"
muscle = "ppam-2-r16"
outputs = ["force_f", "volume_v"]
[axes.contraction]
range = "0.5 %..limit"
[axes.slenderness]
range = "5..9"
[table]
tolerance = 1e-4
gradient = 1e-2
max_size = "64 KiB"
checks = 100000
"""
BOTH = POINTS.replace("50 %", "limit") + TABLE[TABLE.index("[table]") :].replace("[table]", '[table]\noutputs = ["force_f", "volume_v"]')


def contents(folder):
    """Hashes of all files but the lock, by name."""
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != ".lock"]
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of an uninterrupted run."""
    folder = tmp_path_factory.mktemp("sweep") / "whole"
    found = bulge.Sweep(POINTS).run(folder)
    assert (found.points, found.chunks, found.computed, found.damaged, found.is_complete) == (231, 4, 4, [], True)
    return folder


@pytest.fixture(scope="module")
def table():
    return bulge.Sweep(TABLE).table()


def test_what_a_sweep_says_of_itself(tmp_path):
    plan = bulge.Sweep(POINTS)
    assert (plan.name, plan.n_points, plan.n_chunks, plan.chunk_points, plan.has_table) == ("family", 231, 4, 64, False)
    assert plan.columns == {"contraction": "1", "slenderness": "1", "force_f": "1", "volume_v": "1", "max_radius": "m"}
    assert "231 points in 4 chunks" in repr(plan)
    (tmp_path / "sweep.toml").write_text(POINTS)
    assert bulge.Sweep.read(tmp_path / "sweep.toml").columns == plan.columns
    assert bulge.Sweep(bulge.sweep_example()).has_table and bulge.Sweep(TABLE).n_points == 0
    for text, words in [
        (POINTS + "colour = 3\n", "unknown key `colour`"),
        (POINTS.replace("ppam-2-r16", "none.toml"), r"none\.toml"),
        (POINTS.replace("force_f", "forse"), "force"),
    ]:
        with pytest.raises(bulge.InputError, match=words):
            bulge.Sweep(text)
    with pytest.raises(bulge.InputError, match=r"none\.toml"):
        bulge.Sweep.read(tmp_path / "none.toml")


def test_the_points_are_those_of_direct_evaluation(whole, ppam):
    frame = bulge.read_sweep(whole)
    assert list(frame.columns) == ["index", "contraction", "slenderness", "force_f", "volume_v", "max_radius", "infeasible"]
    assert frame["index"].tolist() == list(range(231))
    assert sorted(frame.contraction.unique()) == pytest.approx(np.linspace(0.005, 0.5, 21)) and sorted(frame.slenderness.unique()) == pytest.approx(np.linspace(4, 10, 11))
    expected = ppam.evaluate(["force_f", "volume_v", "max_radius"], frame.contraction, pressure="1 bar", slenderness=frame.slenderness, errors="coerce")
    missing = np.isnan(expected["force_f"])
    assert 20 < missing.sum() < 120
    np.testing.assert_array_equal(frame.infeasible.notna(), missing)
    assert frame.infeasible[missing].str.contains("limit").all()
    for name, values in expected.items():
        np.testing.assert_allclose(frame[name], values, rtol=1e-13, err_msg=name)
    assert list(bulge.read_sweep(whole, ["force_f"]).columns) == ["force_f"]


def test_the_same_bytes_however_it_is_run(whole, tmp_path):
    expected = contents(whole)
    assert {"plan.json", "manifest.json", "points/000003.parquet", "chunks/000000.json"} <= set(expected)
    plan = bulge.Sweep(POINTS)
    parts = tmp_path / "parts"
    first = plan.run(parts, chunks=(1, 3))
    assert (first.computed, first.is_complete) == (2, False) and "manifest.json" not in contents(parts)
    rest = plan.run(parts, resume=True)
    assert (rest.computed, rest.is_complete) == (2, True)
    assert contents(parts) == expected
    plan.run(tmp_path / "one", threads=1)
    assert contents(tmp_path / "one") == expected
    pickle.loads(pickle.dumps(plan)).run(tmp_path / "travelled")
    assert contents(tmp_path / "travelled") == expected


def test_a_sweep_brings_its_muscle(tmp_path, ppam):
    ppam.replace(radius="18 mm").to_toml(tmp_path / "mine.toml")
    text = POINTS.replace("ppam-2-r16", "mine.toml").replace("[axes.slenderness]", "[axes.length]").replace('"4..10"', '"100 mm..120 mm"')
    plan = bulge.Sweep(text, folder=tmp_path)
    other = pickle.loads(pickle.dumps(plan))
    (tmp_path / "mine.toml").unlink()
    plan.run(tmp_path / "here")
    other.run(tmp_path / "there")
    assert contents(tmp_path / "here") == contents(tmp_path / "there")
    frame = bulge.read_sweep(tmp_path / "there")
    row = frame[frame.infeasible.isna()].iloc[40]
    assert row.max_radius == pytest.approx(ppam.replace(radius="18 mm", length=row.length).evaluate("max_radius", row.contraction), rel=1e-12)


def test_what_is_damaged_is_computed_again(whole, tmp_path):
    plan = bulge.Sweep(POINTS)
    folder = tmp_path / "damaged"
    plan.run(folder)
    path = folder / "points" / "000001.parquet"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    found = plan.run(folder, resume=True)
    assert len(found.damaged) == found.computed == 1 and found.is_complete
    assert contents(folder) == contents(whole)


def test_a_folder_is_not_overwritten(whole):
    before = contents(whole)
    with pytest.raises(bulge.InputError, match="holds this sweep already"):
        bulge.Sweep(POINTS).run(whole)
    with pytest.raises(bulge.InputError, match="(?s)holds another sweep.*10.*11"):
        bulge.Sweep(POINTS.replace("4..10", "4..11")).run(whole, resume=True)
    with pytest.raises(bulge.InputError, match="chunks 5..9 are asked for.*0..4"):
        bulge.Sweep(POINTS).run(whole, resume=True, chunks=(5, 9))
    assert bulge.Sweep(POINTS).run(whole, resume=True).computed == 0
    assert contents(whole) == before


def test_advice_is_for_python(whole):
    with pytest.raises(bulge.InputError, match="resume=True"):
        bulge.Sweep(POINTS).run(whole)


def test_points_and_table_together(tmp_path):
    found = bulge.sweep(BOTH, tmp_path / "both", csv=True)
    assert found.points["is_complete"] and found.table["is_met"] and found.name == "family"
    assert len(bulge.read_sweep(tmp_path / "both")) == 231
    assert len((tmp_path / "both" / "csv" / "000000.csv").read_text().splitlines()) >= 65
    read = bulge.Table.read(tmp_path / "both" / "table.bulge")
    assert read.output_names == ["force_f", "volume_v"] and read.axis_names == ["contraction", "slenderness"]


def test_a_table_keeps_what_it_certifies(table, ppam):
    random = np.random.default_rng(2)
    slenderness = random.uniform(5, 9, 400)
    limit = table.upper_end(slenderness=slenderness)
    exact_limit = [ppam.replace(radius=0.11 / s).contraction_limit(1e5) for s in slenderness]
    np.testing.assert_allclose(limit, exact_limit, rtol=1e-5)
    share = random.uniform(0, 1, 400)
    contraction = 0.005 + (limit - 0.005) * 0.97 * share
    outputs = ["force_f", "volume_v"]
    exact = ppam.evaluate(outputs, contraction, slenderness=slenderness)
    found, gradient = table(contraction=contraction, slenderness=slenderness), table.gradient(contraction=contraction, slenderness=slenderness)
    assert list(found) == outputs
    by_contraction = ppam.evaluate(["force_f_by_contraction", "volume_v_by_contraction"], contraction, slenderness=slenderness)
    h = 1e-5
    beside = [ppam.evaluate(outputs, contraction, slenderness=slenderness + s) for s in (-h, h)]
    for output in table.outputs:
        name = output["name"]
        assert output["error"] <= output["bound"] and output["error"] < 1e-4
        error = np.abs(found[name] / exact[name] - 1)
        large = exact[name] > 0.02 * exact[name].max()
        assert error[large].max() < 1.05 * output["bound"]
        for slope, axis, width in [
            (by_contraction[f"{name}_by_contraction"], "contraction", limit - 0.005),
            ((beside[1][name] - beside[0][name]) / (2 * h), "slenderness", 4.0),
        ]:
            off = np.abs(gradient[name][axis] - slope) / np.maximum(np.abs(slope), exact[name] / width)
            assert np.sqrt(np.mean(off[large] ** 2)) < 2e-3, (name, axis)
            assert off[large].max() < 1.2 * max(output["gradient_error"], 1e-2), (name, axis)


def test_tables_broadcast(table):
    e, s = np.array([0.1, 0.2, 0.3]), np.array([5.5, 6.875])
    found = table(contraction=e[:, None], slenderness=s)["force_f"]
    assert found.shape == (3, 2)
    for i in range(3):
        for j in range(2):
            one = table(contraction=e[i], slenderness=s[j])["force_f"]
            assert type(one) is float and one == found[i, j]
    assert table(contraction="20 %", slenderness="6.875")["volume_v"] == table(contraction=0.2, slenderness=6.875)["volume_v"]
    assert table(contraction=[], slenderness=6)["force_f"].shape == (0,)
    assert table.gradient(contraction=e, slenderness=6)["force_f"]["slenderness"].shape == (3,)
    many = np.linspace(0.01, 0.3, 10000)
    assert table(contraction=many, slenderness=6)["force_f"][7777] == table(contraction=many[7777], slenderness=6)["force_f"]


def test_single_points_are_those_of_arrays(table):
    e, s = 0.2, 6.875
    one, slopes = table(contraction=e, slenderness=s), table.gradient(contraction=np.float64(e), slenderness=s)
    many, by = table(contraction=[e], slenderness=s), table.gradient(contraction=[e], slenderness=s)
    for name in table.output_names:
        assert type(one[name]) is float and one[name] == many[name][0]
        assert {axis: value for axis, value in slopes[name].items()} == {axis: value[0] for axis, value in by[name].items()}
    assert np.isnan(table(contraction=0.9, slenderness=s)["force_f"]) and np.isnan(table.gradient(contraction=0.9, slenderness=s)["force_f"]["slenderness"])
    with pytest.raises(bulge.InputError, match="contraction: 20 is 2000 %"):
        table(contraction=20.0, slenderness=s)
    with pytest.raises(bulge.NoSolutionError, match="1 of 1 points lie outside"):
        table(contraction=0.9, slenderness=s, errors="raise")


def test_outside_of_a_table_is_nan(table):
    limit = table.upper_end(slenderness=6.0)
    e = np.array([0.004, 0.005, 0.2, limit * (1 - 1e-9), limit * (1 + 1e-6), 0.9, np.nan])
    expected = [True, False, False, False, True, True, True]
    for values in [*table(contraction=e, slenderness=6.0).values(), *table.gradient(contraction=e, slenderness=6.0)["force_f"].values()]:
        assert np.isnan(values).tolist() == expected
    assert np.isnan(table(contraction=0.1, slenderness=9.1)["force_f"]) and np.isnan(table.upper_end(slenderness=4.9))
    with pytest.raises(bulge.NoSolutionError, match=r"4 of 7 points lie outside.*index \(0,\)"):
        table(contraction=e, slenderness=6.0, errors="raise")
    for wrong, words in [
        ({"contraction": 0.1}, "`slenderness` is missing"),
        ({"contraction": 0.1, "slenderness": 6, "colour": 3}, "`colour` is none"),
        ({"contraction": "1 bar", "slenderness": 6}, "pressure"),
    ]:
        with pytest.raises(bulge.InputError, match=words):
            table(**wrong)


def test_damaged_tables_are_refused(table, tmp_path):
    content = table.to_bytes()
    for place in [0, 20, len(content) // 3, len(content) - 1]:
        damaged = bytearray(content)
        damaged[place] ^= 4
        with pytest.raises(bulge.InputError):
            bulge.Table(bytes(damaged))
    with pytest.raises(bulge.InputError, match="truncated"):
        bulge.Table(content[:-1])
    (tmp_path / "broken.bulge").write_bytes(content[:100])
    with pytest.raises(bulge.InputError, match=r"broken\.bulge: the table is truncated"):
        bulge.Table.read(tmp_path / "broken.bulge")
    with pytest.raises(bulge.InputError, match=r"none\.bulge"):
        bulge.Table.read(tmp_path / "none.bulge")


def test_tables_travel(table):
    other = pickle.loads(pickle.dumps(table))
    assert other.to_bytes() == table.to_bytes() == bulge.Sweep(TABLE).table().to_bytes() and other.to_dict() == table.to_dict()
    assert "force_f" in repr(table) and str(len(table.to_bytes())) in repr(table)


def test_a_table_that_is_not_wished(whole):
    with pytest.raises(bulge.InputError, match="no `.table.`"):
        bulge.Sweep(POINTS).table()


def test_a_small_table_warns():
    with pytest.warns(UserWarning, match="does not meet"):
        small = bulge.Sweep(TABLE.replace("1e-4", "1e-9").replace("64 KiB", "4 KiB")).table()
    assert len(small.to_bytes()) <= 4096


def test_the_command_line_writes_the_same_bytes(command, tmp_path):
    (tmp_path / "sweep.toml").write_text(BOTH)
    command("sweep", tmp_path / "sweep.toml", "--out", tmp_path / "theirs")
    bulge.sweep(tmp_path / "sweep.toml", tmp_path / "ours")
    theirs, ours = contents(tmp_path / "theirs"), contents(tmp_path / "ours")
    assert ours == theirs and {"table.bulge", "table.json", "manifest.json"} <= set(ours)
