#!/usr/bin/env python3
"""Which splines with a continuous gradient there are on a small block of tetrahedra, and how near they come to a smooth field.

Dimensions are those of null spaces of the smoothness conditions, found by singular values: nothing here knows the bases of the
C++ code. Alone it prints a table; density.py writes it into its report.
"""
import itertools
import math

import numpy

CUBES, SIDE, JITTER = 2, 3.0, 0.25  # cubes along an edge of the block, mm, share of the side
POINTS = 60                         # a tetrahedron


def block(cubes=CUBES, seed=1):
    """Points and tetrahedra: cubes split in six, all points moved, so that no planes are left that run through."""
    random = numpy.random.default_rng(seed)
    grid = list(itertools.product(range(cubes + 1), repeat=3))
    points = numpy.array(grid, float)
    points += random.uniform(-JITTER, JITTER, points.shape)
    number = {p: i for i, p in enumerate(grid)}
    cells = []
    for corner in itertools.product(range(cubes), repeat=3):
        for order in itertools.permutations(range(3)):
            at, cell = list(corner), [number[corner]]
            for axis in order:
                at[axis] += 1
                cell.append(number[tuple(at)])
            cells.append(tuple(cell))
    return SIDE * points, cells


def faces(cells):
    """The tetrahedra of each face."""
    found = {}
    for t, cell in enumerate(cells):
        for face in itertools.combinations(sorted(cell), 3):
            found.setdefault(face, []).append(t)
    return found


def split(points, cells):
    """Worsey-Farin: twelve of each tetrahedron."""
    points, incentres, radii = list(points), [], []
    for cell in cells:
        p = numpy.array([points[v] for v in cell])
        areas = numpy.array([numpy.linalg.norm(numpy.cross(*(q[1:] - q[0]))) / 2 for q in (numpy.delete(p, i, 0) for i in range(4))])
        volume = abs(numpy.linalg.det(p[1:] - p[0])) / 6
        incentres.append(areas @ p / areas.sum())
        radii.append(3 * volume / areas.sum())
    first = len(points)
    points += incentres
    parts = [[] for _ in cells]
    for face, of in faces(cells).items():
        a, b, c = (points[v] for v in face)
        normal = numpy.cross(b - a, c - a) / numpy.linalg.norm(numpy.cross(b - a, c - a))
        centre = incentres[of[0]]
        there = incentres[of[1]] if len(of) == 2 else centre - 2 * normal * (normal @ (centre - a))
        share = radii[of[0]] / (radii[of[0]] + (radii[of[1]] if len(of) == 2 else radii[of[0]]))
        points.append((1 - share) * centre + share * there)
        for t in of:
            parts[t] += [(*edge, len(points) - 1, first + t) for edge in itertools.combinations(face, 2)]
    return numpy.array(points), [part for of in parts for part in of]


def coordinates(x, p):
    mu = numpy.linalg.solve((p[1:] - p[0]).T, x - p[0])
    return numpy.array([1 - mu.sum(), *mu])


class Space:
    """Continuous splines of a degree, with the conditions under which their gradients are continuous."""

    def __init__(self, points, cells, degree):
        self.degree, self.points, self.cells, self.number = degree, points, cells, {}
        for cell in cells:
            for control in itertools.combinations_with_replacement(sorted(cell), degree):
                self.number.setdefault(control, len(self.number))
        rows = []
        for face, of in faces(cells).items():
            if len(of) < 2:
                continue
            here, there = ((set(cells[t]) - set(face)).pop() for t in of)
            corners = (*face, here)
            share = coordinates(points[there], points[list(corners)])
            normal = numpy.cross(points[face[1]] - points[face[0]], points[face[2]] - points[face[0]])
            height = abs(normal @ (points[there] - points[face[0]])) / numpy.linalg.norm(normal)
            for ring in itertools.combinations_with_replacement(face, degree - 1):
                row = numpy.zeros(len(self.number))
                for v, weight in (*zip(corners, -share), (there, 1)):
                    row[self.number[tuple(sorted((*ring, v)))]] += weight * degree / height
                rows.append(row)
        self.jumps = numpy.array(rows)  # of the derivative across a face: its control values

    def values(self, x, t):
        """What the coefficients weigh at x, which lies in tetrahedron t."""
        cell = sorted(self.cells[t])
        mu = dict(zip(cell, coordinates(x, self.points[cell])))
        row = numpy.zeros(len(self.number))
        for control in itertools.combinations_with_replacement(cell, self.degree):
            counts = [control.count(v) for v in cell]
            row[self.number[control]] = math.factorial(self.degree) * math.prod(
                mu[v] ** n / math.factorial(n) for v, n in zip(cell, counts))
        return row

    def smooth(self):
        """A basis of those with a continuous gradient, in columns."""
        scale = numpy.abs(self.jumps).max(axis=1, keepdims=True)
        values, vectors = numpy.linalg.eigh((self.jumps / scale).T @ (self.jumps / scale))
        return vectors[:, values < 1e-10 * values.max()]


