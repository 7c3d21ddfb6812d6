// The panel: named configurations, a slider for each coordinate with its limits, the pose of the selected frame.

import { element, icon, iconButton } from "./dom.js";
import { angles, position } from "./pose.js";

const NEAR = 0.03; // of the range: where a slider warns of its limit
const FEW = 12; // sliders that are shown without groups

/** Controls of one robot. `act` has what they do: setCoordinate, go, select, hover, toggleUnits ... */
export class Panel {
  constructor(robot, act, closed) {
    Object.assign(this, { robot, act, degrees: true, rows: [] });
    this.body = element("div", { class: "body" });
    this.fold = iconButton("fold", "Hide the panel (P)", () => this.toggle());
    const joints = `${robot.joints} joint${robot.joints === 1 ? "" : "s"}`;
    this.root = element(
      "section", { class: "panel card", "aria-label": `Controls of ${robot.title}` },
      element("header", {},
        element("div", { class: "name" }, element("h2", { title: robot.title }, robot.title), element("div", { class: "about" }, joints)),
        this.fold),
      this.body,
    );
    this._addConfigurations();
    this._addFrames();
    this._addSliders();
    if (closed) this._fold(true);
  }

  get closed() {
    return this.root.classList.contains("closed");
  }

  toggle() {
    this._fold(!this.closed);
    this.act.layout();
  }

  _fold(closed) {
    this.root.classList.toggle("closed", closed);
    const label = closed ? "Show the panel (P)" : "Hide the panel (P)";
    this.fold.replaceChildren(icon(closed ? "panel" : "fold"));
    this.fold.title = label;
    this.fold.setAttribute("aria-label", label);
    this.fold.setAttribute("aria-expanded", String(!closed));
  }

  /** Shows a configuration, the pose of the selected frame, and how far it is from its goal. */
  update(q, pose, error, met) {
    for (const row of this.rows) this._show(row, row.slider.read(q));
    this.chips?.forEach(([chip, named]) => {
      const same = named.every((x, i) => Math.abs(x - q[i]) < 1e-4);
      if (chip.getAttribute("aria-pressed") !== String(same)) chip.setAttribute("aria-pressed", String(same));
    });
    if (pose && this.cells) this._showPose(pose, error, met);
  }

  /** The row of the frame's joints is opened, its chip pressed. */
  select(frame) {
    this.frameChips?.forEach((chip, k) => chip.setAttribute("aria-pressed", String(k === frame)));
    if (this.groups)
      for (const { details, frames } of this.groups) if (frames.includes(frame)) details.open = true;
  }

  _addConfigurations() {
    const names = Object.entries(this.robot.configurations);
    if (!names.length) return;
    this.chips = names.map(([name, q]) => [
      element("button", { class: "chip", type: "button", "aria-pressed": "false", onclick: () => this.act.go(q) }, name), q,
    ]);
    this.body.append(section("Configurations", null, element("div", { class: "chips" }, ...this.chips.map(([chip]) => chip))));
  }

  _addFrames() {
    const { frames } = this.robot;
    if (!frames.length) return;
    this.axes = element("button", { class: "toggle", type: "button", title: "Axes of the arrows (W)", onclick: () => this.act.toggleAxes() });
    this.cells = ["x", "y", "z", "roll", "pitch", "yaw"].map((name) => {
      const value = element("span");
      return [value, element("div", {}, element("small", {}, name), value)];
    });
    this.status = element("div", { class: "status", role: "status" });
    const chips = frames.map((frame, k) =>
      element("button", { class: "chip", type: "button", "aria-pressed": "false", title: frame.name, onclick: () => this.act.select(k) }, frame.name));
    if (frames.length > 1) this.frameChips = chips;
    const pose = element("div", { class: "pose" }, ...this.cells.map(([, cell]) => cell));
    const title = frames.length > 1 ? "Frames" : frames[0].name;
    const list = frames.length > 1 ? element("div", { class: "chips", style: "margin-bottom:8px" }, ...chips) : null;
    const right = element("span", { class: "right" }, this.axes);
    this.body.append(section(title, right, list, pose, this.status));
  }

  _addSliders() {
    const { sliders } = this.robot;
    if (!sliders.length) return;
    this.units = element("button", { class: "toggle", type: "button", title: "Degrees or radians", onclick: () => this.act.toggleUnits() });
    const right = element("span", { class: "right" }, this.units);
    const names = [...new Set(sliders.map((s) => s.group))];
    const rows = (group) => sliders.filter((s) => group === null || s.group === group).map((s) => this._row(s));
    if (sliders.length <= FEW || names.length < 2) {
      this.body.append(section("Joints", right, ...rows(null)));
    } else {
      this.groups = names.map((name) => {
        const details = element("details", {}, element("summary", {}, name), ...rows(name));
        const mine = sliders.filter((s) => s.group === name).map((s) => s.index);
        const frames = this.robot.frames.flatMap((f, k) => (f.moves.some((i) => mine.includes(i)) ? [k] : []));
        return { details, frames };
      });
      this.body.append(section("Joints", right, ...this.groups.map((g) => g.details)));
    }
    this._showUnits();
  }

