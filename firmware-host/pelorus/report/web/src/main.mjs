// The page: each section draws its part of the run; one playback moves the replay and the marks in all charts.

import {showErrors, showLatency, showPointCounts, showStates} from './charts.mjs';
import {showFacts} from './facts.mjs';
import {showPaths} from './paths.mjs';
import {showPictures} from './pictures.mjs';
import {Playback} from './playback.mjs';
import {showReplay} from './replay.mjs';

const run = JSON.parse(document.getElementById('run').textContent);
const playback = new Playback(run.frames.time_s);
for (const show of [showFacts, showReplay, showPaths, showErrors, showStates, showLatency, showPointCounts, showPictures]) {
  // One part that fails must not take the others with it; the console names it.
  try {
    show(run, playback);
  } catch (error) {
    console.error(`${show.name} failed:`, error);
  }
}
