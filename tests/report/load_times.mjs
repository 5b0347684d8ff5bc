// SPDX-License-Identifier: Apache-2.0
// node load_times.mjs REPORT.html [TIMES = 5]: when a report is painted, loaded and drawn to its last part, in ms from the
// start of its navigation: first in a browser that has just been started, then in new windows of the same one.
import { launch, open } from './browser.mjs';

const [file, times = 5] = process.argv.slice(2);
let start = performance.now();
const browser = await launch();
console.log(`browser started in ${(performance.now() - start).toFixed(0)} ms`);
for (let i = 0; i < times; ++i) {
  start = performance.now();
  const page = await open(browser, file), all = performance.now() - start;
  const [painted, loaded, drawn] = await page.evaluate(() => [
    performance.getEntriesByName('first-contentful-paint')[0]?.startTime, performance.getEntriesByType('navigation')[0].loadEventEnd,
    performance.getEntriesByName('complete')[0].startTime].map(Math.round));
  console.log(`${i ? 'warm' : 'cold'}: painted ${painted}, loaded ${loaded}, all parts drawn ${drawn}; with the new window ${all.toFixed(0)}`);
  await page.context().close();
}
await browser.close();
