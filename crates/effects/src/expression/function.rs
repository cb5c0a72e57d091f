//! The functions and comparisons of formulas.

/// A function of formulas; angles are in rad.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Function {
    Sqrt,
    Exp,
    Ln,
    Log10,
    Sin,
    Cos,
    Tan,
    Asin,
    Atan,
    Tanh,
    Sinh,
    Cosh,
    Abs,
    Sign,
    Step,
    Min,
    Max,
    Clamp,
    If,
}

impl Function {
    /// Each with its name and how it is written.
    pub(crate) const ALL: [(Self, &'static str, &'static str); 19] = [
        (Self::Sqrt, "sqrt", "sqrt(x)"),
        (Self::Exp, "exp", "exp(x)"),
        (Self::Ln, "ln", "ln(x)"),
        (Self::Log10, "log10", "log10(x)"),
        (Self::Sin, "sin", "sin(x)"),
        (Self::Cos, "cos", "cos(x)"),
        (Self::Tan, "tan", "tan(x)"),
        (Self::Asin, "asin", "asin(x)"),
        (Self::Atan, "atan", "atan(x)"),
        (Self::Tanh, "tanh", "tanh(x)"),
        (Self::Sinh, "sinh", "sinh(x)"),
        (Self::Cosh, "cosh", "cosh(x)"),
        (Self::Abs, "abs", "abs(x)"),
        (Self::Sign, "sign", "sign(x)"),
        (Self::Step, "step", "step(x)"),
        (Self::Min, "min", "min(a, b)"),
        (Self::Max, "max", "max(a, b)"),
        (Self::Clamp, "clamp", "clamp(x, low, high)"),
        (Self::If, "if", "if(a < b, x, y)"),
    ];

    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, known, _)| *known == name).map(|(function, ..)| *function)
    }

    pub(crate) fn name(self) -> &'static str {
        Self::ALL.iter().find(|(function, ..)| *function == self).map_or("", |(_, name, _)| *name)
    }

    pub(crate) fn form(self) -> &'static str {
        Self::ALL.iter().find(|(function, ..)| *function == self).map_or("", |(.., form)| *form)
    }

    /// Number of arguments; those of `if` are the comparison and the two values.
    pub(crate) fn arity(self) -> usize {
        match self {
            Self::Min | Self::Max => 2,
            Self::Clamp | Self::If => 3,
            _ => 1,
        }
    }
}

/// A comparison, within `if` only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Comparison {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

impl Comparison {
    pub(crate) fn symbol(self) -> &'static str {
        match self {
            Self::Less => "<",
            Self::LessOrEqual => "<=",
            Self::Greater => ">",
            Self::GreaterOrEqual => ">=",
        }
    }

    pub(crate) fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Self::Less => left < right,
            Self::LessOrEqual => left <= right,
            Self::Greater => left > right,
            Self::GreaterOrEqual => left >= right,
        }
    }
}
