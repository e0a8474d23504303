// Plots over time, of residuals and of the run's stages, as SVG of the width that there is.
import { h } from './dom.js';
import { digits } from './format.js';

const MARGIN = { left: 46, right: 10, top: 8, bottom: 22 };
const HEIGHT = 170;
const INTERVAL_KINDS = ['gap', 'degenerate', 'doubtful'];

// Round numbers between two ends, about so many.
export function ticks(low, high, about) {
  const rough = (high - low) / about;
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= rough) * power;
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
    found.push(i * step);
  return found;
}

const label = (value) => String(Number(value.toPrecision(6)));

class Frame {
  constructor(width, [left, right], [low, high]) {
    this.width = width;
    this.x = (value) =>
      MARGIN.left + ((value - left) / (right - left || 1)) * (width - MARGIN.left - MARGIN.right);
    this.y = (value) =>
      HEIGHT -
      MARGIN.bottom -
      ((value - low) / (high - low || 1)) * (HEIGHT - MARGIN.top - MARGIN.bottom);
    this.value = (x) =>
      left + ((x - MARGIN.left) / (width - MARGIN.left - MARGIN.right)) * (right - left);
    this.svg = h('svg', { width, height: HEIGHT, viewBox: `0 0 ${width} ${HEIGHT}`, role: 'img' });
    for (const tick of ticks(low, high, 4)) {
      this.svg.append(
        h('line', {
          class: 'grid',
          x1: MARGIN.left,
          x2: width - MARGIN.right,
          y1: this.y(tick),
          y2: this.y(tick),
        }),
        h(
          'text',
          { class: 'tick', x: MARGIN.left - 6, y: this.y(tick) + 4, 'text-anchor': 'end' },
          label(tick),
        ),
      );
    }
    for (const tick of ticks(left, right, width / 80)) {
      this.svg.append(
        h(
          'text',
          { class: 'tick', x: this.x(tick), y: HEIGHT - 6, 'text-anchor': 'middle' },
          label(tick),
        ),
      );
    }
  }

  path(points, attributes) {
    // At most two points a pixel column show.
    const stride = Math.max(1, Math.floor(points.length / (2 * this.width)));
    const shown = points.filter((_, i) => i % stride === 0);
    const text = shown
      .map(
        ([x, y], i) =>
          `${i && y !== null ? 'L' : 'M'}${this.x(x).toFixed(1)} ${this.y(y ?? 0).toFixed(1)}`,
      )
      .join('');
    this.svg.append(h('path', { d: text, fill: 'none', ...attributes }));
  }
}

// A plot that draws itself again when its width changes. draw(width) returns an SVG element.
function plot(title, note, draw) {
  const place = h('div', { class: 'canvas' });
  let drawnWidth = 0;
  new ResizeObserver(() => {
    const width = Math.floor(place.clientWidth);
    if (width === drawnWidth || width < 50) return;
    drawnWidth = width;
    const svg = draw(width);
    svg.setAttribute('aria-label', title);
    place.replaceChildren(svg);
  }).observe(place);
  return h(
    'figure',
    { class: 'plot' },
    h('figcaption', {}, h('b', {}, title), ' ', note ?? ''),
    place,
  );
}

