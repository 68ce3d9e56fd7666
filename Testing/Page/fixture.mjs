// A layered solid of tetrahedra with a known density, and report pages made of it, for the page's tests.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { coefficientCount, evaluate } from '../../Modules/Report/page/src/bernstein.js';

const typeNames = new Map([
  [Uint8Array, 'uint8'],
  [Int16Array, 'int16'],
  [Uint16Array, 'uint16'],
  [Uint32Array, 'uint32'],
  [Int32Array, 'int32'],
  [Float32Array, 'float32']
]);

/** An array as the page's data holds it. delta and planes as arrays.js takes them; step and offset are only noted. */
export function encodeArray(values, { planes = false, delta = 0, step, offset } = {}) {
  let raw = values.slice();
  if (delta) {
    for (let i = raw.length - 1; i >= delta; --i) {
      raw[i] -= raw[i - delta];
    }
  }
  const size = raw.BYTES_PER_ELEMENT;
  let bytes = new Uint8Array(raw.buffer);
  if (planes) {
    const source = bytes;
    bytes = new Uint8Array(source.length);
    for (let i = 0; i < raw.length; ++i) {
      for (let byte = 0; byte < size; ++byte) {
        bytes[byte * raw.length + i] = source[i * size + byte];
      }
    }
  }
  const array = {
    type: typeNames.get(values.constructor),
    length: values.length,
    data: gzipSync(bytes).toString('base64')
  };
  return { ...array, ...(planes && { planes }), ...(delta && { delta }), ...(step !== undefined && { step, offset }) };
}

/** Densities by region, polynomials of degree 3, 2 and 1 in mm about the solid's centre. */
export const densityDegrees = { 1: 3, 2: 2, 3: 1 };
export const densityOfRegion = {
  1: (x, y, z) => 1300 + 6 * x - 0.1 * x * y + 0.002 * z * z * x + 0.004 * y * y * y,
  2: (x, y, z) => 320 + 0.5 * x * x - 4 * y + 0.02 * z * z,
  3: (x, y, z) => -60 + x + 0.8 * z
};

/** The matrix from a polynomial's values at the domain points to its Bernstein coefficients. */
function interpolation(degree) {
  const count = coefficientCount(degree);
  const points = [];
  for (let i = degree; i >= 0; --i) {
    for (let j = degree - i; j >= 0; --j) {
      for (let k = degree - i - j; k >= 0; --k) {
        points.push([i, j, k, degree - i - j - k].map((exponent) => (degree ? exponent / degree : 0.25)));
      }
    }
  }
  const rows = points.map((point, r) =>
    [...Array(count).keys()]
      .map((c) => {
        const unit = new Float64Array(count);
        unit[c] = 1;
        return evaluate(unit, 0, degree, ...point);
      })
      .concat(points.map((_, c) => (c === r ? 1 : 0)))
  );
  for (let pivot = 0; pivot < count; ++pivot) {
    const best =
      rows
        .slice(pivot)
        .reduce((most, row, i) => (Math.abs(row[pivot]) > Math.abs(rows[pivot + most][pivot]) ? i : most), 0) + pivot;
    [rows[pivot], rows[best]] = [rows[best], rows[pivot]];
    const scale = rows[pivot][pivot];
    rows[pivot] = rows[pivot].map((value) => value / scale);
    rows.forEach((row, r) => {
      if (r !== pivot && row[pivot] !== 0) {
        const factor = row[pivot];
        rows[r] = row.map((value, c) => value - factor * rows[pivot][c]);
      }
    });
  }
  return { points, matrix: rows.map((row) => row.slice(count)) };
}

/** The Bernstein coefficients of the regions' densities, which are f(x, y, z) by region, of given degrees by region. */
export function fitDensities({ points, tetrahedra, regions }, functions, degreeOf) {
  const degrees = Uint8Array.from(regions, (region) => degreeOf[region]);
  const rules = new Map([...new Set(degrees)].map((degree) => [degree, interpolation(degree)]));
  const coefficients = [];
  regions.forEach((region, cell) => {
    const { points: domain, matrix } = rules.get(degrees[cell]);
    const values = domain.map((barycentric) => {
      const position = [0, 1, 2].map((i) =>
        barycentric.reduce((sum, weight, vertex) => sum + weight * points[3 * tetrahedra[4 * cell + vertex] + i], 0)
      );
      return functions[region](...position);
    });
    matrix.forEach((row) => coefficients.push(row.reduce((sum, weight, i) => sum + weight * values[i], 0)));
  });
  return { degrees, coefficients: Float64Array.from(coefficients) };
}

/**
 * A box of n cubes along each edge, six tetrahedra each, mapped by `map` from [-1, 1]^3, with region 1 in the outer
 * layer, 2 within it and 3 at the core.
 */
