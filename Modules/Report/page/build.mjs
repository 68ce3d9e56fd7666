// Bundles the page's script: node build.mjs FOLDER writes FOLDER/bundle.js (minified, the licences of what it holds at
// its end) and FOLDER/bundle.txt (base64 of its gzip).
import { build } from 'esbuild';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';

/** The packages whose code is in the bundle, by esbuild's list of inputs. */
function packagesOf(inputs) {
  const names = Object.entries(inputs)
    .filter(([, input]) => input.bytesInOutput > 0)
    .map(([path]) => path.match(/.*node_modules\/((?:@[^/]+\/)?[^/]+)/)?.[1]);
  return [...new Set(names)].filter(Boolean).sort();
}

/** Name, version and licence text of a package. */
function licenceOf(name) {
  const folder = join('node_modules', name);
  const { version, license, author } = JSON.parse(readFileSync(join(folder, 'package.json')));
  const files = readdirSync(folder)
    .filter((file) => /^(licen[cs]e|copyright)/i.test(file))
    .sort();
  const texts = files.map((file) => readFileSync(join(folder, file), 'utf8').replaceAll('*/', '* /').trim());
  return [`${name} ${version}, ${license}, ${author?.name ?? author ?? ''}`, ...texts].join('\n\n');
}

const folder = process.argv[2];
const result = await build({
  entryPoints: ['src/main.js'],
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  legalComments: 'eof',
  charset: 'ascii',
  alias: { 'spark-md5': './src/hash.js' },
  metafile: true,
  write: false,
  outfile: 'bundle.js'
});
const licences = packagesOf(result.metafile.outputs['bundle.js'].inputs).map(licenceOf);
const script = `${result.outputFiles[0].text}\n/*! This script holds:\n\n${licences.join('\n\n----\n\n')}\n*/\n`;
const packed = gzipSync(script, { level: 9 });
writeFileSync(join(folder, 'bundle.js'), script);
writeFileSync(join(folder, 'bundle.txt'), packed.toString('base64'));
console.log(`Report page: ${script.length} bytes of script, ${packed.length} packed.`);
