// SPDX-License-Identifier: Apache-2.0
// The reports of source models in a real browser: a measured LED where the data folder has it, else a simulated one.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { launch, lucerna, open, temporaryFolder } from './browser.mjs';
import { commonTests } from './common.mjs';
import { ready } from './ready.mjs';

const folder = temporaryFolder(), measured = join(process.env.LUCERNA_DATA_DIR || join(import.meta.dirname, '../../../shared/data'),
  'rayfiles/rayfile_LERTDUW_S2WP_green_100k_20161013_IES_TM25.TM25RAY');
let browser;
before(async () => { browser = await launch(); });
after(() => browser?.close());

// The luminance picture in the page: its values, and the flux that they and the intensity towards it agree on.
const picture = (page, direction, half, n) => page.evaluate(([d, h, size]) => {
  const image = lucerna.model.image(d, h, size);
  const most = Math.max(...image.value);
  let sum = 0, lit = 0;
  for (const v of image.value) { sum += v; lit += v > 0.05 * most ? 1 : 0; }
  // cd: luminance times area in m2.
  return { intensity: sum * (2 * h / size) ** 2 * 1e-6, lit: lit / image.value.length };
}, [direction, half, n]);

const orbit = async (page, act) => {
  const state = () => page.evaluate(() => {
    const canvas = document.querySelector('#luminance canvas');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height), colours = new Set();
    let sum = 0;
    for (let i = 0; i < data.length; i += 4) {
      colours.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
      sum = (sum * 31 + data[i] + 256 * data[i + 1] + i) % 2147483647;
    }
    return { colours: colours.size, sum };
  });
  const old = await state();
  await act();
  await page.waitForTimeout(60);
  const now = await state();
  return { changed: now.sum !== old.sum, colours: now.colours };
};

const modelTests = (name, make, { skip, lambert }) => describe(name, { skip }, () => {
  const file = join(folder, name + '.html');
  before(() => make(name));
  commonTests({
    browser: () => browser, file, figures: 30, pages: [3, 14], model: true, bytes: 3.5e6,
    parts: ['Summary', 'Luminance from any direction', 'five views', 'Étendue', 'What the model is made of', 'Where this comes from', 'excess'],
  });

  test('the page finds the luminance that the library finds', async () => {
    const page = await open(browser, file);
    await ready(page, { model: true });
    const pairs = await page.evaluate(() => lucerna.model.data.probes.map(p => [p.luminance, lucerna.model.luminance(p.origin, p.direction)]));
    assert.ok(pairs.length >= 8);
    if (await page.evaluate(() => Boolean(lucerna.model.data.layers))) {
      // A ray within rounding of a leaf's side may be read from the next one: one of them at the most.
      const off = pairs.filter(([wanted, found]) => Math.abs(found - wanted) > 1e-4 * wanted);
      assert.ok(off.length <= 1, JSON.stringify(off));
    }
    await page.context().close();
  });

  test('pictures hold the light that goes their way, and turn', async () => {
    const page = await open(browser, file);
    await ready(page, { model: true });
    const half = await page.evaluate(() => lucerna.model.data.radius_mm * 3);
    const front = await picture(page, [0, 0, 1], half, 256), aside = await picture(page, [Math.sin(1), 0, Math.cos(1)], half, 256);
    assert.ok(front.lit > 0.01 && front.lit < 0.9, `${front.lit} of the picture is lit`);
    if (lambert) {
      // cos law of a flat source of 500 lm: 500 / pi cd on the axis.
      assert.ok(Math.abs(front.intensity / (500 / Math.PI) - 1) < 0.06, `${front.intensity} cd`);
      assert.ok(Math.abs(aside.intensity / front.intensity - Math.cos(1)) < 0.06, `${aside.intensity} cd aside`);
    }
    const canvas = page.locator('#luminance canvas'), stage = page.locator('#luminance .stage');
    const keys = await orbit(page, () => stage.press('ArrowLeft'));
    assert.ok(keys.colours > 20, `${keys.colours} colours`);
    assert.ok((await orbit(page, () => stage.press('ArrowDown'))).changed);
    assert.ok((await orbit(page, () => stage.press('+'))).changed);
    assert.ok((await orbit(page, () => page.locator('#luminance .log').check())).changed);
    assert.ok((await orbit(page, () => page.locator('#luminance .borders').check())).changed);
    assert.ok((await orbit(page, () => page.locator('#luminance .colours').selectOption('cividis'))).changed);
    assert.ok((await orbit(page, () => page.locator('#luminance .from').selectOption('0 0'))).changed);
    await canvas.scrollIntoViewIfNeeded();
    const dragged = await orbit(page, async () => {
      const b = await canvas.boundingBox();
      await page.mouse.move(b.x + b.width / 2, b.y + b.height / 2);
      await page.mouse.down();
      await page.mouse.move(b.x + b.width / 2 + 60, b.y + b.height / 2 + 60, { steps: 3 });
      await page.mouse.up();
    });
    assert.ok(dragged.changed);
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  });

  test('the maps of the views are the shares of the flux', async () => {
    const page = await open(browser, file);
    const sums = await page.evaluate(() => lucerna.plots.grids.map(g => [g.diverging, g.value.reduce((a, b) => a + b, 0)]));
    assert.equal(sums.length, 15);
    // A window holds 99 % of the light that the view sees; the beam of a collimator does not see what passes beside it.
    for (let i = 0; i < 15; i += 3) {
      const [[, rays], [, model], [diverging, difference]] = sums.slice(i, i + 3);
      assert.ok(diverging && Math.abs(difference - (model - rays)) < 1e-2, String(sums.slice(i, i + 3)));
      for (const sum of [rays, model]) assert.ok(sum > 15 && sum < 100.001, String(sum));
    }
    await page.context().close();
  });
});

modelTests('measured', name => lucerna(folder, 'compress', measured, '-o', name + '.nfl', '--report', name + '.html', '--quiet'),
  { skip: existsSync(measured) ? false : 'no measured ray file (LUCERNA_DATA_DIR)' });
modelTests('clusters', name => {
  lucerna(folder, 'make-source', 'disk', '--flux-lm', '500', '--surface', 'none', '-n', '2e5', '-o', 'disk.tm25ray', '--quiet');
  lucerna(folder, 'compress', 'disk.tm25ray', '-o', name + '.nfl', '--method', 'clusters', '--report', name + '.html', '--quiet');
}, { lambert: true });
