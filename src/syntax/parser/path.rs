//! What is wrong with the file name of a `write`.

use crate::diag::words::{proposed, quoted};
use crate::diag::{Diagnostic, Edit, Fix, Safety, codes};
use crate::source::{Source, Span};
use crate::syntax::parser::errors::BadCommand;
use crate::syntax::token::{Token, TokenKind};

/// How the name of an image ends.
const ENDING: &str = ".png";
/// What people put around a name, `"` included where it is not a pair.
const FALSE_QUOTES: [char; 9] = ['\'', '"', '`', '“', '”', '„', '‘', '’', '«'];

/// Returns the name that the token below `span` stands for: without its quotes, if it has them.
pub(super) fn unquoted(source: &Source, span: Span) -> &str {
    let text = source.slice(span);
    text.strip_prefix('"').map_or(text, |rest| rest.strip_suffix('"').unwrap_or(rest))
}

/// Tells whether `name` is one that a `write` takes.
pub(super) fn is_png(name: &str) -> bool {
    name.ends_with(ENDING)
}

/// Returns the diagnostic of a name that is empty or does not end in `.png`.
pub(super) fn not_a_png(source: &Source, name: &Token) -> Diagnostic {
    let text = unquoted(source, name.span);
    if text.trim().is_empty() {
        return Diagnostic::new(&codes::MISSING_FILE_NAME, name.span, "`write` takes a file name, found an empty one")
            .label("no name between the quotes")
            .help("write `\"picture.png\"`");
    }
    let repair = repair_ending(text, name.kind);
    Diagnostic::new(&codes::NOT_A_PNG, name.span, format!("the file name {} does not end in `{ENDING}`", quoted(text)))
        .label("not the name of a PNG image")
        .help(repair.as_ref().map_or("add the name of a file, such as `picture.png`".to_owned(), Repair::help))
        .fix(repair.map(|repair| Fix::write(repair.safety(), name.span, repair.text())))
        .note("images are saved as PNG, whatever their name")
}

/// What to write in place of a name.
enum Repair {
    /// This name, of which the ending shows that it was meant.
    Name(String),
    /// This name; what stands there may end in anything.
    Guess(String),
    /// This name and, behind it, this comment.
    Commented(String, String),
}

impl Repair {
    fn text(&self) -> String {
        match self {
            Self::Name(name) | Self::Guess(name) => in_quotes_if_needed(name),
            Self::Commented(name, comment) => format!("{name} #{comment}"),
        }
    }

    fn help(&self) -> String {
        match self {
            Self::Name(_) | Self::Guess(_) => proposed(&self.text()),
            Self::Commented(..) => format!("put a blank before the comment: `{}`", self.text()),
        }
    }

    fn safety(&self) -> Safety {
        match self {
            Self::Name(_) | Self::Commented(..) => Safety::Safe,
            Self::Guess(_) => Safety::Unsafe,
        }
    }
}

/// Finds the name that was meant, if any of it is there.
fn repair_ending(name: &str, kind: TokenKind) -> Option<Repair> {
    const OTHER_ENDINGS: [&str; 8] = ["jpg", "jpeg", "bmp", "gif", "ppm", "tga", "tiff", "tif"];
    let bare = name.trim_matches(|c| FALSE_QUOTES.contains(&c)).trim_end_matches([';', ',', '.', ' ', '\t']);
    if is_png(bare) {
        return Some(Repair::Name(bare.to_owned()));
    }
    if bare.is_empty() || bare.ends_with('/') {
        return None;
    }
    if let (TokenKind::Path, Some((before, comment))) = (kind, name.split_once('#'))
        && is_png(before)
    {
        return Some(Repair::Commented(before.to_owned(), comment.to_owned()));
    }
    let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
    let lower = ending.to_ascii_lowercase();
    if lower == "png" || OTHER_ENDINGS.contains(&lower.as_str()) {
        return Some(Repair::Name(format!("{stem}{ENDING}")));
    }
    let named = format!("{bare}{ENDING}");
    Some(if bare == name && !name.contains('.') { Repair::Name(named) } else { Repair::Guess(named) })
}

/// Returns the name as a scene has to write it.
fn in_quotes_if_needed(name: &str) -> String {
    let needs_quotes = name.contains([' ', '\t']) || name.starts_with('#');
    if needs_quotes { format!("\"{name}\"") } else { name.to_owned() }
}

/// Returns the diagnostic of a `write` with nothing behind it. `name` is the place of the word `write`.
pub(super) fn missing(source: &Source, name: Span) -> Diagnostic {
    let lines = source.lines();
    let line_end = lines.line_span(source.text(), lines.line_of(name.start)).end;
    let rest = source.slice(Span::new(name.end, line_end.max(name.end)));
    let (help, fix) = match rest.split_once('#') {
        Some((_, comment)) if is_png(comment.trim()) && !comment.contains('"') => {
            let repair = format!("\"#{}\"", comment.trim());
            let help = format!("`#` begins a comment: put the name in quotes, {}", quoted(&repair));
            let place = Span::new(name.end, name.end + rest.trim_end().len() as u32);
            (help, Some(Fix::guess(proposed(&repair), vec![Edit::replace(place, format!(" {repair}"))])))
        }
        _ => ("add the name of the image, such as `write picture.png`".to_owned(), None),
    };
    Diagnostic::new(&codes::MISSING_FILE_NAME, name, "`write` takes 1 file name, found none")
        .label("needs name.png")
        .help(help)
        .fix(fix)
}

/// Returns the diagnostic of a quote that the line does not close.
pub(super) fn unterminated_quote(source: &Source, span: Span) -> Diagnostic {
    let name = unquoted(source, span).trim_end();
    let (repair, safety) = match is_png(name) {
        true => (format!("\"{name}\""), Safety::Safe),
        false => (format!("\"{name}{ENDING}\""), Safety::Unsafe),
    };
    Diagnostic::new(&codes::UNTERMINATED_QUOTE, span, "the quote is not closed on its line")
        .label("begins here")
        .help(format!("close it: {}", quoted(&repair)))
        .fix(Fix::write(safety, span, repair))
}

/// Says what to do about words behind a file name. `surplus` is their place.
pub(super) fn help_for_surplus(command: &BadCommand<'_>, surplus: Span) -> (String, Fix) {
    let whole = command.source.slice(command.args[0].span.to(surplus)).trim_matches(FALSE_QUOTES);
    let first = unquoted(command.source, command.args[0].span);
    if !is_png(first) && is_png(whole) && !whole.contains('"') {
        let repair = format!("\"{whole}\"");
        let help = format!("put a name with blanks in double quotes: {}", quoted(&repair));
        return (help, Fix::write(Safety::Unsafe, command.args[0].span.to(surplus), repair));
    }
    let help = format!("remove {}; the size of an image is not part of a scene", quoted(command.source.slice(surplus)));
    (help, command.without_surplus(surplus))
}
