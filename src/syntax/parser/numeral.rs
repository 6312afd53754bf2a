//! What is wrong with a text that should be a number.

use crate::diag::words::{counted, proposed, quoted};
use crate::diag::{Code, Diagnostic, Fix, Safety, codes};
use crate::source::{Source, Span};
use crate::syntax::lexer::lex_line;
use crate::syntax::parser::errors::BadCommand;
use crate::syntax::spec::{ArgSpec, Arguments, CommandSpec, Range};
use crate::syntax::token::{Token, TokenKind};

/// Characters that people put between or around numbers.
pub(super) const SEPARATORS: [char; 10] = [',', ';', '(', ')', '[', ']', '{', '}', '<', '>'];
/// Those of them that can mean nothing but that numbers stand apart; the others may belong to another language, which has
/// another order.
const PLAIN_SEPARATORS: [char; 4] = [',', ';', '(', ')'];
/// Characters that look like a minus sign.
const FALSE_MINUSES: [char; 9] =
    ['\u{2010}', '\u{2011}', '\u{2012}', '\u{2013}', '\u{2014}', '\u{2015}', '\u{2212}', '\u{FE63}', '\u{FF0D}'];

/// Why a text is no number, and what to write instead.
#[derive(Debug, PartialEq)]
struct Finding {
    code: &'static Code,
    why: String,
    help: String,
    /// The text to write, if there is one, and how sure it is.
    repair: Option<(Safety, String)>,
}

impl Finding {
    fn malformed(why: impl Into<String>, help: impl Into<String>) -> Self {
        Self { code: &codes::MALFORMED_NUMBER, why: why.into(), help: help.into(), repair: None }
    }

    /// Makes a finding whose help is to write `repair`, which nobody can have meant otherwise; none when that is no
    /// number either.
    fn slip(why: impl Into<String>, repair: &str) -> Option<Self> {
        is_number(repair).then(|| Self::malformed(why, proposed(repair)).with(Safety::Safe, repair))
    }

    /// Makes a finding whose help is to write `repair`, which is a guess; none when that is no number either.
    fn repaired(why: impl Into<String>, repair: &str) -> Option<Self> {
        is_number(repair).then(|| Self::malformed(why, proposed(repair)).with(Safety::Unsafe, repair))
    }

    fn with(self, safety: Safety, repair: impl Into<String>) -> Self {
        Self { repair: Some((safety, repair.into())), ..self }
    }
}

/// Tells whether a line may hold `text` as a number.
pub(super) fn is_number(text: &str) -> bool {
    has_shape_of_number(text) && text.parse().is_ok_and(f64::is_finite)
}

/// Tells whether `text` is one token, a number, if perhaps too large a one.
fn has_shape_of_number(text: &str) -> bool {
    let mut is_one_number = false;
    lex_line(text, 1, |token| is_one_number = token.kind == TokenKind::Number && token.span.len() == text.len());
    is_one_number
}

/// Tells whether `text` is a sign without digits, of whatever script.
pub(super) fn is_sign(text: &str) -> bool {
    let mut characters = text.chars();
    let first = characters.next().is_some_and(|first| matches!(first, '+' | '-') || FALSE_MINUSES.contains(&first));
    first && characters.next().is_none()
}

/// Tells how sure it is to take the separators out of texts.
pub(super) fn safety_without_separators<'t>(mut texts: impl Iterator<Item = &'t str>) -> Safety {
    let is_plain = |text: &str| !text.contains(|c| SEPARATORS.contains(&c) && !PLAIN_SEPARATORS.contains(&c));
    if texts.all(is_plain) { Safety::Safe } else { Safety::Unsafe }
}

