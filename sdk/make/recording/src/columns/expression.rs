//! Expressions over columns: `fx1+fx2`, `-fz*0.31`, `(a-b)/2*9.81e-3`.
//!
//! ```text
//! sum     = product (('+' | '-') product)*
//! product = signed (('*' | '/') signed)*
//! signed  = ('+' | '-')* operand
//! operand = number | column | '(' sum ')'
//! column  = '#' number | '"' any '"' | "'" any "'" | path | name
//! ```
//!
//! A name begins with neither a digit nor an operator. It may contain spaces and a unit in
//! brackets, as in `Fx [mN]` and `Lateral Force (m/s)`. A path, such as `/run1/fx`, begins with `/`
//! and ends at a space or at an operator other than `/`. Products and quotients of columns are
//! allowed, so an expression need not be linear.
//!
//! The expression is evaluated row by row. A result that is not finite is an error, and the error
//! names the row.

use std::fmt;

use crate::columns::token::{ColumnRef, Problem, Token, TokenKind};

/// Deepest allowed nesting of parentheses and signs.
const MOST_DEEP: usize = 32;
/// Largest number of numbers, columns and operators together. A stack of this size is always enough
/// to evaluate them.
const MOST_STEPS: usize = 256;

/// An expression that computes a role's values: a single column, or sums, differences, products and
/// quotients of columns and numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    text: String,
    steps: Vec<Step>,
}

/// An operation on a stack of values.
#[derive(Debug, Clone, PartialEq)]
enum Step {
    Number(f64),
    Column(ColumnRef),
    Negate,
    Binary(Operator),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
}

impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Expression {
    /// Returns the column if the expression consists of a single column; `None` if it has to be
    /// computed.
    #[must_use]
    pub fn column(&self) -> Option<&ColumnRef> {
        match &self.steps[..] {
            [Step::Column(column)] => Some(column),
            _ => None,
        }
    }

    /// Returns the text of the expression as the user wrote it. If a file has a column whose name
    /// is exactly this text, the text refers to this column.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether the expression contains a number, which may be a factor between units.
    pub(crate) fn has_number(&self) -> bool {
        let is_number = |step: &Step| matches!(step, Step::Number(_));
        self.steps.iter().any(is_number)
    }

    /// Returns the formula, in which each column is replaced by what `find` returns for it.
    pub(crate) fn resolve<E>(
        &self,
        mut find: impl FnMut(&ColumnRef) -> Result<usize, E>,
    ) -> Result<Formula, E> {
        let resolved = |step: &Step| {
            Ok(match step {
                Step::Number(number) => Operation::Number(*number),
                Step::Column(column) => Operation::Column(find(column)?),
                Step::Negate => Operation::Negate,
                Step::Binary(operator) => Operation::Binary(*operator),
            })
        };
        let operations = self.steps.iter().map(resolved).collect::<Result<_, E>>()?;
        Ok(Formula { operations })
    }

    /// Parses `tokens` of `text`; there must be at least one.
    pub(crate) fn parse(text: &str, tokens: &[Token]) -> Result<Self, Problem> {
        let mut parser = Parser { tokens, steps: Vec::new(), depth: 0 };
        parser.sum()?;
        if let Some(token) = parser.tokens.first() {
            let what = match token.kind {
                TokenKind::Close => "')' closes nothing",
                TokenKind::Colon => "a second ':'; quote a name that contains one",
                TokenKind::Equals => "a second '='; quote a name that contains one",
                _ => "an operator is missing before this",
            };
            return Err(Problem::at_token(token, what));
        }
        let whole = match tokens {
            [first, .., last] => text.get(first.start..last.end),
            [only] => text.get(only.start..only.end),
            [] => None,
        };
        Ok(Self { text: whole.unwrap_or_default().to_owned(), steps: parser.steps })
    }
}

struct Parser<'a> {
    tokens: &'a [Token],
    steps: Vec<Step>,
    depth: usize,
}

