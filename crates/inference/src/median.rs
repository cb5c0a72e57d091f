//! The median.

/// The middle of some values, the upper one of two; reorders them. 0 of none.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Standard deviation of a normal x over the median of |x|.
pub(crate) const MAD_TO_SD: f64 = 1.482_602_218_505_602;
