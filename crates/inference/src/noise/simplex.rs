//! Minimum of a function of a few variables without derivatives: the downhill simplex (Nelder and Mead 1965),
//! within bounds.

/// Settings of a search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Search<'a> {
    /// Least and largest value of each variable; points beyond are moved to the bound.
    pub(crate) bounds: &'a [(f64, f64)],
    /// Size of the first simplex.
    pub(crate) step: f64,
    /// Most evaluations.
    pub(crate) evaluations: usize,
    /// Ends when the values at the corners differ by less.
    pub(crate) tolerance: f64,
}

/// Best point and its value. NaN counts as infinite.
pub(crate) fn minimise(
    mut function: impl FnMut(&[f64]) -> f64,
    start: &[f64],
    search: Search,
) -> (Vec<f64>, f64) {
    let mut left = search.evaluations;
    let mut at = |mut point: Vec<f64>| {
        for (x, (low, high)) in point.iter_mut().zip(search.bounds) {
            *x = x.max(*low).min(*high);
        }
        left = left.saturating_sub(1);
        let value = function(&point);
        (point, if value.is_nan() { f64::INFINITY } else { value }, left)
    };
    let mut corners = Vec::with_capacity(start.len() + 1);
    let (point, value, mut rest) = at(start.to_vec());
    corners.push((point, value));
    for i in 0..start.len() {
        let mut corner = corners[0].0.clone();
        // Step away from the bound if the corner would lie outside.
        let outside = corner[i] + search.step > search.bounds[i].1;
        corner[i] += if outside { -search.step } else { search.step };
        let (point, value, left) = at(corner);
        corners.push((point, value));
        rest = left;
    }
    let last = corners.len() - 1;
    loop {
        corners.sort_by(|a, b| a.1.total_cmp(&b.1));
        if rest == 0 || last == 0 || corners[last].1 - corners[0].1 < search.tolerance {
            return corners.swap_remove(0);
        }
        let centre: Vec<f64> = (0..start.len())
            .map(|i| corners[..last].iter().map(|c| c.0[i]).sum::<f64>() / last as f64)
            .collect();
        let along = |factor: f64| -> Vec<f64> {
            centre.iter().zip(&corners[last].0).map(|(c, w)| c + factor * (w - c)).collect()
        };
        let (outward, inward, further) = (along(-1.0), along(0.5), along(-2.0));
        let nearer = along(-0.5);
        let (point, value, left) = at(outward);
        rest = left;
        // The reflected point replaces the worst corner if it is better than the second worst.
        if value < corners[last - usize::from(last > 1)].1 && value >= corners[0].1 {
            corners[last] = (point, value);
            continue;
        }
        // Expansion if the reflection is the best point, else contraction outside or inside the simplex.
        let (tried, other, left) = at(if value < corners[0].1 {
            further
        } else if value < corners[last].1 {
            nearer
        } else {
            inward
        });
        rest = left;
        if other < value.min(corners[last].1) {
            corners[last] = (tried, other);
        } else if value < corners[last].1 {
            corners[last] = (point, value);
        } else {
            // Nothing helped: the simplex shrinks towards its best corner.
            for i in 1..corners.len() {
                let half = corners[0].0.iter().zip(&corners[i].0).map(|(best, x)| 0.5 * (best + x)).collect();
                let (point, value, left) = at(half);
                corners[i] = (point, value);
                rest = left;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(bounds: &[(f64, f64)]) -> Search<'_> {
        Search { bounds, step: 1.0, evaluations: 400, tolerance: 1e-12 }
    }

    #[test]
    fn the_banana_of_rosenbrock_ends_at_one() {
        let banana = |x: &[f64]| (1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2);
        let (point, value) = minimise(banana, &[-1.2, 1.0], search(&[(-5.0, 5.0); 2]));
        assert!(value < 1e-10 && (point[0] - 1.0).abs() < 1e-4, "{point:?} {value}");
    }

    /// Corners beside the start, and a start on its bound, whose corner lies inside.
    #[test]
    fn the_first_corners_lie_one_step_away_within_the_bounds() {
        let asked = std::cell::RefCell::new(Vec::new());
        let bowl = |x: &[f64]| {
            asked.borrow_mut().push(x.to_vec());
            x.iter().map(|x| x * x).sum()
        };
        let few =
            Search { bounds: &[(-5.0, 5.0), (-5.0, 2.0)], step: 0.5, evaluations: 400, tolerance: 1e-3 };
        minimise(bowl, &[1.0, 2.0], few);
        let asked = asked.into_inner();
        assert_eq!(asked[..3], [vec![1.0, 2.0], vec![1.5, 2.0], vec![1.0, 1.5]]);
        assert_eq!(asked.len(), 33);
    }

    #[test]
    fn bounds_hold_and_single_numbers_are_found() {
        let (point, _) = minimise(|x| (x[0] - 3.0).powi(2), &[0.0], search(&[(-1.0, 2.0)]));
        assert!((point[0] - 2.0).abs() < 1e-9, "{point:?}");
        let (point, _) = minimise(|x| (x[0] - 0.3).powi(2), &[0.0], search(&[(-1.0, 2.0)]));
        assert!((point[0] - 0.3).abs() < 1e-5, "{point:?}");
    }
}
