// Bundles the page's program, style and frame into one file: node build.mjs [OUTPUT.js]
import { readFileSync } from 'node:fs';
import { build } from 'esbuild';

// The licence asks for its text in every copy, and every report holds one.
const licence = readFileSync('node_modules/three/LICENSE', 'utf8').trim();

await build({
  entryPoints: ['src/main.js'],
  bundle: true,
  minify: true,
  format: 'iife',
  target: ['chrome110', 'firefox115', 'safari16.4'],
  charset: 'utf8',
  legalComments: 'none',
  banner: { js: `/*! three.js\n${licence}\n*/` },
  loader: { '.css': 'text', '.html': 'text' },
  outfile: process.argv[2] ?? 'dist/viewer.js',
});
