// A robot that runs in an element: its configuration, what moves it, what is drawn.

import { aboutDialog, helpDialog } from "./dialogs.js";
import { element, iconButton } from "./dom.js";
import { Dragging } from "./dragging.js";
import { followed } from "./following.js";
import { Gizmo } from "./gizmo.js";
import { listen } from "./keyboard.js";
import { glide, Motion } from "./motion.js";
import { Panel } from "./panel.js";
import { moved, turned } from "./pose.js";
import { RangeMark, RobotView } from "./robot_view.js";
import { Stage } from "./scene.js";
import { Timeline } from "./timeline.js";

const REST = 400; // ms without progress until a goal counts as out of reach
const NARROW = 560; // pixels
const PANEL = 306; // pixels that the panel covers

export class Session {
  constructor(host, robot, kinematics, surfaces, motion) {
    Object.assign(this, { host, robot, kinematics, q: robot.start.slice(), axes: "frame", selected: 0 });
    this.goal = this.error = this.glide = this.hovered = null; // goal of the frame `aimed`
    this.met = false; // whether the goal is met as soon as the joints have moved there
    this.aimed = 0;
    this.resting = null; // since when nothing comes nearer to the goal [ms]
    this.dragged = this.moved = false;
    const label = `${robot.title} in three dimensions. Drag the handles, or use the arrow keys; question mark lists the keys.`;
    this.canvas = element("canvas", { tabindex: 0, role: "application", "aria-label": label });
    host.root.insertBefore(this.canvas, host.poster);
    this.reduced = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.stage = new Stage(this.canvas, robot.bounds, this.reduced);
    this.stage.controls.addEventListener("start", () => (this.moved = true));
    this.view = new RobotView(robot, surfaces);
    this.stage.scene.add(this.view.group);
    this.range = new RangeMark(this.stage);
    this.gizmos = robot.frames.map((frame) => new Gizmo(this.stage, frame));
    this.poses = kinematics.linkPoses(this.q);
    this._addControls(motion);
    this.select(0);
    this._show(this.q);
    const { signal } = this.ended;
    this.canvas.addEventListener("webglcontextlost", () => this._pause(), { signal });
    this.canvas.addEventListener("webglcontextrestored", () => host.restart(), { signal });
    this.observer = new ResizeObserver(() => this._layout());
    this.observer.observe(host);
    this._layout();
    this.frame = requestAnimationFrame((now) => this._tick(now));
  }

  dispose() {
    this.ended.abort();
    cancelAnimationFrame(this.frame);
    this.observer.disconnect();
    this.stage.dispose();
  }

  // controls -------------------------------------------------------------------------------------------------

  _addControls(motion) {
    const { host, robot } = this;
    const wanted = host.getAttribute("panel");
    this.panel = new Panel(robot, this._panelActions(), wanted === "closed" || (!wanted && host.clientWidth < NARROW));
    this.panel.showAxes(this.axes);
    this.help = helpDialog();
    this.about = aboutDialog(robot.credits);
    const corner = element(
      "div", { class: "corner card", role: "toolbar", "aria-label": "View" },
      iconButton("home", "First view (Home)", () => this._fit()),
      iconButton("theme", "Light or dark (T)", () => host.toggleTheme()),
      iconButton("help", "Help (?)", () => this.help.showModal()),
      iconButton("info", "Licences", () => this.about.showModal()),
    );
    host.root.append(corner, this.panel.root, this.help, this.about);
    if (motion) this._addTimeline(motion);
    else if (robot.frames.length) this._addHint();
    this.dragging = new Dragging(this.stage, this.gizmos, {
      select: (k) => this.select(k),
      start: (k) => this._startDrag(k),
      drag: (k, pose) => this._aim(k, pose),
      end: () => (this.dragged = false),
    });
    this.ended = new AbortController();
    listen(host, this.canvas, this._keyActions(), this.ended.signal);
  }

  _panelActions() {
    return {
      q: () => this.q,
      setCoordinate: (slider, value) => this.set(slider.write(this.q, value)),
      go: (q) => this.go(q),
      select: (k) => this.select(k),
      hover: (slider) => {
        this.hovered = slider;
        this._mark();
      },
      toggleUnits: () => {
        this.panel.showUnits(!this.panel.degrees);
        this._report();
      },
      toggleAxes: () => this._toggleAxes(),
      layout: () => this._layout(),
    };
  }

  _keyActions() {
    return {
      escape: () => this.dragging.cancel(),
      nudge: (way, turn, step) => this._nudge(way, turn, step),
      configuration: (k) => {
        const q = Object.values(this.robot.configurations)[k];
        if (q) this.go(q);
        return !!q;
      },
      play: () => {
        this.timeline?.toggle();
        return !!this.timeline;
      },
      next: () => this.select((this.selected + 1) % this.gizmos.length),
      axes: () => this._toggleAxes(),
      home: () => this._fit(),
      theme: () => this.host.toggleTheme(),
      panel: () => this.panel.toggle(),
      help: () => this.help.showModal(),
    };
  }

  _addTimeline(bytes) {
    const { nq, quaternions, motion: { count } } = this.robot;
    const values = new Float64Array(bytes.buffer, bytes.byteOffset, count * (1 + nq));
    const motion = new Motion(values.subarray(0, count), values.subarray(count), nq, quaternions);
    this.timeline = new Timeline(motion, (q) => {
      this.goal = this.glide = this.error = null;
      this._show(q);
    });
    this.panel.root.classList.add("with-timeline");
    this.host.root.append(this.timeline.root);
    if (this.host.hasAttribute("autoplay") && !this.reduced) this.timeline.toggle(true);
  }

