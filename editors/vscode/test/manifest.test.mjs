// What package.json promises is there.

import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import Module from 'node:module';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

const HERE = fileURLToPath(new URL('..', import.meta.url));
const { contributes, main } = JSON.parse(readFileSync(`${HERE}package.json`, 'utf8'));

/** Anything: it can be called, made with `new`, and asked for any field. */
function anything(fields = {}) {
  return new Proxy(Object.assign(function () {}, fields), {
    get: (target, key) => fields[key] ?? (key === 'prototype' ? target.prototype : typeof key === 'symbol' || key === 'then' ? undefined : anything()),
    apply: () => anything(),
    construct: () => anything(),
  });
}

test('every file that is named is there', () => {
  const [language] = contributes.languages;
  for (const file of [main, language.configuration, contributes.grammars[0].path]) {
    assert.ok(existsSync(HERE + file), `${file}: run npm run build first`);
  }
  JSON.parse(readFileSync(HERE + language.configuration, 'utf8'));
});

test('grammar and language have the names of the project', () => {
  const grammar = JSON.parse(readFileSync(HERE + contributes.grammars[0].path, 'utf8'));
  assert.equal(grammar.scopeName, contributes.grammars[0].scopeName);
  assert.equal(contributes.grammars[0].language, contributes.languages[0].id);
  assert.deepEqual(grammar.fileTypes.map((type) => `.${type}`), contributes.languages[0].extensions);
});

test('the bundle registers every command', async () => {
  const registered = [];
  const commands = { registerCommand: (name) => registered.push(name), executeCommand: async () => undefined };
  const workspace = anything({ getConfiguration: () => ({ get: () => 'no-such-program' }) });
  const vscode = anything({ version: '1.91.0', commands, workspace, window: anything() });
  const load = Module._load;
  Module._load = (request, ...others) => (request === 'vscode' ? vscode : load(request, ...others));
  const extension = Module.createRequire(import.meta.url)(HERE + main);
  Module._load = load;
  await extension.activate({ subscriptions: [], globalStorageUri: {} });
  assert.deepEqual(registered.sort(), contributes.commands.map(({ command }) => command).sort());
  await extension.deactivate();
});
