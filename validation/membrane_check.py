"""Reads Bulge's .vtu files of membranes with VTK itself, checks what stands in them, and renders a picture.

    pip install vtk
    python validation/membrane_check.py FILE.vtu ... SERIES.pvd ... [--picture FILE.png] [--colour ARRAY]

A surface that is open at most at plane ends across the z axis must enclose `volume_m3` with its normals outward, less what its facets cut
off. The picture shows the first .vtu (or the last member of the first .pvd), off screen, coloured by `membrane_force_1_N_per_m` or
by another array of its cells, such as `wrinkle_state`; lines are drawn as tubes. The last line is `N passed, M failed`; the exit status is 1 if
anything failed.
"""

import math
import sys

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import vtk_check

SHEET = ("membrane_force_1_N_per_m", "membrane_force_2_N_per_m", "stretch_1", "stretch_2", "direction_1", "folded", "wrinkle_state")
THREAD = ("fibre_tension_N", "fibre_strain", "fibre_angle_rad")
CELL_ARRAYS = {"group", *SHEET, *THREAD}
FIELD_ARRAYS = {"pressure_Pa", "volume_m3", "energy_J", "force_N", "unstable", "TimeValue"}
VECTORS = ("direction_1", "displacement_m")
LINES = (vtk.VTK_LINE, vtk.VTK_QUADRATIC_EDGE)
QUADRATIC = (vtk.VTK_QUADRATIC_TRIANGLE, vtk.VTK_QUADRATIC_EDGE)
STATES = {-1, 0, 1, 2}

# Facets of triangles are the surface itself; VTK cuts quadratic ones, and a quadratic meridian is drawn as two chords an element.
EXACT, CURVED = 1e-9, 5e-3
# Cuts of a quadratic cell, halving its edges each time.
SUBDIVISION = 3
# Places that are one, over the size of the surface.
SAME_PLACE = 1e-9

COLOURS = {"membrane_force_1_N_per_m": "larger membrane force [N/m]", "wrinkle_state": "0 slack, 1 wrinkled, 2 taut"}


def read(path):
    """The grid of one file."""
    return vtk_check.read(path, vtk.vtkXMLUnstructuredGridReader())


def arrays(path, attributes, count):
    """Arrays of numbers by name, each finite and with one value per point or cell."""
    found = {}
    for i in range(attributes.GetNumberOfArrays()):
        array = attributes.GetArray(i)
        if array is None:
            continue
        name, values = array.GetName(), vtk_to_numpy(array)
        components = 3 if name.startswith(VECTORS) else 1
        assert array.GetNumberOfComponents() == components, f"{path}: {name} has {array.GetNumberOfComponents()} components"
        assert count is None or len(values) == count, f"{path}: {name}: {len(values)} values for {count}"
        assert numpy.isfinite(values).all(), f"{path}: {name}: a value isn't finite"
        found[name] = values
    return found


def strings(data, name):
    """An array of strings of the field data."""
    array = data.GetFieldData().GetAbstractArray(name)
    assert array is not None, f"no strings {name}"
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())]


def types_of(data):
    """VTK's type of each cell."""
    return numpy.array([data.GetCellType(i) for i in range(data.GetNumberOfCells())])


def kept(data, cells):
    """These cells alone, as poly data; quadratic ones cut."""
    numbers = vtk.vtkIdTypeArray()
    for cell in cells:
        numbers.InsertNextValue(int(cell))
    node = vtk.vtkSelectionNode()
    node.SetFieldType(vtk.vtkSelectionNode.CELL)
    node.SetContentType(vtk.vtkSelectionNode.INDICES)
    node.SetSelectionList(numbers)
    selection = vtk.vtkSelection()
    selection.AddNode(node)
    extract = vtk.vtkExtractSelection()
    extract.SetInputData(0, data)
    extract.SetInputData(1, selection)
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputConnection(extract.GetOutputPort())
    surface.SetNonlinearSubdivisionLevel(SUBDIVISION)
    surface.Update()
    return surface.GetOutput()


