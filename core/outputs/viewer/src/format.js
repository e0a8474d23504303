// Numbers for people.
const DEGREES = 180 / Math.PI;

const known = (value) => value !== null && value !== undefined && Number.isFinite(value);

// With so many digits that count, without an exponent.
export function digits(value, count = 3) {
  if (!known(value)) return 'unknown';
  if (value === 0) return '0';
  const places = Math.max(0, Math.min(9, count - 1 - Math.floor(Math.log10(Math.abs(value)))));
  return value.toFixed(places);
}

export const metres = (value, places = 2) =>
  known(value) ? `${value.toFixed(places)} m` : 'unknown';
export const millimetres = (value) => (known(value) ? `${digits(1000 * value)} mm` : 'unknown');
export const degrees = (radians, places = 3) =>
  known(radians) ? `${(DEGREES * radians).toFixed(places)}°` : 'unknown';
export const count = (value) => (known(value) ? value.toLocaleString('en-US') : 'unknown');
export const toDegrees = (radians) => DEGREES * radians;

export function seconds(value) {
  if (!known(value)) return 'unknown';
  if (value < 120) return `${value.toFixed(1)} s`;
  return `${Math.floor(value / 60)} min ${String(Math.floor(value % 60)).padStart(2, '0')} s`;
}

// Places after the point so that two digits of a standard deviation show.
const placesFor = (stddev) =>
  stddev > 0 ? Math.max(0, Math.min(8, 1 - Math.floor(Math.log10(stddev)))) : 4;

// A number with its standard deviation, both in a unit: as many digits as it is known to.
export const withStddev = (value, stddev, unit) =>
  `${value.toFixed(placesFor(stddev))}${unit} ± ${digits(stddev, 2)}${unit}`;

// A length in m with its standard deviation in mm.
export function lengthWithStddev(value, stddev) {
  if (!known(value) || !known(stddev)) return metres(value, 4);
  if (stddev === 0) return `${metres(value, 4)} (held, not measured)`;
  return `${value.toFixed(placesFor(stddev))} m ± ${digits(1000 * stddev, 2)} mm`;
}

// An angle in rad with its standard deviation, both in degrees.
export function angleWithStddev(value, stddev) {
  if (!known(value) || !known(stddev)) return degrees(value, 4);
  if (stddev === 0) return `${degrees(value, 4)} (held, not measured)`;
  return `${(DEGREES * value).toFixed(placesFor(DEGREES * stddev))}° ± ${digits(DEGREES * stddev, 2)}°`;
}

export function median(values) {
  const sorted = values.filter(known).sort((a, b) => a - b);
  if (sorted.length === 0) return NaN;
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}
