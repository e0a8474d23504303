// Makes elements: h('button', { class: 'x', onclick: f }, 'text', child). Attributes that are
// false or undefined are left out.
const SVG = new Set([
  'svg',
  'g',
  'path',
  'line',
  'rect',
  'circle',
  'text',
  'polyline',
  'title',
  'polygon',
]);

export function h(tag, attributes = {}, ...children) {
  const made = SVG.has(tag)
    ? document.createElementNS('http://www.w3.org/2000/svg', tag)
    : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else made.setAttribute(name, value === true ? '' : value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

export const byId = (id) => document.getElementById(id);

export function table(head, rows, attributes = {}) {
  return h(
    'div',
    { class: 'scroll' },
    h(
      'table',
      attributes,
      h(
        'thead',
        {},
        h(
          'tr',
          {},
          head.map((name) => h('th', { scope: 'col' }, name)),
        ),
      ),
      h(
        'tbody',
        {},
        rows.map((row) =>
          row instanceof Node
            ? row
            : h(
                'tr',
                {},
                row.map((cell) => h('td', {}, cell)),
              ),
        ),
      ),
    ),
  );
}
