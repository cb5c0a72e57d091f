"""Writes the meshes in this folder: two triangles of order 2 with groups, by Gmsh, VTK and meshio.

    pip install gmsh vtk meshio && python write.py
"""

import gmsh
import meshio
import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk


def write_gmsh():
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    geo, model = gmsh.model.geo, gmsh.model
    a, b, c, d = [geo.addPoint(*p) for p in [(0, 0, 0), (1, 0, 0), (1, 1, 0.25), (0, 1, 0)]]
    lines = [geo.addLine(*ends) for ends in [(a, b), (b, c), (c, a), (c, d), (d, a)]]
    lower = geo.addPlaneSurface([geo.addCurveLoop(lines[:3])])
    upper = geo.addPlaneSurface([geo.addCurveLoop([-lines[2], *lines[3:]])])
    geo.synchronize()
    # The upper triangle is turned around in the cloth; the lower one is in a second group, without a name.
    model.addPhysicalGroup(2, [lower, -upper], 1, name='cloth "fine"')
    model.addPhysicalGroup(2, [lower], 7)
    model.addPhysicalGroup(1, [-lines[0], lines[3]], 3, name="held edge")
    model.addPhysicalGroup(0, [a], 4, name="corner")
    gmsh.option.setNumber("Mesh.MeshSizeMin", 5)
    model.mesh.generate(2)
    model.mesh.setOrder(2)
    for version in 4.1, 2.2:
        for binary, ending in enumerate(["text", "binary"]):
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            # Everything there is to skip: coordinates on the surface, and elements without a group.
            gmsh.option.setNumber("Mesh.SaveParametric", version == 4.1 and binary)
            gmsh.option.setNumber("Mesh.SaveAll", version == 4.1 and binary)
            gmsh.write(f"gmsh-{version}-{ending}.msh")
    gmsh.finalize()


POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0.25), (0, 1, 0)]
POINTS += [(0.5, 0, 0), (1, 0.5, 0.125), (0.5, 0.5, 0.125), (0.5, 1, 0.125), (0, 0.5, 0)]


def grid():
    grid, points, names = vtk.vtkUnstructuredGrid(), vtk.vtkPoints(), vtk.vtkStringArray()
    points.SetDataTypeToDouble()
    for point in POINTS:
        points.InsertNextPoint(point)
    grid.SetPoints(points)
    for kind, nodes in [(22, [0, 1, 2, 4, 5, 6]), (22, [0, 2, 3, 6, 7, 8]), (21, [0, 1, 4]), (1, [2])]:
        grid.InsertNextCell(kind, len(nodes), nodes)
    groups = numpy_to_vtk(numpy.array([0, 0, 1, 7], dtype=numpy.int32), deep=True)
    groups.SetName("group")
    grid.GetCellData().AddArray(groups)
    pattern = numpy_to_vtk(numpy.array([(2 * x, 2 * y) for x, y, _ in POINTS], dtype=numpy.float32), deep=True)
    pattern.SetName("pattern")
    grid.GetPointData().AddArray(pattern)
    names.SetName("groups")
    for name in "cloth fine", "held édge":
        names.InsertNextValue(name)
    grid.GetFieldData().AddArray(names)
    return grid


def write_vtk():
    for mode in "Ascii", "Binary", "Appended":
        writer = vtk.vtkXMLUnstructuredGridWriter()
        writer.SetInputData(grid())
        getattr(writer, f"SetDataModeTo{mode}")()
        writer.SetEncodeAppendedData(False)
        (writer.SetCompressorTypeToNone if mode == "Ascii" else writer.SetCompressorTypeToZLib)()
        (writer.SetHeaderTypeToUInt32 if mode == "Binary" else writer.SetHeaderTypeToUInt64)()
        (writer.SetByteOrderToBigEndian if mode == "Binary" else writer.SetByteOrderToLittleEndian)()
        writer.SetFileName(f"vtk-{mode.lower()}.vtu")
        assert writer.Write()


def write_meshio():
    cells = [("triangle6", [[0, 1, 2, 4, 5, 6], [0, 2, 3, 6, 7, 8]]), ("line3", [[0, 1, 4]]), ("vertex", [[2]])]
    groups = [numpy.array(tags) for tags in ([1, 1], [2], [0])]
    mesh = meshio.Mesh(numpy.array(POINTS, dtype=float), cells, cell_data={"gmsh:physical": groups})
    mesh.write("meshio.vtu")


write_gmsh()
write_vtk()
write_meshio()
