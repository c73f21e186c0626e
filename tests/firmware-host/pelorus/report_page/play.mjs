// The replay in the page: play, follow, orbit, views.

import assert from 'node:assert/strict';

const WAIT_MS = 60_000; // drawn by the processor, which may be busy

// The frame on the screen; where vehicle, eye and what it looks at are; the middles of the outlines by id.
export const shown = (page) => page.$eval('#stage', (stage) => stage.shown());
const distance = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));
const reach = (page, frame) =>
  page.waitForFunction((wanted) => document.getElementById('stage').shown().frame >= wanted, {timeout: WAIT_MS}, frame);
// As by the slider.
export const seek = (page, frame) => page.$eval('#position', (slider, wanted) => {
  slider.value = String(wanted);
  slider.dispatchEvent(new Event('input'));
}, frame);
const drawn = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

export async function checkPlay(page, expected) {
  const stage = await page.$('#stage');
  const before = await shown(page);
  assert.equal(before.frame, 0);
  const pictureBefore = await stage.screenshot();
  await page.click('#play');
  await reach(page, 5);
  await page.click('#play');
  assert.equal(await page.$eval('#play', (button) => button.textContent), 'Play', 'a second click pauses');
  const after = await shown(page);
  assert.ok(distance(after.vehicle, before.vehicle) > 1e-5, 'the vehicle moves');
  // Where the page draws the vehicle is where the pipeline saw it.
  assert.ok(Math.abs(Math.hypot(...after.vehicle) - expected[after.frame]) < 1e-4,
    `vehicle at ${after.vehicle} in frame ${after.frame}, expected ${expected[after.frame]} m from the start`);
  assert.ok(!pictureBefore.equals(await stage.screenshot()), 'the picture changes');
  assert.equal(await page.$eval('#position', (slider) => slider.value), String(after.frame));
}

// Outlines are drawn where the pipeline saw the bodies, in each frame that is played. The axes of the view are turned
// against the world: lengths are compared.
export async function checkOutlinesMove(page, middles) {
  const start = 3;
  await seek(page, start);
  const seen = new Map();
  await page.select('#speed', '0.25'); // time to look at single frames
  await page.click('#play');
  for (let frame = start + 1; frame <= Math.min(start + 6, middles.length - 2); ++frame) {
    await reach(page, frame);
    const {frame: seenFrame, outlines} = await shown(page);
    seen.set(seenFrame, outlines);
  }
  await page.click('#play');
  await page.select('#speed', '1');
  let compared = 0;
  let farthest = 0;
  const frames = [...seen.keys()];
  for (const frame of frames) {
    assert.deepEqual(Object.keys(seen.get(frame)).filter((id) => middles[frame][id]).sort(), Object.keys(middles[frame]).sort(),
      `outlines of frame ${frame}`);
    for (const [id, middle] of Object.entries(middles[frame])) {
      const from = middles[frames[0]][id];
      if (!from) continue;
      const moved = distance(seen.get(frame)[id], seen.get(frames[0])[id]);
      assert.ok(Math.abs(moved - distance(middle, from)) < 3e-3, `outline #${id} moved ${moved} m until frame ${frame}, its body ${distance(middle, from)} m`);
      farthest = Math.max(farthest, moved);
      ++compared;
    }
  }
  assert.ok(compared >= 3 && farthest > 0.1, `${compared} outlines compared, moved up to ${farthest} m`);
}

export async function checkFollow(page) {
  await seek(page, 5);
  const before = await shown(page);
  assert.ok(distance(before.target, before.vehicle) > 1e-3, 'the view looks elsewhere');
  await page.click('#follow');
  const from = (await shown(page)).frame;
  await page.click('#play');
  await reach(page, from + 3);
  await page.click('#play');
  const {target, vehicle} = await shown(page);
  const miss = distance(target, vehicle);
  assert.ok(miss < 1e-3, `the view follows: its target is ${miss} m from the vehicle`);
}

// A drag goes around what is looked at: the eye moves, what it looks at and how far off it is stay.
export async function checkOrbit(page) {
  const stage = await page.$('#stage');
  const before = await shown(page);
  const pictureBefore = await stage.screenshot();
  const box = await stage.boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 150, box.y + box.height / 2 + 20, {steps: 5});
  await page.mouse.up();
  await drawn(page);
  const after = await shown(page);
  const [eyeBefore, eye, target] = [before.eye, after.eye, after.target];
  assert.ok(distance(target, before.target) < 1e-5, 'what is looked at stays');
  const far = distance(eye, target);
  assert.ok(distance(eye, eyeBefore) > 0.3 * far, `the eye moved ${distance(eye, eyeBefore)} m, ${far} m from what it looks at`);
  assert.ok(Math.abs(far - distance(eyeBefore, target)) < 1e-3 * far, 'as far off as before');
  assert.ok(!pictureBefore.equals(await stage.screenshot()), 'the picture turns');
}

export async function checkEnd(page, last) {
  await page.select('#speed', '16');
  await page.click('#play');
  await reach(page, last);
  await page.waitForFunction(() => document.getElementById('play').textContent === 'Play', {timeout: WAIT_MS});
}

export async function checkViews(page) {
  const pictures = [];
  for (const view of ['top', 'side', 'camera', 'scene']) {
    await page.select('#view', view);
    await drawn(page);
    pictures.push((await (await page.$('#stage')).screenshot()).toString('base64'));
  }
  assert.equal(new Set(pictures).size, pictures.length, 'each view shows something else');
}
