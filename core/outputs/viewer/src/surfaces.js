// The chosen surfaces, what is known of them and between them, and the list of all.
import { h, table } from './dom.js';
import { SELECTED } from './colours.js';
import {
  angleWithStddev,
  count,
  degrees,
  digits,
  lengthWithStddev,
  metres,
  millimetres,
  seconds,
} from './format.js';
import { bow, extents } from './surface.js';

const TYPES = { horizontal: 'level', vertical: 'upright', general: 'sloping', cylinder: 'round' };
const RADIANS = Math.PI / 180;
const DEGREES = 180 / Math.PI;

// Length and height, of a wall in a plane its length alone.
const size = (surface, places) => {
  const [width, height] = extents(surface).map((x) => x.toFixed(places));
  return Number(height) > 0 ? `${width} × ${height} m` : `${width} m`;
};

function facts(rows) {
  return h(
    'dl',
    { class: 'facts' },
    rows.filter(Boolean).flatMap(([name, value]) => [h('dt', {}, name), h('dd', {}, value)]),
  );
}

// What is known of one surface.
function describe(surface, start, errors, scatter) {
  const rows = [
    ['kind', `${TYPES[surface.type]}, ${size(surface, 2)}`],
    ['distance', lengthWithStddev(surface.distance, surface.sigma_distance_m)],
    [
      'direction',
      surface.sigma_angle_deg > 0
        ? `± ${degrees(surface.sigma_angle_deg * RADIANS, 4)}`
        : surface.type === 'horizontal'
          ? 'level'
          : 'held: it is the reference',
    ],
    surface.type === 'cylinder' && [
      'radius',
      radiusInWords(surface, scatter, lengthWithStddev(surface.radius, surface.sigma_radius_m)),
    ],
    ['normal', surface.normal.map((x) => x.toFixed(4)).join(', ')],
    ['points', `${count(surface.num_points)} in ${count(surface.num_segments)} segments`],
    [
      'seen',
      `from ${seconds(surface.first_time - start)} to ${seconds(surface.last_time - start)}`,
    ],
  ];
  if (errors) {
    rows.push([
      'against the truth',
      errors.status === 'wrong'
        ? 'matches no true face'
        : `${millimetres(Math.abs(errors.distance_m))} and ${digits(errors.angle_deg)}° off${errors.status === 'doubled' ? ', doubled' : ''}`,
    ]);
  }
  return facts(rows);
}

// A radius is told by how far its arc bows out: of one that bows out less than points scatter,
// only that is said.
function radiusInWords(surface, scatter, text) {
  const bowed = bow(surface);
  return bowed < scatter
    ? `not known: bows out by ${millimetres(bowed)} over ${metres(extents(surface)[0], 1)}`
    : text;
}

// How two directions lie to each other, in words.
function relation(radians) {
  const angle = radians * DEGREES;
  if (angle > 175) return `${(180 - angle).toFixed(3)}° from back to back`;
  if (angle < 5) return `${angle.toFixed(3)}° from parallel`;
  if (Math.abs(angle - 90) < 5) return `${Math.abs(90 - angle).toFixed(3)}° from a right angle`;
  return '';
}

export class Surfaces {
  // onChoose(ids): other surfaces are chosen. onMeasure(measured): what `between`
  // has found, or null.
  constructor(report, covariance, onChoose, onMeasure) {
    this.report = report;
    this.surfaces = report.planes;
    this.covariance = covariance;
    this.onChoose = onChoose;
    this.onMeasure = onMeasure;
    this.errors = new Map(
      (report.evaluation?.planes?.list ?? []).map((entry) => [entry.id, entry]),
    );
    this.chosen = []; // ids, at most two
    this.place = null; // where the first one was clicked
    this.isMeasuring = false;
    this.button = h(
      'button',
      {
        id: 'measure',
        'aria-pressed': 'false',
        onclick: () => this.measureNext(!this.isMeasuring),
      },
      'Measure to a second surface',
    );
    this.details = h('div', { class: 'details', 'aria-live': 'polite' });
    this.element = h(
      'section',
      { class: 'chosen', 'aria-label': 'chosen surfaces' },
      this.details,
      this.button,
    );
    this.list = this.drawList();
    this.show();
  }

  find(id) {
    return this.surfaces.find((surface) => surface.id === id);
  }

  measureNext(on) {
    this.isMeasuring = on && this.chosen.length > 0;
    this.button.setAttribute('aria-pressed', String(this.isMeasuring));
  }

  // A surface was clicked at a point, or picked from the list (no point), or nothing was (null).
  pick(index, point, extend) {
    if (index === null) {
      if (!this.isMeasuring) this.set([]);
      return;
    }
    const { id } = this.surfaces[index];
    if ((extend || this.isMeasuring) && this.chosen.length > 0 && id !== this.chosen[0]) {
      this.set([this.chosen[0], id], this.place);
    } else {
      this.set([id], point);
    }
  }

  set(ids, place = null) {
    this.chosen = ids;
    this.place = place;
    this.measureNext(false);
    this.show();
    this.onChoose(ids);
    this.onMeasure(this.measured);
  }

  // What lies between two surfaces: angle (rad) and distance (m) with their standard deviations,
  // the latter at `place`, or else at the first one's centre.
  between(a, b, place) {
    if (!this.covariance.has(a) || !this.covariance.has(b)) return null;
    const angle = this.covariance.angle(a, b);
    const distance = this.covariance.separation(place ?? a.centre, a, b);
    return { angle, distance, ends: [distance.from, distance.to] };
  }

