// The rig's motion from its poses.

// The index of the last pose at or before t.
export function poseIndex(poses, t) {
  let low = 0;
  let high = poses.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (poses[middle].t <= t) low = middle;
    else high = middle - 1;
  }
  return low;
}

// The pose at t, between the poses before and after it.
export function poseAt(poses, t) {
  const i = poseIndex(poses, t);
  const a = poses[i];
  const b = poses[Math.min(i + 1, poses.length - 1)];
  const share = b.t > a.t ? Math.min(1, Math.max(0, (t - a.t) / (b.t - a.t))) : 0;
  const sign = a.rotation.reduce((sum, x, k) => sum + x * b.rotation[k], 0) < 0 ? -1 : 1;
  const mix = (x, y) => x + share * (y - x);
  const rotation = a.rotation.map((x, k) => mix(x, sign * b.rotation[k]));
  const length = Math.hypot(...rotation);
  return {
    ...a,
    t,
    position: a.position.map((x, k) => mix(x, b.position[k])),
    rotation: rotation.map((x) => x / length),
  };
}

const WINDOW = 0.25; // s: poses this far apart give a speed

// Speed (m/s) and rate of turn (deg/s) over time: [{ t, speed, turn }].
export function speeds(poses) {
  const found = [];
  for (let i = 0, j = 0; j < poses.length; ++j) {
    while (poses[j].t - poses[i].t > WINDOW && i + 1 < j) ++i;
    const [a, b] = [poses[i], poses[j]];
    const duration = b.t - a.t;
    if (duration < WINDOW / 2 || duration > 4 * WINDOW) continue;
    const way = Math.hypot(...b.position.map((x, k) => x - a.position[k]));
    const cosine = Math.abs(a.rotation.reduce((sum, x, k) => sum + x * b.rotation[k], 0));
    const turn = (2 * Math.acos(Math.min(1, cosine)) * 180) / Math.PI;
    found.push({ t: (a.t + b.t) / 2, speed: way / duration, turn: turn / duration });
  }
  return found;
}
