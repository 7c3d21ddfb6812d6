// Written by Ulna; do not edit. The types are in the file beside this one that ends with .d.ts.

export const description = __DESCRIPTION__;

const BASE = __FREE__; // where arguments and results lie in the module's memory
const Numbers = __NUMBERS__; // the type of arrays of numbers
const UNIT_TOLERANCE = 1e-5; // on the squared length of quaternions, and of cosine and sine
const DESCENT = __DESCENT__; // steps of a descent to the nearest configuration

function describeValue(value) {
  if (value === undefined || value === null) return String(value);
  if (typeof value === "number") return `the number ${value}`;
  if (isArray(value)) return `${Array.isArray(value) ? "an array" : `a ${value.constructor.name}`} of ${value.length}`;
  return typeof value === "object" ? `an object ${value.constructor ? value.constructor.name : ""}` : `a ${typeof value}`;
}

function isArray(value) {
  return Array.isArray(value) || (ArrayBuffer.isView(value) && !(value instanceof DataView));
}

function expected(argument) {
  const { shape, unit } = argument;
  const size = argument.size;
  const numbers = shape.length === 0 ? "a number" : shape.length === 1 ? `${size} numbers` : `${size} numbers (${shape.join(" x ")}, row after row) or rows of them`;
  return numbers + (unit ? ` [${unit}]` : "");
}

// Copies a number, an array, or an array of rows to the module's memory, after all checks.
function put(memory, at, value, argument, where) {
  const flat = typeof value === "number" ? [value] : isArray(value) && Array.isArray(value[0]) ? value.flat(Infinity) : value;
  if (!isArray(flat) || flat.length !== argument.size) {
    throw new TypeError(`${where}: \`${argument.name}\` is ${describeValue(value)}; expected ${expected(argument)}.`);
  }
  for (let k = 0; k < flat.length; k++) {
    const x = flat[k];
    if (typeof x !== "number" || !Number.isFinite(x)) {
      throw new RangeError(`${where}: \`${argument.name}\`[${k}] is ${typeof x === "number" ? x : describeValue(x)}; expected a finite number.`);
    }
    memory[at + k] = x;
  }
  if (argument.unitVectors === undefined) return;
  for (const places of argument.unitVectors) {
    let squared = 0;
    for (const k of places) squared += flat[k] * flat[k];
    if (Math.abs(squared - 1) > UNIT_TOLERANCE) {
      throw new RangeError(`${where}: \`${argument.name}\`[${places[0]}] to [${places[places.length - 1]}] is no ${places.length === 4 ? "unit quaternion x, y, z, w" : "cosine and sine"}: its length is ${Math.sqrt(squared)}.`);
    }
  }
}

function receiver(out, size, where) {
  if (out === undefined || out === null) return new Numbers(size);
  if (!(out instanceof Numbers) || out.length !== size) {
    throw new TypeError(`${where}: \`out\` is ${describeValue(out)}; expected a ${Numbers.name} of ${size}.`);
  }
  return out;
}

function positive(value, name, where) {
  if (typeof value === "number" && value > 0 && value < Infinity) return value;
  throw new RangeError(`${where}: \`${name}\` is ${describeValue(value)}; expected a number above 0.`);
}

function whole(value, name, where) {
  if (Number.isInteger(value) && value > 0) return value;
  throw new RangeError(`${where}: \`${name}\` is ${describeValue(value)}; expected a whole number above 0.`);
}

function optionsOf(options, known, where) {
  for (const name of Object.keys(options ?? {})) {
    if (!known.includes(name)) {
      throw new TypeError(`${where} has no option "${name}"; its options are ${known.join(", ")}.`);
    }
  }
  return options ?? {};
}

const offset = (bytes) => (BASE + bytes) / Numbers.BYTES_PER_ELEMENT;

function method(name, f, run, memory) {
  const { inputs, outputs, at } = f;
  const places = at.map(offset);
  const pointers = at.map((bytes) => BASE + bytes);
  const [first, second, third, fourth] = pointers;
  const count = inputs.length, most = count + outputs.length;
  const call = { 2: () => run(first, second), 3: () => run(first, second, third), 4: () => run(first, second, third, fourth) }[most] ?? (() => run(...pointers));
  function result(k, out) {
    const { size, shape } = outputs[k], start = places[count + k], made = receiver(out, size, name);
    for (let i = 0; i < size; i++) made[i] = memory[start + i];
    return shape.length === 0 ? made[0] : made;
  }
  return function (...values) {
    if (values.length < count || values.length > most) {
      const names = inputs.map((a) => a.name).join(", ");
      throw new TypeError(`${name}(${names}) takes ${count} argument${count === 1 ? "" : "s"}, then arrays for its results where wanted; ${values.length} were passed.`);
    }
    for (let k = 0; k < count; k++) put(memory, places[k], values[k], inputs[k], name);
    call();
    return outputs.length === 1 ? result(0, values[count]) : outputs.map((_, k) => result(k, values[count + k]));
  };
}