/// Returns the diagnostic for the text below `span`, which stands where `arg` of `spec` should. `is_exact` tells whether the
/// command has as many arguments as it takes.
pub(super) fn diagnose(source: &Source, span: Span, spec: &CommandSpec, arg: &ArgSpec, is_exact: bool) -> Diagnostic {
    let text = source.slice(span);
    let label = format!("the `{}` of `{}`", arg.name, spec.name);
    let (code, message, help, repair) = match find(text) {
        Some(Finding { code, why, help, repair }) if code == &codes::MALFORMED_NUMBER => {
            (code, format!("{} is not a number: {why}", quoted(text)), help, repair)
        }
        Some(Finding { code, why, help, repair }) => {
            // What is proposed for any number would be the next mistake where the range is narrow.
            let is_narrow = matches!(arg.range, Range::PositiveBelow(_));
            let help = if is_narrow { format!("write a usual number, as in `{}`", spec.example) } else { help };
            (code, format!("{} {why}", quoted(text)), help, repair)
        }
        None => (
            &codes::MALFORMED_NUMBER,
            format!("{} is not a number", quoted(text)),
            format!("write a number for `{}`, such as `1`, `-0.25` or `1e-3`", arg.name),
            None,
        ),
    };
    let is_sure = is_exact && is_decimal_comma(text);
    let fix = repair.map(|(safety, repair)| Fix::write(if is_sure { Safety::Safe } else { safety }, span, repair));
    Diagnostic::new(code, span, message).label(label).help(help).fix(fix)
}

/// Reports commas and brackets when the line would be right without them: one mistake, however many of them.
pub(super) fn find_commas(command: &BadCommand<'_>) -> Option<Diagnostic> {
    let Arguments::Numbers(args) = command.spec.arguments else { return None };
    let has_separator = |text: &str| text.contains(SEPARATORS);
    let mut with_separator = command.args.iter().filter(|arg| has_separator(command.text(arg)));
    let first = with_separator.next()?;
    let pieces = numbers_between(command.args.iter().map(|arg| command.text(arg)), &SEPARATORS)?;
    if pieces.len() != args.len() {
        return None;
    }
    let safety = safety_without_separators(command.args.iter().map(|arg| command.text(arg)));
    let n_found = command.args.iter().map(|arg| command.text(arg).matches(SEPARATORS).count()).sum::<usize>();
    let n_commas = command.args.iter().map(|arg| command.text(arg).matches(',').count()).sum::<usize>();
    let what = match (n_found, n_commas) {
        (1, 1) => "a comma",
        _ if n_commas == n_found => "commas",
        _ => "punctuation",
    };
    let repair = format!("{} {}", command.spec.name, pieces.join(" "));
    let help = match command.next_name {
        Some(next) => {
            format!("{}, and begin a new line before {}", proposed(&repair), quoted(command.source.slice(next)))
        }
        None => proposed(&repair),
    };
    let message = format!("{what} among the numbers of `{}`", command.spec.name);
    let diagnostic = Diagnostic::new(&codes::MALFORMED_NUMBER, first.span, message)
        .label("blanks alone separate numbers")
        .help(help)
        .fix(command.rewritten(safety, &repair));
    Some(with_separator.fold(diagnostic, |diagnostic, arg| diagnostic.secondary(arg.span, "here too")))
}

/// Reports words among the numbers when the line would be right without them, as in `sphere at 0 0 -4 radius 1`.
pub(super) fn find_stray_words(command: &BadCommand<'_>) -> Option<Diagnostic> {
    let Arguments::Numbers(args) = command.spec.arguments else { return None };
    let (numbers, words): (Vec<&Token>, Vec<&Token>) =
        command.args.iter().partition(|arg| arg.kind == TokenKind::Number);
    let is_inside = |word: &&Token| numbers.last().is_some_and(|last| word.span < last.span);
    let has_digit = |word: &&Token| command.text(word).contains(|c: char| c.is_ascii_digit());
    let first = words.first().filter(|_| numbers.len() == args.len() && words.iter().all(is_inside))?;
    if words.iter().any(has_digit) {
        return None;
    }
    let repair = numbers.iter().fold(command.spec.name.to_owned(), |line, arg| line + " " + command.text(arg));
    let message = format!("{} among the numbers of `{}`", quoted(command.text(first)), command.spec.name);
    let diagnostic =
        Diagnostic::new(&codes::MALFORMED_NUMBER, first.span, message).label("not a number").help(proposed(&repair));
    let diagnostic = diagnostic.fix(command.rewritten(Safety::Unsafe, &repair));
    Some(words[1..].iter().fold(diagnostic, |diagnostic, word| diagnostic.secondary(word.span, "here too")))
}

