//! Roots of a function of one variable: Newton's method within a bracket.

/// A root could not be found.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RootError<E> {
    /// The function itself failed.
    #[error("{0}")]
    Function(E),
    /// The evaluation limit was reached.
    #[error("no root to the asked accuracy in [{low}, {high}]: at {at} the function is {value:e}")]
    Budget {
        /// Lower end of the last bracket.
        low: f64,
        /// Upper end of the last bracket.
        high: f64,
        /// Last iterate.
        at: f64,
        /// Function value there.
        value: f64,
    },
}

/// Root of a function that is positive at `low` and negative at `high`, from `start`, by Newton steps with
/// bisection as fallback.
///
/// `f` returns value and derivative. The ends are not evaluated: the caller guarantees their signs. Ends when
/// a Newton step is shorter than `absolute + relative |x|`, so that its end is far more accurate than that,
/// when the value is zero, or when the bracket contains no further number.
///
/// # Errors
/// [`RootError::Function`] with the error of `f`, or [`RootError::Budget`] after 100 evaluations.
pub fn newton_bracketed<E>(
    mut f: impl FnMut(f64) -> Result<(f64, f64), E>,
    mut low: f64,
    mut high: f64,
    start: f64,
    [absolute, relative]: [f64; 2],
) -> Result<f64, RootError<E>> {
    let mut x = start.clamp(low, high);
    let mut value = f64::NAN;
    for _ in 0..100 {
        let (y, dy) = f(x).map_err(RootError::Function)?;
        value = y;
        if y == 0.0 {
            return Ok(x);
        }
        if y > 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - y / dy;
        let inside = newton > low && newton < high;
        if (newton - x).abs() <= absolute + relative * x.abs() {
            return Ok(if inside { newton } else { x });
        }
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return Ok(middle);
        }
        x = if inside { newton } else { middle };
    }
    Err(RootError::Budget { low, high, at: x, value })
}

/// Root of a continuous function with a sign change in \[`low`, `high`\] by the Illinois variant of regula
/// falsi, to `tolerance` in the variable, with at most 60 evaluations. Without a sign change, the end with
/// the smaller absolute value is returned.
///
/// For starting values, where an approximate answer is better than an error.
pub fn illinois(mut f: impl FnMut(f64) -> f64, low: f64, high: f64, tolerance: f64) -> f64 {
    let (mut a, mut b) = (low, high);
    let (mut fa, mut fb) = (f(a), f(b));
    if fa * fb > 0.0 {
        return if fa.abs() < fb.abs() { a } else { b };
    }
    for _ in 0..60 {
        let c = (a * fb - b * fa) / (fb - fa);
        if !c.is_finite() {
            return 0.5 * (a + b);
        }
        let fc = f(c);
        if fc == 0.0 || (b - a).abs() < tolerance {
            return c;
        }
        if fc * fb < 0.0 {
            (a, fa) = (b, fb);
        } else {
            fa *= 0.5;
        }
        (b, fb) = (c, fc);
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn newton_finds_a_steep_root_and_keeps_inside() {
        // 1/sqrt(x) - 10 on (0, 1): plain Newton from 0.9 jumps to a negative x.
        let mut seen = Vec::new();
        let f = |x: f64| {
            seen.push(x);
            Ok::<_, Infallible>((1.0 / x.sqrt() - 10.0, -0.5 * x.powf(-1.5)))
        };
        let root = newton_bracketed(f, 0.0, 1.0, 0.9, [1e-12, 0.0]).unwrap();
        assert!((root - 0.01).abs() < 1e-15);
        assert!(seen.iter().all(|x| *x > 0.0 && *x < 1.0) && seen.len() < 30);
    }

    /// A jump has no zero: what is returned is a number next to it.
    #[test]
    fn newton_ends_at_a_jump() {
        let jump = |x: f64| Ok::<_, Infallible>((if x < 0.3 { 1.0 } else { -1.0 }, 0.0));
        let found = newton_bracketed(jump, 0.0, 1.0, 0.5, [0.0, 0.0]).unwrap();
        assert!((found - 0.3).abs() < 1e-15, "{found}");
    }

    #[test]
    fn newton_passes_errors_on() {
        let failing = |_: f64| Err::<(f64, f64), _>("no");
        assert_eq!(newton_bracketed(failing, 0.0, 1.0, 0.5, [1e-9, 0.0]), Err(RootError::Function("no")));
    }

    /// A straight line takes one step; an end that stays where it is costs no more than that its value is halved.
    #[test]
    fn illinois_takes_few_steps() {
        let steps = |f: fn(f64) -> f64, tolerance: f64| {
            let mut count = 0;
            let mut counted = |x| {
                count += 1;
                f(x)
            };
            let root = illinois(&mut counted, 0.0, 2.0, tolerance);
            (root, count)
        };
        assert_eq!(steps(|x| 4.0 * x - 2.0, 1e-12), (0.5, 3));
        // Where it is zero at both ends nothing is known.
        assert_eq!(steps(|_| 0.0, 1e-12), (1.0, 2));
        let (root, count) = steps(|x| x * x * x - 0.5, 1e-12);
        assert!((root.powi(3) - 0.5).abs() < 1e-14 && count <= 17, "{root}: {count}");
    }

    #[test]
    fn illinois_finds_a_flat_root() {
        let root = illinois(|x| x.powi(5) - 1e-5, 0.0, 2.0, 1e-10);
        assert!((root - 0.1).abs() < 1e-8);
        assert!((illinois(|x| x + 1.0, 0.0, 2.0, 1e-10) - 0.0).abs() < f64::EPSILON);
    }
}
