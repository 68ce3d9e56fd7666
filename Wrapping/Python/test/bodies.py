"""Small bodies with known densities, for tests."""
import itertools
import os

import numpy as np

import bonetk

SANITIZED = "libasan" in os.environ.get("LD_PRELOAD", "")

# Six tetrahedra of a cube about its diagonal 0-7; corner bit 0 is x, 1 is y, 2 is z.
_CUBE = [(0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7)]


def box(cells=(3, 3, 3), size=(30.0, 24.0, 36.0), origin=(0.0, 0.0, 0.0)):
    """A box of cells x 6 tetrahedra, mm; region 1 in its lower half along z, 2 above."""
    axes = [np.linspace(0, s, c + 1) + o for s, c, o in zip(size, cells, origin)]
    points = np.array([(x, y, z) for z in axes[2] for y in axes[1] for x in axes[0]])
    nx, ny = cells[0] + 1, cells[1] + 1
    tetrahedra = []
    for k, j, i in itertools.product(range(cells[2]), range(cells[1]), range(cells[0])):
        corner = [(i + (b & 1)) + nx * ((j + (b >> 1 & 1)) + ny * (k + (b >> 2))) for b in range(8)]
        tetrahedra += [[corner[v] for v in t] for t in _CUBE]
    tetrahedra = np.array(tetrahedra, dtype=np.int32)
    height = points[tetrahedra].mean(axis=1)[:, 2]
    middle = origin[2] + size[2] / 2
    return bonetk.DensityMesh(points, tetrahedra, region=np.where(height < middle, 1, 2))


def at_vertices(mesh, values):
    """The mesh with the density of degree 1 that has these values at its points."""
    # The order of the four coefficients of degree 1 follows from an evaluation near the vertices.
    unit = mesh.replace(coefficients=np.tile([1.0, 2.0, 3.0, 4.0], (len(mesh.tetrahedra), 1)), quantity="hu")
    corners = mesh.points[mesh.tetrahedra[0]]
    order = [int(round(v)) - 1 for v in unit.evaluate(corners * 0.97 + 0.03 * corners.mean(axis=0))]
    coefficients = np.empty((len(mesh.tetrahedra), 4))
    for vertex, column in enumerate(order):
        coefficients[:, column] = values[mesh.tetrahedra[:, vertex]]
    return mesh.replace(coefficients=coefficients, quantity="hu")


def linear(mesh, slope=(3.0, -2.0, 5.0), level=100.0):
    """The mesh with the density level + slope . x."""
    return at_vertices(mesh, level + mesh.points @ np.asarray(slope))


def bump(mesh, height=1000.0):
    """A density that is 0 on the box's surface and `height` in its middle: radiographs without edges."""
    lower, upper = mesh.points.min(axis=0), mesh.points.max(axis=0)
    return at_vertices(mesh, height * np.sin(np.pi * (mesh.points - lower) / (upper - lower)).prod(axis=1))


def ramp_image(slope=(3.0, -2.0, 5.0), level=100.0, shape=(30, 26, 28), spacing=(1.6, 1.4, 1.8), origin=(-6.0, -5.0, -7.0)):
    """An image of level + slope . x that holds the box."""
    z, y, x = np.meshgrid(*[np.arange(n) for n in shape], indexing="ij")
    place = [o + s * index for o, s, index in zip(origin, spacing, (x, y, z))]
    values = level + sum(a * p for a, p in zip(slope, place))
    return bonetk.Image(values.astype(np.float32), origin, spacing)
