// SPDX-License-Identifier: Apache-2.0
// The report of a real trace (an LED in a paraboloid) in a real browser.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { canvasPixels, launch, lucerna, open, readCsv, temporaryFolder } from './browser.mjs';
import { commonTests } from './common.mjs';

const folder = temporaryFolder(), file = join(folder, 'report.html');
let browser;

before(async () => {
  lucerna(folder, 'init', '-o', 'led.toml', '--quiet');
  const project = readFileSync(join(folder, 'led.toml'), 'utf8').replace('diameter_mm = 100.0', 'diameter_mm = 50.0');
  const more = `
[[detector]]
name = "desk"
kind = "plane"
position_mm = [0, 0, -1000]
normal = "+z"
size_mm = [1200, 800]
cells = [61, 41]
[[detector]]
name = "look"
kind = "luminance"
from = "-z"
size_mm = [60, 60]
cells = [30, 30]
half_angle_deg = 10
[[detector]]
name = "out"
kind = "rays"
`;
  writeFileSync(join(folder, 'led.toml'), project.replace('kind = "led"', 'kind = "sphere"') + more);
  lucerna(folder, 'trace', 'led.toml', '-o', 'led', '--rays', '300000', '--report', 'report.html', '--quiet');
  browser = await launch();
});
after(() => browser?.close());

commonTests({
  browser: () => browser, file, folder: join(folder, 'led'), figures: 60, pages: [5, 18], scene: true,
  parts: ['Summary', 'Energy balance', '3D view', 'Intensity', 'Zonal flux', 'Illuminance: desk', 'Luminance image: look', 'Ray files', 'Where this comes from', 'focal_mm'],
});

test('the values under the cursor are those of the table', async () => {
  const page = await open(browser, file);
  const rows = readFileSync(join(folder, 'led', 'far.csv'), 'utf8').trim().split('\n').slice(1).map(l => l.split(',').map(Number));
  for (const [c, gamma, cd, se] of rows.filter((_, i) => i % 97 === 0)) {
    const [shown, error] = await page.evaluate(([c, g]) => {
      const f = lucerna.fields[0];
      return [lucerna.intensityAt(f, c, g), lucerna.intensityAt(f, c, g, f.standardError)];
    }, [c, gamma]);
    assert.ok(Math.abs(shown - cd) <= 1e-6 * cd, `C${c} gamma ${gamma}: ${shown}, not ${cd}`);
    assert.ok(Math.abs(error - se) <= 1e-3 * se);
  }
  // By keys: ten degrees along C0 from the bottom.
  const stage = page.locator('figure.plot .stage').first();
  await stage.focus();
  await stage.press('ArrowUp');
  const text = await page.locator('figure.plot output.cursor').first().textContent();
  const [, , expected] = rows.find(([c, g]) => c === 0 && g === 10);
  assert.match(text, /^γ 10\.00°/);
  assert.equal(Number(/C0: ([\d.]+)/.exec(text)[1]), Number(expected.toPrecision(4)));
  // By pointer: straight below the middle is gamma 0.
  await stage.locator('svg').hover();
  assert.match(await page.locator('figure.plot output.cursor').first().textContent(), /^γ [01]\./);
  await page.context().close();
});

test('plots with straight axes read the table too', async () => {
  const page = await open(browser, file);
  const rows = readFileSync(join(folder, 'led', 'far.csv'), 'utf8').trim().split('\n').map(l => l.split(',').map(Number));
  const value = (c, gamma) => Number(rows.find(r => r[0] === c && r[1] === gamma)[2].toPrecision(4));
  for (const [name, pattern] of [['cartesian', /C0: ([\d.]+)/], ['isocandela', /([\d.]+) cd$/]]) {
    const plot = page.locator(`figure[data-file="far-${name}"]`);
    // One key to the right and one back: the middle of the plot is the axis of the beam.
    await plot.locator('.stage').press('ArrowRight');
    await plot.locator('.stage').press('ArrowLeft');
    const text = await plot.locator('output.cursor').textContent();
    assert.equal(Number(pattern.exec(text)[1]), value(0, 0), `${name}: ${text}`);
  }
  await page.context().close();
});

