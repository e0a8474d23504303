// Draws the points, a share of them while the view moves, the rest once it is at rest.
import * as THREE from 'three';
import { css, rampColour, rgb, scannerColour, surfaceColour, GREY, SELECTED } from './colours.js';
import { POINT_FRAGMENT, POINT_VERTEX } from './shaders.js';
import { isCylinder, sideOf, signedDistance } from './surface.js';

export const COLOURINGS = ['surface', 'height', 'time', 'scanner', 'residual'];
const RAMP_OF = { height: 'sequential', time: 'sequential', residual: 'diverging' };
const FIRST_PLANE = 2;
const RAMP_STEPS = 256;
const MAX_SCANNERS = 256;

const unit = (colour) => colour.map((x) => x / 255);

function texture(data, width, height, type) {
  const made = new THREE.DataTexture(data, width, height, THREE.RGBAFormat, type);
  made.needsUpdate = true;
  return made;
}

// The rows of `surfaces` in shaders.js.
export function surfaceTexture(surfaces) {
  const width = surfaces.length + FIRST_PLANE;
  const data = new Float32Array(4 * 3 * width);
  surfaces.forEach((surface, i) => {
    const column = 4 * (i + FIRST_PLANE);
    const round = isCylinder(surface);
    data.set([...surface.normal, round ? sideOf(surface) : surface.distance], column);
    if (round) {
      data.set(
        [surface.axis_point[0], surface.axis_point[1], surface.radius, 1],
        4 * width + column,
      );
    }
  });
  return texture(data, width, 3, THREE.FloatType);
}

export function colourSurfaces(map, surfaces, selected) {
  const { data, width } = map.image;
  const row = 2 * 4 * width;
  data.set([...unit(rgb(GREY)), 0, ...unit([214, 60, 160]), 0], row);
  surfaces.forEach((surface, i) => {
    const which = selected.indexOf(surface.id);
    const colour = which < 0 ? surfaceColour(surface.id) : rgb(SELECTED[which]);
    data.set([...unit(colour), which < 0 ? 0 : 0.85], row + 4 * (i + FIRST_PLANE));
  });
  map.needsUpdate = true;
}

// Notes in `surfaces` which of them are seen from behind: all of a plane is, or nothing of it.
export function markHidden(map, surfaces, eye) {
  const { data, width } = map.image;
  const row = 2 * 4 * width + 3;
  surfaces.forEach((surface, i) => {
    const at = row + 4 * (i + FIRST_PLANE);
    const code = isCylinder(surface) ? 4 : signedDistance(surface, eye) < 0 ? 2 : 0;
    const marked = (data[at] % 2) + code;
    if (data[at] === marked) return;
    data[at] = marked;
    map.needsUpdate = true;
  });
}

function rampTexture(name) {
  const data = new Uint8Array(4 * RAMP_STEPS);
  for (let i = 0; i < RAMP_STEPS; ++i) {
    data.set([...rampColour(name, i / (RAMP_STEPS - 1)), 255], 4 * i);
  }
  const made = texture(data, RAMP_STEPS, 1, THREE.UnsignedByteType);
  made.minFilter = made.magFilter = THREE.LinearFilter;
  return made;
}

function scannerTexture() {
  const data = new Uint8Array(4 * MAX_SCANNERS);
  for (let i = 0; i < MAX_SCANNERS; ++i) data.set([...scannerColour(i), 255], 4 * i);
  return texture(data, MAX_SCANNERS, 1, THREE.UnsignedByteType);
}

export class PointCloud {
  // shared: uniforms that all drawings have in common (view.js).
  // bounds: lowest and highest corner, last time.
  constructor(points, shared, bounds, residualRange) {
    this.points = points;
    this.ramps = { sequential: rampTexture('sequential'), diverging: rampTexture('diverging') };
    this.lowest = bounds.lowest;
    this.highest = bounds.highest;
    this.lastTime = bounds.lastTime;
    this.residualRange = residualRange;
    this.uniforms = {
      ...shared,
      origin: { value: new THREE.Vector3(...points.origin) },
      step_m: { value: points.step_m },
      times: { value: new THREE.Vector2(0, 65535) },
      coloured_by: { value: 0 },
      ramp_ends: { value: new THREE.Vector2(0, 1) },
      ramp: { value: this.ramps.sequential },
      scanners: { value: scannerTexture() },
      point_m: { value: 0.02 },
      pixels: { value: 1000 },
      smallest: { value: 1.5 },
      hide_loose: { value: 0 },
    };
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setAttribute('place', new THREE.BufferAttribute(points.place, 4));
    this.geometry.setAttribute('moment', new THREE.BufferAttribute(points.moment, 2));
    const material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: POINT_VERTEX,
      fragmentShader: POINT_FRAGMENT,
      uniforms: this.uniforms,
    });
    this.object = new THREE.Points(this.geometry, material);
    this.object.frustumCulled = false;
    this.scene = new THREE.Scene();
    this.scene.add(this.object);
  }

  // Values of the ramp's ends, in the units of the colouring; null where it has no ramp.
  rampEnds(name, heights) {
    if (name === 'height')
      return [Math.max(heights[0], this.lowest[2]), Math.min(heights[1], this.highest[2])];
    if (name === 'residual') return [-this.residualRange, this.residualRange];
    if (name === 'time') return [0, this.lastTime];
    return null;
  }

  colourBy(name, heights) {
    this.uniforms.coloured_by.value = COLOURINGS.indexOf(name);
    const ends = this.rampEnds(name, heights);
    if (!ends) return;
    const scale = name === 'time' ? this.points.time_step_s : 1;
    this.uniforms.ramp.value = this.ramps[RAMP_OF[name]];
    this.uniforms.ramp_ends.value.set(ends[0] / scale, ends[1] / scale);
  }

  showTimes(from, to) {
    const step = this.points.time_step_s;
    this.uniforms.times.value.set(from / step, to / step);
  }

  // The surface index of the point that is drawn nearest to the eye within `radius` pixels of a
  // place on the screen, and the point; null where there is none. transform: world to the
  // screen's x and y in pixels and the distance, as rows.
  pick(transform, x, y, radius, isVisible) {
    const { place, moment, count, origin, step_m: step } = this.points;
    const [rx, ry, rw] = transform;
    const { x: first, y: last } = this.uniforms.times.value;
    let best = null;
    let nearest = Infinity;
    for (let i = 0; i < count; ++i) {
      const field = place[4 * i + 3];
      if (field < FIRST_PLANE || moment[2 * i] < first || moment[2 * i] > last) continue;
      const px = origin[0] + step * place[4 * i];
      const py = origin[1] + step * place[4 * i + 1];
      const pz = origin[2] + step * place[4 * i + 2];
      const w = rw[0] * px + rw[1] * py + rw[2] * pz + rw[3];
      if (w <= 0.05 || w >= nearest) continue;
      if (Math.abs((rx[0] * px + rx[1] * py + rx[2] * pz + rx[3]) / w - x) > radius) continue;
      if (Math.abs((ry[0] * px + ry[1] * py + ry[2] * pz + ry[3]) / w - y) > radius) continue;
      if (!isVisible(field - FIRST_PLANE, [px, py, pz])) continue;
      nearest = w;
      best = { index: field - FIRST_PLANE, point: [px, py, pz] };
    }
    return best;
  }
}

export { RAMP_OF, css };