export function layeredBox(counts, map) {
  const [nx, ny, nz] = counts;
  const points = [];
  for (let k = 0; k <= nz; ++k) {
    for (let j = 0; j <= ny; ++j) {
      for (let i = 0; i <= nx; ++i) {
        points.push(...map((2 * i) / nx - 1, (2 * j) / ny - 1, (2 * k) / nz - 1));
      }
    }
  }
  const vertex = (i, j, k) => i + (nx + 1) * (j + (ny + 1) * k);
  const orders = [
    [0, 1, 2],
    [1, 2, 0],
    [2, 0, 1],
    [0, 2, 1],
    [2, 1, 0],
    [1, 0, 2]
  ];
  const tetrahedra = [];
  const regions = [];
  for (let k = 0; k < nz; ++k) {
    for (let j = 0; j < ny; ++j) {
      for (let i = 0; i < nx; ++i) {
        const reach = Math.max(
          ...[
            [i, nx],
            [j, ny],
            [k, nz]
          ].map(([index, n]) => Math.abs((2 * index + 1) / n - 1))
        );
        orders.forEach((order, index) => {
          const corner = [i, j, k];
          const path = [vertex(...corner)];
          for (const axis of order) {
            ++corner[axis];
            path.push(vertex(...corner));
          }
          tetrahedra.push(...(index < 3 ? path : [path[0], path[1], path[3], path[2]]));
          regions.push(reach > 0.8 ? 1 : reach > 0.4 ? 2 : 3);
        });
      }
    }
  }
  return {
    points: Float64Array.from(points),
    tetrahedra: Uint32Array.from(tetrahedra),
    regions: Uint8Array.from(regions)
  };
}

/** A rounded, tapered block of about 45 x 30 x 90 mm with a bump to the patient's left (+x) near its upper end. */
export function boneShape(x, y, z) {
  const largest = Math.max(Math.abs(x), Math.abs(y), Math.abs(z));
  const round = 0.25 + (0.75 * largest) / (Math.hypot(x, y, z) || 1);
  const [u, v, w] = [x * round, y * round, z * round];
  const bump = u > 0 ? 14 * u * u * Math.exp(-8 * (w - 0.55) ** 2) : 0;
  return [(19 + 3 * w) * u + bump, (14 + 2 * w) * v, 45 * w];
}

/** The fixture's mesh: points, tetrahedra, regions, degrees, coefficients. */
export function boneMesh(counts = [12, 12, 16], degrees = densityDegrees) {
  const mesh = layeredBox(counts, boneShape);
  return { ...mesh, ...fitDensities(mesh, densityOfRegion, degrees) };
}

/** A mesh as a level of the page's data, its points and coefficients in steps as the page's writer has them. */
export function levelOf(name, mesh) {
  const pointStep = 0.001;
  const density = mesh.coefficients && {
    degrees: encodeArray(mesh.degrees),
    coefficients: encodeArray(
      Int16Array.from(mesh.coefficients, (value) => Math.round(value / 0.25)),
      { planes: true, step: 0.25, offset: 0 }
    )
  };
  return {
    name,
    points: encodeArray(
      Int32Array.from(mesh.points, (value) => Math.round(value / pointStep)),
      { planes: true, delta: 3, step: pointStep, offset: [0, 0, 0] }
    ),
    tetrahedra: encodeArray(mesh.tetrahedra, { planes: true, delta: 4 }),
    regions: encodeArray(mesh.regions),
    ...density
  };
}

const description = {
  unit: 'HU',
  quantity: 'CT number',
  range: [-200, 1600],
  regions: { 1: 'cortical', 2: 'trabecular', 3: 'cavity' }
};

function contoursOf(count) {
  const points = [];
  for (let line = 0; line < count; ++line) {
    for (let i = 0; i < 48; ++i) {
      const angle = (2 * Math.PI * i) / 48;
      const w = (2 * (line + 0.5)) / count - 1;
      const reach = Math.min(1 / Math.abs(Math.cos(angle)), 1 / Math.abs(Math.sin(angle)));
      points.push(...boneShape(reach * Math.cos(angle), reach * Math.sin(angle), w));
    }
  }
  return {
    name: 'periosteal',
    color: '#ff463c',
    counts: encodeArray(new Uint16Array(count).fill(48)),
    closed: encodeArray(new Uint8Array(count).fill(1)),
    points: encodeArray(Float32Array.from(points))
  };
}

/** The page's model; counts: cubes along each edge, by level; degrees: of the density, by region. */
export function modelData(
  counts = [
    [12, 12, 16],
    [6, 6, 8]
  ],
  degrees = densityDegrees
) {
  return {
    ...description,
    levels: counts.map((n, i) => levelOf(`level ${i + 1}`, boneMesh(n, degrees))),
    contours: [contoursOf(18)],
    landmarks: [
      { name: 'left bump', position: boneShape(1, 0, 0.55) },
      { name: 'top', position: boneShape(0, 0, 1) },
      { name: 'front', position: boneShape(0, -1, 0) }
    ]
  };
}