def field(x):
    return 1000 + 400 * math.sin(0.7 * x[0] + 0.3) * math.cos(0.6 * x[1]) + 200 * math.sin(0.5 * x[2] * x[0] / SIDE)


def rows():
    """(space, free coefficients, root mean square error in HU, largest jump of the derivative across faces in HU/mm)."""
    points, cells = block()
    parts = split(points, cells)
    random = numpy.random.default_rng(2)
    samples = [(points[list(cell)].T @ random.dirichlet(numpy.ones(4)), t) for t, cell in enumerate(cells) for _ in range(POINTS)]
    target = numpy.array([field(x) for x, _ in samples])
    found = []

    def add(name, space, values, basis=None, weight=None):
        matrix = values if basis is None else values @ basis
        if weight is not None:
            matrix, wanted = numpy.vstack([matrix, weight * space.jumps]), numpy.append(target, numpy.zeros(len(space.jumps)))
        else:
            wanted = target
        solution = numpy.linalg.lstsq(matrix, wanted, rcond=None)[0]
        solution = solution if basis is None else basis @ solution
        found.append((name, matrix.shape[1], math.sqrt(((values @ solution - target) ** 2).mean()),
                      numpy.abs(space.jumps @ solution).max()))

    for degree in (2, 3, 4):
        space = Space(points, cells, degree)
        values = numpy.array([space.values(x, t) for x, t in samples])
        add(f"degree {degree}, continuous", space, values)
        if degree == 3:
            for weight in (0.03, 1, 30, 1000):
                add(f"degree 3, continuous, jumps of the gradient weighed by {weight}", space, values, weight=weight)
        add(f"degree {degree}, continuous gradient; global polynomials are {math.comb(degree + 3, 3)}", space, values, space.smooth())
    space = Space(*parts, 3)

    def part(x, t):
        return max(range(12 * t, 12 * t + 12), key=lambda k: coordinates(x, parts[0][list(parts[1][k])]).min())

    values = numpy.array([space.values(x, part(x, t)) for x, t in samples])
    edges = {edge for cell in cells for edge in itertools.combinations(sorted(cell), 2)}
    add(f"degree 3, split in twelve, continuous gradient; 4 V + 2 E = {4 * len(points) + 2 * len(edges)}", space, values, space.smooth())
    return found


def text():
    points, cells = block(3)
    larger = [Space(points, cells, degree).smooth().shape[1] for degree in (2, 3)]
    lines = ["| space | free coefficients | error (HU, root mean square) | largest jump of the gradient (HU/mm) |", "|---|---|---|---|"]
    lines += [f"| {name} | {count} | {error:.3g} | {jump:.1e} |" for name, count, error, jump in rows()]
    return "\n".join(lines) + f"""

In a block of {len(cells)} tetrahedra and {len(points)} points, {larger[0]} splines of degree 2 and {larger[1]} of degree 3 have a
continuous gradient on tetrahedra that are not split; global polynomials are 10 and 20.
"""


if __name__ == "__main__":
    print(text())
