//! A reader of W3C EBNF: grammar text in, a recogniser and a generator of sentences out.
//!
//! The grammars it reads are regular: no production leads back to itself. So a grammar becomes a finite automaton, which
//! follows all its paths at once and never backtracks. A path leaves marks where it had a choice, which tell afterwards
//! which parts of the grammar a sentence has used.

use std::collections::{BTreeMap, BTreeSet};

use clisc::testing::Stream;

/// Characters that a negated class is tried with when a sentence is generated.
const SAMPLES: &str = "aZ7.-+#\"'/\\ \té π漢😀\u{A0}\u{FEFF}\u{200B}\u{85}\u{1B}\u{7F}\u{0}\r\n";

/// A grammar.
#[derive(Debug)]
pub struct Grammar {
    productions: BTreeMap<String, Expr>,
    /// What each mark stands for, in words.
    marks: Vec<String>,
}

/// The right side of a production, or a part of one. A choice and a repetition know the first of their marks.
#[derive(Clone, Debug)]
pub enum Expr {
    /// The name of a production.
    Symbol(String),
    /// These characters.
    Literal(String),
    /// One character.
    Class(Class),
    /// One after the other.
    Sequence(Vec<Expr>),
    /// One of them.
    Choice(usize, Vec<Expr>),
    /// `?`, `*` or `+`.
    Repeat(usize, Box<Expr>, Quantity),
}

/// How often something stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// `?`
    Optional,
    /// `*`
    Any,
    /// `+`
    Some,
}

/// A set of characters.
#[derive(Clone, Debug)]
pub struct Class {
    is_negated: bool,
    ranges: Vec<(char, char)>,
}

impl Class {
    fn contains(&self, c: char) -> bool {
        self.ranges.iter().any(|&(low, high)| (low..=high).contains(&c)) != self.is_negated
    }

    fn pick(&self, stream: &mut Stream) -> char {
        if self.is_negated {
            let fitting: Vec<char> = SAMPLES.chars().filter(|&c| self.contains(c)).collect();
            return fitting[stream.below(fitting.len())];
        }
        let (low, high) = self.ranges[stream.below(self.ranges.len())];
        let picked = u32::from(low) + stream.below((u32::from(high) - u32::from(low) + 1) as usize) as u32;
        char::from_u32(picked).expect("a range without surrogates")
    }
}

impl Grammar {
    /// Reads a grammar.
    ///
    /// # Panics
    /// When the text is none, when a symbol has no production or several, or when a production leads back to itself.
    pub fn read(text: &str) -> Self {
        let text = without_comments(text);
        let mut grammar = Self { productions: BTreeMap::new(), marks: Vec::new() };
        let heads: Vec<usize> = text.match_indices("::=").map(|(at, _)| line_start(&text, at)).collect();
        for (i, &start) in heads.iter().enumerate() {
            let end = heads.get(i + 1).copied().unwrap_or(text.len());
            let (name, right) = text[start..end].split_once("::=").expect("a production");
            let mut reader = Reader { name: name.trim(), text: right, at: 0, marks: &mut grammar.marks };
            let expr = reader.choice();
            reader.skip_blanks();
            assert_eq!(reader.rest(), "", "{name}: unread");
            assert!(grammar.productions.insert(name.trim().to_owned(), expr).is_none(), "{name}: twice");
        }
        for name in grammar.productions.keys() {
            grammar.assert_ends(name, &mut Vec::new());
        }
        grammar
    }

