//! One report in any format.

use std::io::{self, Write};

use crate::diag::render::{
    Explained, GitlabReport, JsonReport, Notification, SarifReport, Screen, github, render_github, render_human,
    render_short,
};
use crate::diag::{Diagnostic, Severity};
use crate::source::Source;

/// How diagnostics are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The lines of the scene with the places marked.
    Human(Screen),
    /// One line each.
    Short,
    /// One JSON document of our own.
    Json,
    /// One SARIF document.
    Sarif,
    /// Annotations of GitHub Actions.
    Github,
    /// A code quality report of GitLab.
    Gitlab,
}

/// A report that grows a source at a time, so that no run has to keep all its diagnostics.
#[derive(Debug)]
pub struct Report<W: Write>(Form<W>);

#[derive(Debug)]
enum Form<W: Write> {
    Human(W, Screen, Explained),
    Short(W),
    Json(JsonReport<W>),
    Sarif(SarifReport<W>),
    Github(W),
    Gitlab(GitlabReport<W>),
}

impl<W: Write> Report<W> {
    /// Writes the head of the report, if the format has one.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn begin(format: Format, out: W) -> io::Result<Self> {
        Ok(Self(match format {
            Format::Human(screen) => Form::Human(out, screen, Explained::new()),
            Format::Short => Form::Short(out),
            Format::Json => Form::Json(JsonReport::begin(out)?),
            Format::Sarif => Form::Sarif(SarifReport::begin(out)?),
            Format::Github => Form::Github(out),
            Format::Gitlab => Form::Gitlab(GitlabReport::begin(out)?),
        }))
    }

    /// Writes the diagnostics of one source. `n_unlisted` counts the errors and the warnings that were found besides them.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn add(&mut self, source: &Source, diagnostics: &[Diagnostic], n_unlisted: [usize; 2]) -> io::Result<()> {
        match &mut self.0 {
            Form::Human(out, screen, explained) => {
                explained.add(diagnostics);
                render_human(source, diagnostics, *screen, out)?;
            }
            Form::Short(out) => render_short(source, diagnostics, out)?,
            Form::Json(report) => {
                report.count(Severity::Error, n_unlisted[0]);
                report.count(Severity::Warning, n_unlisted[1]);
                report.add(source, diagnostics)?;
            }
            Form::Sarif(report) => {
                report.count_unlisted(n_unlisted.iter().sum());
                report.add(source, diagnostics)?;
            }
            Form::Github(out) => render_github(source, diagnostics, out)?,
            Form::Gitlab(report) => report.add(source, diagnostics)?,
        }
        Ok(())
    }

    /// Writes a notification, or keeps it for the end. The forms for people have no room for it: it is printed elsewhere.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn notify(&mut self, notification: &Notification) -> io::Result<()> {
        match &mut self.0 {
            Form::Human(..) | Form::Short(_) => {}
            Form::Json(report) => report.notify(notification.clone()),
            Form::Sarif(report) => report.notify(notification.clone()),
            Form::Github(out) => github::write_notification(notification, out)?,
            Form::Gitlab(report) => report.notify(notification)?,
        }
        Ok(())
    }

    /// Writes the end of the report, if the format has one, and gives the writer back.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(self) -> io::Result<W> {
        match self.0 {
            Form::Human(mut out, _, explained) => write!(out, "{explained}").map(|()| out),
            Form::Short(out) | Form::Github(out) => Ok(out),
            Form::Json(report) => report.finish(),
            Form::Sarif(report) => report.finish(),
            Form::Gitlab(report) => report.finish(),
        }
    }
}
