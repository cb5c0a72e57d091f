"""Reads Bulge's .vtp and .pvd files with VTK itself, checks what stands in them, and renders a picture.

    pip install vtk
    python validation/vtk_check.py FILE.vtp ... SERIES.pvd [--picture FILE.png]

The picture shows the first .vtp (or the last member of the first .pvd), off screen, coloured by the membrane force. The last line is
`N passed, M failed`; the exit status is 1 if anything failed.
"""

import argparse
import math
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import vtk
from vtk.util.numpy_support import vtk_to_numpy

POINT_ARRAYS = {
    "radius_m", "cloth_radius_m", "slope_rad", "braid_angle_rad", "fibre_tension_N", "fibre_strain", "membrane_force_N_per_m",
}
CELL_ARRAYS = {"part", "area_m2", "membrane_force_N_per_m"}
FIELD_ARRAYS = {"pressure_Pa", "force_N", "length_m", "contraction", "volume_m3"}
CLOTH, FIBRE = 0, 1

# Of the picture; it is drawn SCALE times as large and averaged: smooth edges without the driver's multisampling.
WIDTH, HEIGHT, SCALE = 1200, 700, 2
# Steps of colour that are kept, so that the file is small: 255 = 85 * 3.
COLOUR_STEP = 3

# VTK's quadrangles have the same area formula, so only rounding may differ.
CELL_AREA_TOLERANCE = 1e-9
# Cutting a quadrangle that isn't plane into two triangles adds area of second order in its warp.
TRIANGLE_AREA_TOLERANCE = 5e-3


def read(path, reader=None):
    """The data of one file, poly data unless another reader is given; whatever VTK complains about is an assertion."""
    complaints = []
    reader = reader or vtk.vtkXMLPolyDataReader()
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda _, name: complaints.append(name))
    assert path.is_file(), f"{path}: no such file"
    reader.SetFileName(str(path))
    reader.Update()
    assert not complaints and reader.GetErrorCode() == 0, f"{path}: VTK complains {complaints}"
    return reader.GetOutput()


def arrays(attributes, count):
    """Arrays by name, each finite and with one value per point or cell."""
    found = {}
    for i in range(attributes.GetNumberOfArrays()):
        array = attributes.GetArray(i)
        values = vtk_to_numpy(array)
        assert array.GetNumberOfComponents() == 1, f"{array.GetName()}: {array.GetNumberOfComponents()} components"
        assert count is None or len(values) == count, f"{array.GetName()}: {len(values)} values for {count}"
        assert all(math.isfinite(value) for value in values), f"{array.GetName()}: a value isn't finite"
        found[array.GetName()] = values
    return found


def cells_of(data, part):
    """The cells of one part, as poly data of its own."""
    threshold = vtk.vtkThreshold()
    threshold.SetInputData(data)
    threshold.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_CELLS, "part")
    threshold.SetThresholdFunction(vtk.vtkThreshold.THRESHOLD_BETWEEN)
    threshold.SetLowerThreshold(part)
    threshold.SetUpperThreshold(part)
    surface = vtk.vtkGeometryFilter()
    surface.SetInputConnection(threshold.GetOutputPort())
    surface.Update()
    return surface.GetOutput()


def cell_size_area(data):
    """Area of all cells by vtkCellSizeFilter."""
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(data)
    sizes.ComputeLengthOff()
    sizes.ComputeVolumeOff()
    sizes.ComputeVertexCountOff()
    sizes.ComputeAreaOn()
    sizes.Update()
    return vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Area"))


def mass_property_area(data):
    """Area of the triangulated cloth by vtkMassProperties."""
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputData(data)
    triangles.PassLinesOff()
    triangles.PassVertsOff()
    properties = vtk.vtkMassProperties()
    properties.SetInputConnection(triangles.GetOutputPort())
    return properties.GetSurfaceArea()


def boundary_loops(data):
    """Number of open edges loops of the cloth: the two ends."""
    edges = vtk.vtkFeatureEdges()
    edges.SetInputData(data)
    edges.BoundaryEdgesOn()
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.NonManifoldEdgesOff()
    regions = vtk.vtkPolyDataConnectivityFilter()
    regions.SetInputConnection(edges.GetOutputPort())
    regions.SetExtractionModeToAllRegions()
    regions.Update()
    return regions.GetNumberOfExtractedRegions()


