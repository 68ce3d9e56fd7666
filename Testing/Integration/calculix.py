"""Bodies with a known answer, and CalculiX as a program to solve them."""
import os
import re
import shutil
import subprocess

import numpy

KUHN = [(0, 1, 3, 7), (0, 1, 5, 7), (0, 2, 3, 7), (0, 2, 6, 7), (0, 4, 5, 7), (0, 4, 6, 7)]  # of a cube, conforming
ASH = 4  # of DensityQuantity, g/cm^3


def find_solver():
    """The program; None where it is not installed."""
    return shutil.which("ccx")


def box_mesh(cells, size):
    """Points and tetrahedra of a box from the origin, of so many cubes along each axis."""
    counts = [n + 1 for n in cells]
    grid = numpy.stack(numpy.meshgrid(*[numpy.linspace(0, s, n) for s, n in zip(size, counts)], indexing="ij"), -1)
    number = numpy.arange(numpy.prod(counts)).reshape(counts)
    corner = [number[i:counts[0] - 1 + i, j:counts[1] - 1 + j, k:counts[2] - 1 + k].ravel()
              for k in (0, 1) for j in (0, 1) for i in (0, 1)]
    points = grid.reshape(-1, 3)
    return points, positive(points, numpy.concatenate([numpy.stack([corner[c] for c in t], -1) for t in KUHN]))


def ball_mesh(cells, radius):
    """A cube's grid bent to a ball about the origin."""
    points, tetrahedra = box_mesh([cells] * 3, [2.0] * 3)
    points = points - 1.0
    reach = numpy.abs(points).max(axis=1, keepdims=True)
    length = numpy.linalg.norm(points, axis=1, keepdims=True)
    points = radius * points * numpy.divide(reach, length, out=numpy.zeros_like(length), where=length > 0)
    return points, positive(points, tetrahedra)


def positive(points, tetrahedra):
    a, b, c, d = (points[tetrahedra[:, i]] for i in range(4))
    turned = numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), d - a) < 0
    tetrahedra[turned] = tetrahedra[turned][:, [0, 1, 3, 2]]
    return tetrahedra


def write_model(path, points, tetrahedra, ash):
    """A model whose ash density (g/cm^3) is linear in each tetrahedron between ash(points)."""
    values = ash(points)[tetrahedra]

    def array(kind, name, data, width=1):
        width = f' NumberOfComponents="{width}"' if width > 1 else ""
        text = " ".join(map(str, numpy.asarray(data).ravel().tolist()))
        return f'<DataArray type="{kind}" Name="{name}"{width} format="ascii">{text}</DataArray>'

    count = len(tetrahedra)
    with open(path, "w") as file:
        file.write('<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"><UnstructuredGrid><FieldData>'
                   f'<DataArray type="Int32" Name="DensityQuantity" NumberOfTuples="1" format="ascii">{ASH}</DataArray>'
                   f'</FieldData><Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}"><Points>'
                   + array("Float64", "Points", points, 3) + "</Points><Cells>"
                   + array("Int64", "connectivity", tetrahedra) + array("Int64", "offsets", 4 * numpy.arange(1, count + 1))
                   + array("UInt8", "types", numpy.full(count, 10)) + "</Cells><CellData>"
                   + array("Int32", "Region", numpy.ones(count, int)) + array("Int32", "Degree", numpy.ones(count, int))
                   + array("Float64", "DensityCoefficients", values, 4)
                   + "</CellData></Piece></UnstructuredGrid></VTKFile>\n")


def solve(mesh, step, folder="."):
    """Runs a static step on an exported mesh. Returns {"displacements (...) for set NAME": rows of node, x, y, z}, the
    tables that the step prints; totals are rows without a node."""
    with open(os.path.join(folder, "job.inp"), "w") as file:
        file.write(f"*INCLUDE, INPUT={mesh}\n*STEP\n*STATIC\n{step}\n*END STEP\n")
    done = subprocess.run([find_solver(), "job"], cwd=folder, capture_output=True, text=True)
    if done.returncode != 0 or "*ERROR" in done.stdout:
        raise RuntimeError(done.stdout[-2000:])
    tables, name = {}, ""
    with open(os.path.join(folder, "job.dat")) as file:
        for line in file:
            heading = re.match(r" *(\S.*?) \(\S+\)(?: for set (\S+))?.*time", line)
            if heading:
                name = f"{heading[1]} {heading[2]}"
                tables[name] = []
            elif line.split() and name:
                tables[name].append([float(x) for x in line.split()])
    return {key: numpy.array(rows) for key, rows in tables.items()}
