//! Comments that speak to clisc.

/// Returns what a comment tells clisc: what follows `clisc:` if it begins with that. `comment` begins with its `#`.
///
/// ```
/// # use clisc::syntax::directive;
/// assert_eq!(directive("# clisc: off"), Some("off"));
/// assert_eq!(directive("#clisc:on "), Some("on"));
/// assert_eq!(directive("# see clisc: off"), None);
/// ```
#[must_use]
pub fn directive(comment: &str) -> Option<&str> {
    comment.strip_prefix('#')?.trim_ascii_start().strip_prefix("clisc:").map(str::trim_ascii)
}
