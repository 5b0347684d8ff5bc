// SPDX-License-Identifier: Apache-2.0
// Luminance images of an embedded source model from any direction, evaluated in the page: no rays, no noise. An adaptive
// model is looked up line by line of sight (to_chart of source/adaptive/charts/support.h, then the trees); a clusters model is drawn
// triangle by triangle, each point with the directional distribution of its nearest cluster. Data: model_arrays.h.
'use strict';
lucerna.model = (() => {
  const data = lucerna.json('model');
  if (!data) return null;
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = a => a.map(x => x / Math.hypot(...a));
  const perSquareM = 1e6, twoPi = 2 * Math.PI, squareSide = Math.sqrt(Math.PI);
  const azimuth = (x, y) => (x === 0 && y === 0 ? 0 : Math.atan2(y, x));
  const wrapped = angle => angle - twoPi * Math.floor((angle + Math.PI) / twoPi);

  // The four numbers of a line (origin o, direction d, in the support's frame) and its chart: [chart, c0, c1, c2, c3].
  const square = (x, y) => {
    const r = Math.hypot(x, y), k = 4 / Math.PI;
    if (r === 0) return [0.5, 0.5];
    if (Math.abs(x) >= Math.abs(y)) {
      const a = x > 0 ? r : -r;
      return [0.5 * (a + 1), 0.5 * (a * k * Math.atan(y / x) + 1)];
    }
    const b = y > 0 ? r : -r;
    return [0.5 * (b * k * Math.atan(x / y) + 1), 0.5 * (b + 1)];
  };
  const about = (chart, c0, c1, d, u, v, polar) => {
    const x = dot(d, u), y = dot(d, v);
    if (polar) return [chart, c0, c1, Math.min(0.5, 0.5 * (x * x + y * y)), azimuth(x, y)];
    const s = square(x, y);
    return [chart, c0, c1, squareSide * s[0], squareSide * s[1]];
  };
  const faceUp = [[1, 0, 0], [0, 1, 0]], faceDown = [[1, 0, 0], [0, -1, 0]];
  const sphereTriad = n => {
    const across = Math.hypot(n[0], n[1]), c = across > 0 ? n[0] / across : 1, s = across > 0 ? n[1] / across : 0;
    return [[-s, c, 0], [-n[2] * c, -n[2] * s, across]];
  };
  const flat = (o, d, polar, round) => {
    if (Math.abs(d[2]) < 1e-6) return null;
    const t = -o[2] / d[2], x = o[0] + t * d[0], y = o[1] + t * d[1], chart = d[2] > 0 ? 0 : 1;
    if (!round) return about(chart, x, y, d, ...(chart ? faceDown : faceUp), polar);
    const r = Math.hypot(x, y), c = r > 0 ? x / r : 1, s = r > 0 ? y / r : 0;
    return about(chart, 0.5 * r * r, azimuth(x, y), d, [c, s, 0], chart ? [s, -c, 0] : [-s, c, 0], polar);
  };
  // How far along the line it last leaves what lies between the limits; null where it misses.
  const inRound = (o, d, r) => {
    const a = dot(d, d), b = dot(o, d), c = dot(o, o) - r * r;
    if (a === 0) return c <= 0 ? [-Infinity, Infinity] : null;
    const root = b * b - a * c;
    return root < 0 ? null : [(-b - Math.sqrt(root)) / a, (-b + Math.sqrt(root)) / a];
  };
  const inSlab = (o, d, h) => {
    if (d === 0) return Math.abs(o) <= h ? [-Infinity, Infinity] : null;
    const a = (-h - o) / d, b = (h - o) / d;
    return [Math.min(a, b), Math.max(a, b)];
  };
  const exit = parts => {
    if (parts.some(p => !p)) return null;
    const near = Math.max(...parts.map(p => p[0])), far = Math.min(...parts.map(p => p[1]));
    return near <= far ? far : null;
  };
  const charts = {
    plane: (o, d, s) => flat(o, d, s.polar, false),
    disk: (o, d, s) => flat(o, d, s.polar, true),
    sphere: (o, d, s) => {
      const along = dot(o, d), q = o.map((v, i) => v - along * d[i]), rest = s.radius_mm ** 2 - dot(q, q);
      if (rest < 0) return null;
      const n = unit(q.map((v, i) => v + Math.sqrt(rest) * d[i]));
      return about(0, s.radius_mm * n[2], s.radius_mm * azimuth(n[0], n[1]), d, ...sphereTriad(n), s.polar);
    },
    cylinder: (o, d, s) => {
      const half = s.half_size_mm[2], t = exit([inRound([o[0], o[1], 0], [d[0], d[1], 0], s.radius_mm), inSlab(o[2], d[2], half)]);
      if (t === null) return null;
      const p = o.map((v, i) => v + t * d[i]), rho = Math.hypot(p[0], p[1]), phi = azimuth(p[0], p[1]);
      if (half - Math.abs(p[2]) < s.radius_mm - rho) {
        return about(p[2] > 0 ? 1 : 2, 0.5 * rho * rho, phi, d, ...(p[2] > 0 ? faceUp : faceDown), s.polar);
      }
      return about(0, s.radius_mm * wrapped(phi - s.twist_per_mm * p[2]), p[2], d, [-Math.sin(phi), Math.cos(phi), 0], [0, 0, 1], s.polar);
    },
    box: (o, d, s) => {
      const t = exit([0, 1, 2].map(i => inSlab(o[i], d[i], s.half_size_mm[i])));
      if (t === null) return null;
      const p = o.map((v, i) => v + t * d[i]);
      let axis = 0, nearest = Infinity;
      for (let a = 0; a < 3; ++a) {
        const gap = Math.abs(s.half_size_mm[a] - Math.abs(p[a]));
        if (p[a] * d[a] > 0 && gap < nearest) { nearest = gap; axis = a; }
      }
      const sign = p[axis] > 0 ? 1 : -1, along = (i, v) => [0, 1, 2].map(k => (k === i ? v : 0));
      const b = (axis + 1) % 3, c = (axis + 2) % 3;
      return about(2 * axis + (sign > 0 ? 0 : 1), p[b], p[c], d, along(b, 1), along(c, sign), s.polar);
    },
    focal: (o, d, s) => {
      const along = dot(o, d), p = o.map((v, i) => v - along * d[i]), [u, v] = sphereTriad(d), x = dot(p, v), y = dot(p, u);
      const phi = azimuth(d[0], d[1]);
      return s.polar ? [0, 0.5 * (x * x + y * y), azimuth(x, y), d[2], phi] : [0, x, y, d[2], phi];
    },
    axis: (o, d, s) => {
      const across = Math.hypot(d[0], d[1]);
      if (across < 1e-6) return null;
      const c = d[0] / across, k = d[1] / across, z = o[2] - (o[0] * c + o[1] * k) / across * d[2];
      return [0, z, o[1] * c - o[0] * k, 0.5 * (Math.atan2(across, d[2]) - across * d[2]), wrapped(Math.atan2(d[1], d[0]) - s.twist_per_mm * z)];
    },
  };

  // An adaptive model: `at(o, d)` is [pdf_etendue, number of the largest part's leaf].
  const adaptive = () => {
    const layers = data.layers.map(layer => ({
      ...layer, chart: charts[layer.kind],
      charts: layer.charts.map(c => ({ ...c, trees: c.trees.map(t => ({ value: lucerna.floats(t.value), link: lucerna.counts(t.link) })) })),
    }));
    let leaves = 0;
    for (const layer of layers) for (const c of layer.charts) for (const t of c.trees) { t.first = leaves; leaves += t.value.length; }
    return (o, d) => {
      let sum = 0, most = 0, leaf = -1;
      for (const layer of layers) {
        const f = layer.world_from_support, p = [o[0] - f[9], o[1] - f[10], o[2] - f[11]];
        const axes = [f.slice(0, 3), f.slice(3, 6), f.slice(6, 9)];
        const c = layer.chart(axes.map(a => dot(p, a)), axes.map(a => dot(d, a)), layer);
        if (!c) continue;
        for (const { chart, low, high, trees } of layer.charts) {
          if (chart !== c[0] || low.some((v, i) => c[i + 1] < v || c[i + 1] > high[i])) continue;
          for (const { value, link, first } of trees) {
            let n = 0;
            while (link[n]) n += c[(link[n] & 3) + 1] >= value[n] ? link[n] >>> 2 : 1;
            sum += value[n];
            if (value[n] > most) { most = value[n]; leaf = first + n; }
          }
        }
      }
      return [sum, leaf];
    };
  };

  // direction_code of source/clusters/spherical_triangle.h.
  const directionCode = d => {
    let code = (d[0] < 0 ? 1 : 0) | (d[1] < 0 ? 2 : 0) | (d[2] < 0 ? 4 : 0), a = [1, 0, 0], b = [0, 1, 0], c = [0, 0, 1];
    const p = d.map(Math.abs), between = (x, y) => unit(x.map((v, i) => v + y[i]));
    for (let level = 0; level < 10; ++level) {
      const ab = between(a, b), bc = between(b, c), ca = between(c, a);
      if (dot(cross(ab, ca), p) > 0) { code = code << 2; b = ab; c = ca; }
      else if (dot(cross(bc, ab), p) > 0) { code = code << 2 | 1; a = ab; c = bc; }
      else if (dot(cross(ca, bc), p) > 0) { code = code << 2 | 2; a = ca; b = bc; }
      else { code = code << 2 | 3; a = bc; b = ca; c = ab; }
    }
    return code;
  };
  // A clusters model: draws all triangles into `value` and `id` (n x n, row 0 at the top).
  const clusters = () => {
    const pieces = { corner: lucerna.floats(data.pieces.corner), density: lucerna.floats(data.pieces.density), cluster: lucerna.counts(data.pieces.cluster) };
    const begin = lucerna.counts(data.clusters.leaf_begin), code = lucerna.counts(data.clusters.code), density = lucerna.floats(data.clusters.density);
    const towards = (v, wanted) => {
      let low = begin[v], high = begin[v + 1];
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (code[middle] <= wanted) low = middle; else high = middle;
      }
      return density[low];
    };
    return (d, u, w, centre, half, n, value, id) => {
      const wanted = directionCode(d), parts = new Float32Array(begin.length - 1);
      for (let v = 0; v < parts.length; ++v) parts[v] = towards(v, wanted);
      for (let t = 0; 3 * t < pieces.cluster.length; ++t) {
        const p = [0, 1, 2].map(k => [0, 1, 2].map(i => pieces.corner[9 * t + 3 * k + i] - centre[i]));
        const [a, b, c] = p.map(q => [(dot(q, u) / half + 1) * n / 2, (1 - dot(q, w) / half) * n / 2]);
        const normal = cross(p[1].map((v, i) => v - p[0][i]), p[2].map((v, i) => v - p[0][i]));
        const cosine = Math.abs(dot(normal, d)) / Math.hypot(...normal), whole = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if (!(cosine > 1e-4) || Math.abs(whole) < 1e-9) continue;
        const [x0, x1] = [Math.min(a[0], b[0], c[0]), Math.max(a[0], b[0], c[0])].map(x => Math.max(0, Math.min(n - 1, Math.floor(x))));
        const [y0, y1] = [Math.min(a[1], b[1], c[1]), Math.max(a[1], b[1], c[1])].map(y => Math.max(0, Math.min(n - 1, Math.floor(y))));
        const owners = [0, 1, 2].map(k => pieces.cluster[3 * t + k]), density3 = [0, 1, 2].map(k => pieces.density[3 * t + k]);
        for (let y = y0; y <= y1; ++y) {
          for (let x = x0; x <= x1; ++x) {
            const px = x + 0.5, py = y + 0.5;
            const v = ((px - a[0]) * (c[1] - a[1]) - (py - a[1]) * (c[0] - a[0])) / whole;
            const q = ((b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0])) / whole, s = 1 - v - q;
            if (v < 0 || q < 0 || s < 0) continue;
            // The nearest corner in space, from the shares.
            let nearest = 0, least = Infinity;
            for (let k = 0; k < 3; ++k) {
              let far = 0;
              for (let i = 0; i < 3; ++i) far += (s * p[0][i] + v * p[1][i] + q * p[2][i] - p[k][i]) ** 2;
              if (far < least) { least = far; nearest = owners[k]; }
            }
            const l = (s * density3[0] + v * density3[1] + q * density3[2]) * parts[nearest] / cosine;
            value[y * n + x] += l;
            if (l > 0) id[y * n + x] = nearest;
          }
        }
      }
    };
  };

  const look = data.layers ? adaptive() : null, drawClusters = data.pieces ? clusters() : null;
  const luminance = (origin, direction) => (look ? look(origin, direction)[0] * data.flux * perSquareM : NaN);
  // An n x n picture seen from direction d: luminances and the numbers of leaves or clusters.
  const image = (d, half, n) => {
    const pole = Math.abs(d[2]) > 0.999999, u = pole ? [0, 1, 0] : unit([-d[1], d[0], 0]), w = cross(d, u);
    const value = new Float32Array(n * n), id = new Int32Array(n * n).fill(-1), centre = data.centre_mm;
    if (look) {
      for (let y = 0; y < n; ++y) {
        for (let x = 0; x < n; ++x) {
          const a = half * (2 * (x + 0.5) / n - 1), b = half * (1 - 2 * (y + 0.5) / n);
          const [l, leaf] = look([0, 1, 2].map(i => centre[i] + a * u[i] + b * w[i]), d);
          value[y * n + x] = l;
          id[y * n + x] = leaf;
        }
      }
    } else drawClusters(d, u, w, centre, half, n, value, id);
    for (let i = 0; i < value.length; ++i) value[i] *= data.flux * perSquareM;
    return { value, id, u, w, half, n, direction: d };
  };
  return { data, luminance, image, directionCode };
})();

