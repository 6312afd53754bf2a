//! The drawing for people: the lines that a diagnostic speaks of, with its places marked.
//!
//! The drawing is ariadne's; this file is the only one that knows it. Three things are ours: the header, because the code
//! belongs to the diagnostic; lines too long for a screen, of which the pieces around the places are shown; and the text
//! itself, in which nothing that a terminal would obey is left.

use std::borrow::Cow;
use std::collections::HashMap;
use std::io::{self, Write};
use std::ops::Range;

use ariadne::{Config, IndexType, Label, Report, ReportKind};

use crate::diag::render::canvas::{Canvas, Marks, is_long};
use crate::diag::render::{self, short};
use crate::diag::{Diagnostic, Severity};
use crate::source::Source;

/// How wide a screen is taken to be of which nothing is known, in columns; rustc takes the same.
const DEFAULT_WIDTH: usize = 140;
/// The least columns that a line of the source gets.
const MIN_WIDTH: usize = 40;
/// The most diagnostics of one source that are drawn; the others get a line each.
const MAX_DRAWN: usize = 500;

/// A place as ariadne takes it: the name of the source and a range of bytes.
type Place<'a> = (&'a str, Range<usize>);

/// Whether the drawing may hold colours (ANSI escapes).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Color {
    /// For a terminal.
    Always,
    /// For a file or a pipe.
    Never,
}

/// What a drawing is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Screen {
    /// Whether it shows colours.
    pub color: Color,
    /// How many columns it has; `None` when that is not known.
    pub width: Option<usize>,
}

impl From<Color> for Screen {
    fn from(color: Color) -> Self {
        Self { color, width: None }
    }
}

/// Draws each diagnostic with the lines it speaks of; lines that are too long for the screen are cut around its places.
///
/// # Errors
/// Those of `out`.
pub fn render_human(
    source: &Source,
    diagnostics: &[Diagnostic],
    screen: impl Into<Screen>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let screen = screen.into();
    let (drawn, others) = diagnostics.split_at(diagnostics.len().min(MAX_DRAWN));
    let n_digits = source.lines().n_lines().to_string().len();
    let width = screen.width.unwrap_or(DEFAULT_WIDTH).saturating_sub(n_digits + 4).max(MIN_WIDTH);
    let Layers { of_diagnostics, marks } = Layers::new(source, drawn, width);
    let easels: Vec<_> = marks.iter().map(|marks| Easel::new(source, marks, width, screen.color)).collect();
    for (diagnostic, layer) in drawn.iter().zip(of_diagnostics) {
        easels[layer].write_header(diagnostic, out)?;
        easels[layer].draw(diagnostic, out)?;
        writeln!(out)?;
    }
    others.iter().try_for_each(|diagnostic| short::write_line(source, diagnostic, out))
}

/// The canvases of a source. Diagnostics of one long line cut it in different ways, so that each has a canvas of its own,
/// which those of other lines share; there are few mistakes on one line.
#[derive(Default)]
struct Layers {
    /// For each diagnostic, its canvas.
    of_diagnostics: Vec<usize>,
    /// For each canvas, what is marked in its long lines.
    marks: Vec<Marks>,
}

impl Layers {
    fn new(source: &Source, diagnostics: &[Diagnostic], width: usize) -> Self {
        let mut layers = Self::default();
        let mut known_lengths = HashMap::new();
        let mut n_layers_of: HashMap<usize, usize> = HashMap::new();
        for diagnostic in diagnostics {
            let mut marks = Marks::new();
            for label in std::iter::once(&diagnostic.primary).chain(&diagnostic.secondary) {
                let line = source.lines().line_of(label.span.start);
                if *known_lengths.entry(line).or_insert_with(|| is_long(source, line, width)) {
                    marks.entry(line).or_default().push(label.span);
                }
            }
            let layer = marks.keys().filter_map(|line| n_layers_of.get(line)).copied().max().unwrap_or(0);
            if layers.marks.len() <= layer {
                layers.marks.push(Marks::new());
            }
            n_layers_of.extend(marks.keys().map(|line| (*line, layer + 1)));
            layers.marks[layer].extend(marks);
            layers.of_diagnostics.push(layer);
        }
        layers
    }
}

