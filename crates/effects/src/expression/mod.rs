//! Formulas for user-defined effects: `-mu * p * (1 - eps) * direction + k * max(0, eps - eps_c)^2`.
//!
//! A formula is read and checked for its units once. It can then be evaluated any number of times with exact
//! derivatives.
//!
//! - Numbers, with a unit in brackets where they have one: `3 [N]`, `0.1 [N/mm^2]`. The constant `pi`.
//! - The variables of [`VARIABLES`], and parameters.
//! - `+ - * / ^` (`a^b^c` is `a^(b^c)`, `-x^2` is `-(x^2)`) and parentheses.
//! - `sqrt exp ln log10 sin cos tan asin atan tanh sinh cosh abs sign min max step clamp`, and
//!   `if(a < b, x, y)` with `< <= > >=`.
//!
//! At a kink the derivative is that of the active branch. For equal arguments of `min` and `max` this is the
//! first one. `clamp` is active up to and including its limits. `abs`, `sqrt` and powers between 0 and 1 have
//! the derivative 0 at 0, and `asin` has it at -1 and 1. The derivative of `sign` and `step` is 0 everywhere.

mod compile;
mod display;
mod error;
mod function;
mod lexer;
mod node;
mod parser;
mod variable;

pub use error::ExpressionError;
pub use variable::{SHAPE_VARIABLES, VARIABLES, Variable, variable_index};

use bulge_muscles::Dimension;
use bulge_numerics::Real;
use bulge_numerics::tape::{Builder, MOST_REGISTERS, Place, Tape};
use node::{Node, Part};
use std::fmt;

/// The largest nesting depth of parentheses, functions, signs and exponents.
pub const MAX_DEPTH: usize = 64;
/// The largest number of numbers, names and operators in a formula.
pub const MAX_NODES: usize = 4096;
/// The largest size of a formula, in bytes.
pub const MAX_BYTES: usize = 16 << 10;

/// A formula with consistent units.
///
/// ```
/// use bulge_effects::expression::{Expression, VARIABLES, variable_index};
/// use bulge_muscles::Dimension;
/// use bulge_numerics::Dual;
///
/// let formula = Expression::parse("-k * max(0, eps - 10 [%])^2", &[("k", Dimension::FORCE)], Dimension::FORCE)?;
/// let mut state = [Dual::<2>::from(0.0); VARIABLES.len()];
/// state[variable_index("eps").unwrap()] = Dual::variable(0.3, 0);
/// let force = formula.evaluate(&state, &[Dual::variable(50.0, 1)]);
/// assert!((force.gradient()[0] + 2.0 * 50.0 * 0.2).abs() < 1e-12);
///
/// let error = Expression::parse("p + eps", &[], Dimension::FORCE).unwrap_err();
/// assert_eq!(error.what(), "`p` (Pa) cannot be added to `eps` (1)");
/// # Ok::<(), bulge_effects::expression::ExpressionError>(())
/// ```
///
/// Two formulas are equal if they take the same steps with the same parameters.
#[derive(Debug, Clone)]
pub struct Expression {
    text: String,
    nodes: Vec<Node>,
    variables: &'static [Variable],
    parameters: Vec<String>,
    dimension: Dimension,
    builder: Builder,
    place: Place,
    tape: Tape,
}

impl Expression {
    /// Reads a formula of [`VARIABLES`] and of these parameters, each with its dimension. The formula must
    /// have the dimension `result`.
    ///
    /// Numbers without a unit are dimensionless, but a plain 0 fits any dimension.
    ///
    /// # Errors
    /// With the place and the cure, if the text is larger than [`MAX_BYTES`], deeper than [`MAX_DEPTH`] or
    /// longer than [`MAX_NODES`], is no formula, uses an unknown name, or has inconsistent units. Also if
    /// [`check_name`] refuses the name of a parameter, or if a name occurs twice.
    pub fn parse(
        text: &str,
        parameters: &[(&str, Dimension)],
        result: Dimension,
    ) -> Result<Self, ExpressionError> {
        Self::parse_over(text, &VARIABLES, parameters, result)
    }

