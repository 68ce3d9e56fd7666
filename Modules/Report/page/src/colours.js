// Colours that readers with any colour vision can tell apart.

/** Red, green, blue (0..255) of the map "cividis" (Nuñez, Anderton and Renslow, 2018) by d3's polynomials; share 0..1. */
export function cividis(share) {
  const t = Math.min(1, Math.max(0, share));
  const channels = [
    -4.54 - t * (35.34 - t * (2381.73 - t * (6402.7 - t * (7024.72 - t * 2710.57)))),
    32.49 + t * (170.73 + t * (52.82 - t * (131.46 - t * (176.58 - t * 67.37)))),
    81.24 + t * (442.36 - t * (2482.43 - t * (6167.24 - t * (6614.94 - t * 2475.67))))
  ];
  return channels.map((channel) => Math.min(255, Math.max(0, Math.round(channel))));
}

const densityTable = new Uint8Array(3 * 256);
for (let i = 0; i < 256; ++i) {
  densityTable.set(cividis(i / 255), 3 * i);
}

/** Three bytes for each density, by the map's ends at the range's; grey where there is no density. */
export function coloursOfDensities(densities, [low, high]) {
  const colours = new Uint8Array(3 * densities.length);
  const scale = 255 / (high - low);
  for (let i = 0; i < densities.length; ++i) {
    const value = (densities[i] - low) * scale;
    const entry = 3 * (value > 0 ? (value < 255 ? Math.round(value) : 255) : 0);
    colours[3 * i] = densityTable[entry];
    colours[3 * i + 1] = densityTable[entry + 1];
    colours[3 * i + 2] = densityTable[entry + 2];
  }
  return colours;
}

/** A CSS gradient of the density's colours from left to right. */
export function densityGradient() {
  const stops = Array.from({ length: 17 }, (_, i) => `rgb(${cividis(i / 16).join(' ')})`);
  return `linear-gradient(to right, ${stops.join(', ')})`;
}

// Okabe and Ito's colours, in an order that suits bone: cortical, trabecular, cavity, further layers.
const regionTable = [
  [230, 159, 0], [86, 180, 233], [204, 121, 167], [0, 158, 115], [240, 228, 66], [0, 114, 178], [213, 94, 0]
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
