// SPDX-License-Identifier: Apache-2.0
// Colour scales: numbers to colours, for the part and for the legend.

const STOPS = {
  viridis: ["#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"],
  rainbow: ["#1f3bb3", "#1c74d9", "#17a8c9", "#22bf86", "#6fce44", "#c3d32c", "#f2b822", "#f0802a", "#dd3b2b", "#a80f24"],
  signed: ["#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#f7f7f7", "#fddbc7", "#f4a582", "#d6604d", "#b2182b"],
  grey: ["#30343b", "#e8eaee"],
};
export const SCALES = { viridis: "Viridis", rainbow: "Rainbow", signed: "Blue to red", grey: "Grey" };
export const LINES = ["#1b5e9e", "#c2571a", "#2e7d4f", "#7a4a9e", "#a3333d", "#4d6b73", "#8a6d1b", "#5a5a5a"];
const WIDTH = 256;

const toNumbers = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));

/** Return the pixels of a scale (256 x RGBA), from its lowest to its highest colour. */
export function makePixels(scale) {
  const stops = STOPS[scale].map(toNumbers);
  const pixels = new Uint8Array(4 * WIDTH);
  for (let i = 0; i < WIDTH; i++) {
    const place = (i / (WIDTH - 1)) * (stops.length - 1);
    const first = Math.min(Math.floor(place), stops.length - 2), part = place - first;
    for (let c = 0; c < 3; c++) pixels[4 * i + c] = (1 - part) * stops[first][c] + part * stops[first + 1][c];
    pixels[4 * i + 3] = 255;
  }
  return pixels;
}

/** Return the pixels of stops [[value, colour], ...], from the first value to the last. */
export function makeStopPixels(stops) {
  const pixels = new Uint8Array(4 * WIDTH), [low, high] = [stops[0][0], stops.at(-1)[0]], colours = stops.map(([, colour]) => toNumbers(colour));
  for (let i = 0; i < WIDTH; i++) {
    const value = low + (i / (WIDTH - 1)) * (high - low), after = Math.min(Math.max(stops.findIndex(([at]) => at >= value), 1), stops.length - 1);
    const part = (value - stops[after - 1][0]) / (stops[after][0] - stops[after - 1][0]);
    for (let c = 0; c < 3; c++) pixels[4 * i + c] = (1 - part) * colours[after - 1][c] + part * colours[after][c];
    pixels[4 * i + 3] = 255;
  }
  return pixels;
}

/** Return the pixels of zones: steps of one colour each, as many as there are. */
export function makeZonePixels(zones) {
  const pixels = new Uint8Array(4 * WIDTH);
  const colours = zones.map((zone) => toNumbers(zone.colour));
  for (let i = 0; i < WIDTH; i++) {
    const zone = Math.min(Math.floor((i / WIDTH) * zones.length), zones.length - 1);
    pixels.set([...colours[zone], 255], 4 * i);
  }
  return pixels;
}

/** Return a number in at most so many digits, as a legend shows it. */
export function formatNumber(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3) return value.toExponential(Math.max(digits - 2, 1)).replace("e+", "e");
  return String(Number(value.toPrecision(digits))).replace("-", "−");
}

export const withUnit = (label, unit) => (unit ? `${label} [${unit}]` : label);
