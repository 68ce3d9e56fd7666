// Statistical models as sums.

/** values + sum of weight times change over the modes. */
export function combine(values, changes, weights) {
  const sum = Float64Array.from(values);
  changes.forEach((change, mode) => {
    if (weights[mode] !== 0) {
      for (let i = 0; i < sum.length; ++i) {
        sum[i] += weights[mode] * change[i];
      }
    }
  });
  return sum;
}
