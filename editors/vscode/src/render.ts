// `clisc run` for the scene at hand, and a look at its images.

import { spawn } from 'node:child_process';
import { mkdir, readdir, rm } from 'node:fs/promises';
import * as path from 'node:path';
import * as vscode from 'vscode';
import { program, reportMissing } from './program';

/** Renders the scene of the active editor into a folder of the extension's own and opens the images beside it. */
export async function render(storage: vscode.Uri, log: vscode.OutputChannel): Promise<void> {
  const scene = vscode.window.activeTextEditor?.document;
  if (scene?.languageId !== 'clisc' || !(await scene.save()) || scene.uri.scheme !== 'file') {
    void vscode.window.showInformationMessage('clisc: open a scene that is saved as a file to render it.');
    return;
  }
  const folder = path.join(storage.fsPath, 'images');
  // Images of an earlier run are no images of this scene.
  await rm(folder, { recursive: true, force: true });
  await mkdir(folder, { recursive: true });
  const title = `Rendering ${path.basename(scene.fileName)}`;
  const options = { location: vscode.ProgressLocation.Notification, title, cancellable: true };
  const outcome = await vscode.window.withProgress(options, (_, token) => run(scene.fileName, folder, token, log));
  if (outcome === 'failed') {
    log.show(true);
  } else if (outcome === 'done') {
    await openImages(folder);
  }
}

/** Runs `clisc run`; what it says goes to `log`. A program that cannot be started is reported, and counts as stopped. */
function run(scene: string, folder: string, token: vscode.CancellationToken, log: vscode.OutputChannel) {
  log.clear();
  return new Promise<'done' | 'failed' | 'stopped'>((resolve) => {
    const args = ['run', scene, '--out-dir', folder];
    const child = spawn(program(), args, { cwd: path.dirname(scene), stdio: ['ignore', 'pipe', 'pipe'] });
    for (const stream of [child.stdout, child.stderr]) {
      stream.setEncoding('utf8').on('data', (text: string) => log.append(text));
    }
    token.onCancellationRequested(() => child.kill());
    child.on('error', (error) => {
      void reportMissing(error);
      resolve('stopped');
    });
    child.on('close', (code) => resolve(token.isCancellationRequested ? 'stopped' : code === 0 ? 'done' : 'failed'));
  });
}

/** Opens every image below `folder`. */
async function openImages(folder: string): Promise<void> {
  for (const entry of await readdir(folder, { recursive: true })) {
    if (entry.endsWith('.png')) {
      const image = vscode.Uri.file(path.join(folder, entry));
      await vscode.commands.executeCommand('vscode.open', image, { viewColumn: vscode.ViewColumn.Beside, preview: false });
    }
  }
}
