// SPDX-License-Identifier: Apache-2.0
// The far field in false colours with lines of equal intensity, drawn in the page: gamma outward from the middle, C
// around it (C0 to the right, C90 up). Distances are true along the radii (azimuthal equidistant projection). Where the
// figure has a target, the target and the difference (result - target) can be shown too.
'use strict';
for (const figure of document.querySelectorAll('figure.map')) lucerna.afterLoad(() => {
  const field = lucerna.fields[Number(figure.dataset.detector)];
  const canvas = figure.querySelector('canvas');
  // Its pixels come from here: a graphics card would only keep them waiting.
  const context = canvas.getContext('2d', { willReadFrequently: true });
  const output = figure.querySelector('output.cursor'), stage = figure.querySelector('.stage');
  const [reach, colours, log, shown] = ['.reach', '.colours', '.log', '.shown'].map(name => figure.querySelector(name));
  const target = figure.dataset.target ? lucerna.fields[Number(figure.dataset.target)] : null;
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

  // What is shown in a direction; of a difference the colours go to the largest one on the grid, both ways.
  const difference = () => Boolean(target) && shown.value === 'difference';
  const most = target ? field.gamma_deg.reduce((largest, g, k) => field.c_deg.reduce((m, c, i) =>
    Math.max(m, Math.abs(field.intensity[i * field.gamma_deg.length + k] - lucerna.intensityAt(target, c, g))), largest), 0) : 0;
  const toneOf = (signed, decades) => cd => {
    if (signed) return most > 0 ? 0.5 + 0.5 * cd / most : 0.5;
    const share = peak > 0 ? cd / peak : 0;
    return decades ? 1 + Math.log10(Math.max(share, 1e-3)) / 3 : share;
  };
  const at = (x, y) => {
    const out = Number(reach.value), dx = x - middle, dy = middle - y, r = Math.sqrt(dx * dx + dy * dy) / radius * out;
    const c = Math.atan2(dy, dx) * 180 / Math.PI;
    return r <= out ? [c < 0 ? c + 360 : c, around(r)] : null;
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
    const tones = new Float32Array(size * size), name = difference() ? 'blueorange' : colours.value;
    const table = lucerna.rampTable(name), pixels = image.data, signed = difference(), tone = toneOf(signed, log.checked), out = Number(reach.value);
    const drawn = shown?.value === 'target' ? target : field, steps = shares.map(s => s * peak);
    for (let y = 0; y < size; ++y) {
      for (let x = 0; x < size; ++x) {
        const dx = x + 0.5 - middle, dy = middle - y - 0.5, r = Math.sqrt(dx * dx + dy * dy) / radius * out;
        if (r > out) continue;
        const i = y * size + x, c = Math.atan2(dy, dx) * 180 / Math.PI, gamma = around(r);
        const found = lucerna.intensityAt(drawn, c, gamma), cd = signed ? found - lucerna.intensityAt(target, c, gamma) : found;
        let level = 0;
        while (level < steps.length && cd >= steps[level]) ++level;
        levels[i] = level;
        tones[i] = tone(cd);
        const k = 3 * Math.round(255 * Math.max(0, Math.min(1, tones[i]))), p = 4 * i;
        pixels[p] = table[k];
        pixels[p + 1] = table[k + 1];
        pixels[p + 2] = table[k + 2];
        pixels[p + 3] = 255;
      }
    }
    for (let i = 0; !signed && i < size * (size - 1) - 1; ++i) {
      if (levels[i] < 0 || (levels[i] === levels[i + 1] && levels[i] === levels[i + size])) continue;
      if (levels[i + 1] < 0 || levels[i + size] < 0) continue;
      pixels.fill(tones[i] > 0.55 ? 0 : 255, 4 * i, 4 * i + 3);
    }
    context.clearRect(0, 0, size, size);
    context.putImageData(image, 0, 0);
    labels();
    figure.querySelector('.ramp').style.background = lucerna.rampCss(name);
    const ends = log.checked && !difference() ? [0.001, 0.01, 0.1, 1] : [0, 0.25, 0.5, 0.75, 1];
    figure.querySelector('.ends').replaceChildren(...ends.map(share => {
      const span = document.createElement('span'), value = difference() ? (2 * share - 1) * most : share * peak;
      span.textContent = lucerna.figure(value, 3) + (share === 1 ? ' ' + field.unit : '');
      return span;
    }));
    canvas.dataset.drawn = 'yes';
  };
  const read = (c, gamma) => {
    const cd = lucerna.intensityAt(field, c, gamma), place = `C ${lucerna.figure(c, 4)}°, γ ${lucerna.figure(gamma, 4)}°: `;
    const se = field.standardError.length ? lucerna.intensityAt(field, c, gamma, field.standardError) : NaN;
    const share = target ? `target ${lucerna.figure(lucerna.intensityAt(target, c, gamma))} ${field.unit}`
      : `${lucerna.figure(100 * cd / peak, 3)} % of the maximum`;
    output.textContent = `${place}${lucerna.figure(cd)}${se > 0 ? ' ± ' + lucerna.figure(se, 2) : ''} ${field.unit}, ${share}`;
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
  for (const control of [reach, colours, log, shown]) control?.addEventListener('input', draw);
  document.addEventListener('lucerna-theme', draw);
  lucerna.savesCanvas(figure, canvas, () => lucerna.csvOf(field));
  draw();
});
