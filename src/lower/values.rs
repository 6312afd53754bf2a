//! The values of arguments against the ranges of the command table.

use crate::diag::words::{named, proposed, quoted, shortened};
use crate::diag::{Code, Diagnostic, Edit, Fix, Safety, codes};
use crate::source::{Source, Span};
use crate::syntax::spec::{CommandKind, CommandSpec, Range};
use crate::syntax::{argument_spans, ast, editions};

/// Checks the numbers of a whole command and appends what is wrong with them. Tells whether the scene may hold them.
pub(super) fn check(source: &Source, kind: CommandKind, command: &ast::Command<'_>, acc: &mut Vec<Diagnostic>) -> bool {
    let spec = kind.spec();
    let as_expected = spec.numbers().iter().zip(command.numbers).all(|(arg, &number)| arg.range.expects(number));
    if as_expected && find_unordered(spec, command.numbers).is_none() {
        return true;
    }
    let slow = Values { source, spec, numbers: command.numbers, spans: argument_spans(source, command.span) };
    let n_before = acc.len();
    slow.check_ranges(acc);
    slow.check_order(acc);
    slow.check_unit_ranges(acc);
    slow.check_radians(acc);
    !acc[n_before..].iter().any(Diagnostic::is_error)
}

/// Returns the indices of two numbers of which the first must be below the second and is not.
fn find_unordered(spec: &CommandSpec, numbers: &[f64]) -> Option<(usize, usize)> {
    spec.rising.filter(|&(low, high)| numbers[low] >= numbers[high])
}

/// The numbers of a command of which some is not as expected.
struct Values<'c> {
    source: &'c Source,
    spec: &'static CommandSpec,
    numbers: &'c [f64],
    spans: Vec<Span>,
}

