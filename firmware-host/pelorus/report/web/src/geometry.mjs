// Rows of numbers of the run as points and paths.

// Triples of a flat array; null where the run has no value.
export function triples(numbers, width = 3) {
  const points = [];
  for (let i = 0; i + width <= numbers.length; i += width) {
    points.push(numbers[i] === null ? null : [numbers[i], numbers[i + 1], numbers[i + 2]]);
  }
  return points;
}

// From the world into the axes of the views: x along the track, y to the left, z up.
export function toView(R, p) {
  if (p === null) return null;
  return [0, 3, 6].map((row) => R[row] * p[0] + R[row + 1] * p[1] + R[row + 2] * p[2]);
}

// A path per frame shown: null where the object is not there.
export function spread(frames, points, count) {
  const path = new Array(count).fill(null);
  frames.forEach((frame, i) => (path[frame] = points[i]));
  return path;
}

export function viewPaths(run) {
  const R = run.scene.R_view_world;
  const view = (points) => points.map((p) => toView(R, p));
  const count = run.frames.time_s.length;
  return {
    vehicle: view(triples(run.frames.camera, 7)),
    vehicleTruth: run.frames.truth ? view(triples(run.frames.truth)) : null,
    objects: run.objects.map((object) => ({
      name: object.name,
      color: object.color,
      path: spread(object.frame, view(triples(object.pose, 7)), count),
    })),
    bodies: run.true_bodies.map((body) => ({
      name: body.name,
      color: body.color,
      path: spread(body.frame, view(triples(body.p)), count),
    })),
    seabed: view(triples(run.scene.points)),
  };
}
