// Prints the words of the page's top and of its numbers: node words.mjs CASE.json
import { readFileSync } from 'node:fs';

// As much of a browser's document as the page's top needs.
class Element {
  constructor(tag) {
    this.tag = tag;
    this.parts = [];
  }

  append(...parts) {
    this.parts.push(...parts);
  }

  setAttribute(name, value) {
    this[name] = value;
  }

  addEventListener() {}

  get text() {
    return this.parts.map((part) => part.text ?? String(part)).join(' ');
  }
}
globalThis.Node = Element;
globalThis.document = {
  createElement: (tag) => new Element(tag),
  createElementNS: (space, tag) => new Element(tag),
};

const source = '../../../core/outputs/viewer/src';
const { drawBand, drawFigures, drawVerdict } = await import(`${source}/verdict.js`);
const { angleWithStddev, lengthWithStddev } = await import(`${source}/format.js`);
const { drawRig } = await import(`${source}/rig.js`);
const { bow } = await import(`${source}/surface.js`);
const { reports, cylinders, calibrations } = JSON.parse(readFileSync(process.argv[2], 'utf8'));
const found = {
  tops: reports.map((report) => ({
    band: drawBand(report)?.text ?? null,
    verdict: drawVerdict(report, () => {}).text,
    figures: drawFigures(report, [{ position: [0, 0, 0], positionStddev: 0.00164 }]).text,
  })),
  held: [angleWithStddev(Math.PI / 2, 0), lengthWithStddev(2, 0)],
  measured: [angleWithStddev(Math.PI / 2, 1e-4), lengthWithStddev(2, 1e-3)],
  rigs: calibrations.map((calibration) => drawRig(calibration).text),
  bows: cylinders.map(bow),
};
console.log(JSON.stringify(found));