// lines: [{ name, class, points: [[t, value], ...] }]. A click asks for that time.
export function timePlot(title, unit, lines, { intervals, end, onTime }) {
  const highest = Math.max(1e-9, ...lines.flatMap(({ points }) => points.map(([, y]) => y)));
  const note = h(
    'span',
    {},
    lines.length > 1
      ? lines.map((line) => h('span', { class: `key ${line.class}` }, line.name))
      : '',
    ` ${unit}`,
  );
  return plot(title, note, (width) => {
    const frame = new Frame(width, [0, end], [0, 1.08 * highest]);
    for (const kind of INTERVAL_KINDS) {
      for (const { start_s: from, end_s: to, reason, direction } of intervals[kind]) {
        const x = frame.x(from);
        frame.svg.append(
          h(
            'rect',
            {
              class: `interval ${kind}`,
              x,
              width: Math.max(2, frame.x(to) - x),
              y: MARGIN.top,
              height: HEIGHT - MARGIN.top - MARGIN.bottom,
            },
            h('title', {}, `${kind}: ${reason ?? direction}`),
          ),
        );
      }
    }
    for (const line of lines) frame.path(line.points, { class: `curve ${line.class}` });
    const cursor = h('line', {
      class: 'cursor',
      y1: MARGIN.top,
      y2: HEIGHT - MARGIN.bottom,
      x1: 0,
      x2: 0,
      visibility: 'hidden',
    });
    const readout = h('text', { class: 'tick value', y: MARGIN.top + 10, visibility: 'hidden' });
    frame.svg.append(cursor, readout);
    const timeAt = (event) => frame.value(event.clientX - frame.svg.getBoundingClientRect().left);
    frame.svg.addEventListener('pointermove', (event) => {
      const t = Math.min(end, Math.max(0, timeAt(event)));
      for (const part of [cursor, readout]) part.setAttribute('visibility', 'visible');
      cursor.setAttribute('x1', frame.x(t));
      cursor.setAttribute('x2', frame.x(t));
      const values = lines.map(({ points }) => {
        const next = points.findIndex(([x]) => x >= t);
        return next < 0 ? '' : digits(points[next][1]);
      });
      readout.textContent = `${t.toFixed(1)} s: ${values.join(', ')}`;
      const isRight = frame.x(t) > width / 2;
      readout.setAttribute('x', frame.x(t) + (isRight ? -6 : 6));
      readout.setAttribute('text-anchor', isRight ? 'end' : 'start');
    });
    frame.svg.addEventListener('pointerleave', () => {
      for (const part of [cursor, readout]) part.setAttribute('visibility', 'hidden');
    });
    frame.svg.addEventListener('click', (event) => onTime(timeAt(event)));
    return frame.svg;
  });
}

// The histogram of residuals, with the normal curve of the same RMS.
export function residualPlot(statistics, rms) {
  const { histogram, bin_m: bin } = statistics;
  const half = histogram.length / 2;
  const range = Math.min(half, Math.max(5, Math.ceil((4 * rms) / bin)));
  const bins = histogram.slice(half - range, half + range);
  const total = histogram.reduce((sum, x) => sum + x, 0);
  const normal = (x) =>
    ((total * bin) / (rms * Math.sqrt(2 * Math.PI))) * Math.exp(-0.5 * (x / rms) ** 2);
  const scale = 100 / (total || 1);
  const outside = total - bins.reduce((sum, x) => sum + x, 0);
  const note = `% of points by mm; curve: normal, RMS ${digits(1000 * rms)} mm; ${digits(outside * scale, 2)} % lie beyond`;
  return plot('Residuals', note, (width) => {
    const highest = Math.max(normal(0), ...bins) * scale;
    const frame = new Frame(width, [-range * bin * 1000, range * bin * 1000], [0, 1.08 * highest]);
    bins.forEach((number, i) => {
      const left = frame.x((i - range) * bin * 1000);
      const right = frame.x((i - range + 1) * bin * 1000);
      frame.svg.append(
        h('rect', {
          class: 'bar',
          x: left,
          width: Math.max(0.5, right - left - 0.5),
          y: frame.y(number * scale),
          height: frame.y(0) - frame.y(number * scale),
        }),
      );
    });
    const curve = [];
    for (let i = 0; i <= 120; ++i) {
      const x = (i / 60 - 1) * range * bin;
      curve.push([1000 * x, normal(x) * scale]);
    }
    frame.path(curve, { class: 'curve second' });
    return frame.svg;
  });
}

// Bars with names and values: [[name, value], ...].
export function barPlot(title, note, rows, format) {
  const ROW = 24;
  const highest = Math.max(1e-12, ...rows.map(([, value]) => value));
  return plot(title, note, (width) => {
    const left = 110;
    const svg = h('svg', {
      width,
      height: ROW * rows.length + 4,
      viewBox: `0 0 ${width} ${ROW * rows.length + 4}`,
      role: 'img',
    });
    rows.forEach(([name, value, colour], i) => {
      const y = ROW * i + 4;
      const bar = h('rect', {
        class: 'bar',
        x: left,
        y,
        height: ROW - 8,
        width: Math.max(1, ((width - left - 80) * value) / highest),
      });
      if (colour) bar.style.fill = colour;
      svg.append(
        h('text', { class: 'tick', x: left - 8, y: y + 12, 'text-anchor': 'end' }, name),
        bar,
        h(
          'text',
          {
            class: 'tick',
            x: left + 6 + Math.max(1, ((width - left - 80) * value) / highest),
            y: y + 12,
          },
          format(value),
        ),
      );
    });
    return svg;
  });
}
