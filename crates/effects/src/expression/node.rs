//! The parts of a formula, with operands before operators. This is a tree without pointers, so nothing is
//! recursive.

use bulge_muscles::Dimension;
use bulge_numerics::tape::{Comparison, Function, Operator};
use std::ops::Range;

/// One part of a formula. Its operands are the parts directly before it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Node {
    pub(crate) part: Part,
    /// The bytes of the part in the text, including its operands.
    pub(crate) span: Range<usize>,
}

/// The kind of a part.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Part {
    /// A number in SI, with the bytes of its digits and of its unit. Without a unit it has no dimension.
    Number {
        si: f64,
        dimension: Dimension,
        digits: Range<usize>,
        unit: Option<Range<usize>>,
    },
    /// The number pi.
    Pi,
    Variable(usize),
    Parameter(usize),
    Negate,
    Operate(Operator),
    Compare(Comparison),
    Call(Function),
}

impl Part {
    /// The number of operands.
    pub(crate) fn arity(&self) -> usize {
        match self {
            Self::Number { .. } | Self::Pi | Self::Variable(_) | Self::Parameter(_) => 0,
            Self::Negate => 1,
            Self::Operate(_) | Self::Compare(_) => 2,
            Self::Call(function) => function.arity(),
        }
    }
}
