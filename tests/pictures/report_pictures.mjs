// Pictures of parts of a report page, as a laptop shows them.
// usage: node report_pictures.mjs REPORT.html WEB_BUILD_FOLDER FOLDER_OF_PICTURES

import {createRequire} from 'node:module';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [, , report, webBuild, pictures] = process.argv;
const SHOWN_FRAME = 58; // of the demo's 90: all three objects are well in view
const MARGIN = 16;
const HEIGHT = 768;
const WIDTH = 1366;
// The tall one: narrower, it is smaller.
const WIDTH_OF = {figures: 1000};
// A picture: from the top of one element to the bottom of another.
const PARTS = {replay: ['#replay', '#layers'], errors: ['#errors', '#error-charts'], paths: ['#paths', '#axes-note'],
  figures: ['#error-tables', '#stage-table']};

const {default: puppeteer} = await import(
  pathToFileURL(createRequire(join(resolve(webBuild), 'package.json')).resolve('puppeteer-core')));
const browser = await puppeteer.launch({
  executablePath: '/usr/bin/chromium', headless: true,
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
try {
  const page = await browser.newPage();
  await page.setViewport({width: WIDTH, height: HEIGHT});
  await page.goto(pathToFileURL(resolve(report)).href, {waitUntil: 'load'});
  await page.$eval('#position', (slider, frame) => {
    slider.value = frame;
    slider.dispatchEvent(new Event('input'));
  }, String(SHOWN_FRAME));
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  for (const [name, ends] of Object.entries(PARTS)) {
    await page.setViewport({width: WIDTH_OF[name] ?? WIDTH, height: HEIGHT});
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    const clip = await page.evaluate(([first, last], margin) => {
      const from = document.querySelector(first).getBoundingClientRect();
      const to = document.querySelector(last).getBoundingClientRect();
      // A section begins with the line above its heading, which stays out; a table begins with its heading.
      const top = from.top + (document.querySelector(first).matches('section') ? 2 : -margin / 2);
      return {x: from.left - margin, y: top + window.scrollY, width: from.width + 2 * margin, height: to.bottom - top + margin / 2};
    }, ends, MARGIN);
    await page.screenshot({path: join(pictures, `report_${name}.png`), clip});
  }
} finally {
  await browser.close();
}
