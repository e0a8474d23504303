// Bundles the page's program, style and frame into one file: node build.mjs [OUTPUT.js]
import { build } from 'esbuild';

await build({
  entryPoints: ['src/main.js'],
  bundle: true,
  minify: true,
  format: 'iife',
  target: ['chrome110', 'firefox115', 'safari16.4'],
  charset: 'utf8',
  legalComments: 'eof',
  loader: { '.css': 'text', '.html': 'text' },
  outfile: process.argv[2] ?? 'dist/viewer.js',
});
