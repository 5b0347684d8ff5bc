// SPDX-License-Identifier: Apache-2.0
// All that is drawn by scripts is there.
export const ready = async (page, { scene, model } = {}) => {
  await page.waitForSelector('html[data-complete]');
  if (scene) await page.waitForSelector('.scene3d canvas[data-drawn]');
  if (model) await page.waitForFunction(() => Number(document.querySelector('#luminance canvas').dataset.drawn) >= 2);
};