def triangles_of(surface):
    """The corners' numbers of its plane triangles, and the points."""
    cut = vtk.vtkTriangleFilter()
    cut.SetInputData(surface)
    cut.PassLinesOff()
    cut.PassVertsOff()
    cut.Update()
    flat = cut.GetOutput()
    corners = vtk_to_numpy(flat.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return corners, vtk_to_numpy(flat.GetPoints().GetData()).astype(float)


def enclosed(corners, points):
    """Volume by the flow of (x, y, 0)/2, to which ends across the z axis add nothing."""
    a, b, c = (points[corners[:, i]] for i in range(3))
    normal = 0.5 * numpy.cross(b - a, c - a)
    middle = (a + b + c) / 3.0
    return float(0.5 * (normal[:, :2] * middle[:, :2]).sum())


def open_edges(corners):
    """Edges that don't cancel with a neighbour's: pairs of points."""
    edges = {}
    for i in range(3):
        for a, b in zip(corners[:, i], corners[:, (i + 1) % 3]):
            key = (min(a, b), max(a, b))
            edges[key] = edges.get(key, 0) + (1 if a < b else -1)
    return [key for key, total in edges.items() if total != 0]


def expected_part(types, edges, ends):
    """What part of the volume the facets of a revolved surface leave: a polygon's area over the circle's."""
    if vtk.VTK_QUAD not in types or not edges:
        return 1.0
    angle = 2.0 * math.pi * ends / len(edges)
    return math.sin(angle) / angle


def check_surface(path, data, types, volume):
    """Whether the surface is closed but for plane ends, and then its volume."""
    sheets = numpy.flatnonzero(~numpy.isin(types, (*LINES, vtk.VTK_VERTEX)))
    if not len(sheets):
        return "no surface"
    corners, points = triangles_of(kept(data, sheets))
    edges = open_edges(corners)
    size = numpy.linalg.norm(points.max(axis=0) - points.min(axis=0))
    z = points[:, 2]
    # A hole whose edges lie in a plane across the axis; a part of a whole has edges elsewhere too.
    heights = sorted({round(float(z[a]) / (SAME_PLACE * size)) for a, _ in edges})
    is_flat = all(abs(z[a] - z[b]) <= SAME_PLACE * size for a, b in edges)
    ends = 1 + sum(second - first > 2 for first, second in zip(heights, heights[1:])) if heights else 0
    if not is_flat or ends > 2:
        return f"{len(corners)} triangles, open at {len(edges)} edges: no volume to compare"
    found, part = enclosed(corners, points), expected_part(types, edges, ends)
    tolerance = EXACT if set(types) <= {vtk.VTK_TRIANGLE, *LINES} else CURVED
    if abs(volume) <= EXACT * size**3:
        return f"flat: {found * 1e6:.3g} ml of {volume * 1e6:.3g} ml"
    apart = found / (part * volume) - 1.0
    assert abs(apart) <= tolerance, f"{path}: the surface encloses {found} m3, not {part} * {volume} m3: {apart:.2e}"
    return f"{ends} ends, {found * 1e6:.6g} ml, {apart:+.1e} from volume_m3 and its facets"


def check_vtu(path):
    """One file: arrays, their ranges, the surface."""
    data = read(path)
    points, cells = data.GetNumberOfPoints(), data.GetNumberOfCells()
    assert points > 0 and cells > 0, f"{path}: {points} points, {cells} cells"
    point = arrays(path, data.GetPointData(), points)
    cell = arrays(path, data.GetCellData(), cells)
    field = arrays(path, data.GetFieldData(), None)
    for where, wanted, found in (("point", {"displacement_m"}, point), ("cell", CELL_ARRAYS, cell), ("field", FIELD_ARRAYS, field)):
        assert wanted <= found.keys(), f"{path}: {where} data lack {sorted(wanted - found.keys())}"
    groups, types = strings(data, "groups"), types_of(data)
    assert cell["group"].min() >= 0 and cell["group"].max() < len(groups), f"{path}: a group without a name of {groups}"
    for layer in [""] + [f"_{k}" for k in range(2, 100) if f"wrinkle_state_{k}" in cell]:
        state, direction = cell[f"wrinkle_state{layer}"], cell[f"direction_1{layer}"]
        assert set(state) <= STATES, f"{path}: states {set(state)}"
        length = numpy.linalg.norm(direction, axis=1)
        # A slack sheet has no direction of force.
        assert (abs(length[state > 0] - 1.0) < 1e-9).all(), f"{path}: a direction isn't of length 1"
        none = state == -1
        for name in SHEET[:-1]:
            assert (cell[name + layer][none] == 0.0).all(), f"{path}: {name}{layer} where there is no sheet"
        assert (cell[f"folded{layer}"] >= 0.0).all() and (cell[f"folded{layer}"] <= 1.0).all(), f"{path}: folded"
    shown = check_surface(path, data, types, float(field["volume_m3"][0]))
    print(
        f"{path}: {points} points, {cells} cells of {', '.join(groups)} at {float(field['pressure_Pa'][0]) / 1e3:.4g} kPa: {shown}"
    )


def check_pvd(path):
    """A series: its values, and every member, which knows its own."""
    found = vtk_check.members(path)
    assert found, f"{path}: empty"
    for value, member in found:
        assert math.isfinite(value), f"{path}: a value isn't finite"
        check_vtu(member)
        own = float(read(member).GetFieldData().GetArray("TimeValue").GetValue(0))
        assert own == value, f"{member}: TimeValue is {own}, the series says {value}"
    print(f"{path}: {len(found)} members from {found[0][0]:.4g} to {found[-1][0]:.4g}")


def caption(data):
    """Pressure, volume and force of the picture."""
    value = {name: float(data.GetFieldData().GetArray(name).GetValue(0)) for name in FIELD_ARRAYS}
    return f"{value['pressure_Pa'] / 1e5:.3g} bar    {value['volume_m3'] * 1e6:.4g} ml    force {value['force_N']:.4g} N"


def picture(path, target, colour):
    """Renders one file off screen."""
    data = read(path)
    values = data.GetCellData().GetArray(colour)
    assert values is not None and values.GetNumberOfComponents() == 1, f"{path}: no numbers {colour} to colour by"
    types, values = types_of(data), vtk_to_numpy(values)
    is_line = numpy.isin(types, LINES)
    drawn = values[~is_line] if (~is_line).any() else values
    # A few elements at a clamped edge would take the whole scale.
    is_state = colour.startswith("wrinkle_state")
    low, high = (0.0, 2.0) if is_state else numpy.percentile(drawn, (1.0, 99.0))
    # What differs by less than the labels show takes one colour.
    margin = 0.01 * abs(high) if high - low < 0.005 * abs(high) else 0.0
    low, high = low - margin, high + margin
    table = vtk_check.colour_table(float(low), float(high))
    bounds = numpy.array(data.GetBounds()).reshape(3, 2)
    size = numpy.linalg.norm(bounds[:, 1] - bounds[:, 0])

    scene = vtk.vtkRenderer()
    scene.SetBackground(1.0, 1.0, 1.0)
    if (~is_line).any():
        surface = kept(data, numpy.flatnonzero(~is_line))
        scene.AddActor(vtk_check.cloth_actor(surface, table, colour, 50.0, 0.12, of_cells=True))
    if is_line.any():
        strip = vtk.vtkStripper()
        strip.SetInputData(kept(data, numpy.flatnonzero(is_line)))
        strip.JoinContiguousSegmentsOn()
        tubes = vtk.vtkTubeFilter()
        tubes.SetInputConnection(strip.GetOutputPort())
        scene.AddActor(vtk_check.fibre_actor(tubes, 0.004 * size))
    bar = vtk_check.colour_bar(table)
    if is_state:
        bar.SetNumberOfLabels(3)
    scene.AddViewProp(bar)
    scene.AddViewProp(vtk_check.heading(COLOURS.get(colour, colour), 0.118, 19))
    scene.AddViewProp(vtk_check.heading(caption(data), 0.925, 23))
    vtk_check.light_up(scene)
    camera = scene.GetActiveCamera()
    # The axis of the muscle, z, lies across the window.
    camera.SetFocalPoint(*bounds.mean(axis=1))
    camera.SetPosition(*(bounds.mean(axis=1) + size * numpy.array([0.9, 0.35, 0.42])))
    camera.SetViewUp(0.0, 1.0, 0.0)
    camera.SetViewAngle(18.0)

    def framed():
        # Between the lines of text; known only with the window's shape.
        scene.ResetCameraScreenSpace(0.68)
        camera.SetWindowCenter(0.0, -0.06)
        scene.ResetCameraClippingRange()

    def check(image):
        width, height = vtk_check.WIDTH, vtk_check.HEIGHT
        shown = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)
        middle = shown[height // 3 : 2 * height // 3, width // 3 : 2 * width // 3]
        assert (middle[:, :, :3].min(axis=2) < 240).mean() > 0.2, f"{target}: nothing in the middle of the picture"

    vtk_check.render(scene, target, framed, check)


def main():
    parser = vtk_check.arguments(".vtu", __doc__)
    parser.add_argument("--colour", default="membrane_force_1_N_per_m", help="array of the cells to colour by")
    options = parser.parse_args()
    return vtk_check.run(options, check_vtu, check_pvd, lambda source, target: picture(source, target, options.colour))


if __name__ == "__main__":
    sys.exit(main())
