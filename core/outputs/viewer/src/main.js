// The report's page: puts its parts together, and tells each what the others do.
import { Controls, KEYS, listenToKeys } from './controls.js';
import {
  readFloat64,
  readJson,
  readPoints,
  readPoses,
  readSection,
  scannerNames,
} from './data.js';
import { byId, h, table } from './dom.js';
import { drawEvaluation } from './evaluation.js';
import { digits, millimetres, count } from './format.js';
import { Labels } from './labels.js';
import { JointCovariance } from './joint_covariance.js';
import { speeds } from './motion.js';
import { Plan } from './plan.js';
import { barPlot, residualPlot, timePlot } from './plots.js';
import { drawNoise, drawRig } from './rig.js';
import { scannerColour, css } from './colours.js';
import style from './style.css';
import { Surfaces } from './surfaces.js';
import { Timeline } from './timeline.js';
import { drawBand, drawFigures, drawVerdict } from './verdict.js';
import { NoWebgl, View } from './view.js';

const STAGE_WORDS = { total: 'all' };

function readReport() {
  const report = readJson('report');
  const { consistency = {}, gaps = [] } = report.summary;
  report.intervals = {
    doubtful: consistency.doubtful_intervals ?? [],
    degenerate: consistency.degenerate_intervals ?? [],
    gap: gaps,
  };
  return report;
}

function drawPlots(report, poses, motion, onTime) {
  const { statistics, summary } = report;
  const names = scannerNames(report);
  const options = { intervals: report.intervals, end: poses[poses.length - 1].t, onTime };
  const perSecond = statistics.by_second
    .map((group, i) => [i + 0.5, group])
    .filter(([, [points]]) => points > 0);
  const stages = Object.entries(summary.stages ?? {}).map(([name, value]) => [
    STAGE_WORDS[name] ?? name,
    value,
  ]);
  return h(
    'div',
    { class: 'plots' },
    residualPlot(statistics, summary.residual_rms_m),
    timePlot(
      'Residuals by second',
      'RMS, mm',
      [{ name: 'RMS', class: 'one', points: perSecond.map(([t, group]) => [t, 1000 * group[2]]) }],
      options,
    ),
    timePlot(
      'Points on surfaces',
      'share by second, %',
      [
        {
          name: 'share',
          class: 'one',
          points: perSecond.map(([t, [points, on]]) => [t, (100 * on) / points]),
        },
      ],
      options,
    ),
    timePlot(
      'Stated standard deviation of the position',
      'mm',
      [
        {
          name: 'position',
          class: 'one',
          points: poses.map((pose) => [pose.t, 1000 * pose.positionStddev]),
        },
      ],
      options,
    ),
    timePlot(
      'Speed',
      'm/s',
      [{ name: 'speed', class: 'one', points: motion.map((at) => [at.t, at.speed]) }],
      options,
    ),
    timePlot(
      'Rate of turn',
      'deg/s',
      [{ name: 'turn', class: 'one', points: motion.map((at) => [at.t, at.turn]) }],
      options,
    ),
    barPlot(
      'Residuals by scanner',
      'RMS, mm',
      statistics.by_scanner.map((group, i) => [
        names[i],
        1000 * group[2],
        css(scannerColour(i)),
      ]),
      (value) => digits(value),
    ),
    barPlot('Time for each stage', 's', stages, (value) => `${digits(value)} s`),
  );
}

function drawIntervals(report, onTime) {
  const rows = ['doubtful', 'degenerate', 'gap'].flatMap((kind) =>
    report.intervals[kind].map((interval) => [
      h(
        'button',
        { class: 'link', onclick: () => onTime(interval.start_s) },
        `${interval.start_s.toFixed(2)} to ${interval.end_s.toFixed(2)} s`,
      ),
      h('span', { class: `key ${kind}` }, kind),
      interval.reason ?? `${interval.direction}, ± ${millimetres(interval.stddev_m)}`,
    ]),
  );
  return rows.length
    ? table(['when', 'what', 'why'], rows)
    : h('p', { class: 'hint' }, 'No doubtful and no degenerate intervals.');
}

// Floor plans that the result holds, as pictures: what scripts they might have does not run.
async function drawFloorPlans(number) {
  const figures = [];
  for (let i = 1; i <= number; ++i) {
    const url = URL.createObjectURL(
      new Blob([await readSection(`floor-plan-${i}`)], { type: 'image/svg+xml' }),
    );
    const name = number > 1 ? `Storey ${i}` : 'Rooms';
    figures.push(
      h(
        'figure',
        { class: 'floor-plan' },
        h('figcaption', {}, name),
        h('img', { src: url, alt: `floor plan, ${name}` }),
      ),
    );
  }
  return figures;
}

function drawFrame(report) {
  document.head.append(h('style', {}, style));
  const canvas = h('canvas', {
    id: 'view',
    tabindex: 0,
    'aria-label': 'the map in 3D; arrow keys turn it',
  });
  const frame = {
    canvas,
    top: h('div', {}),
    stage: h(
      'div',
      { class: 'stage' },
      canvas,
      h('p', { class: 'loading', role: 'status' }, 'Unpacking the points …'),
    ),
    panel: h('aside', { class: 'panel' }),
    below: h('div', {}),
  };
  document.body.append(
    ...[drawBand(report)].filter(Boolean),
    frame.top,
    h('section', { class: 'view' }, frame.stage, frame.panel),
    frame.below,
  );
  frame.top.append(drawVerdict(report, (t) => frame.onTime?.(t)));
  return frame;
}

