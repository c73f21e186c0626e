// Figures as text, and small pieces of the page.

export const INK = '#15202b';
export const CM_PER_M = 100;
export const DEG_PER_RAD = 180 / Math.PI;

export const isKnown = (value) => value !== null && value !== undefined;

export function figure(value, digits = 4) {
  if (!isKnown(value) || Number.isNaN(value)) return '-';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-6) return value.toExponential(digits - 1);
  return Number(value.toPrecision(digits)).toLocaleString('en-US', {maximumFractionDigits: 10, useGrouping: false});
}

export const percent = (share) => (isKnown(share) ? `${figure(100 * share, 4)} %` : '-');

export function element(tag, properties = {}, ...children) {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
}

// rows: arrays of cells; the first cell of a row names it.
export function table(head, rows) {
  const cells = (tag, row) => element('tr', {}, ...row.map((cell) => element(tag, {textContent: cell})));
  return element(
    'div',
    {className: 'table'},
    element('table', {}, element('thead', {}, cells('th', head)),
      element('tbody', {}, ...rows.map((row) => cells('td', row)))),
  );
}

// Where a chart would have nothing in it.
export const nothing = (text) => element('p', {className: 'hint nothing', textContent: text});

// entries: {name, color, dashed, block}; dashes mean truth
export function legend(container, entries) {
  for (const {name, color, dashed, block} of entries) {
    const mark = element('i', {className: block ? 'block' : ''});
    if (block) mark.style.background = color;
    mark.style.borderColor = color;
    if (dashed) mark.style.borderTopStyle = 'dashed';
    container.append(element('span', {}, mark, name));
  }
}
