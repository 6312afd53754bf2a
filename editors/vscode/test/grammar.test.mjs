// The scopes that the TextMate grammar gives, held against what clisc says of every scene of the project.
//
// Expects the command in `CLISC`, or on the path.

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import oniguruma from 'vscode-oniguruma';
import textmate from 'vscode-textmate';

const ROOT = fileURLToPath(new URL('../../..', import.meta.url));
const CLISC = process.env.CLISC ?? 'clisc';
const GRAMMAR = path.join(ROOT, 'grammar/clisc.tmLanguage.json');
const SCENES = ['scenes', 'tests/fixtures', 'fuzz/seeds'];

/** Errors that lack something, at which no word is wrong, and those of numbers that are too large. */
const WITHOUT_WRONG_WORD = ['E0203', 'E0207', 'E0208'];

/** What is put into lines to spoil them, or not. */
const PIECES = ['', '', '', ' ', '\t', '1', '.', '-', 'e5', 'x', ',', '#', '"', '.png', ' write ', '\u00A0', '\u3000', '\u0085', '\0', 'π', '😀'];

let grammar;
/** What is said of every scene of the project. */
let scenes;

before(async () => {
  const wasm = createRequire(import.meta.url).resolve('vscode-oniguruma/release/onig.wasm');
  await oniguruma.loadWASM(readFileSync(wasm));
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => textmate.parseRawGrammar(readFileSync(GRAMMAR, 'utf8'), GRAMMAR),
  });
  grammar = await registry.loadGrammar('source.clisc');
  scenes = said(files());
});

/** Returns the lines of a scene as an editor has them, each with its place in bytes and its tokens. */
function tokenize(text) {
  let start = text.startsWith('\uFEFF') ? 3 : 0;
  let stack = textmate.INITIAL;
  return text.replace(/^\uFEFF/, '').split('\n').map((whole) => {
    const line = whole.replace(/\r$/, '');
    const result = grammar.tokenizeLine(line, stack);
    stack = result.ruleStack;
    const at = start;
    start += Buffer.byteLength(whole) + 1;
    const bytes = (index) => at + Buffer.byteLength(line.slice(0, index));
    const tokens = result.tokens.map(({ startIndex, endIndex, scopes }) => ({
      start: bytes(startIndex),
      end: bytes(endIndex),
      text: line.slice(startIndex, endIndex),
      scopes: scopes.slice(1),
    }));
    return { start: at, end: start, tokens };
  });
}

/** Returns the paths of the scenes that an editor shows as they are: UTF-8, and without lone carriage returns. */
function files() {
  const paths = SCENES.flatMap((folder) =>
    readdirSync(path.join(ROOT, folder), { recursive: true })
      .filter((name) => name.endsWith('.cli'))
      .map((name) => path.join(ROOT, folder, name)),
  );
  return paths.filter((name) => {
    const bytes = readFileSync(name);
    const text = bytes.toString('utf8');
    return Buffer.from(text).equals(bytes) && !/\r(?!\n)|^.?\0/.test(text);
  });
}

/** Returns for each scene its name, its lines as the grammar sees them, and its commands and diagnostics by clisc. */
function said(names) {
  const { diagnostics } = clisc('check', ...names, '--format', 'json');
  return names.map((name) => ({
    name,
    lines: tokenize(readFileSync(name, 'utf8')),
    commands: clisc('ir', name, '--emit', 'ast', '--format', 'json').commands,
    diagnostics: diagnostics.filter(({ path }) => path === name),
  }));
}

/** Returns what `clisc` prints as JSON; scenes with errors make it exit with 1. */
function clisc(...args) {
  const { stdout, status, error } = spawnSync(CLISC, args, { encoding: 'utf8', maxBuffer: 1 << 28 });
  assert.ifError(error);
  assert.ok(status === 0 || status === 1, `${args.join(' ')}: exit code ${status}`);
  return JSON.parse(stdout);
}

const isInvalid = (token) => token.scopes.some((scope) => scope.startsWith('invalid.'));

/** Returns the codes of what is wrong with the text of a line. */
function codesOf(line, diagnostics) {
  const isHere = ({ code, primary: { bytes } }) =>
    /^E0[12]/.test(code) && bytes.start >= line.start && bytes.start < line.end;
  return diagnostics.filter(isHere).map(({ code }) => code);
}

