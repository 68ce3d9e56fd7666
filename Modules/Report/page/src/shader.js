// What the graphics card does for a triangle with a density: at each pixel, the polynomial's value and its colour.
import { triangleCoefficientCount, triangleTerms } from './bernstein.js';
import { densityStops } from './colours.js';

const letters = 'xyzw';
const vectorsOf = (degree) => Math.ceil(triangleCoefficientCount(degree) / 4);

/** The names of what each vertex carries beside its position: its place in the triangle, then the coefficients by four. */
export function densityAttributeNames(degree) {
  return ['corner', ...Array.from({ length: vectorsOf(degree) }, (_, i) => `density${i}`)];
}

/**
 * The attributes of the vertices of triangles (three each) with coefficients of a degree: name, number of components,
 * values. The coefficients are turned into shares of the range.
 */
export function densityAttributes({ degree, coefficients }, [low, high]) {
  const stride = triangleCoefficientCount(degree);
  const count = coefficients.length / stride;
  const [corner, ...vectors] = densityAttributeNames(degree);
  const corners = new Float32Array(6 * count);
  for (let i = 0; i < corners.length; i += 6) {
    corners[i] = 1;
    corners[i + 3] = 1;
  }
  return [
    { name: corner, components: 2, values: corners },
    ...vectors.map((name, vector) => {
      const values = new Float32Array(12 * count);
      for (let triangle = 0; triangle < count; ++triangle) {
        for (let c = 0; c < 4 && 4 * vector + c < stride; ++c) {
          const share = (coefficients[stride * triangle + 4 * vector + c] - low) / (high - low);
          values[12 * triangle + c] = share;
          values[12 * triangle + 4 + c] = share;
          values[12 * triangle + 8 + c] = share;
        }
      }
      return { name, components: 4, values };
    })
  ];
}

const glslNumber = (value) => (Number.isInteger(value) ? `${value}.0` : String(value));

/** A power of a barycentric coordinate as a product. */
const power = (name, exponent) => Array(exponent).fill(name);

function polynomial(degree) {
  return triangleTerms(degree)
    .map(({ i, j, k, weight }, term) =>
      [
        `density${term >> 2}VSOutput.${letters[term & 3]}`,
        ...(weight > 1 ? [glslNumber(weight)] : []),
        ...power('u', i),
        ...power('v', j),
        ...power('w', k)
      ].join(' * ')
    )
    .join(' +\n    ');
}

const before = (shaderType, place, code) => ({
  shaderType,
  originalValue: `//VTK::Color::${place}`,
  replacementValue: `${code}\n//VTK::Color::${place}`,
  replaceFirst: true,
  replaceAll: false
});

const after = (shaderType, place, code) => ({
  ...before(shaderType, place, ''),
  replacementValue: `//VTK::Color::${place}\n${code}`
});

/** vtk.js's replacements in the shaders of a mapper whose vertices have densityAttributes of this degree. */
export function densityShader(degree) {
  const names = densityAttributeNames(degree);
  const type = (name) => (name === 'corner' ? 'vec2' : 'vec4');
  // Coefficients are the same at a triangle's three vertices; the place of a pixel at a triangle's rim is one within it,
  // as polynomials grow steeply beyond slender triangles.
  const varying = (name) => `${name === 'corner' ? 'centroid' : 'flat'} varying ${type(name)} ${name}VSOutput;`;
  const stops = densityStops.map((channels) => `vec3(${channels.map((c) => glslNumber(c / 255)).join(', ')})`);
  const last = stops.length - 1;
  return [
    before('Vertex', 'Dec', names.map((name) => `attribute ${type(name)} ${name}MC;\n${varying(name)}`).join('\n')),
    before('Vertex', 'Impl', names.map((name) => `${name}VSOutput = ${name}MC;`).join('\n')),
    before(
      'Fragment',
      'Dec',
      `${names.map(varying).join('\n')}
const vec3 densityStops[${stops.length}] = vec3[${stops.length}](${stops.join(', ')});`
    ),
    after(
      'Fragment',
      'Impl',
      `  float u = cornerVSOutput.x;
  float v = cornerVSOutput.y;
  float w = 1.0 - u - v;
  float share = ${polynomial(degree)};
  share = clamp(share, 0.0, 1.0) * ${glslNumber(last)};
  int stop = min(int(share), ${last - 1});
  diffuseColor = mix(densityStops[stop], densityStops[stop + 1], share - float(stop));
  ambientColor = diffuseColor;`
    )
  ];
}
