// SPDX-License-Identifier: Apache-2.0
// The site that `make docs` builds, in a real browser (make test-site): every page at two widths, its links, and the search.
import assert from 'node:assert/strict';
import { existsSync, readdirSync } from 'node:fs';
import { join, relative, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const site = resolve(process.env.SITE || 'build/docs');
if (!existsSync(join(site, 'docs/index.html'))) throw new Error(`${site} has no site; or run: make test-site`);

// Pages of ours; those of Doxygen's own design are read for links only.
const files = readdirSync(site, { recursive: true }).filter(f => f.endsWith('.html'));
const pages = files.filter(f => !f.startsWith('api/') && f !== 'index.html');  // which leads on to docs/index.html
const widths = [1280, 400];

let browser;
before(async () => {
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM || '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
      '--disable-component-update', '--disable-sync'],
  });
});
after(() => browser.close());

const open = async (file, width) => {
  const context = await browser.newContext({ viewport: { width, height: 900 } }), page = await context.newPage();
  page.complaints = [];
  page.on('pageerror', e => page.complaints.push(String(e)));
  page.on('requestfailed', r => page.complaints.push(`failed: ${r.url()}`));
  page.on('request', r => { if (!/^(file|data|blob):/.test(r.url())) page.complaints.push(`asks for ${r.url()}`); });
  await page.goto(pathToFileURL(join(site, file)).href);
  return page;
};

// Wider than the window is only what scrolls by itself: code and tables.
const overflow = page => page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);

for (const width of widths) {
  test(`${pages.length} pages fit into ${width} pixels, have their pictures and ask nothing of any network`, async () => {
    assert.ok(pages.length > 60, `${pages.length} pages`);
    for (const file of pages) {
      const page = await open(file, width);
      const broken = await page.$$eval('img', all => all.filter(i => i.complete && !i.naturalWidth).map(i => i.src));
      assert.deepEqual(broken, [], file);
      assert.deepEqual(page.complaints, [], file);
      assert.ok(await overflow(page) <= 0, `${file} is ${await overflow(page)} pixels too wide at ${width}`);
      assert.ok((await page.title()).length > 0, file);
      await page.context().close();
    }
  });
}

test('every link leads to a page that is there, and to a place on it', async () => {
  const places = new Map(), links = [];
  for (const file of pages) {
    const page = await open(file, 1280);
    places.set(file, new Set(await page.$$eval('[id]', all => all.map(e => e.id))));
    for (const href of await page.$$eval('a[href]', all => all.map(a => a.href))) links.push([file, new URL(href)]);
    await page.context().close();
  }
  for (const [from, link] of links) {
    if (link.protocol !== 'file:') continue;
    const to = relative(site, fileURLToPath(new URL(link.pathname, 'file:///')));
    assert.ok(existsSync(join(site, to)), `${from} links to ${to}`);
    const place = decodeURIComponent(link.hash.slice(1));
    if (place && places.has(to)) assert.ok(places.get(to).has(place), `${from} links to ${to}#${place}`);
  }
  assert.ok(links.length > 1000, `${links.length} links`);
});

test('the search finds words of the pages, and nothing for a word that there is not', async () => {
  const found = async words => {
    const page = await open('docs/index.html', 1280);
    await page.fill('input[name=q]', words);
    await page.press('input[name=q]', 'Enter');
    await page.waitForSelector('#search-results .search-summary:not(:empty)');
    await page.waitForFunction(() => /finished|did not match/.test(document.querySelector('#search-results').textContent));
    const titles = await page.$$eval('#search-results ul.search li a', all => all.map(a => a.textContent));
    await page.context().close();
    return titles;
  };
  assert.ok((await found('focal_mm')).includes('Project files'));
  assert.ok((await found('paraboloid')).some(t => t.startsWith('Tutorial 2')));
  assert.deepEqual(await found('xyzzyxyzzy'), []);
});

test('on a narrow window the menu opens and leads on', async () => {
  const page = await open('docs/index.html', 400);
  await page.click('label.nav-overlay-icon, .nav-overlay-icon');
  await page.click('.sidebar-tree a >> text=Installing Lucerna');
  await page.waitForURL(/install\.html$/);
  assert.match(await page.title(), /Installing/);
  await page.context().close();
});
