// The page's data: plain values as JSON, and in it arrays as `page/pack.py` packs them. DATA has typed arrays in place.

const KINDS = {
  f8: Float64Array, f4: Float32Array, u4: Uint32Array, i4: Int32Array, u2: Uint16Array, i2: Int16Array,
  u1: Uint8Array, i1: Int8Array,
};

if (!("DecompressionStream" in window)) {
  const told = document.createElement("p");
  told.setAttribute("role", "alert");
  told.textContent = "This page needs a newer browser: Chrome or Edge 80, Firefox 113, Safari 16.4.";
  document.body.prepend(told);
  throw new Error(told.textContent);
}

async function inflated(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

async function unpacked(pack) {
  const planes = await inflated(pack.deflated);
  const width = KINDS[pack.kind].BYTES_PER_ELEMENT, size = planes.length / width;
  const bytes = new Uint8Array(planes.length);
  for (let j = 0; j < width; j++) for (let k = 0; k < size; k++) bytes[k * width + j] = planes[j * size + k];
  const values = new KINDS[pack.kind](bytes.buffer);
  if (pack.kind[0] === "f") return values;
  const codes = new KINDS[`u${width}`](bytes.buffer); // the same numbers, without signs
  for (let k = 0; k < size; k++) values[k] = (codes[k] >>> 1) ^ -(codes[k] & 1);
  const row = pack.shape[pack.shape.length - 1];
  for (let order = 0; order < pack.differences; order++) {
    for (let k = 1; k < size; k++) if (k % row !== 0) values[k] += values[k - 1];
  }
  if (pack.step === undefined) return values;
  return Float64Array.from(values, (value) => {
    const whole = pack.middle + pack.step * value;
    return pack.log ? 10 ** whole : whole;
  });
}

// The same value with every packed array in it as a typed array: browsers inflate only while the page goes on.
async function withArrays(value) {
  if (value === null || typeof value !== "object") return value;
  if ("deflated" in value) return unpacked(value);
  if (Array.isArray(value)) return Promise.all(value.map(withArrays));
  const entries = Object.entries(value).map(async ([key, part]) => [key, await withArrays(part)]);
  return Object.fromEntries(await Promise.all(entries));
}

// Places that increase: a straight line and what is left of it.
export function placesOf({ first, last, size, rest }) {
  const out = new Float64Array(size);
  const step = size > 1 ? (last - first) / (size - 1) : 0;
  for (let k = 0; k < size; k++) out[k] = first + step * k + (rest ? rest[k] : 0);
  return out;
}

// A page counts as loaded once no image is on its way, so there is one until the data are there: what prints a page as
// soon as it is loaded, as headless browsers do, prints its plots too.
const EMPTY = "data:image/gif;base64,R0lGODlhAQABAAAAACH5BAEKAAEALAAAAAABAAEAAAICTAEAOw==";
let unpacking = true;
function keepLoading() {
  if (!unpacking) return;
  const image = new Image();
  image.onload = keepLoading;
  image.src = EMPTY;
}
keepLoading();
export const DATA = await withArrays(JSON.parse(document.getElementById("data").textContent)).finally(() => { unpacking = false; });
export const DEG = Math.PI / 180;
export const UM = 1e-3; // mm per um
export const TURN = 2 * Math.PI;

export const modulo = (x, n) => ((x % n) + n) % n;
export const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

// The number as text with a true minus sign, so that columns and screen readers agree on it.
export function signed(x, digits) {
  const text = Math.abs(x).toFixed(digits);
  return (x < 0 && Number(text) !== 0 ? "\u2212" : "") + text;
}

// A length given in mm, in the unit that suits its size.
export function lengthText(mm) {
  const round = (x) => String(Number(x.toPrecision(3)));
  if (mm >= 1) return `${round(mm)} mm`;
  if (mm >= 1e-3) return `${round(mm / UM)} \u00b5m`;
  return `${round(mm / 1e-6)} nm`;
}
