// Prints the points that "web-e57" (the Rust crate e57) finds in a file: x y z red green blue.
//
// Usage: node --experimental-wasm-modules read_e57.mjs FILE
import { readFileSync } from "node:fs";
import { convertE57 } from "web-e57";

const bytes = new Uint8Array(readFileSync(process.argv[2]));
process.stdout.write(Buffer.from(convertE57(bytes, "XYZ")));
