// The filled cut of a mesh by a plane: the exact polygons in which the plane meets the cells, with their density.
import { dividedTriangle } from './surface.js';

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
 * accepts. Each polygon is divided into triangles `resolution` times finer along each edge, and each vertex has its
 * density by the polynomial of the polygon's own cell.
 * Returns points (3 a vertex, mm), densities (1 a vertex; NaN without density), regions (1 a vertex), triangles (3
 * each, counter-clockwise seen from where the normal points to), outlines (pairs of points, 6 numbers each: the
 * polygons' edges).
 */
export function planeCut(mesh, normal, offset, isShown, resolution) {
  const points = [];
  const densities = [];
  const regions = [];
  const triangles = [];
  const outlines = [];
  const divided = dividedTriangle(resolution);
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
    let corners = polygon.map((corner) => position(cell, corner));
    if (!isCounterClockwise(corners, normal)) {
      polygon.reverse();
      corners.reverse();
    }
    corners.forEach((corner, i) => outlines.push(...corner, ...corners[(i + 1) % corners.length]));
    for (let fan = 1; fan + 1 < polygon.length; ++fan) {
      const [a, b, c] = [0, fan, fan + 1];
      const begin = densities.length;
      for (let v = 0; v < divided.coordinates.length; v += 3) {
        const [wa, wb, wc] = [divided.coordinates[v], divided.coordinates[v + 1], divided.coordinates[v + 2]];
        for (let i = 0; i < 3; ++i) {
          points.push(wa * corners[a][i] + wb * corners[b][i] + wc * corners[c][i]);
        }
        const at = (vertex) => wa * polygon[a][vertex] + wb * polygon[b][vertex] + wc * polygon[c][vertex];
        densities.push(mesh.density(cell, at(0), at(1), at(2), at(3)));
        regions.push(mesh.regions[cell]);
      }
      for (const vertex of divided.triangles) {
        triangles.push(begin + vertex);
      }
    }
  }
  return {
    points: Float64Array.from(points),
    densities: Float64Array.from(densities),
    regions: Uint8Array.from(regions),
    triangles: Uint32Array.from(triangles),
    outlines: Float32Array.from(outlines)
  };
}
