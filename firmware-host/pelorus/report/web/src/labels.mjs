// Names beside the ends of paths and curves, none over another.

export const LABEL_HEIGHT = 17;
export const CHARACTER_WIDTH = 8.2; // bold, 13 px, at most
const GAP = 9; // from the end of the path
const MOST_CHARACTERS = 20; // the legend tells the others

// The name as it stands beside a curve.
export function labelText(name) {
  return name.length <= MOST_CHARACTERS ? name : `${name.slice(0, MOST_CHARACTERS - 1)}…`;
}

// How much room right of a chart the names beside its curves take, in pixels.
export function labelMargin(names) {
  return 12 + CHARACTER_WIDTH * Math.max(...names.map((name) => labelText(name).length));
}

// In pixels. labels: {x, y, width}: the end of a path and how long its name is. Returns the left edge and the middle of each.
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

// Writes names into a chart: ends {name, color, x, y} in its units, box in pixels. What finds no room the legend tells.
export function addEndLabels(plot, ends, box) {
  const svg = plot.tagName === 'svg' ? plot : plot.querySelector('svg');
  const shown = ends.slice(0, Math.floor((box.bottom - box.top) / LABEL_HEIGHT))
    .map((end) => ({...end, name: labelText(end.name)}));
  const [x, y] = [plot.scale('x'), plot.scale('y')];
  const places = placeLabels(shown.map((end) =>
    ({x: x.apply(end.x), y: y.apply(end.y), width: end.name.length * CHARACTER_WIDTH})), box);
  shown.forEach(({name, color}, i) => {
    const text = document.createElementNS('http://www.w3.org/2000/svg', 'text');
    text.setAttribute('class', 'end-label');
    text.setAttribute('x', places[i].x);
    text.setAttribute('y', places[i].y);
    text.setAttribute('text-anchor', 'start');
    text.setAttribute('fill', color);
    text.textContent = name;
    svg.append(text);
  });
}
