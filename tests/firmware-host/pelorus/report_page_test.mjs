// The report in a browser: a rendered dive is replayed and reported, and the page opened in Chromium without network.
// usage: node report_page_test.mjs PELORUS WEB_BUILD_FOLDER SCENE
// Exit codes: 0 passed, 1 failed, 77 skipped (no Chromium here, and PELORUS_CI is not set).

import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {delimiter, join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {checkLabels, checkLongName, checkNames, checkOneFrame, checkParts, checkUnknown} from './report_page/parts.mjs';
import {checkEnd, checkFollow, checkOrbit, checkOutlinesMove, checkPlay, checkViews} from './report_page/play.mjs';
import {checkPrint} from './report_page/print.mjs';
import {distances, outlineMiddles} from './report_page/results.mjs';

const [, , pelorus, webBuild, scene] = process.argv;
const VIEWPORT = {width: 1366, height: 768}; // a laptop's
const PROTOCOL_WAIT_MS = 180_000; // drawn by the processor, which may be busy

function findChromium() {
  for (const folder of (process.env.PATH ?? '').split(delimiter)) {
    for (const name of ['chromium', 'chromium-browser', 'google-chrome']) {
      if (existsSync(join(folder, name))) return join(folder, name);
    }
  }
  return null;
}

function report(out, more) {
  execFileSync(pelorus, ['replay', scene, '--out', out, ...more], {stdio: 'inherit'});
  execFileSync(pelorus, ['report', out, scene], {stdio: 'inherit'});
  return join(out, 'report.html');
}

// A page of the same run with other figures in it.
function changed(file, name, change) {
  const page = readFileSync(file, 'utf8');
  const other = file.replace('.html', `_${name}.html`);
  writeFileSync(other, page.replace(/(<script id="run" type="application\/json">)(.*?)(<\/script>)/s, (_, open, data, close) => {
    const run = JSON.parse(data);
    change(run);
    return open + JSON.stringify(run).replaceAll('<', '\\u003c') + close;
  }));
  return other;
}

// Nothing can be said about some figures.
const withUnknown = (file) => changed(file, 'unknown', ({evaluation: {camera, objects}}) => {
  camera.final_drift_percent = null;
  camera.step_m = camera.step_rad = null;
  camera.ate_rmse_m = undefined; // absent
  objects.right_count_share = objects.right_count_settled_share = null;
});

const LONG_TRUE_NAME = `crate ${'of the second dive '.repeat(5)}`.trim();
const LONG_NAME = `${[...Array(20).keys()].map((i) => `#${i + 1} `).join('')}${LONG_TRUE_NAME}`;
const withLongName = (file) => changed(file, 'long', ({errors: {bodies}}) =>
  Object.assign(bodies[0], {name: LONG_NAME, short_name: `#1 +19 ${LONG_TRUE_NAME}`}));

// Errors of the page, while `look` looks at it.
async function open(browser, file, look) {
  const page = await browser.newPage();
  await page.setViewport(VIEWPORT);
  const problems = [];
  page.on('console', (message) => message.type() === 'error' && problems.push(message.text()));
  page.on('pageerror', (error) => problems.push(error.message));
  page.on('request', (request) => /^(file|data|blob):/.test(request.url()) || problems.push(`asks for ${request.url()}`));
  await page.setOfflineMode(true);
  await page.goto(pathToFileURL(file).href, {waitUntil: 'load'});
  await look(page);
  await page.close();
  assert.deepEqual(problems, [], 'errors of the page');
}

async function lookAtRun(page, out) {
  const expected = distances(out);
  await checkParts(page);
  await checkNames(page);
  await checkPlay(page, expected);
  await checkOutlinesMove(page, outlineMiddles(out));
  await checkOrbit(page);
  await checkFollow(page);
  await checkEnd(page, expected.length - 1);
  await checkViews(page);
  await checkPrint(page);
}

async function run(chromium, folder) {
  checkLabels();
  const out = join(folder, 'out');
  const file = report(out, ['--overlay', '--overlay-every', '5']);
  assert.ok(statSync(file).size < 5_000_000, `${statSync(file).size} bytes`);
  const oneFrame = report(join(folder, 'one'), ['--frames', '1']);
  const {default: puppeteer} = await import(
    pathToFileURL(createRequire(join(resolve(webBuild), 'package.json')).resolve('puppeteer-core')));
  const browser = await puppeteer.launch({
    executablePath: chromium, headless: true, protocolTimeout: PROTOCOL_WAIT_MS,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
  try {
    await open(browser, file, (page) => lookAtRun(page, out));
    await open(browser, oneFrame, checkOneFrame);
    await open(browser, withUnknown(file), checkUnknown);
    await open(browser, withLongName(file), (page) => checkLongName(page, LONG_NAME));
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