/// A canvas and what it takes to draw on it.
struct Easel<'s> {
    source: &'s Source,
    /// The name of the source.
    name: Cow<'s, str>,
    color: Color,
    canvas: Canvas<'s>,
    drawn: ariadne::Source<String>,
}

impl<'s> Easel<'s> {
    fn new(source: &'s Source, marks: &Marks, width: usize, color: Color) -> Self {
        let mut canvas = Canvas::new(source, marks, width);
        let drawn = ariadne::Source::from(canvas.take_text());
        Self { source, name: render::harmless(source.name()), color, canvas, drawn }
    }

    fn write_header(&self, diagnostic: &Diagnostic, out: &mut dyn Write) -> io::Result<()> {
        let (word, id) = (diagnostic.severity().word(), diagnostic.code.id);
        let (on, off) = match (self.color, diagnostic.severity()) {
            (Color::Never, _) => ("", ""),
            (Color::Always, Severity::Error) => ("\u{1B}[31m", "\u{1B}[0m"),
            (Color::Always, Severity::Warning) => ("\u{1B}[33m", "\u{1B}[0m"),
        };
        writeln!(out, "{on}{word}[{id}]{off}: {}", diagnostic.message)
    }

    /// Draws with ariadne, whose own header and trailing blanks are left out.
    fn draw(&self, diagnostic: &Diagnostic, out: &mut dyn Write) -> io::Result<()> {
        let mut drawing = Vec::new();
        self.report(diagnostic).write((&*self.name, &self.drawn), &mut drawing)?;
        let drawing = String::from_utf8_lossy(&drawing);
        let mut rows = drawing.lines().skip(1).map(str::trim_end);
        let first = rows.next().unwrap_or_default();
        writeln!(out, "{}", self.with_place(first, diagnostic))?;
        rows.try_for_each(|row| writeln!(out, "{row}"))
    }

    fn report<'a>(&'a self, diagnostic: &'a Diagnostic) -> Report<'a, Place<'a>> {
        let has_color = self.color == Color::Always;
        let (kind, primary_color) = match diagnostic.severity() {
            Severity::Error => (ReportKind::Error, ariadne::Color::Red),
            Severity::Warning => (ReportKind::Warning, ariadne::Color::Yellow),
        };
        let mut labels: Vec<_> = diagnostic.secondary.iter().map(|label| (label, ariadne::Color::Blue)).collect();
        labels.push((&diagnostic.primary, primary_color));
        labels.sort_by_key(|(label, _)| label.span);
        let labels = labels.into_iter().map(|(label, color)| {
            Label::new((&*self.name, self.canvas.place(label.span))).with_message(&label.message).with_color(color)
        });
        let config = Config::new().with_color(has_color).with_index_type(IndexType::Byte);
        let place = (&*self.name, self.canvas.place(diagnostic.primary.span));
        let mut report = Report::build(kind, place).with_config(config).with_labels(labels);
        if let Some(help) = &diagnostic.help {
            report.set_help(help);
        }
        if let Some(note) = &diagnostic.note {
            report.set_note(note);
        }
        report.finish()
    }

    /// Writes the place of a diagnostic in the source over that in the canvas.
    fn with_place(&self, row: &str, diagnostic: &Diagnostic) -> String {
        let place = self.source.lines().position(self.source.text(), diagnostic.primary.span.start);
        let before = format!("{}:{}:", self.name, place.line);
        let Some((head, rest)) = row.split_once(&before) else { return row.to_owned() };
        format!("{head}{before}{}{}", place.column, rest.trim_start_matches(|c: char| c.is_ascii_digit()))
    }
}
