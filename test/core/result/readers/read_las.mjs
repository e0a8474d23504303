// Prints what the LAS reader of "copc" finds in a file: the header, and every step'th value of
// every dimension.
//
// Usage: node read_las.mjs FILE STEP
import { readFileSync } from "node:fs";
import { Las } from "copc";

const bytes = new Uint8Array(readFileSync(process.argv[2]));
const step = Number(process.argv[3]);
const header = Las.Header.parse(bytes);
const records = await Las.Vlr.walk(async (begin, end) => bytes.subarray(begin, end), header);
const contentOf = (user, number) => {
  const record = records.find((r) => r.userId === user && r.recordId === number);
  return record && bytes.subarray(record.contentOffset, record.contentOffset + record.contentLength);
};
const extra = contentOf("LASF_Spec", 4);
const wkt = contentOf("LASF_Projection", 2112);
const view = Las.View.create(
  bytes.subarray(header.pointDataOffset), header, extra ? Las.ExtraBytes.parse(extra) : []);
const dimensions = {};
for (const name of Object.keys(view.dimensions)) {
  const get = view.getter(name);
  dimensions[name] = [];
  for (let i = 0; i < view.pointCount; i += step) dimensions[name].push(String(get(i)));
}
const text = wkt && Buffer.from(wkt).toString().replace(/\0$/, "");
console.log(JSON.stringify({ header, wkt: text, dimensions }));
