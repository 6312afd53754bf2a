; By names that tree-sitter's own highlighter, Neovim, Helix and Emacs have in common.

(comment) @comment

[
  "fov"
  "background"
  "light"
  "surface"
  "sphere"
  "cylinder"
  "write"
] @keyword

(number) @number

[
  (bare_name)
  (quoted_name)
] @string.special.path

; What makes a line malformed, unless something is missing or one too many.
[
  (word)
  (foreign)
] @error
