"""Measurements: the same rows from files and frames, and mistakes with their place and cure."""

import pickle

import bulge
import numpy as np
import pytest

pandas = pytest.importorskip("pandas")

#: Every column that a file may have, in units that are not SI.
FULL = """pressure [mbar],length [cm],force [kgf],time [ms],specimen,temperature [K],diameter [in],volume [ml],force_sd [mN],sweep,cycle
1000,10,50,0,A,300,1,300,5,1,1
1000,9,40,1000,A,301,1.1,310,5,1,1
2000,10,60,0,B,300,1,300,5,2,1
2000,9,45,900,B,300,1,310,6,2,2
"""
PLAIN = "pressure [bar],contraction [%],force [N]\n1,10,500\n1,20,300\n2,10,1000\n2,20,610\n"


@pytest.fixture
def full(tmp_path):
    path = tmp_path / "full.csv"
    path.write_text(FULL)
    return path


@pytest.fixture
def plain(tmp_path):
    path = tmp_path / "plain.csv"
    path.write_text(PLAIN)
    return path


def same(one, other):
    assert set(one.columns) == set(other.columns)
    for name, values in one.columns.items():
        assert list(values) == list(other.columns[name]), name


def test_units_of_headings(full):
    data = bulge.read(full)
    g, inch = 9.80665, 0.0254
    expected = {
        "pressure_pa": [1e5, 1e5, 2e5, 2e5], "length_m": [0.1, 0.09, 0.1, 0.09], "force_n": [50 * g, 40 * g, 60 * g, 45 * g],
        "time_s": [0, 1, 0, 0.9], "temperature_k": [300, 301, 300, 300], "diameter_m": [inch, 1.1 * inch, inch, inch],
        "volume_m3": [3e-4, 3.1e-4, 3e-4, 3.1e-4], "force_sd_n": [0.005, 0.005, 0.005, 0.006],
    }  # fmt: skip
    for name, values in expected.items():
        np.testing.assert_allclose(data.columns[name], values, rtol=1e-14, err_msg=name)
        assert data.columns[name].dtype == np.float64
    assert list(data.columns["specimen"]) == ["A", "A", "B", "B"] and list(data.columns["cycle"]) == [1, 1, 1, 2]
    assert list(data.columns["sweep"]) == [0, 0, 1, 1]
    assert (len(data), data.is_path, data.n_sweeps, data.files) == (4, True, 2, [str(full)])
    assert len(data.sha256) == 64
    assert "4 rows" in repr(data) and "2 sweeps" in repr(data) and "1 to 2 bar" in repr(data)


def test_the_same_rows_from_everywhere(plain, tmp_path):
    data = bulge.read(plain)
    assert not data.is_path and len(data) == 4 and data.columns["contraction"].tolist() == [0.1, 0.2, 0.1, 0.2]
    frame = pandas.read_csv(plain)
    same(data, bulge.read(frame))
    same(data, bulge.read(frame.set_index(pandas.Index([5, 6, 9, 1]))))
    same(data, bulge.read(str(plain)))
    same(data, bulge.read([plain]))
    assert bulge.read(data) is data
    pytest.importorskip("pyarrow")
    frame.to_parquet(tmp_path / "plain.parquet")
    same(data, bulge.read(tmp_path / "plain.parquet"))
    si = pandas.DataFrame({"pressure_pa": [1e5, 1e5, 2e5, 2e5], "contraction": [0.1, 0.2, 0.1, 0.2], "force_n": [500, 300, 1000, 610]})
    same(data, bulge.read(si))
    same(data, bulge.read(si[["force_n", "contraction", "pressure_pa"]]))


def test_several_files_are_one_analysis(plain, tmp_path):
    other = tmp_path / "other.csv"
    other.write_text("force [kN],pressure [kPa],contraction\n0.2,300,0.25\n")
    for data in [bulge.read(plain, other), bulge.read([plain, str(other)])]:
        assert data.files == [str(plain), str(other)] and len(data) == 5
        assert data.columns["force_n"].tolist() == [500, 300, 1000, 610, 200]
        assert data.columns["pressure_pa"][-1] == pytest.approx(3e5, rel=1e-15)
    with pytest.raises(bulge.InputError, match="same content"):
        bulge.read(plain, plain)


#: The frame has the column `sweep` in any case.


@pytest.mark.parametrize("fixture", ["full", "plain", "rubbed"])
def test_to_pandas_and_back(fixture, request):
    source = request.getfixturevalue(fixture)
    data = source.data if fixture == "rubbed" else bulge.read(source)
    frame = data.to_pandas()
    assert len(frame) == len(data) and list(frame.columns) == list(data.columns)
    back = bulge.read(frame)
    same(data, back)
    assert (back.is_path, back.n_sweeps) == (data.is_path, data.n_sweeps)


