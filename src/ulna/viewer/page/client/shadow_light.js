// One directional light casts shadows, with one shadow map that fits the scene and is drawn again only when something moved.
//
// `KEY_LIGHT` is the path of the light: a directional light whose node is in the direction of the light.
(() => {
  const page = window.__viserMutable;
  if (!page || page.ulnaSoftware !== undefined) return;
  const software = page.ulnaSoftware = /swiftshader|llvmpipe|software/i.test(renderer());
  const SIZE = software ? 1024 : 2048, STEP = Math.SQRT2;
  const SOFT = 0.007;  // width of the edge of a shadow [m], where the map is fine enough
  let lastState = "", keyLight = null;

  function renderer() {
    const gl = document.createElement("canvas").getContext("webgl2");
    const debugInfo = gl?.getExtension("WEBGL_debug_renderer_info");
    const name = debugInfo ? gl.getParameter(debugInfo.UNMASKED_RENDERER_WEBGL) : "";
    gl?.getExtension("WEBGL_lose_context")?.loseContext();
    return name;
  }

  function findKeyLight() {
    let light = null;
    page.nodeRefFromName[KEY_LIGHT]?.traverse(o => { if (o.isDirectionalLight) light = o; });
    if (light && light !== keyLight) {
      keyLight = light;
      keyLight.castShadow = true;
      keyLight.shadow.mapSize.set(SIZE, SIZE);
      keyLight.shadow.autoUpdate = false;
      lastState = "";
    }
    return light;
  }

  // Without the environment map, which takes seconds with software rendering, the hemisphere light replaces it.
  function brighten() {
    page.nodeRefFromName[SKY]?.traverse(light => {
      if (!light.isHemisphereLight || light.userData.ulna) return;
      light.userData.ulna = true;
      light.intensity *= 8.5;
      light.groundColor.lerp(light.color, 0.4);
    });
  }

  // A number that changes when any shadow caster moves, is added or removed, or changes its shape.
  let changes = 0;
  function signature(meshes) {
    let sum = meshes.length;
    for (const mesh of meshes) {
      const e = mesh.matrixWorld.elements;
      for (let i = 0; i < 16; i++) sum = (sum * 1.0000001 + e[i] * (i + 1)) % 1e9;
      sum += mesh.id + (mesh.geometry.attributes.position.version ?? 0);
      // the poses of instances are in a texture, and their common bounding sphere is reset when they move
      if (mesh.isInstancedMesh2 && (!mesh.boundingSphere || mesh.matricesTexture?._needsUpdate)) changes++;
    }
    return sum + changes;
  }

  function casters(scene) {
    const out = [], casts = o => o.isMesh && o.castShadow && o.geometry?.attributes.position;
    scene.traverseVisible(o => { if (casts(o)) out.push(o); });
    return out;
  }

  // The box in the axes of the light that contains the bounding spheres of all casters, no wider than the view.
  function fit(meshes, camera) {
    const view = keyLight.shadow.camera;
    view.position.setFromMatrixPosition(keyLight.matrixWorld);
    const target = view.position.clone().setFromMatrixPosition(keyLight.target.matrixWorld);
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
    // in steps, so that edges of shadows do not flicker while things move
    const half = Math.max(...span.map(([a, b]) => (b - a) / 2)) * 1.05;
    const size = STEP ** Math.ceil(Math.log(half) / Math.log(STEP)), sample = 2 * size / SIZE;
    const [x, y] = span.map(([a, b]) => Math.round((a + b) / 2 / sample) * sample);
    const depth = high[2] - low[2];
    const box = [x - size, x + size, y - size, y + size, -high[2] - 0.1, -low[2] + 2 * depth + 10].map(v => +v.toFixed(4));
    [view.left, view.right, view.bottom, view.top, view.near, view.far] = box;
    view.updateProjectionMatrix();
    keyLight.shadow.radius = Math.min(Math.max(SOFT / sample, 1.0), 4.0);  // in samples; the number of samples read is constant
    keyLight.shadow.normalBias = (0.5 + keyLight.shadow.radius) * sample;
    return box.join();
  }

  const updateShadow = (scene, camera) => {
    if (software) brighten();
    if (!findKeyLight()) return;
    const meshes = casters(scene), now = signature(meshes) + "," + fit(meshes, camera);
    if (now === lastState) return;
    lastState = now;
    keyLight.shadow.needsUpdate = true;
  };
  const install = () => {
    if (!page.scene) return requestAnimationFrame(install);
    const before = page.scene.onBeforeRender;
    page.scene.onBeforeRender = (gl, scene, camera, target) => {
      before?.call(page.scene, gl, scene, camera, target);
      updateShadow(scene, camera);
    };
  };
  install();
})();
