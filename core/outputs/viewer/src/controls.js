// What the reader can set in the 3D view, with buttons and keys.
import { h } from './dom.js';
import { css, rampGradient, scannerColour } from './colours.js';
import { scannerNames } from './data.js';
import { digits } from './format.js';
import { COLOURINGS, RAMP_OF } from './point_cloud.js';
import { extents } from './surface.js';

const FLAT = 0.05; // m: a map that is not higher has no heights to choose from
const STOREY = 1.8; // m: floors are at least so far apart
const BELOW_FLOOR = 0.3; // m: a storey begins so far below its floor, where a ceiling is not yet
const VIEWS = { overview: 'Overview', top: 'From above', front: 'Front', side: 'Side' };
const LABELS = {
  surface: 'Surface',
  height: 'Height',
  time: 'Time',
  scanner: 'Scanner',
  residual: 'Residual',
};

// The heights of the storeys' floors, lowest first: level surfaces, seen from above, that take a
// fair share of all such area, as many of them as lie a storey apart.
export function storeyHeights(surfaces) {
  const floors = surfaces.filter(
    (surface) => surface.type === 'horizontal' && surface.normal[2] > 0,
  );
  const area = (surface) => extents(surface).reduce((a, b) => a * b);
  const total = floors.reduce((sum, surface) => sum + area(surface), 0);
  const heights = [];
  for (const surface of floors
    .filter((floor) => area(floor) > 0.1 * total)
    .sort((a, b) => area(b) - area(a))) {
    if (heights.every((height) => Math.abs(height - surface.centre[2]) > STOREY))
      heights.push(surface.centre[2]);
  }
  return heights.sort((a, b) => a - b);
}

export class Controls {
  constructor(view, plan, report) {
    this.view = view;
    this.plan = plan;
    this.scannerNames = scannerNames(report);
    this.hasMoving = report.summary.points_moving > 0;
    const { lowest, highest } = view.cloud;
    this.range = [Math.floor(10 * lowest[2]) / 10, Math.ceil(10 * highest[2]) / 10];
    this.heights = [...this.range];
    this.colours = h(
      'div',
      { class: 'buttons', role: 'group', 'aria-label': 'colour' },
      COLOURINGS.map((name) =>
        h('button', { 'data-colour': name, onclick: () => this.colourBy(name) }, LABELS[name]),
      ),
    );
    this.legend = h('div', { class: 'legend' });
    this.low = this.heightSlider('height-low', 'lowest height shown', 0);
    this.high = this.heightSlider('height-high', 'greatest height shown', 1);
    this.heightText = h('output', { id: 'heights' });
    const check = (id, text, isOn, change) =>
      h(
        'label',
        { class: 'check' },
        h('input', {
          type: 'checkbox',
          id,
          checked: isOn,
          onchange: (event) => {
            change(event.target.checked);
            view.changed();
          },
        }),
        text,
      );
    const size = h('input', {
      type: 'range',
      id: 'size',
      min: 0.005,
      max: 0.08,
      step: 0.005,
      value: 0.02,
      'aria-label': 'size of points',
      oninput: () => view.pointSize(Number(size.value)),
    });
    this.element = h(
      'section',
      { class: 'controls', 'aria-label': 'view' },
      h('h3', {}, 'Colour by'),
      this.colours,
      this.legend,
      ...(this.range[1] - this.range[0] > FLAT
        ? [
            h('h3', {}, 'Heights ', this.heightText),
            this.low,
            this.high,
            this.drawStoreys(report.planes),
          ].filter(Boolean)
        : []),
      h('h3', {}, 'Look from'),
      h(
        'div',
        { class: 'buttons' },
        Object.entries(VIEWS).map(([name, text]) =>
          h('button', { 'data-view': name, onclick: () => view.eye.lookFrom(name) }, text),
        ),
      ),
      h('h3', {}, 'Show'),
      check('backs', 'surfaces from behind', false, (on) => view.hideBacks(!on)),
      check('points-shown', 'points', true, (on) => {
        view.cloud.object.visible = on;
      }),
      check('loose', 'points on no surface', true, (on) => {
        view.cloud.uniforms.hide_loose.value = on ? 0 : 1;
      }),
      check('outlines', 'outlines', true, (on) => {
        view.drawings.outlines.visible = on;
      }),
      check('path', 'trajectory', true, (on) => {
        view.drawings.path.visible = on;
        view.drawings.rig.visible = on;
      }),
      h('label', { class: 'check' }, 'size of points ', size),
    );
    this.colourBy('surface');
    this.clip();
  }

  heightSlider(id, name, which) {
    const slider = h('input', {
      type: 'range',
      id,
      min: this.range[0],
      max: this.range[1],
      step: 0.05,
      value: this.range[which],
      'aria-label': name,
    });
    slider.addEventListener('input', () => {
      this.heights[which] = Number(slider.value);
      // They never pass each other.
      if (this.heights[0] > this.heights[1]) this.heights[1 - which] = this.heights[which];
      this.clip();
    });
    return slider;
  }

  // Buttons that show one storey each, without its ceiling, where the map has several.
  drawStoreys(surfaces) {
    const floors = storeyHeights(surfaces);
    if (floors.length < 2) return null;
    const buttons = floors.map((floor, i) => {
      const top = (floors[i + 1] ?? this.range[1] + BELOW_FLOOR) - BELOW_FLOOR;
      return h(
        'button',
        { 'data-storey': i + 1, onclick: () => this.setHeights(floor - BELOW_FLOOR, top) },
        `Storey ${i + 1}`,
      );
    });
    return h(
      'div',
      { class: 'buttons storeys' },
      buttons,
      h('button', { onclick: () => this.setHeights(...this.range) }, 'All'),
    );
  }

