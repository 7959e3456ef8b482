// The page's data: plain values as JSON, arrays as little-endian bytes in base64.

const KINDS = {
  f8: Float64Array, f4: Float32Array, u4: Uint32Array, u2: Uint16Array, i2: Int16Array, u1: Uint8Array, i1: Int8Array,
};

export function unpack(pack) {
  const text = atob(pack.base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  const raw = new KINDS[pack.kind](bytes.buffer);
  if (pack.step === undefined) return raw;
  const out = new Float32Array(raw.length);
  for (let k = 0; k < raw.length; k++) {
    const value = pack.middle + pack.step * raw[k];
    out[k] = pack.log ? 10 ** value : value;
  }
  return out;
}

// Places that increase: a straight line and what is left of it.
export function placesOf(pack) {
  const rest = pack.rest && unpack(pack.rest);
  const out = new Float64Array(pack.size);
  const step = pack.size > 1 ? (pack.last - pack.first) / (pack.size - 1) : 0;
  for (let k = 0; k < pack.size; k++) out[k] = pack.first + step * k + (rest ? rest[k] : 0);
  return out;
}

export const DATA = JSON.parse(document.getElementById("data").textContent);
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
