// Arrays of numbers as the page's data holds them: base64 of the gzip of little-endian numbers, which may be stored as
// differences, as byte planes, and as steps from an offset.

const types = {
  uint8: Uint8Array,
  int8: Int8Array,
  uint16: Uint16Array,
  int16: Int16Array,
  uint32: Uint32Array,
  int32: Int32Array,
  float32: Float32Array
};

function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) {
    return Uint8Array.fromBase64(text);
  }
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; ++i) {
    bytes[i] = characters.charCodeAt(i);
  }
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The bytes of numbers of which all first bytes, then all second bytes, … were stored. */
function joinPlanes(planes, length, size) {
  const bytes = new Uint8Array(planes.length);
  for (let byte = 0; byte < size; ++byte) {
    for (let i = 0; i < length; ++i) {
      bytes[i * size + byte] = planes[byte * length + i];
    }
  }
  return bytes;
}

/**
 * The numbers of an array of the page's data: a typed array of its type, or a Float64Array where it has a step.
 * Throws an Error where the data holds another number of bytes than its length says.
 */
export async function decodeArray(array) {
  const Type = types[array.type];
  if (!Type) {
    throw new Error(`The page's data has an array of the unknown type "${array.type}".`);
  }
  let bytes = await inflate(bytesOfBase64(array.data));
  if (bytes.length !== array.length * Type.BYTES_PER_ELEMENT) {
    throw new Error(`The page's data is damaged: an array of ${array.length} numbers has ${bytes.length} bytes.`);
  }
  if (array.planes) {
    bytes = joinPlanes(bytes, array.length, Type.BYTES_PER_ELEMENT);
  }
  const raw = new Type(bytes.buffer, bytes.byteOffset, array.length);
  if (array.delta) {
    for (let i = array.delta; i < raw.length; ++i) {
      raw[i] += raw[i - array.delta];
    }
  }
  if (array.step === undefined) {
    return raw;
  }
  const offsets = [array.offset ?? 0].flat();
  return Float64Array.from(raw, (value, i) => offsets[i % offsets.length] + array.step * value);
}

/** A value that may be stored as base64 of the gzip of its JSON. */
export async function decodeJson(value) {
  return value.gzip ? JSON.parse(new TextDecoder().decode(await inflate(bytesOfBase64(value.gzip)))) : value;
}

/**
 * Grey values, slice after slice, of a JPEG that holds the slices as tiles, `across` of them in a row. `count`,
 * `columns` and `rows`: of the slices.
 */
export async function decodeJpeg({ jpeg, across, tile, step, offset }, { count, columns, rows }) {
  const bitmap = await createImageBitmap(new Blob([bytesOfBase64(jpeg)], { type: 'image/jpeg' }));
  const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d', { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  const values = new Float32Array(count * rows * columns);
  for (let k = 0; k < count; ++k) {
    const { data } = context.getImageData((k % across) * tile[0], Math.floor(k / across) * tile[1], columns, rows);
    for (let i = 0; i < rows * columns; ++i) {
      values[k * rows * columns + i] = offset + step * data[4 * i];
    }
  }
  return values;
}
