// The paths of vehicle and objects from above and from the side, to the same scale, with a mark for the frame shown.

import * as Plot from '@observablehq/plot';
import {INK, legend, nothing} from './format.mjs';
import {viewPaths} from './geometry.mjs';
import {addEndLabels} from './labels.mjs';

const WIDTH = 1190;
const TALLEST = 430;
const MARGIN = {marginLeft: 56, marginRight: 12, marginTop: 18, marginBottom: 38};
const MOST_SEABED_POINTS = 4000;

// The range that holds the ways, and the seabed but for its few farthest points.
function range(ways, seabed, axis) {
  const values = ways.flat().filter((p) => p !== null).map((p) => p[axis]);
  const sorted = seabed.map((p) => p[axis]).sort((a, b) => a - b);
  if (sorted.length) values.push(sorted[Math.floor(0.02 * (sorted.length - 1))], sorted[Math.ceil(0.98 * (sorted.length - 1))]);
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (!(low <= high)) [low, high] = [0, 0];
  const margin = Math.max(0.05 * (high - low), 0.02);
  return [low - margin, high + margin];
}

// Ranges and heights so that a meter is as long in both directions and in both views.
function layout(paths) {
  const ways = [paths.vehicle, paths.vehicleTruth ?? [], ...paths.objects.map((o) => o.path), ...paths.bodies.map((b) => b.path)];
  const [along, ...across] = [0, 1, 2].map((axis) => range(ways, paths.seabed, axis));
  const length = ([low, high]) => high - low;
  const innerWidth = WIDTH - MARGIN.marginLeft - MARGIN.marginRight;
  const innerTallest = TALLEST - MARGIN.marginTop - MARGIN.marginBottom;
  const pixelsPerMeter = Math.min(innerWidth / length(along), ...across.map((one) => innerTallest / length(one)));
  const extra = (innerWidth / pixelsPerMeter - length(along)) / 2;
  const height = (one) => Math.max(60, length(one) * pixelsPerMeter) + MARGIN.marginTop + MARGIN.marginBottom;
  // A flat view gets a little more room than its points need, to the same scale.
  const padded = ([low, high]) => {
    const more = Math.max(0, 60 / pixelsPerMeter - (high - low)) / 2;
    return [low - more, high + more];
  };
  return {x: [along[0] - extra, along[1] + extra], views: across.map((one) => ({y: padded(one), height: height(one)}))};
}

function endsOf(objects, axis) {
  return objects.map(({name, color, path}) => ({name, color, p: path.findLast((p) => p !== null)}))
    .filter(({p}) => p).map(({name, color, p}) => ({name, color, x: p[0], y: p[axis]}));
}

function drawView(paths, axis, label, x, {y: yRange, height}) {
  const every = Math.max(1, Math.ceil(paths.seabed.length / MOST_SEABED_POINTS));
  const channels = {x: (p) => (p ? p[0] : NaN), y: (p) => (p ? p[axis] : NaN)};
  const line = (path, stroke, options) => Plot.line(path, {...channels, stroke, clip: true, ...options});
  const truth = {strokeDasharray: '4 6', strokeWidth: 1};
  const plot = Plot.plot({
    width: WIDTH, height, ...MARGIN, grid: true, style: {fontSize: '13px'},
    x: {domain: x, label: 'along track [m]', labelAnchor: 'center'},
    y: {domain: yRange, label, labelAnchor: 'center'},
    marks: [
      Plot.dot(paths.seabed.filter((_, i) => i % every === 0), {...channels, r: 1, fill: '#9aa9a0', clip: true}),
      ...paths.objects.map(({color, path}) => line(path, color, {strokeWidth: 2.2})),
      line(paths.vehicle, INK, {strokeWidth: 2.2}),
      // Truth lies over the estimates, thin and dashed: under them it would not be seen.
      paths.vehicleTruth ? line(paths.vehicleTruth, '#b8c4cf', truth) : null,
      ...paths.bodies.map(({path}) => line(path, INK, truth)),
    ],
  });
  addEndLabels(plot, endsOf(paths.objects, axis), {left: MARGIN.marginLeft, right: WIDTH - MARGIN.marginRight,
    top: MARGIN.marginTop, bottom: height - MARGIN.marginBottom});
  return plot;
}

// A circle per path that moves with the playback.
function addPlayheads(plot, paths, axis, playback) {
  const x = plot.scale('x');
  const y = plot.scale('y');
  const heads = [{color: INK, path: paths.vehicle}, ...paths.objects].map(({color, path}) => {
    const circle = document.createElementNS('http://www.w3.org/2000/svg', 'circle');
    circle.setAttribute('class', 'playhead');
    circle.setAttribute('r', 6);
    circle.setAttribute('fill', color);
    circle.setAttribute('stroke', '#fff');
    circle.setAttribute('stroke-width', 2);
    plot.append(circle);
    return {circle, path};
  });
  const move = () => {
    for (const {circle, path} of heads) {
      const p = path[playback.frame];
      circle.style.display = p ? '' : 'none';
      if (!p) continue;
      circle.setAttribute('cx', x.apply(p[0]));
      circle.setAttribute('cy', y.apply(p[axis]));
    }
  };
  playback.addEventListener('frame', move);
  move();
}

const noPathText = (run) => (run.evaluation.frames === 1 ? 'One frame: no path to draw.' : 'No two frames with a pose: no path to draw.');

export function showPaths(run, playback) {
  const paths = viewPaths(run);
  const ways = [paths.vehicle, ...paths.objects.map((object) => object.path)];
  if (paths.seabed.length === 0 && ways.every((way) => way.filter((p) => p !== null).length < 2)) {
    for (const figure of document.querySelectorAll('#paths figure')) figure.hidden = true;
    document.getElementById('axes-note').before(nothing(noPathText(run)));
    return;
  }
  const entries = [{name: 'vehicle', color: INK}, ...paths.objects];
  if (run.frames.truth) entries.push({name: 'truth', color: '#51606f', dashed: true});
  if (paths.seabed.length) entries.push({name: 'points of the static scene', color: '#9aa9a0', block: true});
  legend(document.querySelector('#paths [data-legend]'), entries);
  const {x, views} = layout(paths);
  for (const [id, axis, label] of [['top-view', 1, 'to port [m]'], ['side-view', 2, 'up [m]']]) {
    const plot = drawView(paths, axis, label, x, views[axis - 1]);
    addPlayheads(plot, paths, axis, playback);
    document.getElementById(id).append(plot);
  }
  document.getElementById('axes-note').textContent =
    (run.scene.up_from_plane
      ? 'Up is the normal of the plane fitted to the points of the static scene.'
      : 'Up is -y of the first camera: the points of the static scene form no plane.') +
    ' The origin is the first camera; both views are to the same scale. An object is drawn at the origin of its frame; its truth is that of the same point of the body.';
}
