// Packed data of a robot: bytes from base64, surfaces from the walk of ../triangle_codes.py.

import { BufferAttribute, BufferGeometry } from "three";

const BORDER = 0, NEW = 1, NEXT = 2, PREVIOUS = 3;
const SMOOTH = Math.cos((38 * Math.PI) / 180); // edges that turn by more are drawn sharp

export function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

export async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The surfaces of packed meshes: [{link, color, geometry}]. */
export function surfacesOf(meshes, bytes) {
  const [codes, names, low, high] = cut(bytes, meshes.streams);
  const total = low.length / 3;
  const at = { code: 0, name: 0, vertex: 0 };
  const residual = (axis, k) => {
    const i = axis * total + k;
    const zigzag = low[i] | (high[2 * i] << 8) | (high[2 * i + 1] << 16);
    return zigzag & 1 ? -((zigzag + 1) >>> 1) : zigzag >>> 1;
  };
  return meshes.surfaces.map((surface) => {
    const { positions, triangles } = walked(surface, codes, names, residual, at);
    const points = Float32Array.from(positions, (x) => x * meshes.step);
    return { ...surface, geometry: shaded(points, triangles) };
  });
}

function cut(bytes, lengths) {
  let start = 0;
  return lengths.map((length) => bytes.subarray(start, (start += length)));
}

/** Positions in steps of the grid, and triangles, of one surface: the reverse of triangle_codes.walk. */
function walked(surface, codes, names, residual, at) {
  const n = surface.vertices, m = surface.triangles;
  const positions = new Int32Array(3 * n), triangles = new Uint32Array(3 * m);
  const next = new Int32Array(n).fill(-1), previous = new Int32Array(n).fill(-1), opposite = new Int32Array(n);
  const open = [];
  let count = 0, filled = 0;
  const value = (vertex, axis) => (vertex < 0 ? 0 : positions[3 * vertex + axis]);
  const met = (u, v, x) => {
    for (let axis = 0; axis < 3; axis++)
      positions[3 * count + axis] = residual(axis, at.vertex) + value(u, axis) + value(v, axis) - value(x, axis);
    at.vertex++;
    return count++;
  };
  const named = (predictor) => {
    let number = 0, shift = 0, byte;
    do {
      byte = names[at.name++];
      number |= (byte & 127) << shift;
      shift += 7;
    } while (byte & 128);
    return number === 0 ? met(predictor, predictor, predictor) : count - number;
  };
  const openEdge = (u, v, third) => {
    next[u] = v;
    previous[v] = u;
    opposite[u] = third;
    open.push(u, v);
  };
  const close = (u, v) => {
    next[u] = -1;
    if (previous[v] === u) previous[v] = -1;
  };
  const add = (u, v, w) => {
    triangles.set([u, v, w], filled);
    filled += 3;
  };
  while (filled < triangles.length) {
    const u = named(count - 1), v = named(count - 1), w = named(count - 1);
    add(u, v, w);
    openEdge(v, u, w);
    openEdge(w, v, u);
    openEdge(u, w, v);
    while (open.length) {
      const b = open.pop(), a = open.pop();
      if (next[a] !== b) continue;
      const third = opposite[a];
      close(a, b);
      const code = codes[at.code++];
      if (code === BORDER) continue;
      const c = code === NEW ? met(a, b, third) : code === NEXT ? next[b] : code === PREVIOUS ? previous[a] : named(-1);
      add(a, b, c);
      for (const [x, y, z] of [[c, a, b], [b, c, a]])
        if (next[x] === y) close(x, y);
        else openEdge(y, x, z);
    }
  }
  return { positions, triangles };
}

/** A geometry whose corners have the mean normal of the triangles around that turn by less than a crease. */
function shaded(points, triangles) {
  const m = triangles.length / 3, n = points.length / 3;
  const area = new Float32Array(3 * m), unit = new Float32Array(3 * m);
  const first = new Uint32Array(n + 1);
  for (let t = 0; t < m; t++) {
    const [a, b, c] = [3 * triangles[3 * t], 3 * triangles[3 * t + 1], 3 * triangles[3 * t + 2]];
    const ux = points[b] - points[a], uy = points[b + 1] - points[a + 1], uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a], vy = points[c + 1] - points[a + 1], vz = points[c + 2] - points[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    const length = Math.hypot(x, y, z) || 1;
    area.set([x, y, z], 3 * t);
    unit.set([x / length, y / length, z / length], 3 * t);
    for (let k = 0; k < 3; k++) first[triangles[3 * t + k] + 1]++;
  }
  for (let i = 0; i < n; i++) first[i + 1] += first[i];
  const around = new Uint32Array(3 * m), filled = first.slice();
  for (let i = 0; i < 3 * m; i++) around[filled[triangles[i]]++] = (i / 3) | 0;
  const position = new Float32Array(9 * m), normal = new Float32Array(9 * m);
  for (let i = 0; i < 3 * m; i++) {
    const vertex = triangles[i], t = 3 * ((i / 3) | 0);
    let x = 0, y = 0, z = 0;
    for (let k = first[vertex]; k < first[vertex + 1]; k++) {
      const s = 3 * around[k];
      if (unit[s] * unit[t] + unit[s + 1] * unit[t + 1] + unit[s + 2] * unit[t + 2] < SMOOTH) continue;
      x += area[s];
      y += area[s + 1];
      z += area[s + 2];
    }
    const length = Math.hypot(x, y, z) || 1;
    position.set(points.subarray(3 * vertex, 3 * vertex + 3), 3 * i);
    normal.set([x / length, y / length, z / length], 3 * i);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(position, 3));
  geometry.setAttribute("normal", new BufferAttribute(normal, 3));
  return geometry;
}
