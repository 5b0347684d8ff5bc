// SPDX-License-Identifier: Apache-2.0
// Values under the cursor, saved plots and tables, light and dark. Needs no network; the page reads without it.
'use strict';
const lucerna = (() => {
  const json = id => {
    const element = document.getElementById(id);
    return element ? JSON.parse(element.textContent) : null;
  };
  const floats = text => new Float32Array(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);
  const fields = (json('far-fields') || []).map(f => ({
    ...f, intensity: floats(f.intensity), standardError: floats(f.standard_error),
  }));
  const figure = (value, digits = 4) => {
    if (!Number.isFinite(value)) return '–';
    const text = value.toPrecision(digits);
    return text.includes('e') ? String(Number(text)) : text;
  };

  // Without trailing zeros.
  const plain = value => String(Number(value.toPrecision(6)));

  // Viridis and cividis at nine even steps (S. van der Walt, N. Smith; J. Nuñez, C. Anderton, R. Renslow 2018).
  const ramps = {
    viridis: [0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725],
    cividis: [0x00224e, 0x123570, 0x3b496c, 0x575d6d, 0x707173, 0x8a8678, 0xa59c74, 0xc3b369, 0xfee838],
  };
  const rampAt = (name, t) => {
    const ramp = ramps[name], x = Math.max(0, Math.min(1, t)) * (ramp.length - 1), i = Math.min(ramp.length - 2, x | 0);
    return [16, 8, 0].map(shift => {
      const a = ramp[i] >> shift & 255, b = ramp[i + 1] >> shift & 255;
      return a + (b - a) * (x - i);
    });
  };
  const rampCss = name => `linear-gradient(90deg, ${ramps[name].map(c => '#' + c.toString(16).padStart(6, '0')).join(',')})`;

  // Index of the grid step that holds x, and how far x is into it.
  const locate = (angles, x) => {
    let low = 0, high = angles.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (angles[middle] <= x) low = middle; else high = middle;
    }
    return [low, high, high > low ? (x - angles[low]) / (angles[high] - angles[low]) : 0];
  };
  // Bilinear in (C, gamma), periodic in C, as intensity_at of the library.
  const intensityAt = (field, c, gamma, values = field.intensity) => {
    const gammas = field.gamma_deg, planes = field.c_deg, n = gammas.length;
    if (gamma < gammas[0] || gamma > gammas[n - 1]) return 0;
    const turn = ((c % 360) + 360) % 360;
    const [c0, c1, u] = turn > planes[planes.length - 1]
      ? [planes.length - 1, 0, (turn - planes[planes.length - 1]) / (360 - planes[planes.length - 1])]
      : locate(planes, turn);
    const [g0, g1, v] = locate(gammas, gamma);
    const row = i => values[i * n + g0] * (1 - v) + values[i * n + g1] * v;
    return row(c0) * (1 - u) + row(c1) * u;
  };

  const svgElement = (name, attributes) => {
    const element = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return element;
  };
  const mark = svg => {
    let group = svg.querySelector('.mark');
    if (!group) svg.append(group = svgElement('g', { class: 'mark', 'aria-hidden': 'true' }));
    group.replaceChildren();
    return group;
  };

  // What each kind of plot says of a point (in units of the drawing), and how it is walked by keys.
  const polar = (plot, field) => {
    const svg = plot.querySelector('svg'), output = plot.querySelector('output.cursor');
    const slider = plot.querySelector('input[type="range"]');
    const [cx, cy, unit] = svg.dataset.polar.split(' ').map(Number);
    const place = (gamma, side, cd) => {
      const angle = gamma * Math.PI / 180;
      return [cx + side * cd * unit * Math.sin(angle), cy + cd * unit * Math.cos(angle)];
    };
    const show = (gamma, side) => {
      const pairs = side > 0 ? [0, 90] : [180, 270];
      if (slider) pairs.push(Number(slider.value) + (side > 0 ? 0 : 180));
      const group = mark(svg), radius = 250;
      const end = place(gamma, side, radius / unit);
      group.append(svgElement('line', { x1: cx, y1: cy, x2: end[0], y2: end[1] }));
      const parts = [...new Set(pairs)].map(c => {
        const cd = intensityAt(field, c, gamma), [x, y] = place(gamma, side, cd);
        group.append(svgElement('circle', { cx: x, cy: y, r: 3.5 }));
        const se = field.standardError.length ? intensityAt(field, c, gamma, field.standardError) : NaN;
        return `C${c}: ${figure(cd)}${se > 0 ? ' ± ' + figure(se, 2) : ''}`;
      });
      output.textContent = `γ ${figure(gamma, 4)}°  ${parts.join(' · ')} ${field.unit}`;
    };
    let cursor = 0;
    const drawExtra = () => {
      let line = svg.querySelector('.extra');
      if (!line) svg.append(line = svgElement('polyline', { class: 'extra' }));
      const c = Number(slider.value), points = [];
      for (let g = 180; g >= 0; --g) points.push(place(g, -1, intensityAt(field, c + 180, g)));
      for (let g = 0; g <= 180; ++g) points.push(place(g, 1, intensityAt(field, c, g)));
      line.setAttribute('points', c % 90 ? points.map(p => p.map(x => x.toFixed(1)).join(',')).join(' ') : '');
      plot.querySelector('.control output').textContent = `C${c} – C${c + 180}`;
      show(Math.abs(cursor), cursor < 0 ? -1 : 1);
    };
    if (slider) slider.addEventListener('input', drawExtra);
    return {
      at: ([x, y]) => {
        cursor = Math.atan2(x - cx, y - cy) * 180 / Math.PI;
        show(Math.abs(cursor), cursor < 0 ? -1 : 1);
      },
      step: (across, along) => {
        cursor = Math.max(-180, Math.min(180, Math.round(cursor) + across + 10 * along));
        show(Math.abs(cursor), cursor < 0 ? -1 : 1);
      },
    };
  };

  // Plots with straight axes; `directions` turns a point's two values into lines of [label, C, gamma].
  const onAxes = directions => (plot, field) => {
    const svg = plot.querySelector('svg'), output = plot.querySelector('output.cursor');
    const axes = [svg.dataset.x, svg.dataset.y].map(text => text.split(' ').slice(0, 4).map(Number));
    const flux = (from, to) => field.gamma_deg.reduce((sum, g, k) => sum + (g >= from && g <= to ? Math.sin(g * Math.PI / 180) *
      field.c_deg.reduce((s, _, i) => s + field.intensity[i * field.gamma_deg.length + k], 0) : 0), 0);
    const up = flux(0, 89.99) < flux(90.01, 180);
    let cursor = axes.map(([a, b]) => (a + b) / 2);
    const show = () => {
      const clamped = cursor.map((v, k) => Math.max(Math.min(...axes[k].slice(0, 2)), Math.min(Math.max(...axes[k].slice(0, 2)), v)));
      const values = clamped.map((v, k) => axes[k][2] + (v - axes[k][0]) / (axes[k][1] - axes[k][0]) * (axes[k][3] - axes[k][2]));
      const group = mark(svg), [xs, ys] = axes;
      group.append(svgElement('line', { x1: clamped[0], x2: clamped[0], y1: ys[0], y2: ys[1] }));
      const { text, lines, level } = directions(values, up);
      if (level) group.append(svgElement('line', { x1: xs[0], x2: xs[1], y1: clamped[1], y2: clamped[1] }));
      output.textContent = text + '  ' + lines.map(([name, c, gamma]) => name + figure(intensityAt(field, c, gamma))).join(' · ') + ' ' + field.unit;
      cursor = clamped;
    };
    return {
      at: point => { cursor = point; show(); },
      step: (across, along) => { cursor = [cursor[0] + 5 * across, cursor[1] - 5 * along]; show(); },
    };
  };
  const cartesian = onAxes(([angle], up) => {
    const gamma = up ? 180 - Math.abs(angle) : Math.abs(angle), planes = angle < 0 ? [180, 270] : [0, 90];
    return { text: `γ ${figure(gamma)}°`, lines: planes.map(c => [`C${c}: `, c, gamma]) };
  });
  // H and V of a goniometer about the beam's axis (svg_isocandela.h).
  const isocandela = onAxes(([h, v], up) => {
    const a = h * Math.PI / 180, b = v * Math.PI / 180, along = Math.cos(a) * Math.cos(b);
    const c = Math.atan2(up ? Math.sin(a) : -Math.sin(a), Math.cos(a) * Math.sin(b)) * 180 / Math.PI;
    const angle = Math.acos(Math.max(-1, Math.min(1, along))) * 180 / Math.PI;
    return { text: `H ${figure(h)}°, V ${figure(v)}°`, level: true, lines: [['', c, up ? 180 - angle : angle]] };
  });

  const save = (name, blob) => {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
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
  const svgOf = plot => {
    const copy = plot.querySelector('svg').cloneNode(true);
    copy.querySelectorAll('.mark').forEach(e => e.remove());
    copy.querySelectorAll('.extra').forEach(e => {
      e.setAttribute('fill', 'none');
      e.setAttribute('stroke', '#009e73');
      e.setAttribute('stroke-width', '2.2');
      e.setAttribute('stroke-dasharray', '2 4');
    });
    return new XMLSerializer().serializeToString(copy);
  };

  const kinds = { polar, cartesian, isocandela };
  for (const plot of document.querySelectorAll('figure.plot')) {
    const field = fields[Number(plot.dataset.detector)], svg = plot.querySelector('svg');
    const make = kinds[svg.dataset.plot];
    plot.querySelector('[data-save="svg"]').addEventListener('click', () =>
      save(plot.dataset.file + '.svg', new Blob([svgOf(plot)], { type: 'image/svg+xml' })));
    plot.querySelector('[data-save="csv"]').addEventListener('click', () =>
      save(plot.dataset.file + '.csv', new Blob([csvOf(field)], { type: 'text/csv' })));
    if (!make || !field) continue;
    const cursor = make(plot, field), stage = plot.querySelector('.stage');
    stage.addEventListener('pointermove', event => {
      const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      cursor.at([p.x, p.y]);
    });
    stage.addEventListener('pointerleave', () => mark(svg));
    stage.addEventListener('keydown', event => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!step) return;
      event.preventDefault();
      cursor.step(...step);
    });
  }

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
  // Paper cannot be unfolded.
  const opened = [];
  addEventListener('beforeprint', () => document.querySelectorAll('details:not([open])').forEach(d => {
    d.open = true;
    opened.push(d);
  }));
  addEventListener('afterprint', () => opened.splice(0).forEach(d => { d.open = false; }));
  return { json, floats, fields, figure, plain, intensityAt, ramps, rampAt, rampCss, save, csvOf };
})();
