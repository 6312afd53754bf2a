// `clisc lsp`, started as the extension starts it and spoken to by the protocol library that VS Code's client is made of.
//
// What the server answers is tested in the root of the project; here it is whether the two understand each other.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { test } from 'node:test';
import protocol from 'vscode-languageserver-protocol/node';

const CLISC = process.env.CLISC ?? 'clisc';
const SCENE = { uri: 'file:///scene.cli', languageId: 'clisc' };

/** Starts the server and greets it; returns the connection and what to wait for at the end. */
async function connect() {
  const server = spawn(CLISC, ['lsp'], { stdio: ['pipe', 'pipe', 'inherit'] });
  const end = once(server, 'exit');
  const { StreamMessageReader, StreamMessageWriter } = protocol;
  const reader = new StreamMessageReader(server.stdout);
  const connection = protocol.createProtocolConnection(reader, new StreamMessageWriter(server.stdin));
  connection.listen();
  const { capabilities } = await connection.sendRequest(protocol.InitializeRequest.type, {
    processId: process.pid,
    rootUri: null,
    capabilities: { general: { positionEncodings: ['utf-16'] }, textDocument: { publishDiagnostics: {} } },
  });
  await connection.sendNotification(protocol.InitializedNotification.type, {});
  return { connection, capabilities, end };
}

/** Returns the diagnostics that the server sends next. */
const nextDiagnostics = (connection) =>
  new Promise((resolve) => connection.onNotification(protocol.PublishDiagnosticsNotification.type, resolve));

test('a mistake is told, mended and told no more', async () => {
  const { connection, capabilities, end } = await connect();
  assert.equal(capabilities.positionEncoding ?? 'utf-16', 'utf-16');
  const wrong = 'fov 60\nlight 1 1 1  0 0 5\nsurface 0 0.2 0  0.4 0.1 0.1  0 0 0  1  0\nsphere 0 0 -4\nwrite a.png\n';
  let told = nextDiagnostics(connection);
  await connection.sendNotification(protocol.DidOpenTextDocumentNotification.type, {
    textDocument: { ...SCENE, version: 1, text: wrong },
  });
  const { diagnostics } = await told;
  assert.deepEqual(diagnostics.filter(({ severity }) => severity === protocol.DiagnosticSeverity.Error).map(({ code }) => code), ['E0203']);
  assert.equal(diagnostics[0].range.start.line, 3);

  told = nextDiagnostics(connection);
  const place = { line: 3, character: 'sphere 0 0 -4'.length };
  await connection.sendNotification(protocol.DidChangeTextDocumentNotification.type, {
    textDocument: { uri: SCENE.uri, version: 2 },
    contentChanges: [{ range: { start: place, end: place }, text: ' 1' }],
  });
  const mended = await told;
  assert.equal(mended.version ?? 2, 2);
  assert.deepEqual(mended.diagnostics.filter(({ severity }) => severity === protocol.DiagnosticSeverity.Error), []);

  await connection.sendRequest(protocol.ShutdownRequest.type);
  await connection.sendNotification(protocol.ExitNotification.type);
  assert.deepEqual(await end, [0, null]);
  connection.dispose();
});
