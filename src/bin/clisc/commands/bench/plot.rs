//! Plots of time and error.

use anyhow::anyhow;
use plotters::prelude::*;

use super::report::Measured;

/// Width and height in pixels.
const SIZE: (u32, u32) = (640, 420);

/// What no error at all is drawn as, below the least that there is: a logarithm has no zero.
const BELOW_LEAST: f64 = 0.1;

/// Draws run time against error, both by their logarithms, and the Pareto front.
pub fn svg(title: &str, error_name: &str, all: &[Measured]) -> anyhow::Result<String> {
    let mut svg = String::new();
    draw(&mut svg, title, error_name, all).map_err(|error| anyhow!("cannot draw the plot: {error}"))?;
    Ok(svg)
}

/// A point of the plot: milliseconds, error, its label, whether it is on the front.
type Point<'a> = (f64, f64, String, bool);

/// Returns the points, those without an error a little below the others.
fn points(all: &[Measured]) -> Vec<Point<'_>> {
    let errors = || all.iter().map(|one| one.errors.shown()).filter(|error| *error > 0.0);
    let floor = errors().fold(f64::INFINITY, f64::min).min(1.0) * BELOW_LEAST;
    let point = |one: &Measured| {
        let error = one.errors.shown();
        let label = if error > 0.0 { one.name.clone() } else { format!("{} (no error)", one.name) };
        (1e3 * one.times.median_seconds, error.max(floor), label, one.is_on_front)
    };
    let mut points: Vec<_> = all.iter().map(point).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// Returns a range around numbers above 0, with room at both ends.
fn range(numbers: impl Iterator<Item = f64> + Clone) -> std::ops::Range<f64> {
    let (least, most) = (numbers.clone().fold(f64::INFINITY, f64::min), numbers.fold(0.0, f64::max));
    0.5 * least..3.0 * most
}

fn draw(
    svg: &mut String,
    title: &str,
    error_name: &str,
    all: &[Measured],
) -> Result<(), DrawingAreaErrorKind<std::io::Error>> {
    let points = points(all);
    let (times, errors) = (points.iter().map(|point| point.0), points.iter().map(|point| point.1));
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 15))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(70)
        .build_cartesian_2d(range(times).log_scale(), range(errors).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("time, ms")
        .y_desc(format!("{error_name}, levels"))
        .x_label_formatter(&|ms| format!("{ms:.3}").trim_end_matches('0').trim_end_matches('.').to_owned())
        .y_label_formatter(&|error| format!("{error:.0e}"))
        .light_line_style(WHITE)
        .draw()?;
    let front = points.iter().filter(|point| point.3).map(|point| (point.0, point.1));
    chart.draw_series(LineSeries::new(front, BLUE.mix(0.4).stroke_width(2)))?;
    chart.draw_series(points.iter().map(|(ms, error, label, is_on_front)| {
        let style = if *is_on_front { BLUE.filled() } else { BLACK.mix(0.5).filled() };
        let label = Text::new(label.clone(), (8, -6), ("sans-serif", 13));
        EmptyElement::at((*ms, *error)) + Circle::new((0, 0), 4, style) + label
    }))?;
    root.present()
}
