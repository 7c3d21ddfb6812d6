// A target to drag: arrows that shift it, rings that turn it, a ball that moves it across the view.

import {
  ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Plane, Quaternion, Raycaster, SphereGeometry,
  TorusGeometry, Vector2, Vector3, Matrix4,
} from "three";
import { moved, position, turned, unit } from "./pose.js";

const COLORS = [0xf0444f, 0x22a565, 0x2f7df6], BALL = 0xf59e0b, LIT = 0xffd66b;
const RADIUS = 84; // of the rings, in pixels of CSS
const AXES = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];

/** Handles at one frame of the robot. Poses are those of pose.js. */
export class Gizmo {
  constructor(stage, frame) {
    this.stage = stage;
    this.frame = frame;
    this.pose = null;
    this.parts = [];
    this.group = new Group();
    this.group.renderOrder = 10;
    stage.scene.add(this.group);
    this._addBall();
    this.handles = new Group();
    this.group.add(this.handles);
    AXES.forEach((axis, k) => this._addArrow(axis, k));
    if (frame.turns) AXES.forEach((axis, k) => this._addRing(axis, k));
    this.selected = false;
  }

  set selected(value) {
    this.handles.visible = this._selected = value;
    this.stage.dirty = true;
  }

  get selected() {
    return this._selected;
  }

  /** Puts the handles where the pose is; with axes of the world, or of the frame. */
  place(pose, axes) {
    this.pose = pose;
    this.group.position.set(...position(pose));
    const turn = new Matrix4().set(...pose);
    turn.setPosition(0, 0, 0);
    this.handles.quaternion.copy(axes === "world" ? new Quaternion() : new Quaternion().setFromRotationMatrix(turn));
  }

  /** As large on the screen at any distance. */
  rescale() {
    const pixel = this.stage.pixel(this.group.position);
    this.group.scale.setScalar(pixel * RADIUS * (this.stage.canvas.clientWidth < 480 ? 0.8 : 1));
    this.group.updateMatrixWorld(true);
  }

  /** The handle under the pointer, or null: {gizmo, kind, axis, distance}. */
  picked(ray, touch) {
    const caster = new Raycaster();
    caster.ray.copy(ray);
    const wanted = this.parts.filter((p) => (this._selected || p.kind === "ball") && p.touch === touch);
    const hit = caster.intersectObjects(wanted.map((p) => p.grip), false)[0];
    if (!hit) return null;
    const part = wanted.find((p) => p.grip === hit.object);
    const first = part.kind === "ball" ? 0 : part.kind === "arrow" ? 1 : 2; // where grips overlap
    return { gizmo: this, kind: part.kind, axis: part.axis, rank: first, distance: hit.distance };
  }

  light(handle) {
    for (const part of this.parts) {
      const lit = handle && handle.gizmo === this && handle.kind === part.kind && handle.axis === part.axis;
      for (const mesh of part.shown) mesh.material.color.set(lit ? LIT : part.color);
    }
    this.stage.dirty = true;
  }

  /** A drag from a handle: a function from rays to poses. */
  drag(handle, ray) {
    const start = this.pose, origin = new Vector3(...position(start));
    const axis = handle.axis < 0 ? null : AXES[handle.axis].clone().applyQuaternion(this.handles.quaternion);
    if (handle.kind === "ball") return across(this.stage, start, origin, ray);
    return handle.kind === "arrow" ? along(start, origin, axis, ray) : about(this.stage, start, origin, axis, ray);
  }

  dispose() {
    this.stage.scene.remove(this.group);
  }

  _addBall() {
    const shown = [solid(new SphereGeometry(0.085, 20, 14), BALL, 0.95)];
    this._add("ball", -1, BALL, shown, [new SphereGeometry(0.16, 12, 8), new SphereGeometry(0.3, 12, 8)], this.group);
  }

  _addArrow(axis, k) {
    const shaft = solid(new CylinderGeometry(0.018, 0.018, 0.78, 10).translate(0, 0.49, 0), COLORS[k]);
    const head = solid(new ConeGeometry(0.062, 0.2, 18).translate(0, 0.97, 0), COLORS[k]);
    const grips = [0.09, 0.17].map((r) => new CylinderGeometry(r, r, 0.9, 8).translate(0, 0.64, 0));
    this._add("arrow", k, COLORS[k], [shaft, head], grips, this.handles, new Quaternion().setFromUnitVectors(AXES[1], axis));
  }

