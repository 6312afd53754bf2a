// Scenes in VS Code: what is said about them comes from `clisc lsp`, how they look from the grammar in grammar/.

import * as vscode from 'vscode';
import { render } from './render';
import { Server } from './server';

const server = new Server();

/** Starts the language server; called by VS Code when the first scene is opened. */
export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const log = vscode.window.createOutputChannel('clisc run');
  context.subscriptions.push(
    log,
    vscode.commands.registerCommand('clisc.restart', () => server.restart()),
    vscode.commands.registerCommand('clisc.render', () => render(context.globalStorageUri, log)),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration('clisc.path')) {
        void server.restart();
      }
    }),
  );
  await server.restart();
}

/** Stops the language server; called by VS Code at its end. */
export function deactivate(): Promise<void> {
  return server.stop();
}
