// Curves and bars over time, and the latency histogram.

import * as Plot from '@observablehq/plot';
import {lengthUnit} from './facts.mjs';
import {DEG_PER_RAD, element, figure, INK, isKnown, legend, nothing} from './format.mjs';
import {addEndLabels, labelMargin} from './labels.mjs';

const HALF = 590;
const FULL = 1190;
const STYLE = {fontSize: '13px'};
const CURVE_HEIGHT = 250;

const endOf = (run) => run.states.at(-1)?.to_s ?? 0;

// Instead of axes without anything between them.
function nothingOverTime(run) {
  const one = run.evaluation.frames === 1;
  return nothing(one ? 'One frame: nothing to draw over time.' : 'Fewer than two figures: nothing to draw over time.');
}

// A vertical line that moves with the playback; a click on the chart moves the playback.
function addPlayhead(plot, playback) {
  const svg = plot.tagName === 'svg' ? plot : plot.querySelector('svg');
  const x = plot.scale('x');
  const [low, high] = plot.scale('y')?.range ?? [0, Number(svg.getAttribute('height'))];
  const line = document.createElementNS('http://www.w3.org/2000/svg', 'line');
  line.setAttribute('class', 'playhead');
  line.setAttribute('stroke', '#2f6fde');
  line.setAttribute('stroke-width', 1.5);
  line.setAttribute('y1', low);
  line.setAttribute('y2', high);
  svg.append(line);
  const move = () => {
    const at = x.apply(playback.times[playback.frame]);
    line.setAttribute('x1', at);
    line.setAttribute('x2', at);
  };
  svg.addEventListener('click', (event) => {
    const box = svg.getBoundingClientRect();
    playback.seekTime(x.invert((event.clientX - box.left) * (Number(svg.getAttribute('width')) / box.width)));
  });
  playback.addEventListener('frame', move);
  move();
}

function chart(id, plot, caption, playback) {
  if (playback) addPlayhead(plot, playback);
  const holder = document.getElementById(id);
  holder.append(caption ? element('figure', {}, element('figcaption', {textContent: caption}), plot) : plot);
}

// The last figure of a curve is where its name stands.
function endOfCurve({name, short_name, color, time_s, values}) {
  const last = values.findLastIndex(isKnown);
  return last < 0 ? null : {name: short_name ?? name, color, x: time_s[last], y: values[last]};
}

// series: {name, short_name, color, time_s, values}
function curves(series, yLabel, end) {
  const marks = series.map(({color, width, time_s, values}) =>
    Plot.line(time_s, {x: (t) => t, y: (_, i) => values[i] ?? NaN, stroke: color, strokeWidth: width ?? 1.6}));
  const marginRight = labelMargin(series.map(({name, short_name}) => short_name ?? name));
  const plot = Plot.plot({
    width: HALF, height: CURVE_HEIGHT, marginLeft: 62, marginBottom: 38, marginRight, grid: true, style: STYLE,
    x: {label: 'time [s]', labelAnchor: 'center', domain: [0, end]},
    y: {label: yLabel, labelAnchor: 'center', zero: true},
    marks: [Plot.ruleY([0]), ...marks],
  });
  addEndLabels(plot, series.map(endOfCurve).filter((label) => label), {left: 62, right: HALF, top: 10, bottom: CURVE_HEIGHT - 28});
  return plot;
}

export function showErrors(run, playback) {
  if (!run.errors) {
    document.getElementById('errors').hidden = true;
    return;
  }
  const all = [{name: 'vehicle', color: INK, width: 2.2, curves: run.errors.camera}, ...run.errors.bodies];
  if (all.every((one) => one.curves.time_s.length < 2)) {
    document.getElementById('error-charts').append(nothingOverTime(run));
    return;
  }
  legend(document.querySelector('#errors [data-legend]'), all);
  const end = endOf(run);
  for (const [key, caption] of [
    ['step_m', 'Local displacement error (one step)'], ['step_rad', 'Local orientation error (one step)'],
    ['absolute_m', 'Absolute displacement error (since the start; of an object since its birth)'],
    ['absolute_rad', 'Absolute orientation error (since the start; of an object since its birth)']]) {
    const unit = key.endsWith('_m') ? lengthUnit(all.flatMap((one) => one.curves[key])) : {name: 'deg', factor: DEG_PER_RAD};
    const series = all.map((one) => ({...one, time_s: one.curves.time_s,
      values: one.curves[key].map((value) => (value === null ? null : value * unit.factor))}));
    const per = Math.max(...all.map((one) => one.curves.frames_per_sample));
    chart('error-charts', curves(series, `error [${unit.name}]`, end),
      per > 1 ? `${caption}; the worst of up to ${per} frames` : caption, playback);
  }
}

