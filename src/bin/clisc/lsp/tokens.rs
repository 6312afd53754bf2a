//! Semantic tokens, as the protocol packs them: each told by its distance from the one before.

use clisc::ide::semantic_tokens;
use clisc::source::Span;
use lsp_server::ResponseError;
use lsp_types::{
    SemanticToken, SemanticTokens, SemanticTokensDelta, SemanticTokensDeltaParams, SemanticTokensEdit,
    SemanticTokensFullDeltaResult, SemanticTokensParams, SemanticTokensRangeParams, SemanticTokensRangeResult,
    SemanticTokensResult,
};

use crate::lsp::convert::Places;
use crate::lsp::documents::Open;

/// How many numbers a token is in the protocol.
const TOKEN_LEN: u32 = 5;

type Answer<T> = Result<T, ResponseError>;

pub fn full(open: &Open, _: SemanticTokensParams) -> Answer<Option<SemanticTokensResult>> {
    let data = packed(open, whole(open));
    let result_id = Some(remember(open, data.clone()));
    Ok(Some(SemanticTokensResult::Tokens(SemanticTokens { result_id, data })))
}

/// Tells what has changed since the tokens were sent, if the editor has kept them.
pub fn delta(open: &Open, params: SemanticTokensDeltaParams) -> Answer<Option<SemanticTokensFullDeltaResult>> {
    let data = packed(open, whole(open));
    let sent = open.sent_tokens.take().filter(|(id, _)| id.to_string() == params.previous_result_id);
    let result_id = Some(remember(open, data.clone()));
    Ok(Some(match sent {
        Some((_, sent)) => {
            let edits = difference(&sent, &data).into_iter().collect();
            SemanticTokensFullDeltaResult::TokensDelta(SemanticTokensDelta { result_id, edits })
        }
        None => SemanticTokensFullDeltaResult::Tokens(SemanticTokens { result_id, data }),
    }))
}

pub fn range(open: &Open, params: SemanticTokensRangeParams) -> Answer<Option<SemanticTokensRangeResult>> {
    let data = packed(open, Places::new(open).span(params.range));
    Ok(Some(SemanticTokensRangeResult::Tokens(SemanticTokens { result_id: None, data })))
}

fn whole(open: &Open) -> Span {
    Span::new(0, open.document.text().len() as u32)
}

/// Keeps what is sent and gives it a name.
fn remember(open: &Open, data: Vec<SemanticToken>) -> String {
    let id = open.generation;
    open.sent_tokens.replace(Some((id, data)));
    id.to_string()
}

fn packed(open: &Open, span: Span) -> Vec<SemanticToken> {
    let places = Places::new(open);
    let (mut line, mut column) = (0, 0);
    let tokens = semantic_tokens(&open.document, span);
    let pack = |token: clisc::ide::SemanticToken| {
        let range = places.range(token.span);
        let delta_line = range.start.line - line;
        let delta_start = if delta_line == 0 { range.start.character - column } else { range.start.character };
        (line, column) = (range.start.line, range.start.character);
        let length = range.end.character - range.start.character;
        SemanticToken { delta_line, delta_start, length, token_type: token.kind as u32, token_modifiers_bitset: 0 }
    };
    tokens.into_iter().map(pack).collect()
}

/// Returns the one edit that makes the new tokens of the old.
fn difference(old: &[SemanticToken], new: &[SemanticToken]) -> Option<SemanticTokensEdit> {
    let n_before = old.iter().zip(new).take_while(|(old, new)| old == new).count();
    let (old, new) = (&old[n_before..], &new[n_before..]);
    let n_behind = old.iter().rev().zip(new.iter().rev()).take_while(|(old, new)| old == new).count();
    let (old, new) = (&old[..old.len() - n_behind], &new[..new.len() - n_behind]);
    (!old.is_empty() || !new.is_empty()).then(|| SemanticTokensEdit {
        start: n_before as u32 * TOKEN_LEN,
        delete_count: old.len() as u32 * TOKEN_LEN,
        data: (!new.is_empty()).then(|| new.to_vec()),
    })
}
