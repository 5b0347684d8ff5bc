// SPDX-License-Identifier: Apache-2.0
// Values under the cursor of the library's diagrams, their saved pictures and tables, and the colours of its maps.
// A diagram says what it is by data-plot and where its values lie by data-x, data-y, ... (svg_canvas.h).
'use strict';
lucerna.plots = (() => {
  const { figure, intensityAt, svgElement } = lucerna;
  const curves = lucerna.json('curves') || [];
  const grids = (lucerna.json('grids') || []).map(g => ({
    ...g, value: lucerna.floats(g.value), standardError: lucerna.floats(g.standard_error),
  }));
  const numbers = text => (text || '').split(' ').map(Number);
  const mark = svg => {
    let group = svg.querySelector('.mark');
    if (!group) svg.append(group = svgElement('g', { class: 'mark', 'aria-hidden': 'true' }));
    group.replaceChildren();
    return group;
  };
  const errorText = error => (error > 0 ? ' ± ' + figure(error, 2) : '');

  const polar = plot => {
    const { svg, output, field } = plot, slider = plot.element.querySelector('input[type="range"]');
    const [cx, cy, unit] = numbers(svg.dataset.polar);
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
        const wanted = plot.target ? ` (target ${figure(intensityAt(plot.target, c, gamma))})` : '';
        return `C${c}: ${figure(cd)}${errorText(se)}${wanted}`;
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
      plot.element.querySelector('.control output').textContent = `C${c} – C${c + 180}`;
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

  // Straight axes: `say` turns the values of a place into { text, level, upright }: what to print and which lines to draw.
  const straight = say => plot => {
    const { svg, output } = plot, names = [svg.dataset.x, svg.dataset.y];
    const axes = names.map(text => text.split(' ').slice(0, 4).map(Number)), log = names.map(text => text.endsWith('log'));
    const valueAt = (at, k) => {
      const [a, b, first, last] = axes[k], share = (at - a) / (b - a);
      return log[k] ? first * (last / first) ** share : first + share * (last - first);
    };
    let cursor = axes.map(([a, b]) => (a + b) / 2);
    const show = () => {
      cursor = cursor.map((v, k) => Math.max(Math.min(...axes[k].slice(0, 2)), Math.min(Math.max(...axes[k].slice(0, 2)), v)));
      const group = mark(svg), [xs, ys] = axes;
      const { text, level, upright = true } = say(cursor.map(valueAt), plot);
      if (upright) group.append(svgElement('line', { x1: cursor[0], x2: cursor[0], y1: ys[0], y2: ys[1] }));
      if (level) group.append(svgElement('line', { x1: xs[0], x2: xs[1], y1: cursor[1], y2: cursor[1] }));
      output.textContent = text;
    };
    return {
      at: point => { cursor = point; show(); },
      step: (across, along) => { cursor = [cursor[0] + 5 * across, cursor[1] - 5 * along]; show(); },
    };
  };
  const readings = (plot, lines) => lines.map(([name, c, gamma]) => name + figure(intensityAt(plot.field, c, gamma)) +
    (plot.target ? ` (target ${figure(intensityAt(plot.target, c, gamma))})` : '')).join(' · ') + ' ' + plot.field.unit;
  const cartesian = straight(([angle], plot) => {
    const gamma = plot.up ? 180 - Math.abs(angle) : Math.abs(angle), planes = angle < 0 ? [180, 270] : [0, 90];
    return { text: `γ ${figure(gamma)}°  ${readings(plot, planes.map(c => [`C${c}: `, c, gamma]))}` };
  });
  // H and V of a goniometer about the beam's axis (svg_isocandela.h).
  const isocandela = straight(([h, v], plot) => {
    const a = h * Math.PI / 180, b = v * Math.PI / 180, along = Math.cos(a) * Math.cos(b);
    const c = Math.atan2(plot.up ? Math.sin(a) : -Math.sin(a), Math.cos(a) * Math.sin(b)) * 180 / Math.PI;
    const angle = Math.acos(Math.max(-1, Math.min(1, along))) * 180 / Math.PI;
    return { text: `H ${figure(h)}°, V ${figure(v)}°  ${readings(plot, [['', c, plot.up ? 180 - angle : angle]])}`, level: true };
  });
  // Illuminance at (x, y) metres on a plane square to the axis (svg_isolux.h).
  const luxAt = (plot, x, y, distance) => {
    const angle = Math.atan(Math.hypot(x, y) / distance), c = Math.atan2(plot.up ? -y : y, x) * 180 / Math.PI;
    return intensityAt(plot.field, c, (plot.up ? Math.PI - angle : angle) * 180 / Math.PI) * Math.cos(angle) ** 3 / distance ** 2;
  };
  const fieldLux = straight(([x, y], plot) => ({
    text: `x ${figure(x, 3)} m, y ${figure(y, 3)} m  ${figure(luxAt(plot, x, y, Number(plot.element.dataset.distance)))} ` +
      (plot.field.unit === 'cd' ? 'lx' : 'W/m²'),
    level: true,
  }));
  const zonal = straight(([, gamma], plot) => {
    const zones = numbers(plot.svg.dataset.zones), i = Math.max(0, Math.min(zones.length - 1, Math.floor(gamma / 10)));
    const all = zones.reduce((a, b) => a + b, 0), unit = plot.field.unit === 'cd' ? 'lm' : 'W';
    return {
      text: `${10 * i}°–${10 * i + 10}°  ${figure(zones[i])} ${unit}, ${figure(100 * zones[i] / all, 3)} % of all`,
      level: true, upright: false,
    };
  });
  const cone = plot => {
    const { svg, output } = plot, [apex, end, far] = numbers(svg.dataset.cone), [axis, most] = numbers(svg.dataset.lux);
    const edges = numbers(svg.dataset.edges), box = svg.viewBox.baseVal;
    let distance = far / 2;
    const show = () => {
      distance = Math.max(far / 100, Math.min(far, distance));
      const y = apex + (end - apex) * distance / far;
      mark(svg).append(svgElement('line', { x1: 10, x2: box.width - 10, y1: y, y2: y }));
      const width = i => distance * (Math.tan(edges[i + 1] * Math.PI / 180) - Math.tan(edges[i] * Math.PI / 180));
      const widths = edges.length === 4 ? `width ${figure(width(0), 3)} m in C0–C180, ${figure(width(2), 3)} m in C90–C270; ` : '';
      output.textContent = `at ${figure(distance, 3)} m  ${widths}${figure(axis / distance ** 2, 3)} ` +
        `${plot.field.unit === 'cd' ? 'lx' : 'W/m²'} on the axis, at most ${figure(most / distance ** 2, 3)}`;
    };
    return {
      at: ([, y]) => { distance = (y - apex) / (end - apex) * far; show(); },
      step: (across, along) => { distance += (across + 10 * along) * far / 100; show(); },
    };
  };
  // Two discs of equal area per solid angle (svg_isocandela.h).
  const sphere = plot => {
    const { svg, output } = plot, [x0, y0, x1, y1, radius] = numbers(svg.dataset.discs);
    let cursor = [x0, y0];
    const show = () => {
      const up = cursor[0] > (x0 + x1) / 2, dx = cursor[0] - (up ? x1 : x0), dy = (up ? y1 : y0) - cursor[1];
      const r = Math.hypot(dx, dy) / radius;
      if (r > 1) return;
      const angle = 2 * Math.asin(r / Math.SQRT2) * 180 / Math.PI, gamma = up ? 180 - angle : angle;
      const c = (Math.atan2(dy, dx) * 180 / Math.PI + 360) % 360;
      mark(svg).append(svgElement('circle', { cx: cursor[0], cy: cursor[1], r: 3.5 }));
      output.textContent = `C ${figure(c, 4)}°, γ ${figure(gamma, 4)}°: ${readings(plot, [['', c, gamma]])}`;
    };
    return {
      at: point => { cursor = point; show(); },
      step: (across, along) => { cursor = [cursor[0] + 3 * across, cursor[1] - 3 * along]; show(); },
    };
  };
  const curveValues = ([at], plot) => {
    const data = curves[Number(plot.element.dataset.curves)];
    const parts = data.curves.map(c => {
      let i = 0;
      for (let k = 1; k < c.x.length; ++k) if (Math.abs(c.x[k] - at) < Math.abs(c.x[i] - at)) i = k;
      return `${c.name}: ${figure(c.y[i])} at ${lucerna.plain(c.x[i])}`;
    });
    return { text: parts.join(' · ') };
  };
  const curvesTable = plot => {
    const data = curves[Number(plot.element.dataset.curves)], quoted = text => `"${text.replaceAll('"', '""')}"`;
    const lines = [`curve,${quoted(data.x)},${quoted(data.y)}`];
    for (const c of data.curves) c.x.forEach((x, i) => lines.push(`${quoted(c.name)},${x},${c.y[i]}`));
    return lines.join('\n') + '\n';
  };
  const luxTable = plot => {
    const [x, y] = [plot.svg.dataset.x, plot.svg.dataset.y].map(numbers), n = 50, lines = ['x_m,y_m,illuminance'];
    for (let i = 0; i <= n; ++i) {
      for (let k = 0; k <= n; ++k) {
        const at = [x[2] + (x[3] - x[2]) * k / n, y[2] + (y[3] - y[2]) * i / n];
        lines.push([...at, luxAt(plot, ...at, Number(plot.element.dataset.distance))].map(lucerna.plain).join(','));
      }
    }
    return lines.join('\n') + '\n';
  };

  // False-colour maps: cells as a picture in the diagram, their colours as a bar beside it.
  const cellCentre = (plot, ix, iy) => {
    const { grid, svg } = plot, [x, y] = [svg.dataset.x, svg.dataset.y].map(numbers);
    return [x[2] + (x[3] - x[2]) * (ix + 0.5) / grid.nx, y[2] + (y[3] - y[2]) * (iy + 0.5) / grid.ny];
  };
  const tone = (value, [low, high], log) => {
    if (!log) return high > low ? (value - low) / (high - low) : 0.5;
    return value > 0 && high > 0 ? 1 + Math.log10(Math.max(value / high, 1e-4)) / 4 : 0;
  };
  const picture = (width, height, colourOf) => {
    const canvas = Object.assign(document.createElement('canvas'), { width, height }), context = canvas.getContext('2d');
    const image = context.createImageData(width, height);
    for (let i = 0; i < width * height; ++i) image.data.set(colourOf(i % width, Math.floor(i / width)), 4 * i);
    context.putImageData(image, 0, 0);
    return canvas.toDataURL('image/png');
  };
  const paintGrid = plot => {
    const { svg, grid, element } = plot, [x, y] = [svg.dataset.x, svg.dataset.y].map(numbers);
    const log = Boolean(element.querySelector('.log')?.checked), name = grid.diverging ? 'blueorange' : element.querySelector('.colours').value;
    const table = lucerna.rampTable(name), [low, high] = grid.range;
    const colour = t => [...table.subarray(3 * Math.round(255 * Math.max(0, Math.min(1, t)))).subarray(0, 3), 255];
    const cells = picture(grid.nx, grid.ny, (ix, row) => {
      const v = grid.value[(grid.ny - 1 - row) * grid.nx + ix];
      return Number.isFinite(v) ? colour(tone(v, grid.range, log)) : [0, 0, 0, 0];
    });
    svg.querySelector('.raster')?.remove();
    const raster = svgElement('g', { class: 'raster' }), bar = { x: x[1] + 22, y: y[1] + 8, width: 16, height: Math.max(44, y[0] - y[1] - 16) };
    const sharp = { preserveAspectRatio: 'none', style: 'image-rendering:pixelated' };
    raster.append(svgElement('image', { href: cells, x: x[0], y: y[1], width: x[1] - x[0], height: y[0] - y[1], ...sharp }));
    raster.append(svgElement('image', { href: picture(1, 128, (_, row) => colour(1 - row / 127)), ...bar, preserveAspectRatio: 'none' }));
    const steps = log ? [1e-4, 1e-3, 1e-2, 0.1, 1] : [0, 0.25, 0.5, 0.75, 1];
    steps.forEach((share, i) => {
      const value = log ? share * high : low + share * (high - low), at = bar.y + bar.height * (1 - i / 4);
      raster.append(svgElement('text', { x: bar.x + 22, y: at + 4, 'font-size': 12, fill: '#222' }, figure(value, 3)));
    });
    raster.append(svgElement('text', { x: bar.x, y: y[1] - 4, 'font-size': 12, fill: '#444' }, grid.unit));
    // Under the lines of the axes, over the ground.
    svg.insertBefore(raster, svg.children[1]);
  };
  const gridSays = straight(([x, y], plot) => {
    const { grid, svg } = plot, [xs, ys] = [svg.dataset.x, svg.dataset.y].map(numbers);
    const cell = (v, [, , first, last], n) => Math.max(0, Math.min(n - 1, Math.floor((v - first) / (last - first) * n)));
    const i = cell(y, ys, grid.ny) * grid.nx + cell(x, xs, grid.nx);
    const error = grid.standardError.length ? grid.standardError[i] : NaN;
    return { text: `${grid.x} ${figure(x, 3)}, ${grid.y} ${figure(y, 3)}: ${figure(grid.value[i])}${errorText(error)} ${grid.unit}`, level: true };
  });
  const gridTable = plot => {
    const { grid } = plot, quoted = text => `"${text}"`, lines = [[grid.x, grid.y, grid.unit, 'standard error'].map(quoted).join(',')];
    grid.value.forEach((v, i) => lines.push([...cellCentre(plot, i % grid.nx, Math.floor(i / grid.nx)).map(lucerna.plain),
      Number.isFinite(v) ? Number(v.toPrecision(7)) : '', grid.standardError.length ? Number(grid.standardError[i].toPrecision(4)) : ''].join(',')));
    return lines.join('\n') + '\n';
  };
  const isolux = plot => (plot.grid ? gridSays : fieldLux)(plot);
  const grid = plot => {
    paintGrid(plot);
    for (const control of plot.element.querySelectorAll('.colours, .log')) control.addEventListener('input', () => paintGrid(plot));
    return gridSays(plot);
  };

  const svgOf = svg => {
    const copy = svg.cloneNode(true);
    copy.querySelectorAll('.mark').forEach(e => e.remove());
    copy.querySelectorAll('.extra').forEach(e => {
      for (const [key, value] of [['fill', 'none'], ['stroke', '#009e73'], ['stroke-width', '2.2'], ['stroke-dasharray', '2 4']]) e.setAttribute(key, value);
    });
    return new XMLSerializer().serializeToString(copy);
  };
  const tables = { curves: curvesTable, grid: gridTable, isolux: plot => (plot.grid ? gridTable : luxTable)(plot) };
  const kinds = { polar, cartesian, isocandela, isolux, zonal, cone, sphere, grid, curves: straight(curveValues) };
  for (const element of document.querySelectorAll('figure.plot')) {
    const svg = element.querySelector('svg'), { detector, target, grid: number, file } = element.dataset;
    const plot = {
      element, svg, output: element.querySelector('output.cursor'), field: lucerna.fields[Number(detector)],
      target: target ? lucerna.fields[Number(target)] : null, grid: grids[Number(number)],
    };
    plot.up = plot.field && lucerna.goesUp(plot.field);
    const table = tables[svg.dataset.plot] || (p => lucerna.csvOf(p.field));
    element.querySelector('[data-save="svg"]').addEventListener('click', () => lucerna.saveText(file + '.svg', svgOf(svg), 'image/svg+xml'));
    element.querySelector('[data-save="csv"]').addEventListener('click', () => lucerna.saveText(file + '.csv', table(plot)));
    const cursor = kinds[svg.dataset.plot](plot), stage = element.querySelector('.stage');
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
  return { curves, grids };
})();
