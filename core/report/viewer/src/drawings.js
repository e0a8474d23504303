// What is drawn over the points: outlines, chosen surfaces, the rig's path, a measured line.
import * as THREE from 'three';
import { SELECTED } from './colours.js';
import { OVERLAY_FRAGMENT, OVERLAY_VERTEX } from './shaders.js';
import { facets, isCylinder, tangents, dot } from './surface.js';

const FIRST_PLANE = 2;
const INTERVALS = { doubtful: '#c0262d', degenerate: '#d98e04' };
const PATH = '#20242c';

function material(shared, { tint = '#000000', nearer = 0.05, opacity = 1, ownColour = 0 }) {
  const colour = new THREE.Color();
  colour.setStyle(tint, THREE.LinearSRGBColorSpace); // as it shows
  return new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3,
    vertexShader: OVERLAY_VERTEX,
    fragmentShader: OVERLAY_FRAGMENT,
    uniforms: {
      ...shared,
      tint: { value: colour },
      nearer: { value: nearer },
      opacity: { value: opacity },
      own_colour: { value: ownColour },
    },
    transparent: opacity < 1,
    depthWrite: opacity === 1,
    side: THREE.DoubleSide,
  });
}

function geometry(corners, fields) {
  const made = new THREE.BufferGeometry();
  made.setAttribute('position', new THREE.Float32BufferAttribute(corners.flat(), 3));
  made.setAttribute('field', new THREE.Float32BufferAttribute(fields, 1));
  return made;
}

// Pairs of corners, a line each.
function outlineEdges(surface) {
  const { outline } = surface;
  return outline.flatMap((corner, i) => [corner, outline[(i + 1) % outline.length]]);
}

// Corners of triangles that fill the outline.
function triangles(surface) {
  return facets(surface).flatMap((polygon) => {
    if (isCylinder(surface)) return [0, 1, 2, 0, 2, 3].map((i) => polygon[i]);
    const [u, v] = tangents(surface.normal);
    const flat = polygon.map((corner) => new THREE.Vector2(dot(corner, u), dot(corner, v)));
    return THREE.ShapeUtils.triangulateShape(flat, []).flatMap((face) => face.map((i) => polygon[i]));
  });
}

// Never culled: their shaders move them.
function drawn(object) {
  object.frustumCulled = false;
  return object;
}

export class Drawings {
  // intervals: { doubtful, degenerate }, each with start_s and end_s.
  constructor(surfaces, poses, intervals, shared) {
    this.surfaces = surfaces;
    this.shared = shared;
    this.scene = new THREE.Scene();
    const corners = [];
    const fields = [];
    surfaces.forEach((surface, i) => {
      const edges = outlineEdges(surface);
      corners.push(...edges);
      fields.push(...edges.map(() => i + FIRST_PLANE));
    });
    this.outlines = drawn(
      new THREE.LineSegments(geometry(corners, fields), material(shared, { ownColour: 1 })),
    );
    this.chosen = new THREE.Group();
    this.path = this.drawPath(poses, intervals);
    this.rig = this.drawRig();
    this.measure = new THREE.Group();
    this.scene.add(this.outlines, this.path, this.chosen, this.rig, this.measure);
  }

  drawPath(poses, intervals) {
    const group = new THREE.Group();
    const add = (shown, tint, nearer) => {
      const corners = [];
      for (let i = 0; i + 1 < poses.length; ++i) {
        if (shown(poses[i].t)) corners.push(poses[i].position, poses[i + 1].position);
      }
      if (corners.length === 0) return;
      group.add(
        drawn(new THREE.LineSegments(geometry(corners, corners.map(() => 0)), material(this.shared, { tint, nearer }))),
      );
    };
    add(() => true, PATH, 0.1);
    for (const kind of ['degenerate', 'doubtful']) {
      const within = (t) => intervals[kind].some(({ start_s: start, end_s: end }) => t >= start && t <= end);
      add(within, INTERVALS[kind], 0.15);
    }
    return group;
  }

  // An arrow along the body's axes: red forwards, green to the left, blue up.
  drawRig() {
    const group = new THREE.Group();
    const axes = [[0.5, 0, 0], [0, 0.3, 0], [0, 0, 0.3]];
    this.axes = ['#b3261e', '#2e7d32', '#1f5fbf'].map((tint, i) => {
      const line = drawn(
        new THREE.LineSegments(geometry([[0, 0, 0], axes[i]], [0, 0]), material(this.shared, { tint, nearer: 0.3 })),
      );
      group.add(line);
      return line;
    });
    this.body = drawn(new THREE.Mesh(geometry(this.bodyCorners(), Array(24).fill(0)), material(this.shared, { tint: PATH, nearer: 0.3 })));
    group.add(this.body);
    this.rigAxes = axes;
    return group;
  }

  // An octahedron of 16 cm.
  bodyCorners() {
    const size = 0.08;
    const corners = [];
    for (const x of [-size, size]) {
      for (const y of [-size, size]) {
        for (const z of [-size, size]) corners.push([x, 0, 0], [0, y, 0], [0, 0, z]);
      }
    }
    return corners;
  }

  moveRig({ position, rotation }) {
    const turn = new THREE.Quaternion(...rotation);
    const place = new THREE.Vector3(...position);
    const moved = (corner) => new THREE.Vector3(...corner).applyQuaternion(turn).add(place).toArray();
    const update = (object, corners) => {
      object.geometry.attributes.position.array.set(corners.map(moved).flat());
      object.geometry.attributes.position.needsUpdate = true;
    };
    this.axes.forEach((line, i) => update(line, [[0, 0, 0], this.rigAxes[i]]));
    update(this.body, this.bodyCorners());
  }

  clear(group) {
    for (const object of [...group.children]) {
      object.geometry.dispose();
      object.material.dispose();
      group.remove(object);
    }
  }

  choose(indices) {
    this.clear(this.chosen);
    indices.forEach((index, i) => {
      const surface = this.surfaces[index];
      const tint = SELECTED[i];
      const field = (corners) => corners.map(() => index + FIRST_PLANE);
      const filled = triangles(surface);
      const edges = outlineEdges(surface);
      this.chosen.add(
        drawn(new THREE.Mesh(geometry(filled, field(filled)), material(this.shared, { tint, nearer: 0.06, opacity: 0.25 }))),
        drawn(new THREE.LineSegments(geometry(edges, field(edges)), material(this.shared, { tint, nearer: 0.1 }))),
      );
    });
  }

  // A line from one point to another, or none.
  showMeasure(ends) {
    this.clear(this.measure);
    if (!ends) return;
    this.measure.add(
      drawn(new THREE.LineSegments(geometry(ends, [0, 0]), material(this.shared, { tint: '#000000', nearer: 0.4 }))),
    );
  }
}
