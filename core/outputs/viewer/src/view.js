// The 3D view: draws on demand, as much as a frame's time allows.
import * as THREE from 'three';
import { Composition } from './composition.js';
import { NUM_LEVELS } from './data.js';
import { Drawings } from './drawings.js';
import { Eye } from './eye.js';
import { colourSurfaces, markHidden, PointCloud, surfaceTexture } from './point_cloud.js';
import { addScaled, dot, normalAt, rayDistance, subtract } from './surface.js';

const GROUND = [0.965, 0.968, 0.972];
const FRAME_MS = 33; // a frame takes at most so long while the view moves
const REST_MS = 120; // after so long without movement all points are drawn
const PREVIEW_SIZE = 2; // of points, while only few are drawn
const AT_REST = 100_000; // points, at least, in a frame then
const CLICK_RADIUS = 4; // pixels
const MAX_PIXELS = 2.5e6; // of the picture, on dense screens

// The box that the surfaces and the rig's way take, and the last time.
function boundsOf(surfaces, poses) {
  const corners = [
    ...surfaces.flatMap((surface) => surface.outline),
    ...poses.map((pose) => pose.position),
  ];
  const lowest = [0, 1, 2].map((axis) =>
    corners.reduce((low, corner) => Math.min(low, corner[axis]), Infinity),
  );
  const highest = [0, 1, 2].map((axis) =>
    corners.reduce((high, corner) => Math.max(high, corner[axis]), -Infinity),
  );
  return { lowest, highest, lastTime: poses[poses.length - 1].t };
}

export class NoWebgl extends Error {}

export class View {
  // Throws NoWebgl where the browser can not draw in 3D.
  // onPick(index, point, extend): a surface was clicked, or none (index null).
  constructor(canvas, report, points, poses, onPick) {
    this.canvas = canvas;
    this.surfaces = report.planes;
    this.onPick = onPick;
    const context = canvas.getContext('webgl2', {
      antialias: false,
      powerPreference: 'high-performance',
      preserveDrawingBuffer: true, // a page that is printed takes what was drawn last
    });
    if (!context) throw new NoWebgl();
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    this.renderer.autoClear = false;
    this.ground = new THREE.Color().setRGB(...GROUND, THREE.SRGBColorSpace);
    this.shared = {
      eye: { value: new THREE.Vector3() },
      heights: { value: new THREE.Vector2(-1e9, 1e9) },
      hide_backs: { value: 1 },
      surfaces: { value: surfaceTexture(this.surfaces) },
      half_screen: { value: new THREE.Vector2(1, 1) },
    };
    this.ratio = { value: 1 }; // pixels of the picture by those of the page
    const rms = report.summary.residual_rms_m || 0.01;
    this.cloud = new PointCloud(points, this.shared, boundsOf(this.surfaces, poses), 3 * rms);
    this.drawings = new Drawings(this.surfaces, poses, report.intervals, this.shared, this.ratio);
    this.composition = new Composition(GROUND);
    const { lowest, highest } = this.cloud;
    this.eye = new Eye(canvas, lowest, highest, () => this.moved());
    this.choose([]);
    this.numDrawn = 0; // points that the picture holds
    this.numMoving = Math.min(points.count, 200_000); // drawn in a frame while the view moves
    this.isSlow = this.drawsInSoftware();
    this.frames = 0;
    this.listen();
    this.resize();
    this.eye.lookFrom(report.summary.motion === 'planar' ? 'top' : 'overview');
  }

