// Formats and parses numbers: units with prefixes, and as many digits as the error allows.

/**
 * @typedef {"length" | "pressure" | "force" | "energy" | "energy per area" | "angle" | "time" | "fraction" |
 *   "number"}
 *   Dimension
 */

/**
 * @typedef {object} Unit
 * @property {string} symbol
 * @property {number | null} power Power of ten relative to the SI unit; null for degrees.
 */

/** @type {Record<Dimension, readonly Unit[]>} */
const UNITS = {
  length: [
    { symbol: "m", power: 0 },
    { symbol: "mm", power: -3 },
    { symbol: "µm", power: -6 },
    { symbol: "nm", power: -9 },
  ],
  pressure: [
    { symbol: "GPa", power: 9 },
    { symbol: "MPa", power: 6 },
    { symbol: "kPa", power: 3 },
    { symbol: "Pa", power: 0 },
  ],
  force: [
    { symbol: "N", power: 0 },
    { symbol: "mN", power: -3 },
    { symbol: "µN", power: -6 },
    { symbol: "nN", power: -9 },
  ],
  energy: [
    { symbol: "J", power: 0 },
    { symbol: "mJ", power: -3 },
    { symbol: "µJ", power: -6 },
    { symbol: "nJ", power: -9 },
    { symbol: "pJ", power: -12 },
    { symbol: "fJ", power: -15 },
  ],
  "energy per area": [
    { symbol: "J/m²", power: 0 },
    { symbol: "mJ/m²", power: -3 },
  ],
  angle: [{ symbol: "°", power: null }],
  time: [
    { symbol: "s", power: 0 },
    { symbol: "ms", power: -3 },
    { symbol: "µs", power: -6 },
  ],
  // The server parses per cent and other input.
  fraction: [],
  number: [],
};

const DEGREE = Math.PI / 180;

/**
 * Units of time that are no powers of ten, s.
 * @type {Readonly<Record<string, number>>}
 */
const LONG_TIMES = { min: 60, h: 3600, d: 86_400 };

/**
 * A formatted number and its unit.
 * @typedef {object} Quantity
 * @property {string} number
 * @property {string} unit
 */

/**
 * Significant digits of a value with this relative error: two to six; three if the error is not estimated yet.
 * @param {number | null} error
 * @returns {number}
 */
export function digitsFor(error) {
  if (error === null) return 3;
  if (!(error > 0)) return 6;
  return Math.min(6, Math.max(2, Math.ceil(-Math.log10(error))));
}

/**
 * Significant digits of a contact radius with this relative error: at most five.
 * @param {number | null} error
 * @returns {number}
 */
export function radiusDigits(error) {
  return Math.min(5, digitsFor(error));
}

/**
 * Formats a number with so many significant digits, with a power of ten only where there would be many zeros.
 * @param {number} value
 * @param {number} digits
 * @returns {string}
 */
export function significant(value, digits) {
  if (value === 0) return "0";
  if (!Number.isFinite(value)) return "–";
  const [mantissa = "0", exponent = "0"] = value.toExponential(digits - 1).split("e");
  const power = Number(exponent);
  if (power < -3 || power >= Math.max(digits, 6)) {
    return `${minus(mantissa)} · 10^{${minus(String(power))}}`;
  }
  const decimals = Math.max(0, digits - 1 - power);
  return minus(Number(`${mantissa}e${power}`).toFixed(decimals));
}

/**
 * Formats a number in its shortest form.
 * @param {number} value
 * @returns {string}
 */
export function plain(value) {
  const text = String(value);
  const [mantissa = "", exponent] = text.split("e");
  return exponent === undefined ? minus(text) : `${minus(mantissa)}e${exponent}`;
}

/**
 * @param {string} text
 * @returns {string}
 */
function minus(text) {
  return text.replace("-", "−");
}

/**
 * The unit in which a value has one to three digits before the point.
 * @param {number} value
 * @param {Dimension} dimension
 * @returns {Unit | null}
 */
function unitFor(value, dimension) {
  const units = UNITS[dimension];
  const size = Math.abs(value);
  const fitting = units.find((unit) => unit.power !== null && size >= 0.9999995 * 10 ** unit.power);
  return fitting ?? units[units.length - 1] ?? null;
}

/**
 * Formats a value in the unit in which it has one to three digits before the point.
 * @param {number} value
 * @param {Dimension} dimension
 * @param {number} digits
 * @returns {Quantity}
 */
export function engineering(value, dimension, digits) {
  if (dimension === "angle") return { number: significant(value / DEGREE, digits), unit: "°" };
  const unit = value === 0 ? (UNITS[dimension][0] ?? null) : unitFor(value, dimension);
  if (unit === null || unit.power === null) return { number: significant(value, digits), unit: "" };
  return { number: significant(value / 10 ** unit.power, digits), unit: unit.symbol };
}

/**
 * Formats a value with its unit in one text.
 * @param {number} value
 * @param {Dimension} dimension
 * @param {number} digits
 * @returns {string}
 */