test('maps of planes show their tables', async () => {
  const page = await open(browser, file);
  for (const name of ['desk', 'look']) {
    const rows = readCsv(join(folder, 'led', name + '.csv'));
    const grid = await page.evaluate(n => {
      const at = document.querySelector(`figure[data-file="${n}-map"]`).dataset.grid;
      return { ...lucerna.plots.grids[Number(at)], value: [...lucerna.plots.grids[Number(at)].value] };
    }, name);
    assert.equal(grid.value.length, rows.length);
    rows.forEach(([, , value], i) => assert.ok(Math.abs(grid.value[i] - value) <= 1e-5 * value, `${name} cell ${i}`));
  }
  // By keys: from the middle one step to the left is still in the cell left of it.
  const plot = page.locator('figure[data-file="desk-map"]');
  await plot.locator('.stage').press('ArrowLeft');
  const [x, y, lux] = /x, mm (-?[\d.]+), y, mm (-?[\d.]+): ([\d.]+)/.exec(await plot.locator('output.cursor').textContent()).slice(1).map(Number);
  const rows = readCsv(join(folder, 'led', 'desk.csv'));
  const near = rows.reduce((best, row) => (Math.hypot(row[0] - x, row[1] - y) < Math.hypot(best[0] - x, best[1] - y) ? row : best));
  assert.equal(lux, Number(near[2].toPrecision(4)), `${x}, ${y}`);
  await page.context().close();
});

test('cone, isolux and zonal diagrams agree with the table', async () => {
  const page = await open(browser, file);
  const rows = readCsv(join(folder, 'led', 'far.csv')), axis = rows.find(r => r[0] === 0 && r[1] === 0)[2];
  const say = async (kind, key) => {
    const plot = page.locator(`figure[data-file="far-${kind}"]`);
    await plot.locator('.stage').press(key);
    return plot.locator('output.cursor').textContent();
  };
  const [, distance, lux] = /at ([\d.]+) m .*?([\d.]+) lx on the axis/.exec(await say('cone', 'ArrowRight'));
  assert.ok(Math.abs(lux - axis / distance ** 2) < 0.01 * lux, `${lux} lx at ${distance} m`);
  await say('isolux', 'ArrowRight');
  const middle = /([\d.]+) lx/.exec(await say('isolux', 'ArrowLeft'))[1];
  assert.ok(Math.abs(middle - axis / 9) < 0.01 * middle, `${middle} lx at 3 m`);
  const zone = /(\d+)°–(\d+)°  ([\d.]+) lm/.exec(await say('zonal', 'ArrowUp')), [from, to, flux] = zone.slice(1).map(Number);
  const table = await page.locator('#zones-0 tbody tr', { hasText: `${from}°–${to}°` }).first().locator('td').first().textContent();
  assert.ok(Math.abs(flux - Number(table.split(' ± ')[0])) <= 0.01 * Math.max(flux, 0.1), `${flux}, not ${table}`);
  await page.context().close();
});