  listen() {
    let down = null;
    this.canvas.addEventListener('pointerdown', (event) => {
      down = [event.clientX, event.clientY];
    });
    this.canvas.addEventListener('pointerup', (event) => {
      if (!down || event.button !== 0) return;
      const still = Math.hypot(event.clientX - down[0], event.clientY - down[1]) < CLICK_RADIUS;
      down = null;
      if (!still) return;
      const box = this.canvas.getBoundingClientRect();
      this.pickAt(event.clientX - box.left, event.clientY - box.top, event.shiftKey);
    });
    this.canvas.addEventListener('dblclick', (event) => {
      const box = this.canvas.getBoundingClientRect();
      const found = this.find(event.clientX - box.left, event.clientY - box.top);
      if (found) this.eye.lookAt(found.point);
    });
    this.canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    this.canvas.addEventListener('webglcontextrestored', () => this.changed());
    new ResizeObserver(() => this.resize()).observe(this.canvas);
  }

  resize() {
    const width = Math.max(1, this.canvas.clientWidth);
    const height = Math.max(1, this.canvas.clientHeight);
    const ratio = Math.min(window.devicePixelRatio, Math.sqrt(MAX_PIXELS / (width * height)));
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    const [columns, rows] = [this.canvas.width, this.canvas.height];
    this.composition.resize(columns, rows, ratio);
    this.eye.resize(width, height);
    this.shared.half_screen.value.set(columns / 2, rows / 2);
    this.ratio.value = ratio;
    this.drawings.scaleLines();
    this.cloud.uniforms.pixels.value = Eye.pixelsPerMetre(rows);
    this.cloud.uniforms.smallest.value = 1.5 * ratio;
    this.changed();
  }

  // The picture has to be drawn anew, and shall not wait for all points.
  moved() {
    this.isMoving = true;
    this.changed();
  }

  changed() {
    this.numDrawn = 0;
    this.isStale = true;
    this.schedule();
  }

  drawsInSoftware() {
    const context = this.renderer.getContext();
    const named = context.getExtension('WEBGL_debug_renderer_info');
    return (
      !!named &&
      /swiftshader|llvmpipe|software/i.test(context.getParameter(named.UNMASKED_RENDERER_WEBGL))
    );
  }

  schedule() {
    if (this.isScheduled) return;
    this.isScheduled = true;
    requestAnimationFrame((now) => this.draw(now));
  }

  // Draws as many more points as a frame's time allows; what they are is kept until the view
  // changes. Where that is slow, a moving view is drawn without shading, which takes as long as
  // many points.
  draw(now) {
    this.isScheduled = false;
    const { count } = this.cloud.points;
    if (this.isStale && this.isMoving) this.adapt(now);
    const isPreview = this.isStale && this.isMoving && this.isSlow;
    if (this.isStale) this.prepare();
    this.isStale = false;
    ++this.frames;
    this.lastFrame = now;
    this.renderer.setRenderTarget(null);
    if (isPreview) {
      this.drawPreview();
      this.onDrawn?.();
      clearTimeout(this.refining);
      this.refining = setTimeout(() => this.schedule(), REST_MS);
      return;
    }
    if (this.numDrawn === 0 || this.numDrawn < count)
      this.drawPoints(Math.min(Math.max(this.numMoving, AT_REST), count - this.numDrawn));
    this.renderer.setRenderTarget(null);
    this.composition.draw(this.renderer, this.eye.camera);
    this.renderer.render(this.drawings.scene, this.eye.camera);
    if (this.numDrawn < count) this.schedule();
    else this.isMoving = false;
    this.onDrawn?.();
  }

  // Draws fewer points in a frame where the last ones took too long, more where they did not.
  adapt(now) {
    const took = now - (this.lastFrame ?? now);
    if (took <= 0 || took > 500) return;
    this.smoothed = 0.7 * (this.smoothed ?? took) + 0.3 * took;
    if (this.smoothed > 1.2 * FRAME_MS) this.isSlow = true;
    const scale =
      this.smoothed > FRAME_MS
        ? Math.max(0.7, FRAME_MS / this.smoothed)
        : this.smoothed < 0.75 * FRAME_MS
          ? 1.08
          : 1;
    this.numMoving = Math.round(
      Math.min(
        this.cloud.points.count,
        Math.max(this.cloud.points.count / NUM_LEVELS, 20_000, this.numMoving * scale),
      ),
    );
  }

