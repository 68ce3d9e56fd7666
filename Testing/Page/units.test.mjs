// The page's pure functions: arrays, polynomials, surfaces, cuts, radiographs, numbers.
import assert from 'node:assert/strict';
import test from 'node:test';
import { gzipSync } from 'node:zlib';
import { decodeArray, decodeJson } from '../../Modules/Report/page/src/arrays.js';
import { combine } from '../../Modules/Report/page/src/modes.js';
import { coefficientCount, evaluate } from '../../Modules/Report/page/src/bernstein.js';
import { densityColour } from '../../Modules/Report/page/src/colours.js';
import { planeCut } from '../../Modules/Report/page/src/cut.js';
import { Mesh } from '../../Modules/Report/page/src/mesh.js';
import { formatNumber, roundStep, ticks } from '../../Modules/Report/page/src/numbers.js';
import { coarserView, gaussLegendre, radiograph } from '../../Modules/Report/page/src/radiograph.js';
import { densityAttributeNames, densityAttributes } from '../../Modules/Report/page/src/shader.js';
import { regionFaces, regionSurface } from '../../Modules/Report/page/src/surface.js';
import { boneMesh, densityOfRegion, encodeArray, fitDensities, layeredBox, levelOf } from './fixture.mjs';

/** Numbers in [0, 1), the same in each run. */
function randomNumbers(seed) {
  let state = seed;
  return () => {
    state = (state * 1664525 + 1013904223) % 2 ** 32;
    return state / 2 ** 32;
  };
}

const near = (value, expected, tolerance, what) =>
  assert.ok(Math.abs(value - expected) <= tolerance, `${what}: ${value} is not ${expected} within ${tolerance}`);
const all = () => true;
const point = (points, i) => [points[3 * i], points[3 * i + 1], points[3 * i + 2]];

/** Half the cross product of a triangle's edges. */
function areaVector(points, [a, b, c]) {
  const [p, q, r] = [a, b, c].map((i) => point(points, i));
  const u = q.map((value, i) => value - p[i]);
  const v = r.map((value, i) => value - p[i]);
  return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]].map((value) => value / 2);
}

function* trianglesOf({ points }) {
  for (let i = 0; 3 * i < points.length; i += 3) {
    yield [i, i + 1, i + 2];
  }
}

/** The value on a triangle at barycentric coordinates, by de Casteljau's algorithm. */
function valueOnTriangle(coefficients, degree, [u, v, w]) {
  let values = [...coefficients];
  for (let n = degree; n > 0; --n) {
    const next = [];
    for (let row = 0, at = 0; row < n; ++row) {
      for (let column = 0; column <= row; ++column, ++at) {
        next.push(u * values[at] + v * values[at + row + 1] + w * values[at + row + 2]);
      }
    }
    values = next;
  }
  return values[0];
}

/** Places in the triangles of a surface or cut, with the density there. */
function* samplesOf({ points, degree, coefficients }) {
  const stride = ((degree + 1) * (degree + 2)) / 2;
  for (let triangle = 0; 9 * triangle < points.length; ++triangle) {
    for (const weights of [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1],
      [0.2, 0.5, 0.3],
      [0.7, 0.1, 0.2]
    ]) {
      const x = [0, 1, 2].map((axis) =>
        weights.reduce((sum, weight, corner) => sum + weight * points[9 * triangle + 3 * corner + axis], 0)
      );
      yield [x, valueOnTriangle(coefficients.subarray(stride * triangle, stride * (triangle + 1)), degree, weights)];
    }
  }
}

function areaOf(surface) {
  let area = 0;
  for (const triangle of trianglesOf(surface)) {
    area += Math.hypot(...areaVector(surface.points, triangle));
  }
  return area;
}

/** A box of 20 x 30 x 40 mm about the origin. */
const boxShape = (x, y, z) => [10 * x, 15 * y, 20 * z];
const cubic = (x, y, z) => 1000 + 20 * x - 3 * y * z + 0.4 * x * y * z - 0.2 * x * x * x + 0.1 * z * z;

function boxMesh(counts, degree = 3, density = cubic) {
  const mesh = layeredBox(counts, boxShape);
  const same = (value) => ({ 1: value, 2: value, 3: value });
  return new Mesh({ ...mesh, ...fitDensities(mesh, same(density), same(degree)) });
}

