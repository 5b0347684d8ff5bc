// SPDX-License-Identifier: Apache-2.0
// One headless Chromium for the tests of a file, and pages that note what they ask for and complain of.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

export const program = process.env.LUCERNA;
if (!program || !existsSync(program)) throw new Error('set LUCERNA to the program; or run: make test-report');

const executablePath = process.env.CHROMIUM || '/usr/bin/chromium';
const flags = ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
  '--disable-background-networking', '--disable-component-update', '--disable-sync'];

export const launch = (more = []) => chromium.launch({ executablePath, args: [...flags, ...more] });

export const temporaryFolder = () => {
  const folder = mkdtempSync(join(tmpdir(), 'lucerna-report-'));
  process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
  return folder;
};

export const lucerna = (folder, ...words) => execFileSync(program, words, { cwd: folder, encoding: 'utf8' });

// A page with the file open and all parts drawn; `page.requests` and `page.complaints` fill as it lives.
export const open = async (browser, file, options = {}) => {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  const page = await context.newPage();
  page.requests = [];
  page.complaints = [];
  page.on('request', r => page.requests.push(r.url()));
  page.on('pageerror', e => page.complaints.push(String(e)));
  // What the tests themselves cause by reading pixels is no complaint of the page.
  page.on('console', m => {
    if (/^(error|warning)$/.test(m.type()) && !/ReadPixels|getImageData/.test(m.text())) page.complaints.push(m.text());
  });
  await page.goto(pathToFileURL(file).href);
  await page.waitForSelector('html[data-complete]');
  return page;
};

// How many different colours a screenshot of the canvas has, and its bytes to compare.
export const canvasPixels = page => page.evaluate(() => {
  const canvas = document.querySelector(".scene3d canvas"), copy = document.createElement('canvas');
  copy.width = canvas.width;
  copy.height = canvas.height;
  const context = copy.getContext('2d');
  context.drawImage(canvas, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height), colours = new Set();
  let drawn = 0, sum = 0;
  for (let i = 0; i < data.length; i += 4) {
    if (!data[i + 3]) continue;
    ++drawn;
    colours.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
    sum = (sum * 31 + data[i] + 256 * data[i + 1] + i) % 2147483647;
  }
  return { drawn, share: drawn / (data.length / 4), colours: colours.size, sum };
});

// The rows of a CSV file as numbers, without its header.
export const readCsv = file => readFileSync(file, 'utf8').trim().split('\n').slice(1).map(line => line.split(',').map(Number));