impl Parser<'_> {
    fn sum(&mut self) -> Result<(), Problem> {
        self.chain(Self::product, |kind| match kind {
            TokenKind::Plus => Some(Operator::Add),
            TokenKind::Minus => Some(Operator::Subtract),
            _ => None,
        })
    }

    fn product(&mut self) -> Result<(), Problem> {
        self.chain(Self::signed, |kind| match kind {
            TokenKind::Times => Some(Operator::Multiply),
            TokenKind::Over => Some(Operator::Divide),
            _ => None,
        })
    }

    /// Parses terms joined by operators, from left to right.
    fn chain(
        &mut self,
        term: fn(&mut Self) -> Result<(), Problem>,
        operator: fn(&TokenKind) -> Option<Operator>,
    ) -> Result<(), Problem> {
        term(self)?;
        while let Some(operator) = self.tokens.first().and_then(|token| operator(&token.kind)) {
            self.tokens = &self.tokens[1..];
            term(self)?;
            self.push(Step::Binary(operator))?;
        }
        Ok(())
    }

    fn signed(&mut self) -> Result<(), Problem> {
        let Some((token, rest)) = self.tokens.split_first() else {
            return Err(Problem::at_end("a number or a column is missing at the end"));
        };
        self.depth += 1;
        if self.depth > MOST_DEEP {
            let what = format!("more than {MOST_DEEP} parentheses and signs within each other");
            return Err(Problem::at_token(token, what));
        }
        match &token.kind {
            TokenKind::Plus | TokenKind::Minus => {
                self.tokens = rest;
                self.signed()?;
                if token.kind == TokenKind::Minus {
                    self.push(Step::Negate)?;
                }
            }
            _ => self.operand()?,
        }
        self.depth -= 1;
        Ok(())
    }

    fn operand(&mut self) -> Result<(), Problem> {
        let Some((token, rest)) = self.tokens.split_first() else {
            return Err(Problem::at_end("a number or a column is missing at the end"));
        };
        self.tokens = rest;
        match &token.kind {
            TokenKind::Number(number) => self.push(Step::Number(*number)),
            TokenKind::Column(column) => self.push(Step::Column(column.clone())),
            TokenKind::Open => {
                self.sum()?;
                match self.tokens.split_first() {
                    Some((Token { kind: TokenKind::Close, .. }, rest)) => self.tokens = rest,
                    Some((other, _)) => {
                        return Err(Problem::at_token(
                            other,
                            "an operator or ')' is missing before this",
                        ));
                    }
                    None => return Err(Problem::at_token(token, "'(' is not closed")),
                }
                Ok(())
            }
            _ => Err(Problem::at_token(token, "a number or a column is missing before this")),
        }
    }

    fn push(&mut self, step: Step) -> Result<(), Problem> {
        if self.steps.len() == MOST_STEPS {
            let what = format!("more than {MOST_STEPS} numbers, columns and operators");
            return Err(Problem::at_end(what));
        }
        self.steps.push(step);
        Ok(())
    }
}

/// An expression whose columns are indices.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Formula {
    operations: Vec<Operation>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Operation {
    Number(f64),
    Column(usize),
    Negate,
    Binary(Operator),
}

impl Formula {
    /// Returns the columns in the order of use; a column may occur several times.
    pub(crate) fn columns(&self) -> impl Iterator<Item = usize> {
        self.operations.iter().filter_map(|operation| match operation {
            Operation::Column(column) => Some(*column),
            _ => None,
        })
    }

    /// Returns the value in each of `rows` rows, multiplied by `scale`; `of` returns the values of
    /// a column.
    pub(crate) fn values<'a>(
        &self,
        rows: usize,
        scale: f64,
        of: impl Fn(usize) -> &'a [f64],
    ) -> Vec<f64> {
        let mut stack = Vec::with_capacity(self.operations.len());
        let value = |row| {
            for operation in &self.operations {
                let value = match operation {
                    Operation::Number(number) => *number,
                    Operation::Column(column) => of(*column)[row],
                    Operation::Negate => -stack.pop().unwrap_or(f64::NAN),
                    Operation::Binary(operator) => {
                        // The right operand was pushed last. The stack is never empty here, because
                        // the parser wrote both operands before their operator.
                        let right = stack.pop().unwrap_or(f64::NAN);
                        let left = stack.pop().unwrap_or(f64::NAN);
                        operator.apply(left, right)
                    }
                };
                stack.push(value);
            }
            stack.pop().unwrap_or(f64::NAN) * scale
        };
        (0..rows).map(value).collect()
    }
}

impl Operator {
    fn apply(self, left: f64, right: f64) -> f64 {
        match self {
            Self::Add => left + right,
            Self::Subtract => left - right,
            Self::Multiply => left * right,
            Self::Divide => left / right,
        }
    }
}