    /// Returns the names of the productions.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.productions.keys().map(String::as_str)
    }

    /// Returns the right side of a production.
    pub fn production(&self, name: &str) -> &Expr {
        self.productions.get(name).unwrap_or_else(|| panic!("no production `{name}`"))
    }

    /// Returns what `marks` leaves out of the grammar, in words.
    pub fn unused(&self, marks: &BTreeSet<usize>) -> Vec<&str> {
        (0..self.marks.len()).filter(|mark| !marks.contains(mark)).map(|mark| self.marks[mark].as_str()).collect()
    }

    /// Returns a sentence of a production.
    pub fn generate(&self, name: &str, stream: &mut Stream) -> String {
        let mut sentence = String::new();
        self.append(self.production(name), stream, &mut sentence);
        sentence
    }

    fn append(&self, expr: &Expr, stream: &mut Stream, sentence: &mut String) {
        match expr {
            Expr::Symbol(name) => self.append(self.production(name), stream, sentence),
            Expr::Literal(text) => sentence.push_str(text),
            Expr::Class(class) => sentence.push(class.pick(stream)),
            Expr::Sequence(parts) => parts.iter().for_each(|part| self.append(part, stream, sentence)),
            Expr::Choice(_, branches) => self.append(&branches[stream.below(branches.len())], stream, sentence),
            Expr::Repeat(_, part, quantity) => {
                let n = match quantity {
                    Quantity::Optional => stream.below(2),
                    Quantity::Any => stream.below(4),
                    Quantity::Some => 1 + stream.below(3),
                };
                (0..n).for_each(|_| self.append(part, stream, sentence));
            }
        }
    }

    fn assert_ends(&self, name: &str, above: &mut Vec<String>) {
        assert!(!above.iter().any(|outer| outer == name), "`{name}` leads back to itself");
        above.push(name.to_owned());
        for symbol in symbols(self.production(name)) {
            self.assert_ends(symbol, above);
        }
        above.pop();
    }
}

/// Returns the symbols of an expression, from left to right.
pub fn symbols(expr: &Expr) -> Vec<&str> {
    match expr {
        Expr::Symbol(name) => vec![name],
        Expr::Literal(_) | Expr::Class(_) => Vec::new(),
        Expr::Sequence(parts) | Expr::Choice(_, parts) => parts.iter().flat_map(symbols).collect(),
        Expr::Repeat(_, part, _) => symbols(part),
    }
}

fn without_comments(text: &str) -> String {
    let mut pieces = text.split("/*");
    let mut kept = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        kept.push_str(piece.split_once("*/").expect("a comment that ends").1);
    }
    kept
}

fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind('\n').map_or(0, |newline| newline + 1)
}

/// Reads one right side.
struct Reader<'t> {
    name: &'t str,
    text: &'t str,
    at: usize,
    marks: &'t mut Vec<String>,
}

