//! A formula as its parts, operands before operators: a tree without pointers, so that nothing is ever recursive.

use bulge_muscles::Dimension;
use bulge_numerics::tape::{Comparison, Function, Operator};
use std::ops::Range;

/// One part of a formula. Its operands are the parts just before it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Node {
    pub(crate) part: Part,
    /// Its bytes in the text, with its operands.
    pub(crate) span: Range<usize>,
}

/// What it is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Part {
    /// A number in SI, the bytes of its digits and of its unit; without a unit it has no dimension.
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
    /// How many operands it has.
    pub(crate) fn arity(&self) -> usize {
        match self {
            Self::Number { .. } | Self::Pi | Self::Variable(_) | Self::Parameter(_) => 0,
            Self::Negate => 1,
            Self::Operate(_) | Self::Compare(_) => 2,
            Self::Call(function) => function.arity(),
        }
    }
}