lucerna.afterLoad(() => {
  const figure = document.getElementById('luminance'), { model } = lucerna;
  if (!figure || !model) return;
  const part = name => figure.querySelector(name), canvas = part('canvas'), context = canvas.getContext('2d');
  const output = part('output.cursor'), stage = part('.stage'), size = canvas.width;
  const { data } = model, start = { azimuth: data.from_deg[0], height: data.from_deg[1], half: data.radius_mm * 1.5 };
  const view = { ...start };
  let drawn = null, cursor = null;
  const direction = () => {
    const a = view.azimuth * Math.PI / 180, h = view.height * Math.PI / 180;
    return [Math.cos(a) * Math.cos(h), Math.sin(a) * Math.cos(h), Math.sin(h)].map(v => (Math.abs(v) < 1e-12 ? 0 : v));
  };
  const range = () => {
    if (!part('.own').checked) return data.peak;
    return drawn.value.reduce((a, b) => Math.max(a, b), 0) || data.peak;
  };
  const paint = () => {
    const { value, id, n } = drawn, picture = context.createImageData(n, n), table = lucerna.rampTable(part('.colours').value);
    const high = range(), log = part('.log').checked, borders = part('.borders').checked;
    for (let i = 0; i < n * n; ++i) {
      const share = high > 0 ? value[i] / high : 0, t = log ? 1 + Math.log10(Math.max(share, 1e-4)) / 4 : share;
      const k = 3 * Math.round(255 * Math.max(0, Math.min(1, t)));
      picture.data.set([table[k], table[k + 1], table[k + 2], 255], 4 * i);
      if (borders && i % n < n - 1 && i < n * (n - 1) && (id[i] !== id[i + 1] || id[i] !== id[i + n])) {
        picture.data.set(t > 0.6 ? [20, 20, 20, 255] : [235, 235, 235, 255], 4 * i);
      }
    }
    const small = Object.assign(document.createElement('canvas'), { width: n, height: n });
    small.getContext('2d').putImageData(picture, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(small, 0, 0, size, size);
    // A bar of a round length.
    const raw = drawn.half / 2, power = 10 ** Math.floor(Math.log10(raw)), step = [5, 2, 1].map(f => f * power).find(v => v <= raw);
    const length = step / drawn.half * size / 2;
    context.fillStyle = 'rgba(0,0,0,.6)';
    context.fillRect(12, size - 40, Math.max(length, 60) + 16, 30);
    context.fillStyle = '#fff';
    context.fillRect(20, size - 18, length, 3);
    context.font = '13px system-ui, "DejaVu Sans", sans-serif';
    context.fillText(`${lucerna.plain(step)} mm`, 20, size - 24);
    part('.ramp').style.background = lucerna.rampCss(part('.colours').value);
    const ends = log ? [1e-4, 1e-3, 1e-2, 0.1, 1] : [0, 0.25, 0.5, 0.75, 1];
    part('.ends').replaceChildren(...ends.map(share => Object.assign(document.createElement('span'),
      { textContent: lucerna.figure(share * high, 3) + (share === 1 ? ' ' + data.unit : '') })));
    canvas.dataset.drawn = Number(canvas.dataset.drawn || 0) + 1;
  };
  const say = () => {
    const named = `${view.azimuth} ${view.height}`, from = part('.from');
    from.value = [...from.options].some(o => o.value === named) ? named : '';
    const where = `from azimuth ${lucerna.plain(view.azimuth)}°, ${lucerna.plain(view.height)}° above the xy plane`;
    if (!cursor) { output.textContent = `Seen ${where}. Drag to turn, wheel or + − to zoom, arrows to turn.`; return; }
    const { n, half, value } = drawn, [x, y] = cursor, i = Math.min(n - 1, Math.floor(y * n)) * n + Math.min(n - 1, Math.floor(x * n));
    output.textContent = `${lucerna.figure(half * (2 * x - 1), 3)} mm across, ${lucerna.figure(half * (1 - 2 * y), 3)} mm up: ` +
      `${lucerna.figure(value[i])} ${data.unit}, ${where}`;
  };
  // Coarse while it turns, fine when it rests.
  let timer = 0;
  const render = fine => {
    drawn = model.image(direction(), view.half, fine ? size / 2 : 96);
    paint();
    say();
  };
  const draw = (fine = false) => {
    clearTimeout(timer);
    render(fine);
    if (!fine) timer = setTimeout(() => render(true), 150);
  };
  const sliders = [part('.azimuth'), part('.height')];
  const turn = (across, up) => {
    view.azimuth = 180 - (((180 - Math.round(view.azimuth + across)) % 360) + 360) % 360;
    view.height = Math.max(-90, Math.min(90, Math.round(view.height + up)));
    sliders[0].value = view.azimuth;
    sliders[1].value = view.height;
    draw();
  };
  const zoom = factor => { view.half = Math.max(data.radius_mm / 50, Math.min(data.radius_mm * 20, view.half * factor)); draw(); };
  sliders[0].addEventListener('input', () => { view.azimuth = Number(sliders[0].value); draw(); });
  sliders[1].addEventListener('input', () => { view.height = Number(sliders[1].value); draw(); });
  for (const name of ['.colours', '.log', '.own', '.borders']) part(name).addEventListener('input', paint);
  part('.from').addEventListener('input', event => {
    if (!event.target.value) return;
    const [azimuth, height] = event.target.value.split(' ').map(Number);
    Object.assign(view, { azimuth, height });
    turn(0, 0);
  });
  part('.again').addEventListener('click', () => { Object.assign(view, start); turn(0, 0); });
  const last = new Map();
  const spread = () => { const [a, b] = [...last.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
  canvas.addEventListener('pointerdown', event => { canvas.setPointerCapture(event.pointerId); last.set(event.pointerId, [event.clientX, event.clientY]); });
  canvas.addEventListener('pointermove', event => {
    const box = canvas.getBoundingClientRect(), before = last.get(event.pointerId);
    if (!before) {
      cursor = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
      say();
      return;
    }
    const wide = last.size === 2 && spread();
    last.set(event.pointerId, [event.clientX, event.clientY]);
    if (wide) zoom(wide / Math.max(1, spread()));
    else turn(-(event.clientX - before[0]) * 0.5, (event.clientY - before[1]) * 0.5);
  });
  for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => last.delete(event.pointerId));
  canvas.addEventListener('pointerleave', () => { cursor = null; say(); });
  canvas.addEventListener('wheel', event => {
    if (document.activeElement !== stage && !event.ctrlKey) return;
    event.preventDefault();
    zoom(Math.exp(event.deltaY * 0.0012));
  }, { passive: false });
  stage.addEventListener('keydown', event => {
    const act = {
      ArrowLeft: () => turn(-5, 0), ArrowRight: () => turn(5, 0), ArrowUp: () => turn(0, 5), ArrowDown: () => turn(0, -5),
      '+': () => zoom(0.85), '=': () => zoom(0.85), '-': () => zoom(1 / 0.85),
    }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
  lucerna.savesCanvas(figure, canvas, () => {
    const { value, n, half } = drawn, lines = [`x_mm,y_mm,"${data.unit}"`];
    for (let i = 0; i < n * n; ++i) {
      lines.push([half * (2 * (i % n + 0.5) / n - 1), half * (1 - 2 * (Math.floor(i / n) + 0.5) / n), value[i]].map(lucerna.plain).join(','));
    }
    return lines.join('\n') + '\n';
  });
  document.addEventListener('lucerna-theme', paint);
  draw();
});