def test_frames_keep_every_digit():
    thirds = pandas.DataFrame({"pressure_pa": [1e5 / 3, 2e5], "contraction": [0.1 / 3, 0.2], "force_n": [1 / 3, 1e-17]})
    assert bulge.read(thirds).to_pandas()[list(thirds)].equals(thirds)


def test_measurements_travel(full, rubbed):
    for data in [bulge.read(full), rubbed.data, bulge.read(pandas.read_csv(full))]:
        other = pickle.loads(pickle.dumps(data))
        same(data, other)
        assert (other.sha256, other.files) == (data.sha256, data.files)


def test_the_fingerprint_is_of_the_content(plain, tmp_path):
    copied, changed = tmp_path / "copied.csv", tmp_path / "changed.csv"
    copied.write_text(PLAIN)
    changed.write_text(PLAIN.replace("610", "611"))
    assert bulge.read(copied).sha256 == bulge.read(plain).sha256 != bulge.read(changed).sha256


def test_columns_that_are_said(tmp_path):
    path = tmp_path / "rig.csv"
    path.write_text("t,ch 1,ch 2,\"F, raw\"\n0,2000,0,-900\n1,2000,5,-800\n2,2000,10,-700\n")
    with pytest.raises(bulge.InputError, match="--columns"):
        bulge.read(path)
    hose = bulge.Muscle(kind="braided", length="200 mm", radius="10 mm", braid_angle="25 deg")
    said = {"pressure": "ch 1 [mbar]", "displacement": "ch 2 [mm]", "force": "-F, raw [N]"}
    text = 'pressure=ch 1 [mbar], displacement=ch 2 [mm], force=-"F, raw [N]"'
    for columns in [said, text]:
        data = bulge.read(path, columns=columns, muscle=hose)
        np.testing.assert_allclose(data.columns["length_m"], [0.2, 0.195, 0.19], rtol=1e-14)
        assert data.columns["force_n"].tolist() == [900, 800, 700] and data.columns["pressure_pa"].tolist() == [2e5] * 3
    # A length of its own needs no muscle; a displacement does.
    lengths = bulge.read(path, columns="pressure=ch 1 [mbar],length=ch 2 [mm],force=4 [N]")
    np.testing.assert_allclose(lengths.columns["length_m"], [0, 0.005, 0.01])
    with pytest.raises(bulge.InputError, match="name the muscle"):
        bulge.read(path, columns=said)
    with pytest.raises(bulge.InputError, match="there is no column `F2`"):
        bulge.read(path, columns={"force": "F2"})
    assert data.reading["columns"][1]["quantity"] == "pressure" and not data.reading["set_apart"]
    again = pickle.loads(pickle.dumps(data))
    same(data, again)
    frame = pandas.read_csv(path)
    same(data, bulge.read(frame, columns=said, muscle=hose))


def test_units_that_are_not_written_are_known_with_the_muscle(tmp_path):
    hose = bulge.Muscle(kind="braided", length="200 mm", radius="10 mm", braid_angle="25 deg", ends="cylinder")
    contraction = np.linspace(0.01, 0.2, 20)
    a, b = 3 / np.tan(np.radians(25)) ** 2, np.sin(np.radians(25)) ** -2
    force = np.pi * 0.01**2 * 3e5 * (a * (1 - contraction) ** 2 - b)
    path = tmp_path / "bare.csv"
    pandas.DataFrame({"p": 3.0, "x": 200 * contraction, "F": force}).to_csv(path, index=False)
    with pytest.raises(bulge.InputError, match="(?s)column `p` has no unit.*it may be psi.*bar"):
        bulge.read(path)
    data = bulge.read(path, muscle=hose)
    assert set(data.columns["pressure_pa"]) == {3e5} and data.reading["columns"][0]["guessed"]
    assert bulge.compare(path, hose).ladder[0]["rmse_n"] < 1e-6 * force.max()


