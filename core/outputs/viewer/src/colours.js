// Colours on a light ground.

export const SELECTED = ['#1f5fbf', '#d9541e'];
export const GREY = '#8b9099';

const channel = (value) => Math.round(255 * Math.min(1, Math.max(0, value)));

// A colour of even lightness (OKLCH), as [red, green, blue] from 0 to 255.
function oklch(lightness, chroma, hueDegrees) {
  const hue = (hueDegrees * Math.PI) / 180;
  const a = chroma * Math.cos(hue);
  const b = chroma * Math.sin(hue);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const linear = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  return linear.map((x) => channel(x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
}

// Hues of successive numbers are far apart (golden angle).
export const surfaceColour = (id) =>
  oklch(0.7 + 0.05 * ((id % 3) - 1), 0.095, 40 + 137.50776405 * id);

const SCANNERS = [
  '#2f6db5',
  '#d07a1c',
  '#3c8f55',
  '#b03a5b',
  '#7a5bb0',
  '#7d6a4a',
  '#2b9aa0',
  '#8b8b2e',
];
export const scannerColour = (scanner) => rgb(SCANNERS[scanner % SCANNERS.length]);

export function rgb(hex) {
  const number = parseInt(hex.slice(1), 16);
  return [number >> 16, (number >> 8) & 255, number & 255];
}

export const css = ([red, green, blue]) => `rgb(${red}, ${green}, ${blue})`;

// Stops of ramps from 0 to 1.
const RAMPS = {
  // Viridis without its brightest end, which a light ground swallows.
  sequential: ['#440154', '#46327e', '#365c8d', '#277f8e', '#1fa187', '#4ac16d', '#9fc531'],
  diverging: ['#0b3d91', '#4f83c4', '#b4bac2', '#d77d54', '#9e1b1b'],
};

export function rampColour(name, share) {
  const stops = RAMPS[name].map(rgb);
  const place = Math.min(1, Math.max(0, share)) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(place));
  return stops[i].map((from, k) => Math.round(from + (place - i) * (stops[i + 1][k] - from)));
}

export const rampGradient = (name) => `linear-gradient(to right, ${RAMPS[name].join(', ')})`;
