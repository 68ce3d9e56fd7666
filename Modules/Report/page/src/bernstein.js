// Bernstein polynomials on tetrahedra. The coefficients of a cell of degree n are ordered by the exponents (i, j, k,
// l), i + j + k + l = n, of the barycentric coordinates of its vertices 0..3: i descending, then j, then k. Those of a
// triangle are ordered by (i, j, k) in the same way.

/** The number of coefficients of a polynomial of this degree. */
export function coefficientCount(degree) {
  return ((degree + 1) * (degree + 2) * (degree + 3)) / 6;
}

function factorial(n) {
  return n < 2 ? 1 : n * factorial(n - 1);
}

const tables = [];

/** The exponents, four for each coefficient, and the weights n!/(i! j! k! l!) of a degree. */
function tableOf(degree) {
  if (!tables[degree]) {
    const exponents = [];
    const weights = [];
    for (let i = degree; i >= 0; --i) {
      for (let j = degree - i; j >= 0; --j) {
        for (let k = degree - i - j; k >= 0; --k) {
          const l = degree - i - j - k;
          exponents.push(i, j, k, l);
          weights.push(factorial(degree) / (factorial(i) * factorial(j) * factorial(k) * factorial(l)));
        }
      }
    }
    tables[degree] = { exponents: Uint8Array.from(exponents), weights: Float64Array.from(weights) };
  }
  return tables[degree];
}

const powers = new Float64Array(4 * 32);

function fillPowers(row, degree, base) {
  powers[row] = 1;
  for (let n = 1; n <= degree; ++n) {
    powers[row + n] = powers[row + n - 1] * base;
  }
}

/** The value at barycentric coordinates of the polynomial whose coefficients begin at `begin`. */
export function evaluate(coefficients, begin, degree, b0, b1, b2, b3) {
  const { exponents, weights } = tableOf(degree);
  fillPowers(0, degree, b0);
  fillPowers(32, degree, b1);
  fillPowers(64, degree, b2);
  fillPowers(96, degree, b3);
  let sum = 0;
  for (let c = 0; c < weights.length; ++c) {
    sum +=
      coefficients[begin + c] *
      weights[c] *
      powers[exponents[4 * c]] *
      powers[32 + exponents[4 * c + 1]] *
      powers[64 + exponents[4 * c + 2]] *
      powers[96 + exponents[4 * c + 3]];
  }
  return sum;
}

/** The number of coefficients of a polynomial of this degree on a triangle. */
export function triangleCoefficientCount(degree) {
  return ((degree + 1) * (degree + 2)) / 2;
}

const tetrahedronNumber = (n) => (n * (n + 1) * (n + 2)) / 6;
const triangleNumber = (n) => (n * (n + 1)) / 2;

/** De Casteljau's step: the coefficients of the polynomial's polar form, one of whose arguments is set to a point. */
function setArgument(coefficients, degree, [b0, b1, b2, b3]) {
  const result = new Float64Array(coefficientCount(degree - 1));
  let at = 0;
  // later: the exponents of the vertices 1 to 3 together; last: of 2 and 3.
  for (let later = 0; later < degree; ++later) {
    const [here, next] = [tetrahedronNumber(later), tetrahedronNumber(later + 1)];
    for (let last = 0; last <= later; ++last) {
      const [row, below] = [triangleNumber(last), triangleNumber(last + 1)];
      for (let l = 0; l <= last; ++l) {
        result[at++] =
          b0 * coefficients[here + row + l] +
          b1 * coefficients[next + row + l] +
          b2 * coefficients[next + below + l] +
          b3 * coefficients[next + below + l + 1];
      }
    }
  }
  return result;
}

/** The same polynomial on a triangle as one of a degree higher by one. */
function elevated(coefficients, degree) {
  const result = new Float64Array(triangleCoefficientCount(degree + 1));
  let at = 0;
  for (let later = 0; later <= degree + 1; ++later) {
    for (let k = 0; k <= later; ++k) {
      const [i, j] = [degree + 1 - later, later - k];
      const sum =
        (i > 0 ? i * coefficients[triangleNumber(later) + k] : 0) +
        (j > 0 ? j * coefficients[triangleNumber(later - 1) + k] : 0) +
        (k > 0 ? k * coefficients[triangleNumber(later - 1) + k - 1] : 0);
      result[at++] = sum / (degree + 1);
    }
  }
  return result;
}

/** A polynomial on a triangle as one of degree `target`, which is not below its own. */
function elevatedTo(coefficients, degree, target) {
  let result = coefficients;
  for (let n = degree; n < target; ++n) {
    result = elevated(result, n);
  }
  return result;
}

/** The coefficients with none, one, ... all of the polar form's arguments set to a point. */
function settings(coefficients, degree, point) {
  const steps = [coefficients];
  for (let left = degree; left > 0; --left) {
    steps.push(setArgument(steps.at(-1), left, point));
  }
  return steps;
}

/**
 * A tetrahedron's polynomial on a triangle in it: its Bernstein coefficients on the triangle, of degree `target`, which
 * is not below `degree`. coefficients: the tetrahedron's; corners: the triangle's, by their barycentric coordinates in
 * the tetrahedron. Exact: the values of the polar form at the corners.
 */
export function restrictToTriangle(coefficients, degree, [a, b, c], target) {
  const result = new Float64Array(triangleCoefficientCount(degree));
  settings(coefficients, degree, a).forEach((withA, i) => {
    settings(withA, degree - i, b).forEach((withB, j) => {
      const k = degree - i - j;
      result[triangleNumber(j + k) + k] = settings(withB, k, c)[k][0];
    });
  });
  return elevatedTo(result, degree, target);
}

/** The same on the face whose corners are these three of the tetrahedron's vertices. */
export function restrictToFace(coefficients, degree, [a, b, c], target) {
  const result = new Float64Array(triangleCoefficientCount(degree));
  const exponents = [0, 0, 0, 0];
  let at = 0;
  for (let later = 0; later <= degree; ++later) {
    for (let k = 0; k <= later; ++k) {
      exponents.fill(0);
      exponents[a] = degree - later;
      exponents[b] = later - k;
      exponents[c] = k;
      const last = exponents[2] + exponents[3];
      result[at++] = coefficients[tetrahedronNumber(exponents[1] + last) + triangleNumber(last) + exponents[3]];
    }
  }
  return elevatedTo(result, degree, target);
}

/** The exponents i, j, k and the weight n!/(i! j! k!) of each of a triangle's coefficients. */
export function triangleTerms(degree) {
  const terms = [];
  for (let i = degree; i >= 0; --i) {
    for (let j = degree - i; j >= 0; --j) {
      const k = degree - i - j;
      terms.push({ i, j, k, weight: factorial(degree) / (factorial(i) * factorial(j) * factorial(k)) });
    }
  }
  return terms;
}
