// What is drawn over the points: outlines, chosen surfaces, the rig's path, a measured line.
import * as THREE from 'three';
import { SELECTED } from './colours.js';
import { OVERLAY_FRAGMENT, OVERLAY_VERTEX } from './shaders.js';
import { facets, isCylinder, tangents, dot } from './surface.js';

const FIRST_PLANE = 2;
const INTERVALS = { doubtful: '#c0262d', degenerate: '#d98e04' };
const PATH = '#20242c';
const AXES = [
  [[0.5, 0, 0], '#b3261e'],
  [[0, 0.3, 0], '#2e7d32'],
  [[0, 0, 0.3], '#1f5fbf'],
];
// The corners of an octahedron's triangles, m.
const BODY = [-0.08, 0.08].flatMap((x) =>
  [-0.08, 0.08].flatMap((y) =>
    [-0.08, 0.08].flatMap((z) => [
      [x, 0, 0],
      [0, y, 0],
      [0, 0, z],
    ]),
  ),
);

function material(
  shared,
  { tint = '#000000', nearer = 0.05, opacity = 1, ownColour = 0, width = 0 },
) {
  const colour = new THREE.Color();
  colour.setStyle(tint, THREE.LinearSRGBColorSpace); // as it shows
  const made = new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3,
    vertexShader: OVERLAY_VERTEX,
    fragmentShader: OVERLAY_FRAGMENT,
    uniforms: {
      ...shared,
      tint: { value: colour },
      nearer: { value: nearer },
      opacity: { value: opacity },
      own_colour: { value: ownColour },
      width: { value: width },
    },
    transparent: opacity < 1,
    depthWrite: opacity === 1,
    side: THREE.DoubleSide,
  });
  made.userData.width = width; // in pixels of the page
  return made;
}

// Never culled: their shaders move them.
function drawn(geometry, made) {
  const mesh = new THREE.Mesh(geometry, made);
  mesh.frustumCulled = false;
  return mesh;
}

const floats = (numbers, size) => new THREE.Float32BufferAttribute(numbers, size);

// Triangles with these corners, three each.
function areas(corners, field) {
  const made = new THREE.BufferGeometry();
  made.setAttribute('position', floats(corners.flat(), 3));
  made.setAttribute('other', floats(corners.flat(), 3));
  made.setAttribute('side', floats(new Array(corners.length).fill(0), 1));
  made.setAttribute('field', floats(new Array(corners.length).fill(field), 1));
  return made;
}

// Lines between these ends, two each, on surfaces of these fields.
function lines(ends, fields) {
  const made = new THREE.BufferGeometry();
  const position = [];
  const other = [];
  const side = [];
  const field = [];
  const index = [];
  for (let i = 0; i + 1 < ends.length; i += 2) {
    const [a, b] = [ends[i], ends[i + 1]];
    position.push(...a, ...a, ...b, ...b);
    other.push(...b, ...b, ...a, ...a);
    side.push(1, -1, -1, 1); // across turns round at the other end
    field.push(...new Array(4).fill(fields[i]));
    index.push(...[0, 1, 2, 2, 1, 3].map((corner) => 2 * i + corner));
  }
  made.setAttribute('position', floats(position, 3));
  made.setAttribute('other', floats(other, 3));
  made.setAttribute('side', floats(side, 1));
  made.setAttribute('field', floats(field, 1));
  made.setIndex(index);
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
    return THREE.ShapeUtils.triangulateShape(flat, []).flatMap((face) =>
      face.map((i) => polygon[i]),
    );
  });
}

export class Drawings {
  // intervals: { doubtful, degenerate }, each with start_s and end_s. ratio: uniform, pixels of the
  // picture by those of the page.
  constructor(surfaces, poses, intervals, shared, ratio) {
    this.surfaces = surfaces;
    this.shared = shared;
    this.ratio = ratio;
    this.scene = new THREE.Scene();
    const edges = surfaces.map(outlineEdges);
    const fields = edges.flatMap((ends, i) => ends.map(() => i + FIRST_PLANE));
    this.outlines = drawn(
      lines(edges.flat(), fields),
      material(shared, { ownColour: 1, width: 1.4 }),
    );
    this.chosen = new THREE.Group();
    this.path = this.drawPath(poses, intervals);
    this.rig = new THREE.Group();
    this.measure = new THREE.Group();
    this.scene.add(this.outlines, this.path, this.chosen, this.rig, this.measure);
  }

  // Lines are as wide on dense screens as on others.
  scaleLines() {
    this.scene.traverse(({ material: made }) => {
      if (made) made.uniforms.width.value = made.userData.width * this.ratio.value;
    });
  }

  line(ends, options) {
    return drawn(
      lines(
        ends,
        ends.map(() => 0),
      ),
      material(this.shared, options),
    );
  }

  drawPath(poses, intervals) {
    const group = new THREE.Group();
    const add = (shown, options) => {
      const ends = [];
      for (let i = 0; i + 1 < poses.length; ++i) {
        if (shown(poses[i].t)) ends.push(poses[i].position, poses[i + 1].position);
      }
      if (ends.length > 0) group.add(this.line(ends, options));
    };
    add(() => true, { tint: PATH, nearer: 0.1, width: 2 });
    for (const kind of ['degenerate', 'doubtful']) {
      const within = (t) =>
        intervals[kind].some(({ start_s: start, end_s: end }) => t >= start && t <= end);
      add(within, { tint: INTERVALS[kind], nearer: 0.15, width: 4 });
    }
    return group;
  }

  // The rig: its body, and its axes: red forwards, green to the left, blue up.
  moveRig({ position, rotation }) {
    const turn = new THREE.Quaternion(...rotation);
    const place = new THREE.Vector3(...position);
    const moved = (corner) =>
      new THREE.Vector3(...corner).applyQuaternion(turn).add(place).toArray();
    this.clear(this.rig);
    this.body = drawn(
      areas(BODY.map(moved), 0),
      material(this.shared, { tint: PATH, nearer: 0.3 }),
    );
    this.rig.add(
      this.body,
      ...AXES.map(([end, tint]) =>
        this.line([[0, 0, 0], end].map(moved), { tint, nearer: 0.3, width: 3 }),
      ),
    );
    this.scaleLines();
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
      const field = index + FIRST_PLANE;
      // A chosen surface shows from behind, too.
      const shared = { ...this.shared, hide_backs: { value: 0 } };
      this.chosen.add(
        drawn(
          areas(triangles(surface), field),
          material(shared, { tint, nearer: 0.06, opacity: 0.25 }),
        ),
        drawn(
          lines(outlineEdges(surface), new Array(2 * surface.outline.length).fill(field)),
          material(shared, { tint, nearer: 0.1, width: 3 }),
        ),
      );
    });
    this.scaleLines();
  }

  // A line from one point to another, or none.
  showMeasure(ends) {
    this.clear(this.measure);
    if (ends) this.measure.add(this.line(ends, { tint: PATH, nearer: 0.4, width: 3 }));
    this.scaleLines();
  }
}
