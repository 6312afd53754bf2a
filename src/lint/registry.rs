//! The rules, once each, and how one is found by its name.

use crate::diag::{Code, Diagnostic, Safety, codes};
use crate::lint::context::RuleContext;
use crate::lint::rules;

/// A rule: what it is called and how it is checked.
#[derive(Debug)]
pub struct Rule {
    /// Id, name, title and page.
    pub code: Code,
    /// How sure its fixes are; `None` when it offers none.
    pub fix: Option<Safety>,
    /// Appends what it finds.
    pub(super) check: fn(&RuleContext<'_>, &mut Vec<Diagnostic>),
}

/// Declares the rule of a file. Its documentation is its page, with the sections Why, Example, Instead, Fix safety and Limits.
macro_rules! declare_rule {
    ($(#[doc = $doc:literal])* pub static $rule:ident = {
        id: $id:literal, name: $name:literal, title: $title:literal, fix: $fix:expr $(,)?
    }) => {
        $(#[doc = $doc])*
        pub static $rule: $crate::lint::Rule = $crate::lint::Rule {
            code: $crate::diag::Code {
                id: $id,
                name: Some($name),
                severity: $crate::diag::Severity::Warning,
                title: $title,
                explanation: concat!($($doc, "\n"),*),
            },
            fix: $fix,
            check,
        };
    };
}
pub(super) use declare_rule;

/// Every rule that only `lint` checks, in the order of their ids. The warnings of the compiler are rules too: see [`find`].
pub static RULES: &[&Rule] = &[
    &rules::unused_surface::UNUSED_SURFACE,
    &rules::repeated_setting::REPEATED_SETTING,
    &rules::overridden_setting::OVERRIDDEN_SETTING,
    &rules::dark_light::DARK_LIGHT,
    &rules::no_light::NO_LIGHT,
    &rules::light_inside::LIGHT_INSIDE,
    &rules::outside_view::OUTSIDE_VIEW,
    &rules::behind_eye::BEHIND_EYE,
    &rules::hidden_inside::HIDDEN_INSIDE,
    &rules::hidden_copy::HIDDEN_COPY,
    &rules::below_pixel::BELOW_PIXEL,
    &rules::fills_view::FILLS_VIEW,
    &rules::eye_inside::EYE_INSIDE,
    &rules::coincident_caps::COINCIDENT_CAPS,
    &rules::overlapping_walls::OVERLAPPING_WALLS,
    &rules::too_bright::TOO_BRIGHT,
    &rules::name_unlike_file::NAME_UNLIKE_FILE,
    &rules::unused_allow::UNUSED_ALLOW,
];

/// Returns every code there is: those of the compiler, then those of the rules.
pub fn all_codes() -> impl Iterator<Item = &'static Code> {
    codes::ALL.iter().copied().chain(RULES.iter().map(|rule| &rule.code))
}

/// Returns the code with this id or name, upper or lower case.
#[must_use]
pub fn find(text: &str) -> Option<&'static Code> {
    let is_name = |name: &str| name.eq_ignore_ascii_case(text);
    all_codes().find(|code| is_name(code.id) || code.name.is_some_and(is_name))
}

/// Returns the code whose id or name is nearest to `text` in spelling, if one is near.
#[must_use]
pub fn nearest(text: &str) -> Option<&'static Code> {
    const MAX_LEN: usize = 30;
    if text.len() > MAX_LEN {
        return None;
    }
    let lower = text.to_ascii_lowercase().replace('_', "-");
    let near = all_codes().filter_map(|code| {
        let name = code.name.filter(|_| lower.contains('-')).unwrap_or(code.id);
        let distance = strsim::osa_distance(&lower, &name.to_ascii_lowercase());
        (distance <= name.len() / 3).then_some((distance, code))
    });
    near.min_by_key(|(distance, _)| *distance).map(|(_, code)| code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_found_by_id_and_by_name() {
        assert_eq!(find("l0101").map(|code| code.name), Some(Some("unused-surface")));
        assert_eq!(find("no-fov").map(|code| code.id), Some("W0302"));
        assert_eq!(find("E0203").map(|code| code.id), Some("E0203"));
        assert_eq!(find("no-such-rule"), None);
        assert_eq!(nearest("unused-surfaces").map(|code| code.id), Some("L0101"));
        assert_eq!(nearest("E0103").map(|code| code.id), Some("E0101"));
        assert_eq!(nearest("banana"), None);
    }
}
