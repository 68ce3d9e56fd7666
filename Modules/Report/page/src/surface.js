// The surfaces of regions.
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

/** The barycentric coordinates, three a vertex, and the triangles of a triangle divided n times along each edge. */
export function dividedTriangle(n) {
  const coordinates = [];
  const triangles = [];
  const rowBegin = (row) => (row * (row + 1)) / 2;
  for (let row = 0; row <= n; ++row) {
    for (let column = 0; column <= row; ++column) {
      coordinates.push((n - row) / n, (row - column) / n, column / n);
      if (row < n) {
        const here = rowBegin(row) + column;
        const below = rowBegin(row + 1) + column;
        triangles.push(here, below, below + 1);
        if (column < row) {
          triangles.push(here, below + 1, here + 1);
        }
      }
    }
  }
  return { coordinates: Float64Array.from(coordinates), triangles: Uint32Array.from(triangles) };
}

/**
 * The surface of a region as triangles: each face is divided `divisions` times, and each vertex has its density by the
 * polynomial of the face's own cell. Returns points and normals (3 a vertex), densities (1 a vertex), triangles (3
 * each).
 */
export function regionSurface(mesh, region, divisions) {
  const faces = regionFaces(mesh, region);
  const faceNormals = pointNormals(mesh, faces);
  const { coordinates, triangles } = dividedTriangle(divisions);
  const perFace = coordinates.length / 3;
  const surface = {
    points: new Float32Array(3 * perFace * faces.length),
    normals: new Float32Array(3 * perFace * faces.length),
    densities: new Float64Array(perFace * faces.length),
    triangles: new Uint32Array(triangles.length * faces.length)
  };
  const barycentric = [0, 0, 0, 0];
  faces.forEach((face, index) => {
    const corners = facesOfCell[face & 3];
    const [a, b, c] = corners.map((vertex) => 3 * mesh.tetrahedra[(face & ~3) + vertex]);
    for (let v = 0; v < perFace; ++v) {
      const [wa, wb, wc] = [coordinates[3 * v], coordinates[3 * v + 1], coordinates[3 * v + 2]];
      const vertex = index * perFace + v;
      for (let i = 0; i < 3; ++i) {
        surface.points[3 * vertex + i] = wa * mesh.points[a + i] + wb * mesh.points[b + i] + wc * mesh.points[c + i];
        surface.normals[3 * vertex + i] = wa * faceNormals[a + i] + wb * faceNormals[b + i] + wc * faceNormals[c + i];
      }
      barycentric[face & 3] = 0;
      barycentric[corners[0]] = wa;
      barycentric[corners[1]] = wb;
      barycentric[corners[2]] = wc;
      surface.densities[vertex] = mesh.density(face >> 2, ...barycentric);
    }
    for (let t = 0; t < triangles.length; ++t) {
      surface.triangles[index * triangles.length + t] = triangles[t] + index * perFace;
    }
  });
  return surface;
}
