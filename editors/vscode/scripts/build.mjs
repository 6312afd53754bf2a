// Makes what the extension consists of: one file of JavaScript, and a copy of the grammar, which stands once, in grammar/.
import { copyFile, mkdir } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const here = fileURLToPath(new URL('..', import.meta.url));
const GRAMMAR = 'clisc.tmLanguage.json';

await mkdir(`${here}syntaxes`, { recursive: true });
await copyFile(`${here}../../grammar/${GRAMMAR}`, `${here}syntaxes/${GRAMMAR}`);
await build({
  absWorkingDir: here,
  entryPoints: ['src/extension.ts'],
  outfile: 'dist/extension.js',
  bundle: true,
  platform: 'node',
  format: 'cjs',
  target: 'node20',
  external: ['vscode'],
  minify: true,
});