/** Slices of an ellipse, brighter at the rim, with a bright spot at the patient's left front. */
export function slicesData({ columns = 120, rows = 96, count = 9 } = {}) {
  const values = new Uint8Array(columns * rows * count);
  const contours = [];
  for (let slice = 0; slice < count; ++slice) {
    const size = 0.7 + 0.25 * Math.sin((Math.PI * slice) / (count - 1));
    for (let row = 0; row < rows; ++row) {
      for (let column = 0; column < columns; ++column) {
        const reach = Math.hypot((2 * column) / (columns - 1) - 1, (2 * row) / (rows - 1) - 1) / size;
        const spot = Math.hypot(column - 0.7 * columns, row - 0.3 * rows) < 4;
        const unit = spot ? 1400 : reach > 1 ? -100 : reach > 0.8 ? 1250 : 300 - 350 * (1 - reach);
        values[(slice * rows + row) * columns + column] = Math.round((unit + 1000) / 12);
      }
    }
    const ring = (factor) =>
      [...Array(60).keys()].flatMap((i) => {
        const angle = (2 * Math.PI * i) / 60;
        return [
          (0.5 + 0.5 * factor * size * Math.cos(angle)) * (columns - 1),
          (0.5 + 0.5 * factor * size * Math.sin(angle)) * (rows - 1)
        ];
      });
    contours.push([
      { name: 'periosteal', color: '#ff463c', closed: true, points: ring(1) },
      { name: 'endosteal', color: '#3cb4ff', closed: true, points: ring(0.8) }
    ]);
  }
  return {
    columns,
    rows,
    count,
    pixel: 0.5,
    values: encodeArray(values, { step: 12, offset: -1000 }),
    unit: 'HU',
    window: [-200, 1500],
    letters: { left: 'R', right: 'L', top: 'A', bottom: 'P' },
    titles: [...Array(count).keys()].map((i) => `CT slice ${i + 1}, z = ${(-120 + 2.5 * i).toFixed(1)} mm`),
    contours
  };
}

/** An atlas whose first shape mode stretches along z, whose second widens, and whose first density mode adds 60 HU. */
export function atlasData(counts = [6, 6, 8]) {
  const mesh = boneMesh(counts);
  const mode = (change) => {
    const moved = new Float32Array(mesh.points.length);
    for (let i = 0; i < moved.length; i += 3) {
      moved.set(change(mesh.points[i], mesh.points[i + 1], mesh.points[i + 2]), i);
    }
    return encodeArray(moved);
  };
  return {
    ...description,
    mean: levelOf('mean', mesh),
    shape: [
      { share: 0.43, displacements: mode((x, y, z) => [0, 0, 0.08 * z]) },
      { share: 0.21, displacements: mode((x, y) => [0.1 * x, 0.1 * y, 0]) }
    ],
    density: [{ share: 0.61, coefficients: encodeArray(new Float32Array(mesh.coefficients.length).fill(60)) }],
    view: {
      source: [0, -800, 0],
      detectorOrigin: [-47.5, 200, 79.5],
      detectorU: [1, 0, 0],
      detectorV: [0, 0, -1],
      size: [96, 160],
      spacing: [1, 1]
    },
    letters: { left: 'R', right: 'L', top: 'S', bottom: 'I' }
  };
}

const sections = { viewer: 'Model', slices: 'CT slices', atlas: 'Statistical model' };

/** Writes a report page. bundle: the folder of bundle.txt, as CMake or build.mjs makes it. edit changes the page's text. */
export function writePage(path, data, bundle, edit = (html) => html) {
  const source = (name) => readFileSync(new URL(`../../Modules/Report/page/${name}`, import.meta.url), 'utf8');
  const parts = Object.keys(sections).filter((id) => data[id === 'viewer' ? 'model' : id]);
  const html = `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>BoneTK report: ${data.name}</title>
<style>${source('page.css')}</style>
</head>
<body>
<header><h1>${data.name}</h1><p>BoneTK report of a synthetic solid</p>
<nav><a href="#summary">Summary</a>
${parts.map((id) => `<a href="#section-${id}">${sections[id]}</a>`).join(' ')}</nav></header>
<main>
<section class="warnings" role="status"><h2>Warnings</h2><ul><li>This is a test page.</li></ul></section>
<section id="summary"><h2>Summary</h2>
<table><caption>Volumes by region</caption>
<thead><tr><th scope="col">Region</th><th scope="col">Volume (cm\u00b3)</th></tr></thead>
<tbody><tr><th scope="row">cortical</th><td>41.3</td></tr><tr><th scope="row">trabecular</th><td>28.0</td></tr></tbody>
</table>
<details><summary>All parameters</summary>
<table><tbody><tr><th scope="row">degree</th><td>3</td></tr></tbody></table></details>
</section>
${parts.map((id) => `<section id="section-${id}"><h2>${sections[id]}</h2><div id="${id}"></div></section>`).join('\n')}
</main>
<script type="application/json" id="bonetk-data">${JSON.stringify(data).replaceAll('</', '<\\/')}</script>
<script type="application/octet-stream" id="bonetk-bundle">${bundle ? readFileSync(join(bundle, 'bundle.txt'), 'utf8') : ''}</script>
<script>${source('loader.js')}</script>
</body>
</html>
`;
  writeFileSync(path, edit(html));
}
