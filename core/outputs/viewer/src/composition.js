// Keeps what was drawn of the points, and copies it to the screen with shading.
import * as THREE from 'three';
import { COMPOSE_FRAGMENT, COMPOSE_VERTEX } from './shaders.js';

const RADIUS = 1.4; // of the shading, pixels of the page
const STRENGTH = 6;

// A triangle that covers the screen.
function sheetOf(material) {
  const corners = new THREE.BufferGeometry();
  const places = [-1, -1, 0, 3, -1, 0, -1, 3, 0];
  corners.setAttribute('position', new THREE.Float32BufferAttribute(places, 3));
  const sheet = new THREE.Mesh(corners, material);
  sheet.frustumCulled = false;
  const scene = new THREE.Scene();
  scene.add(sheet);
  return scene;
}

export class Composition {
  // ground: what shows where there is nothing, as red, green and blue.
  constructor(ground) {
    this.target = new THREE.WebGLRenderTarget(1, 1, {
      minFilter: THREE.NearestFilter,
      magFilter: THREE.NearestFilter,
      depthTexture: new THREE.DepthTexture(1, 1, THREE.UnsignedIntType),
    });
    this.material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: COMPOSE_VERTEX,
      fragmentShader: COMPOSE_FRAGMENT,
      uniforms: {
        colours: { value: this.target.texture },
        depths: { value: this.target.depthTexture },
        ground: { value: new THREE.Vector3(...ground) },
        near_far: { value: new THREE.Vector2() },
        strength: { value: STRENGTH },
        radius: { value: 1 },
      },
      depthFunc: THREE.AlwaysDepth,
    });
    this.sheet = sheetOf(this.material);
  }

  // ratio: pixels of the picture by those of the page.
  resize(columns, rows, ratio) {
    this.target.setSize(columns, rows);
    this.material.uniforms.radius.value = Math.max(1, Math.round(RADIUS * ratio));
  }

  draw(renderer, camera) {
    this.material.uniforms.near_far.value.set(camera.near, camera.far);
    renderer.clear();
    renderer.render(this.sheet, camera);
  }
}