/// Reports braces that cannot simply be left out, as in `sphere { <0, 0, -4>, 1 pigment { … } }`: the arguments of another
/// language, which are one mistake.
pub(super) fn find_block(command: &BadCommand<'_>) -> Option<Diagnostic> {
    let Arguments::Numbers(args) = command.spec.arguments else { return None };
    let brace = command.args.iter().find(|arg| command.text(arg).contains(['{', '}']))?;
    let message = format!("braces among the numbers of `{}`", command.spec.name);
    let help = format!("write `{}` with {}", command.spec.usage(), counted(args.len(), "number"));
    Some(
        Diagnostic::new(&codes::MALFORMED_NUMBER, brace.span, message)
            .label("there are no blocks in this language")
            .help(help),
    )
}

/// Returns the numbers that `separators` separate in `texts`, if there is nothing else in them.
pub(super) fn numbers_between<'t>(texts: impl Iterator<Item = &'t str>, separators: &[char]) -> Option<Vec<&'t str>> {
    let pieces: Vec<_> = texts.flat_map(|text| text.split(separators)).filter(|piece| !piece.is_empty()).collect();
    pieces.iter().all(|piece| is_number(piece)).then_some(pieces)
}

/// Finds out what is wrong with `text`; none when it resembles no number.
fn find(text: &str) -> Option<Finding> {
    const DETECTORS: [fn(&str) -> Option<Finding>; 17] = [
        overflow,
        not_finite,
        sign_apart,
        false_minus,
        false_digits,
        several_signs,
        comma,
        several_points,
        digit_groups,
        other_base,
        bad_exponent,
        letters_for_digits,
        percentage,
        fraction,
        enclosed,
        named,
        glued,
    ];
    DETECTORS.iter().find_map(|detector| detector(text)).or_else(|| no_digits(text))
}

fn overflow(text: &str) -> Option<Finding> {
    (has_shape_of_number(text) && !is_number(text)).then(|| Finding {
        code: &codes::NUMBER_OVERFLOW,
        why: "is too large a number".to_owned(),
        help: "the largest number is about 1.8e308".to_owned(),
        repair: None,
    })
}

fn not_finite(text: &str) -> Option<Finding> {
    const INFINITIES: [&str; 5] = ["inf", "infinity", "1.#inf", "∞", "infty"];
    let word = text.trim_start_matches(['+', '-']).to_lowercase();
    let found = |why: &str, help: &str| Some(Finding { code: &codes::NOT_FINITE, ..Finding::malformed(why, help) });
    if INFINITIES.contains(&word.as_str()) {
        return found("is not finite, as every number of a scene is", "write a large number, such as `1e9`");
    }
    let is_nan = word == "nan" || word.starts_with("nan(") || matches!(word.as_str(), "1.#ind" | "1.#qnan");
    if is_nan { found("stands for no number at all", "write the number that was meant") } else { None }
}

fn sign_apart(text: &str) -> Option<Finding> {
    let mut parts = text.split([' ', '\t']).filter(|part| !part.is_empty());
    let (sign, digits) = (parts.next()?, parts.next()?);
    let sign = sign.replace(FALSE_MINUSES, "-");
    Finding::slip("a blank follows its sign", &format!("{sign}{digits}"))
}

fn false_minus(text: &str) -> Option<Finding> {
    let found = text.chars().find(|character| FALSE_MINUSES.contains(character))?;
    let why = format!("`{found}` (U+{:04X}) is not the minus sign", u32::from(found));
    Finding::slip(why, &text.replace(FALSE_MINUSES, "-"))
}

fn false_digits(text: &str) -> Option<Finding> {
    let found = text.chars().find(|character| character.is_numeric() && !character.is_ascii())?;
    Some(Finding::malformed(format!("`{found}` is not a digit from 0 to 9"), "write it with the digits 0 to 9"))
}

fn several_signs(text: &str) -> Option<Finding> {
    let digits = text.trim_start_matches(['+', '-']);
    let signs = &text[..text.len() - digits.len()];
    let sign = if signs.contains('-') { "-" } else { "" };
    (signs.len() > 1).then(|| Finding::repaired("it has more than one sign", &format!("{sign}{digits}")))?
}

