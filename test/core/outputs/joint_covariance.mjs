// Prints what the page computes between pairs of surfaces: node joint_covariance.mjs CASE.json
import { readFileSync } from 'node:fs';
import { JointCovariance } from '../../../core/outputs/viewer/src/joint_covariance.js';

const { planes, covariance, pairs } = JSON.parse(readFileSync(process.argv[2], 'utf8'));
const lower = covariance.flatMap((row, i) => row.slice(0, i + 1));
const joint = new JointCovariance(planes, lower);
const found = pairs.map(([i, j, point]) => {
  const angle = joint.angle(planes[i], planes[j]);
  const distance = joint.separation(point, planes[i], planes[j]);
  return [angle.value, angle.stddev, distance.value, distance.stddev];
});
console.log(JSON.stringify(found));
