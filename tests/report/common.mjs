// SPDX-License-Identifier: Apache-2.0
// What every kind of report must do, as tests of one file.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';
import { test } from 'node:test';
import { open } from './browser.mjs';
import { ready } from './ready.mjs';

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

const value = (object, pointer) => pointer.split('/').slice(1)
  .reduce((o, word) => o[word.replaceAll('~1', '/').replaceAll('~0', '~')], object);

// `file`: the report. `folder`: where the result.json is that it must agree with (none: the page's own). `figures`: at
// least so many with a data-key. `parts`: what the printed text must have. `pages`: least and most. `bytes`: upper limit.
export const commonTests = ({ browser, file, folder, figures, parts, pages, scene, model, bytes = 1.5e6 }) => {
  const opened = async options => {
    const page = await open(browser(), file, options);
    await ready(page, { scene, model });
    return page;
  };

  test('opens without a complaint or a request', async () => {
    const start = performance.now(), page = await opened();
    const seconds = (performance.now() - start) / 1000;
    const [load, painted, complete] = (await page.evaluate(() => [
      performance.getEntriesByType('navigation')[0].loadEventEnd, performance.getEntriesByName('first-contentful-paint')[0]?.startTime,
      performance.getEntriesByName('complete')[0].startTime])).map(ms => (ms / 1000).toFixed(2));
    // Printed, not asserted: a busy machine is no fault of the page (the bar is 2 s).
    console.log(`painted at ${painted} s, loaded at ${load} s, all parts drawn at ${complete} s, with the browser's new window ` +
      `${seconds.toFixed(2)} s, ${(statSync(file).size / 1e6).toFixed(2)} MB`);
    assert.ok(statSync(file).size < bytes, `${statSync(file).size} bytes`);
    assert.deepEqual(page.complaints, []);
    assert.deepEqual(page.requests.filter(url => !/^(file|data|blob):/.test(url)), []);
    assert.equal(page.requests.filter(url => url.startsWith('file:')).length, 1);
    await page.context().close();
  });

  test('every figure on the page is the one of the JSON', async () => {
    const page = await opened(), embedded = await page.$eval('#result', e => JSON.parse(e.textContent));
    const result = folder ? JSON.parse(readFileSync(join(folder, 'result.json'), 'utf8')) : embedded;
    assert.deepEqual(embedded, result);
    const shown = await page.$$eval('[data-key]', all => all.map(e => [e.dataset.key, e.textContent, Number(e.dataset.factor || 1)]));
    assert.ok(shown.length >= figures, `${shown.length} figures`);
    for (const [key, text, factor] of shown) {
      const expected = value(result, key), figure = text.split(' ± ')[0];
      if (expected === null) { assert.equal(figure, '–', key); continue; }
      const digits = (figure.split('.')[1] || '').length;
      const half = figure.includes('e') ? 1e-4 * Math.abs(expected) : 0.5001 * 10 ** -digits;
      assert.ok(Math.abs(Number(figure) - factor * expected) <= half, `${key}: ${figure}, not ${factor * expected}`);
    }
    await page.context().close();
  });

  test('every plot is drawn, says its values under the cursor and by keys, and can be saved', async () => {
    const page = await opened();
    const count = await page.locator('figure.plot, figure.map, figure.luminance').count();
    assert.ok(count > 1);
    for (let i = 0; i < count; ++i) {
      const figure = page.locator('figure.plot, figure.map, figure.luminance').nth(i), name = await figure.getAttribute('data-file');
      const box = await figure.locator('svg, canvas').first().boundingBox();
      assert.ok(box.width > 150 && box.height > 60, `${name}: ${box.width} x ${box.height}`);
      await figure.locator('.stage').press('ArrowRight');
      const text = await figure.locator('output.cursor').textContent();
      assert.match(text, /\d/, name);
      assert.doesNotMatch(text, /NaN|undefined|Infinity/, `${name}: ${text}`);
      const kinds = await figure.locator('[data-save]').evaluateAll(all => all.map(b => b.dataset.save));
      assert.ok(kinds.includes('svg') && kinds.includes('csv'), `${name} saves ${kinds}`);
      const [download] = await Promise.all([page.waitForEvent('download'), figure.locator('[data-save="csv"]').click()]);
      const lines = readFileSync(await download.path(), 'utf8').trim().split('\n');
      assert.ok(lines.length > 2 && !/NaN|undefined/.test(lines[1]), `${name}: ${lines[1]}`);
      const [picture] = await Promise.all([page.waitForEvent('download'), figure.locator('[data-save="svg"]').click()]);
      const svg = readFileSync(await picture.path(), 'utf8');
      assert.match(svg, /^<svg[\s\S]*<\/svg>$/, name);
      assert.doesNotMatch(svg, /class="mark"/, name);
    }
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  });

  for (const colorScheme of ['light', 'dark']) {
    for (const width of [1280, 1024, 390]) {
      test(`axe finds nothing and nothing sticks out: ${colorScheme}, ${width} px`, async () => {
        const page = await opened({ colorScheme, viewport: { width, height: 900 } });
        await page.locator('details').evaluateAll(all => all.forEach(d => { d.open = true; }));
        // Scripts may not be added to a page with this policy; the test's own may be run in it.
        await page.evaluate(axe);
        const { violations } = await page.evaluate(() => axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21aa', 'best-practice'] }));
        assert.deepEqual(violations.map(v => [v.id, v.nodes.map(n => n.html.slice(0, 120))]), []);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
        assert.ok(wide <= 0, `${wide} px too wide`);
        if (process.env.SHOTS && width !== 1280) {
          const name = `${file.split('/').at(-1).replace('.html', '')}-${colorScheme}-${width}.png`;
          await page.screenshot({ path: join(process.env.SHOTS, name), fullPage: true });
        }
        await page.context().close();
      });
    }
  }

  test('nothing moves while it loads', async () => {
    const context = await browser().newContext({ viewport: { width: 1024, height: 800 } }), page = await context.newPage();
    await page.addInitScript(() => {
      window.shift = 0;
      new PerformanceObserver(list => list.getEntries().forEach(e => { window.shift += e.value; }))
        .observe({ type: 'layout-shift', buffered: true });
    });
    await page.goto('file://' + file);
    await ready(page, { scene, model });
    await page.waitForTimeout(300);
    const shift = await page.evaluate(() => window.shift);
    assert.ok(shift < 0.02, `cumulative layout shift ${shift}`);
    await context.close();
  });

  test('prints to A4 with all its parts', async () => {
    const page = await opened(), pdf = join(dirname(file), 'printed.pdf');
    await page.pdf({ path: pdf, preferCSSPageSize: true, printBackground: true });
    const info = execFileSync('pdfinfo', [pdf], { encoding: 'utf8' }), text = execFileSync('pdftotext', [pdf, '-'], { encoding: 'utf8' });
    assert.match(info, /Page size:\s+59[45]\.\d* x 84[12]/);
    const count = Number(/Pages:\s+(\d+)/.exec(info)[1]);
    assert.ok(count >= pages[0] && count <= pages[1], `${count} pages`);
    for (const part of parts) assert.ok(text.includes(part), part);
    assert.ok(!text.includes('Save PNG'));
    if (process.env.SHOTS) execFileSync('cp', [pdf, join(process.env.SHOTS, file.split('/').at(-1).replace('.html', '.pdf'))]);
    await page.context().close();
  });
};
