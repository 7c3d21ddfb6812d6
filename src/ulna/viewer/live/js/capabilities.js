// What the browser must be able to do, and what to say where it cannot.

export class Unable extends Error {}

export function checkBrowser() {
  if (typeof DecompressionStream === "undefined" || !Array.prototype.with)
    throw new Unable("This browser is too old for this page. Browsers from 2023 on can show it: Chrome 110, Firefox 115, Safari 16.4 or newer.");
  if (typeof WebAssembly === "undefined")
    throw new Unable("This browser runs no WebAssembly, which computes the robot's kinematics here. It may be turned off in the settings, or by a lockdown mode.");
}

/** WebAssembly code as a module. */
export async function compiled(bytes) {
  if (!WebAssembly.validate(bytes))
    throw new Unable("This browser has no 128-bit SIMD in WebAssembly, which the robot's kinematics needs. Chrome 91, Firefox 89, Safari 16.4 and newer have it.");
  try {
    return await WebAssembly.compile(bytes);
  } catch (error) {
    throw new Unable(`The content security policy of this site forbids WebAssembly. It must allow script-src 'wasm-unsafe-eval'. (${error.message})`);
  }
}

export function checkWebGL() {
  if (!document.createElement("canvas").getContext("webgl2"))
    throw new Unable("This browser cannot draw the robot: WebGL 2 is missing or turned off. Hardware acceleration in the browser's settings often turns it on.");
}
