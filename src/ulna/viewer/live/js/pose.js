// Poses as 16 numbers in rows, T_world_frame, in double precision (three.js draws in single precision).

export const identity = () => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export function product(a, b) {
  const out = new Array(16).fill(0);
  for (let i = 0; i < 4; i++)
    for (let j = 0; j < 4; j++) for (let k = 0; k < 4; k++) out[4 * i + j] += a[4 * i + k] * b[4 * k + j];
  return out;
}

export const position = (T) => [T[3], T[7], T[11]];

export function moved(T, offset) {
  const out = Array.from(T);
  for (let k = 0; k < 3; k++) out[4 * k + 3] += offset[k];
  return out;
}

/** The pose after a turn about an axis of the world through its own origin. */
export function turned(T, axis, angle) {
  const R = rotation(axis, angle);
  const out = Array.from(T);
  for (let i = 0; i < 3; i++)
    for (let j = 0; j < 3; j++)
      out[4 * i + j] = R[3 * i] * T[j] + R[3 * i + 1] * T[4 + j] + R[3 * i + 2] * T[8 + j];
  return orthonormal(out);
}

function rotation([x, y, z], angle) {
  const c = Math.cos(angle), s = Math.sin(angle), v = 1 - c;
  return [
    c + x * x * v, x * y * v - z * s, x * z * v + y * s,
    y * x * v + z * s, c + y * y * v, y * z * v - x * s,
    z * x * v - y * s, z * y * v + x * s, c + z * z * v,
  ];
}

/** The same pose with axes that are unit vectors at right angles. */
function orthonormal(T) {
  const column = (j) => [T[j], T[4 + j], T[8 + j]];
  const x = unit(column(0));
  const along = dot(x, column(1));
  const y = unit(column(1).map((c, k) => c - along * x[k]));
  const z = cross(x, y);
  const out = Array.from(T);
  [x, y, z].forEach((axis, j) => axis.forEach((c, i) => (out[4 * i + j] = c)));
  return out;
}

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

export function unit(a) {
  const length = Math.hypot(...a) || 1;
  return a.map((x) => x / length);
}

/** Distance [m] and angle [rad] between two poses. */
export function difference(a, b) {
  const distance = Math.hypot(a[3] - b[3], a[7] - b[7], a[11] - b[11]);
  let trace = 0;
  for (let i = 0; i < 3; i++) for (let j = 0; j < 3; j++) trace += (a[4 * i + j] - b[4 * i + j]) ** 2;
  return [distance, 2 * Math.asin(Math.min(1, Math.sqrt(trace / 8)))];
}

/** The pose a part of the way from one to another: straight, and about one axis. */
export function between(a, b, part) {
  const R = new Array(9); // of a to b, in the world
  for (let i = 0; i < 3; i++) for (let j = 0; j < 3; j++) R[3 * i + j] = b[4 * i] * a[4 * j] + b[4 * i + 1] * a[4 * j + 1] + b[4 * i + 2] * a[4 * j + 2];
  const sine = [R[7] - R[5], R[2] - R[6], R[3] - R[1]].map((x) => x / 2);
  const angle = Math.atan2(Math.hypot(...sine), (R[0] + R[4] + R[8] - 1) / 2);
  const offset = [3, 7, 11].map((k) => part * (b[k] - a[k]));
  return moved(angle > 1e-12 && Math.hypot(...sine) > 1e-9 ? turned(a, unit(sine), part * angle) : a, offset);
}

/** Roll, pitch and yaw [rad]. */
export function angles(T) {
  const pitch = Math.atan2(-T[8], Math.hypot(T[0], T[4]));
  return [Math.atan2(T[9], T[10]), pitch, Math.atan2(T[4], T[0])];
}
