/**
 * The tree of a `.cli` scene, for editors.
 *
 * `../scene.ebnf` is normative; the tokens here are those of `src/syntax/lexer.rs`, and so is the rule that a word is as
 * long as it can be: `1.2.3` is one word gone wrong, not three numbers.
 *
 * A scene is edited while it is wrong, so every text has a tree, and a mistake never reaches beyond its line. That is more
 * than tree-sitter's way of recovering promises: it takes what is cheapest, be it to join two lines. So a wrong line has a
 * rule of its own, `malformed`, and no text makes an ERROR or a MISSING node.
 *
 * The fields have the names of the arguments, `x`, `radius`, `P`; the nine colour numbers of `surface` stand in three
 * groups, so that its `Cdr` is the `r` of its `diffuse`.
 */

/// <reference types="tree-sitter-cli/dsl" />

/** Control characters, the line ends among them. */
const CONTROL = '\\x00-\\x08\\x0A-\\x1F\\x7F-\\u{9F}';
/** Blanks of other scripts and systems. */
const FOREIGN_BLANK =
  '\\u{A0}\\u{1680}\\u{180E}\\u{2000}-\\u{200B}\\u{2028}\\u{2029}\\u{202F}\\u{205F}\\u{2060}\\u{3000}\\u{FEFF}';
/** What no word begins with. */
const SEPARATOR = `#\\t\\x20${CONTROL}${FOREIGN_BLANK}`;

/** The commands that take numbers, each with its fields: a number, or a group of three. */
const COMMANDS = {
  fov: { angle: 'number' },
  background: { color: 'color' },
  light: { color: 'color', position: 'position' },
  surface: { ambient: 'color', diffuse: 'color', specular: 'color', P: 'number', Krefl: 'number' },
  sphere: { center: 'position', radius: 'number' },
  cylinder: { radius: 'number', x: 'number', z: 'number', ymin: 'number', ymax: 'number' },
};

const regex = (pattern) => new RustRegex(pattern);

/** A command with all its arguments. */
const whole = ($, name) => seq(name, ...Object.entries(COMMANDS[name]).map(([arg, kind]) => field(arg, $[kind])));

/** The ways in which a command goes wrong: too few arguments, a wrong one, too many. */
const spoilt = ($, name) => {
  const kinds = Object.values(COMMANDS[name]);
  return [
    seq(name, beginning($, kinds), optional(seq($._no_number, repeat($._anything)))),
    seq(name, ...kinds.map((kind) => $[kind]), repeat1($._anything)),
  ];
};

/** Arguments from the first on, perhaps none, but not all. */
const beginning = ($, [first, ...others]) => {
  const ways = [];
  if (others.length > 0) {
    ways.push(seq($[first], beginning($, others)));
  }
  if (first !== 'number') {
    ways.push(seq($.number, optional($.number)));
  }
  return ways.length > 0 ? optional(choice(...ways)) : blank();
};

module.exports = grammar({
  name: 'clisc',

  extras: () => [/[ \t]+/],

  rules: {
    scene: ($) => seq(optional($._line), repeat(seq($._line_end, optional($._line)))),

    _line: ($) => choice($.comment, seq(choice($._command, $.malformed), optional($.comment))),

    _command: ($) => choice($.fov, $.background, $.light, $.surface, $.sphere, $.cylinder, $.write),

    fov: ($) => whole($, 'fov'),
    background: ($) => whole($, 'background'),
    light: ($) => whole($, 'light'),
    surface: ($) => whole($, 'surface'),
    sphere: ($) => whole($, 'sphere'),
    cylinder: ($) => whole($, 'cylinder'),
    write: ($) => seq('write', field('name', choice($.bare_name, $.quoted_name))),

    color: ($) => seq(field('r', $.number), field('g', $.number), field('b', $.number)),
    position: ($) => seq(field('x', $.number), field('y', $.number), field('z', $.number)),

    number: () => /[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?/,
    bare_name: () => regex(`\\.png|[^"${SEPARATOR}][^\\x20\\t${CONTROL}]*\\.png`),
    quoted_name: () => regex(`"[^"${CONTROL}]*\\.png"`),

    // NUL has a branch of its own: in a class the generated lexer takes it for the end of the text.
    comment: () => token(seq('#', repeat(choice(/[^\r\n\x00]/, seq('\0', optional(/[^\r\n\x00]/)))))),
    // A carriage return that no line feed follows ends a line, and should not.
    _line_end: ($) => choice(/\r?\n/, alias('\r', $.malformed)),

    // What is wrong.
    malformed: ($) =>
      choice(
        seq(choice($.number, $.word, $.foreign), repeat($._anything)),
        ...Object.keys(COMMANDS).flatMap((name) => spoilt($, name)),
        seq('write', optional(seq($._no_name, repeat($._any_name)))),
        seq('write', choice($.bare_name, $.quoted_name), repeat1($._any_name)),
      ),

    _anything: ($) => choice($.number, $._no_number),
    _no_number: ($) => choice($.word, $.foreign, ...Object.keys(COMMANDS), 'write'),
    _any_name: ($) => choice($.bare_name, $.quoted_name, $._no_name),
    _no_name: ($) => choice(alias($._word_for_name, $.word), $.foreign),

    word: () => regex(`[^${SEPARATOR}]+`),
    // A quote that is not closed, or no .png.
    _word_for_name: () => regex(`"[^"${CONTROL}]*"?|[^"${SEPARATOR}][^\\x20\\t${CONTROL}]*`),
    // Characters that look like a blank or like nothing.
    foreign: () => regex(`[\\x00-\\x08\\x0B\\x0C\\x0E-\\x1F\\x7F-\\u{9F}${FOREIGN_BLANK}]+`),
  },
});
