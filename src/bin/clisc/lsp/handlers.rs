//! Questions that change nothing.

use clisc::ide::{self, Completion, CompletionKind, FoldKind, Symbol};
use clisc::syntax::spec::CommandKind;
use lsp_server::ResponseError;
use lsp_types::{
    Color, ColorInformation, ColorPresentation, ColorPresentationParams, CompletionItem, CompletionItemKind,
    CompletionParams, CompletionResponse, CompletionTextEdit, DocumentColorParams, DocumentHighlight,
    DocumentHighlightKind, DocumentHighlightParams, DocumentSymbol, DocumentSymbolParams, DocumentSymbolResponse,
    FoldingRange, FoldingRangeKind, FoldingRangeParams, GotoDefinitionParams, GotoDefinitionResponse, Hover,
    HoverContents, HoverParams, InlayHint, InlayHintKind, InlayHintLabel, InlayHintParams, InlayHintTooltip,
    InsertTextFormat, Location, ParameterInformation, ParameterLabel, ReferenceParams, SignatureHelp,
    SignatureHelpParams, SignatureInformation, SymbolInformation, SymbolKind,
};

use crate::lsp::convert::{Places, documentation, markup};
use crate::lsp::documents::Open;

type Answer<T> = Result<T, ResponseError>;

pub fn hover(open: &Open, params: HoverParams) -> Answer<Option<Hover>> {
    let places = Places::new(open);
    let hover = ide::hover(&open.document, places.offset(params.text_document_position_params.position));
    Ok(hover.map(|hover| Hover {
        contents: HoverContents::Markup(markup(hover.markdown, open.client.has_markdown)),
        range: Some(places.range(hover.span)),
    }))
}

pub fn completion(open: &Open, params: CompletionParams) -> Answer<Option<CompletionResponse>> {
    let places = Places::new(open);
    let found = ide::completions(&open.document, places.offset(params.text_document_position.position));
    let items = found.into_iter().enumerate().map(|(order, found)| completion_item(open, &places, order, found));
    Ok(Some(CompletionResponse::Array(items.collect())))
}

fn completion_item(open: &Open, places: &Places<'_>, order: usize, found: Completion) -> CompletionItem {
    let snippet = found.snippet.filter(|_| open.client.has_snippets);
    let format = if snippet.is_some() { InsertTextFormat::SNIPPET } else { InsertTextFormat::PLAIN_TEXT };
    let edit = places.text_edit(found.span, snippet.unwrap_or(found.text));
    CompletionItem {
        label: found.label,
        kind: Some(match found.kind {
            CompletionKind::Command => CompletionItemKind::KEYWORD,
            CompletionKind::Value => CompletionItemKind::VALUE,
            CompletionKind::Color => CompletionItemKind::COLOR,
            CompletionKind::FileName => CompletionItemKind::FILE,
            CompletionKind::Directive => CompletionItemKind::SNIPPET,
        }),
        detail: (!found.detail.is_empty()).then_some(found.detail),
        documentation: documentation(found.doc),
        sort_text: Some(format!("{order:04}")),
        insert_text_format: Some(format),
        text_edit: Some(CompletionTextEdit::Edit(edit)),
        ..CompletionItem::default()
    }
}

pub fn signature_help(open: &Open, params: SignatureHelpParams) -> Answer<Option<SignatureHelp>> {
    let offset = Places::new(open).offset(params.text_document_position_params.position);
    let Some(signature) = ide::signature(&open.document, offset) else { return Ok(None) };
    // Older versions of the protocol cannot say that no argument is at hand; then there is nothing to help with.
    let Some(active) = signature.active else { return Ok(None) };
    let parameters = signature.args.into_iter().map(|(bytes, doc)| ParameterInformation {
        label: ParameterLabel::LabelOffsets([bytes.start as u32, bytes.end as u32]),
        documentation: documentation(doc),
    });
    let information = SignatureInformation {
        label: signature.label,
        documentation: documentation(signature.doc.to_owned()),
        parameters: Some(parameters.collect()),
        active_parameter: Some(active as u32),
    };
    Ok(Some(SignatureHelp {
        signatures: vec![information],
        active_signature: Some(0),
        active_parameter: Some(active as u32),
    }))
}

pub fn definition(open: &Open, params: GotoDefinitionParams) -> Answer<Option<GotoDefinitionResponse>> {
    let places = Places::new(open);
    let surface = ide::surface_at(&open.document, places.offset(params.text_document_position_params.position));
    Ok(surface.map(|surface| GotoDefinitionResponse::Scalar(places.location(surface))))
}

pub fn references(open: &Open, params: ReferenceParams) -> Answer<Option<Vec<Location>>> {
    let places = Places::new(open);
    let uses = ide::uses_of_surface_at(&open.document, places.offset(params.text_document_position.position));
    let wanted = uses.iter().filter(|found| params.context.include_declaration || !found.is_surface);
    Ok(Some(wanted.map(|found| places.location(found.span)).collect()))
}

