//! Tokens to a tree, by precedence.

use super::{
    error::{FormulaError, TextRange},
    lexer::{FormulaToken, FormulaTokenKind, tokens},
    units::LiteralUnit,
};

/// So deep formulas may be: deeper ones are made by programs, and would take the stack.
const DEEPEST: usize = 200;

#[derive(Clone, Debug)]
pub(crate) struct FormulaTree {
    pub kind: TreeKind,
    pub range: TextRange,
}

#[derive(Clone, Debug)]
pub(crate) enum TreeKind {
    Number(f64, Option<&'static LiteralUnit>),
    Name,
    /// `decided(true)`, `distance(a, b)`: what is in the parentheses is whatever the name says.
    Applied {
        name: TextRange,
        inside: TextRange,
    },
    Function(TermFunction, Vec<FormulaTree>),
    Negative(Box<FormulaTree>),
    Arithmetic(TermOperator, Box<FormulaTree>, Box<FormulaTree>),
    Comparison(Comparator, Box<FormulaTree>, Box<FormulaTree>),
    Not(Box<FormulaTree>),
    Junction(JunctionWord, Box<FormulaTree>, Box<FormulaTree>),
    /// An operator before its operand.
    Prefix(PrefixWord, Option<WindowTree>, Box<FormulaTree>),
    /// `until`, `since`.
    Infix(InfixWord, Option<WindowTree>, Box<FormulaTree>, Box<FormulaTree>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TermFunction {
    Abs,
    Min,
    Max,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TermOperator {
    Add,
    Subtract,
    Multiply,
    Divide,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Comparator {
    Less,
    AtMost,
    Greater,
    AtLeast,
    Equal,
    Unequal,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JunctionWord {
    And,
    Or,
    Implies,
}

/// Operators that stand before their operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PrefixWord {
    Once,
    Historically,
    Eventually,
    Always,
}

/// Operators that stand between two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum InfixWord {
    Since,
    Until,
}

/// `[0 s, 10 s]`
#[derive(Clone, Debug)]
pub(crate) struct WindowTree {
    pub from: Box<FormulaTree>,
    pub to: Box<FormulaTree>,
    pub range: TextRange,
}

/// What a word means that is no name.
enum ReservedWord {
    Prefix(PrefixWord),
    Infix(InfixWord),
    Junction(JunctionWord),
    Not,
}

fn reserved(word: &str) -> Option<ReservedWord> {
    Some(match word {
        "once" | "O" => ReservedWord::Prefix(PrefixWord::Once),
        "historically" | "H" => ReservedWord::Prefix(PrefixWord::Historically),
        "since" | "S" => ReservedWord::Infix(InfixWord::Since),
        "eventually" | "F" => ReservedWord::Prefix(PrefixWord::Eventually),
        "always" | "G" => ReservedWord::Prefix(PrefixWord::Always),
        "until" | "U" => ReservedWord::Infix(InfixWord::Until),
        "and" | "&&" => ReservedWord::Junction(JunctionWord::And),
        "or" | "||" => ReservedWord::Junction(JunctionWord::Or),
        "implies" | "->" => ReservedWord::Junction(JunctionWord::Implies),
        "not" | "!" => ReservedWord::Not,
        _ => return None,
    })
}

pub(crate) fn parse(text: &str) -> Result<FormulaTree, FormulaError> {
    let tokens = tokens(text)?;
    let mut parser = FormulaParser { text, tokens, at: 0, depth: 0 };
    let tree = parser.implication()?;
    match parser.tokens.get(parser.at) {
        None => Ok(tree),
        Some(token) => Err(parser.unexpected(&token.range.clone())),
    }
}

struct FormulaParser<'a> {
    text: &'a str,
    tokens: Vec<FormulaToken>,
    at: usize,
    depth: usize,
}

type Parsed = Result<FormulaTree, FormulaError>;

impl FormulaParser<'_> {
    fn shown(&self, range: &TextRange) -> &str {
        self.text.get(range.clone()).unwrap_or_default()
    }

    /// The text of the next token.
    fn next_text(&self) -> &str {
        self.tokens.get(self.at).map_or("", |t| self.shown(&t.range))
    }

    fn next_range(&self) -> TextRange {
        self.tokens.get(self.at).map_or(self.text.len()..self.text.len(), |t| t.range.clone())
    }

    fn take_if(&mut self, text: &str) -> bool {
        let is_it = self.next_text() == text;
        self.at += usize::from(is_it);
        is_it
    }

    fn unexpected(&self, range: &TextRange) -> FormulaError {
        if range.is_empty() {
            return FormulaError::new(range, "the formula ends here, and something is missing");
        }
        let shown = self.shown(range);
        let error = FormulaError::new(range, format!("`{shown}` does not stand here"));
        match shown {
            "=" => error.help("equality is `==`"),
            "until" | "since" | "U" | "S" => error.help("say by parentheses what belongs together"),
            "<" | "<=" | ">" | ">=" | "==" | "!=" => error.help("comparisons are joined by `and`"),
            _ => error,
        }
    }

    fn expect(&mut self, text: &str, what: &str) -> Result<(), FormulaError> {
        if self.take_if(text) {
            return Ok(());
        }
        Err(self.unexpected(&self.next_range()).help(format!("{what} wants a `{text}` here")))
    }

    fn is_junction(&self, of: JunctionWord) -> bool {
        matches!(reserved(self.next_text()), Some(ReservedWord::Junction(word)) if word == of)
    }

    fn implication(&mut self) -> Parsed {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(FormulaError::new(
                &self.next_range(),
                format!("the formula is more than {DEEPEST} deep"),
            ));
        }
        let left = self.junction(JunctionWord::Or)?;
        let tree = if self.is_junction(JunctionWord::Implies) {
            self.at += 1;
            let right = self.implication()?;
            joined(JunctionWord::Implies, left, right)
        } else {
            left
        };
        self.depth -= 1;
        Ok(tree)
    }

    /// `or`, which has `and` in it, which has `until` in it.
    fn junction(&mut self, word: JunctionWord) -> Parsed {
        let operand = |parser: &mut Self| match word {
            JunctionWord::Or => parser.junction(JunctionWord::And),
            JunctionWord::And | JunctionWord::Implies => parser.infix(),
        };
        let mut tree = operand(self)?;
        while self.is_junction(word) {
            self.at += 1;
            tree = joined(word, tree, operand(self)?);
        }
        Ok(tree)
    }

    fn infix(&mut self) -> Parsed {
        let left = self.prefixed()?;
        let Some(ReservedWord::Infix(word)) = reserved(self.next_text()) else {
            return Ok(left);
        };
        self.at += 1;
        let window = self.window()?;
        let right = self.prefixed()?;
        let range = left.range.start..right.range.end;
        Ok(FormulaTree { kind: TreeKind::Infix(word, window, Box::new(left), Box::new(right)), range })
    }

    fn prefixed(&mut self) -> Parsed {
        let start = self.next_range().start;
        let word = match reserved(self.next_text()) {
            Some(ReservedWord::Not) => None,
            Some(ReservedWord::Prefix(word)) => Some(word),
            Some(ReservedWord::Infix(_) | ReservedWord::Junction(_)) | None => return self.comparison(),
        };
        self.at += 1;
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(FormulaError::new(
                &self.next_range(),
                format!("the formula is more than {DEEPEST} deep"),
            ));
        }
        let window = if word.is_some() { self.window()? } else { None };
        let of = Box::new(self.prefixed()?);
        self.depth -= 1;
        let range = start..of.range.end;
        let kind = match word {
            None => TreeKind::Not(of),
            Some(word) => TreeKind::Prefix(word, window, of),
        };
        Ok(FormulaTree { kind, range })
    }