test('arrays are decoded as they were encoded, by planes, differences and steps', async () => {
  const random = randomNumbers(1);
  for (const [Type, low, high] of [
    [Uint8Array, 0, 256],
    [Int16Array, -32768, 32768],
    [Uint32Array, 0, 2 ** 32]
  ]) {
    const values = Type.from({ length: 301 }, () => Math.floor(low + random() * (high - low)));
    for (const options of [{}, { planes: true }, { delta: 3 }, { planes: true, delta: 4 }]) {
      const decoded = await decodeArray(JSON.parse(JSON.stringify(encodeArray(values, options))));
      assert.deepEqual(decoded, values);
    }
  }
  const floats = Float32Array.from({ length: 9 }, random);
  assert.deepEqual(await decodeArray(encodeArray(floats, { planes: true })), floats);
  const steps = encodeArray(Int16Array.from([0, 1, 2, -3, 4, 5]), { planes: true, step: 0.5, offset: [10, 20, 30] });
  assert.deepEqual([...(await decodeArray(steps))], [10, 20.5, 31, 8.5, 22, 32.5]);
  await assert.rejects(decodeArray({ ...encodeArray(floats), length: 8 }), /damaged/);
  await assert.rejects(decodeArray({ ...encodeArray(floats), type: 'uint64' }), /unknown type "uint64"/);
});

test('JSON is read plain and packed', async () => {
  const value = [[{ name: 'periosteal', points: [1, 2] }], []];
  const packed = { gzip: gzipSync(JSON.stringify(value)).toString('base64') };
  assert.deepEqual(await decodeJson(value), value);
  assert.deepEqual(await decodeJson(packed), value);
});

test('Bernstein polynomials sum to one and their coefficients are in the order of the exponents', () => {
  const random = randomNumbers(2);
  for (let degree = 0; degree <= 8; ++degree) {
    const [a, b, c] = [random() / 3, random() / 3, random() / 3];
    const ones = new Float64Array(coefficientCount(degree)).fill(1);
    near(evaluate(ones, 0, degree, a, b, c, 1 - a - b - c), 1, 1e-13, `sum at degree ${degree}`);
  }
  assert.equal(evaluate([5, 6, 7, 8], 0, 1, 0, 1, 0, 0), 6);
  // 2000, 1100, 1010, 1001, 0200, 0110, 0101, 0020, 0011, 0002 after two numbers of another cell.
  const b = [0.4, 0.3, 0.2, 0.1];
  const pairs = [
    [0, 0],
    [0, 1],
    [0, 2],
    [0, 3],
    [1, 1],
    [1, 2],
    [1, 3],
    [2, 2],
    [2, 3],
    [3, 3]
  ];
  pairs.forEach(([i, j], index) => {
    const unit = new Float64Array(12);
    unit[2 + index] = 1;
    near(evaluate(unit, 2, 2, ...b), (i === j ? 1 : 2) * b[i] * b[j], 1e-15, `coefficient ${index}`);
  });
});

test('a mesh of mixed degrees has in each cell the density of its region', () => {
  const mesh = new Mesh(boneMesh([7, 7, 7]));
  const random = randomNumbers(3);
  assert.equal(new Set(mesh.degrees).size, 3);
  for (let cell = 0; cell < mesh.cellCount; cell += 7) {
    const b = [random(), random(), random(), random()];
    const sum = b.reduce((total, value) => total + value);
    const x = [0, 1, 2].map((i) =>
      b.reduce((total, weight, v) => total + (weight / sum) * mesh.points[3 * mesh.tetrahedra[4 * cell + v] + i], 0)
    );
    near(
      evaluate(mesh.coefficientsOf(cell), 0, mesh.degrees[cell], ...b.map((value) => value / sum)),
      densityOfRegion[mesh.regions[cell]](...x),
      1e-9,
      `cell ${cell}`
    );
  }
});

test('coefficients that do not fit the degrees are refused', () => {
  const mesh = boneMesh([2, 2, 2]);
  assert.throws(() => new Mesh({ ...mesh, coefficients: mesh.coefficients.subarray(1) }), /disagree/);
});