  setHeights(low, high) {
    const within = (value) => Math.min(this.range[1], Math.max(this.range[0], value));
    this.heights = [within(low), within(high)];
    this.clip();
  }

  clip() {
    const [low, high] = this.heights;
    this.low.value = low;
    this.high.value = high;
    this.heightText.textContent = `${low.toFixed(2)} to ${high.toFixed(2)} m`;
    // Noise goes beyond the sliders' ends.
    const bottom = low <= this.range[0] ? -1e9 : low;
    const top = high >= this.range[1] ? 1e9 : high;
    this.view.clip(bottom, top);
    this.plan.clip(bottom, top);
    this.drawLegend();
  }

  colourBy(name) {
    this.colouring = name;
    this.view.colourBy(name);
    for (const button of this.colours.children)
      button.setAttribute('aria-pressed', String(button.dataset.colour === name));
    this.drawLegend();
  }

  drawLegend() {
    const name = this.colouring;
    if (RAMP_OF[name]) {
      const ends = this.view.cloud.rampEnds(name, this.view.shared.heights.value.toArray());
      const [scale, unit] = { height: [1, 'm'], time: [1, 's'], residual: [1000, 'mm'] }[name];
      const bar = h('div', { class: 'ramp' });
      bar.style.background = rampGradient(RAMP_OF[name]);
      this.legend.replaceChildren(
        bar,
        h('span', {}, `${digits(scale * ends[0])} ${unit}`),
        h('span', {}, `${digits(scale * ends[1])} ${unit}`),
      );
    } else if (name === 'scanner') {
      this.legend.replaceChildren(
        ...this.scannerNames.map((scanner, i) => {
          const dot = h('i', { class: 'dot' });
          dot.style.background = css(scannerColour(i));
          return h('span', {}, dot, scanner);
        }),
      );
    } else {
      this.legend.replaceChildren(
        h(
          'span',
          {},
          `each surface its colour; grey: on none${this.hasMoving ? '; pink: what moved' : ''}`,
        ),
      );
    }
  }
}

const TURN = 6; // degrees a key
const SHIFT = 0.06; // of the distance a key
const ZOOM = 0.88;
const HEIGHT = 0.1; // m a key

export const KEYS = [
  ['arrows', 'turn'],
  ['Shift + arrows', 'shift'],
  ['+ and −', 'nearer, farther'],
  ['1 to 5', 'colour by surface, height, time, scanner, residual'],
  ['O, T, F, S', 'look from the corner, above, the front, the side'],
  ['Page up, Page down', 'raise, lower the greatest height shown'],
  ['B', 'surfaces from behind'],
  ['space', 'play and pause'],
  [', and .', 'a tenth of a second back, on'],
  ['N, P', 'next, previous surface; with Shift as the second one'],
  ['M', 'measure to a second surface'],
  ['Esc', 'choose nothing'],
];

// Keys work wherever the focus is, but in fields that use them.
export function listenToKeys({ view, controls, timeline, surfaces }) {
  const step = (by, extend) => {
    const count = surfaces.surfaces.length;
    if (count === 0) return;
    const last = surfaces.chosen[extend ? 1 : 0] ?? surfaces.chosen[0];
    const at = surfaces.surfaces.findIndex((surface) => surface.id === last);
    surfaces.pick((at + by + count) % count, null, extend);
  };
  const look = { o: 'overview', t: 'top', f: 'front', s: 'side' };
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  const simple = {
    '+': () => view.eye.zoom(ZOOM),
    '=': () => view.eye.zoom(ZOOM),
    '-': () => view.eye.zoom(1 / ZOOM),
    PageUp: () => controls.setHeights(controls.heights[0], controls.heights[1] + HEIGHT),
    PageDown: () => controls.setHeights(controls.heights[0], controls.heights[1] - HEIGHT),
    ' ': () => timeline.toggle(),
    ',': () => timeline.set(timeline.t - 0.1),
    '.': () => timeline.set(timeline.t + 0.1),
    m: () => surfaces.measureNext(!surfaces.isMeasuring),
    Escape: () => surfaces.set([]),
    b: () => document.getElementById('backs').click(),
  };
  document.addEventListener('keydown', (event) => {
    const { target } = event;
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (target.matches('input[type=range], select, textarea') && !/^[a-z1-5]$/i.test(event.key))
      return;
    if (event.key === ' ' && target.matches('button, summary, input')) return;
    // On the page, arrows and page keys scroll; in the view they turn it.
    const inView = target === view.canvas;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (arrows[key] && inView) {
      const [x, y] = arrows[key];
      if (event.shiftKey) view.eye.shift(SHIFT * x, SHIFT * y);
      else view.eye.turn(TURN * x, TURN * y);
    } else if (/^[1-5]$/.test(key)) controls.colourBy(COLOURINGS[Number(key) - 1]);
    else if (look[key] && !event.shiftKey) view.eye.lookFrom(look[key]);
    else if (key === 'n' || key === 'p') step(key === 'n' ? 1 : -1, event.shiftKey);
    else if (simple[key] && (inView || !key.startsWith('Page')) && (inView || key !== ' '))
      simple[key]();
    else return;
    event.preventDefault();
  });
}
