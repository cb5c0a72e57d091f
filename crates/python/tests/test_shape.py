"""Shapes: the document, the meridian and the surface of an equilibrium."""

import pickle

import bulge
import numpy as np
import pytest

BAR = 1e5
#: Keys of the document of `bulge shape --json`, and those that only the closed form has.
KEYS = {
    "schema", "muscle", "pressure_pa", "force_n", "length_m", "contraction", "volume_m3", "volume_polygon_m3", "max_radius_m", "mid_radius_m",
    "fibre_tension_n", "fibre_strain", "stiffness_n_per_m", "stiffness_isothermal_n_per_m", "stiffness_adiabatic_n_per_m", "volume_slope_m2",
    "end_slope_rad", "contraction_limit", "ends_slack", "method", "convergence", "meridian",
}  # fmt: skip
CLOSED = {"m", "phi_r", "force_f", "volume_v"}


@pytest.fixture(scope="module")
def pleats(ppam):
    return ppam.shape(pressure="2 bar", contraction="20 %", points=201)


@pytest.fixture(scope="module")
def woven(braid):
    return braid.shape(pressure="3 bar", contraction="10 %", points=201)


@pytest.fixture(scope="module", params=["ppam", "braid"])
def coarse(request):
    """Fewer points: for files."""
    return request.getfixturevalue(request.param).shape(pressure="3 bar", contraction=0.1, points=31)


@pytest.fixture(params=["pleats", "woven"])
def shape(request):
    return request.getfixturevalue(request.param)


def test_the_document(shape, pleats):
    assert set(shape.to_dict()) == KEYS | (CLOSED if shape is pleats else set())
    assert shape.schema == "bulge.shape/1" and shape.method == ("closed-form" if shape is pleats else "shooting")
    assert shape["force_n"] == shape.force_n and "force_n" in shape and set(shape) == set(shape.keys()) <= set(dir(shape))
    with pytest.raises(AttributeError, match="no 'forse_n'; it has .*force_n"):
        shape.forse_n
    text = repr(shape)
    assert f"{shape.force_n:.6g} N" in text and f"{1e3 * shape.length_m:.5g} mm" in text and shape.method in text
    assert shape.muscle in shape._repr_html_()


def test_the_numbers_are_those_of_arrays(ppam, braid, pleats, woven):
    names = {
        "force_n": "force", "volume_m3": "volume", "volume_polygon_m3": "volume_polygon", "max_radius_m": "max_radius", "end_slope_rad": "end_slope",
        "fibre_tension_n": "fibre_tension", "fibre_strain": "fibre_strain", "stiffness_n_per_m": "stiffness",
        "stiffness_isothermal_n_per_m": "stiffness_isothermal", "stiffness_adiabatic_n_per_m": "stiffness_adiabatic",
    }  # fmt: skip
    for muscle, shape, e, p in [(ppam, pleats, 0.2, 2 * BAR), (braid, woven, 0.1, 3 * BAR)]:
        found = muscle.evaluate(list(names.values()), e, pressure=p)
        for key, name in names.items():
            assert shape[key] == pytest.approx(found[name], rel=1e-9), key
        assert shape.contraction_limit == pytest.approx(muscle.contraction_limit(p), rel=1e-9)
        assert shape.length_m == pytest.approx(muscle.number("length") * (1 - e), rel=1e-13)
        assert (shape.pressure_pa, shape.contraction) == (p, pytest.approx(e))
        # F = -p dV/dl, of inextensible fibres.
        assert shape.force_n == pytest.approx(-p * shape.volume_slope_m2, rel=1e-9)


