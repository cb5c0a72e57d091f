//! The median.

/// The median of some values, the upper one of the two in the middle; 0 without values. Reorders the values.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Ratio of the standard deviation of a normal variable x to the median of |x|.
pub(crate) const MAD_TO_SD: f64 = 1.482_602_218_505_602;

/// Standard deviation of normal values around 0 by their median size, whatever a few of them are.
pub(crate) fn robust_sd(values: &[f64]) -> f64 {
    MAD_TO_SD * median(&mut values.iter().map(|value| value.abs()).collect::<Vec<_>>())
}
