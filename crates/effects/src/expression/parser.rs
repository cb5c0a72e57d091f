//! Parses text into parts by recursive descent, at most 64 levels deep.
//!
//! ```text
//! sum     = product (("+" | "-") product)*
//! product = unary (("*" | "/") unary)*
//! unary   = ("-" | "+") unary | power
//! power   = atom ("^" unary)?                      so that -x^2 = -(x^2) and a^b^c = a^(b^c)
//! atom    = number ("[" unit "]")? | name | name "(" sum ("," sum)* ")" | "(" sum ")"
//! ```
//!
//! The first argument of `if` is `sum comparison sum`.

use super::error::{ExpressionError, nearest};
use super::function;
use super::lexer::{Lexer, Token};
use super::node::{Node, Part};
use super::variable::{Variable, place};
use super::{MAX_DEPTH, MAX_NODES};
use bulge_muscles::shown::shortened;
use bulge_muscles::units;
use bulge_numerics::tape::{Function, Operator};
use std::ops::Range;

/// Reads a formula of the variables and these parameters.
pub(crate) fn parse(
    text: &str,
    variables: &'static [Variable],
    parameters: &[&str],
) -> Result<Vec<Node>, ExpressionError> {
    let mut lexer = Lexer::new(text);
    let (token, span) = lexer.next()?;
    let mut parser =
        Parser { text, variables, parameters, lexer, token, span, end: 0, depth: 0, nodes: Vec::new() };
    if parser.token == Token::End {
        let instead = "write a force, such as `-k * eps` with a parameter `k` in N";
        return Err(ExpressionError::new(text, 0..0, "the formula is empty", instead));
    }
    parser.sum()?;
    if parser.token == Token::End { Ok(parser.nodes) } else { Err(parser.unexpected("an operator")) }
}

struct Parser<'t> {
    text: &'t str,
    variables: &'static [Variable],
    parameters: &'t [&'t str],
    lexer: Lexer<'t>,
    /// The next word.
    token: Token,
    span: Range<usize>,
    /// The end of the last word.
    end: usize,
    depth: usize,
    nodes: Vec<Node>,
}

type Parsed = Result<(), ExpressionError>;