def test_the_numbers_of_the_closed_form(pleats):
    from scipy.special import ellipeinc, ellipkinc

    m, phi, ratio = pleats.m, pleats.phi_r, 0.016
    root = np.sqrt(m) * np.cos(phi)
    # docs/theory.md (6): length of the fibre and distance of the ends.
    assert ellipkinc(phi, m) / root == pytest.approx(0.11 / ratio, rel=1e-12)
    assert 2 * (ellipeinc(phi, m) - ellipkinc(phi, m) / 2) / root == pytest.approx(0.088 / ratio, rel=1e-12)
    assert pleats.max_radius_m == pytest.approx(ratio / np.cos(phi), rel=1e-12)
    assert pleats.force_f == pytest.approx(np.pi / 2 * (1 - 2 * m) / (root * 0.11 / ratio) ** 2, rel=1e-12)
    assert pleats.volume_v == pytest.approx(pleats.volume_m3 / 0.11**3, rel=1e-12)


def test_every_way_to_ask(ppam, braid, pleats, woven):
    for muscle, shape, pressure in [(ppam, pleats, 2 * BAR), (braid, woven, 3 * BAR)]:
        for given, key in [("length", "length_m"), ("force", "force_n"), ("volume", "volume_m3"), ("contraction", "contraction")]:
            other = muscle.shape(pressure=pressure, **{given: shape[key]})
            for name in ["force_n", "length_m", "volume_m3", "max_radius_m"]:
                assert other[name] == pytest.approx(shape[name], rel=1e-8), (given, name)
    same = ppam.shape(pressure="2 bar", length="88 mm")
    assert same.force_n == pytest.approx(pleats.force_n, rel=1e-12)
    shot = ppam.shape(pressure="2 bar", contraction="20 %", method="shooting")
    assert shot.method == "shooting" and shot.force_n == pytest.approx(pleats.force_n, rel=1e-9)


def test_the_meridian(ppam, braid, shape, pleats):
    muscle = ppam if shape is pleats else braid
    line = shape.meridian
    x, r, slope = line["x_m"], line["r_m"], line["slope_rad"]
    assert x.shape == (201,) and all(values.shape == (201,) and values.dtype == np.float64 for values in line.values())
    listed = shape.to_dict()["meridian"]
    assert all([point[name] for point in listed] == line[name].tolist() for name in ["x_m", "r_m", "slope_rad", "braid_angle_rad"])
    for end in (0, -1):
        assert r[end] == pytest.approx(muscle.number("radius"), rel=1e-9)
    assert x[0] == pytest.approx(0, abs=1e-12) and x[-1] == pytest.approx(shape.length_m, rel=1e-12) and np.all(np.diff(x) > 0)
    np.testing.assert_allclose(r, r[::-1], rtol=1e-10)
    np.testing.assert_allclose(x, shape.length_m - x[::-1], atol=1e-12)
    np.testing.assert_allclose(slope, -slope[::-1], atol=1e-10)
    assert r.max() == r[100] == pytest.approx(shape.max_radius_m, rel=1e-12) and slope[0] == pytest.approx(shape.end_slope_rad, rel=1e-9)
    np.testing.assert_allclose(np.gradient(r, x)[2:-2], np.tan(slope)[2:-2], rtol=0.02, atol=1e-3)


def test_fibres_keep_their_length(shape, pleats, woven, ppam, braid):
    line = shape.meridian
    x, r, turn = line["x_m"], line["r_m"], line["turn_rad"]
    pieces = np.sqrt(np.diff(x) ** 2 + np.diff(r) ** 2 + (0.5 * (r[1:] + r[:-1]) * np.diff(turn)) ** 2)
    full = 0.11 if shape is pleats else 0.06 / np.cos(np.radians(25))
    assert line["fibre_length_m"][-1] == pytest.approx(full, rel=1e-9)
    assert pieces.sum() == pytest.approx(full, rel=1e-4)
    np.testing.assert_array_equal(line["fibre_strain"], 0)
    if shape is woven:
        np.testing.assert_allclose(np.sin(line["braid_angle_rad"]), np.sin(np.radians(25)) * r / 0.010725, rtol=1e-9)
    else:
        assert not line["braid_angle_rad"].any() and not turn.any()


