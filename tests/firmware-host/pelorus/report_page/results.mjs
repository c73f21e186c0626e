// What the files of a run say, against which the page is held.

import {readFileSync} from 'node:fs';
import {join} from 'node:path';

function rows(file) {
  const [head, ...lines] = readFileSync(file, 'utf8').trim().split('\n');
  const names = head.split(',');
  return lines.map((line) => Object.fromEntries(line.split(',').map((cell, i) => [names[i], cell])));
}

// The distance of the vehicle from the start in each frame, as camera.tum has it.
export function distances(folder) {
  const lines = readFileSync(join(folder, 'camera.tum'), 'utf8').trim().split('\n');
  return lines.map((line) => Math.hypot(...line.split(' ').slice(1, 4).map(Number)));
}

// p turned by the unit quaternion [w, x, y, z].
function turned([w, ...v], p) {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const t = cross(v, p).map((x) => 2 * x);
  return p.map((x, i) => x + w * t[i] + cross(v, t)[i]);
}

// The middle of the outline of each confirmed body in the world: by time and id.
export function outlineMiddles(folder) {
  const corners = new Map();
  for (const row of rows(join(folder, 'outlines.csv'))) {
    const key = `${row.timestamp_ns} ${row.object_id}`;
    corners.set(key, [...(corners.get(key) ?? []), [row.p_x, row.p_y, row.p_z].map(Number)]);
  }
  const times = rows(join(folder, 'frames.csv')).map((row) => row.timestamp_ns);
  const middles = times.map(() => ({}));
  for (const row of rows(join(folder, 'objects.csv'))) {
    const outline = corners.get(`${row.timestamp_ns} ${row.object_id}`);
    if (!outline || row.state !== 'confirmed') continue;
    const middle = [0, 1, 2].map((axis) => outline.reduce((sum, p) => sum + p[axis], 0) / outline.length);
    const quaternion = [row.q_w, row.q_x, row.q_y, row.q_z].map(Number);
    const origin = [row.p_x, row.p_y, row.p_z].map(Number);
    middles[times.indexOf(row.timestamp_ns)][row.object_id] = turned(quaternion, middle).map((x, i) => x + origin[i]);
  }
  return middles;
}