pub fn highlights(open: &Open, params: DocumentHighlightParams) -> Answer<Option<Vec<DocumentHighlight>>> {
    let places = Places::new(open);
    let offset = places.offset(params.text_document_position_params.position);
    let highlight = |span, kind| DocumentHighlight { range: places.range(span), kind: Some(kind) };
    let names = ide::names_at(&open.document, offset).map_or_else(Vec::new, |names| names.places);
    let names = names.into_iter().map(|span| highlight(span, DocumentHighlightKind::TEXT));
    let uses = ide::uses_of_surface_at(&open.document, offset).into_iter().map(|found| {
        let kind = if found.is_surface { DocumentHighlightKind::WRITE } else { DocumentHighlightKind::READ };
        highlight(found.span, kind)
    });
    Ok(Some(names.chain(uses).collect()))
}

pub fn document_symbols(open: &Open, _: DocumentSymbolParams) -> Answer<Option<DocumentSymbolResponse>> {
    let places = Places::new(open);
    let symbols = ide::outline(&open.document);
    Ok(Some(if open.client.has_tree_symbols {
        DocumentSymbolResponse::Nested(symbols.into_iter().map(|symbol| nested(&places, symbol)).collect())
    } else {
        let flat = symbols.iter().flat_map(|symbol| std::iter::once(symbol).chain(&symbol.children));
        DocumentSymbolResponse::Flat(flat.map(|symbol| flat_symbol(&places, symbol)).collect())
    }))
}

const fn symbol_kind(kind: CommandKind) -> SymbolKind {
    match kind {
        CommandKind::Fov | CommandKind::Background => SymbolKind::PROPERTY,
        CommandKind::Light => SymbolKind::EVENT,
        CommandKind::Surface => SymbolKind::CLASS,
        CommandKind::Sphere | CommandKind::Cylinder => SymbolKind::OBJECT,
        CommandKind::Write => SymbolKind::FILE,
    }
}

#[expect(deprecated, reason = "the structure still has the field")]
fn nested(places: &Places<'_>, symbol: Symbol) -> DocumentSymbol {
    DocumentSymbol {
        name: symbol.kind.name().to_owned(),
        detail: Some(symbol.detail),
        kind: symbol_kind(symbol.kind),
        range: places.range(symbol.span),
        selection_range: places.range(symbol.command),
        children: Some(symbol.children.into_iter().map(|child| nested(places, child)).collect()),
        tags: None,
        deprecated: None,
    }
}

#[expect(deprecated, reason = "the structure still has the field")]
fn flat_symbol(places: &Places<'_>, symbol: &Symbol) -> SymbolInformation {
    SymbolInformation {
        name: format!("{} {}", symbol.kind.name(), symbol.detail),
        kind: symbol_kind(symbol.kind),
        location: places.location(symbol.command),
        container_name: None,
        tags: None,
        deprecated: None,
    }
}

pub fn folding_ranges(open: &Open, _: FoldingRangeParams) -> Answer<Option<Vec<FoldingRange>>> {
    let folds = ide::folds(&open.document).into_iter().map(|fold| FoldingRange {
        start_line: fold.first,
        end_line: fold.last,
        kind: match fold.kind {
            FoldKind::Comment => Some(FoldingRangeKind::Comment),
            FoldKind::Fence => Some(FoldingRangeKind::Region),
            FoldKind::Surface => None,
        },
        ..FoldingRange::default()
    });
    Ok(Some(folds.collect()))
}

pub fn inlay_hints(open: &Open, params: InlayHintParams) -> Answer<Option<Vec<InlayHint>>> {
    let places = Places::new(open);
    let hints = ide::hints(&open.document, places.span(params.range)).into_iter().map(|hint| InlayHint {
        position: places.position(hint.at),
        label: InlayHintLabel::String(format!("{}:", hint.label)),
        kind: Some(InlayHintKind::PARAMETER),
        tooltip: Some(InlayHintTooltip::String(hint.doc.to_owned())),
        padding_right: Some(true),
        padding_left: None,
        text_edits: None,
        data: None,
    });
    Ok(Some(hints.collect()))
}

pub fn document_colors(open: &Open, _: DocumentColorParams) -> Answer<Vec<ColorInformation>> {
    let places = Places::new(open);
    let colors = ide::colors(&open.document).into_iter().map(|place| {
        let [red, green, blue] = place.rgb.map(|channel| channel.clamp(0.0, 1.0) as f32);
        ColorInformation { range: places.range(place.span), color: Color { red, green, blue, alpha: 1.0 } }
    });
    Ok(colors.collect())
}

pub fn color_presentations(open: &Open, params: ColorPresentationParams) -> Answer<Vec<ColorPresentation>> {
    let places = Places::new(open);
    let Color { red, green, blue, .. } = params.color;
    let text = ide::color_text([red, green, blue].map(f64::from));
    let text_edit = Some(places.text_edit(places.span(params.range), text.clone()));
    Ok(vec![ColorPresentation { label: text, text_edit, additional_text_edits: None }])
}