def test_axial_balance_along_the_meridian(shape, pleats):
    line = shape.meridian
    area = np.pi * line["r_m"] ** 2 * (40 / (2 * np.pi) * np.sin(2 * np.pi / 40) if shape is pleats else 1)
    # N cos(psi) = F + p A, the membrane force is per circumference.
    carried = 2 * np.pi * line["r_m"] * line["membrane_force_n_per_m"] * np.cos(line["slope_rad"])
    np.testing.assert_allclose(carried, shape.force_n + shape.pressure_pa * area, rtol=1e-8)


def enclosed(surface):
    """The volume by the divergence theorem: flux of (0, y, z)/2, to which discs at the ends add nothing."""
    points, quads = surface.points, surface.quads
    triangles = points[np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])]
    normal = 0.5 * np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return abs(np.sum(normal[:, 1:] * triangles.mean(axis=1)[:, 1:])) / 2


def test_a_surface_of_revolution_holds_the_volume(shape):
    errors = []
    for facets in (16, 32, 64):
        surface = shape.surface("revolution", facets=facets)
        assert surface.quads.shape == (200 * facets, 4)
        # A polygon in a circle: the share of its area that is missing.
        polygon = facets / (2 * np.pi) * np.sin(2 * np.pi / facets)
        errors.append(1 - enclosed(surface) / shape.volume_m3)
        assert errors[-1] == pytest.approx(1 - polygon, rel=0.05)
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05) and errors[1] / errors[2] == pytest.approx(4, rel=0.1)


def test_pleats_hold_more_than_their_polygon(pleats):
    volumes = [enclosed(pleats.surface("pleats", cloth=cloth, facets=24)) for cloth in ["290 mm", 0.3]]
    assert pleats.volume_polygon_m3 < volumes[0] < volumes[1]
    assert enclosed(pleats.surface()) < volumes[0]


def test_a_surface_is_well_formed(shape, pleats):
    surface = shape.surface()
    n = len(surface.points)
    for cells in (surface.quads, surface.fibres):
        assert cells.dtype.kind == "i" and 0 <= cells.min() and cells.max() < n
    assert all(values.shape == (n,) for values in surface.point_data.values())
    assert all(values.shape == (len(surface.fibres) + len(surface.quads),) for values in surface.cell_data.values())
    part = surface.cell_data["part"]
    assert len(np.unique(part[: len(surface.fibres)])) == 1 and len(np.unique(part[len(surface.fibres) :])) == 1 and part[0] != part[-1]
    assert surface.points[:, 0].min() == pytest.approx(0, abs=1e-12) and surface.points[:, 0].max() == pytest.approx(shape.length_m, rel=1e-12)
    if shape is pleats:
        assert surface.fibres.shape == (40, 201)


def test_fibres_lie_on_the_meridian(shape):
    surface = shape.surface()
    lines = surface.points[surface.fibres]
    radius = np.hypot(lines[..., 1], lines[..., 2])
    np.testing.assert_allclose(radius, surface.point_data["radius_m"][surface.fibres], rtol=1e-9)
    np.testing.assert_allclose(radius, np.broadcast_to(shape.meridian["r_m"], radius.shape), rtol=1e-9)
    np.testing.assert_allclose(lines[..., 0], np.broadcast_to(shape.meridian["x_m"], radius.shape), atol=1e-12)
    turned = np.unwrap(np.arctan2(lines[..., 2], lines[..., 1]), axis=1)
    np.testing.assert_allclose(np.abs(turned - turned[:, :1]), np.broadcast_to(np.abs(shape.meridian["turn_rad"]), radius.shape), atol=1e-9)


