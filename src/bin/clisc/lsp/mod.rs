//! The language server: an editor on standard input and output, answers from `clisc::ide`.
//!
//! `transport` reads frames on a thread of its own and `server` takes the messages one by one: `documents` keeps the open
//! texts, `handlers` answers requests, `convert` turns places and lists into the protocol's. What is wrong with a scene is
//! found on a further thread, a moment after the last change, and told with the version that it is about: a version that
//! has passed is told nothing of. `configs` keeps what each `clisc.toml` says; every few seconds the server looks whether
//! one has changed and whether the editor still runs (`client_process`).
//!
//! Never here: what a scene means.

mod actions;
mod address;
mod capabilities;
mod client_process;
mod configs;
mod convert;
mod documents;
mod handlers;
mod server;
mod tokens;
mod transport;

pub use server::serve;
