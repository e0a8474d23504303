// The 3D view: camera, controls, and drawing on demand.
import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { NUM_LEVELS } from './data.js';
import { Drawings } from './drawings.js';
import { colourSurfaces, markHidden, PointCloud, surfaceTexture } from './point_cloud.js';
import { COMPOSE_FRAGMENT, COMPOSE_VERTEX } from './shaders.js';
import { addScaled, dot, normalAt, rayDistance, subtract } from './surface.js';

const GROUND = [0.965, 0.968, 0.972];
const FIELD_OF_VIEW = 50; // degrees
const FRAME_MS = 33; // a frame takes at most so long while the view moves
const REST_MS = 120; // after so long without movement all points are drawn
const AT_REST = 100_000; // points, at least, in a frame then
const SHADE_RADIUS = 1.4; // pixels of the screen
const CLICK_RADIUS = 4; // pixels
const MAX_PIXELS = 2.5e6; // of the picture, on dense screens

// The box that the surfaces and the rig's way take, and the last time.
function boundsOf(surfaces, poses) {
  const corners = [...surfaces.flatMap((surface) => surface.outline), ...poses.map((pose) => pose.position)];
  const lowest = [0, 1, 2].map((axis) => corners.reduce((low, corner) => Math.min(low, corner[axis]), Infinity));
  const highest = [0, 1, 2].map((axis) => corners.reduce((high, corner) => Math.max(high, corner[axis]), -Infinity));
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
    const context = canvas.getContext('webgl2', { antialias: false, powerPreference: 'high-performance' });
    if (!context) throw new NoWebgl();
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    this.renderer.autoClear = false;
    this.ground = new THREE.Color().setRGB(...GROUND, THREE.LinearSRGBColorSpace);
    this.camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.1, 1000);
    this.camera.up.set(0, 0, 1);
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
    this.makeComposition();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = Math.PI;
    this.controls.addEventListener('change', () => this.moved());
    this.choose([]);
    this.numDrawn = 0; // points that the picture holds
    this.numMoving = Math.min(points.count, 200_000); // drawn in a frame while the view moves
    this.isSlow = this.drawsInSoftware();
    this.frames = 0;
    this.listen();
    this.resize();
    this.lookFrom(report.summary.motion === 'planar' ? 'top' : 'overview');
  }

  makeComposition() {
    this.target = new THREE.WebGLRenderTarget(1, 1, {
      minFilter: THREE.NearestFilter,
      magFilter: THREE.NearestFilter,
      depthTexture: new THREE.DepthTexture(1, 1, THREE.UnsignedIntType),
    });
    const corners = new THREE.BufferGeometry();
    corners.setAttribute('position', new THREE.Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3));
    this.composition = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: COMPOSE_VERTEX,
      fragmentShader: COMPOSE_FRAGMENT,
      uniforms: {
        colours: { value: this.target.texture },
        depths: { value: this.target.depthTexture },
        ground: { value: new THREE.Vector3(...GROUND) },
        near_far: { value: new THREE.Vector2() },
        strength: { value: 6 },
        radius: { value: 1 },
      },
      depthFunc: THREE.AlwaysDepth,
    });
    const sheet = new THREE.Mesh(corners, this.composition);
    sheet.frustumCulled = false;
    this.sheet = new THREE.Scene();
    this.sheet.add(sheet);
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
      if (found) this.lookAt(found.point);
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
    this.target.setSize(columns, rows);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.shared.half_screen.value.set(columns / 2, rows / 2);
    this.ratio.value = ratio;
    this.drawings.scaleLines();
    const { uniforms } = this.cloud;
    uniforms.pixels.value = rows / (2 * Math.tan((FIELD_OF_VIEW * Math.PI) / 360));
    uniforms.smallest.value = 1.5 * ratio;
    this.composition.uniforms.radius.value = Math.max(1, Math.round(SHADE_RADIUS * ratio));
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
    return !!named && /swiftshader|llvmpipe|software/i.test(context.getParameter(named.UNMASKED_RENDERER_WEBGL));
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
    if (this.numDrawn === 0 || this.numDrawn < count) this.drawPoints(Math.min(Math.max(this.numMoving, AT_REST), count - this.numDrawn));
    this.renderer.setRenderTarget(null);
    this.renderer.clear();
    this.renderer.render(this.sheet, this.camera);
    this.renderer.render(this.drawings.scene, this.camera);
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
    const scale = this.smoothed > FRAME_MS ? Math.max(0.7, FRAME_MS / this.smoothed) : this.smoothed < 0.75 * FRAME_MS ? 1.08 : 1;
    this.numMoving = Math.round(Math.min(this.cloud.points.count, Math.max(this.cloud.points.count / NUM_LEVELS, 20_000, this.numMoving * scale)));
  }

  // What depends on where the eye is.
  prepare() {
    this.fitDepths();
    this.shared.eye.value.copy(this.camera.position);
    markHidden(this.shared.surfaces.value, this.surfaces, this.camera.position.toArray());
  }

  drawPreview() {
    const { camera, cloud, renderer } = this;
    renderer.setClearColor(this.ground);
    renderer.clear();
    cloud.geometry.setDrawRange(0, this.numMoving);
    renderer.render(cloud.scene, camera);
    renderer.render(this.drawings.scene, camera);
  }

  drawPoints(number) {
    const { camera, cloud, renderer } = this;
    renderer.setRenderTarget(this.target);
    if (this.numDrawn === 0) renderer.clear();
    cloud.geometry.setDrawRange(this.numDrawn, number);
    renderer.render(cloud.scene, camera);
    this.numDrawn += number;
  }

  // The nearest and the farthest depth that the map needs: depths are precise in between.
  fitDepths() {
    const [low, high] = [new THREE.Vector3(...this.cloud.lowest), new THREE.Vector3(...this.cloud.highest)];
    const radius = low.distanceTo(high) / 2;
    const away = this.camera.position.distanceTo(low.add(high).multiplyScalar(0.5));
    this.camera.far = away + 1.5 * radius + 5;
    this.camera.near = Math.max(0.05, Math.min(1, (away - radius) / 2));
    this.camera.updateProjectionMatrix();
    this.composition.uniforms.near_far.value.set(this.camera.near, this.camera.far);
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

  // --- camera ---

  lookFrom(name) {
    const low = new THREE.Vector3(...this.cloud.lowest);
    const high = new THREE.Vector3(...this.cloud.highest);
    // The directions' second numbers keep azimuths where they are wanted.
    const towards = {
      overview: [-0.45, -0.75, 0.95],
      top: [0, -0.001, 1],
      front: [0, -1, 0.12],
      side: [-1, -0.001, 0.12],
    }[name];
    const direction = new THREE.Vector3(...towards).normalize();
    this.controls.target.copy(low).add(high).multiplyScalar(0.5);
    this.camera.position.copy(this.controls.target).add(direction);
    this.camera.lookAt(this.controls.target);
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(
      (corner) => new THREE.Vector3(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z),
    );
    for (let round = 0; round < 4; ++round) this.fit(corners, direction);
    this.controls.update();
    this.moved();
  }

  // Moves the target to the middle of what the corners take of the picture, and the camera as near
  // as they fit.
  fit(corners, direction) {
    const tan = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    const inverse = this.camera.quaternion.clone().invert();
    const inView = corners.map((corner) => corner.clone().sub(this.controls.target).applyQuaternion(inverse));
    const reach = ({ x, y, z }) => z + Math.max(Math.abs(y), Math.abs(x) / this.camera.aspect) / tan;
    const away = 1.03 * Math.max(1, ...inView.map(reach));
    const middle = (axis) => {
      const places = inView.map((corner) => corner[axis] / (away - corner.z));
      return ((Math.max(...places) + Math.min(...places)) / 2) * away;
    };
    const shift = new THREE.Vector3(middle('x'), middle('y'), 0).applyQuaternion(this.camera.quaternion);
    this.controls.target.add(shift);
    this.camera.position.copy(this.controls.target).addScaledVector(direction, away);
  }

  lookAt(point) {
    const shift = new THREE.Vector3(...point).sub(this.controls.target);
    this.controls.target.add(shift);
    this.camera.position.add(shift.multiplyScalar(0.5));
    this.controls.update();
    this.moved();
  }

  // Turns about the target by angles in degrees.
  turn(azimuth, elevation) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const spherical = new THREE.Spherical().setFromCartesianCoords(offset.x, offset.z, -offset.y);
    spherical.theta += (azimuth * Math.PI) / 180;
    spherical.phi = Math.min(Math.PI - 0.01, Math.max(0.01, spherical.phi - (elevation * Math.PI) / 180));
    const turned = new THREE.Vector3().setFromSpherical(spherical);
    this.camera.position.copy(this.controls.target).add(new THREE.Vector3(turned.x, -turned.z, turned.y));
    this.controls.update();
    this.moved();
  }

  zoom(factor) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    this.camera.position.copy(this.controls.target).addScaledVector(offset, factor);
    this.controls.update();
    this.moved();
  }

  // Shifts by shares of the distance to the target, to the right and upwards on the screen.
  shift(right, up) {
    const scale = this.camera.position.distanceTo(this.controls.target);
    const move = new THREE.Vector3(right, up, 0).multiplyScalar(scale).applyQuaternion(this.camera.quaternion);
    this.camera.position.add(move);
    this.controls.target.add(move);
    this.controls.update();
    this.moved();
  }

  // --- picking ---

  // Pixels of the canvas, and the distance from the eye, of a point of the world.
  project(point) {
    const at = new THREE.Vector3(...point).project(this.camera);
    return {
      x: ((at.x + 1) / 2) * this.canvas.clientWidth,
      y: ((1 - at.y) / 2) * this.canvas.clientHeight,
      isInFront: at.z < 1,
    };
  }

  isShown(surface, point) {
    const { x: low, y: high } = this.shared.heights.value;
    if (point[2] < low || point[2] > high) return false;
    if (this.shared.hide_backs.value === 0) return true;
    return dot(normalAt(surface, point), subtract(this.camera.position.toArray(), point)) >= 0;
  }

  // What is drawn at a place of the canvas: { index, point }, or null.
  find(x, y) {
    this.camera.updateMatrixWorld();
    const matrix = new THREE.Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
    const row = (i) => [0, 1, 2, 3].map((k) => matrix.elements[4 * k + i]);
    const [width, height] = [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2];
    const rw = row(3);
    const rx = row(0).map((value, k) => width * (value + rw[k]));
    const ry = row(1).map((value, k) => height * (rw[k] - value));
    const isVisible = (index, point) => this.isShown(this.surfaces[index], point);
    const found = this.cloud.pick([rx, ry, rw], x, y, CLICK_RADIUS, isVisible);
    return found ?? this.findOutline(x, y);
  }

  findOutline(x, y) {
    const place = new THREE.Vector2((x / this.canvas.clientWidth) * 2 - 1, 1 - (y / this.canvas.clientHeight) * 2);
    const caster = new THREE.Raycaster();
    caster.setFromCamera(place, this.camera);
    const origin = caster.ray.origin.toArray();
    const direction = caster.ray.direction.toArray();
    let best = null;
    let nearest = Infinity;
    this.surfaces.forEach((surface, index) => {
      const along = rayDistance(surface, origin, direction, (point) => this.isShown(surface, point));
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