    fn window(&mut self) -> Result<Option<WindowTree>, FormulaError> {
        let start = self.next_range().start;
        if !self.take_if("[") {
            return Ok(None);
        }
        let from = Box::new(self.primary()?);
        self.expect(",", "a window")?;
        let to = Box::new(self.primary()?);
        let end = self.next_range().end;
        self.expect("]", "a window")?;
        Ok(Some(WindowTree { from, to, range: start..end }))
    }

    fn comparison(&mut self) -> Parsed {
        let left = self.sum()?;
        let comparator = match self.next_text() {
            "<" => Comparator::Less,
            "<=" => Comparator::AtMost,
            ">" => Comparator::Greater,
            ">=" => Comparator::AtLeast,
            "==" => Comparator::Equal,
            "!=" => Comparator::Unequal,
            _ => return Ok(left),
        };
        self.at += 1;
        let right = self.sum()?;
        let range = left.range.start..right.range.end;
        Ok(FormulaTree { kind: TreeKind::Comparison(comparator, Box::new(left), Box::new(right)), range })
    }

    fn sum(&mut self) -> Parsed {
        let mut tree = self.product()?;
        loop {
            let operator = match self.next_text() {
                "+" => TermOperator::Add,
                "-" => TermOperator::Subtract,
                _ => return Ok(tree),
            };
            self.at += 1;
            tree = computed(operator, tree, self.product()?);
        }
    }

