// Geometry of the surfaces in planes.json (docs/outputs.md).

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const addScaled = (a, scale, b) => [
  a[0] + scale * b[0],
  a[1] + scale * b[1],
  a[2] + scale * b[2],
];
export const norm = (a) => Math.hypot(...a);

export const isCylinder = (surface) => surface.type === 'cylinder';

// +1 where the side that was seen is the one away from the axis, else -1.
export function sideOf(surface) {
  return Math.sign(dot(surface.normal, subtract(surface.centre, surface.axis_point)));
}

// Unit vectors along a plane: u level, and v = n x u; of a level plane u is the x axis.
export function tangents(normal) {
  const level = cross([0, 0, 1], normal);
  const length = norm(level);
  const u = length < 1e-9 ? [1, 0, 0] : level.map((x) => x / length);
  return [u, cross(normal, u)];
}

export function normalAt(surface, point) {
  if (!isCylinder(surface)) return surface.normal;
  const away = subtract(point, surface.axis_point);
  const length = Math.hypot(away[0], away[1]);
  const scale = sideOf(surface) / length;
  return [away[0] * scale, away[1] * scale, 0];
}

export function signedDistance(surface, point) {
  if (!isCylinder(surface)) return dot(surface.normal, point) - surface.distance;
  const away = subtract(point, surface.axis_point);
  return sideOf(surface) * (Math.hypot(away[0], away[1]) - surface.radius);
}

// The flat polygons of an outline: one, or the strips of a cylinder between its two rims.
export function facets(surface) {
  const { outline } = surface;
  if (outline.length < 3) return [];
  if (!isCylinder(surface)) return [outline];
  const strips = [];
  for (let i = 0; i + 1 < outline.length / 2; ++i) {
    const last = outline.length - 1 - i;
    strips.push([outline[i], outline[i + 1], outline[last - 1], outline[last]]);
  }
  return strips;
}

// Height of the lowest and of the highest corner.
export function heightRange(surface) {
  const heights = surface.outline.map((corner) => corner[2]);
  return [Math.min(...heights), Math.max(...heights)];
}

// Extents of the outline, along its level direction and across, in m.
export function extents(surface) {
  const [u, v] = tangents(surface.normal);
  const range = (axis) => {
    const places = surface.outline.map((corner) => dot(corner, axis));
    return Math.max(...places) - Math.min(...places);
  };
  if (!isCylinder(surface)) return [range(u), range(v)];
  let arc = 0;
  for (let i = 0; i + 1 < surface.outline.length / 2; ++i) {
    arc += norm(subtract(surface.outline[i + 1], surface.outline[i]));
  }
  const [low, high] = heightRange(surface);
  return [arc, high - low];
}

// How far the arc of a cylinder, as it was seen, bows out from its chord, in m.
export function bow(surface) {
  const halfTurn = Math.min(Math.PI, extents(surface)[0] / (2 * surface.radius));
  return surface.radius * (1 - Math.cos(halfTurn));
}

function contains(polygon, normal, point) {
  const [u, v] = tangents(normal);
  const x = dot(point, u);
  const y = dot(point, v);
  let inside = false;
  for (let i = 0, j = polygon.length - 1; i < polygon.length; j = i++) {
    const [xi, yi] = [dot(polygon[i], u), dot(polygon[i], v)];
    const [xj, yj] = [dot(polygon[j], u), dot(polygon[j], v)];
    if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) inside = !inside;
  }
  return inside;
}

// How far along the ray it meets the outline, at places that `accepts`; Infinity: nowhere.
export function rayDistance(surface, origin, direction, accepts) {
  let nearest = Infinity;
  for (const polygon of facets(surface)) {
    const normal = isCylinder(surface)
      ? cross(subtract(polygon[1], polygon[0]), subtract(polygon[3], polygon[0]))
      : surface.normal;
    const slope = dot(normal, direction);
    if (slope === 0) continue;
    const along = dot(normal, subtract(polygon[0], origin)) / slope;
    if (along <= 0 || along >= nearest) continue;
    const point = addScaled(origin, along, direction);
    const length = norm(normal);
    const unit = normal.map((x) => x / length);
    if (contains(polygon, unit, point) && accepts(point)) nearest = along;
  }
  return nearest;
}