    /// As [`Expression::parse`], but with other variables, such as [`SHAPE_VARIABLES`].
    ///
    /// # Errors
    /// As [`Expression::parse`].
    pub fn parse_over(
        text: &str,
        variables: &'static [Variable],
        parameters: &[(&str, Dimension)],
        result: Dimension,
    ) -> Result<Self, ExpressionError> {
        if text.len() > MAX_BYTES {
            let what = format!("the formula has {} bytes, but at most {MAX_BYTES} are read", text.len());
            return Err(ExpressionError::new(
                text,
                0..0,
                what,
                "write a shorter formula (of forces, several effects with a part each)",
            ));
        }
        let names: Vec<&str> = parameters.iter().map(|(name, _)| *name).collect();
        for (index, name) in names.iter().enumerate() {
            let twice = || Err(format!("there are two parameters `{name}`"));
            check_name(name, variables)
                .and_then(|()| if names[..index].contains(name) { twice() } else { Ok(()) })
                .map_err(|what| ExpressionError::new(text, 0..0, what, "rename the parameter"))?;
        }
        let nodes = parser::parse(text, variables, &names)?;
        let known = variables.iter().map(|variable| variable.dimension);
        let dimensions: Vec<Dimension> = known.chain(parameters.iter().map(|(_, of)| *of)).collect();
        let dimension = |index: usize| dimensions.get(index).copied().unwrap_or_default();
        let (builder, place) = compile::compile(text, &nodes, variables.len(), dimension, result)?;
        let tape = builder.finish(&[place]).ok_or_else(|| {
            let what = format!("the formula needs more than {MOST_REGISTERS} numbers at a time");
            ExpressionError::new(
                text,
                0..0,
                what,
                "write a shorter formula (of forces, several effects with a part each)",
            )
        })?;
        let parameters = names.into_iter().map(str::to_owned).collect();
        let text = text.to_owned();
        Ok(Self { text, nodes, variables, parameters, dimension: result, builder, place, tape })
    }

    /// The text as written. `Display` writes a normal form that reads as an equal formula.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Names of the parameters, in the order of their values.
    #[must_use]
    pub fn parameters(&self) -> &[String] {
        &self.parameters
    }

    /// Dimension of the value.
    #[must_use]
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// Whether the parameter at this index occurs.
    #[must_use]
    pub fn uses_parameter(&self, index: usize) -> bool {
        self.nodes.iter().any(|node| node.part == Part::Parameter(index))
    }

    /// Whether the variable at this index of its list occurs.
    #[must_use]
    pub fn uses_variable(&self, index: usize) -> bool {
        self.nodes.iter().any(|node| node.part == Part::Variable(index))
    }

    /// The value in SI. Variables and parameters are given in SI, each in its order.
    ///
    /// Numbers with derivatives ([`bulge_numerics::Dual`]) give a value with exact derivatives. Nothing is
    /// allocated. The result isn't finite if the formula has no value, such as the logarithm or a real power
    /// of a negative number or a division by 0, or if an input is missing. The caller checks this.
    pub fn evaluate<D: Real>(&self, variables: &[D], parameters: &[D]) -> D {
        let input = |index: usize| match index.checked_sub(self.variables.len()) {
            Some(parameter) => parameters.get(parameter),
            None => variables.get(index),
        };
        let [value] = self.tape.run_on(|index| input(index).copied().unwrap_or(D::from(f64::NAN)));
        value
    }

    /// The steps and the place of the value, for further processing. The inputs are the variables, followed
    /// by the parameters.
    pub(crate) fn steps(&self) -> (Builder, Place) {
        (self.builder.clone(), self.place)
    }
}

/// Checks the name of a parameter. It must consist of the letters a to z, digits and `_`, must not begin with
/// a digit, and must not be one of these variables, a function or a constant.
///
/// # Errors
/// A sentence with the reason.
pub fn check_name(name: &str, variables: &[Variable]) -> Result<(), String> {
    let shown = bulge_muscles::shown::shortened(name);
    let is_word = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if name.is_empty() || name.len() > 64 || !is_word || name.starts_with(|c: char| c.is_ascii_digit()) {
        return Err(format!(
            "`{shown}` is no name of a parameter: write letters from a to z, digits and `_`, first a letter, at most 64"
        ));
    }
    if let Some(variable) = variable::place(variables, name).and_then(|index| variables.get(index)) {
        return Err(format!("`{shown}` is a variable already: {}", variable.meaning));
    }
    if function::named(name).is_some() || name == "pi" {
        let kind = if name == "pi" { "constant" } else { "function" };
        return Err(format!("`{shown}` is a {kind} already"));
    }
    Ok(())
}

impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        self.parameters == other.parameters && self.dimension == other.dimension && self.tape == other.tape
    }
}

impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let written = display::written(&self.text, &self.nodes, self.variables, &self.parameters);
        // Blanks could make a long formula too long to be read again.
        f.pad(if written.len() > MAX_BYTES { &self.text } else { &written })
    }
}

#[cfg(test)]
mod tests;
