// SPDX-License-Identifier: Apache-2.0
// What all scripts of a report share: its data, colours, saved files, light and dark, printing. Needs no network; the
// page reads without it.
'use strict';
const lucerna = (() => {
  const json = id => {
    const element = document.getElementById(id);
    return element ? JSON.parse(element.textContent) : null;
  };
  const bytes = text => {
    const binary = atob(text), out = new Uint8Array(binary.length);
    for (let i = 0; i < out.length; ++i) out[i] = binary.charCodeAt(i);
    return out.buffer;
  };
  const floats = text => new Float32Array(bytes(text));
  const counts = text => new Uint32Array(bytes(text));
  const fields = (json('far-fields') || []).map(f => ({
    ...f, intensity: floats(f.intensity), standardError: floats(f.standard_error),
  }));
  const figure = (value, digits = 4) => {
    if (!Number.isFinite(value)) return '–';
    const text = value.toPrecision(digits);
    if (!text.includes('e')) return text;
    return Math.abs(value) >= 1e6 ? text.replace('e+', 'e') : String(Number(text));
  };

  // Without trailing zeros.
  const plain = value => String(Number(value.toPrecision(6)));

  // Viridis and cividis at nine even steps (S. van der Walt, N. Smith; J. Nuñez, C. Anderton, R. Renslow 2018); blue
  // and orange about white, which the colour blind tell apart (M. Okabe, K. Ito 2008: the ends are darker shades).
  const ramps = {
    viridis: [0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725],
    cividis: [0x00224e, 0x123570, 0x3b496c, 0x575d6d, 0x707173, 0x8a8678, 0xa59c74, 0xc3b369, 0xfee838],
    blueorange: [0x083a66, 0x0072b2, 0x56a5d8, 0xb7d9ef, 0xf7f7f7, 0xf6d3ab, 0xe59550, 0xc75a06, 0x6e2c00],
  };
  const rampAt = (name, t) => {
    const ramp = ramps[name], x = Math.max(0, Math.min(1, t)) * (ramp.length - 1), i = Math.min(ramp.length - 2, x | 0);
    return [16, 8, 0].map(shift => {
      const a = ramp[i] >> shift & 255, b = ramp[i + 1] >> shift & 255;
      return a + (b - a) * (x - i);
    });
  };
  // 256 colours at once, for pictures: [r, g, b, r, ...].
  const rampTable = name => {
    const table = new Uint8ClampedArray(768);
    for (let i = 0; i < 256; ++i) table.set(rampAt(name, i / 255), 3 * i);
    return table;
  };
  const rampCss = name => `linear-gradient(90deg, ${ramps[name].map(c => '#' + c.toString(16).padStart(6, '0')).join(',')})`;

  // The last of rising angles that is not above x, but never the last of several.
  const locate = (angles, x) => {
    let low = 0, high = angles.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (angles[middle] <= x) low = middle; else high = middle;
    }
    return low;
  };
  // Bilinear in (C, gamma), periodic in C, as intensity_at of the library.
  const intensityAt = (field, c, gamma, values = field.intensity) => {
    const gammas = field.gamma_deg, planes = field.c_deg, n = gammas.length;
    if (gamma < gammas[0] || gamma > gammas[n - 1]) return 0;
    const turn = ((c % 360) + 360) % 360, last = planes.length - 1, around = turn > planes[last];
    const c0 = around ? last : locate(planes, turn), c1 = around ? 0 : Math.min(c0 + 1, last);
    const u = c1 === c0 ? 0 : (turn - planes[c0]) / ((around ? 360 : planes[c1]) - planes[c0]);
    const g0 = locate(gammas, gamma), g1 = Math.min(g0 + 1, n - 1), v = g1 > g0 ? (gamma - gammas[g0]) / (gammas[g1] - gammas[g0]) : 0;
    // Many thousand times for a picture: no arrays, no functions.
    const a = values[c0 * n + g0] * (1 - v) + values[c0 * n + g1] * v, b = values[c1 * n + g0] * (1 - v) + values[c1 * n + g1] * v;
    return a * (1 - u) + b * u;
  };
  // Does more of the light go up than down?
  const goesUp = field => {
    const flux = kept => field.gamma_deg.reduce((sum, g, k) => sum + (kept(g) ? Math.sin(g * Math.PI / 180) *
      field.c_deg.reduce((s, _, i) => s + field.intensity[i * field.gamma_deg.length + k], 0) : 0), 0);
    return flux(g => g < 90) < flux(g => g > 90);
  };

  const svgElement = (name, attributes, text) => {
    const element = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    return element;
  };

  const save = (name, blob) => {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const saveText = (name, text, type = 'text/csv') => save(name, new Blob([text], { type }));
  // A canvas as a picture in an SVG document.
  const svgOfCanvas = canvas => new XMLSerializer().serializeToString((() => {
    const { width, height } = canvas;
    const svg = svgElement('svg', { width, height, viewBox: `0 0 ${width} ${height}` });
    svg.append(svgElement('image', { href: canvas.toDataURL('image/png'), width, height }));
    return svg;
  })());
  // The buttons below a canvas; `csv` gives the text of the table.
  const savesCanvas = (figureElement, canvas, csv) => {
    const on = (kind, act) => {
      const button = figureElement.querySelector(`[data-save="${kind}"]`);
      if (button) button.addEventListener('click', () => act(figureElement.dataset.file + '.' + kind));
    };
    on('png', name => canvas.toBlob(blob => save(name, blob)));
    on('svg', name => saveText(name, svgOfCanvas(canvas), 'image/svg+xml'));
    on('csv', name => saveText(name, csv()));
  };
  const csvOf = field => {
    const unit = field.unit === 'cd' ? 'cd' : 'w_per_sr';
    const lines = [`c_deg,gamma_deg,intensity_${unit},standard_error_${unit}`];
    field.c_deg.forEach((c, i) => field.gamma_deg.forEach((g, k) => {
      const at = i * field.gamma_deg.length + k;
      const error = field.standardError.length ? Number(field.standardError[at].toPrecision(4)) : '';
      lines.push(`${c},${g},${Number(field.intensity[at].toPrecision(7))},${error}`);
    }));
    return lines.join('\n') + '\n';
  };

  const themes = ['auto', 'light', 'dark'];
  let theme = 0;
  const button = document.getElementById('theme');
  button.addEventListener('click', () => {
    theme = (theme + 1) % themes.length;
    if (theme) document.documentElement.dataset.theme = themes[theme];
    else delete document.documentElement.dataset.theme;
    button.textContent = `Theme: ${themes[theme]}`;
    document.dispatchEvent(new Event('lucerna-theme'));
  });
  document.getElementById('print').addEventListener('click', () => window.print());
  // What takes long to draw waits until the page has been read and painted, part after part, so that text and diagrams
  // are there at once. The root says when all is drawn.
  const parts = [], root = document.documentElement;
  const drawPart = () => {
    const draw = parts.shift();
    if (draw) draw();
    else if (!root.dataset.complete) {
      root.dataset.complete = 'yes';
      performance.mark('complete');
    }
    return Boolean(draw);
  };
  const onward = () => { if (drawPart()) setTimeout(onward); };
  const afterLoad = draw => { parts.push(draw); };
  // No frames come where nobody looks.
  addEventListener('load', () => (document.hidden ? setTimeout(onward) : requestAnimationFrame(() => setTimeout(onward))));
  addEventListener('beforeprint', () => { while (drawPart()); });

  // Paper cannot be unfolded.
  const opened = [];
  addEventListener('beforeprint', () => document.querySelectorAll('details:not([open])').forEach(d => {
    d.open = true;
    opened.push(d);
  }));
  addEventListener('afterprint', () => opened.splice(0).forEach(d => { d.open = false; }));
  return {
    json, floats, counts, fields, figure, plain, intensityAt, goesUp, ramps, rampAt, rampTable, rampCss, svgElement,
    save, saveText, savesCanvas, csvOf, afterLoad,
  };
})();
