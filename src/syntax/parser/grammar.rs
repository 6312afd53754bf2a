//! The arguments of a command as a grammar, in chumsky.
//!
//! The grammar is written once, generic in its errors: with empty ones it says at full speed whether a line is good, with
//! rich ones it says on a second look at a bad line what is wrong with it.

use chumsky::error::{EmptyErr, Rich};
use chumsky::prelude::*;

use crate::syntax::spec::Arguments;
use crate::syntax::token::{Token, TokenKind};

/// The tokens behind the name of a command, without blanks and comments.
type Input<'t> = &'t [Token];
/// Errors that say nothing.
type Cheap = extra::Err<EmptyErr>;
/// Errors that say which token was found where.
type Full<'t> = extra::Err<Rich<'t, Token>>;

/// Tells whether `tokens` are the arguments that a command takes.
pub(super) fn accepts(arguments: &Arguments, tokens: Input<'_>) -> bool {
    match arguments {
        Arguments::Numbers(args) => !number::<Cheap>().repeated().exactly(args.len()).check(tokens).has_errors(),
        Arguments::FileName(_) => !file_name::<Cheap>().check(tokens).has_errors(),
    }
}

/// Returns what is wrong with `tokens` as the arguments that a command takes: an error for each wrong one among those
/// expected, one for all that are missing, one for all that are too many.
pub(super) fn errors<'t>(arguments: &Arguments, tokens: Input<'t>) -> Vec<Rich<'t, Token>> {
    match arguments {
        Arguments::Numbers(args) => tolerant(args.len(), number()).parse(tokens).into_errors(),
        Arguments::FileName(_) => tolerant(1, file_name()).parse(tokens).into_errors(),
    }
}

/// Parses a number.
fn number<'t, E: extra::ParserExtra<'t, Input<'t>>>() -> impl Parser<'t, Input<'t>, (), E> + Clone {
    any().filter(|token: &Token| token.kind == TokenKind::Number).ignored()
}

/// Parses a file name.
fn file_name<'t, E: extra::ParserExtra<'t, Input<'t>>>() -> impl Parser<'t, Input<'t>, (), E> + Clone {
    any().filter(|token: &Token| matches!(token.kind, TokenKind::Path | TokenKind::Quoted)).ignored()
}

/// Parses `n` arguments. A wrong token takes the place of an argument; tokens behind the last one are passed over.
fn tolerant<'t>(
    n: usize,
    argument: impl Parser<'t, Input<'t>, (), Full<'t>> + Clone,
) -> impl Parser<'t, Input<'t>, (), Full<'t>> {
    let argument = argument.recover_with(via_parser(any().ignored()));
    let surplus = any().repeated().at_least(1);
    argument.repeated().exactly(n).then_ignore(end().recover_with(via_parser(surplus)))
}
