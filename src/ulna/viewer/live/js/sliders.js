// Coordinates that sliders set: entries of a configuration, and roll, pitch, yaw of unit quaternions (x, y, z, w).

/** The sliders of a robot's description, with functions that read and write them. */
export function slidersOf(descriptions) {
  return descriptions.map((d, number) => {
    if (d.part < 0) {
      const clip = (value) => Math.min(Math.max(value, d.low), d.high);
      return { ...d, number, read: (q) => q[d.index], write: (q, value) => q.with(d.index, d.bounded ? clip(value) : value) };
    }
    return { ...d, number, read: (q) => rollPitchYaw(q, d.index)[d.part], write: (q, value) => withAngle(q, d, value) };
  });
}

function rollPitchYaw(q, first) {
  const [x, y, z, w] = q.slice(first, first + 4);
  const sine = Math.min(Math.max(2 * (w * y - z * x), -1), 1);
  return [
    Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    Math.asin(sine),
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
  ];
}

function withAngle(q, slider, value) {
  const angles = rollPitchYaw(q, slider.index);
  angles[slider.part] = Math.min(Math.max(value, slider.low), slider.high);
  const [r, p, y] = angles.map((a) => a / 2);
  const [cr, cp, cy] = [r, p, y].map(Math.cos), [sr, sp, sy] = [r, p, y].map(Math.sin);
  const turned = [
    sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy,
  ];
  const out = q.slice();
  turned.forEach((c, k) => (out[slider.index + k] = c));
  return out;
}
