// A level of the model, made ready for surfaces, cuts and radiographs.
import { decodeArray } from './arrays.js';
import { coefficientCount } from './bernstein.js';

/** Where each cell's coefficients begin, and one entry more: where they end. */
function coefficientBegins(degrees) {
  const begins = new Uint32Array(degrees.length + 1);
  for (let cell = 0; cell < degrees.length; ++cell) {
    begins[cell + 1] = begins[cell] + coefficientCount(degrees[cell]);
  }
  return begins;
}

/** The vertices of the face opposite each vertex, counter-clockwise seen from outside a positive cell. */
export const facesOfCell = [
  [1, 2, 3],
  [0, 3, 2],
  [0, 1, 3],
  [0, 2, 1]
];

/** For each cell its four neighbours across the faces opposite its vertices, or -1. */
function neighborsOf(tetrahedra, pointCount) {
  const neighbors = new Int32Array(tetrahedra.length).fill(-1);
  // Faces that wait for their second cell, in a list for each lowest vertex.
  const first = new Int32Array(pointCount).fill(-1);
  const next = new Int32Array(tetrahedra.length);
  const middle = new Uint32Array(tetrahedra.length);
  const highest = new Uint32Array(tetrahedra.length);
  for (let face = 0; face < tetrahedra.length; ++face) {
    const [i, j, k] = facesOfCell[face & 3];
    const cell = face & ~3;
    const a = tetrahedra[cell + i];
    const b = tetrahedra[cell + j];
    const c = tetrahedra[cell + k];
    const low = Math.min(a, b, c);
    const high = Math.max(a, b, c);
    const between = a + b + c - low - high;
    let before = -1;
    let other = first[low];
    while (other >= 0 && (middle[other] !== between || highest[other] !== high)) {
      before = other;
      other = next[other];
    }
    if (other >= 0) {
      neighbors[face] = other >> 2;
      neighbors[other] = face >> 2;
      if (before < 0) {
        first[low] = next[other];
      } else {
        next[before] = next[other];
      }
    } else {
      middle[face] = between;
      highest[face] = high;
      next[face] = first[low];
      first[low] = face;
    }
  }
  return neighbors;
}

/**
 * A tetrahedral mesh with a polynomial density in each cell.
 * points: 3 a point, LPS mm; tetrahedra: 4 a cell; regions: 1 a cell; coefficients and degrees may be null (no
 * density).
 */
export class Mesh {
  constructor({ points, tetrahedra, regions, degrees = null, coefficients = null }) {
    this.points = points;
    this.tetrahedra = tetrahedra;
    this.regions = regions;
    this.degrees = degrees;
    this.coefficients = coefficients;
    this.begins = degrees ? coefficientBegins(degrees) : null;
    this.maximumDegree = degrees ? degrees.reduce((most, degree) => Math.max(most, degree), 0) : 0;
    if (coefficients && this.begins[degrees.length] !== coefficients.length) {
      throw new Error("The page's data is damaged: the cells' degrees and their coefficients disagree.");
    }
  }

  /** The mesh of a level of the page's data. */
  static async decode(level) {
    const names = ['points', 'tetrahedra', 'regions', 'degrees', 'coefficients'].filter((name) => level[name]);
    const arrays = await Promise.all(names.map((name) => decodeArray(level[name])));
    return new Mesh(Object.fromEntries(names.map((name, i) => [name, arrays[i]])));
  }

  /** The same cells with other points or coefficients. */
  with({ points = this.points, coefficients = this.coefficients }) {
    const mesh = Object.create(Mesh.prototype);
    return Object.assign(mesh, this, { points, coefficients });
  }

  get hasDensity() {
    return this.coefficients !== null;
  }

  get cellCount() {
    return this.tetrahedra.length / 4;
  }

  get neighbors() {
    this.cachedNeighbors ??= neighborsOf(this.tetrahedra, this.points.length / 3);
    return this.cachedNeighbors;
  }

  /** A cell's coefficients, where the mesh has a density. */
  coefficientsOf(cell) {
    return this.coefficients.subarray(this.begins[cell], this.begins[cell + 1]);
  }

  /** The least and greatest of direction . point over all points. */
  extent(direction) {
    let least = Infinity;
    let greatest = -Infinity;
    for (let i = 0; i < this.points.length; i += 3) {
      const value =
        direction[0] * this.points[i] + direction[1] * this.points[i + 1] + direction[2] * this.points[i + 2];
      least = Math.min(least, value);
      greatest = Math.max(greatest, value);
    }
    return [least, greatest];
  }
}
