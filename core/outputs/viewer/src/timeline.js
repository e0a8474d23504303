// The slider of time: moves the rig, shows points up to then, and plays.
import { h } from './dom.js';
import { digits, metres, millimetres, degrees } from './format.js';
import { poseAt, poseIndex } from './motion.js';

const MODES = { all: 'all points', until: 'points until then', around: 'points of that second' };

export class Timeline {
  // onChange(t, mode)
  constructor(poses, speeds, report, onChange) {
    this.poses = poses;
    this.speeds = speeds;
    this.onChange = onChange;
    this.start = poses[0].t;
    this.end = poses[poses.length - 1].t;
    this.mode = 'all';
    this.t = this.start;
    this.slider = h('input', {
      type: 'range',
      id: 'time',
      min: this.start,
      max: this.end,
      step: 0.01,
      value: this.start,
      'aria-label': 'time in seconds since the recording began',
      oninput: () => this.set(Number(this.slider.value)),
    });
    this.button = h(
      'button',
      { id: 'play', 'aria-label': 'play', onclick: () => this.toggle() },
      '▶',
    );
    this.rate = h(
      'select',
      { id: 'rate', 'aria-label': 'speed of playing' },
      [1, 2, 5, 10, 30].map((rate) =>
        h('option', { value: rate, selected: rate === 5 }, `${rate} ×`),
      ),
    );
    this.modes = h(
      'select',
      {
        id: 'time-mode',
        'aria-label': 'points shown',
        onchange: () => {
          this.mode = this.modes.value;
          this.tell();
        },
      },
      Object.entries(MODES).map(([value, text]) => h('option', { value }, text)),
    );
    this.readout = h('output', { class: 'readout', for: 'time' });
    this.element = h(
      'div',
      { class: 'timeline' },
      this.button,
      h('div', { class: 'track' }, this.slider, this.drawMarks(report)),
      this.rate,
      this.modes,
      this.readout,
    );
    this.tell();
  }

  drawMarks(report) {
    const share = (t) =>
      `${(100 * (Math.min(this.end, Math.max(this.start, t)) - this.start)) / (this.end - this.start || 1)}%`;
    const marks = h('div', { class: 'marks', 'aria-hidden': 'true' });
    for (const kind of ['degenerate', 'doubtful', 'gap']) {
      for (const interval of report.intervals[kind]) {
        const mark = h('span', { class: kind, title: interval.reason ?? interval.direction });
        mark.style.left = share(interval.start_s);
        mark.style.right = `calc(100% - ${share(interval.end_s)})`;
        marks.append(mark);
      }
    }
    return marks;
  }

  set(t) {
    this.t = Math.min(this.end, Math.max(this.start, t));
    this.slider.value = this.t;
    this.tell();
  }

  tell() {
    const pose = poseAt(this.poses, this.t);
    const speed = this.speeds.length ? this.speeds[poseIndex(this.speeds, this.t)].speed : NaN;
    this.readout.textContent =
      `${this.t.toFixed(2)} s · ${digits(speed, 2)} m/s · height ${metres(pose.position[2])} · ` +
      (this.t === this.start
        ? 'position held: the origin of the map'
        : `position ± ${millimetres(pose.positionStddev)} · direction ± ${degrees(pose.rotationStddev)}`);
    this.onChange(this.t, this.mode, pose);
  }

  toggle() {
    if (this.playing) this.stop();
    else this.play();
  }

  play() {
    if (this.t >= this.end) this.set(this.start);
    this.playing = true;
    this.button.textContent = '❚❚';
    this.button.setAttribute('aria-label', 'pause');
    let before = performance.now();
    const step = (now) => {
      if (!this.playing) return;
      this.set(this.t + ((now - before) / 1000) * Number(this.rate.value));
      before = now;
      if (this.t >= this.end) this.stop();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  stop() {
    this.playing = false;
    this.button.textContent = '▶';
    this.button.setAttribute('aria-label', 'play');
  }
}
