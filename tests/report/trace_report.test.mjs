// SPDX-License-Identifier: Apache-2.0
// The report of a real trace (an LED in a paraboloid) in a real browser.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { canvasPixels, launch, lucerna, open, temporaryFolder } from './browser.mjs';

const folder = temporaryFolder(), file = join(folder, 'report.html');
const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
let browser;

before(async () => {
  lucerna(folder, 'init', '-o', 'led.toml', '--quiet');
  const project = readFileSync(join(folder, 'led.toml'), 'utf8').replace('diameter_mm = 100.0', 'diameter_mm = 50.0');
  writeFileSync(join(folder, 'led.toml'), project.replace('kind = "led"', 'kind = "sphere"'));
  lucerna(folder, 'trace', 'led.toml', '-o', 'led', '--rays', '300000', '--report', 'report.html', '--quiet');
  browser = await launch();
});
after(() => browser?.close());

const value = (object, pointer) => pointer.split('/').slice(1)
  .reduce((o, word) => o[word.replaceAll('~1', '/').replaceAll('~0', '~')], object);

test('opens without a complaint or a request, under 1.5 MB', async () => {
  const start = performance.now(), page = await open(browser, file);
  await page.waitForSelector('.scene3d canvas[data-drawn]');
  const seconds = (performance.now() - start) / 1000;
  const load = await page.evaluate(() => performance.getEntriesByType('navigation')[0].loadEventEnd);
  // Printed, not asserted: a busy machine is no fault of the page (the bar is 2 s).
  console.log(`loaded in ${(load / 1000).toFixed(2)} s, with the browser's new window ${seconds.toFixed(2)} s, ` +
    `${(statSync(file).size / 1e6).toFixed(2)} MB`);
  assert.ok(statSync(file).size < 1.5e6);
  assert.deepEqual(page.complaints, []);
  assert.deepEqual(page.requests.filter(url => !url.startsWith('file:')), []);
  assert.equal(page.requests.length, 1);
  await page.context().close();
});

test('every figure on the page is the one of result.json', async () => {
  const result = JSON.parse(readFileSync(join(folder, 'led', 'result.json'), 'utf8')), page = await open(browser, file);
  const shown = await page.$$eval('[data-key]', all => all.map(e => [e.dataset.key, e.textContent]));
  assert.ok(shown.length > 60, `${shown.length} figures`);
  for (const [key, text] of shown) {
    const expected = value(result, key), figure = text.split(' ± ')[0];
    if (expected === null) { assert.equal(figure, '–', key); continue; }
    const digits = (figure.split('.')[1] || '').length;
    assert.ok(Math.abs(Number(figure) - expected) <= 0.5001 * 10 ** -digits, `${key}: ${figure}, not ${expected}`);
  }
  const embedded = await page.$eval('#result', e => JSON.parse(e.textContent));
  assert.deepEqual(embedded, result);
  await page.context().close();
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

test('the far-field map shows the table, in any colours, to any angle', async () => {
  const page = await open(browser, file);
  const pixel = (x, y) => page.evaluate(([x, y]) => {
    const canvas = document.querySelector('figure.map canvas');
    return [...canvas.getContext('2d').getImageData(x * canvas.width, y * canvas.height, 1, 1).data];
  }, [x, y]);
  // To the right of the middle by 3 % of the width: on C0, the circle's radius being 42.5 % of it for 180 degrees.
  await page.locator('.reach').selectOption('180');
  const peak = await page.evaluate(() => {
    const f = lucerna.fields[0];
    return lucerna.rampAt('viridis', lucerna.intensityAt(f, 0, 180 * 0.03 / 0.425) / Math.max(...f.intensity));
  });
  const shown = await pixel(0.53, 0.5);
  peak.forEach((v, k) => assert.ok(Math.abs(v - shown[k]) <= 24, `${shown} is not ${peak}`));
  assert.equal((await pixel(0.01, 0.01))[3], 0, 'corners are empty');
  await page.locator('.colours').selectOption('cividis');
  assert.notDeepEqual(await pixel(0.53, 0.5), shown);
  await page.locator('.log').check();
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
  await page.waitForSelector('.scene3d canvas[data-drawn]');
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

for (const colorScheme of ['light', 'dark']) {
  for (const width of [1280, 1024, 390]) {
    test(`axe finds nothing and nothing sticks out: ${colorScheme}, ${width} px`, async () => {
      const page = await open(browser, file, { colorScheme, viewport: { width, height: 900 } });
      await page.locator('details').evaluateAll(all => all.forEach(d => { d.open = true; }));
      // Scripts may not be added to a page with this policy; the test's own may be run in it.
      await page.evaluate(axe);
      const { violations } = await page.evaluate(() => axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21aa', 'best-practice'] }));
      assert.deepEqual(violations.map(v => [v.id, v.nodes.map(n => n.html.slice(0, 120))]), []);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.ok(wide <= 0, `${wide} px too wide`);
      await page.context().close();
    });
  }
}

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

test('nothing moves while it loads', async () => {
  const context = await browser.newContext({ viewport: { width: 1024, height: 800 } }), page = await context.newPage();
  await page.addInitScript(() => {
    window.shift = 0;
    new PerformanceObserver(list => list.getEntries().forEach(e => { window.shift += e.value; }))
      .observe({ type: 'layout-shift', buffered: true });
  });
  await page.goto('file://' + file);
  await page.waitForSelector('.scene3d canvas[data-drawn]');
  await page.waitForTimeout(300);
  const shift = await page.evaluate(() => window.shift);
  assert.ok(shift < 0.02, `cumulative layout shift ${shift}`);
  await context.close();
});

test('prints to A4 with all its parts', async () => {
  const page = await open(browser, file);
  await page.waitForSelector('.scene3d canvas[data-drawn]');
  const pdf = join(folder, 'report.pdf');
  await page.pdf({ path: pdf, preferCSSPageSize: true, printBackground: true });
  const info = execFileSync('pdfinfo', [pdf], { encoding: 'utf8' }), text = execFileSync('pdftotext', [pdf, '-'], { encoding: 'utf8' });
  assert.match(info, /Page size:\s+59[45]\.\d* x 84[12]/);
  const pages = Number(/Pages:\s+(\d+)/.exec(info)[1]);
  assert.ok(pages >= 3 && pages <= 14, `${pages} pages`);
  for (const part of ['Summary', 'Energy balance', '3D view', 'Intensity', 'Zonal flux', 'Where this comes from', 'focal_mm']) {
    assert.ok(text.includes(part), part);
  }
  assert.ok(!text.includes('Save PNG'));
  await page.context().close();
});