  // What depends on where the eye is.
  prepare() {
    this.eye.fitDepths();
    this.shared.eye.value.copy(this.eye.camera.position);
    markHidden(this.shared.surfaces.value, this.surfaces, this.eye.position);
  }

  drawPreview() {
    const { cloud, renderer } = this;
    const { camera } = this.eye;
    renderer.setClearColor(this.ground);
    renderer.clear();
    // Whole levels, each of which shows the whole map; larger, since they are few.
    const level = cloud.points.count / NUM_LEVELS;
    cloud.geometry.setDrawRange(0, Math.ceil(Math.ceil(this.numMoving / level) * level));
    cloud.uniforms.smallest.value *= PREVIEW_SIZE;
    renderer.render(cloud.scene, camera);
    cloud.uniforms.smallest.value /= PREVIEW_SIZE;
    renderer.render(this.drawings.scene, camera);
  }

  drawPoints(number) {
    const { cloud, renderer } = this;
    const { camera } = this.eye;
    renderer.setRenderTarget(this.composition.target);
    if (this.numDrawn === 0) renderer.clear();
    cloud.geometry.setDrawRange(this.numDrawn, number);
    renderer.render(cloud.scene, camera);
    this.numDrawn += number;
  }

  // --- what is shown ---

  choose(ids) {
    colourSurfaces(this.shared.surfaces.value, this.surfaces, ids);
    this.drawings.choose(ids.map((id) => this.surfaces.findIndex((surface) => surface.id === id)));
    this.changed();
  }

  clip(low, high) {
    this.shared.heights.value.set(low, high);
    if (this.coloredBy) this.cloud.colourBy(this.coloredBy, [low, high]);
    this.changed();
  }

  colourBy(name) {
    this.coloredBy = name;
    this.cloud.colourBy(name, this.shared.heights.value.toArray());
    this.changed();
  }

  hideBacks(hide) {
    this.shared.hide_backs.value = hide ? 1 : 0;
    this.changed();
  }

  // Shows the points of a time, as the slider's mode says.
  showTimes(t, mode) {
    const ends = { all: [-1, 1e9], until: [-1, t], around: [t - 0.5, t + 0.5] }[mode];
    const isSame = ends.every((end, i) => end === this.timeEnds?.[i]);
    this.timeEnds = ends;
    if (isSame) return this.schedule();
    this.cloud.showTimes(...ends);
    this.moved();
  }

  pointSize(metres) {
    this.cloud.uniforms.point_m.value = metres;
    this.changed();
  }

  // --- picking ---

  isShown(surface, point) {
    const { x: low, y: high } = this.shared.heights.value;
    if (point[2] < low || point[2] > high) return false;
    if (this.shared.hide_backs.value === 0) return true;
    return dot(normalAt(surface, point), subtract(this.eye.position, point)) >= 0;
  }

  // What is drawn at a place of the canvas: { index, point }, or null.
  find(x, y) {
    const isVisible = (index, point) => this.isShown(this.surfaces[index], point);
    const found = this.cloud.pick(this.eye.screenRows(), x, y, CLICK_RADIUS, isVisible);
    return found ?? this.findOutline(x, y);
  }

  // The surface whose outline is nearest there.
  findOutline(x, y) {
    const [origin, direction] = this.eye.ray(x, y);
    let best = null;
    let nearest = Infinity;
    this.surfaces.forEach((surface, index) => {
      const isShown = (point) => this.isShown(surface, point);
      const along = rayDistance(surface, origin, direction, isShown);
      if (along >= nearest) return;
      nearest = along;
      best = { index, point: addScaled(origin, along, direction) };
    });
    return best;
  }

  pickAt(x, y, extend) {
    const found = this.find(x, y);
    this.onPick(found ? found.index : null, found?.point, extend);
  }
}