impl<'t> Reader<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    fn skip_blanks(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    fn take(&mut self, expected: &str) -> bool {
        self.skip_blanks();
        let is_there = self.rest().starts_with(expected);
        self.at += if is_there { expected.len() } else { 0 };
        is_there
    }

    fn take_char(&mut self) -> char {
        let c = self.rest().chars().next().unwrap_or_else(|| panic!("{}: ends too early", self.name));
        self.at += c.len_utf8();
        c
    }

    /// Adds a mark for each of some ways through a part of the text.
    fn mark<'w>(&mut self, ways: impl IntoIterator<Item = &'w str>) -> usize {
        let first = self.marks.len();
        self.marks.extend(ways.into_iter().map(|way| format!("{}: {way}", self.name)));
        first
    }

    fn choice(&mut self) -> Expr {
        let (mut branches, mut texts) = (Vec::new(), Vec::new());
        loop {
            let start = self.at;
            branches.push(self.sequence());
            texts.push(self.text[start..self.at].trim());
            if !self.take("|") {
                break;
            }
        }
        if branches.len() == 1 { branches.remove(0) } else { Expr::Choice(self.mark(texts), branches) }
    }

    fn sequence(&mut self) -> Expr {
        let mut parts = Vec::new();
        loop {
            self.skip_blanks();
            if self.rest().is_empty() || self.rest().starts_with(['|', ')']) {
                return Expr::Sequence(parts);
            }
            parts.push(self.repetition());
        }
    }

    fn repetition(&mut self) -> Expr {
        let start = self.at;
        let part = self.atom();
        let (quantity, ways) = match self.rest().chars().next() {
            Some('?') => (Quantity::Optional, ["left out", "there"]),
            Some('*') => (Quantity::Any, ["not at all", "at least once"]),
            Some('+') => (Quantity::Some, ["once", "more than once"]),
            _ => return part,
        };
        self.take_char();
        let text = &self.text[start..self.at];
        let ways = ways.map(|way| format!("{text} {way}"));
        Expr::Repeat(self.mark(ways.iter().map(String::as_str)), Box::new(part), quantity)
    }

    fn atom(&mut self) -> Expr {
        match self.take_char() {
            '(' => {
                let inner = self.choice();
                assert!(self.take(")"), "{}: a bracket is not closed", self.name);
                inner
            }
            '[' => Expr::Class(self.class()),
            '#' => {
                let c = self.code_point();
                Expr::Class(Class { is_negated: false, ranges: vec![(c, c)] })
            }
            quote @ ('"' | '\'') => {
                let (text, _) = self.rest().split_once(quote).expect("a literal that ends");
                self.at += text.len() + 1;
                Expr::Literal(text.to_owned())
            }
            _ => {
                self.at -= 1;
                let is_end = |c: char| !(c.is_ascii_alphanumeric() || c == '-');
                let name = &self.rest()[..self.rest().find(is_end).unwrap_or(self.rest().len())];
                assert!(!name.is_empty(), "{}: unexpected {:?}", self.name, self.rest());
                self.at += name.len();
                Expr::Symbol(name.to_owned())
            }
        }
    }

    fn class(&mut self) -> Class {
        let is_negated = self.rest().starts_with('^');
        self.at += usize::from(is_negated);
        let mut ranges = Vec::new();
        loop {
            let low = match self.take_char() {
                ']' => return Class { is_negated, ranges },
                '#' => self.code_point(),
                c => c,
            };
            // A hyphen at the end of a class stands for itself.
            let is_range = self.rest().starts_with('-') && !self.rest().starts_with("-]");
            let high = if is_range { self.range_end() } else { low };
            assert!(low <= high, "{}: a range that falls", self.name);
            ranges.push((low, high));
        }
    }

    fn range_end(&mut self) -> char {
        self.take_char();
        match self.take_char() {
            '#' => self.code_point(),
            c => c,
        }
    }

    /// Reads `xN` behind a `#`.
    fn code_point(&mut self) -> char {
        assert_eq!(self.take_char(), 'x', "{}: a code point is #xN", self.name);
        let digits = &self.rest()[..self.rest().find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(self.rest().len())];
        self.at += digits.len();
        u32::from_str_radix(digits, 16).ok().and_then(char::from_u32).expect("a code point")
    }
}

/// A state of an [`Automaton`].
#[derive(Debug)]
enum State {
    /// Goes on behind one character.
    Take(Class, usize),
    /// Goes on here, and leaves a mark.
    Mark(usize, usize),
    /// Goes on at any of them.
    Split(Vec<usize>),
    Accept,
}

/// A recogniser for one production of a grammar.
#[derive(Debug)]
pub struct Automaton {
    states: Vec<State>,
    start: usize,
}

/// A state that has been reached, and the step it was reached from.
#[derive(Clone, Copy, Debug)]
struct Step {
    state: usize,
    before: Option<usize>,
}

impl Automaton {
    /// Makes the recogniser of a production.
    pub fn new(grammar: &Grammar, name: &str) -> Self {
        let mut automaton = Self { states: vec![State::Accept], start: 0 };
        automaton.start = automaton.build(grammar, grammar.production(name), 0);
        automaton
    }

    /// Tells whether `text` is a sentence.
    pub fn accepts(&self, text: &str) -> bool {
        self.marks(text).is_some()
    }