function search(name, f, run, memory) {
  const [goal, start, shift, settings, result] = f.at.map(offset);
  const pointers = f.at.map((bytes) => BASE + bytes);
  const n = f.start.length, k = f.frames.length;
  const known = ["positionTolerance", "rotationTolerance", "attempts"];
  return function (T, q0, options) {
    const { positionTolerance = 1e-6, rotationTolerance = 1e-6, attempts = 400 } = optionsOf(options, known, name);
    put(memory, goal, T, f.goal, name);
    const near = q0 !== undefined && q0 !== null;
    if (near) put(memory, start, q0, f.q0, name);
    else memory.set(f.start, start);
    memory.set(f.shift, shift);
    memory[settings] = squaredLength(positive(positionTolerance, "positionTolerance", name));
    memory[settings + 1] = squaredChord(positive(rotationTolerance, "rotationTolerance", name));
    memory[settings + 2] = near ? 1 : 0;
    memory[settings + 3] = Math.ceil(whole(attempts, "attempts", name) / f.lanes) * f.meanSteps + f.attemptSteps;
    run(...pointers);
    if (memory[result + n] < -0.5) {
      throw new RangeError(`${name}: \`T\` is no pose; expected a rotation in its upper left and the last row 0, 0, 0, 1, row after row. Matrices of three.js are transposed: pass matrix.clone().transpose().elements.`);
    }
    const [iterations, attempt] = [memory[result + n + 1], memory[result + n + 2]];
    if (memory[result + n] < 0.5) { // the nearest that can be had, from where the search ended
      memory.copyWithin(start, result, result + n);
      memory[settings + 3] = -DESCENT;
      run(...pointers);
    }
    const errors = memory.slice(result + n + 3, result + n + 3 + 2 * k);
    const positionErrors = errors.filter((_, i) => i % 2 === 0), rotationErrors = errors.filter((_, i) => i % 2 === 1);
    return {
      q: memory.slice(result, result + n),
      success: memory[result + n] > 0.5,
      positionError: Math.max(...positionErrors),
      rotationError: Math.max(...rotationErrors),
      positionErrors,
      rotationErrors,
      iterations,
      attempt,
    };
  };
}

function squaredLength(metres) {
  return Math.min(metres, description.limits.length) ** 2;
}

// Angles are compared by their chords; half a turn and more is any turn.
function squaredChord(angle) {
  return (angle < Math.PI ? 2 * Math.sin(angle / 2) : description.limits.chord) ** 2;
}

class Kernels {
  constructor(instance) {
    const { memory, ...code } = instance.exports;
    const numbers = new Numbers(memory.buffer);
    this.description = description;
    for (const [name, f] of Object.entries(description.functions)) this[name] = method(name, f, code[name], numbers);
    for (const [name, f] of Object.entries(description.searches)) this[name] = search(name, f, code[name], numbers);
    Object.freeze(this);
  }
}

function checkSupport() {
  if (typeof WebAssembly !== "object") {
    throw new Error("This environment has no WebAssembly, which the functions are compiled to.");
  }
  // A function that makes a vector of zeros: a module that only engines with 128-bit SIMD accept.
  const probe = new Uint8Array([0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11]);
  if (!WebAssembly.validate(probe)) {
    throw new Error("This browser has no WebAssembly SIMD; expected Chrome 91, Edge 91, Firefox 89, Safari 16.4, node 16.4 or later.");
  }
}

async function bytesOf(source) {
  if (source instanceof WebAssembly.Module || source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return source;
  if (typeof Response === "function" && source instanceof Response) return source.arrayBuffer();
  const url = source instanceof URL ? source : new URL(String(source), import.meta.url);
  if (url.protocol === "file:" && typeof process === "object" && process.versions?.node) {
    const { readFile } = await import("node:fs/promises");
    return readFile(url);
  }
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url} cannot be read: ${answer.status} ${answer.statusText}.`);
  return answer.arrayBuffer();
}

export async function load(source = new URL("./__NAME__.wasm", import.meta.url)) {
  checkSupport();
  const content = await bytesOf(source);
  const compiled = content instanceof WebAssembly.Module ? content : await WebAssembly.compile(content);
  return new Kernels(await WebAssembly.instantiate(compiled, {}));
}

export function loadSync(source) {
  checkSupport();
  const compiled = source instanceof WebAssembly.Module ? source : new WebAssembly.Module(source);
  return new Kernels(new WebAssembly.Instance(compiled, {}));
}

export default load;
