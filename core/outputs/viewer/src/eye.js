// Where the reader looks from: the camera, its controls, and where points show on the screen.
import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

const FIELD_OF_VIEW = 50; // degrees
const TAN = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);

// From the target to the eye. The small second numbers keep azimuths where they are wanted.
const DIRECTIONS = {
  overview: [-0.45, -0.75, 0.95],
  top: [0, -0.001, 1],
  front: [0, -1, 0.12],
  side: [-1, -0.001, 0.12],
};

export class Eye {
  // lowest, highest: corners of the map. onMove(): the eye has moved.
  constructor(canvas, lowest, highest, onMove) {
    this.canvas = canvas;
    this.low = new THREE.Vector3(...lowest);
    this.high = new THREE.Vector3(...highest);
    this.camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.1, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = Math.PI;
    this.controls.addEventListener('change', onMove);
    this.target = this.controls.target;
  }

  get position() {
    return this.camera.position.toArray();
  }

  resize(width, height) {
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  // Pixels that 1 m takes at a distance of 1 m in a picture of so many rows.
  static pixelsPerMetre(rows) {
    return rows / (2 * TAN);
  }

  // The nearest and the farthest depth that the map needs: depths are precise in between.
  fitDepths() {
    const { camera, low, high } = this;
    const radius = low.distanceTo(high) / 2;
    const away = camera.position.distanceTo(low.clone().add(high).multiplyScalar(0.5));
    camera.far = away + 1.5 * radius + 5;
    camera.near = Math.max(0.05, Math.min(1, (away - radius) / 2));
    camera.updateProjectionMatrix();
  }

  lookFrom(name) {
    const { camera, low, high, target } = this;
    const direction = new THREE.Vector3(...DIRECTIONS[name]).normalize();
    target.copy(low).add(high).multiplyScalar(0.5);
    camera.position.copy(target).add(direction);
    camera.lookAt(target);
    const [x, y, z] = ['x', 'y', 'z'].map((axis) => [low[axis], high[axis]]);
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(
      (i) => new THREE.Vector3(x[i & 1], y[(i >> 1) & 1], z[i >> 2]),
    );
    for (let round = 0; round < 4; ++round) this.fit(corners, direction);
    this.controls.update();
  }

  // Moves the target to the middle of what the corners take of the picture, and the camera as
  // near as they fit.
  fit(corners, direction) {
    const { camera, target } = this;
    const inverse = camera.quaternion.clone().invert();
    const inView = corners.map((corner) => corner.clone().sub(target).applyQuaternion(inverse));
    const reach = ({ x, y, z }) => z + Math.max(Math.abs(y), Math.abs(x) / camera.aspect) / TAN;
    const away = 1.03 * Math.max(1, ...inView.map(reach));
    const middle = (axis) => {
      const places = inView.map((corner) => corner[axis] / (away - corner.z));
      return ((Math.max(...places) + Math.min(...places)) / 2) * away;
    };
    const shift = new THREE.Vector3(middle('x'), middle('y'), 0);
    target.add(shift.applyQuaternion(camera.quaternion));
    camera.position.copy(target).addScaledVector(direction, away);
  }

  // Makes a point the one that the eye turns about, and goes half of the way along with it.
  lookAt(point) {
    const shift = new THREE.Vector3(...point).sub(this.target);
    this.target.add(shift);
    this.camera.position.add(shift.multiplyScalar(0.5));
    this.controls.update();
  }

  // Turns about the target by angles in degrees.
  turn(azimuth, elevation) {
    const offset = this.camera.position.clone().sub(this.target);
    // three's spherical coordinates have y upwards.
    const place = new THREE.Spherical().setFromCartesianCoords(offset.x, offset.z, -offset.y);
    place.theta += (azimuth * Math.PI) / 180;
    place.phi -= (elevation * Math.PI) / 180;
    place.phi = Math.min(Math.PI - 0.01, Math.max(0.01, place.phi));
    const turned = new THREE.Vector3().setFromSpherical(place);
    this.camera.position.set(turned.x, -turned.z, turned.y).add(this.target);
    this.controls.update();
  }

  zoom(factor) {
    const offset = this.camera.position.clone().sub(this.target);
    this.camera.position.copy(this.target).addScaledVector(offset, factor);
    this.controls.update();
  }

  // Shifts by shares of the distance to the target, to the right and upwards on the screen.
  shift(right, up) {
    const move = new THREE.Vector3(right, up, 0)
      .multiplyScalar(this.camera.position.distanceTo(this.target))
      .applyQuaternion(this.camera.quaternion);
    this.camera.position.add(move);
    this.target.add(move);
    this.controls.update();
  }

  // Pixels of the canvas where a point of the world shows.
  project(point) {
    const at = new THREE.Vector3(...point).project(this.camera);
    return {
      x: ((at.x + 1) / 2) * this.canvas.clientWidth,
      y: ((1 - at.y) / 2) * this.canvas.clientHeight,
      isInFront: at.z < 1,
    };
  }

  // Rows that give, of a point (x, y, z, 1), its pixels' x and y times its distance along the view,
  // and that distance.
  screenRows() {
    const { camera, canvas } = this;
    camera.updateMatrixWorld();
    const matrix = new THREE.Matrix4().multiplyMatrices(
      camera.projectionMatrix,
      camera.matrixWorldInverse,
    );
    const row = (i) => [0, 1, 2, 3].map((k) => matrix.elements[4 * k + i]);
    const distance = row(3);
    const x = row(0).map((value, k) => (canvas.clientWidth / 2) * (distance[k] + value));
    const y = row(1).map((value, k) => (canvas.clientHeight / 2) * (distance[k] - value));
    return [x, y, distance];
  }

  // The line of sight through a pixel of the canvas: its origin and its direction.
  ray(x, y) {
    const place = new THREE.Vector2(
      (x / this.canvas.clientWidth) * 2 - 1,
      1 - (y / this.canvas.clientHeight) * 2,
    );
    const caster = new THREE.Raycaster();
    caster.setFromCamera(place, this.camera);
    return [caster.ray.origin.toArray(), caster.ray.direction.toArray()];
  }
}
