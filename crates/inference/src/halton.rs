//! Starting points that fill a box evenly and are always the same: Halton's sequence.

const PRIMES: [usize; 40] = [
    2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89, 97, 101, 103,
    107, 109, 113, 127, 131, 137, 139, 149, 151, 157, 163, 167, 173,
];

/// Coordinate `axis` of point `number` (from 1) in the unit cube.
pub(crate) fn halton(number: usize, axis: usize) -> f64 {
    let base = PRIMES[axis % PRIMES.len()];
    let (mut rest, mut part, mut sum) = (number, 1.0, 0.0);
    while rest > 0 {
        part /= base as f64;
        sum += part * (rest % base) as f64;
        rest /= base;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_points() {
        let first = [1, 2, 3, 4].map(|n| halton(n, 0)).map(f64::to_bits);
        assert_eq!(first, [0.5, 0.25, 0.75, 0.125].map(f64::to_bits));
        assert!((halton(5, 1) - (2.0 / 3.0 + 1.0 / 9.0)).abs() < 1e-15);
    }
}
