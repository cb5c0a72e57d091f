//! One check: the compared quantities, their difference, and its tolerance.

use std::error::Error;

/// Any error inside a check.
pub(crate) type Trouble = Box<dyn Error>;

/// A row of the verification table.
#[derive(Debug, Clone)]
pub struct Check {
    /// Part of the physics or the numerics that is checked.
    pub group: &'static str,
    /// The comparison.
    pub name: &'static str,
    /// Source of the expected values.
    pub source: &'static str,
    /// Largest error; infinite if something failed or was not a number.
    pub error: f64,
    /// Largest accepted error.
    pub tolerance: f64,
    /// Number of comparisons.
    pub cases: usize,
    /// Reason of the tolerance.
    pub why: &'static str,
    /// The case with the largest error, or the failure.
    pub worst: String,
}

impl Check {
    /// Whether something was compared and every error is within the tolerance.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.cases > 0 && self.error <= self.tolerance
    }
}

impl std::fmt::Display for Check {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let verdict = if self.passed() { "ok    " } else { "FAILED" };
        let Self { group, name, error, tolerance, cases, worst, .. } = self;
        write!(f, "{verdict} {error:8.1e} (<= {tolerance:.0e}) {cases:5}  {group}: {name} [{worst}]")
    }
}

/// A check before it is run.
pub(crate) struct Claim {
    pub(crate) group: &'static str,
    pub(crate) name: &'static str,
    pub(crate) source: &'static str,
    pub(crate) tolerance: f64,
    pub(crate) why: &'static str,
}

impl Claim {
    /// Runs the comparisons. If one of them fails, the error of the check is infinite.
    pub(crate) fn run(self, compare: impl FnOnce(&mut Tally) -> Result<(), Trouble>) -> Check {
        let mut tally = Tally { error: 0.0, cases: 0, worst: String::new() };
        if let Err(trouble) = compare(&mut tally) {
            tally.add(f64::INFINITY, || trouble.to_string());
        }
        let Self { group, name, source, tolerance, why } = self;
        let Tally { error, cases, worst } = tally;
        Check { group, name, source, error, tolerance, cases, why, worst }
    }
}

/// The largest of many errors.
pub(crate) struct Tally {
    error: f64,
    cases: usize,
    worst: String,
}

impl Tally {
    /// Adds one error. An error that is not a number counts as infinite.
    pub(crate) fn add(&mut self, error: f64, case: impl FnOnce() -> String) {
        let error = if error.is_nan() { f64::INFINITY } else { error.abs() };
        self.cases += 1;
        if error > self.error || self.worst.is_empty() {
            self.error = self.error.max(error);
            self.worst = case();
        }
    }

    /// Adds `got - expected` relative to the expected value.
    pub(crate) fn relative(&mut self, got: f64, expected: f64, case: impl FnOnce() -> String) {
        self.add((got - expected) / expected, case);
    }

    /// Adds `got - expected` relative to the larger of the expected value and `floor`.
    pub(crate) fn scaled(&mut self, got: f64, expected: f64, floor: f64, case: impl FnOnce() -> String) {
        self.add((got - expected) / expected.abs().max(floor.abs()), case);
    }

    /// Adds an absolute difference.
    pub(crate) fn absolute(&mut self, got: f64, expected: f64, case: impl FnOnce() -> String) {
        self.add(got - expected, case);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLAIM: fn() -> Claim =
        || Claim { group: "g", name: "n", source: "s", tolerance: 1e-3, why: "for the test" };

    fn one(got: f64) -> Check {
        CLAIM().run(|tally| {
            tally.relative(got, 1.0, String::new);
            Ok(())
        })
    }

    #[test]
    fn the_largest_error_decides() {
        let check = CLAIM().run(|tally| {
            tally.relative(1.0001, 1.0, || "small".into());
            tally.scaled(0.5, 0.0, 1000.0, || "larger".into());
            Ok(())
        });
        assert!(check.passed() && check.cases == 2 && check.worst == "larger");
        assert!(!one(1.1).passed());
    }

    #[test]
    fn failures_count() {
        let not_a_number = one(f64::NAN);
        let nothing = CLAIM().run(|_| Ok(()));
        let broken = CLAIM().run(|_| Err("no equilibrium at 0.47".into()));
        assert!(!not_a_number.passed() && !nothing.passed() && !broken.passed());
        assert!(broken.error.is_infinite() && broken.to_string().contains("0.47"));
    }
}