    fn product(&mut self) -> Parsed {
        let mut tree = self.negative()?;
        loop {
            let operator = match self.next_text() {
                "*" => TermOperator::Multiply,
                "/" => TermOperator::Divide,
                _ => return Ok(tree),
            };
            self.at += 1;
            tree = computed(operator, tree, self.negative()?);
        }
    }

    fn negative(&mut self) -> Parsed {
        let start = self.next_range().start;
        if !self.take_if("-") {
            return self.primary();
        }
        let of = Box::new(self.primary()?);
        let range = start..of.range.end;
        Ok(FormulaTree { kind: TreeKind::Negative(of), range })
    }

    fn primary(&mut self) -> Parsed {
        let range = self.next_range();
        let Some(token) = self.tokens.get(self.at).cloned() else { return Err(self.unexpected(&range)) };
        match token.kind {
            FormulaTokenKind::Number(number, unit) => {
                self.at += 1;
                Ok(FormulaTree { kind: TreeKind::Number(number, unit), range })
            }
            FormulaTokenKind::Word if reserved(self.shown(&range)).is_none() => {
                self.at += 1;
                self.name(range)
            }
            FormulaTokenKind::Sign("(") => {
                self.at += 1;
                let mut tree = self.implication()?;
                // Names stay as they are.
                if !matches!(tree.kind, TreeKind::Name | TreeKind::Applied { .. }) {
                    tree.range = range.start..self.next_range().end;
                }
                self.expect(")", "a parenthesis")?;
                Ok(tree)
            }
            FormulaTokenKind::Word | FormulaTokenKind::Sign(_) => Err(self.unexpected(&range)),
        }
    }

    fn name(&mut self, name: TextRange) -> Parsed {
        let touches = self.next_range().start == name.end;
        if self.next_text() != "(" || !touches {
            return Ok(FormulaTree { kind: TreeKind::Name, range: name });
        }
        let function = match self.shown(&name) {
            "abs" => TermFunction::Abs,
            "min" => TermFunction::Min,
            "max" => TermFunction::Max,
            _ => return self.applied(name),
        };
        self.at += 1;
        let mut operands = vec![self.sum()?];
        while self.take_if(",") {
            operands.push(self.sum()?);
        }
        let range = name.start..self.next_range().end;
        self.expect(")", "a function")?;
        Ok(FormulaTree { kind: TreeKind::Function(function, operands), range })
    }

    /// Everything up to the parenthesis that closes.
    fn applied(&mut self, name: TextRange) -> Parsed {
        let start = self.next_range().end;
        let mut open = 0_usize;
        loop {
            let range = self.next_range();
            match self.next_text() {
                "" => return Err(self.unexpected(&range).help("a parenthesis wants a `)`")),
                "(" => open += 1,
                ")" => open -= 1,
                _ => {}
            }
            self.at += 1;
            if open == 0 {
                let whole = name.start..range.end;
                return Ok(FormulaTree {
                    kind: TreeKind::Applied { name, inside: start..range.start },
                    range: whole,
                });
            }
        }
    }
}

fn joined(word: JunctionWord, left: FormulaTree, right: FormulaTree) -> FormulaTree {
    let range = left.range.start..right.range.end;
    FormulaTree { kind: TreeKind::Junction(word, Box::new(left), Box::new(right)), range }
}

fn computed(operator: TermOperator, left: FormulaTree, right: FormulaTree) -> FormulaTree {
    let range = left.range.start..right.range.end;
    FormulaTree { kind: TreeKind::Arithmetic(operator, Box::new(left), Box::new(right)), range }
}
