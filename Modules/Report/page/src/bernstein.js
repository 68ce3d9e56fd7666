// Bernstein polynomials on tetrahedra. The coefficients of a cell of degree n are ordered by the exponents (i, j, k,
// l), i + j + k + l = n, of the barycentric coordinates of its vertices 0..3: i descending, then j, then k.

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
