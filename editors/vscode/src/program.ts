// Which program is clisc.

import { homedir } from 'node:os';
import * as path from 'node:path';
import * as vscode from 'vscode';

/** Returns the program that the setting `clisc.path` names, with `~` for the home folder written out. */
export function program(): string {
  const setting = vscode.workspace.getConfiguration('clisc').get<string>('path', '').trim() || 'clisc';
  return /^~[/\\]/.test(setting) ? path.join(homedir(), setting.slice(2)) : setting;
}

/** Tells the user that clisc could not be started, and offers the setting that says where it is. */
export async function reportMissing(error: unknown): Promise<void> {
  const reason = error instanceof Error ? error.message : String(error);
  const choice = await vscode.window.showErrorMessage(`clisc: \`${program()}\` could not be started: ${reason}`, 'Open Settings');
  if (choice) {
    await vscode.commands.executeCommand('workbench.action.openSettings', 'clisc.path');
  }
}
