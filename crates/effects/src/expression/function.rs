//! The names and notations of the functions and comparisons in formulas.

use bulge_numerics::tape::{Comparison, Function};

/// Each function with its name and its notation.
const ALL: [(Function, &str, &str); 19] = [
    (Function::Sqrt, "sqrt", "sqrt(x)"),
    (Function::Exp, "exp", "exp(x)"),
    (Function::Ln, "ln", "ln(x)"),
    (Function::Log10, "log10", "log10(x)"),
    (Function::Sin, "sin", "sin(x)"),
    (Function::Cos, "cos", "cos(x)"),
    (Function::Tan, "tan", "tan(x)"),
    (Function::Asin, "asin", "asin(x)"),
    (Function::Atan, "atan", "atan(x)"),
    (Function::Tanh, "tanh", "tanh(x)"),
    (Function::Sinh, "sinh", "sinh(x)"),
    (Function::Cosh, "cosh", "cosh(x)"),
    (Function::Abs, "abs", "abs(x)"),
    (Function::Sign, "sign", "sign(x)"),
    (Function::Step, "step", "step(x)"),
    (Function::Min, "min", "min(a, b)"),
    (Function::Max, "max", "max(a, b)"),
    (Function::Clamp, "clamp", "clamp(x, low, high)"),
    (Function::If, "if", "if(a < b, x, y)"),
];

/// The function with this name.
pub(crate) fn named(name: &str) -> Option<Function> {
    ALL.iter().find(|(_, known, _)| *known == name).map(|(function, ..)| *function)
}

/// All names.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    ALL.iter().map(|(_, name, _)| *name)
}

pub(crate) fn name(function: Function) -> &'static str {
    ALL.iter().find(|(known, ..)| *known == function).map_or("", |(_, name, _)| *name)
}

/// The notation with arguments.
pub(crate) fn form(function: Function) -> &'static str {
    ALL.iter().find(|(known, ..)| *known == function).map_or("", |(.., form)| *form)
}

pub(crate) fn symbol(comparison: Comparison) -> &'static str {
    match comparison {
        Comparison::Less => "<",
        Comparison::LessOrEqual => "<=",
        Comparison::Greater => ">",
        Comparison::GreaterOrEqual => ">=",
    }
}