fn comma(text: &str) -> Option<Finding> {
    let bare = text.trim_matches([',', ';']);
    if bare != text {
        return Finding::slip("blanks alone separate numbers", bare);
    }
    if text.contains('.') {
        return Finding::repaired("digits stand without separators", &text.replace(',', ""));
    }
    match text.matches(',').count() {
        1 => Finding::repaired("the decimal sign is a point", &text.replace(',', ".")),
        0 => None,
        _ => {
            let all_numbers = text.split(',').all(is_number);
            all_numbers.then(|| {
                Finding::malformed("commas do not separate numbers", "put blanks between the numbers")
                    .with(Safety::Unsafe, text.replace(',', " "))
            })
        }
    }
}

/// Tells whether a number has a comma that can be nothing but the decimal sign: `1,000` may be a thousand.
fn is_decimal_comma(text: &str) -> bool {
    let Some((whole, decimals)) = text.split_once(',') else { return false };
    let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let whole = whole.trim_start_matches(['+', '-']);
    is_digits(whole) && is_digits(decimals) && (decimals.len() != 3 || whole == "0")
}

fn several_points(text: &str) -> Option<Finding> {
    let is_dotted = text.trim_start_matches(['+', '-']).bytes().all(|byte| byte == b'.' || byte.is_ascii_digit());
    (is_dotted && text.matches('.').count() > 1 && text.contains(|c: char| c.is_ascii_digit()))
        .then(|| Finding::malformed("it has more than one point", "keep one point, or put a blank between two numbers"))
}

fn digit_groups(text: &str) -> Option<Finding> {
    const GROUPERS: [char; 2] = ['_', '\''];
    let is_grouped = text.contains(GROUPERS) && !text.starts_with(GROUPERS) && !text.ends_with(GROUPERS);
    is_grouped.then(|| Finding::slip("digits stand without separators", &text.replace(GROUPERS, "")))?
}

fn other_base(text: &str) -> Option<Finding> {
    let (sign, digits) = match text.strip_prefix('-') {
        Some(digits) => ("-", digits),
        None => ("", text.trim_start_matches('+')),
    };
    let (base, name) = match digits.as_bytes() {
        [b'0', b'x' | b'X', ..] => (16, "hexadecimal"),
        [b'0', b'b' | b'B', ..] => (2, "binary"),
        [b'0', b'o' | b'O', ..] => (8, "octal"),
        _ => return None,
    };
    let value = u64::from_str_radix(&digits[2..], base).ok()?;
    Finding::slip(format!("{name} numbers are not part of the language"), &format!("{sign}{value}"))
}

fn bad_exponent(text: &str) -> Option<Finding> {
    if text.contains(['d', 'D']) {
        return Finding::slip("an exponent begins with `e`", &text.replace(['d', 'D'], "e"));
    }
    let (mantissa, exponent) = text.split_once(['e', 'E'])?;
    if !is_number(mantissa) {
        return None;
    }
    match exponent {
        "" | "+" | "-" => Finding::repaired("its exponent has no digits", mantissa),
        _ => is_number(exponent).then(|| {
            Finding::malformed("its exponent is not a whole number", "write a whole exponent, such as `1e-3`")
        }),
    }
}

fn letters_for_digits(text: &str) -> Option<Finding> {
    let found = text.chars().find(|character| "OoIl".contains(*character))?;
    let digit = if "Oo".contains(found) { '0' } else { '1' };
    let repair = text.replace(['O', 'o'], "0").replace(['I', 'l'], "1");
    Finding::repaired(format!("`{found}` is a letter, not the digit {digit}"), &repair)
}

fn percentage(text: &str) -> Option<Finding> {
    let percent: f64 = text.strip_suffix('%').filter(|digits| is_number(digits))?.parse().ok()?;
    Finding::repaired("percentages are not part of the language", &(percent / 100.0).to_string())
}

fn fraction(text: &str) -> Option<Finding> {
    let (above, below) = text.split_once('/').filter(|(above, below)| is_number(above) && is_number(below))?;
    let value = above.parse::<f64>().ok()? / below.parse::<f64>().ok()?;
    Finding::repaired("fractions are not part of the language", &value.to_string())
}

