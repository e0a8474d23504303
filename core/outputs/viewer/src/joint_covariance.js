// Angles and distances between surfaces with their standard deviations, from the joint covariance
// of all surfaces' parameters; the formulas of core/result/plane_covariance.cc.
import {
  addScaled,
  cross,
  dot,
  norm,
  normalAt,
  sideOf,
  signedDistance,
  subtract,
  tangents,
} from './surface.js';

const NUM_PARAMETERS = { horizontal: 1, vertical: 2, general: 3, cylinder: 3 };
// Parameters that turn the normal: each towards a tangent.
const NUM_TURNS = { horizontal: 0, vertical: 1, general: 2, cylinder: 1 };
const PARALLEL = 1e-3; // sine below which an angle may open in any direction

// A row of derivatives by all parameters: [[parameter, derivative], ...].
const plus = (row, scale, other) => [...row, ...other.map(([at, value]) => [at, scale * value])];

export class JointCovariance {
  // lower: the lower triangle, row by row, of the parameters of these surfaces, in their order.
  constructor(surfaces, lower) {
    this.lower = lower;
    this.offsets = new Map();
    let offset = 0;
    for (const surface of surfaces) {
      this.offsets.set(surface.id, offset);
      offset += NUM_PARAMETERS[surface.type];
    }
    if ((offset * (offset + 1)) / 2 !== lower.length) throw new Error('covariance of another size');
  }

  // Whether its parameters are among those of the covariance.
  has(surface) {
    return this.offsets.has(surface.id);
  }

  at(i, j) {
    return i >= j ? this.lower[(i * (i + 1)) / 2 + j] : this.at(j, i);
  }

  covariance(rowA, rowB) {
    let sum = 0;
    for (const [i, a] of rowA) for (const [j, b] of rowB) sum += a * b * this.at(i, j);
    return sum;
  }

  stddev(row) {
    return Math.sqrt(Math.max(0, this.covariance(row, row)));
  }

  // Of the signed distance of a fixed point from the surface.
  distanceRow(surface, point) {
    const offset = this.offsets.get(surface.id);
    const [u, v] = tangents(surface.normal);
    switch (surface.type) {
      case 'horizontal':
        return [[offset, -1]];
      case 'vertical':
        return [
          [offset, dot(u, point)],
          [offset + 1, -1],
        ];
      case 'general': {
        const arm = subtract(point, surface.centre);
        return [
          [offset, dot(arm, u)],
          [offset + 1, dot(arm, v)],
          [offset + 2, -1],
        ];
      }
      default: {
        // A cylinder's axis moves along with its centre and its radius.
        const normal = normalAt(surface, point);
        const side = sideOf(surface);
        const along = dot(normal, surface.normal);
        return [
          [offset, side * surface.radius * dot(normal, u)],
          [offset + 1, side * (along - 1)],
          [offset + 2, -along],
        ];
      }
    }
  }

  // Of the normal's component along a direction.
  normalRow(surface, direction) {
    const offset = this.offsets.get(surface.id);
    return tangents(surface.normal)
      .slice(0, NUM_TURNS[surface.type])
      .map((tangent, i) => [offset + i, dot(tangent, direction)]);
  }

  // The angle between the normals of two surfaces, rad; of parallel ones, its standard deviation
  // is that in the direction in which it is known worst.
  angle(a, b) {
    const sine = norm(cross(a.normal, b.normal));
    const cosine = dot(a.normal, b.normal);
    const value = Math.atan2(sine, cosine);
    if (sine > PARALLEL) {
      const row = plus(this.normalRow(a, b.normal), 1, this.normalRow(b, a.normal));
      return { value, stddev: this.stddev(row) / sine };
    }
    const [first, second] = tangents(a.normal).map((tangent) =>
      plus(this.normalRow(a, tangent), -Math.sign(cosine), this.normalRow(b, tangent)),
    );
    const xx = this.covariance(first, first);
    const xy = this.covariance(first, second);
    const yy = this.covariance(second, second);
    const largest = (xx + yy) / 2 + Math.hypot((xx - yy) / 2, xy);
    return { value, stddev: Math.sqrt(Math.max(0, largest)) };
  }

  // The distance of surface b from the point of surface a that is nearest to `point`, m, with
  // that point and the one of b that is nearest to it.
  separation(point, a, b) {
    const onA = addScaled(point, -signedDistance(a, point), normalAt(a, point));
    const distance = signedDistance(b, onA);
    const normalB = normalAt(b, onA);
    // When a moves away from the point by e along its normal, the point of a follows.
    const follows = dot(normalB, normalAt(a, onA));
    const row = plus(this.distanceRow(b, onA), -follows, this.distanceRow(a, onA));
    return {
      value: Math.abs(distance),
      stddev: this.stddev(row),
      from: onA,
      to: addScaled(onA, -distance, normalB),
    };
  }
}
