// What the map is worth, in words, and its figures: the top of the page.
import { h } from './dom.js';
import { count, digits, median, metres, millimetres, seconds } from './format.js';

const WORDS = {
  consistent: ['Consistent', 'Nothing that was measured contradicts this map.'],
  doubtful: [
    'Doubtful',
    'At the intervals named below, this map is in doubt. Elsewhere, nothing that was measured contradicts it.',
  ],
  contradictory: [
    'Contradictory',
    'So much that was measured contradicts this map that neither it nor its standard deviations are to be trusted.',
  ],
};

// Of a variance factor, how the stated noise holds.
export function noiseInWords(factor) {
  if (!(factor > 0)) return null;
  const scale = Math.sqrt(factor);
  if (scale > 0.9 && scale < 1.1) return 'The scanners measured as precisely as the rig file says.';
  if (scale > 1) {
    return `Points scatter ${digits(scale, 2)} times as far as the rig file's noise says: the noise that it states is too small, or the scanners sit elsewhere than it says. Stated standard deviations may be too small.`;
  }
  return `Points scatter only ${digits(scale, 2)} times as far as the rig file's noise says: stated standard deviations may be too large.`;
}

// What most likely went wrong, before all symptoms of it.
function causeBlock(cause) {
  if (!cause) return null;
  return h(
    'dl',
    { class: 'cause' },
    h('dt', {}, 'Likeliest cause'),
    h('dd', {}, h('b', {}, cause.name)),
    h('dt', {}, 'What speaks for it'),
    h('dd', {}, cause.evidence),
    h('dt', {}, 'What to do'),
    h('dd', {}, cause.next_step),
  );
}

// The stretches of the recording that are in doubt, each with all that shows it.
function symptomBlocks(symptoms, onTime) {
  return symptoms.map((group) =>
    h(
      'section',
      { class: 'symptoms' },
      h(
        'h3',
        {},
        `Doubtful from ${group.start_s.toFixed(0)} to ${group.end_s.toFixed(0)} s `,
        h('button', { class: 'link', onclick: () => onTime(group.start_s) }, 'show'),
      ),
      h('ul', {}, group.what.map((text) => h('li', {}, text))),
    ),
  );
}

// On top of the page wherever it is scrolled to, so that nobody takes figures of such a map for
// measured.
export function drawBand({ summary }) {
  const verdict = summary.consistency?.verdict;
  const words = {
    doubtful: 'The map is doubtful: lengths and areas may be wrong',
    contradictory: 'The map contradicts the scans it was made from: do not use it',
  };
  return words[verdict] ? h('p', { class: 'band', role: 'alert' }, words[verdict]) : null;
}

// A warning, with a button that shows the time that it names.
function warningItem(warning, onTime) {
  const text = `${warning.charAt(0).toUpperCase()}${warning.slice(1)}.`;
  const time = /([\d.]+)(?: s)? to [\d.]+ s\b/.exec(warning);
  const show = () => onTime(Number(time[1]));
  return h(
    'li',
    {},
    text,
    ' ',
    time ? h('button', { class: 'link', onclick: show }, 'show') : null,
  );
}

function partSentences({ summary, part_reports: hasReports }) {
  return (summary.parts ?? [])
    .filter((part) => part.folder !== '.')
    .map((part) =>
      h(
        'li',
        {},
        `The recording fell into parts. From ${part.start_s.toFixed(1)} to ${part.end_s.toFixed(1)} s it is mapped in `,
        hasReports
          ? h('a', { href: `${encodeURIComponent(part.folder)}/report.html` }, part.folder)
          : part.folder,
        `, on its own: ${part.verdict}.`,
      ),
    );
}

export function pathLength(poses) {
  let length = 0;
  for (let i = 1; i < poses.length; ++i) {
    length += Math.hypot(...poses[i].position.map((x, axis) => x - poses[i - 1].position[axis]));
  }
  return length;
}

// onTime(t): the reader wants to see that instant.
export function drawVerdict(report, onTime) {
  const { summary } = report;
  const verdict = summary.consistency?.verdict;
  const [word, sentence] = WORDS[verdict] ?? [
    'Not judged',
    'This result does not say whether it can be trusted.',
  ];
  const items = [
    ...(summary.warnings ?? []).map((warning) => warningItem(warning, onTime)),
    ...partSentences(report),
  ];
  const symptoms = summary.consistency?.symptoms ?? [];
  return h(
    'header',
    { class: `verdict ${verdict ?? 'unknown'}` },
    h('p', { class: 'title' }, h('b', {}, report.title), ` mapped by plumbline`),
    h('h1', {}, word),
    h('p', { class: 'lead' }, sentence, ' ', noiseInWords(summary.variance_factor)),
    causeBlock(summary.cause),
    ...symptomBlocks(symptoms, onTime),
    items.length === 0
      ? h('p', { class: 'none' }, 'No warnings.')
      : h(
          'details',
          { open: true, class: 'warnings' },
          h('summary', {}, `${items.length} ${items.length === 1 ? 'warning' : 'warnings'}`),
          h('ul', {}, items),
        ),
  );
}

// Where the truth is known.
function errorFigure(evaluation, figure) {
  const positions = evaluation?.trajectory?.unaligned?.position_m?.rmse;
  if (positions === undefined) return [];
  const note = evaluation.planes
    ? `RMS of positions; surfaces ${millimetres(evaluation.planes.distance_m.rmse)}`
    : 'RMS of positions';
  return [figure(millimetres(positions), 'error against the truth', note)];
}

export function drawFigures(report, poses) {
  const { summary, planes } = report;
  const figure = (value, name, note) =>
    h('div', { class: 'figure' }, h('dt', {}, name), h('dd', {}, value, h('small', {}, note)));
  const walls = planes.filter((plane) => plane.sigma_angle_deg > 0);
  const worstPose = poses.length ? Math.max(...poses.map((pose) => pose.positionStddev)) : NaN;
  // Deviations count on every surface and pose being what the map takes it for.
  const verdict = summary.consistency?.verdict;
  const trusted = verdict === undefined || verdict === 'consistent';
  const precision = [
    figure(
      `± ${millimetres(median(planes.map((plane) => plane.sigma_distance_m)))}`,
      'precision of surfaces',
      `median; in direction ± ${digits(median(walls.map((plane) => plane.sigma_angle_deg)))}°`,
    ),
    figure(
      `± ${millimetres(median(poses.map((pose) => pose.positionStddev)))}`,
      'precision of positions',
      `median; worst ± ${millimetres(worstPose)}`,
    ),
  ];
  return h(
    'dl',
    { class: 'figures' },
    figure(metres(pathLength(poses), 1), 'trajectory', `in ${seconds(summary.duration_s)}`),
    figure(
      count(planes.length),
      'surfaces',
      `from ${count(summary.segments)} segments of scan lines`,
    ),
    figure(
      count(summary.points),
      'points',
      `${digits((100 * summary.points_used) / summary.points)} % lie on surfaces`,
    ),
    figure(
      millimetres(summary.residual_rms_m),
      'residuals, RMS',
      `variance factor ${digits(summary.variance_factor)}`,
    ),
    ...(trusted ? precision : [figure('not stated', 'precision', `the map is ${verdict}`)]),
    ...errorFigure(report.evaluation, figure),
    figure(
      `${digits(summary.real_time_factor)} ×`,
      'real time',
      `${seconds(summary.stages?.total)} for the map`,
    ),
  );
}