  _row(slider) {
    const set = (value) => this.act.setCoordinate(slider, value);
    const id = `slider-${slider.number}`;
    const input = element("input", {
      type: "range", id, min: slider.low, max: slider.high, step: "any", title: slider.hint,
      oninput: () => set(Number(input.value)),
      onkeydown: (event) => {
        const way = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
        if (!way) return;
        event.preventDefault();
        const step = slider.angle ? (Math.PI / 180) * (event.shiftKey ? 0.1 : 1) : (slider.high - slider.low) / (event.shiftKey ? 1000 : 100);
        set(slider.read(this.act.q()) + way * step);
      },
    });
    const value = element("input", {
      class: "value", inputmode: "decimal", "aria-label": `Value of ${slider.label}`,
      onchange: () => {
        const number = Number(value.value.replace(",", ".").replace(/[^\d.eE+-]/g, ""));
        if (value.value.trim() && Number.isFinite(number)) set(number / this._scale(slider));
        row.shown = null;
        this._show(row, slider.read(this.act.q()));
      },
      onkeydown: (event) => event.key === "Enter" && value.blur(),
      onfocus: () => value.select(),
    });
    const ends = [element("span", { class: "end" }), element("span", { class: "end" })];
    const root = element(
      "div", {
        class: "joint", onpointerenter: () => this.act.hover(slider), onpointerleave: () => this.act.hover(null),
        onfocusin: () => this.act.hover(slider), onfocusout: () => this.act.hover(null),
      },
      element("label", { for: id, title: slider.hint }, slider.label),
      element("div", { class: "range" }, input, ...ends), value,
    );
    const row = { slider, input, value, root, ends, shown: null };
    this.rows.push(row);
    return root;
  }

  _show(row, x) {
    const { slider, input, root, value } = row;
    if (row.shown === x) return;
    row.shown = x;
    input.value = x;
    const width = slider.high - slider.low;
    const part = (v) => 100 * Math.min(Math.max((v - slider.low) / width, 0), 1);
    const zero = part(Math.min(Math.max(0, slider.low), slider.high)), here = part(x);
    input.style.setProperty("--a", `${Math.min(zero, here)}%`);
    input.style.setProperty("--b", `${Math.max(zero, here)}%`);
    const room = slider.bounded ? Math.min(x - slider.low, slider.high - x) : Infinity;
    root.classList.toggle("limit", room <= 1e-6 * width);
    root.classList.toggle("near", room > 1e-6 * width && room < NEAR * width);
    if (this.root.getRootNode().activeElement !== value) value.value = this._text(slider, x);
    input.setAttribute("aria-valuetext", this._text(slider, x) + (room <= 1e-6 * width ? ", at its limit" : ""));
  }

  _scale(slider) {
    return slider.angle && this.degrees ? 180 / Math.PI : slider.angle ? 1 : 1000;
  }

  _text(slider, x, digits = null) {
    const scaled = x * this._scale(slider);
    const places = digits ?? (slider.angle && !this.degrees ? 3 : 1);
    const text = (Math.abs(scaled) < 0.5 * 10 ** -places ? 0 : scaled).toFixed(places).replace("-", "\u2212");
    return slider.angle ? (this.degrees ? `${text}°` : text) : `${text} mm`;
  }

  /** Degrees or radians. */
  showUnits(degrees) {
    this.degrees = degrees;
    this._showUnits();
  }

  _showUnits() {
    if (!this.units) return;
    this.units.textContent = this.degrees ? "degrees" : "radians";
    for (const row of this.rows) {
      row.shown = null;
      const { slider, ends } = row;
      const digits = slider.angle && !this.degrees ? 2 : 0;
      ends[0].textContent = slider.bounded ? this._text(slider, slider.low, digits) : "";
      ends[1].textContent = slider.bounded ? this._text(slider, slider.high, digits) : "";
    }
  }

  showAxes(axes) {
    if (this.axes) this.axes.textContent = axes === "world" ? "world axes" : "frame axes";
  }

  _showPose(pose, error, met) {
    const place = position(pose).map((x) => `${fixed(1000 * x, 1)} mm`);
    const turn = angles(pose).map((x) => `${fixed((180 / Math.PI) * x, 1)}°`);
    [...place, ...turn].forEach((text, k) => {
      if (this.cells[k][0].textContent !== text) this.cells[k][0].textContent = text;
    });
    const [distance, angle] = error || [0, 0];
    const far = distance > 1e-5 || angle > 1e-4;
    const parts = [distance > 1e-5 && `${fixed(1000 * distance, 1)} mm`, angle > 1e-3 && `${fixed((180 / Math.PI) * angle, 1)}°`];
    const text = !error ? "" : !far ? "On the target" : met ? "On the way" : `Out of reach: ${parts.filter(Boolean).join(" and ")} short`;
    if (this.status.textContent !== text) this.status.textContent = text;
    this.status.classList.toggle("warn", far && !met);
  }
}

function fixed(x, places) {
  return (Math.abs(x) < 0.5 * 10 ** -places ? 0 : x).toFixed(places).replace("-", "\u2212");
}

function section(title, right, ...content) {
  return element("div", { class: "section" }, element("h3", {}, title, right), ...content.filter((c) => c));
}