def test_other_libraries_get_the_same_mesh(coarse, tmp_path):
    surface = coarse.surface()
    k, m = len(surface.fibres), len(surface.quads)
    meshio = pytest.importorskip("meshio")
    mesh = surface.to_meshio()
    np.testing.assert_array_equal(mesh.points, surface.points)
    np.testing.assert_array_equal(mesh.cells_dict["quad"], surface.quads)
    np.testing.assert_array_equal(mesh.cells_dict["line"][:30], np.stack([surface.fibres[0, :-1], surface.fibres[0, 1:]], axis=1))
    mesh.write(tmp_path / "mesh.vtu")
    back = meshio.read(tmp_path / "mesh.vtu")
    np.testing.assert_array_equal(back.point_data["radius_m"], surface.point_data["radius_m"])
    pyvista = pytest.importorskip("pyvista")
    poly = surface.to_pyvista()
    assert (poly.n_cells, poly.n_points, poly.n_lines) == (k + m, len(surface.points), k)
    np.testing.assert_array_equal(poly.cell_data["part"], surface.cell_data["part"])
    # The file for ParaView holds the same.
    coarse.write_vtk(tmp_path / "bulge.vtp")
    read = pyvista.read(tmp_path / "bulge.vtp")
    assert (read.n_cells, read.n_lines) == (k + m, k)
    np.testing.assert_allclose(read.points, surface.points, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(read.point_data["radius_m"], surface.point_data["radius_m"], rtol=1e-6)


def test_a_file_for_paraview(coarse, tmp_path):
    coarse.write_vtk(tmp_path / "bulge.vtp", "revolution")
    assert (tmp_path / "bulge.vtp").read_bytes().startswith(b"<?xml") and b"PolyData" in (tmp_path / "bulge.vtp").read_bytes()[:400]
    with pytest.raises(bulge.InputError):
        coarse.write_vtk(tmp_path / "no" / "folder" / "bulge.vtp")


def test_shapes_travel(shape):
    other = pickle.loads(pickle.dumps(shape))
    assert other.to_dict() == shape.to_dict() and repr(other) == repr(shape)
    for name, values in shape.meridian.items():
        np.testing.assert_array_equal(other.meridian[name], values)
    with pytest.raises(bulge.InputError, match="compute it again"):
        other.surface()


WRONG = {
    "beyond the limit": (bulge.NoSolutionError, lambda m: m.shape(pressure="1 bar", contraction=0.7), "ppam at 1 bar.*limit of this muscle is 41.84"),
    "nothing given": (bulge.InputError, lambda m: m.shape(pressure="1 bar"), "one of contraction, length, force and volume"),
    "two given": (bulge.InputError, lambda m: m.shape(pressure="1 bar", length=0.1, force=3), "not several"),
    "another unit": (bulge.InputError, lambda m: m.shape(pressure="1 bar", force="3 bar"), "force: `3 bar` is a pressure"),
    "few points": (bulge.InputError, lambda m: m.shape(pressure="1 bar", contraction=0.1, points=2), "give a whole number of 3"),
    "no such surface": (bulge.InputError, lambda m: m.shape(pressure="1 bar", contraction=0.1).surface("skin"), "no `skin`.*pleats"),
    "few facets": (bulge.InputError, lambda m: m.shape(pressure="1 bar", contraction=0.1).surface(facets=0), "give a whole number of 4"),
    "no such method": (bulge.InputError, lambda m: m.shape(pressure="1 bar", contraction=0.1, method="membrane"), "bulge shape --method membrane"),
}


@pytest.mark.parametrize("name", list(WRONG))
def test_mistakes_are_said_with_their_cure(ppam, name):
    kind, wrong, words = WRONG[name]
    with pytest.raises(kind, match=f"(?s){words}"):
        wrong(ppam)


@pytest.mark.parametrize("wrong", [lambda m: m.shape(pressure=BAR, contraction=0.1, points=-3), lambda m: m.shape(pressure=BAR, contraction=0.1).surface(facets=-1)])
def test_negative_counts_are_wrong_input(ppam, wrong):
    with pytest.raises(bulge.InputError):
        wrong(ppam)
