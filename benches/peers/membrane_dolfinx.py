"""The clamped tube of rubber with dolfinx: the energy of the membrane less pressure times volume, written in UFL, by Newton's method.

    /usr/bin/python3 benches/peers/membrane_dolfinx.py revolution ELEMENTS DEGREE STEPS
    /usr/bin/python3 benches/peers/membrane_dolfinx.py triangles ALONG ROUND STEPS

Prints one line of JSON: unknowns, iterations, CPU seconds of the solve (all its steps: assembly, factors, solving), radius at half length, force.
Written for dolfinx 0.5 (Debian 12: python3-dolfinx). Called by membrane.py. mm, N, MPa.
"""

import json
import sys
import time
from collections.abc import Callable

import numpy as np
import ufl
from dolfinx import __version__, fem, mesh, nls
from mpi4py import MPI
from petsc4py import PETSc

RADIUS, LENGTH, STIFFNESS, PRESSURE = 10.0, 60.0, 0.4, 0.03
# The cells at the ends are this many times shorter than even ones, as in Bulge's own case.
GRADING = 3.0
ENOUGH = 1e-9


def graded(t: np.ndarray) -> np.ndarray:
    """0 to 1 onto itself, finer towards both ends: a cubic with slope 1/GRADING there."""
    slope = 1.0 / GRADING
    return t * (slope + t * (1.0 - slope) * (3.0 - 2.0 * t))


def solve(energy: ufl.Form, u: fem.Function, held: list, pressure: fem.Constant, steps: int) -> tuple[int, float]:
    """Newton's method at `steps` rising pressures: iterations and CPU seconds, after the forms were compiled."""
    problem = fem.petsc.NonlinearProblem(ufl.derivative(energy, u), u, held)
    newton = nls.petsc.NewtonSolver(MPI.COMM_SELF, problem)
    newton.convergence_criterion = "residual"
    newton.rtol, newton.atol, newton.max_it = ENOUGH, 1e-11, 40
    options, prefix = PETSc.Options(), newton.krylov_solver.getOptionsPrefix()
    options[f"{prefix}ksp_type"] = "preonly"
    options[f"{prefix}pc_type"] = "cholesky"
    newton.krylov_solver.setFromOptions()
    start, iterations = time.process_time(), 0
    for step in range(1, steps + 1):
        pressure.value = PRESSURE * step / steps
        iterations += newton.solve(u)[0]
    return iterations, time.process_time() - start


