// The filled cut of a mesh by a plane: the exact polygons in which the plane meets the cells, with their density.
import { restrictToTriangle } from './bernstein.js';

/**
 * The barycentric coordinates of the corners of the polygon in which a plane meets a cell, in order, or an empty list.
 * heights: the vertices' signed distances from the plane; a vertex in the plane counts as above it, so that a face in
 * the plane belongs to one of its two cells.
 */
export function cellPolygon(heights) {
  const above = [0, 1, 2, 3].filter((vertex) => heights[vertex] >= 0);
  const below = [0, 1, 2, 3].filter((vertex) => !(heights[vertex] >= 0));
  const crossing = (a, b) => {
    const corner = [0, 0, 0, 0];
    corner[a] = heights[b] / (heights[b] - heights[a]);
    corner[b] = 1 - corner[a];
    return corner;
  };
  if (above.length === 2) {
    const [a, b] = above;
    const [c, d] = below;
    return [crossing(a, c), crossing(a, d), crossing(b, d), crossing(b, c)];
  }
  if (above.length === 1) {
    return below.map((vertex) => crossing(above[0], vertex));
  }
  if (below.length === 1) {
    return above.map((vertex) => crossing(vertex, below[0]));
  }
  return [];
}

/** The cells, among those of shown regions, that the plane crosses, with their vertices' heights above it. */
function* crossedCells(mesh, normal, offset, isShown) {
  const { points, tetrahedra, regions } = mesh;
  const pointHeights = new Float64Array(points.length / 3);
  for (let i = 0; i < pointHeights.length; ++i) {
    pointHeights[i] =
      normal[0] * points[3 * i] + normal[1] * points[3 * i + 1] + normal[2] * points[3 * i + 2] - offset;
  }
  const heights = [0, 0, 0, 0];
  for (let cell = 0; cell < regions.length; ++cell) {
    if (!isShown(regions[cell])) {
      continue;
    }
    let above = 0;
    for (let vertex = 0; vertex < 4; ++vertex) {
      heights[vertex] = pointHeights[tetrahedra[4 * cell + vertex]];
      above += heights[vertex] >= 0 ? 1 : 0;
    }
    if (above > 0 && above < 4) {
      yield [cell, heights];
    }
  }
}

/** Whether the polygon's corners run counter-clockwise seen from where the normal points to. */
function isCounterClockwise(corners, normal) {
  const [a, b, c] = corners;
  const u = [0, 1, 2].map((i) => b[i] - a[i]);
  const v = [0, 1, 2].map((i) => c[i] - a[i]);
  return (
    normal[0] * (u[1] * v[2] - u[2] * v[1]) +
      normal[1] * (u[2] * v[0] - u[0] * v[2]) +
      normal[2] * (u[0] * v[1] - u[1] * v[0]) >=
    0
  );
}

/**
 * The cut by the plane normal . x = offset (normal of length 1, offset in mm) through the cells whose region isShown
 * accepts: the polygons as triangles, each with the polynomial that its cell's density is on it.
 * Returns points (9 a triangle, mm; counter-clockwise seen from where the normal points to), regions (1 a triangle),
 * degree and coefficients (of the density on each triangle; null without density), outlines (pairs of points, 6 numbers
 * each: the polygons' edges).
 */
export function planeCut(mesh, normal, offset, isShown) {
  const points = [];
  const coefficients = [];
  const regions = [];
  const outlines = [];
  const degree = mesh.maximumDegree;
  const { tetrahedra } = mesh;
  const position = (cell, barycentric) =>
    [0, 1, 2].map((i) => {
      let sum = 0;
      for (let vertex = 0; vertex < 4; ++vertex) {
        sum += barycentric[vertex] * mesh.points[3 * tetrahedra[4 * cell + vertex] + i];
      }
      return sum;
    });
  for (const [cell, heights] of crossedCells(mesh, normal, offset, isShown)) {
    const polygon = cellPolygon(heights);
    const corners = polygon.map((corner) => position(cell, corner));
    if (!isCounterClockwise(corners, normal)) {
      polygon.reverse();
      corners.reverse();
    }
    corners.forEach((corner, i) => outlines.push(...corner, ...corners[(i + 1) % corners.length]));
    for (let fan = 1; fan + 1 < polygon.length; ++fan) {
      points.push(...corners[0], ...corners[fan], ...corners[fan + 1]);
      regions.push(mesh.regions[cell]);
      if (mesh.hasDensity) {
        const triangle = [polygon[0], polygon[fan], polygon[fan + 1]];
        coefficients.push(...restrictToTriangle(mesh.coefficientsOf(cell), mesh.degrees[cell], triangle, degree));
      }
    }
  }
  return {
    points: Float64Array.from(points),
    regions: Uint8Array.from(regions),
    degree,
    coefficients: mesh.hasDensity ? Float64Array.from(coefficients) : null,
    outlines: Float32Array.from(outlines)
  };
}