impl Parser<'_> {
    fn advance(&mut self) -> Parsed {
        self.end = self.span.end;
        (self.token, self.span) = self.lexer.next()?;
        Ok(())
    }

    fn error(
        &self,
        span: Range<usize>,
        what: impl Into<String>,
        instead: impl Into<String>,
    ) -> ExpressionError {
        ExpressionError::new(self.text, span, what, instead)
    }

    /// Adds a part that begins at `start` and ends with the last word.
    fn push(&mut self, part: Part, start: usize) -> Parsed {
        if self.nodes.len() >= MAX_NODES {
            let what = format!("the formula has more than {MAX_NODES} parts");
            return Err(self.error(
                start..self.end,
                what,
                "write a shorter formula (of forces, several effects with a part each)",
            ));
        }
        self.nodes.push(Node { part, span: start..self.end });
        Ok(())
    }

    /// Reads one level deeper.
    fn within(&mut self, read: impl FnOnce(&mut Self) -> Parsed) -> Parsed {
        if self.depth >= MAX_DEPTH {
            let what = format!("the formula is more than {MAX_DEPTH} levels deep here");
            return Err(self.error(self.span.clone(), what, "leave out parentheses that are not needed"));
        }
        self.depth += 1;
        read(self)?;
        self.depth -= 1;
        Ok(())
    }

    fn sum(&mut self) -> Parsed {
        let start = self.span.start;
        self.product()?;
        loop {
            let operator = match self.token {
                Token::Plus => Operator::Add,
                Token::Minus => Operator::Subtract,
                _ => return Ok(()),
            };
            self.advance()?;
            self.product()?;
            self.push(Part::Operate(operator), start)?;
        }
    }

    fn product(&mut self) -> Parsed {
        let start = self.span.start;
        self.unary()?;
        loop {
            let operator = match self.token {
                Token::Times => Operator::Multiply,
                Token::Over => Operator::Divide,
                _ => return Ok(()),
            };
            self.advance()?;
            self.unary()?;
            self.push(Part::Operate(operator), start)?;
        }
    }

    fn unary(&mut self) -> Parsed {
        let start = self.span.start;
        match self.token {
            Token::Minus => {
                self.advance()?;
                self.within(Self::unary)?;
                self.push(Part::Negate, start)
            }
            Token::Plus => {
                self.advance()?;
                self.within(Self::unary)
            }
            _ => self.power(),
        }
    }

    fn power(&mut self) -> Parsed {
        let start = self.span.start;
        self.atom()?;
        if self.token != Token::Power {
            return Ok(());
        }
        self.advance()?;
        self.within(Self::unary)?;
        self.push(Part::Operate(Operator::Power), start)
    }

    fn atom(&mut self) -> Parsed {
        match self.token {
            Token::Number => self.number(),
            Token::Name => self.name(),
            Token::Open => {
                self.advance()?;
                self.within(Self::sum)?;
                self.close()
            }
            _ => Err(self.unexpected("a number, a name or `(`")),
        }
    }

    fn close(&mut self) -> Parsed {
        if self.token == Token::Close { self.advance() } else { Err(self.unexpected("`)`")) }
    }

    fn number(&mut self) -> Parsed {
        let digits = self.span.clone();
        self.advance()?;
        let unit = (self.token == Token::Unit).then(|| self.span.start + 1..self.span.end - 1);
        if unit.is_some() {
            self.advance()?;
        }
        let unit_text = unit.clone().map_or("", |unit| &self.text[unit]);
        let value = units::any(&format!("{} {unit_text}", &self.text[digits.clone()])).map_err(|error| {
            let span = unit.clone().unwrap_or(digits.clone());
            self.error(span, error.to_string(), "write a unit as in `3 [N]` or `0.1 [N/mm^2]`")
        })?;
        let start = digits.start;
        self.push(Part::Number { si: value.si, dimension: value.dimension, digits, unit }, start)
    }

    fn name(&mut self) -> Parsed {
        let (text, span) = (self.text, self.span.clone());
        let name = &text[span.clone()];
        self.advance()?;
        let is_call = self.token == Token::Open;
        if let Some(found) = function::named(name) {
            if is_call {
                return self.call(found, span.start);
            }
            let what = format!("`{name}` is a function, but has no argument here");
            return Err(self.error(span, what, format!("write `{}`", function::form(found))));
        }
        let parameter = self.parameters.iter().position(|known| *known == name);
        let part = match place(self.variables, name) {
            Some(variable) => Part::Variable(variable),
            None if name == "pi" => Part::Pi,
            None => match parameter {
                Some(parameter) => Part::Parameter(parameter),
                None if is_call => return Err(self.unknown_function(name, span)),
                None => return Err(self.unknown_name(name, span)),
            },
        };
        if is_call {
            let what = format!("`{name}` is a number, not a function");
            let both = span.start..self.span.end;
            return Err(self.error(both, what, format!("write `{name} * (`, if it is a product")));
        }
        self.push(part, span.start)
    }

    fn call(&mut self, called: Function, start: usize) -> Parsed {
        self.advance()?;
        self.within(|parser| if called == Function::If { parser.condition() } else { parser.sum() })?;
        let mut count = 1;
        while self.token == Token::Comma {
            // min(a, b, c) is read as min(min(a, b), c).
            if count > 1 && matches!(called, Function::Min | Function::Max) {
                self.push(Part::Call(called), start)?;
            }
            self.advance()?;
            self.within(Self::sum)?;
            count += 1;
        }
        let is_right = match called {
            Function::Min | Function::Max => count >= 2,
            _ => count == called.arity(),
        };
        if let (false, Token::Close) = (is_right, self.token) {
            let (name, form) = (function::name(called), function::form(called));
            let plural = if count == 1 { "" } else { "s" };
            let what = format!("`{name}` has {count} argument{plural} here");
            return Err(self.error(start..self.span.end, what, format!("write `{form}`")));
        }
        self.close()?;
        self.push(Part::Call(called), start)
    }

    /// The first argument of `if`.
    fn condition(&mut self) -> Parsed {
        let start = self.span.start;
        self.sum()?;
        let Token::Compare(comparison) = self.token else {
            return Err(self.unexpected("a comparison (<, <=, > or >=)"));
        };
        self.advance()?;
        self.sum()?;
        self.push(Part::Compare(comparison), start)
    }

    fn unknown_name(&self, name: &str, span: Range<usize>) -> ExpressionError {
        let what = format!("unknown name `{}`", shortened(name));
        let variables = self.variables.iter().map(|variable| variable.name);
        let aliases = self.variables.iter().filter_map(|variable| variable.alias);
        let known = self.parameters.iter().copied().chain(variables.clone()).chain(aliases);
        let guess = nearest(name, known).map_or_else(String::new, |near| format!("did you mean `{near}`?\n"));
        let parameters =
            if self.parameters.is_empty() { "none".to_owned() } else { self.parameters.join(", ") };
        let list = variables.collect::<Vec<_>>().join(", ");
        self.error(span, what, format!("{guess}parameters here: {parameters}\nvariables: {list}"))
    }

    fn unknown_function(&self, name: &str, span: Range<usize>) -> ExpressionError {
        let also = [("log", "ln"), ("pow", "^"), ("heaviside", "step"), ("sgn", "sign"), ("arctan", "atan")];
        let names: Vec<&str> = function::names().collect();
        let meant = also.iter().find(|(other, _)| *other == name).map(|(_, known)| *known);
        let guess = meant.or_else(|| nearest(name, names.iter().copied()));
        let guess = guess.map_or_else(String::new, |near| format!("did you mean `{near}`?\n"));
        let list = names.join(", ");
        self.error(
            span,
            format!("unknown function `{}`", shortened(name)),
            format!("{guess}functions: {list}"),
        )
    }

    /// The error for a word that can't stand here.
    fn unexpected(&self, wanted: &str) -> ExpressionError {
        let word = shortened(&self.text[self.span.clone()]);
        let is_operand = matches!(self.token, Token::Number | Token::Name | Token::Open);
        let (what, instead) = match self.token {
            Token::End => (
                format!("the formula ends where {wanted} should stand"),
                String::from("complete it, or delete its last sign"),
            ),
            Token::Unit => (
                format!("the unit `{word}` does not stand behind a number"),
                "write a unit as in `3 [N]`; the unit of a parameter stands where it is stated".to_owned(),
            ),
            Token::Compare(comparison) => (
                format!("a comparison with `{}` stands outside of `if`", function::symbol(comparison)),
                "compare one time within `if`: `if(a < b, x, y)`".to_owned(),
            ),
            Token::Comma => (
                format!("a comma where {wanted} should stand"),
                "separate arguments of a function by commas, and write decimals with a point".to_owned(),
            ),
            Token::Close => (format!("`)` where {wanted} should stand"), "check the parentheses".to_owned()),
            // Where a number is wanted, an operand can stand.
            _ if is_operand => {
                let instead = format!(
                    "write an operator before `{word}`, such as `*`; a unit stands in brackets: `3 [N]`"
                );
                (format!("`{word}` where {wanted} should stand"), instead)
            }
            _ => (format!("`{word}` where {wanted} should stand"), format!("write {wanted} before `{word}`")),
        };
        self.error(self.span.clone(), what, instead)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The formula in reverse Polish notation, which shows the order of operations.
    fn polish(text: &str) -> String {
        let nodes = parse(text, &super::super::VARIABLES, &["a", "b", "c"]).unwrap();
        let word = |node: &Node| match &node.part {
            Part::Number { si, .. } => si.to_string(),
            Part::Pi => "pi".to_owned(),
            Part::Variable(index) => super::super::VARIABLES[*index].name.to_owned(),
            Part::Parameter(index) => ["a", "b", "c"][*index].to_owned(),
            Part::Negate => "neg".to_owned(),
            Part::Operate(operator) => ["+", "-", "*", "/", "^"][usize::from(*operator as u8)].to_owned(),
            Part::Compare(comparison) => function::symbol(*comparison).to_owned(),
            Part::Call(called) => function::name(*called).to_owned(),
        };
        nodes.iter().map(word).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn order_of_operations() {
        for (text, expected) in [
            ("a+b*c", "a b c * +"),
            ("(a+b)*c", "a b + c *"),
            ("a-b-c", "a b - c -"),
            ("a/b/c", "a b / c /"),
            ("a^b^c", "a b c ^ ^"),
            ("-a^b", "a b ^ neg"),
            ("a^-b", "a b neg ^"),
            ("-a*b", "a neg b *"),
            ("a*-b", "a b neg *"),
            ("--a", "a neg neg"),
            ("+a", "a"),
            ("a\u{b7}b \u{2212} c", "a b * c -"),
            ("max(a, b)", "a b max"),
            ("min(a, b, c)", "a b min c min"),
            ("if(a+b <= c, a, b)*2", "a b + c <= a b if 2 *"),
            ("3 [kN] / 2e3", "3000 2000 /"),
            (".5*5.", "0.5 5 *"),
            ("pressure*eps*pi", "p eps * pi *"),
            ("2*\n a\t-1", "2 a * 1 -"),
        ] {
            assert_eq!(polish(text), expected, "{text}");
        }
    }

    #[test]
    fn each_part_knows_its_place() {
        let text = "a + max(b, 2 [N]) * c";
        let spans: Vec<_> = parse(text, &super::super::VARIABLES, &["a", "b", "c"])
            .unwrap()
            .iter()
            .map(|n| &text[n.span.clone()])
            .collect();
        assert_eq!(spans, ["a", "b", "2 [N]", "max(b, 2 [N])", "c", "max(b, 2 [N]) * c", text]);
    }
}
