// Reads what the program packed into the page (core/outputs/report_content.h, quantised_points.h).

const element = (id) => document.getElementById(id);

export function readJson(id) {
  return JSON.parse(element(id).textContent);
}

// As the rig file names them; maps of earlier versions do not say.
export const scannerNames = ({ statistics, summary }) =>
  statistics.by_scanner.map((_, i) => summary.scanners?.[i] ?? `scanner ${i}`);

function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = characters.charCodeAt(i);
  return bytes;
}

// Unpacks a section, and removes its text from the page: it is large.
export async function readSection(id) {
  const packed = bytesOfBase64(element(id).textContent);
  element(id).remove();
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(unpacked).arrayBuffer());
}

// Puts numbers together whose first bytes, second bytes, ... stand in arrays of their own.
function joinBytes(byPlace, numberBytes) {
  const count = byPlace.length / numberBytes;
  const bytes = new Uint8Array(byPlace.length);
  for (let place = 0; place < numberBytes; ++place) {
    const from = place * count;
    for (let i = 0; i < count; ++i) bytes[i * numberBytes + place] = byPlace[from + i];
  }
  return bytes.buffer;
}

export async function readFloat32(id) {
  return new Float32Array(joinBytes(await readSection(id), 4));
}

export async function readFloat64(id) {
  return new Float64Array(joinBytes(await readSection(id), 8));
}

// The poses of the rig: time since the recording's start, position, rotation, and the largest
// standard deviations of both.
export async function readPoses(count) {
  const numbers = await readFloat32('poses');
  const width = numbers.length / count;
  const poses = [];
  for (let i = 0; i < count; ++i) {
    const [t, x, y, z, qx, qy, qz, qw, positionStddev, rotationStddev] = numbers.subarray(
      i * width,
      (i + 1) * width,
    );
    poses.push({
      t,
      position: [x, y, z],
      rotation: [qx, qy, qz, qw],
      positionStddev,
      rotationStddev,
    });
  }
  return poses;
}

// Any first part of the points shows the whole map, thinner: they are put in levels, of every 256th
// point each, in an order that fills the gaps evenly (the level's bits reversed).
const LEVEL_BITS = 8;
export const NUM_LEVELS = 1 << LEVEL_BITS;

function reversedBits(level) {
  let reversed = 0;
  for (let bit = 0; bit < LEVEL_BITS; ++bit)
    reversed |= ((level >> bit) & 1) << (LEVEL_BITS - 1 - bit);
  return reversed;
}

// Returns where the points of each residue modulo the number of levels begin.
function levelStarts(count) {
  const starts = new Uint32Array(NUM_LEVELS);
  let start = 0;
  for (let level = 0; level < NUM_LEVELS; ++level) {
    const residue = reversedBits(level);
    starts[residue] = start;
    start += Math.floor((count - residue + NUM_LEVELS - 1) / NUM_LEVELS);
  }
  return starts;
}

const FIELDS = ['x', 'y', 'z', 'time', 'plane'];

// The points: `place` holds x, y, z in steps and the surface (0: none, 1: moving, 2 + index);
// `moment` the time in steps and the scanner.
export async function readPoints() {
  const header = readJson('points');
  const { count } = header;
  const ids = [
    ...FIELDS.flatMap((name) => [`points-${name}-0`, `points-${name}-1`]),
    'points-scanner-0',
  ];
  const [x0, x1, y0, y1, z0, z1, time0, time1, plane0, plane1, scanner] = await Promise.all(
    ids.map(readSection),
  );
  const starts = levelStarts(count);
  const place = new Uint16Array(4 * count);
  const moment = new Uint16Array(2 * count);
  // Fields are differences from point to point: 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
  const difference = (low, high) => {
    const code = low | (high << 8);
    return (code >> 1) ^ -(code & 1);
  };
  let [x, y, z, time, plane] = [0, 0, 0, 0, 0];
  for (let i = 0; i < count; ++i) {
    const at = starts[i & (NUM_LEVELS - 1)]++;
    place[4 * at] = x = (x + difference(x0[i], x1[i])) & 0xffff;
    place[4 * at + 1] = y = (y + difference(y0[i], y1[i])) & 0xffff;
    place[4 * at + 2] = z = (z + difference(z0[i], z1[i])) & 0xffff;
    place[4 * at + 3] = plane = (plane + difference(plane0[i], plane1[i])) & 0xffff;
    moment[2 * at] = time = (time + difference(time0[i], time1[i])) & 0xffff;
    moment[2 * at + 1] = scanner[i];
  }
  return { ...header, place, moment };
}