  show() {
    this.measured = null;
    const [a, b] = this.chosen.map((id) => this.find(id));
    for (const row of this.list.querySelectorAll('tbody tr')) {
      row.classList.toggle('first', Number(row.dataset.id) === a?.id);
      row.classList.toggle('second', Number(row.dataset.id) === b?.id);
    }
    this.button.disabled = !a;
    if (!a) {
      this.details.replaceChildren(
        h(
          'p',
          { class: 'hint' },
          'Click a surface for its number and precision; click a second one with Shift, or after the button below, to measure between both.',
        ),
      );
      return;
    }
    const parts = [a, b].filter(Boolean).map((surface, i) => {
      const dot = h('i', { class: 'dot' });
      dot.style.background = SELECTED[i];
      return h(
        'div',
        { class: 'surface', 'data-id': surface.id },
        h('h3', {}, dot, `Surface ${surface.id}`),
        describe(
          surface,
          this.report.start_s,
          this.errors.get(surface.id),
          this.report.summary.residual_rms_m,
        ),
      );
    });
    if (b) parts.unshift(this.drawMeasured(a, b));
    this.details.replaceChildren(...parts);
  }

  // What is written into the picture.
  labels() {
    const labels = this.chosen.map((id, i) => ({
      point: this.find(id).centre,
      text: String(id),
      colour: SELECTED[i],
    }));
    if (!this.measured) return labels;
    const {
      distance,
      ends: [from, to],
    } = this.measured;
    const middle = from.map((x, axis) => (x + to[axis]) / 2);
    labels.push({
      point: middle,
      isAbove: true,
      text: lengthWithStddev(distance.value, distance.stddev),
      colour: '#20242c',
    });
    return labels;
  }

  drawMeasured(a, b) {
    this.measured = this.between(a, b, this.place);
    if (!this.measured) {
      return h(
        'p',
        { class: 'hint' },
        'The report holds the joint covariance of the largest surfaces only, and one of these is not among them; plane_covariance.csv has all.',
      );
    }
    const { angle, distance } = this.measured;
    return h(
      'div',
      { class: 'measured' },
      h('h3', {}, `Between ${a.id} and ${b.id}`),
      facts([
        [
          'distance',
          h('b', { id: 'measured-distance' }, lengthWithStddev(distance.value, distance.stddev)),
        ],
        ['angle', h('b', { id: 'measured-angle' }, angleWithStddev(angle.value, angle.stddev))],
      ]),
      h(
        'p',
        { class: 'hint' },
        `${relation(angle.value)}${relation(angle.value) ? '; ' : ''}distance of surface ${b.id} from the ${this.place ? 'clicked place' : 'centre'} of ${a.id}; standard deviations from the joint covariance`,
      ),
    );
  }

  // --- the list of all surfaces ---

  drawList() {
    const columns = [
      ['number', (s) => s.id, (s) => s.id],
      ['kind', (s) => s.type, (s) => TYPES[s.type]],
      ['size', (s) => extents(s)[0] * extents(s)[1], (s) => size(s, 1)],
      ['points', (s) => s.num_points, (s) => count(s.num_points)],
      ['± along the normal', (s) => s.sigma_distance_m, (s) => millimetres(s.sigma_distance_m)],
      [
        '± direction',
        (s) => s.sigma_angle_deg,
        (s) => (s.sigma_angle_deg > 0 ? degrees(s.sigma_angle_deg * RADIANS, 4) : '–'),
      ],
    ];
    if (this.surfaces.some((s) => s.type === 'cylinder')) {
      columns.push([
        'radius',
        (s) => s.radius ?? -1,
        (s) =>
          s.radius
            ? radiusInWords(
                s,
                this.report.summary.residual_rms_m,
                `${metres(s.radius, 3)} ± ${millimetres(s.sigma_radius_m)}`,
              )
            : '–',
      ]);
    }
    if (this.errors.size > 0) {
      columns.push([
        'error',
        (s) => Math.abs(this.errors.get(s.id)?.distance_m ?? Infinity),
        (s) => {
          const entry = this.errors.get(s.id);
          return entry?.distance_m === undefined
            ? (entry?.status ?? '–')
            : millimetres(Math.abs(entry.distance_m));
        },
      ]);
    }
    const row = (surface, index) =>
      h(
        'tr',
        { 'data-id': surface.id },
        columns.map(([, , text], k) =>
          h(
            'td',
            {},
            k === 0
              ? h(
                  'button',
                  {
                    class: 'link',
                    'aria-label': `choose surface ${surface.id}`,
                    onclick: (event) => this.pick(index, null, event.shiftKey),
                  },
                  text(surface),
                )
              : text(surface),
          ),
        ),
      );
    const rows = this.surfaces.map(row);
    const list = table([], rows, { class: 'list' });
    let sorted = null;
    columns.forEach(([name, key], k) => {
      const button = h(
        'button',
        {
          class: 'link',
          onclick: () => {
            const order = this.surfaces.map((surface, i) => [key(surface), rows[i]]);
            const sign = sorted === k ? -1 : 1;
            sorted = sorted === k ? null : k;
            order.sort(([x], [y]) => sign * (x < y ? -1 : x > y ? 1 : 0));
            list.querySelector('tbody').replaceChildren(...order.map(([, element]) => element));
          },
        },
        name,
      );
      list.querySelector('thead tr').append(h('th', { scope: 'col' }, button));
    });
    return list;
  }
}