test('a decoded level is the mesh to half a step', async () => {
  const mesh = boneMesh([3, 3, 4]);
  const decoded = await Mesh.decode(levelOf('level 1', mesh));
  assert.deepEqual(decoded.tetrahedra, mesh.tetrahedra);
  assert.deepEqual(decoded.regions, mesh.regions);
  mesh.points.forEach((value, i) => near(decoded.points[i], value, 0.00051, `coordinate ${i}`));
  mesh.coefficients.forEach((value, i) => near(decoded.coefficients[i], value, 0.126, `coefficient ${i}`));
});

test('neighbours are mutual and the outer faces of a box are those of its cubes', () => {
  const mesh = boxMesh([3, 4, 5], 0, () => 1);
  let outer = 0;
  mesh.neighbors.forEach((neighbor, face) => {
    if (neighbor < 0) {
      ++outer;
    } else {
      assert.ok(mesh.neighbors.subarray(4 * neighbor, 4 * neighbor + 4).includes(face >> 2));
    }
  });
  assert.equal(outer, 2 * 2 * (3 * 4 + 4 * 5 + 5 * 3));
});

test("a region's surface is closed, points outward and has the cells' densities", () => {
  const mesh = new Mesh(boneMesh([6, 6, 8]));
  for (const region of [1, 2, 3]) {
    const surface = regionSurface(mesh, region);
    let volume = 0;
    const sum = [0, 0, 0];
    for (const triangle of trianglesOf(surface)) {
      const vector = areaVector(surface.points, triangle);
      const corner = point(surface.points, triangle[0]);
      volume += (vector[0] * corner[0] + vector[1] * corner[1] + vector[2] * corner[2]) / 3;
      vector.forEach((value, i) => {
        sum[i] += value;
      });
    }
    near(Math.hypot(...sum), 0, 1e-3, 'sum of the area vectors');
    near(volume, volumeOf(mesh, region), 1e-4 * volume, `volume of region ${region}`);
    assert.equal(surface.degree, 3);
    for (const [x, density] of samplesOf(surface)) {
      near(density, densityOfRegion[region](...x), 2e-3, `density of region ${region} at ${x}`);
    }
  }
  assert.equal(regionFaces(mesh, 4).length, 0);
});

function volumeOf(mesh, region) {
  let volume = 0;
  for (let cell = 0; cell < mesh.cellCount; ++cell) {
    if (mesh.regions[cell] === region) {
      const [a, b, c, d] = [0, 1, 2, 3].map((v) => point(mesh.points, mesh.tetrahedra[4 * cell + v]));
      const [u, v, w] = [b, c, d].map((corner) => corner.map((value, i) => value - a[i]));
      volume +=
        (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])) /
        6;
    }
  }
  return volume;
}

test("a surface's normals are unit vectors along the faces", () => {
  const surface = regionSurface(
    boxMesh([2, 2, 2], 0, () => 1),
    1
  );
  for (const triangle of trianglesOf(surface)) {
    const vector = areaVector(surface.points, triangle);
    for (const v of triangle) {
      const normal = point(surface.normals, v);
      assert.ok(normal[0] * vector[0] + normal[1] * vector[1] + normal[2] * vector[2] > 0);
    }
  }
});

test("a cut's area is the solid's cross-section, through vertices and faces too", () => {
  const mesh = boxMesh([4, 6, 5]);
  const third = 1 / Math.sqrt(3);
  const cube = new Mesh(layeredBox([3, 3, 3], (x, y, z) => [10 * x, 10 * y, 10 * z]));
  near(areaOf(planeCut(mesh, [0, 0, 1], 3.3, all)), 20 * 30, 1e-9, 'axial');
  near(areaOf(planeCut(mesh, [0, 1, 0], 0, all)), 20 * 40, 1e-9, 'coronal, through faces');
  near(areaOf(planeCut(mesh, [1, 0, 0], -5, all)), 30 * 40, 1e-9, 'sagittal, through faces');
  // A cube's regular hexagon.
  near(areaOf(planeCut(cube, [third, third, third], 0, all)), 0.75 * Math.sqrt(3) * 400, 1e-9, 'hexagon');
  assert.equal(planeCut(mesh, [0, 0, 1], 20.5, all).points.length, 0);
});