def rubber(first: ufl.core.expr.Expr, second: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
    """Neo-Hookean energy per area from the trace and the determinant of C in the plane, incompressible."""
    return 0.5 * STIFFNESS * (first + 1.0 / second - 3.0)


def reaction(energy: ufl.Form, u: fem.Function, dofs: np.ndarray) -> float:
    """The sum of the energy's derivatives by these unknowns."""
    return fem.petsc.assemble_vector(fem.form(ufl.derivative(energy, u))).array[dofs].sum()


def component(space: fem.FunctionSpace, axis: int, dim: int, where: Callable) -> np.ndarray:
    """The unknowns of one component on the part of the boundary (or the vertices) that `where` finds."""
    domain = space.mesh
    entities = mesh.locate_entities_boundary(domain, dim, where)
    return fem.locate_dofs_topological(space.sub(axis), dim, entities)


def revolution(elements: int, degree: int, steps: int) -> dict:
    """One meridian: r and z over the length, Lagrange elements. 30 quadratic ones converge in 4 equal steps, but not in 2, 5 or 10."""
    domain = mesh.create_interval(MPI.COMM_SELF, elements, (0.0, 1.0))
    domain.geometry.x[:, 0] = LENGTH * graded(domain.geometry.x[:, 0])
    space = fem.VectorFunctionSpace(domain, ("Lagrange", degree), dim=2)
    u, pressure = fem.Function(space), fem.Constant(domain, 0.0)
    r, r_s, z_s = RADIUS + u[0], u[0].dx(0), 1.0 + u[1].dx(0)
    along, round_ = r_s**2 + z_s**2, (r / RADIUS) ** 2
    energy = 2 * np.pi * RADIUS * rubber(along + round_, along * round_) - np.pi * pressure * r**2 * z_s
    energy = energy * ufl.dx(metadata={"quadrature_degree": 2 * degree + 2})

    ends = [component(space, axis, 0, lambda x: np.isclose(x[0], 0) | np.isclose(x[0], LENGTH)) for axis in (0, 1)]
    held = [fem.dirichletbc(0.0, dofs, space.sub(axis)) for axis, dofs in enumerate(ends)]
    iterations, seconds = solve(energy, u, held, pressure, steps)
    last = component(space, 1, 0, lambda x: np.isclose(x[0], LENGTH))
    places = space.tabulate_dof_coordinates()[:, 0]
    middle = np.argmin(abs(places - LENGTH / 2))
    return answer(u, iterations, seconds, RADIUS + u.x.array[2 * middle], reaction(energy, u, last))


def triangles(along: int, round_: int, steps: int) -> dict:
    """A quarter of the tube of flat triangles over its whole length. 48 x 24 cells converge in 3 equal steps, but not in 2 or 4."""
    domain = quarter(along, round_)
    space = fem.VectorFunctionSpace(domain, ("Lagrange", 1))
    u, pressure = fem.Function(space), fem.Constant(domain, 0.0)
    flat = ufl.Jacobian(domain)
    bent = flat + ufl.grad(u) * flat
    before, after = flat.T * flat, bent.T * bent
    place, area = ufl.SpatialCoordinate(domain) + u, ufl.cross(bent[:, 0], bent[:, 1])
    # The flux of (x, y, 0)/2 through the wall: discs and planes of symmetry add nothing.
    volume = 0.5 * (place[0] * area[0] + place[1] * area[1]) / ufl.sqrt(ufl.det(before))
    energy = rubber(ufl.tr(ufl.inv(before) * after), ufl.det(after) / ufl.det(before)) - pressure * volume
    energy = energy * ufl.dx(metadata={"quadrature_degree": 2})

    def end(x: np.ndarray) -> np.ndarray:
        return np.isclose(x[2], 0) | np.isclose(x[2], LENGTH)

    where = [lambda x: end(x) | np.isclose(x[0], 0), lambda x: end(x) | np.isclose(x[1], 0), end]
    held = [fem.dirichletbc(0.0, component(space, axis, 1, part), space.sub(axis)) for axis, part in enumerate(where)]
    iterations, seconds = solve(energy, u, held, pressure, steps)
    last = component(space, 2, 1, lambda x: np.isclose(x[2], LENGTH))
    places = space.tabulate_dof_coordinates()
    middle = np.argmin(abs(places[:, 2] - LENGTH / 2) + abs(places[:, 1]))
    return answer(u, iterations, seconds, RADIUS + u.x.array[3 * middle], 4 * reaction(energy, u, last))


def quarter(along: int, round_: int) -> mesh.Mesh:
    """Points on the cylinder, two triangles to a cell, normals outwards.

    The diagonals all run one way: with alternating ones, as Bulge has them, this Newton iteration diverges.
    """
    angle, z = np.linspace(0, np.pi / 2, round_ + 1), LENGTH * graded(np.linspace(0, 1, along + 1))
    angle, z = np.meshgrid(angle, z)
    points = np.stack([RADIUS * np.cos(angle), RADIUS * np.sin(angle), z], -1).reshape(-1, 3)
    corner = (np.arange(along)[:, None] * (round_ + 1) + np.arange(round_)).ravel()
    right, up = corner + 1, corner + round_ + 1
    cells = np.concatenate([np.stack([corner, right, up + 1], -1), np.stack([corner, up + 1, up], -1)])
    flat = ufl.VectorElement("Lagrange", ufl.Cell("triangle", geometric_dimension=3), 1)
    return mesh.create_mesh(MPI.COMM_SELF, cells, points, ufl.Mesh(flat))


def answer(u: fem.Function, iterations: int, seconds: float, radius: float, force: float) -> dict:
    """What is printed."""
    return {
        "version": __version__,
        "unknowns": len(u.x.array),
        "iterations": iterations,
        "seconds": seconds,
        "radius": float(radius),
        "force": float(force),
    }


if __name__ == "__main__":
    kind, *sizes = sys.argv[1:]
    print(json.dumps({"revolution": revolution, "triangles": triangles}[kind](*map(int, sizes))))
