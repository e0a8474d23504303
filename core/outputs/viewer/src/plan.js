// The plan: walls, slopes' outlines and the path from above, of what lies between two heights.
import { h } from './dom.js';
import { css, surfaceColour, SELECTED } from './colours.js';
import { ticks } from './plots.js';
import { heightRange, isCylinder } from './surface.js';

const FLAT = 0.7; // a normal more upright than this is that of a floor, not of a wall

// The lines of a wall from above, as points.
function traceOf(surface) {
  const { outline } = surface;
  if (isCylinder(surface)) return outline.slice(0, outline.length / 2);
  if (surface.type === 'vertical') {
    const along = [-surface.normal[1], surface.normal[0]];
    const place = (corner) => corner[0] * along[0] + corner[1] * along[1];
    const sorted = [...outline].sort((a, b) => place(a) - place(b));
    return [sorted[0], sorted[sorted.length - 1]];
  }
  return [...outline, outline[0]];
}

export class Plan {
  // onPick(index, extend): a wall was chosen.
  constructor(surfaces, poses, intervals, onPick) {
    this.surfaces = surfaces;
    this.poses = poses;
    this.onPick = onPick;
    this.walls = surfaces
      .map((surface, index) => ({ surface, index }))
      .filter(({ surface }) => surface.outline.length > 2 && Math.abs(surface.normal[2]) < FLAT);
    this.selected = [];
    this.svg = h('svg', { class: 'plan', role: 'img', 'aria-label': 'floor plan' });
    this.element = h('div', { class: 'plan-frame' }, this.svg);
    this.draw();
  }

  box() {
    const corners = [
      ...this.walls.flatMap(({ surface }) => surface.outline),
      ...this.poses.map((pose) => pose.position),
    ];
    const range = (axis) =>
      corners.reduce(
        ([low, high], corner) => [Math.min(low, corner[axis]), Math.max(high, corner[axis])],
        [Infinity, -Infinity],
      );
    return [...range(0), ...range(1)];
  }

  draw() {
    const [left, right, low, high] = this.box();
    const size = Math.max(right - left, high - low, 1);
    const margin = 0.04 * size;
    const width = right - left + 2 * margin;
    const height = high - low + 3 * margin;
    this.unit = size / 1000;
    const x = (point) => (point[0] - left + margin).toFixed(3);
    const y = (point) => (high - point[1] + margin).toFixed(3);
    const line = (points) => points.map((point) => `${x(point)},${y(point)}`).join(' ');
    this.svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    const stride = Math.max(1, Math.floor(this.poses.length / 4000));
    const path = h('polyline', {
      class: 'path',
      points: line(this.poses.filter((_, i) => i % stride === 0).map((pose) => pose.position)),
      'stroke-width': 1.5 * this.unit,
    });
    this.lines = this.walls.map(({ surface, index }) =>
      h(
        'polyline',
        {
          class: 'wall',
          points: line(traceOf(surface)),
          'data-id': surface.id,
          onclick: (event) => this.onPick(index, event.shiftKey),
        },
        h('title', {}, `surface ${surface.id}`),
      ),
    );
    this.rig = h('circle', { class: 'rig', r: 5 * this.unit, cx: -99, cy: -99 });
    this.place = (point) => [x(point), y(point)];
    this.svg.replaceChildren(path, ...this.lines, this.rig, this.scale(margin, height, size));
    this.show();
  }

  // A bar of a round length, with its length.
  scale(margin, height, size) {
    const steps = ticks(0, size / 4, 1).filter((step) => step > 0);
    const length = steps[steps.length - 1] ?? 1;
    const y = height - 0.6 * margin;
    return h(
      'g',
      { class: 'scale' },
      h('line', { x1: margin, x2: margin + length, y1: y, y2: y, 'stroke-width': 2.5 * this.unit }),
      h(
        'text',
        { x: margin + length + 8 * this.unit, y: y + 5 * this.unit, 'font-size': 16 * this.unit },
        `${length} m`,
      ),
    );
  }

  show() {
    const [low, high] = this.heights ?? [-Infinity, Infinity];
    this.walls.forEach(({ surface }, i) => {
      const [bottom, top] = heightRange(surface);
      const which = this.selected.indexOf(surface.id);
      const line = this.lines[i];
      line.style.display = top < low || bottom > high ? 'none' : '';
      line.style.stroke = which < 0 ? css(surfaceColour(surface.id)) : SELECTED[which];
      line.setAttribute('stroke-width', (which < 0 ? 3 : 7) * this.unit);
    });
  }

  clip(low, high) {
    this.heights = [low, high];
    this.show();
  }

  choose(ids) {
    this.selected = ids;
    this.show();
  }

  moveRig(position) {
    const [x, y] = this.place(position);
    this.rig.setAttribute('cx', x);
    this.rig.setAttribute('cy', y);
  }
}
