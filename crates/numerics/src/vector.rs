//! Vectors of numbers.

/// Scalar product over the length of the shorter vector, summed in eight interleaved parts (for vector instructions) in an
/// order that only depends on that length.
#[must_use]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let (mut a, mut b) = (a[..length].chunks_exact(8), b[..length].chunks_exact(8));
    let mut parts = [0.0; 8];
    for (a, b) in a.by_ref().zip(b.by_ref()) {
        for i in 0..8 {
            parts[i] += a[i] * b[i];
        }
    }
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    ((parts[0] + parts[4]) + (parts[1] + parts[5])) + ((parts[2] + parts[6]) + (parts[3] + parts[7])) + rest
}

/// Euclidean norm.
#[must_use]
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Adds a multiple of another vector, over the length of the shorter one.
pub fn add(sum: &mut [f64], factor: f64, vector: &[f64]) {
    for (total, value) in sum.iter_mut().zip(vector) {
        *total += factor * value;
    }
}

/// `a - b`.
#[must_use]
pub fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longer_vector_is_cut() {
        let a: Vec<f64> = (1..=19).map(f64::from).collect();
        let b: Vec<f64> = a.iter().map(|i| i + 2.0).collect();
        // Sums of integers are exact.
        let sum = |n: f64| n * (n + 1.0) * (2.0 * n + 1.0) / 6.0 + n * (n + 1.0);
        for n in [0, 1, 7, 8, 9, 16, 19] {
            for (x, y) in [(&a[..n], &b[..]), (&a[..], &b[..n])] {
                assert_eq!(dot(x, y).to_bits(), sum(n as f64).to_bits(), "{n}");
                let mut added = x.to_vec();
                add(&mut added, 2.0, y);
                let expected = |i: usize| if i < n { 3.0 * a[i] + 4.0 } else { a[i] };
                assert!(added.iter().enumerate().all(|(i, value)| (value - expected(i)).abs() < 1e-12));
            }
        }
        assert_eq!(norm(&[3.0, 4.0]).to_bits(), 5.0_f64.to_bits());
    }

    #[test]
    fn the_order_of_the_sum_is_that_of_eight_parts() {
        let a: Vec<f64> = (0..19).map(|i| (1.7 * f64::from(i)).sin() * 10.0_f64.powi(i % 7)).collect();
        let b: Vec<f64> = a.iter().map(|x| x.cos()).collect();
        let part = |i: usize| a[i] * b[i] + a[i + 8] * b[i + 8];
        let pair = |i: usize| part(i) + part(i + 4);
        let rest = a[16] * b[16] + a[17] * b[17] + a[18] * b[18];
        let sum = (pair(0) + pair(1)) + (pair(2) + pair(3)) + rest;
        assert_eq!(dot(&a, &b).to_bits(), sum.to_bits());
    }
}
