//! Vectors of numbers: products, sums, ranges.

/// Number of marked rows.
pub(crate) fn count(mask: &[bool]) -> usize {
    mask.iter().filter(|is_marked| **is_marked).count()
}

/// Sum of the products of two series, over the length of the shorter one. Eight interleaved partial sums are
/// added at once.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let (mut a, mut b) = (a[..length].chunks_exact(8), b[..length].chunks_exact(8));
    let mut parts = [0.0; 8];
    for (a, b) in a.by_ref().zip(b.by_ref()) {
        for (part, (a, b)) in parts.iter_mut().zip(a.iter().zip(b)) {
            *part += a * b;
        }
    }
    parts.iter().sum::<f64>() + a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum::<f64>()
}

/// Length of a vector.
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Root mean square; 0 of nothing.
pub(crate) fn rms(values: &[f64]) -> f64 {
    (dot(values, values) / values.len().max(1) as f64).sqrt()
}

/// Adds a multiple of another vector.
pub(crate) fn add(sum: &mut [f64], factor: f64, vector: &[f64]) {
    for (total, value) in sum.iter_mut().zip(vector) {
        *total += factor * value;
    }
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

    #[test]
    fn the_longer_series_is_cut() {
        let a: Vec<f64> = (1..=19).map(f64::from).collect();
        let sum = |n: f64| n * (n + 1.0) * (2.0 * n + 1.0) / 6.0;
        for n in [0, 1, 7, 8, 9, 16, 19] {
            for (x, y) in [(&a[..n], &a[..]), (&a[..], &a[..n])] {
                assert!((dot(x, y) - sum(n as f64)).abs() < 1e-9, "{n}");
            }
        }
    }
}
