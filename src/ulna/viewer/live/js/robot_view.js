// The robot in the scene: a group for each link that is moved, the arc of a joint's range, marks of frames.

import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, Group, Line, LineBasicMaterial, Matrix4, Mesh, MeshBasicMaterial,
  MeshStandardMaterial,
} from "three";

/** Meshes of links, moved by their poses. */
export class RobotView {
  constructor(robot, surfaces) {
    this.group = new Group();
    this.links = robot.links.map(() => {
      const link = new Group();
      link.matrixAutoUpdate = false;
      this.group.add(link);
      return link;
    });
    const materials = new Map();
    for (const { link, color, geometry } of surfaces) {
      const key = color.join();
      if (!materials.has(key)) materials.set(key, material(color));
      const mesh = new Mesh(geometry, materials.get(key));
      mesh.castShadow = mesh.receiveShadow = color[3] > 0.5;
      this.links[link].add(mesh);
    }
  }

  /** Poses of the links, row by row, 16 numbers each. */
  move(poses) {
    this.links.forEach((link, k) => {
      link.matrix.fromArray(poses, 16 * k).transpose();
      link.matrixWorldNeedsUpdate = true;
    });
  }
}

function material([red, green, blue, opacity]) {
  const color = new Color().setRGB(red, green, blue); // linear
  const dark = Math.max(red, green, blue) < 0.12;
  return new MeshStandardMaterial({
    color, roughness: dark ? 0.5 : 0.42, metalness: dark ? 0.15 : 0.02, transparent: opacity < 1, opacity,
    side: DoubleSide, shadowSide: DoubleSide,
  });
}

/** The range of a joint: a sector about its axis, or a line along it, and where the joint is. */
export class RangeMark {
  constructor(stage) {
    this.stage = stage;
    this.group = new Group();
    this.group.matrixAutoUpdate = false;
    this.group.visible = false;
    stage.scene.add(this.group);
    this.parts = [];
  }

  /** Shows the range of a slider's joint, or hides it for null. */
  show(slider, q, poses) {
    const wanted = slider && slider.axis ? slider : null;
    if (this.group.visible !== !!wanted) this.stage.dirty = true;
    this.group.visible = !!wanted;
    if (!wanted) return;
    this.stage.dirty = true;
    for (const part of this.parts) {
      this.group.remove(part);
      part.geometry.dispose();
    }
    // in the joint's moving frame the range turns backwards: the link is at zero, the limits are at low - q
    const value = q[slider.index];
    const link = new Matrix4().fromArray(poses, 16 * slider.link).transpose();
    this.group.matrix.copy(link.multiply(new Matrix4().fromArray(slider.place).transpose()));
    this.parts = slider.turns
      ? sector(slider, value, 0.17 * this.stage.size)
      : rail(slider, value, 0.02 * this.stage.size);
    this.group.add(...this.parts);
  }
}

const RANGE = 0x3b82f6, POINTER = 0xf59e0b;

function sector(slider, value, radius) {
  const [x, y] = crossAxes(slider.axis);
  const low = Math.max(slider.low, value - 2 * Math.PI), high = Math.min(slider.high, value + 2 * Math.PI);
  const at = (angle, r) => x.map((_, k) => r * (Math.cos(angle) * x[k] + Math.sin(angle) * y[k]));
  const steps = Math.max(8, Math.ceil((high - low) / 0.06));
  const points = [], edge = [];
  for (let k = 0; k < steps; k++) {
    const a = low - value + ((high - low) * k) / steps, b = low - value + ((high - low) * (k + 1)) / steps;
    points.push(0, 0, 0, ...at(a, radius), ...at(b, radius));
    edge.push(...at(a, radius));
  }
  edge.push(...at(high - value, radius));
  return [
    new Mesh(geometry(points), flat(RANGE, 0.16)),
    new Line(geometry([0, 0, 0, ...edge, 0, 0, 0]), new LineBasicMaterial({ color: RANGE, transparent: true, depthTest: false })),
    new Line(geometry([0, 0, 0, ...at(0, 1.15 * radius)]), new LineBasicMaterial({ color: POINTER, transparent: true, depthTest: false })),
  ];
}

function rail(slider, value, radius) {
  const along = (s) => slider.axis.map((c) => c * (s - value));
  const line = geometry([...along(slider.low), ...along(slider.high)]);
  const [x] = crossAxes(slider.axis);
  const pointer = geometry([...x.map((c) => -radius * c), ...x.map((c) => radius * c)]);
  return [
    new Line(line, new LineBasicMaterial({ color: RANGE, transparent: true, depthTest: false })),
    new Line(pointer, new LineBasicMaterial({ color: POINTER, transparent: true, depthTest: false })),
  ];
}

function geometry(numbers) {
  return new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(numbers), 3));
}

function flat(color, opacity) {
  return new MeshBasicMaterial({ color, transparent: true, opacity, side: DoubleSide, depthWrite: false, depthTest: false });
}

/** Two directions across an axis that make a right-handed system with it. */
function crossAxes(axis) {
  const least = axis.map(Math.abs).indexOf(Math.min(...axis.map(Math.abs)));
  const e = [0, 1, 2].map((k) => (k === least ? 1 : 0));
  const dot = e[0] * axis[0] + e[1] * axis[1] + e[2] * axis[2];
  const x = e.map((c, k) => c - dot * axis[k]);
  const length = Math.hypot(...x);
  const u = x.map((c) => c / length);
  return [u, [axis[1] * u[2] - axis[2] * u[1], axis[2] * u[0] - axis[0] * u[2], axis[0] * u[1] - axis[1] * u[0]]];
}
