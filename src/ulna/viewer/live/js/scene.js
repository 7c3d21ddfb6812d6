// What surrounds the robot: camera, lights, shadow, floor and environment, light and dark.

import {
  Box3, Color, DirectionalLight, DoubleSide, Group, HemisphereLight, Mesh, MeshBasicMaterial, NeutralToneMapping,
  PCFShadowMap, PerspectiveCamera, PlaneGeometry, PMREMGenerator, Scene, ShaderMaterial, ShadowMaterial,
  SphereGeometry, Vector3, WebGLRenderer, BackSide, BoxGeometry,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const FOV = 27;
const SLOW = 45, IDLE = 250, COARSE = 0.6; // ms a frame, ms at rest, part of the pixels along an edge
const THEMES = {
  light: { line: 0x4a5b72, strength: 0.3, disc: 0xffffff, glow: 0.42, shadow: 0.34, key: 2.1, sky: 0.5, room: 0.6 },
  dark: { line: 0x93a7c4, strength: 0.26, disc: 0x3a4658, glow: 0.55, shadow: 0.55, key: 1.9, sky: 0.32, room: 0.5 },
};

const FLOOR_VERTEX = `varying vec2 place;
void main() { place = position.xy; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`;
const FLOOR_FRAGMENT = `varying vec2 place; uniform vec3 line; uniform vec3 disc; uniform float strength, glow, cell, size;
float lines(float width, float thickness) {
  vec2 p = place / width, w = fwidth(p);
  vec2 d = abs(fract(p - 0.5) - 0.5) / max(w, 1e-6);
  float near = 1.0 - min(min(d.x, d.y) / thickness, 1.0);
  return near * (1.0 - smoothstep(0.15, 0.5, max(w.x, w.y)));
}
void main() {
  float r = length(place) / size;
  float fade = 1.0 - smoothstep(0.25, 1.0, r);
  float l = max(0.45 * lines(cell, 1.0), lines(5.0 * cell, 1.3)) * strength * fade;
  float g = glow * pow(1.0 - smoothstep(0.0, 0.95, r), 1.6);
  float a = l + g * (1.0 - l);
  gl_FragColor = vec4((line * l + disc * g * (1.0 - l)) / max(a, 1e-4), a);
  #include <colorspace_fragment>
}`;

/** A scene with one robot in it; draws when `dirty` is set. */
export class Stage {
  constructor(canvas, bounds, reduced) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: true, powerPreference: "high-performance" });
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(FOV, 1.6, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.bounds = bounds;
    this.size = Math.max(...bounds.max.map((x, k) => x - bounds.min[k]), 0.05);
    this.dirty = true;
    this.coarse = false;
    this.slow = 0; // how many frames took too long, less those that did not
    this.last = null; // when the last frame was drawn, if something has moved since [ms]
    this.drawn = 0;
    this._addLights();
    this._addFloor();
    this._addEnvironment();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = !reduced;
    this.controls.dampingFactor = 0.12;
    this.controls.maxPolarAngle = 0.97 * Math.PI;
    this.controls.minDistance = 0.3 * this.size;
    this.controls.maxDistance = 12 * this.size;
    this.controls.addEventListener("change", () => (this.dirty = true));
    this.aside = 0;
  }

  /** Light or dark. */
  set theme(name) {
    const look = THEMES[name];
    this.sun.intensity = look.key;
    this.sky.intensity = look.sky;
    this.scene.environmentIntensity = look.room;
    this.shade.material.opacity = look.shadow;
    const { line, disc, strength, glow } = this.floor.material.uniforms;
    line.value.set(look.line);
    disc.value.set(look.disc);
    strength.value = look.strength;
    glow.value = look.glow;
    this.dirty = true;
  }

  resize(width, height) {
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2) * (this.coarse ? COARSE : 1));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }

  /** The camera sees all of the box from its first direction; `aside` pixels on the right are covered by a panel. */
  fit({ direction, aside = 0, below = 0 }) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const aspect = (width - aside) / Math.max(height - below, 1);
    const box = new Box3(new Vector3(...this.bounds.min), new Vector3(...this.bounds.max));
    const target = box.getCenter(new Vector3());
    const back = new Vector3(...direction).normalize();
    const right = new Vector3(0, 0, 1).cross(back).normalize(), up = back.clone().cross(right);
    const slope = Math.tan((FOV * Math.PI) / 360) / 1.16;
    let distance = 0;
    for (const corner of corners(box)) {
      const offset = corner.sub(target);
      const [x, y, z] = [offset.dot(right), offset.dot(up), offset.dot(back)];
      distance = Math.max(distance, z + Math.abs(y) / (slope * (1 - below / height)));
      distance = Math.max(distance, z + Math.abs(x) / (slope * (1 - below / height) * aspect));
    }
    this.camera.position.copy(target).addScaledVector(back, distance);
    this.controls.target.copy(target);
    this.camera.setViewOffset(width, height, aside / 2, below / 2, width, height);
    this.controls.update();
    this.dirty = true;
  }

  /** Height and width of a pixel at a point [m]. */
  pixel(point) {
    const depth = point.clone().sub(this.camera.position).dot(this.camera.getWorldDirection(new Vector3()));
    return (2 * Math.abs(depth) * Math.tan((FOV * Math.PI) / 360)) / Math.max(this.canvas.clientHeight, 1);
  }

  /** The shadow is drawn again, too. */
  robotMoved() {
    this.renderer.shadowMap.needsUpdate = true;
    this.dirty = true;
  }

  /** Draws where something changed; coarser while frames take too long, as fine as can be when nothing moves. */
  draw(now) {
    this.controls.update();
    if (!this.dirty) {
      this.last = null;
      if (this.slow && now - this.drawn > IDLE) this._setCoarse(false);
      if (!this.dirty) return false;
    }
    this.slow = this.last === null ? this.slow : Math.max(0, this.slow + (now - this.last > SLOW ? 1 : -1));
    if (this.slow > 6 && !this.coarse) this._setCoarse(true);
    this.last = this.drawn = now;
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
    return true;
  }

  _setCoarse(coarse) {
    this.slow = coarse ? this.slow : 0;
    if (this.coarse === coarse) return;
    this.coarse = coarse;
    this.resize(this.canvas.clientWidth, this.canvas.clientHeight);
  }

  dispose() {
    this.controls.dispose();
    this.renderer.dispose();
    if (!this.renderer.getContext().isContextLost()) this.renderer.forceContextLoss(); // browsers have few contexts
  }

  _addLights() {
    const centre = new Vector3(...this.bounds.min).add(new Vector3(...this.bounds.max)).multiplyScalar(0.5);
    this.sun = new DirectionalLight(0xfff6ea, 2);
    this.sun.position.copy(centre).addScaledVector(new Vector3(0.75, -0.55, 1.5).normalize(), 3 * this.size);
    this.sun.target.position.copy(centre);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.radius = 5;
    this.sun.shadow.normalBias = 0.004 * this.size;
    this.sun.shadow.bias = -0.0004;
    const reach = 1.5 * this.size;
    Object.assign(this.sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach });
    Object.assign(this.sun.shadow.camera, { near: 0.1 * this.size, far: 7 * this.size });
    this.sky = new HemisphereLight(0xf4f8ff, 0x9aa3ad, 0.5);
    this.rim = new DirectionalLight(0xdfe9ff, 0.7);
    this.rim.position.copy(centre).addScaledVector(new Vector3(-0.8, 0.7, 0.5).normalize(), 3 * this.size);
    this.rim.target.position.copy(centre);
    this.scene.add(this.sun, this.sun.target, this.sky, this.rim, this.rim.target);
  }

  _addFloor() {
    const size = 3.2 * this.size;
    const cell = 10 ** Math.round(Math.log10(this.size / 8));
    const uniforms = {
      line: { value: new Color() }, disc: { value: new Color() }, strength: { value: 0 }, glow: { value: 0 },
      cell: { value: cell }, size: { value: size },
    };
    const material = new ShaderMaterial({
      uniforms, vertexShader: FLOOR_VERTEX, fragmentShader: FLOOR_FRAGMENT, transparent: true, depthWrite: false,
      side: DoubleSide,
    });
    this.floor = new Mesh(new PlaneGeometry(2 * size, 2 * size), material);
    this.shade = new Mesh(new PlaneGeometry(2 * size, 2 * size), new ShadowMaterial({ color: 0x0b1526 }));
    this.shade.receiveShadow = true;
    this.floor.renderOrder = -2;
    this.shade.renderOrder = -1;
    const z = this.bounds.floor;
    const x = (this.bounds.min[0] + this.bounds.max[0]) / 2, y = (this.bounds.min[1] + this.bounds.max[1]) / 2;
    const snap = (v) => 5 * cell * Math.round(v / (5 * cell)); // lines go through the origin of the world
    for (const plane of [this.floor, this.shade]) plane.position.set(snap(x), snap(y), z - 0.001 * this.size);
    this.scene.add(this.floor, this.shade);
  }

  /** Reflections of a bright room with three windows. */
  _addEnvironment() {
    const room = new Scene();
    const plain = (color, strength) => new MeshBasicMaterial({ color: new Color(color).multiplyScalar(strength), side: BackSide });
    room.add(new Mesh(new SphereGeometry(10, 16, 12), plain(0xaeb9c6, 0.55)));
    const windows = new Group();
    for (const [x, y, z, width, height, strength] of [[6, -4, 5, 4, 4, 9], [-6, 5, 4, 5, 3, 5], [0, 0, 8, 6, 6, 4]]) {
      const pane = new Mesh(new BoxGeometry(width, height, 0.1), new MeshBasicMaterial({ color: new Color(1, 1, 1).multiplyScalar(strength) }));
      pane.position.set(x, y, z);
      pane.lookAt(0, 0, 0);
      windows.add(pane);
    }
    const ground = new Mesh(new PlaneGeometry(20, 20), new MeshBasicMaterial({ color: 0x8d949c }));
    ground.position.z = -3;
    room.add(windows, ground);
    const generator = new PMREMGenerator(this.renderer);
    this.scene.environment = generator.fromScene(room, 0.04, 0.1, 30, { size: 64 }).texture;
    generator.dispose();
  }
}

function* corners(box) {
  for (const x of [box.min.x, box.max.x])
    for (const y of [box.min.y, box.max.y]) for (const z of [box.min.z, box.max.z]) yield new Vector3(x, y, z);
}
