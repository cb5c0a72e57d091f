//! Starts that fill a box evenly: the points of Halton's sequence with multiplied digits.
//!
//! J. H. Halton, *Numer. Math.* 2 (1960) 84. Digits `d` of base `b` become `w d mod b` (H. Chi, M. Mascagni, T. Warnock, *Math.
//! Comput. Simul.* 70 (2005) 9), here with `w` the whole part of `b` times the fractional part of `sqrt(b)`: neighbouring large
//! bases are then no longer in step.

use super::NotABox;
use super::residuals::Bounds;

/// `count` points inside a finite box, each of which fills the largest gaps between earlier ones; the points
/// are the same in every call. Fixed parameters keep their value.
///
/// # Errors
/// [`NotABox`] for infinite or crossed bounds.
pub fn starts_in_box(count: usize, bounds: &Bounds) -> Result<Vec<Vec<f64>>, NotABox> {
    let sides: Vec<(f64, f64)> = bounds.lower.iter().copied().zip(bounds.upper.iter().copied()).collect();
    for (parameter, (lower, upper)) in sides.iter().copied().enumerate() {
        if !(lower.is_finite() && upper.is_finite() && lower <= upper) {
            return Err(NotABox { parameter, lower, upper });
        }
    }
    let bases = primes(sides.len());
    let place = |index: usize, j: usize| {
        let ((lower, upper), part) = (sides[j], radical_inverse(index, bases[j]));
        // `lower + part (upper - lower)` would overflow in a box as wide as the number range.
        (lower * (1.0 - part) + upper * part).clamp(lower, upper)
    };
    Ok((1..=count).map(|index| (0..sides.len()).map(|j| place(index, j)).collect()).collect())
}

/// The first primes.
fn primes(count: usize) -> Vec<usize> {
    let mut primes: Vec<usize> = Vec::with_capacity(count);
    let mut candidate = 2;
    while primes.len() < count {
        if primes.iter().all(|p| candidate % p != 0) {
            primes.push(candidate);
        }
        candidate += 1;
    }
    primes
}

/// The digits of `index`, multiplied and mirrored at the radix point: in (0, 1) for a positive index.
fn radical_inverse(mut index: usize, base: usize) -> f64 {
    let multiplier = multiplier(base);
    let (mut sum, mut weight) = (0.0, 1.0);
    while index > 0 {
        weight /= base as f64;
        sum += weight * (multiplier * (index % base) % base) as f64;
        index /= base;
    }
    sum
}

/// The integer part of `b (sqrt(b) - floor(sqrt(b)))`, at least 1.
fn multiplier(base: usize) -> usize {
    // floor(sqrt(b^3)) - b floor(sqrt(b)), in integers.
    (base.pow(3).isqrt() - base * base.isqrt()).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_coordinate_visits_every_part_once() {
        let bounds = Bounds { lower: vec![-1.0, 0.0, 5.0, 7.0], upper: vec![1.0, 3.0, 10.0, 7.0] };
        let points = starts_in_box(30, &bounds).unwrap();
        for (j, base) in [2_u32, 3, 5].into_iter().enumerate() {
            // In five runs of `base` points each part of width 1/base holds five (point 0, the corner, is missing).
            let run = &points[..base as usize * 5 - 1];
            let (low, width) = (bounds.lower[j], (bounds.upper[j] - bounds.lower[j]) / f64::from(base));
            for part in 0..base {
                let edge = low + f64::from(part) * width - 1e-9;
                let hits = run.iter().filter(|p| p[j] > edge && p[j] < edge + width).count();
                assert_eq!(hits, if part == 0 { 4 } else { 5 }, "coordinate {j}, part {part}");
            }
        }
        assert!(points.iter().all(|p| p[3].to_bits() == 7.0_f64.to_bits()));
        assert_eq!(points, starts_in_box(30, &bounds).unwrap());
    }

    #[test]
    fn digits_are_multiplied_and_mirrored() {
        assert_eq!([2, 3, 5, 67, 71].map(multiplier), [1, 2, 1, 12, 30]);
        // 5 = 12 in base 3: digits 2, 1 become 1, 2: 1/3 + 2/9.
        assert!((radical_inverse(5, 3) - 5.0 / 9.0).abs() < 1e-15);
        assert_eq!(radical_inverse(6, 2).to_bits(), 0.375_f64.to_bits());
        assert_eq!(primes(12), [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37]);
    }

    #[test]
    fn fills_a_square_better_than_large_bases_do() {
        // Coordinates 19 and 20 (bases 67 and 71) of the plain sequence lie on a few lines; here a quarter of the square holds a
        // quarter of the points.
        let bounds = Bounds { lower: vec![0.0; 20], upper: vec![1.0; 20] };
        let points = starts_in_box(400, &bounds).unwrap();
        let quarter = points.iter().filter(|p| p[18] < 0.5 && p[19] < 0.5).count();
        assert!((80..=120).contains(&quarter), "{quarter}");
    }

    #[test]
    fn open_boxes_are_refused() {
        let open = Bounds { lower: vec![0.0, f64::NEG_INFINITY], upper: vec![1.0, 1.0] };
        let error = starts_in_box(3, &open).unwrap_err();
        assert_eq!(error, NotABox { parameter: 1, lower: f64::NEG_INFINITY, upper: 1.0 });
        assert!(error.to_string().ends_with("those of parameter 1 are [-inf, 1]"), "{error}");
    }
}