def test_specimens_of_one_analysis(tmp_path):
    numbers = {"kind": "braided", "radius": "10 mm", "braid_angle": "25 deg", "ends": "cylinder"}
    hose = bulge.Muscle(length="250 mm", specimens={"short": {"length": "60 mm"}}, **numbers)
    a, b = 3 / np.tan(np.radians(25)) ** 2, np.sin(np.radians(25)) ** -2
    contraction = np.tile(np.linspace(0.01, 0.2, 20), 4)
    pressure = np.tile(np.repeat([2.0, 3.0], 20), 2)
    force = np.pi * 0.01**2 * 1e5 * pressure * (a * (1 - contraction) ** 2 - b)
    specimen = np.repeat(["short", "long"], 40)
    length = np.where(specimen == "short", 60, 250) * (1 - contraction)
    frame = pandas.DataFrame({"pressure [bar]": pressure, "length [mm]": length, "force [N]": force, "specimen": specimen})
    path = tmp_path / "two.csv"
    frame.to_csv(path, index=False)
    for source in [path, frame]:
        found = bulge.compare(source, hose)
        assert found.ladder[0]["rmse_n"] < 1e-6 * force.max()
    # Without what the short one is its rows are none of this muscle's.
    with pytest.raises(bulge.InputError, match="contraction"):
        bulge.compare(path, bulge.Muscle(length="250 mm", **numbers))
    with pytest.raises(bulge.InputError, match="no. 3"):
        bulge.compare(path, bulge.Muscle(length="250 mm", specimens={"short": {"length": "60 mm"}, "no. 3": {}}, **numbers))


def test_quality(plain, rubbed):
    assert bulge.read(plain).quality() == ["there are only 4 rows"]
    frame = rubbed.data.to_pandas()
    assert not [finding for finding in rubbed.data.quality("250 mm") if "rows" in finding]
    frame.loc[20, "force_n"] += 400
    found = bulge.read(frame).quality(0.25)
    assert any("22" in finding or "21" in finding for finding in found), found


#: Text of a file, and what must be said of it.
MISTAKES = {
    "no number": ("pressure [bar],contraction [%],force [N]\n1,10,500\n1,x,300\n", r"bad\.csv: 1 of 2 rows.*`contraction \[%\]` is not a number \(line 3\)"),
    "no force": ("pressure [bar],contraction [%]\n1,10\n", r"bad\.csv:1: there is no column `force`: add one"),
    "unit of another": ("pressure [N],contraction [%],force [N]\n1,10,5\n", r"bad\.csv:1: column `pressure \[N\]` has a unit of force.*pressure \[bar\]"),
    "no unit": ("pressure,contraction [%],force [N]\n1,10,3\n", r"bad\.csv:1: column `pressure` has no unit.*pressure \[bar\]"),
    "no row": ("pressure [bar],contraction [%],force [N]\n", r"bad\.csv: has a header but no row"),
    "few fields": ("pressure [bar],contraction [%],force [N]\n1,10\n", r"bad\.csv: 1 of 1 rows.*fewer fields than the header \(line 2\)"),
    "not finite": ("pressure [bar],contraction [%],force [N]\n1,1,1\n1,10,nan\n", r"bad\.csv: 1 of 2 rows.*`force \[N\]` is not a finite number \(line 3\)"),
    "empty": ("", r"bad\.csv: is empty: write a header"),
}


@pytest.mark.parametrize("name", list(MISTAKES))
def test_mistakes_are_said_with_their_place_and_cure(name, tmp_path):
    text, words = MISTAKES[name]
    (tmp_path / "bad.csv").write_text(text)
    with pytest.raises(bulge.InputError, match=f"(?s){words}"):
        bulge.read(tmp_path / "bad.csv")


def test_mistakes_of_frames():
    with pytest.raises(bulge.InputError, match=r"(?s)the data frame: 1 of 2 rows can't be used.*`contraction` is empty \(line 3\)"):
        bulge.read(pandas.DataFrame({"pressure_pa": [1.0, 2], "contraction": [0.1, np.nan], "force_n": [1, 2]}))
    frame = pandas.DataFrame({"pressure_pa": [1.0, 2], "contraction": [0.1, 0.2], "force_n": [1, 2]})
    with pytest.raises(bulge.InputError, match="join them first"):
        bulge.read(frame, frame)
    with pytest.raises(bulge.InputError, match="no file is named"):
        bulge.read([])
    with pytest.raises(bulge.InputError, match=r"none\.csv: can't be read"):
        bulge.read("none.csv")


def test_what_is_no_source_is_refused():
    with pytest.raises(bulge.InputError):
        bulge.read(3)


def test_columns_are_arrays(full):
    assert all(isinstance(values, np.ndarray) for values in bulge.read(full).columns.values())


def test_a_plot(rubbed):
    pytest.importorskip("matplotlib").use("Agg")
    ax = rubbed.data.plot()
    assert len(ax.lines) == 3
    np.testing.assert_array_equal(ax.lines[1].get_ydata(), rubbed.data.columns["force_n"][60:120])