fn enclosed(text: &str) -> Option<Finding> {
    let bare = text.trim_matches(|c: char| SEPARATORS.contains(&c) || matches!(c, '"' | '\'' | '`'));
    (bare != text).then(|| Finding::slip("a number stands without brackets and quotes", bare))?
}

fn named(text: &str) -> Option<Finding> {
    let (_, value) = text.split_once(['=', ':'])?;
    Finding::repaired("arguments have no names", value)
}

/// Finds a number with something behind it: a unit, a suffix, the next number.
fn glued(text: &str) -> Option<Finding> {
    let mut ends = text.char_indices().map(|(end, _)| end).skip(1).take(40).collect::<Vec<_>>().into_iter().rev();
    let (number, rest) = ends.find_map(|end| is_number(&text[..end]).then(|| text.split_at(end)))?;
    if is_number(rest) {
        let help = format!("put a blank between {} and {}", quoted(number), quoted(rest));
        let apart = format!("{number} {rest}");
        return Some(Finding::malformed("it is two numbers in one", help).with(Safety::Unsafe, apart));
    }
    if rest.starts_with(['*', '/', '^', '+', '-']) {
        return Some(Finding::malformed("a scene does not calculate", "write the result as one number"));
    }
    let why = format!("{} follows the number", quoted(rest));
    // The suffix of C can mean nothing else behind a point.
    let is_suffix = matches!(rest, "f" | "F") && number.contains('.');
    if is_suffix { Finding::slip(why, number) } else { Finding::repaired(why, number) }
}

fn no_digits(text: &str) -> Option<Finding> {
    if text == "\\" {
        return Some(Finding::malformed("a command does not go on in the next line", "join the next line to this one"));
    }
    let is_mark =
        text.chars().all(|character| matches!(character, '+' | '-' | '.') || FALSE_MINUSES.contains(&character));
    is_mark.then(|| Finding::malformed("it has no digits", "write a number, such as `1`, `-0.25` or `1e-3`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_slip_is_named() {
        for (text, why, help) in [
            ("1e999", "too large a number", "1.8e308"),
            ("-inf", "not finite", "1e9"),
            ("NaN", "no number", "meant"),
            ("- 4", "blank follows its sign", "write `-4`"),
            ("−4", "`−` (U+2212) is not the minus sign", "write `-4`"),
            ("٣", "`٣` is not a digit", "0 to 9"),
            ("--4", "more than one sign", "write `-4`"),
            ("+-4", "more than one sign", "write `-4`"),
            ("0,5", "decimal sign is a point", "write `0.5`"),
            ("5,", "blanks alone", "write `5`"),
            ("1,2,3", "commas do not separate", "blanks"),
            ("1.2.3", "more than one point", "one point"),
            ("1_000", "without separators", "write `1000`"),
            ("0x10", "hexadecimal", "write `16`"),
            ("-0b11", "binary", "write `-3`"),
            ("1e", "no digits", "write `1`"),
            ("1e0.5", "not a whole number", "whole exponent"),
            ("1O", "`O` is a letter, not the digit 0", "write `10`"),
            ("50%", "percentages", "write `0.5`"),
            ("1/4", "fractions", "write `0.25`"),
            ("(1", "brackets", "write `1`"),
            ("\"1\"", "quotes", "write `1`"),
            ("r=0.5", "no names", "write `0.5`"),
            ("1f", "`f` follows the number", "write `1`"),
            ("60°", "`°` follows the number", "write `60`"),
            ("0-4", "two numbers in one", "between `0` and `-4`"),
            ("-", "no digits", "such as"),
            ("1,000.5", "without separators", "write `1000.5`"),
            ("1d3", "begins with `e`", "write `1e3`"),
            ("2*3", "does not calculate", "the result"),
            ("\\", "does not go on", "join the next line"),
        ] {
            let finding = find(text).unwrap_or_else(|| panic!("{text}"));
            assert!(finding.why.contains(why), "{text}: {}", finding.why);
            assert!(finding.help.contains(help), "{text}: {}", finding.help);
        }
        assert_eq!(find("red"), None);
        assert_eq!(find(&"x".repeat(1_000_000)), None);
    }
}
