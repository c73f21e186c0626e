// Bundles the page: page.html with style and program inside, and the licenses of the libraries that went in.
// usage: node build.mjs OUTPUT.html

import {readFileSync, readdirSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {build} from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const output = process.argv[2];
if (!output) throw new Error('usage: node build.mjs OUTPUT.html');

const bundled = await build({
  entryPoints: [join(here, 'src/main.mjs')],
  absWorkingDir: here,
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2020',
  charset: 'utf8',
  legalComments: 'none', // the licenses themselves go into the page
  write: false,
  metafile: true,
});
const style = await build({
  entryPoints: [join(here, 'style.css')], bundle: true, minify: true, write: false,
});

function packageFolders(inputs) {
  const folders = new Set();
  for (const path of Object.keys(inputs)) {
    const match = path.match(/^(.*node_modules\/(?:@[^/]+\/)?[^/]+)\//);
    if (match) folders.add(match[1]);
  }
  return [...folders].sort();
}

function licenseOf(folder) {
  const {name, version, license} = JSON.parse(readFileSync(join(here, folder, 'package.json'), 'utf8'));
  const file = readdirSync(join(here, folder)).find((entry) => /^licen[cs]e/i.test(entry));
  const text = file ? readFileSync(join(here, folder, file), 'utf8').trim() : '';
  return `${name} ${version} (${license})\n\n${text}\n`;
}

const escapeHtml = (text) => text.replace(/&/g, '&amp;').replace(/</g, '&lt;');
const parts = {
  STYLE: style.outputFiles[0].text.trim(),
  PROGRAM: bundled.outputFiles[0].text.trim().replace(/<\/script/gi, '<\\/script').replace(/<!--/g, '<\\!--'),
  LICENSES: escapeHtml(packageFolders(bundled.metafile.inputs).map(licenseOf).join('\n')),
};
const page = readFileSync(join(here, 'page.html'), 'utf8').replace(/@([A-Z]+)@/g, (mark, name) => parts[name] ?? mark);
writeFileSync(output, page);
