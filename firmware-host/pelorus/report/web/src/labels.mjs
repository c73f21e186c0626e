// Places for names beside the ends of paths, none over another. Pixels.

export const LABEL_HEIGHT = 17;
const GAP = 9; // from the end of the path

// labels: {x, y, width}: the end of a path and how long its name is. Returns the left edge and the middle of each.
export function placeLabels(labels, {left, right, top, bottom}) {
  const placed = labels.map(({x, y, width}, i) => {
    const beside = x + GAP + width <= right ? x + GAP : x - GAP - width;
    return {i, x: Math.max(left, beside), y, width};
  }).sort((a, b) => a.y - b.y || a.i - b.i);
  const touch = (a, b) => a.x < b.x + b.width && b.x < a.x + a.width;
  // Each below those above it, then back up from the lower border.
  placed.forEach((label, n) => {
    label.y = Math.max(label.y, top + LABEL_HEIGHT / 2);
    for (const above of placed.slice(0, n)) {
      if (touch(label, above)) label.y = Math.max(label.y, above.y + LABEL_HEIGHT);
    }
  });
  placed.reverse().forEach((label, n) => {
    label.y = Math.min(label.y, bottom - LABEL_HEIGHT / 2);
    for (const below of placed.slice(0, n)) {
      if (touch(label, below)) label.y = Math.min(label.y, below.y - LABEL_HEIGHT);
    }
  });
  return placed.sort((a, b) => a.i - b.i).map(({x, y}) => ({x, y}));
}
