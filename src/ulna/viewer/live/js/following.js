// A configuration that follows a dragged frame: nearer with each step, without jumps.
// The same rules as ulna/viewer/robot/target_following.py.

import { between, difference } from "./pose.js";

const MOST = 0.5; // the most a joint moves in one step [rad or m]
const SHARES = Array.from({ length: 9 }, (_, k) => 0.5 ** k);

/** One step from q towards a goal of a frame: {q, error: [m, rad], rests, met: the goal of the step is in reach}. */
export function followed(kinematics, frame, q, goal) {
  const start = kinematics.pose(frame, q);
  for (const share of SHARES) {
    const wanted = share === 1 ? goal : between(start, goal, share);
    const answer = kinematics.ik(frame, wanted, q);
    const size = largest(answer.q, q);
    if (size > MOST && !answer.success) continue;
    const next = size > MOST ? q.map((x, i) => x + ((answer.q[i] - x) * MOST) / size) : answer.q;
    const error = difference(kinematics.pose(frame, next), goal);
    return { q: next, error, rests: size < 1e-7, met: answer.success };
  }
  return { q, error: difference(start, goal), rests: true, met: false };
}

function largest(a, b) {
  let most = 0;
  for (let i = 0; i < a.length; i++) most = Math.max(most, Math.abs(a[i] - b[i]));
  return most;
}