function drawBelow(frame, report, poses, motion, surfaces, plan, plans) {
  const keys = h(
    'details',
    { class: 'keys' },
    h('summary', {}, 'Keys'),
    h(
      'p',
      { class: 'hint' },
      'Drag to turn, drag with the right button or two fingers to shift, wheel to go nearer, double click to look at a place.',
    ),
    h(
      'dl',
      { class: 'facts' },
      KEYS.flatMap(([key, what]) => [h('dt', {}, key), h('dd', {}, what)]),
    ),
  );
  frame.below.append(
    keys,
    h(
      'section',
      { id: 'plan' },
      h('h2', {}, 'Floor plan'),
      ...plans,
      h(
        'p',
        { class: 'hint' },
        `Walls${report.summary.motion === 'planar' ? '' : ' between the heights chosen above'}, and the trajectory. A click chooses a wall.`,
      ),
      plan.element,
    ),
    h(
      'section',
      { id: 'plots' },
      h('h2', {}, 'Over time'),
      h('p', { class: 'hint' }, 'A click in a plot moves the rig to that instant.'),
      drawPlots(report, poses, motion, frame.onTime),
      drawIntervals(report, frame.onTime),
    ),
    ...(report.calibration?.scanners.length ? [drawRig(report.calibration)] : []),
    ...(report.summary.range_noise?.length ? [drawNoise(report.summary.range_noise)] : []),
    ...(report.evaluation ? [drawEvaluation(report.evaluation)] : []),
    h('section', { id: 'surfaces' }, h('h2', {}, 'Surfaces'), surfaces.list),
    h(
      'footer',
      {},
      `${count(report.shownPoints)} of ${count(report.statistics.points)} points are shown. Figures and plots are of all points. Standard deviations are those that the rig file’s noise causes. Times count from the recording’s begin, ${new Date(1000 * report.start_s).toISOString().replace('T', ' ').slice(0, 19)} UTC.`,
    ),
  );
}

function makeView(frame, report, points, poses, onPick) {
  try {
    return new View(frame.canvas, report, points, poses, onPick);
  } catch (error) {
    if (error instanceof NoWebgl) return null;
    throw error;
  }
}

async function start() {
  const report = readReport();
  const frame = drawFrame(report);
  // The points stand behind this script.
  if (document.readyState === 'loading')
    await new Promise((resolve) => {
      document.addEventListener('DOMContentLoaded', resolve);
    });
  const [poses, lower, points, plans] = await Promise.all([
    readPoses(report.num_poses),
    readFloat64('covariance'),
    readPoints(),
    drawFloorPlans(report.floor_plans),
  ]);
  report.shownPoints = points.count;
  frame.top.append(drawFigures(report, poses));
  const withCovariance = new Set(report.covariance_plane_ids);
  const covariance = new JointCovariance(
    report.planes.filter((plane) => withCovariance.has(plane.id)),
    lower,
  );
  const motion = speeds(poses);

  let view = null;
  let labels = null;
  const surfaces = new Surfaces(
    report,
    covariance,
    (ids) => {
      view?.choose(ids);
      plan.choose(ids);
    },
    (measured) => {
      if (!view) return;
      view.drawings.showMeasure(measured?.ends);
      labels.set(surfaces.labels());
      view.schedule();
    },
  );
  const plan = new Plan(report.planes, poses, report.intervals, (index, extend) =>
    surfaces.pick(index, null, extend),
  );
  view = makeView(frame, report, points, poses, (index, point, extend) =>
    surfaces.pick(index, point, extend),
  );
  frame.stage.querySelector('.loading').remove();
  if (view) {
    labels = new Labels(view, frame.stage);
    view.onDrawn = () => labels.place();
  }
  const timeline = new Timeline(poses, motion, report, (t, mode, pose) => {
    plan.moveRig(pose.position);
    if (!view) return;
    view.drawings.moveRig(pose);
    view.showTimes(t, mode);
  });
  frame.onTime = (t) => timeline.set(t);
  drawBelow(frame, report, poses, motion, surfaces, plan, plans);
  if (view) {
    const controls = new Controls(view, plan, report);
    frame.panel.append(surfaces.element, controls.element);
    frame.stage.after(timeline.element);
    listenToKeys({ view, controls, timeline, surfaces });
    return { report, view, controls, timeline, surfaces, plan, points };
  }
  frame.stage.replaceChildren(
    h(
      'p',
      { class: 'loading' },
      'This browser has no WebGL 2, so that there is no 3D view here. Everything else is below.',
    ),
  );
  frame.panel.append(surfaces.element);
  return { report, surfaces, plan, points };
}

// For tests and for the curious.
window.plumbline = { ready: start() };
window.plumbline.ready.then(
  (parts) => Object.assign(window.plumbline, parts, { isReady: true }),
  (error) => {
    document
      .querySelector('.loading')
      ?.replaceChildren(`This report can not be shown: ${error.message}`);
    byId('view')?.remove();
    throw error;
  },
);
