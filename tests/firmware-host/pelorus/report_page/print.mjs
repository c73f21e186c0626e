// The page on paper, printed as a browser does it of itself: without backgrounds.

import assert from 'node:assert/strict';
import {inflateSync} from 'node:zlib';
import {seek, shown} from './play.mjs';

const MOST_PAGES = 6;

// Pages, pictures that are not JPEG, and what is drawn, of a PDF as Chromium writes it.
function readPdf(bytes) {
  const text = Buffer.from(bytes).toString('latin1');
  const streams = [...text.matchAll(/<<((?:[^<>]|<(?!<)|>(?!>))*)>> stream\n/g)].map((match) => {
    const length = Number(/\/Length (\d+)/.exec(match[1])?.[1]);
    const packed = Buffer.from(text.slice(match.index + match[0].length).slice(0, length), 'latin1');
    return {head: match[1], data: /FlateDecode/.test(match[1]) ? inflateSync(packed) : packed};
  });
  const number = (head, name) => Number(new RegExp(`/${name} (\\d+)`).exec(head)[1]);
  return {
    pages: [...text.matchAll(/\/Type \/Page\b(?!s)/g)].length,
    pictures: streams.filter(({head}) => /\/Subtype \/Image/.test(head) && /FlateDecode/.test(head) && /ICCBased|RGB/.test(head))
      .map(({head, data}) => ({width: number(head, 'Width'), height: number(head, 'Height'), data})),
    drawing: streams.filter(({head}) => !/\/Subtype|\/Type/.test(head)).map(({data}) => data.toString('latin1')).join('\n'),
  };
}

const printed = async (page, options = {}) => readPdf(await page.pdf({preferCSSPageSize: true, ...options}));

// How much of a picture is not its most frequent color, and in how many colors.
function content({data}) {
  const counts = new Map();
  for (let i = 0; i + 2 < data.length; i += 3) {
    const color = data.readUIntBE(i, 3);
    counts.set(color, (counts.get(color) ?? 0) + 1);
  }
  return {share: 1 - Math.max(...counts.values()) / (data.length / 3), colors: counts.size};
}

export async function checkPrint(page) {
  const all = await printed(page);
  assert.ok(all.pages <= MOST_PAGES, `${all.pages} pages`);
  await seek(page, 0);
  const first = await printed(page, {pageRanges: '1'});
  const replay = first.pictures.find(({width, height}) => width > 600 && height > 200);
  assert.ok(replay, 'the first page holds the picture of the replay');
  const {share, colors} = content(replay);
  assert.ok(share > 0.005 && colors > 30, `the picture shows something: ${share} of it, in ${colors} colors`);
  assert.equal((await shown(page)).frame, 0, 'afterwards the page is as it was');
  await checkMarks(page);
  await checkNarrow(page);
}

// A square mark is all background.
async function checkMarks(page) {
  await page.addStyleTag({content: '.only-legend main *, .only-legend header { display: none !important } ' +
    '.only-legend main :is(#states, #state-bar, #state-bar .legend, #state-bar .legend *) { display: block !important }'});
  const colors = await page.evaluate(() => {
    document.body.classList.add('only-legend');
    return [...document.querySelectorAll('#state-bar .legend i')].map((mark) => getComputedStyle(mark).backgroundColor);
  });
  const {drawing} = await printed(page);
  await page.evaluate(() => document.body.classList.remove('only-legend'));
  assert.ok(colors.length >= 2, 'INIT and TRACKING');
  const fills = [...drawing.matchAll(/([\d.]+) ([\d.]+) ([\d.]+) rg/g)].map((fill) => fill.slice(1, 4).map((x) => Math.round(255 * x)).join());
  for (const color of colors) assert.ok(fills.includes(color.match(/\d+/g).slice(0, 3).join()), `a mark of ${color} among ${fills}`);
}

// Paper is narrower than a screen.
async function checkNarrow(page) {
  const viewport = page.viewport();
  await page.emulateMediaType('print');
  await page.setViewport({...viewport, width: 700});
  const shown = await page.evaluate(() =>
    ['top-view', 'stage'].map((id) => getComputedStyle(document.getElementById(id)).display));
  for (const display of shown) assert.notEqual(display, 'none');
  const columns = await page.$eval('#error-charts', (grid) => getComputedStyle(grid).gridTemplateColumns.split(' ').length);
  assert.equal(columns, 2, 'charts stand side by side on paper');
  await page.setViewport(viewport);
  await page.emulateMediaType(null);
}
