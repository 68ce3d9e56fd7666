// The surfaces of regions.
import { restrictToFace, triangleCoefficientCount } from './bernstein.js';
import { facesOfCell } from './mesh.js';

/** The faces (4 cell + face) of a region's cells across which no cell of that region lies. */
export function regionFaces(mesh, region) {
  const { regions, neighbors } = mesh;
  const faces = [];
  for (let face = 0; face < neighbors.length; ++face) {
    const neighbor = neighbors[face];
    if (regions[face >> 2] === region && (neighbor < 0 || regions[neighbor] !== region)) {
      faces.push(face);
    }
  }
  return Uint32Array.from(faces);
}

/** The surface's unit normals at the mesh's points: the faces' normals, weighted by area. 0 away from the faces. */
export function pointNormals(mesh, faces) {
  const { points, tetrahedra } = mesh;
  const normals = new Float32Array(points.length);
  for (const face of faces) {
    const [a, b, c] = facesOfCell[face & 3].map((vertex) => 3 * tetrahedra[(face & ~3) + vertex]);
    const u = [0, 1, 2].map((i) => points[b + i] - points[a + i]);
    const v = [0, 1, 2].map((i) => points[c + i] - points[a + i]);
    for (let i = 0; i < 3; ++i) {
      const j = (i + 1) % 3;
      const k = (i + 2) % 3;
      const component = u[j] * v[k] - u[k] * v[j];
      normals[a + i] += component;
      normals[b + i] += component;
      normals[c + i] += component;
    }
  }
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
    normals[i] /= length;
    normals[i + 1] /= length;
    normals[i + 2] /= length;
  }
  return normals;
}

/**
 * The surface of a region: its faces with their normals, and the density on each by the polynomial of the face's own
 * cell. Returns points and normals (9 a triangle), degree and coefficients (of the density on each triangle; null
 * without density).
 */
export function regionSurface(mesh, region) {
  const faces = regionFaces(mesh, region);
  const atPoints = pointNormals(mesh, faces);
  const degree = mesh.maximumDegree;
  const stride = triangleCoefficientCount(degree);
  const surface = {
    points: new Float32Array(9 * faces.length),
    normals: new Float32Array(9 * faces.length),
    degree,
    coefficients: mesh.hasDensity ? new Float32Array(stride * faces.length) : null
  };
  faces.forEach((face, index) => {
    const corners = facesOfCell[face & 3];
    corners.forEach((corner, i) => {
      const point = 3 * mesh.tetrahedra[(face & ~3) + corner];
      for (let axis = 0; axis < 3; ++axis) {
        surface.points[9 * index + 3 * i + axis] = mesh.points[point + axis];
        surface.normals[9 * index + 3 * i + axis] = atPoints[point + axis];
      }
    });
    if (mesh.hasDensity) {
      const cell = face >> 2;
      surface.coefficients.set(
        restrictToFace(mesh.coefficientsOf(cell), mesh.degrees[cell], corners, degree),
        stride * index
      );
    }
  });
  return surface;
}
