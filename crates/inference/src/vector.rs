//! Vectors of numbers: differences, means, ranges.

use bulge_numerics::vector::dot;

/// Number of marked rows.
pub(crate) fn count(mask: &[bool]) -> usize {
    mask.iter().filter(|is_marked| **is_marked).count()
}

/// Root mean square; 0 of nothing.
pub(crate) fn rms(values: &[f64]) -> f64 {
    (dot(values, values) / values.len().max(1) as f64).sqrt()
}

/// Difference of two vectors, such as measured less modelled forces.
pub(crate) fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// A log evidence to three decimals, to sort by: effects that are the same on the data at hand differ by what fits are exact
/// to, and stay in their order.
pub(crate) fn coarse(value: f64) -> f64 {
    (1e3 * value).round()
}

/// Least and largest value; infinite with the signs turned over if there is none.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_by_little_stays_in_its_order() {
        let mut values = [0.3, 0.1 + 0.2, -2.0, 0.1 + 0.2 - 1e-5, 0.302];
        values.sort_by(|a, b| coarse(*b).total_cmp(&coarse(*a)));
        assert_eq!(
            values.map(f64::to_bits),
            [0.302, 0.3, 0.1 + 0.2, 0.1 + 0.2 - 1e-5, -2.0].map(f64::to_bits)
        );
    }
}
