// The parts of the page: charts, tables, names.

import assert from 'node:assert/strict';
import {CHARACTER_WIDTH, LABEL_HEIGHT, labelMargin, labelText, placeLabels} from '../../../../firmware-host/pelorus/report/web/src/labels.mjs';

export async function checkParts(page) {
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
  assert.ok(found.width <= page.viewport().width, `${found.width} px wide: wider than the screen`);
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

// The crate, the scene's one body, is called the same wherever it appears; dashes are kept for the truth.
export async function checkNames(page) {
  const found = await page.evaluate(() => {
    const texts = (selector) => [...document.querySelectorAll(selector)].map((node) => node.textContent);
    return {
      places: ['#paths .legend', '#top-view', '#side-view', '#errors .legend', '#error-charts', '#error-tables', '#facts']
        .map((place) => [place, document.querySelector(place).textContent]),
      ends: texts('#error-charts .end-label'),
      pathEnds: texts('#paths .end-label'),
      all: document.querySelector('main').textContent,
      dashed: [...document.querySelectorAll('svg [stroke-dasharray]')].map((line) => line.closest('section').id),
      marks: [...document.querySelectorAll('.legend span')].filter((span) => span.querySelector('i').style.borderTopStyle === 'dashed')
        .map((span) => span.textContent),
      outside: [...document.querySelectorAll('.end-label')].filter((label) => {
        const [inner, outer] = [label, label.ownerSVGElement].map((node) => node.getBoundingClientRect());
        return inner.right > outer.right + 1 || inner.left < outer.left - 1;
      }).map((label) => label.textContent),
    };
  });
  const crate = /#\d+ crate/.exec(found.all)?.[0];
  assert.ok(crate, 'the crate was found');
  for (const [place, text] of found.places) assert.ok(text.includes(crate), `${crate} in ${place}: ${text}`);
  // The name stands for itself wherever either part of it appears.
  for (const text of found.all.match(/(#\d+)( crate)?|crate/g)) assert.match(text, /^#\d+( crate)?$/, 'no other name');
  assert.doesNotMatch(found.all, /object \d|\(#/);
  assert.equal(found.ends.filter((name) => name === crate).length, 4, 'its curve is labeled in each chart of errors');
  assert.equal(found.ends.filter((name) => name === 'vehicle').length, 4);
  assert.equal(found.pathEnds.filter((name) => name === crate).length, 2, 'its path in each view');
  assert.deepEqual(found.outside, [], 'labels within their charts');
  assert.deepEqual(found.marks, ['truth']);
  assert.ok(found.dashed.length > 0 && found.dashed.every((section) => section === 'paths'), `dashed lines in ${found.dashed}`);
}

// Of a run of one frame there is nothing to draw over time: the page says so and has no empty axes.
export async function checkOneFrame(page) {
  const found = await page.evaluate(() => ({
    axes: document.querySelectorAll('svg [aria-label$="-axis tick label"]').length,
    notes: Object.fromEntries(['paths', 'errors', 'states', 'stages'].map((id) => [id, document.getElementById(id).innerText])),
    latency: document.getElementById('latency').innerText,
    all: document.querySelector('main').innerText,
  }));
  assert.equal(found.axes, 0, 'no axes without anything between them');
  for (const [section, text] of Object.entries(found.notes)) assert.match(text, /One frame: no/, section);
  assert.match(found.latency, /One frame, [\d.]+ ms/);
  assert.doesNotMatch(found.all, /NaN|undefined|Infinity|1 frames/);
}

// Figures that are not known are left out or "-", never 0.
export async function checkUnknown(page) {
  const facts = await page.$$eval('#facts div', (all) => all.map((one) => one.innerText.replaceAll('\n', ' ')));
  const fact = (name) => facts.find((text) => text.startsWith(name));
  assert.doesNotMatch(fact('Final drift'), /%/);
  assert.equal(fact('Right number of motions'), 'Right number of motions -');
  assert.equal(fact('Local error'), 'Local error, mean - -');
  assert.doesNotMatch(await page.$eval('main', (main) => main.innerText), /NaN|undefined|null/);
}

// A body seen under twenty numbers, with a true name as long as a line: curves keep their room, the legend has it all.
export async function checkLongName(page, name) {
  const charts = await page.$$eval('#error-charts svg', (all) => all.map((svg) => {
    const widths = [...svg.querySelectorAll('[aria-label="line"] path')].map((path) => path.getBoundingClientRect().width);
    const whole = svg.getBoundingClientRect();
    return {curves: Math.max(...widths) / whole.width,
      outside: [...svg.querySelectorAll('.end-label')].filter((label) => label.getBoundingClientRect().right > whole.right + 1).length};
  }));
  assert.equal(charts.length, 4);
  for (const {curves, outside} of charts) {
    assert.ok(curves > 0.5, `curves take ${curves} of the width of their chart`);
    assert.equal(outside, 0, 'labels within their charts');
  }
  assert.ok((await page.$eval('#errors .legend', (legend) => legend.textContent)).includes(name));
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(width <= page.viewport().width, `${width} px wide: wider than the screen`);
}

// Names of paths that end at one place, in a corner of the view.
export function checkLabels() {
  assert.ok(CHARACTER_WIDTH > 7, 'bold letters of 13 px');
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
  assert.equal(labelText('#1 crate'), '#1 crate');
  assert.equal(labelMargin(['#1 crate', 'vehicle']), 12 + 8 * CHARACTER_WIDTH);
  assert.ok(labelMargin(['x'.repeat(300)]) < 200, 'no name takes the room of the curves');
}
