// SPDX-License-Identifier: Apache-2.0
// The report of a real design in a real browser: the beam of another mirror is the target.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { canvasPixels, launch, lucerna, open, readCsv, temporaryFolder } from './browser.mjs';
import { commonTests } from './common.mjs';
import { ready } from './ready.mjs';

const folder = temporaryFolder(), file = join(folder, 'design.html'), found = join(folder, 'found');
const project = (focal, rest) => `
[[source]]
kind = "disk"
radius_mm = 0.5
flux_lm = 1000
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = ${focal}
diameter_mm = 60
position_mm = [0, 0, 15]
axis = "-z"
reflectance = 0.9
[[detector]]
name = "far"
kind = "far-field"
c_step_deg = 5
gamma_step_deg = 1
${rest}`;
let browser;

before(async () => {
  writeFileSync(join(folder, 'wanted.toml'), project(17, ''));
  lucerna(folder, 'trace', 'wanted.toml', '-o', 'wanted', '--rays', '300000', '--quiet');
  writeFileSync(join(folder, 'design.toml'), project(15, '[target]\nfile = "wanted/far.ldt"\n[design]\nattempts = 1\ntime_s = 30\n[design.limits]\nmax_height_mm = 30\n'));
  lucerna(folder, 'design', 'design.toml', '-o', 'found', '--rays', '65536', '--report', 'design.html', '--quiet');
  browser = await launch();
});
after(() => browser?.close());

commonTests({
  browser: () => browser, file, folder: found, figures: 50, pages: [5, 18], scene: true,
  parts: ['Summary', 'What limits it', 'Target and result', 'Convergence', 'Efficiency and losses', '3D view', 'Intensity', 'profile_mm'],
});

test('the curve of the convergence is history.csv', async () => {
  const page = await open(browser, file);
  const header = readFileSync(join(found, 'history.csv'), 'utf8').split('\n')[0].split(',');
  const column = name => header.indexOf(name), rows = readCsv(join(found, 'history.csv'));
  const curves = await page.evaluate(() => lucerna.plots.curves.find(p => p.y.startsWith('relative RMS')).curves);
  const accepted = rows.filter(r => r[column('accepted')] === 1), curve = curves.find(c => c.name === 'accepted');
  assert.equal(curve.x.length, accepted.length);
  accepted.forEach((r, i) => {
    assert.ok(Math.abs(curve.x[i] - 1e-6 * r[column('total_rays')]) < 1e-9);
    assert.ok(Math.abs(curve.y[i] - 100 * r[column('relative_rms')]) < 1e-9);
  });
  assert.equal(curves.find(c => c.name === 'noise').x.length, rows.length);
  await page.context().close();
});

test('target and result are those of the files, and their difference is shown', async () => {
  const page = await open(browser, file);
  await ready(page, { scene: true });
  const rows = readCsv(join(found, 'far.csv')), wanted = readCsv(join(folder, 'wanted/far.csv'));
  const at = (table, c, g) => table.find(r => r[0] === c && r[1] === g)[2];
  const shown = await page.evaluate(() => [[0, 0], [0, 3], [90, 5], [180, 10]].map(([c, g]) =>
    [c, g, lucerna.intensityAt(lucerna.fields[0], c, g), lucerna.intensityAt(lucerna.fields[1], c, g)]));
  const scale = shown[1][3] / at(wanted, 0, 3);
  for (const [c, g, result, target] of shown) {
    assert.ok(Math.abs(result - at(rows, c, g)) <= 1e-5 * result, `result at C${c}, ${g}`);
    assert.ok(Math.abs(target - scale * at(wanted, c, g)) <= 0.02 * scale * at(wanted, 0, 0), `target at C${c}, ${g}`);
  }
  const map = page.locator('figure.map').first(), pixels = () => map.locator('canvas').evaluate(c => c.toDataURL());
  const result = await pixels();
  await map.locator('.shown').selectOption('target');
  const target = await pixels();
  await map.locator('.shown').selectOption('difference');
  const difference = await pixels();
  assert.ok(result !== target && target !== difference);
  await map.locator('.stage').press('ArrowUp');
  assert.match(await map.locator('output.cursor').textContent(), /target [\d.]+ cd/);
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

test('the mirror found is drawn and turns', async () => {
  const page = await open(browser, file);
  await ready(page, { scene: true });
  const first = await canvasPixels(page);
  assert.ok(first.share > 0.02 && first.colours > 200);
  await page.locator('.scene3d canvas').press('ArrowLeft');
  assert.notEqual((await canvasPixels(page)).sum, first.sum);
  await page.context().close();
});

test('lucerna report makes the same page from the folder', async () => {
  lucerna(folder, 'report', 'found', '-o', 'later.html', '--quiet');
  assert.equal(readFileSync(join(folder, 'later.html'), 'utf8'), readFileSync(file, 'utf8'));
});