/** Checks the scopes of one command without a mistake; returns how many arguments it has. */
function checkCommand(name, command, line) {
  const [keyword, ...words] = line.tokens.filter((token) => token.text.trim() !== '' && token.start < command.span.end);
  assert.equal(keyword.text, command.kind, name);
  assert.match(keyword.scopes.at(-1), /^keyword\.(other|control)\./, name);
  const args = command.arguments.map((arg) => ({ ...arg, scope: new RegExp(`^constant\\.numeric\\..*\\.${arg.name}\\.clisc$`) }));
  if (command.name) {
    args.push({ span: command.name[1], scope: /^string\.(un)?quoted\./ });
  }
  assert.deepEqual(words.map(({ start, end }) => ({ start, end })), args.map(({ span }) => span), name);
  for (const [i, { scope }] of args.entries()) {
    assert.match(words[i].scopes[0], scope, name);
    assert.ok(!isInvalid(words[i]), `${name}: ${words[i].text} is invalid`);
  }
  return args.length;
}

/** Checks every command of a scene without a mistake; returns how many arguments there are. */
function checkArguments({ name, lines, commands, diagnostics }) {
  let n = 0;
  for (const command of commands.filter(({ bad }) => !bad)) {
    const line = lines.find(({ end }) => end > command.span.start);
    if (codesOf(line, diagnostics).length === 0) {
      n += checkCommand(name, command, line);
    }
  }
  return n;
}

/** Checks that words are invalid on the lines that clisc finds wrong, and there alone; returns how many lines that are. */
function checkInvalid({ name, lines, diagnostics }) {
  let n = 0;
  for (const line of lines) {
    const codes = codesOf(line, diagnostics);
    const words = line.tokens.filter(isInvalid).map(({ text }) => text);
    const at = `${name}: ${JSON.stringify(line.tokens.map(({ text }) => text).join(''))}`;
    if (words.length > 0) {
      assert.notEqual(codes.length, 0, `${at}: clisc has nothing against ${words}`);
      n += 1;
    } else {
      assert.ok(codes.every((code) => WITHOUT_WRONG_WORD.includes(code)), `${at}: clisc says ${codes}`);
    }
  }
  return n;
}

const sum = (numbers) => numbers.reduce((total, number) => total + number, 0);

test('every argument has the scope of its name', () => {
  const n = sum(scenes.map(checkArguments));
  assert.ok(n > 3000, `${n} arguments`);
});

test('a word is invalid where clisc says so', () => {
  const n = sum(scenes.map(checkInvalid));
  assert.ok(n > 100, `${n} lines with a wrong word`);
});

test('both hold on lines that are nearly right', (t) => {
  const folder = mkdtempSync(path.join(tmpdir(), 'clisc-'));
  t.after(() => rmSync(folder, { recursive: true }));
  const name = path.join(folder, 'nearly.cli');
  writeFileSync(name, nearlyRight(4000));
  const [scene] = said([name]);
  const [nArguments, nInvalid] = [checkArguments(scene), checkInvalid(scene)];
  assert.ok(nArguments > 2000 && nInvalid > 1000, `${nArguments} arguments, ${nInvalid} lines with a wrong word`);
});

/** Returns this many lines of the scenes, most of them with a piece put in or taken out; the same at every call. */
function nearlyRight(n) {
  const lines = scenes.flatMap(({ lines }) => lines.map(({ tokens }) => tokens.map(({ text }) => text).join('')));
  const commands = lines.filter((line) => /^\s*[a-z]/.test(line));
  let state = 1;
  // A linear congruence; its high bits are good enough to choose by.
  const below = (bound) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * bound);
  };
  const changed = () => {
    const line = commands[below(commands.length)];
    const at = below(line.length + 1);
    return line.slice(0, at) + PIECES[below(PIECES.length)] + line.slice(at + below(3));
  };
  return Array.from({ length: n }, changed).join('\n');
}

test('a comment is one, and nothing in it is a word', () => {
  for (const text of ['# sphere 1 2 3', 'fov 60# sphere', '  # a', 'write a#b.png #c', 'write "a.png"#b', 'sphere x #y']) {
    const [line] = tokenize(text);
    const comment = line.tokens.filter((token) => token.scopes[0] === 'comment.line.number-sign.clisc');
    const start = { 'write a#b.png #c': 14 }[text] ?? text.indexOf('#');
    assert.equal(comment.map((token) => token.text).join(''), text.slice(start), text);
  }
});
