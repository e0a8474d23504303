// How far the scanners are off the rig file, where they were estimated.
import { h, table } from './dom.js';
import { millimetres, withStddev } from './format.js';

// Of calibration.json, as people read them: name, unit, in the file's unit.
const COLUMNS = {
  roll_deg: ['roll', '°', 1],
  pitch_deg: ['pitch', '°', 1],
  yaw_deg: ['yaw', '°', 1],
  x_m: ['along x', ' mm', 1000],
  y_m: ['along y', ' mm', 1000],
  z_m: ['height', ' mm', 1000],
  time_s: ['clock', ' ms', 1000],
  range_m: ['ranges', ' mm', 1000],
  range_scale: ['scale', ' ‰', 1000],
};

function cell(parameter) {
  if (!parameter) return '';
  if (parameter.prior_sigma === 0) return 'held';
  const [, unit, scale] = COLUMNS[parameter.name];
  const text = withStddev(scale * parameter.value, scale * parameter.sigma, unit);
  return parameter.observed ? text : h('span', { class: 'open' }, `open: ${text}`);
}

// What is held for every scanner has no column.
function columns(scanners) {
  const free = scanners.flatMap(({ parameters }) => parameters.filter((one) => one.prior_sigma > 0));
  return Object.keys(COLUMNS).filter((key) => free.some((one) => one.name === key));
}

export function drawRig({ scanners, unobserved }) {
  const shown = columns(scanners);
  const rows = scanners.map(({ name, parameters }) => [
    name,
    ...shown.map((key) => cell(parameters.find((one) => one.name === key))),
  ]);
  const open = unobserved.length
    ? `This recording does not show ${unobserved.join(', ')}: they are as the rig file has them.`
    : 'This recording shows all of it.';
  return h(
    'section',
    { id: 'rig' },
    h('h2', {}, 'Rig'),
    h(
      'p',
      {},
      `What the scanners are off the rig file by, about and along the body’s axes. ${open} rig_calibrated.yaml is the rig file for the next recording.`,
    ),
    table(['scanner', ...shown.map((key) => COLUMNS[key][0])], rows, { class: 'rig' }),
  );
}

// Noise of the ranges, as the rig file states it and as the beams scatter about the surfaces.
export function drawNoise(scanners) {
  const list = (bins, unit) =>
    bins.map(({ from, to, noise_m }) => `${from} to ${to}${unit}: ${millimetres(noise_m)}`).join('; ');
  const rows = scanners.map(({ scanner, stated_m, noise_m, by_range_m, by_incidence_deg }) => [
    scanner,
    millimetres(stated_m),
    noise_m === null ? 'too few beams' : millimetres(noise_m),
    list(by_range_m, ' m'),
    list(by_incidence_deg, '°'),
  ]);
  return h(
    'section',
    { id: 'noise' },
    h('h2', {}, 'Noise of the ranges'),
    h(
      'p',
      {},
      'Standard deviations, as the rig file states them and as the beams scatter about the lines of their surfaces, uneven surfaces included.',
    ),
    table(['scanner', 'stated', 'found', 'by range', 'by angle of incidence'], rows, {
      class: 'noise',
    }),
  );
}