test("a cut's triangles face its normal and its regions add up", () => {
  const mesh = new Mesh(boneMesh([6, 6, 8]));
  const length = Math.hypot(1, 2, -3);
  const normal = [1 / length, 2 / length, -3 / length];
  const whole = planeCut(mesh, normal, 1.7, all);
  for (const triangle of trianglesOf(whole)) {
    const vector = areaVector(whole.points, triangle);
    assert.ok(normal[0] * vector[0] + normal[1] * vector[1] + normal[2] * vector[2] > -1e-12);
  }
  const parts = [1, 2, 3].map((region) => planeCut(mesh, normal, 1.7, (other) => other === region));
  parts.forEach((part, i) => assert.deepEqual([...new Set(part.regions)], [i + 1]));
  near(
    parts.reduce((sum, part) => sum + areaOf(part), 0),
    areaOf(whole),
    1e-9,
    'sum of the regions'
  );
});

test('a cut has the exact density of a cubic field everywhere', () => {
  const mesh = boxMesh([3, 4, 5]);
  const length = Math.hypot(2, 1, 2);
  const normal = [2 / length, 1 / length, 2 / length];
  const cut = planeCut(mesh, normal, 2.1, all);
  let count = 0;
  for (const [x, density] of samplesOf(cut)) {
    ++count;
    near(density, cubic(...x), 1e-9, `density at ${x}`);
    near(normal[0] * x[0] + normal[1] * x[1] + normal[2] * x[2], 2.1, 1e-12, `height of ${x}`);
  }
  assert.ok(count > 500);
});

test('cells of lower degrees have their own densities in a cut beside cells of higher degrees', () => {
  const mesh = new Mesh(boneMesh([6, 6, 8]));
  for (const region of [1, 2, 3]) {
    const cut = planeCut(mesh, [0, 0, 1], 0.7, (other) => other === region);
    assert.equal(cut.degree, 3);
    for (const [x, density] of samplesOf(cut)) {
      near(density, densityOfRegion[region](...x), 1e-8, `density of region ${region} at ${x}`);
    }
  }
});

test('each vertex of a triangle with a density carries its place and the coefficients as shares of the range', () => {
  const triangle = { degree: 2, coefficients: [100, 110, 120, 130, 140, 150] };
  const [corner, first, second] = densityAttributes(triangle, [100, 200]);
  assert.deepEqual([corner.name, first.name, second.name], densityAttributeNames(2));
  assert.deepEqual([...corner.values], [1, 0, 0, 1, 0, 0]);
  for (let vertex = 0; vertex < 3; ++vertex) {
    const carried = [first, second].flatMap(({ values }) => [...values.subarray(4 * vertex, 4 * vertex + 4)]);
    [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0, 0].forEach((share, i) => near(carried[i], share, 1e-7, `coefficient ${i}`));
  }
});

test("a cut's outlines are its polygons' edges", () => {
  const mesh = new Mesh({ points: [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1], tetrahedra: [0, 1, 2, 3], regions: [1] });
  const { outlines } = planeCut(mesh, [0, 0, 1], 0.25, all);
  assert.equal(outlines.length, 18);
  let length = 0;
  for (let i = 0; i < outlines.length; i += 6) {
    length += Math.hypot(
      outlines[i] - outlines[i + 3],
      outlines[i + 1] - outlines[i + 4],
      outlines[i + 2] - outlines[i + 5]
    );
  }
  near(length, 0.75 * (2 + Math.SQRT2), 1e-6, 'length');
  outlines.forEach((value, i) => i % 3 === 2 && near(value, 0.25, 1e-6, 'height'));
});

test('Gauss-Legendre rules are exact up to their degree', () => {
  for (let n = 1; n <= 5; ++n) {
    const { points, weights } = gaussLegendre(n);
    for (let power = 0; power < 2 * n; ++power) {
      near(
        points.reduce((sum, x, i) => sum + weights[i] * x ** power, 0),
        1 / (power + 1),
        1e-14,
        `${n} points, x^${power}`
      );
    }
  }
});

const view = {
  source: [3, -500, 7],
  detectorOrigin: [-19, 120, 29],
  detectorU: [1, 0, 0],
  detectorV: [0, 0, -1],
  size: [20, 31],
  spacing: [2, 2]
};