export function showStates(run, playback) {
  const end = endOf(run);
  const totals = new Map();
  for (const {state, frames, color} of run.states) {
    totals.set(state, {frames: (totals.get(state)?.frames ?? 0) + frames, color});
  }
  const entries = element('div', {className: 'legend'});
  legend(entries, [...totals].map(([state, {frames, color}]) =>
    ({name: `${state}: ${frames} ${frames === 1 ? 'frame' : 'frames'}`, color, block: true})));
  document.getElementById('state-bar').append(entries);
  if (!(end > 0)) {
    document.getElementById('state-bar').append(nothingOverTime(run));
    return;
  }
  chart('state-bar', Plot.plot({
    width: FULL, height: 84, marginLeft: 56, marginBottom: 38, style: STYLE,
    x: {label: 'time [s]', labelAnchor: 'center', domain: [0, end]},
    marks: [Plot.rectX(run.states, {x1: 'from_s', x2: 'to_s', fill: 'color', title: (s) => `${s.state}, ${s.frames} frames`}),
      Plot.text(run.states.filter((s) => s.to_s - s.from_s > 0.08 * end),
        {x: (s) => (s.from_s + s.to_s) / 2, text: 'state', fill: '#fff', fontWeight: 600, stroke: '#15202b', strokeWidth: 3})],
  }), '', playback);
}

export function showPointCounts(run, playback) {
  const counts = run.point_counts;
  if (!counts) return;
  if (counts.time_s.length < 2) {
    document.getElementById('point-chart').append(nothingOverTime(run));
    return;
  }
  const kinds = [['tracked', INK], ['static', '#00805c'], ['moving', '#c84a00'], ['outlier', '#7d8794']];
  const entries = element('div', {className: 'legend'});
  legend(entries, kinds.map(([name, color]) => ({name, color})));
  document.getElementById('point-chart').append(entries);
  chart('point-chart', curves(kinds.map(([name, color]) => ({name, color, time_s: counts.time_s, values: counts[name]})),
    'points', endOf(run)), '', playback);
}

export function showLatency(run) {
  const {latency} = run;
  if (!latency) {
    document.getElementById('latency').hidden = true;
    return;
  }
  if (latency.frames < 2) {
    document.getElementById('latency-note').textContent = `One frame, ${figure(latency.mean_ms, 3)} ms from the decoded pair to its result.`;
    return;
  }
  // Marks that fall together share one label.
  const marks = [];
  for (const [name, ms] of [['p50', latency.p50_ms], ['p99', latency.p99_ms], ['p99.9', latency.p999_ms], ['max', latency.max_ms]]) {
    if (marks.at(-1)?.ms === ms) marks.at(-1).name += ` = ${name}`;
    else marks.push({name, ms});
  }
  const first = latency.bins[0][0];
  const last = latency.bins.at(-1)[1];
  chart('latency-chart', Plot.plot({
    width: FULL, height: 280, marginLeft: 56, marginTop: 26 + 16 * marks.length, marginBottom: 38, marginRight: 30, style: STYLE,
    x: {type: 'log', label: 'latency [ms], logarithmic', labelAnchor: 'center', domain: [first / 1.02, last * 1.02],
      ticks: 12, tickFormat: (ms) => figure(ms, 3)},
    y: {label: 'frames', labelAnchor: 'center', grid: true},
    marks: [Plot.rectY(latency.bins, {x1: (b) => b[0], x2: (b) => b[1], y: (b) => b[2], fill: '#5b7fa6', insetLeft: 1}),
      Plot.ruleY([0]), Plot.ruleX(marks, {x: 'ms', stroke: '#b3261e'}),
      ...marks.map((mark, i) => Plot.text([mark], {x: 'ms', frameAnchor: 'top', dy: -16 - 16 * (marks.length - 1 - i), textAnchor: 'end', dx: -4,
        text: (m) => `${m.name} ${figure(m.ms, 3)} ms`, fill: '#8f1d17', stroke: '#fff', strokeWidth: 4}))],
  }));
  document.getElementById('latency-note').textContent =
    `From a decoded pair to its result (rectification and step), ${latency.frames} frames, mean ${figure(latency.mean_ms, 3)} ms, ` +
    'wall time on the machine of the replay.' +
    (latency.frames < 1000 ? ' With fewer than 1000 frames p99.9 is the maximum.' : '');
}
