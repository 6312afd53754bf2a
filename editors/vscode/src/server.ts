// The language server, `clisc lsp`, which knows everything that this extension says about a scene.

import { LanguageClient, type LanguageClientOptions, type ServerOptions } from 'vscode-languageclient/node';
import { program, reportMissing } from './program';

/** The server that runs, or none. One is stopped before the next is started, also when the setting changes meanwhile. */
export class Server {
  private client: LanguageClient | undefined;
  private last: Promise<void> = Promise.resolve();

  /** Starts the server, anew if it runs. */
  restart(): Promise<void> {
    return this.next(async () => {
      await this.stopClient();
      await this.startClient();
    });
  }

  /** Stops the server. */
  stop(): Promise<void> {
    return this.next(() => this.stopClient());
  }

  /** Runs `step` when the steps before it are done, however they ended. */
  private next(step: () => Promise<void>): Promise<void> {
    this.last = this.last.then(step, step);
    return this.last;
  }

  private async startClient(): Promise<void> {
    const server: ServerOptions = { command: program(), args: ['lsp'] };
    const client: LanguageClientOptions = {
      documentSelector: [
        { scheme: 'file', language: 'clisc' },
        { scheme: 'untitled', language: 'clisc' },
      ],
    };
    try {
      this.client = new LanguageClient('clisc', 'clisc', server, client);
      await this.client.start();
    } catch (error) {
      this.client = undefined;
      void reportMissing(error);
    }
  }

  private async stopClient(): Promise<void> {
    const client = this.client;
    this.client = undefined;
    await client?.dispose();
  }
}
