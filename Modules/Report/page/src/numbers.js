// Numbers as people read them.

const minus = '\u2212';

/** A number with this many decimals and a true minus sign. */
export function formatNumber(value, decimals) {
  const text = Math.abs(value).toFixed(decimals);
  return value < 0 && Number(text) !== 0 ? minus + text : text;
}

/** The largest of 1, 2 and 5 times a power of ten that is not above a positive value. */
export function roundStep(value) {
  const power = 10 ** Math.floor(Math.log10(value) + 1e-12);
  const factor = [5, 2, 1].find((candidate) => candidate * power <= value * (1 + 1e-12));
  return factor * power;
}

/** The decimals that multiples of a step need. */
export function decimalsOf(step) {
  return Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
}

/** About `count` round values in a range: { values, decimals }. */
export function ticks([low, high], count) {
  if (!(high > low)) {
    return { values: [low], decimals: 0 };
  }
  let step = roundStep((high - low) / count);
  if ((high - low) / step > 1.6 * count) {
    step = roundStep(2.6 * step);
  }
  const values = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) {
    values.push(i * step || 0);
  }
  return { values, decimals: decimalsOf(step) };
}
