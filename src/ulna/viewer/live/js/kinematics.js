// The kernels of the robot: a WebAssembly module with its own memory; see ../kinematics.py.

import { product } from "./pose.js";

export class Kinematics {
  constructor(robot, module) {
    const { memory, ...code } = new WebAssembly.Instance(module, {}).exports;
    const { kernels } = robot;
    this.numbers = new Float64Array(memory.buffer);
    this.frames = robot.frames;
    this.nq = robot.nq;
    this.size = 16 * robot.links.length;
    this._linkPoses = this._kernel(code.link_poses, kernels.linkPoses, kernels.free);
    this._searches = kernels.searches.map(({ at, shift }, k) => ({ ...this._kernel(code[`ik_${k}`], at, kernels.free), shift }));
    this.search = kernels.search;
    this.descent = kernels.descent;
  }

  /** T_world_link of all links, 16 numbers in rows for each. */
  linkPoses(q) {
    const { run, at } = this._linkPoses;
    this.numbers.set(q, at[0]);
    run();
    return this.numbers.slice(at[1], at[1] + this.size);
  }

  /** T_world_frame of a frame that can be dragged, for poses of the links. */
  framePose(k, poses) {
    const { link, offset } = this.frames[k];
    return product(poses.subarray(16 * link, 16 * link + 16), offset);
  }

  pose(k, q) {
    return this.framePose(k, this.linkPoses(q));
  }

  /** A configuration near q0 that brings frame k to T_world_goal, or as near as it comes: {q, success}. */
  ik(k, goal, q0) {
    const { run, at, shift } = this._searches[k];
    const [T, start, from, settings, result] = at;
    this.numbers.set(goal, T);
    this.numbers.set(q0, start);
    this.numbers.set(shift, from);
    this.numbers.set(this.search, settings);
    run();
    const success = this.numbers[result + this.nq] > 0.5;
    if (!success) {
      this.numbers.copyWithin(start, result, result + this.nq);
      this.numbers.set(this.descent, settings);
      run();
    }
    return { q: Array.from(this.numbers.subarray(result, result + this.nq)), success };
  }

  /** A function of the module, and where its arguments and results lie among the numbers of its memory. */
  _kernel(run, offsets, free) {
    const pointers = offsets.map((bytes) => free + bytes);
    return { run: () => run(...pointers), at: pointers.map((bytes) => bytes / 8) };
  }
}
