// How messages with poses and appearances are processed in viser's page, written for viser 1.1. Names in capitals are filled in.
//
// The page puts messages into a queue and empties it before each frame. The hook removes messages with poses and writes
// them where the page stores the newest pose of each node, so that they never accumulate. Appearances are applied to the
// materials of meshes, ten times a second for meshes that were loaded since; a node without one gets the default.
// The floor is drawn before translucent nodes: it is sorted by its centre, and would be drawn over them.
// Labels are drawn by the browser, in the fonts that it has, on a square that faces the camera.
(() => {
  document.title = TITLE;
  const page = window.__viserMutable;
  if (!page) return;
  // viser counts a tab once it has sent its camera; a busy tab sends it before the server listens, so send it again
  for (let wait = 500; wait < 4e4; wait *= 2) setTimeout(() => page.sendCamera?.(), wait);
  if (page.messageQueue.ulna) return;
  const queue = page.messageQueue, push = Array.prototype.push;
  const markChanged = changed => { page.ulnaChanged = changed || !!page.ulnaChanged; };
  const apply = ({names, p}) => {
    let changed = false;
    names.forEach((name, i) => {
      const pose = page.nodePoseData[name], k = 7 * i;
      if (!pose || pose.position.every((x, j) => x === p[k + j]) && pose.wxyz.every((x, j) => x === p[k + 3 + j])) return;
      pose.position = [p[k], p[k + 1], p[k + 2]];
      pose.wxyz = [p[k + 3], p[k + 4], p[k + 5], p[k + 6]];
      if (pose.poseUpdateState !== "waitForMakeObject") pose.poseUpdateState = "needsUpdate";
      changed = true;
    });
    return changed;
  };
  const redraw = () => {
    markChanged(true);
    page.requestRender();
  };
  page.ulnaShow = update => {
    if (!apply(update)) return;
    redraw();
  };
  // a visible tab reconnects when the program runs again, without a click
  document.hasFocus = () => document.visibilityState === "visible";
  document.addEventListener("visibilitychange", () => window.dispatchEvent(new Event("focus")));
  let requested = new Map();
  const styled = new Set(), defaultAppearance = [-1, -1, -1, 1, 1, 1, 1];
  const drawText = (mesh, words) => {
    if (mesh.userData.shownText === words) return false;
    const m = mesh.material, lines = words.split("\n"), font = "96px system-ui, sans-serif";
    const canvas = document.createElement("canvas"), pen = canvas.getContext("2d");
    const fresh = mesh.userData.shownText === undefined, height = mesh.userData.words;
    pen.font = font;
    canvas.width = Math.max(1, ...lines.map(line => Math.ceil(pen.measureText(line).width)));
    canvas.height = 120 * lines.length;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.font = font;  // setting the size of a canvas resets the font
    pen.fillStyle = "white";
    lines.forEach((line, k) => pen.fillText(line, 0, 120 * k + 96));
    const Texture = (m.map ?? m.alphaMap).constructor;
    if (!fresh) m.alphaMap.dispose();
    m.alphaMap = new Texture(canvas);
    m.alphaMap.flipY = false;
    m.alphaMap.needsUpdate = m.needsUpdate = true;
    m.map = null;
    m.toneMapped = m.depthWrite = false;
    mesh.userData.shownText = words;
    mesh.frustumCulled = false;
    mesh.onBeforeRender = (renderer, scene, camera) => {
      const p = mesh.parent.matrixWorld.elements, c = camera.matrixWorld.elements, e = mesh.matrixWorld.elements;
      const size = height * Math.hypot(p[8], p[9], p[10]), wide = size * canvas.width / 96;
      for (let i = 0; i < 3; i++) {
        e[i] = wide * c[i];
        e[4 + i] = 1.25 * size * lines.length * c[4 + i];
        e[8 + i] = c[8 + i];
        e[12 + i] = p[12 + i] - 0.25 * size * c[4 + i];
      }
    };
    return true;
  };
  const setAppearance = (name, look, words) => {
    const node = page.nodeRefFromName[name];
    if (!node) return false;
    let changed = false;
    const set = (thing, key, value) => { if (thing[key] !== value) { thing[key] = value; changed = true; } };
    if (node.scale.x !== look[4] || node.scale.y !== look[5] || node.scale.z !== look[6]) {
      node.scale.set(look[4], look[5], look[6]);
      changed = true;
    }
    node.traverse(mesh => {
      const m = mesh.material;
      if (!m || !m.color || m.isShaderMaterial) return;
      if (words !== undefined && mesh.userData.words) changed = drawText(mesh, words) || changed;
      const own = m.userData.ulna ??= {color: m.color.clone(), map: m.map, opacity: m.opacity,
        transparent: m.transparent, depthWrite: m.depthWrite, side: m.side, cast: mesh.castShadow};
      const tinted = look[0] >= 0, opacity = own.opacity * look[3], clear = opacity < 0.999;
      const color = tinted ? m.color.clone().setRGB(look[0], look[1], look[2]) : own.color;
      if (!m.color.equals(color)) { m.color.copy(color); changed = true; }
      set(m, "map", tinted ? null : own.map);
      set(m, "opacity", opacity);
      set(m, "depthWrite", own.depthWrite && !clear);
      set(m, "side", clear ? 0 : own.side);
      set(m, "transparent", own.transparent || clear);
      set(mesh, "castShadow", own.cast && !clear);
      if (changed) m.needsUpdate = true;
    });
    if (changed) redraw();
    return true;
  };
  // the background is drawn last, only where nothing else is: writing its depth is slow with software rendering
  const backdrop = () => {
    const m = page.backgroundMaterial, mesh = m && page.scene?.children.find(o => o.material === m);
    if (!mesh || m.userData.ulna) return;
    m.userData.ulna = mesh.renderOrder = 1e3;
    m.depthWrite = false;
    m.vertexShader = `
      varying vec2 at;
      void main() {
        at = uv;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        #ifdef USE_REVERSED_DEPTH_BUFFER
          gl_Position.z = 0.0;
        #else
          gl_Position.z = gl_Position.w;
        #endif
      }`;
    m.fragmentShader = `
      varying vec2 at;
      uniform sampler2D colorMap;
      uniform bool enabled;
      void main() {
        if (!enabled) discard;
        ivec2 size = textureSize(colorMap, 0);
        gl_FragColor = vec4(texelFetch(colorMap, min(ivec2(at * vec2(size)), size - 1), 0).rgb, 1.0);
      }`;
    m.needsUpdate = true;
    redraw();
  };
  const applyAppearances = () => {
    backdrop();
    page.nodeRefFromName[FLOOR]?.traverse(part => { part.renderOrder = -1; });
    requested.forEach(([look, words], name) => setAppearance(name, look, words) && styled.add(name));
    styled.forEach(name => requested.has(name) || (setAppearance(name, defaultAppearance), styled.delete(name)));
  };
  const onAppearances = ({names, v, words}) => {
    requested = new Map(names.map((name, i) => [name, [Array.from(v.slice(7 * i, 7 * i + 7)), words[name]]]));
    applyAppearances();
  };
  setInterval(applyAppearances, 100);
  Object.defineProperty(queue, "ulna", {value: true});
  Object.defineProperty(queue, "push", {value: (...messages) => {
    for (const m of messages) {
      const update = m.type === "SceneNodeUpdateMessage";
      if (update && m.name === POSES) {
        markChanged(apply(m.updates));
        page.ulnaPlayback?.record(m.updates);
      } else if (update && m.name.startsWith(MOTION)) {
        page.ulnaPlayback?.take(m.updates);
        markChanged(false);
      } else if (update && m.name === LAST) {
        page.sendMessage?.({type: "TransformControlsDragEndMessage", name: LAST, owner: ""});  // the server waits for it
        markChanged(false);
      } else if (update && m.name === APPEARANCES) {
        onAppearances(m.updates);
        markChanged(false);  // it requested a frame where it needed one
      } else {
        markChanged(true);
        push.call(queue, m.type === "EnvironmentMapMessage" && page.ulnaSoftware ? {...m, hdri_data: null} : m);
      }
    }
    return queue.length;
  }});
  queue.push(...queue.splice(0));  // messages that arrived before the hook
})();
