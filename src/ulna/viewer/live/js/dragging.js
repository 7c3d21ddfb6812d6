// The pointer on the canvas: mouse, pen and touch drag the handles of frames; elsewhere they turn the camera.

import { rayThrough } from "./gizmo.js";

/** Listens to a canvas. `act` has `select(k)`, `start(k)`, `drag(k, pose)`, `end(k)`. */
export class Dragging {
  constructor(stage, gizmos, act) {
    Object.assign(this, { stage, gizmos, act, active: null, lit: null, fingers: new Set() }); // fingers on the background
    const { canvas } = stage;
    canvas.addEventListener("pointerdown", (event) => this._down(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this._move(event), { capture: true });
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"])
      canvas.addEventListener(name, (event) => this._up(event), { capture: true });
    canvas.addEventListener("pointerleave", () => this._light(null));
  }

  /** Ends a drag, as when Escape is pressed. */
  cancel() {
    if (!this.active) return;
    const { id, gizmo } = this.active;
    this.active = null;
    this.stage.controls.enabled = true;
    this.stage.canvas.classList.remove("dragging");
    if (this.stage.canvas.hasPointerCapture(id)) this.stage.canvas.releasePointerCapture(id);
    this._light(null);
    this.act.end(this.gizmos.indexOf(gizmo));
  }

  _down(event) {
    this.stage.canvas.classList.remove("keys");
    if (this.active) {
      event.stopImmediatePropagation(); // a second finger waits until the first is lifted
      return;
    }
    if (event.button !== 0 || event.ctrlKey || event.metaKey) return;
    const handle = this.fingers.size ? null : this._handle(event); // a second finger turns a turn into a pinch
    if (!handle) {
      if (event.pointerType === "touch") this.fingers.add(event.pointerId);
      return;
    }
    event.stopImmediatePropagation();
    event.preventDefault();
    const { canvas, controls } = this.stage;
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    canvas.classList.add("dragging");
    controls.enabled = false;
    const number = this.gizmos.indexOf(handle.gizmo);
    this.act.select(number);
    this.act.start(number);
    const pose = handle.gizmo.drag(handle, this._ray(event));
    this.active = { id: event.pointerId, gizmo: handle.gizmo, pose, number };
    this._light(handle);
  }

  _move(event) {
    if (!this.active) {
      if (event.buttons === 0) this._light(this._handle(event));
      return;
    }
    event.stopImmediatePropagation();
    if (event.pointerId !== this.active.id) return;
    const pose = this.active.pose(this._ray(event));
    if (pose) this.act.drag(this.active.number, pose);
  }

  _up(event) {
    this.fingers.delete(event.pointerId);
    if (!this.active || event.pointerId !== this.active.id) return;
    event.stopImmediatePropagation();
    this.cancel();
  }

  _handle(event) {
    const ray = this._ray(event), touch = event.pointerType === "touch";
    const found = this.gizmos.map((g) => g.picked(ray, touch)).filter(Boolean);
    return found.sort((a, b) => b.gizmo.selected - a.gizmo.selected || a.rank - b.rank || a.distance - b.distance)[0] || null;
  }

  _light(handle) {
    const key = handle && `${this.gizmos.indexOf(handle.gizmo)} ${handle.kind} ${handle.axis}`;
    if (this.lit === key) return;
    this.lit = key;
    for (const gizmo of this.gizmos) gizmo.light(handle);
    this.stage.canvas.classList.toggle("over", !!handle);
  }

  _ray(event) {
    const box = this.stage.canvas.getBoundingClientRect();
    return rayThrough(this.stage, event.clientX - box.left, event.clientY - box.top);
  }
}