  _addHint() {
    const what = this.robot.frames.length > 1 ? "the handles" : "the tool";
    this.hint = element("div", { class: "hint card" }, `Drag ${what}`);
    this.host.root.append(this.hint);
  }

  // motion ---------------------------------------------------------------------------------------------------

  pose(k = this.selected) {
    return this.kinematics.framePose(k, this.poses);
  }

  /** Sets the configuration at once. */
  set(q) {
    this._stop();
    this._show(q);
  }

  /** Moves smoothly to a configuration. */
  go(q) {
    this._stop();
    if (this.reduced) this._show(q.slice());
    else this.glide = glide(this.q, q, this.robot.quaternions);
  }

  setTarget(k, goal) {
    this.select(k);
    this._aim(k, goal);
  }

  select(k) {
    if (!this.gizmos.length) return;
    if (k !== this.selected) this.goal = this.error = null;
    this.selected = k;
    this.gizmos.forEach((gizmo, i) => (gizmo.selected = i === k));
    this.panel.select(k);
    this._place();
    this._report();
  }

  _stop() {
    this.goal = this.glide = this.error = null;
    if (this.timeline?.playing) this.timeline.toggle(false);
  }

  _startDrag(k) {
    this._stop();
    this.dragged = true;
    this._aim(k, this.gizmos[k].pose);
  }

  _aim(k, goal) {
    if (this.timeline?.playing) this.timeline.toggle(false);
    Object.assign(this, { goal, aimed: k, resting: null, glide: null });
    this.hint?.classList.add("gone");
    this._place();
  }

  _nudge(way, turn, step) {
    if (!this.gizmos.length || (turn && !this.robot.frames[this.selected].turns)) return;
    const goal = this.goal ?? this.pose();
    const [right, away] = levelDirections(this.stage.camera);
    const sum = (a, b) => right.map((_, i) => way[a] * right[i] + way[b] * away[i] + (i === 2 ? way[2] : 0));
    if (!turn) this._aim(this.selected, moved(goal, sum(0, 1).map((x) => step * x)));
    else this._aim(this.selected, turned(goal, right.map((_, i) => way[0] * away[i] - way[1] * right[i] + (i === 2 ? way[2] : 0)), step));
  }

  _tick(now) {
    this.frame = requestAnimationFrame((next) => this._tick(next));
    this.timeline?.tick(now);
    if (this.glide) {
      const { q, done } = this.glide(now);
      if (done) this.glide = null;
      this._show(q);
    } else if (this.goal) this._follow(now);
    for (const gizmo of this.gizmos) gizmo.rescale();
    if (this.stage.draw(now) && !this.canvas.classList.contains("ready")) this._ready();
  }

  _follow(now) {
    const { q, error, rests, met } = followed(this.kinematics, this.aimed, this.q, this.goal);
    this.error = error;
    this.met = met && !rests;
    if (!rests || this.resting === null) this._show(q);
    this.resting = rests ? this.resting ?? now : null;
    const reached = error[0] < 1e-5 && error[1] < 1e-4;
    if (this.dragged || !rests || (!reached && now - this.resting < REST)) return;
    this.goal = null;
    if (!reached) this.error = null; // the handles go back to the frame
    this._place();
    this._report();
  }

  /** Another configuration, with all that goes with it. */
  _show(q) {
    this.q = q;
    this.poses = this.kinematics.linkPoses(q);
    this.view.move(this.poses);
    this.stage.robotMoved();
    this._place();
    this._mark();
    this._report();
    this.host.dispatchEvent(new CustomEvent("change", { detail: { q: q.slice() } }));
  }

  /** Handles go with their frames, but for the one that has a goal. */
  _place() {
    this.gizmos.forEach((gizmo, k) => gizmo.place(this.goal && k === this.aimed ? this.goal : this.pose(k), this.axes));
    this.stage.dirty = true;
  }

  _report() {
    this.panel.update(this.q, this.gizmos.length ? this.pose() : null, this.error, this.met);
  }

  _mark() {
    this.range.show(this.hovered, this.q, this.poses);
  }

  // surroundings ---------------------------------------------------------------------------------------------

  _ready() {
    this.canvas.classList.add("ready");
    this.host.poster.classList.add("gone");
    this.host.dataset.state = "ready";
    this.host.dispatchEvent(new CustomEvent("ready"));
  }

  /** The browser has dropped the drawing: the graphics processor was reset, or too many pages draw. */
  _pause() {
    cancelAnimationFrame(this.frame);
    this.canvas.classList.remove("ready");
    this.host.pause();
  }

  _layout() {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (!width || !height) return;
    this.host.toggleAttribute("data-narrow", width < NARROW);
    this.stage.resize(width, height);
    if (!this.moved) this._fit();
  }

  _fit() {
    this.moved = false;
    const none = this.panel.closed || this.host.getAttribute("panel") === "none";
    const narrow = this.host.hasAttribute("data-narrow");
    const below = (narrow && !none ? this.panel.root.offsetHeight : 0) + (this.timeline ? 64 : 0);
    this.stage.fit({ direction: this.robot.view, aside: none || narrow ? 0 : PANEL, below });
  }

  _toggleAxes() {
    this.axes = this.axes === "world" ? "frame" : "world";
    this.panel.showAxes(this.axes);
    this._place();
  }
}

/** Directions to the right and away from the camera, level, along the nearest axes of the world. */
function levelDirections(camera) {
  const { 8: x, 9: y } = camera.matrixWorld.elements; // towards the eye
  const away = Math.abs(x) > Math.abs(y) ? [-Math.sign(x), 0, 0] : [0, -Math.sign(y), 0];
  return [[away[1], -away[0], 0], away];
}