def check_vtp(path):
    """One file: topology, arrays, areas."""
    data = read(path)
    points, quads, lines = data.GetNumberOfPoints(), data.GetNumberOfPolys(), data.GetNumberOfLines()
    assert points > 0 and quads > 0, f"{path}: {points} points, {quads} polygons"
    point = arrays(data.GetPointData(), points)
    cell = arrays(data.GetCellData(), data.GetNumberOfCells())
    field = arrays(data.GetFieldData(), None)
    for where, wanted, found in (("point", POINT_ARRAYS, point), ("cell", CELL_ARRAYS, cell), ("field", FIELD_ARRAYS, field)):
        assert wanted <= found.keys(), f"{path}: {where} data lack {sorted(wanted - found.keys())}"
    assert data.GetPointData().GetScalars().GetName() == "membrane_force_N_per_m", f"{path}: other active scalars"
    assert (cell["part"] == FIBRE).sum() == lines and (cell["part"] == CLOTH).sum() == quads, f"{path}: parts"
    assert (cell["part"][:lines] == FIBRE).all() and (cell["area_m2"][:lines] == 0.0).all(), f"{path}: order of cells"

    coordinates = vtk_to_numpy(data.GetPoints().GetData())
    length = field["length_m"][0]
    assert abs(coordinates[:, 0].min()) <= 1e-9 * length, f"{path}: starts at x = {coordinates[:, 0].min()} m"
    distance = (coordinates[:, 1] ** 2 + coordinates[:, 2] ** 2) ** 0.5
    assert abs(distance - point["cloth_radius_m"]).max() <= 1e-12, f"{path}: cloth_radius_m"

    cloth = cells_of(data, CLOTH)
    stated = cell["area_m2"][lines:]
    sizes = cell_size_area(cloth)
    worst = abs(sizes - stated).max() / stated.max()
    assert worst <= CELL_AREA_TOLERANCE, f"{path}: areas of cells differ by {worst}"
    triangulated = mass_property_area(cloth) / stated.sum() - 1.0
    assert abs(triangulated) <= TRIANGLE_AREA_TOLERANCE, f"{path}: area differs by {triangulated} from vtkMassProperties"
    assert boundary_loops(cloth) == 2, f"{path}: the cloth has {boundary_loops(cloth)} open ends"
    print(
        f"{path}: {points} points, {quads} quadrangles, {lines} fibres, cloth {stated.sum() * 1e4:.3f} cm2 "
        f"(cells to {worst:.0e}, triangles to {abs(triangulated):.0e}), contraction {field['contraction'][0]:.4g}"
    )


def members(path):
    """(value, file) of a .pvd."""
    root = ElementTree.parse(path).getroot()
    assert root.tag == "VTKFile" and root.get("type") == "Collection", f"{path}: no collection"
    return [(float(entry.get("timestep")), path.parent / entry.get("file")) for entry in root.iter("DataSet")]


def check_pvd(path):
    """A series: its values, and every member."""
    found = members(path)
    assert found, f"{path}: empty"
    assert all(math.isfinite(value) for value, _ in found), f"{path}: a value isn't finite"
    for _, member in found:
        check_vtp(member)
    print(f"{path}: {len(found)} members from {found[0][0]:.4g} to {found[-1][0]:.4g}")


def cloth_actor(data, colours, array, angle, specular, of_cells=False):
    """Cloth coloured by an array of its points or cells, smoothly shaded except where it is creased by more than an angle in degrees."""
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputData(data)
    normals.SetFeatureAngle(angle)
    normals.SplittingOn()
    normals.ConsistencyOff()
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    if of_cells:
        mapper.SetScalarModeToUseCellFieldData()
    else:
        mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(array)
    mapper.SetLookupTable(colours)
    mapper.UseLookupTableScalarRangeOn()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetInterpolationToPhong()
    look.SetAmbient(0.30)
    look.SetDiffuse(0.80)
    look.SetSpecular(specular)
    look.SetSpecularPower(28.0)
    return actor


