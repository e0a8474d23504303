// Errors against the truth, where plumbline_evaluate has found them.
import { h, table } from './dom.js';
import { count, digits } from './format.js';

export function drawEvaluation(evaluation) {
  const { trajectory, planes } = evaluation;
  const mm = (value) => `${digits(1000 * value)} mm`;
  const deg = (value) => `${digits(value)}°`;
  const rows = [];
  for (const [key, name] of [
    ['unaligned', 'positions of the rig'],
    ['aligned', 'positions of the rig, after the best rigid motion'],
    ['relative_1m', 'motion over each metre'],
  ]) {
    const errors = trajectory?.[key];
    if (errors)
      rows.push([
        name,
        mm(errors.position_m.rmse),
        mm(errors.position_m.max),
        deg(errors.rotation_deg.rmse),
        deg(errors.rotation_deg.max),
      ]);
  }
  if (planes)
    rows.push([
      'surfaces',
      mm(planes.distance_m.rmse),
      mm(planes.distance_m.max),
      deg(planes.angle_deg.rmse),
      deg(planes.angle_deg.max),
    ]);
  const sentence =
    planes &&
    `${count(planes.matched)} surfaces match a true face, ${planes.wrong} match none, ${planes.doubled} are doubled; ${planes.missed} true faces are missed. Errors of surfaces are ${digits(planes.distance_m.over_sigma_rms)} (distances) and ${digits(planes.angle_deg.over_sigma_rms)} (directions) times the stated standard deviations; 1 where these are right.`;
  return h(
    'section',
    { id: 'errors' },
    h('h2', {}, 'Errors against the truth'),
    h('p', {}, sentence),
    table(['', 'RMS', 'largest', 'RMS', 'largest'], rows, { class: 'errors' }),
  );
}