  _addRing(axis, k) {
    const ring = solid(new TorusGeometry(0.74, 0.013, 8, 72), COLORS[k], 0.85);
    const grips = [0.07, 0.14].map((r) => new TorusGeometry(0.74, r, 6, 40));
    this._add("ring", k, COLORS[k], [ring], grips, this.handles, new Quaternion().setFromUnitVectors(AXES[2], axis));
  }

  _add(kind, axis, color, shown, grips, parent, turn) {
    for (const mesh of shown) {
      mesh.renderOrder = kind === "ball" ? 12 : 11;
      if (turn) mesh.quaternion.copy(turn);
      parent.add(mesh);
    }
    grips.forEach((geometry, k) => {
      const grip = new Mesh(geometry, new MeshBasicMaterial());
      grip.visible = true;
      grip.layers.set(0);
      grip.material.visible = false;
      if (turn) grip.quaternion.copy(turn);
      parent.add(grip);
      this.parts.push({ kind, axis, color, shown, grip, touch: k === 1 });
    });
  }
}

/** The ray through a point of the canvas, in pixels of CSS. */
export function rayThrough(stage, x, y) {
  const { clientWidth: width, clientHeight: height } = stage.canvas;
  const caster = new Raycaster();
  stage.camera.updateMatrixWorld();
  caster.setFromCamera(new Vector2((2 * x) / width - 1, 1 - (2 * y) / height), stage.camera);
  return caster.ray;
}

function solid(geometry, color, opacity = 1) {
  return new Mesh(geometry, new MeshBasicMaterial({ color, transparent: true, opacity, depthTest: false, toneMapped: false }));
}

/** Across the view, with the point that was taken under the pointer. */
function across(stage, start, origin, ray) {
  const plane = new Plane().setFromNormalAndCoplanarPoint(stage.camera.getWorldDirection(new Vector3()), origin);
  const taken = ray.intersectPlane(plane, new Vector3()) || origin;
  return (now) => {
    const point = now.intersectPlane(plane, new Vector3());
    return point ? moved(start, point.sub(taken).toArray()) : null;
  };
}

/** Along an axis: the point of it that is nearest to the ray. */
function along(start, origin, axis, ray) {
  const place = (r) => {
    const b = axis.dot(r.direction), offset = r.origin.clone().sub(origin);
    if (1 - b * b < 1e-4) return null; // the axis points at the eye
    return (axis.dot(offset) - b * r.direction.dot(offset)) / (1 - b * b);
  };
  const taken = place(ray);
  return (now) => {
    const at = place(now);
    return at === null || taken === null ? null : moved(start, axis.clone().multiplyScalar(at - taken).toArray());
  };
}

/** About an axis: by the angle in the ring's plane, or by the way across the screen where the ring is seen edge-on. */
function about(stage, start, origin, axis, ray) {
  const plane = new Plane().setFromNormalAndCoplanarPoint(axis, origin);
  const view = stage.camera.getWorldDirection(new Vector3());
  const direction = unit(axis.toArray());
  if (Math.abs(view.dot(axis)) < 0.17) {
    const side = view.clone().cross(axis).normalize();
    const screen = new Plane().setFromNormalAndCoplanarPoint(view, origin);
    const taken = ray.intersectPlane(screen, new Vector3()) || origin.clone();
    const radius = 0.74 * RADIUS * stage.pixel(origin);
    return (now) => {
      const point = now.intersectPlane(screen, new Vector3());
      return point && turned(start, direction, -point.sub(taken).dot(side) / radius);
    };
  }
  const taken = ray.intersectPlane(plane, new Vector3());
  if (!taken) return () => null;
  const first = taken.sub(origin);
  return (now) => {
    const point = now.intersectPlane(plane, new Vector3());
    if (!point) return null;
    const arm = point.sub(origin);
    return turned(start, direction, Math.atan2(first.clone().cross(arm).dot(axis), first.dot(arm)));
  };
}
