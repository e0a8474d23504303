// How far the scanners are off the rig file, where they were estimated.
import { h, table } from './dom.js';
import { withStddev } from './format.js';

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
};

function cell(parameter) {
  if (!parameter) return '';
  if (parameter.prior_sigma === 0) return 'held';
  const [, unit, scale] = COLUMNS[parameter.name];
  const text = withStddev(scale * parameter.value, scale * parameter.sigma, unit);
  return parameter.observed ? text : h('span', { class: 'open' }, `open: ${text}`);
}

export function drawRig({ scanners, unobserved }) {
  const rows = scanners.map(({ name, parameters }) => [
    name,
    ...Object.keys(COLUMNS).map((key) => cell(parameters.find((one) => one.name === key))),
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
    table(['scanner', ...Object.values(COLUMNS).map(([name]) => name)], rows, { class: 'rig' }),
  );
}