test('the far-field map shows the table, in any colours, to any angle', async () => {
  const page = await open(browser, file);
  const pixel = (x, y) => page.evaluate(([x, y]) => {
    const canvas = document.querySelector('figure.map canvas');
    return [...canvas.getContext('2d').getImageData(x * canvas.width, y * canvas.height, 1, 1).data];
  }, [x, y]);
  // To the right of the middle by 3 % of the width: on C0, the circle's radius being 42.5 % of it for 180 degrees.
  await page.locator('figure.map .reach').selectOption('180');
  const peak = await page.evaluate(() => {
    const f = lucerna.fields[0];
    return lucerna.rampAt('viridis', lucerna.intensityAt(f, 0, 180 * 0.03 / 0.425) / Math.max(...f.intensity));
  });
  const shown = await pixel(0.53, 0.5);
  peak.forEach((v, k) => assert.ok(Math.abs(v - shown[k]) <= 24, `${shown} is not ${peak}`));
  assert.equal((await pixel(0.01, 0.01))[3], 0, 'corners are empty');
  await page.locator('figure.map .colours').selectOption('cividis');
  assert.notDeepEqual(await pixel(0.53, 0.5), shown);
  await page.locator('figure.map .log').check();
  const stage = page.locator('figure.map .stage');
  for (let i = 0; i < 4; ++i) await stage.press('ArrowUp');
  const rows = readFileSync(join(folder, 'led', 'far.csv'), 'utf8').trim().split('\n').map(l => l.split(',').map(Number));
  const [, , expected] = rows.find(([c, g]) => c === 0 && g === 4);
  assert.equal(Number(/: ([\d.]+) /.exec(await page.locator('figure.map output.cursor').textContent())[1]), Number(expected.toPrecision(4)));
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

test('the 3D view shows something, orbits, zooms, switches layers and colours', async () => {
  const page = await open(browser, file);
  const first = await canvasPixels(page);
  assert.ok(first.share > 0.02 && first.share < 0.9, `${first.share} of the canvas is drawn`);
  assert.ok(first.colours > 200, `${first.colours} colours`);
  const canvas = page.locator('.scene3d canvas'), box = await canvas.boundingBox();
  const changed = async (what, act) => {
    const old = await canvasPixels(page);
    await act();
    await page.waitForTimeout(50);
    const now = await canvasPixels(page);
    assert.notEqual(now.sum, old.sum, what + ' changed nothing');
    return now;
  };
  await canvas.scrollIntoViewIfNeeded();
  await changed('dragging', async () => {
    const b = await canvas.boundingBox();
    await page.mouse.move(b.x + b.width / 2, b.y + b.height / 2);
    await page.mouse.down();
    await page.mouse.move(b.x + b.width / 2 + 90, b.y + b.height / 2 + 30, { steps: 3 });
    await page.mouse.up();
  });
  await changed('an arrow key', () => canvas.press('ArrowLeft'));
  const near = await changed('+', () => canvas.press('+'));
  assert.ok(near.drawn > first.drawn * 0.5);
  await changed('the wheel', () => page.mouse.wheel(0, 300));
  await changed('the solid', () => page.locator('#layer-solid').check());
  await changed('no mirrors', () => page.locator('#layer-mirrors').uncheck());
  await page.locator('#layer-mirrors').check();
  await changed('plain colour', () => page.locator('#colouring').selectOption('plain'));
  await changed('curvature', () => page.locator('#colouring').selectOption('curvature'));
  await changed('no section', () => page.locator('#cut').selectOption('none'));
  await changed('section', () => page.locator('#cut').selectOption('x'));
  await changed('depth', () => page.locator('#depth').fill('40'));
  await changed('reset', () => page.getByRole('button', { name: 'Reset view' }).click());
  assert.ok(box.height > 300);
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

test('bodies are drawn from their triangles', async () => {
  const packed = values => Buffer.from(values.buffer).toString('base64');
  const body = { name: 'shield', thinned: false, position: packed(Float32Array.from([-20, -20, -10, 20, -20, -10, 0, 20, 10])), index: packed(Uint32Array.from([0, 1, 2])) };
  const html = readFileSync(file, 'utf8'), other = join(folder, 'bodies.html');
  assert.ok(html.includes('"bodies":[]'));
  writeFileSync(other, html.replace('"bodies":[]', `"bodies":[${JSON.stringify(body)}]`));
  const page = await open(browser, other);
  const old = await canvasPixels(page);
  await page.locator('#layer-bodies').uncheck();
  assert.notEqual((await canvasPixels(page)).sum, old.sum);
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

// The layers' boxes by keys: what is pixels before and after.
const togglesByKey = async (page, id) => {
  const old = await canvasPixels(page);
  await page.locator(id).focus();
  await page.keyboard.press('Space');
  const now = await canvasPixels(page);
  assert.notEqual(now.sum, old.sum, `${id} changed nothing`);
  await page.keyboard.press('Space');
  assert.equal((await canvasPixels(page)).sum, old.sum, `${id} does not come back`);
  return { old, now };
};

test('a cover glass is a layer of its own, and rays are bent in it, go on behind it and come back from it', async () => {
  const project = readFileSync(join(folder, 'led.toml'), 'utf8') + `
[[body]]
role = "glass"
diameter_mm = 70.0
thickness_mm = 6.0
refractive_index = 1.8
position_mm = [0, 0, -20]
`;
  writeFileSync(join(folder, 'glass.toml'), project);
  lucerna(folder, 'trace', 'glass.toml', '-o', 'glass', '--rays', '20000', '--report', 'glass.html', '--quiet');
  const page = await open(browser, join(folder, 'glass.html'));
  assert.equal(await page.locator('label', { hasText: 'Cover glass' }).count(), 1);
  await page.locator('#cut').selectOption('none');
  const { old, now } = await togglesByKey(page, '#layer-glass');
  assert.notEqual(now.colours, old.colours);
  await togglesByKey(page, '#layer-rays0');
  const { legs, share } = await page.evaluate(() => {
    const { rays } = lucerna.json('scene'), p = lucerna.floats(rays.position), legs = [];
    rays.bounces.forEach((bounces, i) => legs.push({ from: [...p.slice(6 * i, 6 * i + 3)], to: [...p.slice(6 * i + 3, 6 * i + 6)], bounces }));
    const { ledger } = lucerna.json('result');
    return { legs, share: ledger.absorbed.glass.mean / ledger.emitted };
  });
  const step = ({ from, to }) => from.map((v, k) => to[k] - v), norm = v => Math.hypot(...v), flat = ([x, y]) => Math.hypot(x, y);
  const at = (z, v) => Math.abs(v[2] - z) < 1e-3;
  // From above at z = -14 to below at -20: bent by the index, and on in the old direction, not reflected by it.
  let bent = 0, back = 0;
  legs.forEach((leg, i) => {
    const before = legs[i - 1], after = legs[i + 1];
    if (!before || !after) return;
    if (at(-14, leg.from) && at(-20, leg.to) && before.from[2] > -14 && after.from[2] < -19.9) {
      const into = step(before), inside = step(leg), out = step(after);
      assert.ok(Math.abs(flat(inside) / norm(inside) * 1.8 - flat(into) / norm(into)) < 2e-3);
      if (after.to[2] > -20) return;  // to and fro
      assert.ok(Math.abs(flat(out) / norm(out) - flat(into) / norm(into)) < 1e-3);
      assert.equal(after.bounces, before.bounces);
      ++bent;
    }
    // From the lower face back up: reflected once more when it leaves.
    if (at(-20, leg.from) && at(-14, leg.to) && after.to[2] > -14) {
      assert.equal(after.bounces, leg.bounces + 1);
      ++back;
    }
  });
  assert.ok(bent > 150 && back > 5, `${bent} bent, ${back} back; the glass keeps ${share}`);
  if (process.env.SHOTS) {
    await page.locator('#cut').selectOption('y');
    await page.locator('#scene3d').screenshot({ path: join(process.env.SHOTS, 'glass-3d.png') });
  }
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

test('says so where there is no WebGL', async () => {
  const blind = await launch(['--disable-gpu', '--disable-3d-apis', '--disable-software-rasterizer']);
  try {
    const bare = await open(blind, file);
    assert.match(await bare.locator('#scene3d').textContent(), /needs WebGL/);
    assert.ok(await bare.locator('[data-key="/ledger/emitted"]').first().isVisible());
  } finally {
    await blind.close();
  }
});

test('plots and tables can be saved', async () => {
  const page = await open(browser, file);
  const saved = async selector => {
    const [download] = await Promise.all([page.waitForEvent('download'), page.locator(selector).first().click()]);
    const path = join(folder, download.suggestedFilename());
    await download.saveAs(path);
    return readFileSync(path, 'utf8');
  };
  const svg = await saved('[data-save="svg"]');
  assert.match(svg, /^<svg[\s\S]*<\/svg>$/);
  assert.doesNotMatch(svg, /class="mark"/);
  const lines = (await saved('[data-save="csv"]')).trim().split('\n');
  const original = readFileSync(join(folder, 'led', 'far.csv'), 'utf8').trim().split('\n');
  assert.equal(lines.length, original.length);
  assert.equal(lines[0], original[0]);
  lines.forEach((line, i) => {
    if (!i) return;
    const a = line.split(',').map(Number), b = original[i].split(',').map(Number);
    assert.ok(a[0] === b[0] && a[1] === b[1] && Math.abs(a[2] - b[2]) <= 1e-6 * b[2], line);
  });
  await page.context().close();
});

test('the theme button goes round', async () => {
  const page = await open(browser, file, { colorScheme: 'light' });
  const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await ground();
  await page.click('#theme');
  assert.equal(await ground(), light);
  await page.click('#theme');
  assert.notEqual(await ground(), light);
  await page.click('#theme');
  assert.equal(await ground(), light);
  await page.context().close();
});

