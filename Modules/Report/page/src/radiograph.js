// The radiograph of a mesh: line integrals of its density from a point source to the pixels of a flat detector.
import { evaluate } from './bernstein.js';

const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const add = (a, b, factor) => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];

const rules = [];

/** The points in [0, 1] and weights of the Gauss-Legendre rule of n points, exact up to degree 2n - 1. */
export function gaussLegendre(n) {
  if (!rules[n]) {
    const rule = { points: [], weights: [] };
    for (let i = 0; i < n; ++i) {
      let x = Math.cos((Math.PI * (i + 0.75)) / (n + 0.5));
      let slope = 1;
      for (let iteration = 0; iteration < 20; ++iteration) {
        let [before, value] = [1, x];
        for (let k = 2; k <= n; ++k) {
          [before, value] = [value, ((2 * k - 1) * x * value - (k - 1) * before) / k];
        }
        slope = n === 1 ? 1 : (n * (x * value - before)) / (x * x - 1);
        x -= (n === 1 ? x : value) / slope;
      }
      rule.points.push((1 + x) / 2);
      rule.weights.push(n === 1 ? 1 : 1 / ((1 - x * x) * slope * slope));
    }
    rules[n] = rule;
  }
  return rules[n];
}

/** A cell's barycentric coordinates are values[i] + slopes[i] . (x - source). */
function barycentricForms(corners, source) {
  const values = [];
  const slopes = [];
  for (let vertex = 0; vertex < 4; ++vertex) {
    const [a, b, c] = [0, 1, 2, 3].filter((other) => other !== vertex).map((other) => corners[other]);
    const normal = cross(subtract(b, a), subtract(c, a));
    const height = dot(normal, subtract(corners[vertex], a));
    slopes.push(normal.map((component) => component / height));
    values.push(dot(normal, subtract(source, a)) / height);
  }
  return { values, slopes };
}

/** The detector's pixels that a cell may project to: [first column, last column, first row, last row], or null. */
function pixelsOfCell(corners, view, axis, distance) {
  const bounds = [Infinity, -Infinity, Infinity, -Infinity];
  for (const corner of corners) {
    const ray = subtract(corner, view.source);
    const depth = dot(axis, ray);
    if (!(depth > 1e-9 * distance)) {
      return [0, view.size[0] - 1, 0, view.size[1] - 1];
    }
    const inPlane = subtract(add(view.source, ray, distance / depth), view.detectorOrigin);
    const column = dot(inPlane, view.detectorU) / view.spacing[0];
    const row = dot(inPlane, view.detectorV) / view.spacing[1];
    bounds[0] = Math.min(bounds[0], column);
    bounds[1] = Math.max(bounds[1], column);
    bounds[2] = Math.min(bounds[2], row);
    bounds[3] = Math.max(bounds[3], row);
  }
  return [
    Math.max(0, Math.ceil(bounds[0])),
    Math.min(view.size[0] - 1, Math.floor(bounds[1])),
    Math.max(0, Math.ceil(bounds[2])),
    Math.min(view.size[1] - 1, Math.floor(bounds[3]))
  ];
}

/**
 * Where a ray is within a cell: the range of t in which no values[i] + t rates[i] is negative, as [entry, exit], at
 * most [0, 1]. A ray in a face's plane belongs to one of the face's two cells: that into which a small shift leads, the
 * same for all cells.
 */
function rangeInCell(values, rates, slopes, range) {
  range[0] = 0;
  range[1] = 1;
  for (let i = 0; i < 4; ++i) {
    if (Math.abs(rates[i]) < 1e-9 && Math.abs(values[i]) < 1e-9) {
      const leading = slopes[i].find((component) => Math.abs(component) > 1e-9);
      range[1] = leading > 0 ? range[1] : -1;
    } else if (rates[i] > 0) {
      range[0] = Math.max(range[0], -values[i] / rates[i]);
    } else if (rates[i] < 0) {
      range[1] = Math.min(range[1], -values[i] / rates[i]);
    } else if (values[i] < 0) {
      range[1] = -1;
    }
  }
}

/** Adds a cell's part to the integrals of the pixels it projects to. */
function addCell(mesh, cell, view, axis, distance, image) {
  const corners = [0, 1, 2, 3].map((vertex) => {
    const point = 3 * mesh.tetrahedra[4 * cell + vertex];
    return [mesh.points[point], mesh.points[point + 1], mesh.points[point + 2]];
  });
  const { values, slopes } = barycentricForms(corners, view.source);
  const degree = mesh.degrees[cell];
  const begin = mesh.begins[cell];
  const { points, weights } = gaussLegendre(Math.floor(degree / 2) + 1);
  const [left, right, top, bottom] = pixelsOfCell(corners, view, axis, distance);
  const range = [0, 1];
  const rates = [0, 0, 0, 0];
  for (let row = top; row <= bottom; ++row) {
    const rowRay = add(subtract(view.detectorOrigin, view.source), view.detectorV, row * view.spacing[1]);
    for (let column = left; column <= right; ++column) {
      // The ray is source + t ray, t from 0 to 1.
      const ray = add(rowRay, view.detectorU, column * view.spacing[0]);
      for (let i = 0; i < 4; ++i) {
        rates[i] = dot(slopes[i], ray);
      }
      rangeInCell(values, rates, slopes, range);
      const [entry, exit] = range;
      if (exit > entry) {
        let sum = 0;
        for (let q = 0; q < points.length; ++q) {
          const t = entry + points[q] * (exit - entry);
          sum +=
            weights[q] *
            evaluate(
              mesh.coefficients,
              begin,
              degree,
              values[0] + t * rates[0],
              values[1] + t * rates[1],
              values[2] + t * rates[2],
              values[3] + t * rates[3]
            );
        }
        image[row * view.size[0] + column] += sum * (exit - entry) * Math.sqrt(dot(ray, ray));
      }
    }
  }
}

/**
 * The line integrals of a mesh's density, in units times mm, row by row.
 * view: source and detectorOrigin (centre of pixel 0, 0) in LPS mm, detectorU and detectorV (unit vectors of increasing
 * column and row), size [columns, rows], spacing [mm, mm].
 */
export function radiograph(mesh, view) {
  const image = new Float64Array(view.size[0] * view.size[1]);
  let axis = cross(view.detectorU, view.detectorV);
  let distance = dot(axis, subtract(view.detectorOrigin, view.source));
  if (distance < 0) {
    axis = axis.map((component) => -component);
    distance = -distance;
  }
  for (let cell = 0; cell < mesh.cellCount; ++cell) {
    addCell(mesh, cell, view, axis, distance, image);
  }
  return image;
}

/** The same view by pixels `factor` times as wide and high. */
export function coarserView(view, factor) {
  const shift = (factor - 1) / 2;
  return {
    ...view,
    size: view.size.map((n) => Math.max(1, Math.floor(n / factor))),
    spacing: view.spacing.map((mm) => mm * factor),
    detectorOrigin: add(
      add(view.detectorOrigin, view.detectorU, shift * view.spacing[0]),
      view.detectorV,
      shift * view.spacing[1]
    )
  };
}
