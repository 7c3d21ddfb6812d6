// What is played: a recorded motion, or the way to a named configuration.

const GLIDE = 0.7; // seconds to a named configuration

/** A recorded motion: times [s], and configurations one after the other. */
export class Motion {
  constructor(times, values, nq, quaternions) {
    Object.assign(this, { times, values, nq, quaternions });
    this.duration = times[times.length - 1];
  }

  /** The configuration at a time. */
  at(time) {
    const { times, nq, values } = this;
    let low = 0, high = times.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= time) low = middle;
      else high = middle;
    }
    const row = (k) => Array.from(values.subarray(k * nq, (k + 1) * nq));
    const width = times[high] - times[low];
    const share = width > 0 ? Math.min(Math.max((time - times[low]) / width, 0), 1) : 0;
    return mixed(row(low), row(high), share, this.quaternions);
  }
}

/** The way from one configuration to another, smooth at both ends: a function of time [s] that ends with null. */
export function glide(from, to, quaternions) {
  let began = null;
  return (now) => {
    began ??= now;
    const t = (now - began) / 1000 / GLIDE;
    if (t >= 1) return { q: to.slice(), done: true };
    return { q: mixed(from, to, t * t * t * (10 + t * (6 * t - 15)), quaternions), done: false };
  };
}

/** A configuration between two; unit quaternions stay unit quaternions. */
function mixed(a, b, share, quaternions) {
  const out = a.map((x, i) => x + share * (b[i] - x));
  for (const first of quaternions) {
    const part = [0, 1, 2, 3].map((k) => first + k);
    const sign = part.reduce((sum, i) => sum + a[i] * b[i], 0) < 0 ? -1 : 1;
    part.forEach((i) => (out[i] = a[i] + share * (sign * b[i] - a[i])));
    const length = Math.hypot(...part.map((i) => out[i])) || 1;
    part.forEach((i) => (out[i] /= length));
  }
  return out;
}
