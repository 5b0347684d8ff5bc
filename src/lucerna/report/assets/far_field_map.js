// SPDX-License-Identifier: Apache-2.0
// The far field in false colours with lines of equal intensity, drawn in the page: gamma outward from the middle, C
// around it (C0 to the right, C90 up). Distances are true along the radii (azimuthal equidistant projection).
'use strict';
for (const figure of document.querySelectorAll('figure.map')) {
  const field = lucerna.fields[Number(figure.dataset.detector)];
  const canvas = figure.querySelector('canvas'), context = canvas.getContext('2d');
  const output = figure.querySelector('output.cursor'), stage = figure.querySelector('.stage');
  const [reach, colours, log] = ['.reach', '.colours', '.log'].map(name => figure.querySelector(name));
  const size = canvas.width, middle = size / 2, radius = middle - 42;
  const peak = field.intensity.reduce((a, b) => Math.max(a, b), 0);
  const shares = [0.01, 0.03, 0.1, 0.3, 0.5, 0.7, 0.9];

  // About nadir, or zenith if more flux goes up; first out to where 3 % of the maximum ends.
  const rings = field.gamma_deg.map((g, k) => {
    const values = field.c_deg.map((_, i) => field.intensity[i * field.gamma_deg.length + k]);
    return { gamma: g, flux: values.reduce((a, b) => a + b) * Math.sin(g * Math.PI / 180), peak: Math.max(...values) };
  });
  const total = kept => rings.filter(kept).reduce((sum, ring) => sum + ring.flux, 0);
  const up = total(r => r.gamma < 90) < total(r => r.gamma > 90), around = r => (up ? 180 - r : r);
  const edge = Math.max(0, ...rings.filter(r => r.peak >= 0.03 * peak).map(r => around(r.gamma)));
  const choices = [5, 10, 20, 30, 45, 60, 90, 180], first = choices.find(r => r >= edge) || 180;
  for (const r of choices) reach.append(new Option(`${r}°`, r, r === first, r === first));

  const tone = cd => {
    const share = peak > 0 ? cd / peak : 0;
    return log.checked ? 1 + Math.log10(Math.max(share, 1e-3)) / 3 : share;
  };
  const at = (x, y) => {
    const dx = x - middle, dy = middle - y, r = Math.hypot(dx, dy) / radius * Number(reach.value);
    const c = Math.atan2(dy, dx) * 180 / Math.PI;
    return r <= Number(reach.value) ? [c < 0 ? c + 360 : c, around(r)] : null;
  };
  const labels = () => {
    const style = getComputedStyle(document.documentElement), text = style.getPropertyValue('--text');
    context.font = '13px system-ui, "DejaVu Sans", sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    for (let i = 1; i <= 4; ++i) {
      context.strokeStyle = i === 4 ? style.getPropertyValue('--quiet') : 'rgba(255,255,255,.35)';
      context.beginPath();
      context.arc(middle, middle, radius * i / 4, 0, 2 * Math.PI);
      context.stroke();
      const y = middle + radius * i / 4 - 11;
      context.fillStyle = 'rgba(0,0,0,.55)';
      context.fillRect(middle - 21, y - 9, 42, 18);
      context.fillStyle = '#fff';
      context.fillText(`${lucerna.plain(around(Number(reach.value) * i / 4))}°`, middle, y);
    }
    context.fillStyle = text;
    context.textAlign = 'center';
    const edge = radius + 21;
    [[1, 0], [0, -1], [-1, 0], [0, 1]].forEach(([x, y], i) => context.fillText(`C${90 * i}`, middle + x * edge, middle + y * edge));
  };
  const draw = () => {
    const image = context.createImageData(size, size), levels = new Int8Array(size * size).fill(-1);
    const tones = new Float32Array(size * size);
    for (let y = 0; y < size; ++y) {
      for (let x = 0; x < size; ++x) {
        const where = at(x + 0.5, y + 0.5);
        if (!where) continue;
        const cd = lucerna.intensityAt(field, ...where), i = y * size + x;
        levels[i] = shares.filter(s => cd >= s * peak).length;
        tones[i] = tone(cd);
        const [r, g, b] = lucerna.rampAt(colours.value, tones[i]);
        image.data.set([r, g, b, 255], 4 * i);
      }
    }
    for (let i = 0; i < size * (size - 1) - 1; ++i) {
      if (levels[i] < 0 || (levels[i] === levels[i + 1] && levels[i] === levels[i + size])) continue;
      if (levels[i + 1] < 0 || levels[i + size] < 0) continue;
      image.data.set(tones[i] > 0.55 ? [0, 0, 0, 255] : [255, 255, 255, 255], 4 * i);
    }
    context.clearRect(0, 0, size, size);
    context.putImageData(image, 0, 0);
    labels();
    figure.querySelector('.ramp').style.background = lucerna.rampCss(colours.value);
    const ends = log.checked ? [0.001, 0.01, 0.1, 1] : [0, 0.25, 0.5, 0.75, 1];
    figure.querySelector('.ends').replaceChildren(...ends.map(share => {
      const span = document.createElement('span');
      span.textContent = lucerna.figure(share * peak, 3) + (share === 1 ? ' ' + field.unit : '');
      return span;
    }));
    canvas.dataset.drawn = 'yes';
  };
  const read = (c, gamma) => {
    const cd = lucerna.intensityAt(field, c, gamma);
    const se = field.standardError.length ? lucerna.intensityAt(field, c, gamma, field.standardError) : NaN;
    output.textContent = `C ${lucerna.figure(c, 4)}°, γ ${lucerna.figure(gamma, 4)}°: ${lucerna.figure(cd)}` +
      `${se > 0 ? ' ± ' + lucerna.figure(se, 2) : ''} ${field.unit}, ${lucerna.figure(100 * cd / peak, 3)} % of the maximum`;
  };
  let cursor = [0, around(0)];
  canvas.addEventListener('pointermove', event => {
    const box = canvas.getBoundingClientRect();
    const where = at((event.clientX - box.left) * size / box.width, (event.clientY - box.top) * size / box.height);
    if (where) read(...(cursor = where));
  });
  stage.addEventListener('keydown', event => {
    const step = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!step) return;
    event.preventDefault();
    cursor = [(Math.round(cursor[0]) + step[0] + 360) % 360, Math.max(0, Math.min(180, Math.round(cursor[1]) + step[1]))];
    read(...cursor);
  });
  for (const control of [reach, colours, log]) control.addEventListener('input', draw);
  document.addEventListener('lucerna-theme', draw);
  figure.querySelector('[data-save="png"]').addEventListener('click', () =>
    canvas.toBlob(blob => lucerna.save(figure.dataset.file + '.png', blob)));
  figure.querySelector('[data-save="csv"]').addEventListener('click', () =>
    lucerna.save(figure.dataset.file + '.csv', new Blob([lucerna.csvOf(field)], { type: 'text/csv' })));
  draw();
}
