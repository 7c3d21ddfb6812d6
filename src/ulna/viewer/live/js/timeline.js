// The time line of a recorded motion: play, scrub, speed.

import { element, icon } from "./dom.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];

export class Timeline {
  constructor(motion, show) {
    Object.assign(this, { motion, show, time: 0, playing: false, last: null });
    this.button = element("button", { class: "icon", type: "button", onclick: () => this.toggle() });
    this.input = element("input", {
      type: "range", min: 0, max: motion.duration, step: "any", "aria-label": "Time",
      oninput: () => this.seek(Number(this.input.value)),
    });
    this.speed = element("select", { "aria-label": "Speed" }, ...SPEEDS.map((s) => element("option", { value: s, selected: s === 1 }, `${s}×`)));
    this.clock = element("span", { class: "clock" });
    this.root = element("div", { class: "timeline card" }, this.button, element("div", { class: "range" }, this.input), this.speed, this.clock);
    this._update();
  }

  toggle(playing = !this.playing) {
    if (playing && this.time >= this.motion.duration) this.time = 0;
    this.playing = playing;
    this.last = null;
    this._update();
    if (playing) this.show(this.motion.at(this.time));
  }

  seek(time) {
    this.playing = false;
    this.time = time;
    this.show(this.motion.at(time));
    this._update();
  }

  /** The next frame of the page, at a time in milliseconds. */
  tick(now) {
    if (!this.playing) return;
    if (this.last !== null) this.time += (Math.min(now - this.last, 250) / 1000) * Number(this.speed.value);
    this.last = now;
    if (this.time >= this.motion.duration) {
      this.time = this.motion.duration;
      this.playing = false;
    }
    this.show(this.motion.at(this.time));
    this._update();
  }

  _update() {
    const label = this.playing ? "Pause (space)" : "Play (space)";
    if (this.button.title !== label) {
      this.button.title = label;
      this.button.setAttribute("aria-label", label);
      this.button.replaceChildren(icon(this.playing ? "pause" : "play"));
    }
    this.input.value = this.time;
    this.input.style.setProperty("--a", "0%");
    this.input.style.setProperty("--b", `${(100 * this.time) / this.motion.duration}%`);
    this.clock.textContent = `${this.time.toFixed(2)} / ${this.motion.duration.toFixed(2)} s`;
  }
}
