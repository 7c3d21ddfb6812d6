// Meshes of one form are drawn at once, by a stand-in that has the places and the colours of all of them.
//
// Nodes stay what they are. What is seen of each is read before every frame: a mesh that lets light through, has a
// texture or looks different in another way is drawn by itself from that frame on.
(() => {
  const page = window.__viserMutable;
  if (!page || page.ulnaCrowds) return;
  const crowds = page.ulnaCrowds = new Map(), met = new WeakMap(), forms = new WeakMap(), FEW = 8, DYNAMIC = 35048;

  // What two meshes have in common that can be drawn at once, but for the numbers of their form; null for others.
  function sort(mesh) {
    const m = mesh.material, g = mesh.geometry, own = Object.hasOwn;
    if (!m.isMeshStandardMaterial || m.isMeshPhysicalMaterial || m.transparent || m.vertexColors) return null;
    if (mesh.isInstancedMesh || mesh.isSkinnedMesh || mesh.renderOrder || mesh.userData.words) return null;
    if (own(mesh, "onBeforeRender") || own(m, "onBeforeCompile") || Object.values(m).some(v => v?.isTexture)) return null;
    const data = Object.values(g.attributes);
    if (data.some(a => a.isInterleavedBufferAttribute) || Object.keys(g.morphAttributes).length) return null;
    if (mesh.matrixWorld.determinant() <= 0) return null;
    const looks = [m.roughness, m.metalness, m.emissive.getHex(), m.side, m.flatShading, m.depthWrite, m.depthTest];
    const sizes = [Object.keys(g.attributes), data.map(a => a.count), g.index?.count, g.drawRange.start, g.drawRange.count];
    return [...looks, ...sizes, mesh.castShadow, mesh.receiveShadow].join();
  }

  // 64 bits of all numbers of a form
  function form(geometry) {
    if (!forms.has(geometry)) {
      let a = 0x811c9dc5, b = 0x9e3779b9;
      for (const {array} of [...Object.values(geometry.attributes), geometry.index].filter(Boolean)) {
        const bytes = new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
        for (const x of bytes) {
          a = Math.imul(a ^ x, 0x01000193);
          b = Math.imul(b + x, 0x85ebca6b) ^ (b >>> 13);
        }
      }
      forms.set(geometry, `${a},${b}`);
    }
    return forms.get(geometry);
  }

  function facts(mesh) {
    const m = mesh.material, old = met.get(mesh);
    const same = old && old.material === m && old.version === m.version && old.geometry === mesh.geometry
      && old.cast === mesh.castShadow && old.receive === mesh.receiveShadow;
    if (same) return old;
    const now = {material: m, version: m.version, geometry: mesh.geometry, cast: mesh.castShadow,
      receive: mesh.receiveShadow, mask: old ? old.mask : mesh.layers.mask, sort: sort(mesh)};
    mesh.layers.mask = now.mask;
    met.set(mesh, now);
    return now;
  }

  function attribute(like, count, size) {
    const out = new like.constructor(new Float32Array(count * size), size);
    out.isInstancedBufferAttribute = true;
    out.meshPerAttribute = 1;
    return out.setUsage(DYNAMIC);
  }

  // three draws whatever says that it is an instanced mesh as one
  function standIn(mesh) {
    const kept = mesh.material.userData;
    mesh.material.userData = {};
    const material = mesh.material.clone();
    mesh.material.userData = kept;
    material.color.setRGB(1, 1, 1);
    const out = new mesh.constructor(mesh.geometry, material);
    Object.assign(out, {isInstancedMesh: true, count: 0, morphTexture: null, frustumCulled: false, matrixAutoUpdate: false,
      castShadow: mesh.castShadow, receiveShadow: mesh.receiveShadow, raycast: () => {}, userData: {ulnaCrowd: true}});
    return out;
  }

  function draw(scene, key, meshes, camera) {
    // what is near first, so that little is painted over
    const [x, y, z] = [2, 6, 10].map(i => camera.matrixWorldInverse.elements[i]);
    const near = new Map(meshes.map(mesh => {
      const e = mesh.matrixWorld.elements;
      return [mesh, x * e[12] + y * e[13] + z * e[14]];
    }));
    meshes.sort((a, b) => near.get(b) - near.get(a));
    let one = crowds.get(key);
    if (!one) {
      crowds.set(key, one = standIn(meshes[0]));
      scene.add(one);
    }
    if (!(one.instanceMatrix?.count >= meshes.length)) {
      one.dispatchEvent({type: "dispose"});  // frees what held fewer
      const like = one.geometry.attributes.position, room = 2 * meshes.length;
      one.instanceMatrix = attribute(like, room, 16);
      one.instanceColor = attribute(like, room, 3);
    }
    write(one.instanceMatrix, meshes, mesh => mesh.matrixWorld.elements);
    write(one.instanceColor, meshes, mesh => mesh.material.color.toArray());
    one.count = meshes.length;
    for (const mesh of meshes) mesh.layers.mask = 0;
  }

  function write(attribute, meshes, read) {
    const {array, itemSize} = attribute;
    let news = false, k = 0;
    for (const mesh of meshes) {
      const values = read(mesh);
      for (let i = 0; i < itemSize; i++, k++) {
        const value = Math.fround(values[i]);
        if (array[k] !== value) { array[k] = value; news = true; }
      }
    }
    if (news) attribute.needsUpdate = true;
  }

  function gather(scene, camera) {
    const sorts = new Map(), wanted = new Map();
    const put = (map, key, mesh) => map.has(key) ? map.get(key).push(mesh) : map.set(key, [mesh]);
    scene.traverseVisible(o => {
      if (!o.isMesh || o.userData.ulnaCrowd) return;
      const {sort} = facts(o);
      if (sort) put(sorts, sort, o);
    });
    for (const [sort, meshes] of sorts) {
      if (meshes.length >= FEW) for (const mesh of meshes) put(wanted, `${sort};${form(mesh.geometry)}`, mesh);
      else for (const mesh of meshes) mesh.layers.mask = met.get(mesh).mask;
    }
    for (const [key, meshes] of wanted) {
      if (meshes.length >= FEW) draw(scene, key, meshes, camera);
      else for (const mesh of meshes) mesh.layers.mask = met.get(mesh).mask;
    }
    for (const [key, one] of crowds) {
      if (wanted.get(key)?.length >= FEW) continue;
      crowds.delete(key);
      scene.remove(one);
      one.dispatchEvent({type: "dispose"});
      one.material.dispose();
    }
  }

  const install = () => {
    if (!page.scene) return requestAnimationFrame(install);
    const before = page.scene.onBeforeRender;
    page.scene.onBeforeRender = (gl, scene, camera, target) => {
      gather(scene, camera);
      before?.call(page.scene, gl, scene, camera, target);
    };
  };
  install();
})();