/** The exact integral of a cubic field along a view's ray through the box, by its entry and exit. */
function boxIntegral(field, { source, detectorOrigin, detectorU, detectorV, spacing }, column, row) {
  const ray = [0, 1, 2].map(
    (i) => detectorOrigin[i] + column * spacing[0] * detectorU[i] + row * spacing[1] * detectorV[i] - source[i]
  );
  let [entry, exit] = [0, 1];
  [10, 15, 20].forEach((half, i) => {
    const bounds = [(-half - source[i]) / ray[i], (half - source[i]) / ray[i]];
    if (ray[i] !== 0) {
      entry = Math.max(entry, Math.min(...bounds));
      exit = Math.min(exit, Math.max(...bounds));
    } else if (Math.abs(source[i]) > half) {
      exit = -1;
    }
  });
  if (exit <= entry) {
    return 0;
  }
  const at = (share) => field(...ray.map((value, i) => source[i] + (entry + share * (exit - entry)) * value));
  return ((exit - entry) * Math.hypot(...ray) * (at(0) + 4 * at(0.5) + at(1))) / 6;
}

test('the radiograph of a box is the exact integral of its density, constant and cubic', () => {
  for (const [field, degree, counts] of [
    [() => 1, 0, [3, 2, 4]],
    [cubic, 3, [4, 3, 5]],
    [cubic, 4, [2, 2, 2]]
  ]) {
    const image = radiograph(boxMesh(counts, degree, field), view);
    let hit = 0;
    image.forEach((value, i) => {
      const expected = boxIntegral(field, view, i % 20, Math.floor(i / 20));
      hit += expected !== 0 ? 1 : 0;
      near(value, expected, 1e-6 * Math.max(1, Math.abs(expected)), `pixel ${i}`);
    });
    assert.ok(hit > 100 && hit < image.length);
  }
});

test('a ray in the plane of faces counts each cell once', () => {
  const aligned = { ...view, source: [0, -500, 0], detectorOrigin: [-20, 100, 20], size: [21, 21] };
  const image = radiograph(boxMesh([2, 2, 2], 3), aligned);
  for (const [column, row] of [
    [10, 10],
    [10, 5],
    [6, 10],
    [7, 13]
  ]) {
    near(image[row * 21 + column], boxIntegral(cubic, aligned, column, row), 0.1, `column ${column}, row ${row}`);
  }
});

test('a coarser view has pixels in the middle of those it stands for', () => {
  const coarse = coarserView(view, 2);
  assert.deepEqual(coarse.size, [10, 15]);
  assert.deepEqual(coarse.detectorOrigin, [-18, 120, 28]);
  assert.deepEqual(coarse.spacing, [4, 4]);
});

test('modes add up', () => {
  assert.deepEqual(
    [
      ...combine(
        [1, 2],
        [
          [10, 20],
          [100, 200]
        ],
        [0.5, -1]
      )
    ],
    [-94, -188]
  );
});

test('colours stand for shares and do not leave the map', () => {
  assert.deepEqual(densityColour(0), [68, 1, 84]);
  assert.deepEqual(densityColour(-1e9), densityColour(0));
  assert.deepEqual(densityColour(1), [253, 231, 37]);
  assert.deepEqual(densityColour(1e9), densityColour(1));
  assert.deepEqual(densityColour(4 / 9), [38, 130, 142]);
});

test('numbers are round and legible', () => {
  assert.equal(formatNumber(-120.04, 1), '\u2212120.0');
  assert.equal(formatNumber(-0.04, 1), '0.0');
  assert.deepEqual([0.7, 1, 19.9, 20, 50, 99].map(roundStep), [0.5, 1, 10, 20, 50, 50]);
  assert.deepEqual(ticks([-200, 1600], 5), { values: [0, 500, 1000, 1500], decimals: 0 });
  for (const range of [
    [0, 1],
    [-37, 12],
    [0.001, 0.0032],
    [5, 60000]
  ]) {
    const { values } = ticks(range, 5);
    assert.ok(values.length >= 3 && values.length <= 9, `${values.length} ticks in ${range}`);
    assert.ok(values.every((value) => value >= range[0] - 1e-9 && value <= range[1] + 1e-9));
  }
});
