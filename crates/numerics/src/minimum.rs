//! The minimum of a function of one variable.

/// (sqrt(5) - 1)/2.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Golden section that starts from a place inside (or at an end of) a bracket and never loses the best one: the longer side of it is divided, and
/// what is worse becomes the new end, until the bracket is narrower than `enough`.
///
/// A place may be anything that `at` finds at a coordinate; `seen` gives its coordinate and its cost.
pub fn golden<P>(
    mut best: P,
    [mut low, mut high]: [f64; 2],
    enough: f64,
    seen: impl Fn(&P) -> (f64, f64),
    mut at: impl FnMut(f64) -> P,
) -> P {
    while high - low > enough {
        let (middle, least) = seen(&best);
        let upwards = high - middle > middle - low;
        let far = if upwards { high } else { low };
        let tried = at(far + GOLDEN * (middle - far));
        let (beyond, cost) = seen(&tried);
        let wins = cost < least;
        match (wins, upwards) {
            (true, true) => low = middle,
            (true, false) => high = middle,
            (false, true) => high = beyond,
            (false, false) => low = beyond,
        }
        if wins {
            best = tried;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_valley_from_inside_and_from_an_end() {
        for start in [0.0, 0.7, 1.0] {
            let at = |x: f64| (x, (x - 0.3).powi(2));
            let (x, cost) = golden(at(start), [0.0, 1.0], 1e-6, |place| *place, at);
            assert!((x - 0.3).abs() < 1e-6 && cost < 1e-12, "{x}");
        }
        // The least at an end is kept.
        assert_eq!(golden((0.0, 0.0), [0.0, 1.0], 1e-6, |place| *place, |x| (x, x)), (0.0, 0.0));
        // So is the first place where all others cost as much.
        assert_eq!(golden((0.4, 2.0), [0.0, 1.0], 1e-6, |place| *place, |x| (x, 2.0)), (0.4, 2.0));
    }
}
