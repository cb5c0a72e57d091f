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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_robust_deviation_is_that_of_a_normal_variable_whatever_a_few_values_are() {
        // Quantiles of a standard normal variable, a tenth of them replaced by anything.
        let normal = |part: f64| std::f64::consts::SQRT_2 * statrs::function::erf::erf_inv(2.0 * part - 1.0);
        let mut values: Vec<f64> = (0..10_000).map(|i| normal((f64::from(i) + 0.5) / 10_000.0)).collect();
        assert!((robust_sd(&values) - 1.0).abs() < 1e-3);
        values.iter_mut().step_by(10).for_each(|value| *value = 1e6);
        assert!(robust_sd(&values) < 1.2);
    }
}
