// SPDX-License-Identifier: Apache-2.0
// The 3D view: mirrors, sources, some rays and the photometric solid, in the luminaire frame (z up). Draws only when
// something changed. Data: scene3d.h.
'use strict';
(() => {
  const wait = document.querySelector('#scene3d .wait');
  if (wait) wait.textContent = 'The 3D view is being drawn.';
})();
lucerna.afterLoad(() => {
  const box = document.getElementById('scene3d'), scene = lucerna.json('scene');
  if (!box || !scene) return;
  const canvas = document.createElement('canvas');
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  } catch (error) {
    box.querySelector('.wait').textContent =
      'The 3D view needs WebGL, which this browser does not offer here. Everything else in this report is complete.';
    return;
  }
  renderer.localClippingEnabled = true;
  const radius = scene.radius_mm, centre = new THREE.Vector3(...scene.centre_mm);
  const world = new THREE.Scene(), camera = new THREE.PerspectiveCamera(32, 1, radius / 50, radius * 60);
  // The mirrors stand back from the middle of the picture, so that there is room where the light goes.
  const segments = lucerna.floats(scene.rays.position);
  let rise = 0;
  for (let i = 0; i + 5 < segments.length; i += 6) rise += segments[i + 5] - segments[i + 2];
  const ahead = new THREE.Vector3(0, 0, (rise > 0 ? 0.35 : -0.35) * radius);
  const view = { azimuth: -1.15, height: 0.18, distance: radius * 4.1, target: centre.clone().add(ahead) };
  const home = view.target.clone(), start = { ...view };
  camera.up.set(0, 0, 1);
  world.add(new THREE.HemisphereLight(0xffffff, 0x9999aa, 2.6));
  const lamp = new THREE.DirectionalLight(0xffffff, 1.6);
  world.add(lamp);

  const colourAt = (name, t, out) => out.setRGB(...lucerna.rampAt(name, t).map(v => v / 255), 'srgb');

  const layers = {};
  const layer = (id, label, object, key = '') => {
    layers[id] = { label, object, key };
    world.add(object);
  };
  const section = new THREE.Plane(new THREE.Vector3(0, 1, 0), 0);

  const triangles = ({ position, index, rings, spokes }) => {
    const geometry = new THREE.BufferGeometry(), corners = [];
    geometry.setAttribute('position', new THREE.BufferAttribute(lucerna.floats(position), 3));
    for (let r = 0; r + 1 < rings; ++r) {
      for (let s = 0; s < spokes; ++s) {
        const a = r * spokes + s, b = r * spokes + (s + 1) % spokes;
        corners.push(a, a + spokes, b, b, a + spokes, b + spokes);
      }
    }
    geometry.setIndex(new THREE.BufferAttribute(index ? lucerna.counts(index) : Uint32Array.from(corners), 1));
    return geometry;
  };
  const meshes = scene.mirrors.map(m => {
    const geometry = triangles(m), vertices = geometry.getAttribute('position').count;
    geometry.setAttribute('normal', new THREE.BufferAttribute(lucerna.floats(m.normal), 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(new Float32Array(3 * vertices).fill(1), 3));
    const material = new THREE.MeshPhongMaterial({
      vertexColors: true, side: THREE.DoubleSide, shininess: 55, specular: 0x555555, clippingPlanes: [],
    });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.userData = { name: m.name, slope: lucerna.floats(m.slope_deg), curvature: lucerna.floats(m.curvature_per_mm) };
    return mesh;
  });
  const mirrors = new THREE.Group();
  if (meshes.length) mirrors.add(...meshes);
  if (meshes.length) layer('mirrors', 'Mirrors', mirrors);

  const solids = scene.bodies.map(b => {
    const mesh = new THREE.Mesh(triangles(b), new THREE.MeshPhongMaterial({
      color: 0x8a7f73, side: THREE.DoubleSide, flatShading: true, specular: 0x222222, clippingPlanes: [],
    }));
    mesh.userData = { name: b.name };
    return mesh;
  });
  const bodies = new THREE.Group();
  if (solids.length) bodies.add(...solids);
  if (solids.length) {
    layer('bodies', scene.bodies.some(b => b.thinned) ? 'Bodies (fine meshes drawn coarser)' : 'Bodies', bodies, '#8a7f73');
  }

  // After all that is not transparent; it hides nothing.
  const panes = scene.glasses.map(g => {
    const mesh = new THREE.Mesh(triangles(g), new THREE.MeshPhongMaterial({
      color: 0x56b4e9, transparent: true, opacity: 0.22, side: THREE.DoubleSide, depthWrite: false, flatShading: true, clippingPlanes: [],
    }));
    mesh.userData = { name: g.name };
    return mesh;
  });
  const glasses = new THREE.Group();
  if (panes.length) {
    glasses.add(...panes);
    layer('glass', panes.length > 1 ? 'Glasses and lenses' : 'Glass or lens', glasses, '#56b4e9');
  }

  const points = new THREE.BufferGeometry();
  points.setAttribute('position', new THREE.BufferAttribute(lucerna.floats(scene.source.position), 3));
  layer('source', 'Source (starts of rays)', new THREE.Points(points,
    new THREE.PointsMaterial({ color: 0xf2b632, size: 3, sizeAttenuation: false })), '#f2b632');

  // Rays by reflections so far: 0, 1, 2, 3 and more.
  const rayColours = ['#e69f00', '#3f9fe0', '#009e73', '#cc79a7'];
  const rayNames = ['Rays, not reflected', 'Rays, once', 'Rays, twice', 'Rays, three times or more'];
  rayNames.forEach((name, b) => {
    const kept = [];
    scene.rays.bounces.forEach((n, i) => { if (Math.min(n, 3) === b) kept.push(...segments.subarray(6 * i, 6 * i + 6)); });
    if (!kept.length) return;
    const lines = new THREE.BufferGeometry();
    lines.setAttribute('position', new THREE.Float32BufferAttribute(kept, 3));
    layer('rays' + b, name, new THREE.LineSegments(lines, new THREE.LineBasicMaterial(
      { color: rayColours[b], transparent: true, opacity: 0.55 })), rayColours[b]);
  });

  // The photometric solid of the first far field: distance from the middle = intensity.
  const field = lucerna.fields[0];
  let peak = 0;
  if (field) {
    const spokes = 72, rings = 180, position = [], colour = [], index = [], c = new THREE.Color();
    peak = field.intensity.reduce((a, b) => Math.max(a, b), 0);
    for (let g = 0; g <= rings; ++g) {
      for (let s = 0; s < spokes; ++s) {
        const cd = lucerna.intensityAt(field, s * 360 / spokes, g * 180 / rings), r = cd / peak * radius * 1.5;
        const gamma = Math.PI * g / rings, phi = 2 * Math.PI * s / spokes;
        position.push(centre.x + r * Math.sin(gamma) * Math.cos(phi), centre.y + r * Math.sin(gamma) * Math.sin(phi),
          centre.z - r * Math.cos(gamma));
        colourAt('viridis', cd / peak, c);
        colour.push(c.r, c.g, c.b);
        const a = g * spokes + s, b = g * spokes + (s + 1) % spokes;
        if (g < rings) index.push(a, b, a + spokes, b, b + spokes, a + spokes);
      }
    }
    const solid = new THREE.BufferGeometry();
    solid.setAttribute('position', new THREE.Float32BufferAttribute(position, 3));
    solid.setAttribute('color', new THREE.Float32BufferAttribute(colour, 3));
    solid.setIndex(index);
    solid.computeVertexNormals();
    layer('solid', 'Photometric solid', new THREE.Mesh(solid, new THREE.MeshPhongMaterial(
      { vertexColors: true, side: THREE.DoubleSide, transparent: true, opacity: 0.8, specular: 0x111111 })));
    layers.solid.object.visible = false;
  }

  // x, y, z of the luminaire from the middle.
  const axes = new THREE.BufferGeometry(), tips = [], tints = [];
  [[1, 0, 0, 0xd55e00], [0, 1, 0, 0x009e73], [0, 0, 1, 0x0072b2]].forEach(([x, y, z, tint]) => {
    const t = new THREE.Color(tint);
    tips.push(centre.x, centre.y, centre.z, centre.x + x * radius, centre.y + y * radius, centre.z + z * radius);
    tints.push(t.r, t.g, t.b, t.r, t.g, t.b);
  });
  axes.setAttribute('position', new THREE.Float32BufferAttribute(tips, 3));
  axes.setAttribute('color', new THREE.Float32BufferAttribute(tints, 3));
  layer('axes', 'Axes: x red (C0), y green (C90), z blue',
    new THREE.LineSegments(axes, new THREE.LineBasicMaterial({ vertexColors: true })));
  layers.axes.object.visible = false;

  // Controls.
  const element = (tag, attributes = {}, ...children) => {
    const e = Object.assign(document.createElement(tag), attributes);
    e.append(...children);
    return e;
  };
  const show = element('fieldset', {}, element('legend', { textContent: 'Show' }));
  for (const [id, { label, object, key }] of Object.entries(layers)) {
    const tick = element('input', { type: 'checkbox', checked: object.visible, id: 'layer-' + id });
    tick.addEventListener('change', () => { object.visible = tick.checked; draw(); });
    const swatch = key ? [element('span', { className: 'key', style: `background:${key}` })] : [];
    show.append(element('label', {}, tick, ' ', ...swatch, label));
  }
  const colouring = element('select', { id: 'colouring' },
    ...[['plain', 'plain'], ['slope', 'slope'], ['curvature', 'mean curvature']]
      .map(([value, text]) => element('option', { value, textContent: text })));
  const ramp = element('div', { className: 'ramp' }), ends = element('div', { className: 'ends' });
  const cut = element('select', { id: 'cut' }, ...[['none', 'none'], ['x', 'across x'], ['y', 'across y'], ['z', 'across z']]
    .map(([value, text]) => element('option', { value, textContent: text })));
  const depth = element('input', { type: 'range', min: -100, max: 100, value: 0, id: 'depth' });
  const again = element('button', { type: 'button', textContent: 'Reset view' });
  const picture = element('button', { type: 'button', textContent: 'Save PNG' });
  const output = element('output', { className: 'cursor' });
  const hint = 'Drag to turn, wheel or pinch to zoom, Shift-drag or two fingers to move. Keys: arrows, + −, Home.';
  output.textContent = hint;
  canvas.tabIndex = 0;
  canvas.setAttribute('role', 'application');
  canvas.setAttribute('aria-label', `3D view of ${meshes.length} mirror(s)${panes.length ? ', ' + panes.length + ' glass(es) or lens(es)' : ''}, the source and ${scene.rays.count} rays. ${hint}`);
  const stage = element('div', {}, canvas, output);
  const side = element('aside', {}, show);
  side.setAttribute('aria-label', '3D view settings');
  if (meshes.length || solids.length || panes.length) {
    side.append(element('fieldset', {}, element('legend', { textContent: panes.length ? 'Mirrors, bodies and glass' : 'Mirrors and bodies' }),
      element('label', {}, 'Colour by ', colouring), ramp, ends,
      element('label', {}, 'Section ', cut), element('label', {}, 'Section at ', depth)));
  }
  side.append(element('div', { className: 'tools' }, again, picture));
  box.replaceChildren(stage, side);

  const paint = () => {
    const mode = colouring.value, name = mode === 'slope' ? 'viridis' : 'cividis';
    let low = Infinity, high = -Infinity;
    if (mode !== 'plain') {
      for (const m of meshes) for (const v of m.userData[mode]) { low = Math.min(low, v); high = Math.max(high, v); }
      // A sphere or paraboloid vertex has one value but for rounding: no colours where there is no difference.
      if (high - low < 1e-6 * Math.max(Math.abs(low), Math.abs(high))) high = low;
    }
    const c = new THREE.Color();
    for (const m of meshes) {
      const colours = m.geometry.getAttribute('color');
      for (let i = 0; i < colours.count; ++i) {
        if (mode === 'plain') c.set(0xc9ced6);
        else colourAt(name, high > low ? (m.userData[mode][i] - low) / (high - low) : 0.5, c);
        colours.setXYZ(i, c.r, c.g, c.b);
      }
      colours.needsUpdate = true;
    }
    ramp.style.background = mode === 'plain' ? 'none' : lucerna.rampCss(name);
    const unit = mode === 'slope' ? '°' : ' 1/mm';
    ends.replaceChildren(...(mode === 'plain' ? [] : [low, high].map(v => element('span', { textContent: lucerna.figure(v, 4) + unit }))));
  };
  const slice = () => {
    const on = cut.value !== 'none', at = centre.clone().addScaledVector(new THREE.Vector3(1, 1, 1), radius * depth.value / 100);
    depth.disabled = !on;
    if (on) section.setFromNormalAndCoplanarPoint(new THREE.Vector3(+(cut.value === 'x'), +(cut.value === 'y'), +(cut.value === 'z')), at);
    for (const m of [...meshes, ...solids, ...panes]) m.material.clippingPlanes = on ? [section] : [];
  };

  let size = [];
  const draw = () => {
    const width = canvas.clientWidth, height = canvas.clientHeight;
    renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    renderer.setSize(width, height, false);
    camera.aspect = width / Math.max(1, height);
    const d = view.distance * Math.max(1, 1 / camera.aspect);
    camera.position.set(Math.cos(view.azimuth) * Math.cos(view.height), Math.sin(view.azimuth) * Math.cos(view.height),
      Math.sin(view.height)).multiplyScalar(d).add(view.target);
    camera.lookAt(view.target);
    lamp.position.copy(camera.position).add(new THREE.Vector3(radius, 0, 2 * radius));
    camera.updateProjectionMatrix();
    renderer.render(world, camera);
    size = [width, height];
    canvas.dataset.drawn = Number(canvas.dataset.drawn || 0) + 1;
  };
  const turn = (across, up) => {
    view.azimuth -= across;
    view.height = Math.max(-1.55, Math.min(1.55, view.height + up));
    draw();
  };
  const zoom = factor => {
    view.distance = Math.max(radius * 0.3, Math.min(radius * 25, view.distance * factor));
    draw();
  };
  const move = (dx, dy) => {
    const scale = view.distance / canvas.clientHeight * 0.57;
    const right = new THREE.Vector3().setFromMatrixColumn(camera.matrix, 0), up = new THREE.Vector3().setFromMatrixColumn(camera.matrix, 1);
    view.target.addScaledVector(right, -dx * scale).addScaledVector(up, dy * scale);
    draw();
  };
  const reset = () => { Object.assign(view, start, { target: home.clone() }); draw(); };

  // One pointer turns, two zoom and move.
  const pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return { size: Math.hypot(a.x - b.x, a.y - b.y), x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 };
  };
  const rays = new THREE.Raycaster(), spot = new THREE.Vector2();
  const read = event => {
    const r = canvas.getBoundingClientRect();
    spot.set((event.clientX - r.left) / r.width * 2 - 1, 1 - (event.clientY - r.top) / r.height * 2);
    rays.setFromCamera(spot, camera);
    const first = objects => rays.intersectObjects(objects)
      .find(h => !h.object.material.clippingPlanes.some(p => p.distanceToPoint(h.point) < 0));
    // What is behind a glass is seen through it.
    const hit = first([...mirrors.visible ? meshes : [], ...bodies.visible ? solids : []]) || first(glasses.visible ? panes : []);
    if (!hit) { output.textContent = hint; return; }
    const { slope, curvature, name } = hit.object.userData, i = hit.face.a, p = hit.point;
    output.textContent = `${name} at (${[p.x, p.y, p.z].map(v => v.toFixed(2)).join(', ')}) mm` +
      (slope ? `: slope ${lucerna.figure(slope[i], 3)}°, mean curvature ${lucerna.figure(curvature[i], 3)} 1/mm` : '');
  };
  canvas.addEventListener('pointerdown', event => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener('pointermove', event => {
    const last = pointers.get(event.pointerId);
    if (!last) return read(event);
    const before = pointers.size === 2 && spread();
    const dx = event.clientX - last.x, dy = event.clientY - last.y;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (before) {
      const after = spread();
      zoom(before.size / Math.max(1, after.size));
      move(after.x - before.x, after.y - before.y);
    } else if (event.shiftKey || event.buttons & 2) move(dx, dy);
    else turn(dx * 0.008, dy * 0.008);
  });
  for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => pointers.delete(event.pointerId));
  canvas.addEventListener('contextmenu', event => event.preventDefault());
  // The page scrolls past the view until someone is at it.
  canvas.addEventListener('wheel', event => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    zoom(Math.exp(event.deltaY * 0.0012));
  }, { passive: false });
  canvas.addEventListener('keydown', event => {
    const act = {
      ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1),
      '+': () => zoom(0.85), '=': () => zoom(0.85), '-': () => zoom(1 / 0.85), Home: reset,
    }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
  colouring.addEventListener('change', () => { paint(); draw(); });
  for (const control of [cut, depth]) control.addEventListener('input', () => { slice(); draw(); });
  again.addEventListener('click', reset);
  picture.addEventListener('click', () => {
    draw();
    const link = element('a', { href: canvas.toDataURL('image/png'), download: 'view.png' });
    link.click();
  });
  canvas.addEventListener('webglcontextlost', event => {
    event.preventDefault();
    output.textContent = 'The 3D view lost its graphics context; reload the page to see it again.';
  });
  colouring.value = 'slope';
  cut.value = 'y';
  paint();
  slice();
  draw();
  new ResizeObserver(() => { if (size[0] !== canvas.clientWidth || size[1] !== canvas.clientHeight) draw(); }).observe(canvas);
  addEventListener('beforeprint', draw);
});
