// The element <ulna-robot>: its attributes, what scripts can ask of it, and how it starts.
// Attributes: robot (a name), theme (auto, light, dark), panel (open, closed, none), autoplay.
// Events: "ready", and "change" with the configuration in `event.detail.q`.

import { checkBrowser, checkWebGL, compiled, Unable } from "./capabilities.js";
import { element } from "./dom.js";
import { Kinematics } from "./kinematics.js";
import { cross, dot } from "./pose.js";
import { Session } from "./session.js";
import { slidersOf } from "./sliders.js";
import style from "./style.css";
import { bytesOf, inflated, surfacesOf } from "./unpack.js";

export class UlnaRobot extends HTMLElement {
  static robots = new Map();
  static waiting = new Set();
  static observedAttributes = ["theme"];

  /** Makes a robot known under its name, for all elements that ask for it. */
  static define(name, robot) {
    UlnaRobot.robots.set(name, robot);
    for (const waiting of [...UlnaRobot.waiting]) waiting._begin();
  }

  connectedCallback() {
    if (!this.root) this._build();
    if (this.robot) return; // it was moved only
    UlnaRobot.waiting.add(this);
    this._begin();
  }

  _build() {
    this.root = this.attachShadow({ mode: "open" });
    this.poster = element("div", { class: "poster" }, element("slot"));
    this.root.append(element("style", {}, style), this.poster);
    this.preference = matchMedia("(prefers-color-scheme: dark)");
    this.preference.addEventListener("change", () => this._applyTheme());
    this._applyTheme();
  }

  disconnectedCallback() {
    queueMicrotask(() => {
      if (this.isConnected) return; // it was moved only
      UlnaRobot.waiting.delete(this);
      this._end();
    });
  }

  attributeChangedCallback() {
    if (this.root) this._applyTheme();
  }

  /** The configuration: numbers in the order of the robot's joints; null until the element is ready. */
  get q() {
    return this.session ? this.session.q.slice() : null;
  }

  set q(q) {
    this._session().set(numbers("q", q, this.robot.nq));
  }

  /** Names of the frames that can be dragged. */
  get frames() {
    return this.robot ? this.robot.frames.map((f) => f.name) : [];
  }

  /** T_world_frame, 16 numbers in rows. */
  pose(frame = this.frames[0]) {
    return this._session().pose(this._number(frame));
  }

  /** Lets a frame go to T_world_goal, 16 numbers in rows, as dragging does. */
  setTarget(goal, frame = this.frames[0]) {
    this._session().setTarget(this._number(frame), poseOf(numbers("goal", goal, 16)));
  }

  /** Moves smoothly to a configuration, or to one that has a name. */
  go(q) {
    const named = typeof q === "string" ? this.robot?.configurations[q] : q;
    if (!named) throw new RangeError(`There is no configuration ${q}; there are ${Object.keys(this.robot?.configurations ?? {}).join(", ")}.`);
    this._session().go(numbers("q", named, this.robot.nq));
  }

  async _begin() {
    const name = this.getAttribute("robot") ?? UlnaRobot.robots.keys().next().value;
    const robot = UlnaRobot.robots.get(name);
    if (!robot || this.robot) return;
    UlnaRobot.waiting.delete(this);
    const begun = { ...robot, start: this.last ?? robot.start, sliders: slidersOf(robot.sliders) };
    this.robot = begun;
    try {
      checkBrowser();
      const parts = [robot.wasm, robot.meshes.data, robot.motion?.data].map((part) => part && inflated(bytesOf(part)));
      const [code, meshes, motion] = await Promise.all(parts);
      const kinematics = new Kinematics(begun, await compiled(code));
      if (this.robot !== begun) return; // it was taken out of the page
      checkWebGL();
      this.session = new Session(this, this.robot, kinematics, surfacesOf(robot.meshes, meshes), motion);
      this.session.stage.theme = this.dataset.look;
    } catch (error) {
      if (this.robot === begun) this._explain(error);
    }
  }

  /** Ends what runs; the configuration is kept for the next beginning. */
  _end() {
    this.last = this.session?.q ?? this.last;
    this.session?.dispose();
    this.session = this.robot = null;
    delete this.dataset.state;
    this.poster.classList.remove("gone");
    for (const node of [...this.root.children]) if (node.localName !== "style" && node !== this.poster) node.remove();
  }

  /** Begins again, as after the graphics processor has lost what it drew. */
  restart() {
    this._end();
    this._begin();
  }

  /** Shows the picture instead of the drawing that the browser has dropped, and how to go on. */
  pause() {
    this.poster.classList.remove("gone");
    const button = element("button", { class: "resume card", type: "button", onclick: () => this.restart() }, "Draw the robot again");
    this.root.append(button);
  }

  _explain(error) {
    if (!(error instanceof Unable)) console.error(error);
    const text = error instanceof Unable ? error.message : `The page failed: ${error.message}`;
    const title = element("h2", {}, "The robot cannot be moved here");
    this.root.append(element("div", { class: "message card", role: "alert" }, title, element("p", {}, text)));
    this.dataset.state = "failed";
  }

  toggleTheme() {
    this.setAttribute("theme", this.dataset.look === "dark" ? "light" : "dark");
  }

  _applyTheme() {
    const wanted = this.getAttribute("theme");
    const look = wanted === "light" || wanted === "dark" ? wanted : this.preference.matches ? "dark" : "light";
    this.dataset.look = look;
    if (this.session) this.session.stage.theme = look;
  }

  _session() {
    if (!this.session) throw new Error('The element is not ready; wait for its event "ready".');
    return this.session;
  }

  _number(frame) {
    const number = this.frames.indexOf(frame);
    if (number < 0) throw new RangeError(`There is no frame ${frame} to drag; there are ${this.frames.join(", ")}.`);
    return number;
  }
}

/** The pose itself, where its rotation is one to 1e-6. */
function poseOf(T) {
  const column = (j) => [T[j], T[4 + j], T[8 + j]];
  const [x, y, z] = [0, 1, 2].map(column);
  const products = [dot(x, x) - 1, dot(y, y) - 1, dot(x, y), ...cross(x, y).map((c, k) => c - z[k]), T[12], T[13], T[14], T[15] - 1];
  if (products.some((error) => Math.abs(error) > 1e-6))
    throw new RangeError("goal is no pose; expected T_world_frame, 16 numbers in rows: a rotation, the position [m], and 0, 0, 0, 1 last. three.js has columns: transpose its matrices.");
  return T;
}

function numbers(what, values, count) {
  const list = Array.from(values ?? []);
  if (list.length !== count || !list.every(Number.isFinite))
    throw new RangeError(`${what} is ${values}; expected ${count} finite numbers.`);
  return list;
}