export function engineeringText(value, dimension, digits) {
  const { number, unit } = engineering(value, dimension, digits);
  return unit === "" ? number : `${number} ${unit}`;
}

/**
 * Formats a value for a field, with all its digits. The decimal point is moved in the text, which causes no rounding
 * error.
 * @param {number} value
 * @param {Dimension} dimension
 * @returns {string}
 */
export function editable(value, dimension) {
  if (dimension === "number" || dimension === "fraction") return String(value);
  if (dimension === "angle") return `${Number((value / DEGREE).toPrecision(12))} deg`;
  const unit = unitFor(value, dimension);
  if (unit === null || unit.power === null) return String(value);
  const [mantissa = "0", exponent = "0"] = value.toExponential().split("e");
  return `${Number(`${mantissa}e${Number(exponent) - unit.power}`)} ${unit.symbol}`;
}

const EXPONENT = /(-?\d+(?:\.\d+)?e-?\d+) (m|N|Pa|J|s)(?![\p{L}\d/^²])/gu;

/**
 * A message in which numbers with an exponent and an SI unit, such as `1.807e-5 m`, have a prefix instead.
 * @param {string} message
 * @returns {string}
 */
export function withPrefixes(message) {
  return message.replace(EXPONENT, (whole, number, symbol) => {
    const dimensions = /** @type {Dimension[]} */ (Object.keys(UNITS));
    const dimension = dimensions.find((each) => UNITS[each].some((unit) => unit.symbol === symbol && unit.power === 0));
    return dimension === undefined ? whole : editable(Number(number), dimension);
  });
}

const NUMBER = /^\s*([+-]?(?:\d+\.?\d*|\.\d+))(?:e([+-]?\d+))?\s*(\S*)\s*$/i;

/**
 * The unit of a number in a text; empty if it has none.
 * @param {string} text
 * @returns {string}
 */
export function unitOf(text) {
  return NUMBER.exec(text)?.[3] ?? "";
}

/**
 * Adds the unit to a text that is a number without one.
 * @param {string} text
 * @param {string} unit
 * @returns {string}
 */
export function withUnit(text, unit) {
  const ascii = text.replace("−", "-");
  return NUMBER.test(ascii) && unitOf(ascii) === "" ? `${text.trim()} ${unit}`.trim() : text;
}

/**
 * The value of a text in SI units; null if only the server can read or refuse the text.
 * @param {string} text
 * @param {Dimension} dimension
 * @returns {number | null}
 */
export function parse(text, dimension) {
  const value = read(text, dimension);
  return value !== null && Number.isFinite(value) ? value : null;
}

/**
 * @param {string} text
 * @param {Dimension} dimension
 * @returns {number | null}
 */
function read(text, dimension) {
  const parts = NUMBER.exec(text.replace("−", "-"));
  if (parts === null) return null;
  const [, digits = "", exponent = "0", symbol = ""] = parts;
  if (symbol === "") return Number(`${digits}e${exponent}`);
  if (dimension === "angle") {
    if (symbol === "°" || symbol === "deg") return Number(`${digits}e${exponent}`) * DEGREE;
    return symbol === "rad" ? Number(`${digits}e${exponent}`) : null;
  }
  const long = dimension === "time" ? LONG_TIMES[symbol] : undefined;
  if (long !== undefined) return Number(`${digits}e${exponent}`) * long;
  const name = symbol
    .replace(/^[uμ]/, "µ")
    .replace(/\^?2$/, "²")
    .replace(/^(m?)N\/m$/, "$1J/m²");
  const unit = UNITS[dimension].find((unit) => unit.symbol === name);
  if (unit === undefined || unit.power === null) return null;
  return Number(`${digits}e${Number(exponent) + unit.power}`);
}

/**
 * Writes a text into an element, with `^{}` as superscript and `_{}` as subscript.
 * @param {Element} element
 * @param {string} text
 */
export function write(element, text) {
  const svg = element instanceof SVGElement;
  const parts = text.split(/(\^\{[^}]*\}|_\{[^}]*\})/);
  element.replaceChildren();
  let shift = 0;
  for (const part of parts) {
    if (part === "") continue;
    const raised = part.startsWith("^{");
    const level = raised ? -0.45 : part.startsWith("_{") ? 0.25 : 0;
    const words = level === 0 ? part : part.slice(2, -1);
    if (!svg) {
      const child = level === 0 ? words : document.createElement(raised ? "sup" : "sub");
      if (child instanceof HTMLElement) child.textContent = words;
      element.append(child);
      continue;
    }
    const span = document.createElementNS("http://www.w3.org/2000/svg", "tspan");
    span.textContent = words;
    if (level !== shift) span.setAttribute("dy", `${(level - shift).toFixed(2)}em`);
    if (level !== 0) span.setAttribute("class", "small");
    shift = level;
    element.append(span);
  }
}
