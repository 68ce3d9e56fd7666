// Colours that readers with any colour vision can tell apart.

// The map "viridis" at even distances, as in BoneTK's pictures.
export const densityStops = [
  [68, 1, 84],
  [72, 40, 120],
  [62, 74, 137],
  [49, 104, 142],
  [38, 130, 142],
  [31, 158, 137],
  [53, 183, 121],
  [109, 205, 89],
  [180, 222, 44],
  [253, 231, 37]
];

/** Red, green, blue (0..255) of a share (0..1) of the density's range. */
export function densityColour(share) {
  const at = Math.min(1, Math.max(0, share)) * (densityStops.length - 1);
  const first = Math.min(Math.floor(at), densityStops.length - 2);
  return densityStops[first].map((channel, i) =>
    Math.round(channel + (at - first) * (densityStops[first + 1][i] - channel))
  );
}

/** A CSS gradient of the density's colours from left to right. */
export function densityGradient() {
  return `linear-gradient(to right, ${densityStops.map((colour) => `rgb(${colour.join(' ')})`).join(', ')})`;
}

// Okabe and Ito's colours, in an order that suits bone: cortical, trabecular, cavity, further layers.
const regionTable = [
  [230, 159, 0],
  [86, 180, 233],
  [204, 121, 167],
  [0, 158, 115],
  [240, 228, 66],
  [0, 114, 178],
  [213, 94, 0]
];

/** Red, green, blue (0..255) of a region, numbered from 1. */
export function regionColour(region) {
  return regionTable[(region + regionTable.length - 1) % regionTable.length];
}

/** Three bytes for each region's number. */
export function coloursOfRegions(regions) {
  const colours = new Uint8Array(3 * regions.length);
  regions.forEach((region, i) => colours.set(regionColour(region), 3 * i));
  return colours;
}

/** Red, green, blue (0..1) of a CSS colour such as #ff463c. */
export function parseHexColour(text) {
  const digits = /^#([0-9a-f]{6})$/i.exec(text)?.[1] ?? '808080';
  return [0, 2, 4].map((i) => parseInt(digits.slice(i, i + 2), 16) / 255);
}
