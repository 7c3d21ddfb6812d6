// No frame is drawn for messages that show nothing new. Where a processor draws, a heavy surface has few of its triangles
// while anything moves, and all of them in one frame when it rests.
//
// `page.ulnaChanged` says whether messages since the last request for a frame show something new; null when there were none.
(() => {
  const page = window.__viserMutable;
  const REST = 300, FRAMES = 2;  // ms and frames after the last request; viser's own end before that
  if (!page || page.ulnaChanged !== undefined) return;
  const met = new WeakSet();
  let ask = page.requestRender, asked = 0, since = 0, whole = "";
  page.ulnaChanged = null;
  const request = () => {
    const changed = page.ulnaChanged;
    page.ulnaChanged = null;
    if (changed !== false) frames();
  };
  const frames = () => {
    asked = performance.now();
    since = 0;
    whole = "";
    ask();
  };
  Object.defineProperty(page, "requestRender", {set: f => { ask = f; }, get: () => request});

  const rests = () => performance.now() > asked + REST && since >= FRAMES;
  const view = (gl, camera) => [gl.domElement.width, gl.domElement.height, ...camera.position, ...camera.quaternion,
    ...camera.projectionMatrix.elements].join();
  const sparing = gl => {
    const render = gl.render;
    gl.ulna = true;
    gl.render = (scene, camera) => {
      if (!(whole && rests() && scene === page.scene && view(gl, camera) === whole)) render.call(gl, scene, camera);
    };
  };
  const install = () => {
    if (!page.scene) return requestAnimationFrame(install);
    const before = page.scene.onBeforeRender;
    page.scene.onBeforeRender = (gl, scene, camera, target) => {
      if (page.ulnaSoftware && !gl.ulna) sparing(gl);
      const meshes = [];
      scene.traverse(o => { if (o.isMesh) meshes.push(o); });
      // viser says that a mesh throws a shadow after its first frame, and asks for no other; what is dragged throws none,
      // and is made anew in many a frame
      const lit = meshes.filter(mesh => mesh.material.isMeshStandardMaterial);
      if (!lit.every(mesh => met.has(mesh))) frames();
      lit.forEach(mesh => met.add(mesh));
      const few = page.ulnaSoftware && camera === page.camera && !rests();
      since++;
      const heavy = meshes.filter(mesh => mesh.geometry.userData.level);
      for (const mesh of heavy) mesh.visible = (mesh.geometry.userData.level === "few") === few;
      whole = heavy.length && !few && camera === page.camera ? view(gl, camera) : "";
      before?.call(page.scene, gl, scene, camera, target);
    };
  };
  install();
})();
