// One lamp of the page throws shadows, by one map that fits what is there and is drawn anew only when something moved.
//
// `KEY_LIGHT` is the path of the lamp: a directional light whose node stands where the light comes from.
(() => {
  const page = window.__viserMutable;
  if (!page || page.ulnaSoftware !== undefined) return;
  const software = page.ulnaSoftware = /swiftshader|llvmpipe|software/i.test(renderer());
  const SIZE = software ? 1024 : 2048, STEP = Math.SQRT2;
  const SOFT = 0.007;  // how wide the edge of a shadow is [m], where the map is fine enough to tell
  let known = "", lamp = null;

  function renderer() {
    const gl = document.createElement("canvas").getContext("webgl2");
    const told = gl?.getExtension("WEBGL_debug_renderer_info");
    const name = told ? gl.getParameter(told.UNMASKED_RENDERER_WEBGL) : "";
    gl?.getExtension("WEBGL_lose_context")?.loseContext();
    return name;
  }

  function found() {
    let light = null;
    page.nodeRefFromName[KEY_LIGHT]?.traverse(o => { if (o.isDirectionalLight) light = o; });
    if (light && light !== lamp) {
      lamp = light;
      lamp.castShadow = true;
      lamp.shadow.mapSize.set(SIZE, SIZE);
      lamp.shadow.autoUpdate = false;
      known = "";
    }
    return light;
  }

  // Without the room that mirrors in surfaces, which costs a processor seconds, its light comes from the sky.
  function brighten() {
    page.nodeRefFromName[SKY]?.traverse(light => {
      if (!light.isHemisphereLight || light.userData.ulna) return;
      light.userData.ulna = true;
      light.intensity *= 8.5;
      light.groundColor.lerp(light.color, 0.4);
    });
  }

  // A number that changes when anything that throws a shadow moves, comes, goes or changes its form.
  let changes = 0;
  function signature(meshes) {
    let sum = meshes.length;
    for (const mesh of meshes) {
      const e = mesh.matrixWorld.elements;
      for (let i = 0; i < 16; i++) sum = (sum * 1.0000001 + e[i] * (i + 1)) % 1e9;
      sum += mesh.id + (mesh.geometry.attributes.position.version ?? 0);
      // of copies, their places are kept in a texture, and the ball around all of them is forgotten when they move
      if (mesh.isInstancedMesh2 && (!mesh.boundingSphere || mesh.matricesTexture?._needsUpdate)) changes++;
    }
    return sum + changes;
  }

  function casters(scene) {
    const out = [], casts = o => o.isMesh && o.castShadow && o.geometry?.attributes.position;
    scene.traverseVisible(o => { if (casts(o)) out.push(o); });
    return out;
  }

  // The box in the lamp's own axes that holds all balls around what throws shadows, no wider than what is looked at.
  function fit(meshes, camera) {
    const view = lamp.shadow.camera;
    view.position.setFromMatrixPosition(lamp.matrixWorld);
    const target = view.position.clone().setFromMatrixPosition(lamp.target.matrixWorld);
    view.lookAt(target);
    view.updateMatrixWorld();
    const inverse = view.matrixWorld.clone().invert(), centre = target.clone();
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const mesh of meshes) {
      const holder = mesh.isInstancedMesh2 ? mesh : mesh.geometry;
      if (!holder.boundingSphere) holder.computeBoundingSphere();
      const ball = holder.boundingSphere;
      const radius = ball.radius * mesh.matrixWorld.getMaxScaleOnAxis();
      if (!(radius < 1e6)) continue;
      centre.copy(ball.center).applyMatrix4(mesh.matrixWorld).applyMatrix4(inverse);
      centre.toArray().forEach((x, i) => { low[i] = Math.min(low[i], x - radius); high[i] = Math.max(high[i], x + radius); });
    }
    if (!(low[0] < high[0])) return false;
    page.cameraControl ? page.cameraControl.getTarget(centre) : centre.copy(target);
    const reach = 2.0 * camera.getWorldPosition(target).distanceTo(centre);
    const middle = centre.applyMatrix4(inverse).toArray();
    const span = [0, 1].map(i => [Math.max(low[i], middle[i] - reach), Math.min(high[i], middle[i] + reach)]);
    if (span.some(([a, b]) => a >= b)) span.forEach((_, i) => { span[i] = [low[i], high[i]]; });
    // in steps, so that edges of shadows do not crawl while things move
    const half = Math.max(...span.map(([a, b]) => (b - a) / 2)) * 1.05;
    const size = STEP ** Math.ceil(Math.log(half) / Math.log(STEP)), sample = 2 * size / SIZE;
    const [x, y] = span.map(([a, b]) => Math.round((a + b) / 2 / sample) * sample);
    const depth = high[2] - low[2];
    const box = [x - size, x + size, y - size, y + size, -high[2] - 0.1, -low[2] + 2 * depth + 10].map(v => +v.toFixed(4));
    [view.left, view.right, view.bottom, view.top, view.near, view.far] = box;
    view.updateProjectionMatrix();
    lamp.shadow.radius = Math.min(Math.max(SOFT / sample, 1.0), 4.0);  // in samples; as many are read whatever it is
    lamp.shadow.normalBias = (0.5 + lamp.shadow.radius) * sample;
    return box.join();
  }

  const look = (scene, camera) => {
    if (software) brighten();
    if (!found()) return;
    const meshes = casters(scene), now = signature(meshes) + "," + fit(meshes, camera);
    if (now === known) return;
    known = now;
    lamp.shadow.needsUpdate = true;
  };
  const install = () => {
    if (!page.scene) return requestAnimationFrame(install);
    const before = page.scene.onBeforeRender;
    page.scene.onBeforeRender = (gl, scene, camera, target) => {
      before?.call(page.scene, gl, scene, camera, target);
      look(scene, camera);
    };
  };
  install();
})();