    /// Returns the marks on one way through a sentence; `None` when it is none.
    pub fn marks(&self, text: &str) -> Option<BTreeSet<usize>> {
        let mut steps = Vec::new();
        let mut front = self.closure(&mut steps, vec![Step { state: self.start, before: None }]);
        for c in text.chars() {
            let mut next = Vec::new();
            for &at in &front {
                if let State::Take(class, state) = &self.states[steps[at].state]
                    && class.contains(c)
                {
                    next.push(Step { state: *state, before: Some(at) });
                }
            }
            front = self.closure(&mut steps, next);
        }
        let end = front.into_iter().find(|&at| matches!(self.states[steps[at].state], State::Accept))?;
        let way = std::iter::successors(Some(end), |&at| steps[at].before);
        Some(way.filter_map(|at| self.mark(steps[at].state)).collect())
    }

    fn mark(&self, state: usize) -> Option<usize> {
        if let State::Mark(mark, _) = self.states[state] { Some(mark) } else { None }
    }

    /// Follows all ways that take no character; returns the places of the states in `steps`.
    fn closure(&self, steps: &mut Vec<Step>, mut ahead: Vec<Step>) -> Vec<usize> {
        let (mut seen, mut reached) = (BTreeSet::new(), Vec::new());
        while let Some(step) = ahead.pop() {
            if !seen.insert(step.state) {
                continue;
            }
            let before = Some(steps.len());
            reached.push(steps.len());
            steps.push(step);
            match &self.states[step.state] {
                State::Mark(_, next) => ahead.push(Step { state: *next, before }),
                State::Split(nexts) => ahead.extend(nexts.iter().map(|&state| Step { state, before })),
                State::Take(..) | State::Accept => {}
            }
        }
        reached
    }

    fn push(&mut self, state: State) -> usize {
        self.states.push(state);
        self.states.len() - 1
    }

    /// Adds the states of an expression that goes on at `next`; returns the first.
    fn build(&mut self, grammar: &Grammar, expr: &Expr, next: usize) -> usize {
        match expr {
            Expr::Symbol(name) => self.build(grammar, grammar.production(name), next),
            Expr::Class(class) => self.push(State::Take(class.clone(), next)),
            Expr::Literal(text) => text.chars().rev().fold(next, |next, c| {
                let class = Class { is_negated: false, ranges: vec![(c, c)] };
                self.push(State::Take(class, next))
            }),
            Expr::Sequence(parts) => parts.iter().rev().fold(next, |next, part| self.build(grammar, part, next)),
            Expr::Choice(first, branches) => {
                let ways = (*first..).zip(branches).map(|(mark, branch)| {
                    let state = self.build(grammar, branch, next);
                    self.push(State::Mark(mark, state))
                });
                let ways = ways.collect();
                self.push(State::Split(ways))
            }
            Expr::Repeat(first, part, quantity) => self.build_repeat(grammar, *first, part, *quantity, next),
        }
    }

    fn build_repeat(&mut self, grammar: &Grammar, first: usize, part: &Expr, quantity: Quantity, next: usize) -> usize {
        let end = if quantity == Quantity::Some { next } else { self.push(State::Mark(first, next)) };
        if quantity == Quantity::Optional {
            let there = self.build(grammar, part, next);
            let there = self.push(State::Mark(first + 1, there));
            return self.push(State::Split(vec![end, there]));
        }
        // Behind the first time: once more, or on.
        let again = self.push(State::Split(Vec::new()));
        let more = self.build(grammar, part, again);
        let more = if quantity == Quantity::Some { self.push(State::Mark(first + 1, more)) } else { more };
        self.states[again] = State::Split(vec![more, next]);
        if quantity == Quantity::Any {
            let some = self.push(State::Mark(first + 1, more));
            return self.push(State::Split(vec![end, some]));
        }
        let once = self.push(State::Mark(first, next));
        let behind_first = self.push(State::Split(vec![once, more]));
        self.build(grammar, part, behind_first)
    }
}
