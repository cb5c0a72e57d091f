//! Equilibria at given contractions, whether the muscle pulls there or not.

use crate::FibreError;
use crate::closed_form;
use crate::outcome::{Approach, BURSTING, Scheme, Solution};
use crate::problem::Problem;
use crate::search::{FAR, Goal, Seen};
use crate::shape::Response;
use crate::shooting::USUAL;
use crate::solve::Found;

impl Problem {
    /// The equilibrium at a contraction even where the force is negative (the muscle would have to push): for
    /// fits and tables that must not end at the limit.
    ///
    /// # Errors
    /// See [`FibreError`].
    pub fn follow(&self, contraction: f64, approach: Approach) -> Result<Response, FibreError> {
        self.followed(self.scheme(approach)?, contraction, approach, None).map(|found| found.response)
    }

    /// [`Self::follow`] for many muscles, each at a contraction. Those with a closed form are solved four at a time. The
    /// answers are the same to the last bit.
    #[must_use]
    pub fn follow_each(asked: &[(&Self, f64)], approach: Approach) -> Vec<Result<Response, FibreError>> {
        let schemes: Vec<_> = asked.iter().map(|(problem, _)| problem.scheme(approach)).collect();
        let with_scheme = asked.iter().zip(&schemes).map(|((problem, contraction), scheme)| {
            scheme.as_ref().ok().and_then(|scheme| problem.asks_closed_form(*scheme, *contraction))
        });
        let solved = solved_together(with_scheme);
        let each = asked.iter().zip(schemes).zip(solved).map(|(((problem, contraction), scheme), solved)| {
            problem.followed(scheme?, *contraction, approach, solved).map(|found| found.response)
        });
        each.collect()
    }

    pub(crate) fn followed(
        &self,
        scheme: Scheme,
        contraction: f64,
        approach: Approach,
        solved: Option<Solution>,
    ) -> Result<Found, FibreError> {
        self.at_with(scheme, contraction, (solved, USUAL)).or_else(|error| {
            if !is_lost(&error) {
                return Err(error);
            }
            let error = match error {
                FibreError::Undulates { .. } => error,
                _ => self.within_limit(error, contraction, approach)?,
            };
            self.walked(scheme, contraction, false).ok_or(error)
        })
    }

    /// Explains an error beyond the limit, where a long braid or a soft one would bulge in more than one
    /// place and no equilibrium was found. The result names the limit; other errors stay the same. This takes
    /// a search for the limit.
    #[must_use]
    pub fn explained(&self, error: FibreError, contraction: f64, approach: Approach) -> FibreError {
        if !is_lost(&error) || matches!(error, FibreError::Undulates { .. }) {
            return error;
        }
        self.within_limit(error, contraction, approach).unwrap_or_else(|explained| explained)
    }

    /// The same error where there may be an equilibrium: before the limit, or where no limit was found. If fibres
    /// are soft, no limit means no equilibrium.
    ///
    /// # Errors
    /// What is told instead of it: that the contraction is beyond the limit, or that the fibres are too soft.
    pub(crate) fn within_limit(
        &self,
        error: FibreError,
        contraction: f64,
        approach: Approach,
    ) -> Result<FibreError, FibreError> {
        match self.range_end(approach) {
            Ok(end) if contraction > end.contraction() => Err(end.beyond(contraction)),
            Err(_) if matches!(error, FibreError::TooSoft { .. }) => Err(error),
            _ => Ok(error),
        }
    }

    /// The equilibrium at a contraction, step by step from where one is found, or from a path.
    pub(crate) fn walked(&self, scheme: Scheme, contraction: f64, must_pull: bool) -> Option<Found> {
        if let Some(found) =
            self.drawn_to(scheme, contraction).filter(|found| self.pulls(&found.response) || !must_pull)
        {
            return Some(found);
        }
        let start = self.contraction_start().min(contraction);
        let mut seen = Seen::NOTHING;
        let way = [start, FAR];
        let walked = self.root(scheme, way, &mut seen, |found| contraction - found.response.contraction);
        // Where a direct way is lost, halvings between equilibria on both sides may get there.
        let walked = walked.or_else(|_| {
            let side = |found: &Found| if found.response.contraction < contraction { 1.0 } else { -1.0 };
            let beside = self.root(scheme, way, &mut seen, side)?;
            self.at(scheme, contraction, beside.unknowns())
        });
        let walked = walked.ok().filter(|found| self.pulls(&found.response) || !must_pull);
        walked.or_else(|| self.on_a_path(scheme, Goal::Contraction(contraction), must_pull, &seen))
    }
}

/// Closed forms for what [`Problem::asks_closed_form`] tells of many questions. `None` where there is nothing to ask, and where none
/// was found: such a question explains itself on its own.
pub(crate) fn solved_together(asked: impl Iterator<Item = Option<[f64; 3]>>) -> Vec<Option<Solution>> {
    let asked: Vec<_> = asked.collect();
    let mut found = closed_form::solve_many(&asked.iter().flatten().copied().collect::<Vec<_>>()).into_iter();
    let one = |asked: Option<[f64; 3]>| asked.and_then(|_| found.next()?.ok()).map(Solution::ClosedForm);
    asked.into_iter().map(one).collect()
}

/// The softness from which on a braid that isn't found at once isn't walked to: random ones whose gas acts at the fibres
/// pull up to 0.47.
const SOFTEST: f64 = 0.5;

/// Whether a search ended without an equilibrium, where another way may lead to one.
pub(crate) fn is_lost(error: &FibreError) -> bool {
    match error {
        FibreError::NotConverged { .. } | FibreError::Undulates { .. } => true,
        FibreError::TooSoft { group, limit } => *limit <= BURSTING && *group < SOFTEST,
        _ => false,
    }
}