def fibre_actor(tubes, radius):
    """Fibres as dark tubes, from a filter that has its input."""
    tubes.SetRadius(radius)
    tubes.SetNumberOfSides(12)
    tubes.CappingOn()
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(tubes.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(0.13, 0.14, 0.17)
    look.SetSpecular(0.35)
    return actor


def fitting_actor(x, radius, thickness):
    """A metal disc that closes an end (the drawing's own: files hold no fittings)."""
    disc = vtk.vtkCylinderSource()
    disc.SetRadius(radius)
    disc.SetHeight(thickness)
    disc.SetResolution(96)
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputConnection(disc.GetOutputPort())
    normals.SetFeatureAngle(40.0)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.RotateZ(90.0)
    actor.SetPosition(x, 0.0, 0.0)
    look = actor.GetProperty()
    look.SetColor(0.62, 0.64, 0.67)
    look.SetSpecular(0.5)
    look.SetSpecularPower(30.0)
    return actor


def colour_table(low, high):
    """From deep blue over teal to warm yellow, even in lightness, readable for the colour-blind."""
    stops = [(0.21, 0.31, 0.60), (0.18, 0.50, 0.66), (0.24, 0.68, 0.60), (0.63, 0.81, 0.42), (0.99, 0.87, 0.36)]
    blend = vtk.vtkColorTransferFunction()
    blend.SetColorSpaceToLab()
    for i, colour in enumerate(stops):
        blend.AddRGBPoint(i / (len(stops) - 1), *colour)
    table = vtk.vtkLookupTable()
    table.SetNumberOfTableValues(256)
    for i in range(256):
        table.SetTableValue(i, *blend.GetColor(i / 255), 1.0)
    # A uniform force (a straight muscle) takes the middle of the table.
    margin = 0.01 * abs(high) if high - low <= 1e-6 * abs(high) else 0.0
    table.SetTableRange(low - margin, high + margin)
    return table


def colour_bar(table):
    """A slim bar with plain black figures."""
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetTitle("")
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("{:.0f}" if vtk.vtkVersion.GetVTKMajorVersion() * 100 + vtk.vtkVersion.GetVTKMinorVersion() >= 906 else "%.0f")
    bar.SetOrientationToHorizontal()
    bar.SetPosition(0.30, 0.03)
    bar.SetWidth(0.40)
    bar.SetHeight(0.075)
    bar.SetBarRatio(0.42)
    bar.UnconstrainedFontSizeOn()
    plain(bar.GetLabelTextProperty(), 17 * SCALE)
    return bar


def plain(text, size):
    """Upright dark letters."""
    text.SetColor(0.1, 0.1, 0.1)
    text.SetFontFamilyToArial()
    text.SetFontSize(size)
    text.BoldOff()
    text.ItalicOff()
    text.ShadowOff()


def heading(words, height, size):
    """Words centred at a height of the window (0 below, 1 above)."""
    actor = vtk.vtkTextActor()
    actor.SetInput(words)
    actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    actor.SetPosition(0.5, height)
    plain(actor.GetTextProperty(), size * SCALE)
    actor.GetTextProperty().SetJustificationToCentered()
    return actor


def caption(data):
    """Pressure, contraction and force of the picture."""
    value = {name: values[0] for name, values in arrays(data.GetFieldData(), None).items()}
    return (
        f"{value['pressure_Pa'] / 1e5:.3g} bar    contraction {value['contraction'] * 100:.3g} %    "
        f"force {value['force_N']:.4g} N"
    )


def picture(path, target):
    """Renders one file off screen."""
    data = read(path)
    force = vtk_to_numpy(data.GetPointData().GetArray("membrane_force_N_per_m"))
    radius = vtk_to_numpy(data.GetPointData().GetArray("radius_m"))
    length = float(data.GetFieldData().GetArray("length_m").GetValue(0))
    table = colour_table(float(force.min()), float(force.max()))

    scene = vtk.vtkRenderer()
    scene.SetBackground(1.0, 1.0, 1.0)
    scene.AddActor(cloth_actor(cells_of(data, CLOTH), table, "membrane_force_N_per_m", 40.0, 0.18))
    if data.GetNumberOfLines() > 0:
        tubes = vtk.vtkTubeFilter()
        tubes.SetInputData(cells_of(data, FIBRE))
        fibres = fibre_actor(tubes, 0.018 * float(radius.max()))
        fibres.GetProperty().SetSpecularPower(20.0)
        scene.AddActor(fibres)
    x = vtk_to_numpy(data.GetPoints().GetData())[:, 0]
    outermost = vtk_to_numpy(data.GetPointData().GetArray("cloth_radius_m"))
    thickness = 0.07 * length
    for middle, at_end in ((-thickness / 2, x <= x.min()), (length + thickness / 2, x >= x.max())):
        scene.AddActor(fitting_actor(middle, 1.03 * float(outermost[at_end].max()), thickness))
    scene.AddViewProp(colour_bar(table))
    scene.AddViewProp(heading("membrane force [N/m]", 0.118, 19))
    scene.AddViewProp(heading(caption(data), 0.925, 23))

    light_up(scene)
    camera = scene.GetActiveCamera()
    camera.SetFocalPoint(length / 2, 0.0, 0.0)
    camera.SetPosition(length / 2 - 0.38, 0.30, 0.90)
    camera.SetViewUp(0.0, 1.0, 0.0)
    camera.SetViewAngle(18.0)
    scene.ResetCamera()
    camera.Zoom(1.28)
    # A little lower than the middle of the window is free for the bar, so the muscle moves up.
    camera.SetWindowCenter(0.0, -0.09)
    scene.ResetCameraClippingRange()
    render(scene, target)


def render(scene, target, framed=lambda: None, check=lambda image: None):
    """Draws a scene SCALE times as large and averages; `framed` is called once the window has its shape, `check` with the picture."""
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(SCALE * WIDTH, SCALE * HEIGHT)
    window.AddRenderer(scene)
    framed()
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    half = vtk.vtkImageResize()
    half.SetInputConnection(grab.GetOutputPort())
    half.SetResizeMethodToOutputDimensions()
    half.SetOutputDimensions(WIDTH, HEIGHT, 1)
    half.InterpolateOn()
    half.Update()
    coarsen(half.GetOutput())
    check(half.GetOutput())
    writer = vtk.vtkPNGWriter()
    writer.SetInputData(half.GetOutput())
    writer.SetCompressionLevel(9)
    writer.SetFileName(str(target))
    writer.Write()
    assert target.is_file() and target.stat().st_size > 10_000, f"{target}: no picture"
    print(f"{target}: {target.stat().st_size / 1000:.0f} kB, rendered with {window.GetClassName()}")


def coarsen(image):
    """Rounds the colours to multiples of COLOUR_STEP."""
    colours = vtk_to_numpy(image.GetPointData().GetScalars())
    colours[:] = (colours.astype(int) + COLOUR_STEP // 2) // COLOUR_STEP * COLOUR_STEP


def light_up(scene):
    """A key light above the camera, a weak one from the other side."""
    scene.AutomaticLightCreationOff()
    for place, strength in (((-0.5, 1.0, 0.9), 0.85), ((0.9, -0.4, 0.6), 0.35), ((0.0, 0.0, 1.0), 0.28)):
        light = vtk.vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(*place)
        light.SetFocalPoint(0.0, 0.0, 0.0)
        light.SetIntensity(strength)
        scene.AddLight(light)


def arguments(kinds, doc):
    """What both checks take: files, and a picture to render."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("files", nargs="+", type=Path, help=f"{kinds} and .pvd files")
    parser.add_argument("--picture", type=Path, help="PNG to render")
    return parser


def run(options, check_file, check_series, draw):
    """Checks every file and draws the first (or the last member of it); the exit status."""
    # Without a display VTK warns before it turns to EGL or OSMesa.
    vtk.vtkLogger.SetStderrVerbosity(vtk.vtkLogger.VERBOSITY_ERROR)
    checks = [(check_series if path.suffix == ".pvd" else check_file, (path,)) for path in options.files]
    if options.picture:
        first = options.files[0]
        source = members(first)[-1][1] if first.suffix == ".pvd" else first
        checks.append((draw, (source, options.picture)))
    failed = 0
    for check, given in checks:
        try:
            check(*given)
        except (AssertionError, ElementTree.ParseError, OSError) as reason:
            failed += 1
            print(f"FAILED {reason}")
    print(f"{len(checks) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(run(arguments(".vtp", __doc__).parse_args(), check_vtp, check_pvd, picture))