impl Values<'_> {
    fn text(&self, index: usize) -> &str {
        self.source.slice(self.spans[index])
    }

    /// Returns the text of a number for a message.
    fn shown(&self, index: usize) -> String {
        shortened(self.text(index))
    }

    fn check_ranges(&self, acc: &mut Vec<Diagnostic>) {
        for (index, (arg, &number)) in self.spec.numbers().iter().zip(self.numbers).enumerate() {
            if !arg.range.allows(number) {
                acc.push(match arg.range {
                    Range::PositiveBelow(limit) => self.angle(index, limit),
                    Range::NotNegative => self.exponent(index),
                    Range::Positive | Range::Any | Range::UsuallyUnit => self.radius(index),
                });
            }
        }
    }

    /// Makes a diagnostic at a number.
    fn at(&self, code: &'static Code, index: usize, message: String) -> Diagnostic {
        Diagnostic::new(code, self.spans[index], message)
    }

    fn angle(&self, index: usize, limit: f64) -> Diagnostic {
        let message = format!("a field of view of {} degrees is out of range", self.shown(index));
        let help = if self.numbers[index] > 0.0 {
            "a usual angle is `60`; a wide one is `120`"
        } else {
            "a usual angle is `60`"
        };
        self.at(&codes::FOV_OUT_OF_RANGE, index, message).label(format!("must be above 0 and below {limit}")).help(help)
    }

    fn exponent(&self, index: usize) -> Diagnostic {
        let message = format!("the shininess `{}` is negative: {}", self.spec.numbers()[index].name, self.shown(index));
        self.at(&codes::NEGATIVE_SHININESS, index, message)
            .label("must be 0 or above")
            .help(format!("write {} if the sign is a slip", quoted(self.text(index).trim_start_matches('-'))))
            .fix(self.without_sign(index))
    }

    /// Returns the fix that takes the sign from a number.
    fn without_sign(&self, index: usize) -> Fix {
        Fix::write(Safety::Unsafe, self.spans[index], self.text(index).trim_start_matches('-'))
    }

    fn radius(&self, index: usize) -> Diagnostic {
        let (name, text, shown) = (self.spec.name, self.text(index), self.shown(index));
        let mantissa = text.split(['e', 'E']).next().unwrap_or(text);
        let is_rounded = mantissa.bytes().any(|byte| (b'1'..=b'9').contains(&byte));
        let (message, help) = if self.numbers[index] < 0.0 {
            let repair = quoted(text.trim_start_matches('-'));
            (format!("the radius of a `{name}` is negative: {shown}"), format!("write {repair} if the sign is a slip"))
        } else if is_rounded {
            let help = "the smallest radius is about 5e-324; scale the scene up";
            (format!("the radius {shown} of a `{name}` is so small that it is 0"), help.to_owned())
        } else {
            let help = "write a radius above 0, or remove the object";
            (format!("the radius of a `{name}` is 0"), help.to_owned())
        };
        let unsigned = (self.numbers[index] < 0.0).then(|| self.without_sign(index));
        let diagnostic = self.at(&codes::RADIUS_NOT_POSITIVE, index, message).label("must be above 0");
        // Other programs had the radius first, and the place behind it mostly has the lowest number last.
        let in_order = [1, 2, 3, 0];
        let has_radius_first = match (self.spec.kind, self.numbers) {
            (CommandKind::Sphere, &[x, _, z, radius]) => x > 0.0 && radius < 0.0 && (z >= 0.0 || radius < z),
            _ => false,
        };
        if has_radius_first {
            let help = format!("if the radius came first, {}", proposed(&self.reordered(&in_order)));
            return diagnostic.help(help).fix(self.in_order(&in_order)).fix(unsigned);
        }
        diagnostic.help(help).fix(unsigned)
    }

    fn check_order(&self, acc: &mut Vec<Diagnostic>) {
        let Some((low, high)) = find_unordered(self.spec, self.numbers) else { return };
        let args = self.spec.numbers();
        let (low_name, high_name) = (args[low].name, args[high].name);
        let (low_text, high_text) = (self.shown(low), self.shown(high));
        let span = self.spans[low].to(self.spans[high]);
        let (message, help, fix) = if self.numbers[low] > self.numbers[high] {
            let message = format!("`{low_name}` {low_text} is above `{high_name}` {high_text}");
            let help = format!("swap them: {}", proposed(&self.with_swapped(low, high)));
            (message, help, Some(self.swapped(low, high)))
        } else {
            let message =
                format!("`{low_name}` and `{high_name}` are both {low_text}: the `{}` has no height", self.spec.name);
            (message, format!("write a `{high_name}` above {low_text}"), None)
        };
        let label = format!("`{low_name}` must be below `{high_name}`");
        acc.push(Diagnostic::new(&codes::HEIGHTS_NOT_RISING, span, message).label(label).help(help).fix(fix));
    }

    /// Returns the fix that swaps two arguments.
    fn swapped(&self, a: usize, b: usize) -> Fix {
        let edits = vec![Edit::replace(self.spans[a], self.text(b)), Edit::replace(self.spans[b], self.text(a))];
        let names = self.spec.numbers();
        Fix::guess(format!("swap `{}` and `{}`", names[a].name, names[b].name), edits)
    }

    /// Returns the command with two of its arguments swapped.
    fn with_swapped(&self, a: usize, b: usize) -> String {
        let mut texts: Vec<_> = (0..self.spans.len()).map(|index| self.text(index)).collect();
        texts.swap(a, b);
        format!("{} {}", self.spec.name, texts.join(" "))
    }

    /// Returns the colour and the place of a light.
    fn light(&self) -> Option<[[f64; 3]; 2]> {
        match (self.spec.kind, self.numbers) {
            (CommandKind::Light, &[r, g, b, x, y, z]) => Some([[r, g, b], [x, y, z]]),
            _ => None,
        }
    }

    fn place_before_color(&self) -> Diagnostic {
        Diagnostic::new(
            &codes::ARGUMENT_ORDER,
            self.spans[0].to(self.spans[2]),
            "the colour of this `light` looks like a place, and its place like a colour",
        )
        .label("a colour comes first")
        .help(proposed(&self.reordered(&COLOR_FIRST)))
        .note("other programs had the place first")
        .fix(self.in_order(&COLOR_FIRST))
    }

    /// Returns the command with its arguments in another order.
    fn reordered(&self, order: &[usize]) -> String {
        let texts: Vec<_> = order.iter().map(|&index| self.text(index)).collect();
        format!("{} {}", self.spec.name, texts.join(" "))
    }

    /// Returns the fix that puts the arguments in another order.
    fn in_order(&self, order: &[usize]) -> Fix {
        let edits = order.iter().zip(&self.spans).map(|(&index, span)| Edit::replace(*span, self.text(index)));
        Fix::guess(proposed(&self.reordered(order)), edits.collect())
    }

    /// Tells whether the numbers look like channels from 0 to 255.
    fn is_in_bytes(&self, outside: &[usize]) -> bool {
        // A light of 2 or 10 is meant as one; above this a scale to 255 is likelier.
        const LEAST: f64 = 16.0;
        let numbers = || outside.iter().map(|&index| self.numbers[index]);
        numbers().all(|number| number > 0.0 && number <= 255.0 && number.fract() == 0.0)
            && numbers().any(|n| n >= LEAST)
    }

    /// Returns the fix that brings a colour on a scale to 255 to one on a scale to 1, each channel rounded so that it is
    /// the same step of a pixel. `index` is that of one of its channels.
    fn divided_by_255(&self, index: usize) -> Fix {
        /// Three digits tell 256 steps apart, and read well.
        const N_DIGITS: usize = 3;
        let first = index - index % 3;
        let channels = first..(first + 3).min(self.numbers.len());
        let edits = channels.map(|channel| {
            let text = format!("{:.N_DIGITS$}", self.numbers[channel] / 255.0);
            let short = text.trim_end_matches('0').trim_end_matches('.');
            Edit::replace(self.spans[channel], short)
        });
        Fix::guess("divide the colour by 255", edits.collect())
    }

    /// Reports the colours and coefficients outside 0…1, all of a command at once.
    fn check_unit_ranges(&self, acc: &mut Vec<Diagnostic>) {
        let args = self.spec.numbers();
        let is_outside =
            |&index: &usize| args[index].range == Range::UsuallyUnit && !args[index].range.expects(self.numbers[index]);
        let outside: Vec<_> = (0..args.len()).filter(is_outside).collect();
        let Some((&first, others)) = outside.split_first() else { return };
        if self.light().is_some_and(|[color, place]| editions::is_place_before_color(color, place)) {
            return acc.push(self.place_before_color());
        }
        let names = named(outside.iter().map(|&index| args[index].name));
        let message = match others {
            [] => format!("{names} of `{}` is {}, outside 0 to 1", self.spec.name, self.shown(first)),
            _ => format!("{names} of `{}` are outside 0 to 1", self.spec.name),
        };
        let diagnostic = self
            .at(&codes::OUTSIDE_UNIT_RANGE, first, message)
            .label(format!("`{}`", args[first].name))
            .note("colours and coefficients usually lie between 0 and 1; a pixel is cut off there");
        let label = |diagnostic: Diagnostic, &index: &usize| {
            diagnostic.secondary(self.spans[index], format!("`{}`", args[index].name))
        };
        let diagnostic = others.iter().fold(diagnostic, label);
        if !self.is_in_bytes(&outside) {
            return acc.push(diagnostic);
        }
        // White light at a place of whole numbers reads as a colour on a scale to 255 at the place 1 1 1, and the other way.
        let is_color = |place: [f64; 3]| place.iter().all(|channel| *channel > 0.0 && *channel <= 1.0);
        let by_255 = "if the colour is on a scale to 255, divide it by 255";
        acc.push(match self.light() {
            Some([_, place]) if is_color(place) => {
                let reordered = proposed(&self.reordered(&COLOR_FIRST));
                let diagnostic = diagnostic.help(format!("{by_255}; if the place came first, {reordered}"));
                diagnostic.fix(self.divided_by_255(first)).fix(self.in_order(&COLOR_FIRST))
            }
            _ => diagnostic.help(by_255).fix(self.divided_by_255(first)),
        });
    }

    /// Reports a field of view that is a usual angle in radians.
    fn check_radians(&self, acc: &mut Vec<Diagnostic>) {
        let (CommandKind::Fov, &[angle]) = (self.spec.kind, self.numbers) else { return };
        let Some(degrees) = degrees_of(angle, self.text(0)) else { return };
        let message = format!("a field of view of {} degrees looks like {degrees} degrees in radians", self.shown(0));
        let repair = degrees.to_string();
        acc.push(
            self.at(&codes::FOV_IN_RADIANS, 0, message)
                .label("hardly anything is seen at such an angle")
                .help(format!("`fov` is in degrees: {}", proposed(&format!("{} {repair}", self.spec.name))))
                .fix(Fix::write(Safety::Unsafe, self.spans[0], repair)),
        );
    }
}

/// The arguments of a light in their order, by their places where the place came first.
const COLOR_FIRST: [usize; 6] = [3, 4, 5, 0, 1, 2];

/// Returns the usual angle in degrees that `angle`, written as `text`, is in radians; `None` when it is none. A short
/// number must be one of the commonest angles: by chance it is near some angle.
fn degrees_of(angle: f64, text: &str) -> Option<u32> {
    const COMMONEST: [u32; 6] = [30, 45, 60, 75, 90, 120];
    let decimals = text.split_once('.').map(|(_, decimals)| decimals)?;
    let n_decimals = decimals.bytes().all(|byte| byte.is_ascii_digit()).then_some(decimals.len())?;
    // Rounded or cut off, it is within one step of its last digit.
    let step = (0..n_decimals.min(12)).fold(1.0, |step, _| step / 10.0);
    let is_meant = |degrees: &u32| (f64::from(*degrees).to_radians() - angle).abs() < step;
    match n_decimals {
        0 | 1 => None,
        2 => COMMONEST.into_iter().find(is_meant),
        _ => (10..180).step_by(5).find(is_meant),
    }
}
