// The report in a browser: a rendered dive is replayed and reported, and the page opened in Chromium without network.
// usage: node report_page_test.mjs PELORUS WEB_BUILD_FOLDER SCENE
// Exit codes: 0 passed, 1 failed, 77 skipped (no Chromium here, and PELORUS_CI is not set).

import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, rmSync, statSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {delimiter, join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {LABEL_HEIGHT, placeLabels} from '../../../firmware-host/pelorus/report/web/src/labels.mjs';

const [, , pelorus, webBuild, scene] = process.argv;
const VIEWPORT = {width: 1366, height: 768}; // a laptop's
const WAIT_MS = 60_000; // drawn by the processor, which may be busy

function findChromium() {
  for (const folder of (process.env.PATH ?? '').split(delimiter)) {
    for (const name of ['chromium', 'chromium-browser', 'google-chrome']) {
      if (existsSync(join(folder, name))) return join(folder, name);
    }
  }
  return null;
}

// The distance of the vehicle from the start in each frame, as camera.tum has it.
function distances(folder) {
  const rows = readFileSync(join(folder, 'camera.tum'), 'utf8').trim().split('\n');
  return rows.map((row) => Math.hypot(...row.split(' ').slice(1, 4).map(Number)));
}

const hooks = (page) => page.evaluate(() => ({...document.body.dataset}));
const numbers = (text) => text.split(' ').map(Number);
const reach = (page, frame) =>
  page.waitForFunction((wanted) => Number(document.body.dataset.frame) >= wanted, {timeout: WAIT_MS}, frame);

async function checkPlay(page, expected) {
  const stage = await page.$('#stage');
  const before = await hooks(page);
  assert.equal(before.frame, '0');
  const pictureBefore = await stage.screenshot();
  await page.click('#play');
  await reach(page, 5);
  await page.click('#play');
  assert.equal(await page.$eval('#play', (button) => button.textContent), 'Play', 'a second click pauses');
  const after = await hooks(page);
  assert.notEqual(after.vehicle, before.vehicle, 'the vehicle moves');
  // Where the page draws the vehicle is where the pipeline saw it.
  assert.ok(Math.abs(Math.hypot(...numbers(after.vehicle)) - expected[Number(after.frame)]) < 1e-4,
    `vehicle at ${after.vehicle} in frame ${after.frame}, expected ${expected[Number(after.frame)]} m from the start`);
  assert.ok(!pictureBefore.equals(await stage.screenshot()), 'the picture changes');
  assert.equal(await page.$eval('#position', (slider) => slider.value), after.frame);
}

async function checkFollow(page) {
  assert.notEqual((await hooks(page)).target, (await hooks(page)).vehicle);
  await page.click('#follow');
  const from = Number((await hooks(page)).frame);
  await page.click('#play');
  await reach(page, from + 3);
  await page.click('#play');
  const {target, vehicle} = await hooks(page);
  const miss = Math.hypot(...numbers(target).map((x, i) => x - numbers(vehicle)[i]));
  assert.ok(miss < 1e-3, `the view follows: its target is ${miss} m from the vehicle`);
}

async function checkEnd(page, last) {
  await page.select('#speed', '16');
  await page.click('#play');
  await reach(page, last);
  await page.waitForFunction(() => document.getElementById('play').textContent === 'Play', {timeout: WAIT_MS});
}

async function checkViews(page) {
  const pictures = [];
  for (const view of ['top', 'side', 'camera', 'scene']) {
    await page.select('#view', view);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    pictures.push((await (await page.$('#stage')).screenshot()).toString('base64'));
  }
  assert.equal(new Set(pictures).size, pictures.length, 'each view shows something else');
}

async function checkParts(page) {
  const found = await page.evaluate(() => {
    const visible = (node) => node && node.getBoundingClientRect().height > 0;
    const charts = [...document.querySelectorAll('svg')];
    return {
      width: document.documentElement.scrollWidth,
      paths: ['#top-view', '#side-view'].map((id) => document.querySelectorAll(`${id} svg path`).length),
      errorCharts: document.querySelectorAll('#error-charts svg').length,
      stateBars: document.querySelectorAll('#state-bar svg rect').length,
      latencyMarks: document.getElementById('latency-chart').textContent,
      tableRows: document.querySelectorAll('#error-tables tbody tr').length,
      stageRows: document.querySelectorAll('#stage-table tbody tr').length,
      pictures: [...document.querySelectorAll('#pictures img')].map((image) => image.naturalWidth),
      axes: charts.flatMap((chart) => [...chart.querySelectorAll('[aria-label$="-axis label"]')]).map((axis) => axis.textContent),
      hidden: ['top-view', 'error-charts', 'state-bar', 'latency-chart', 'stage-table'].filter((id) => !visible(document.getElementById(id))),
      facts: document.getElementById('facts').textContent,
      wrong: /NaN|undefined|Infinity/.test(document.querySelector('main').textContent),
    };
  });
  assert.ok(found.width <= VIEWPORT.width, `${found.width} px wide: wider than the screen`);
  assert.ok(found.paths.every((count) => count >= 3), 'vehicle, truth and objects have paths');
  assert.equal(found.errorCharts, 4);
  assert.ok(found.stateBars >= 2, 'INIT and TRACKING');
  assert.match(found.latencyMarks, /p50.*p99.*p99\.9/s);
  assert.ok(found.tableRows >= 8, 'errors of the vehicle and of a body');
  assert.ok(found.stageRows >= 14, 'outcomes and times of seven stages');
  assert.ok(found.pictures.length >= 3 && found.pictures.every((width) => width > 100), `pictures ${found.pictures}`);
  assert.ok(found.axes.length >= 2 * found.errorCharts + 4, `axes: ${found.axes}`);
  for (const axis of found.axes) assert.match(axis, /\[(m|cm|s|ms|deg)\]|points|frames/, 'every axis has a unit');
  assert.deepEqual(found.hidden, []);
  assert.match(found.facts, /Local error/);
  assert.ok(!found.wrong, 'no figure is NaN');
}

// Names of paths that end at one place, in a corner of the view.
function checkLabels() {
  const box = {left: 50, right: 600, top: 10, bottom: 300};
  const labels = [[590, 295], [588, 296], [590, 290], [300, 12], [310, 11], [300, 200]].map(([x, y]) => ({x, y, width: 70}));
  const placed = placeLabels(labels, box);
  placed.forEach((a, i) => {
    assert.ok(a.x >= box.left && a.x + 70 <= box.right, `label ${i} at ${a.x}: within the view`);
    assert.ok(a.y >= box.top && a.y <= box.bottom, `label ${i} at height ${a.y}: within the view`);
    for (const b of placed.slice(0, i)) {
      assert.ok(Math.abs(a.x - b.x) >= 70 || Math.abs(a.y - b.y) >= LABEL_HEIGHT, `label ${i} lies over another`);
    }
  });
  assert.equal(placed[5].y, 200, 'one that stands alone stays at its end');
}

async function checkPrint(page) {
  await page.emulateMediaType('print');
  await page.setViewport({...VIEWPORT, width: 700}); // paper is narrower than a screen
  const shown = await page.evaluate(() =>
    ['replay', 'top-view'].map((id) => getComputedStyle(document.getElementById(id)).display));
  assert.equal(shown[0], 'none');
  assert.notEqual(shown[1], 'none');
  const columns = await page.$eval('#error-charts', (grid) => getComputedStyle(grid).gridTemplateColumns.split(' ').length);
  assert.equal(columns, 2, 'charts stand side by side on paper');
  await page.setViewport(VIEWPORT);
  await page.emulateMediaType(null);
}

async function run(chromium, folder) {
  const out = join(folder, 'out');
  execFileSync(pelorus, ['replay', scene, '--out', out, '--overlay', '--overlay-every', '5'], {stdio: 'inherit'});
  execFileSync(pelorus, ['report', out, scene], {stdio: 'inherit'});
  const file = join(out, 'report.html');
  assert.ok(statSync(file).size < 5_000_000, `${statSync(file).size} bytes`);
  const {default: puppeteer} = await import(
    pathToFileURL(createRequire(join(resolve(webBuild), 'package.json')).resolve('puppeteer-core')));
  const browser = await puppeteer.launch({
    executablePath: chromium, headless: true, protocolTimeout: 3 * WAIT_MS,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
  try {
    const page = await browser.newPage();
    await page.setViewport(VIEWPORT);
    const problems = [];
    page.on('console', (message) => message.type() === 'error' && problems.push(message.text()));
    page.on('pageerror', (error) => problems.push(error.message));
    page.on('request', (request) => /^(file|data|blob):/.test(request.url()) || problems.push(`asks for ${request.url()}`));
    await page.setOfflineMode(true);
    await page.goto(pathToFileURL(file).href, {waitUntil: 'load'});
    const expected = distances(out);
    checkLabels();
    await checkParts(page);
    await checkPlay(page, expected);
    await checkFollow(page);
    await checkEnd(page, expected.length - 1);
    await checkViews(page);
    await checkPrint(page);
    assert.deepEqual(problems, [], 'errors of the page');
  } finally {
    await browser.close();
  }
}

const chromium = findChromium();
if (!chromium) {
  console.log('skipped: no chromium here; on Debian: apt-get install chromium');
  process.exit(process.env.PELORUS_CI ? 1 : 77);
}
const folder = mkdtempSync(join(tmpdir(), 'pelorus_report_'));
try {
  await run(chromium, folder);
  console.log('passed');
} finally {
  rmSync(folder, {recursive: true, force: true});
}
