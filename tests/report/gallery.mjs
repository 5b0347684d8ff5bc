// SPDX-License-Identifier: Apache-2.0
// node gallery.mjs FOLDER OUT: photographs the reports in FOLDER (scripts/gallery.sh makes them).
import { statSync } from 'node:fs';
import { join } from 'node:path';
import { launch, open } from './browser.mjs';
import { ready } from './ready.mjs';

const [folder, out] = process.argv.slice(2), browser = await launch();
const shoot = async (report, name, scheme, viewport, act, model = false) => {
  const page = await open(browser, join(folder, report), { colorScheme: scheme, viewport });
  await ready(page, { scene: !model, model });
  const target = (await act(page)) || page;
  const path = join(out, name);
  await target.screenshot({ path });
  console.log(`${path}: ${statSync(path).size} bytes`);
  if (statSync(path).size > 300000) throw new Error(`${name} is larger than 300 kB`);
  await page.context().close();
};

await shoot('led.html', 'report.png', 'light', { width: 1024, height: 700 }, async () => null);
await shoot('filament.html', 'view-dark.png', 'dark', { width: 1024, height: 900 }, async page => {
  for (let i = 0; i < 3; ++i) await page.locator('.scene3d canvas').press('+');
  await page.locator('#layer-rays0').uncheck();
  return page.locator('#view');
});
await shoot('filament.html', 'solid.png', 'light', { width: 1024, height: 900 }, async page => {
  await page.locator('#layer-solid').check();
  for (const id of ['rays0', 'rays1', 'rays2', 'rays3']) {
    const tick = page.locator('#layer-' + id);
    if (await tick.count()) await tick.uncheck();
  }
  await page.locator('#colouring').selectOption('curvature');
  return page.locator('.scene3d canvas');
});
await shoot('filament.html', 'intensity.png', 'light', { width: 620, height: 900 }, async page => page.locator('figure.map'));
const wide = { width: 1180, height: 900 };
await shoot('dies.html', 'model.png', 'light', wide, async page => {
  await page.locator('#luminance .azimuth').fill('-60');
  await page.locator('#luminance .height').fill('40');
  await page.locator('#luminance .log').check();
  await page.waitForTimeout(600);
  return page.locator('#look');
}, true);
await shoot('dies.html', 'views.png', 'dark', wide, async page => page.locator('#views .trio').nth(2), true);
await shoot('mirror.html', 'design.png', 'light', wide, async page => page.locator('#target .plots'));
await shoot('mirror.html', 'convergence.png', 'dark', { width: 760, height: 900 }, async page => page.locator('#convergence figure'));
await browser.close();
