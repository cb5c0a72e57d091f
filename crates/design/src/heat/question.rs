//! The question of a cool muscle: inner pipes to compare. Its answer is a JSON document.

use bulge_muscles::units::significant;
use serde::Serialize;

use super::{HeatError, HeatProblem, HeatSolution, Pipe, trend};
use crate::question::{Lines, QuestionError};

/// Most pipes in one question.
const MOST_PIPES: usize = 100;

/// A muscle that is charged again and again, with each of some pipes.
#[derive(Debug, Clone)]
pub struct HeatQuestion {
    /// The muscle and its drive; its own pipe is left out of account.
    pub problem: HeatProblem,
    /// The pipes to compare; `None` is no pipe.
    pub pipes: Vec<Option<Pipe>>,
}

/// Answer to a [`HeatQuestion`].
#[derive(Debug, Clone)]
pub struct HeatAnswer {
    /// The question.
    pub question: HeatQuestion,
    /// The solution for each pipe, or why there is none.
    pub solved: Vec<Result<HeatSolution, HeatError>>,
}

/// The JSON document of an answer.
#[derive(Debug, Serialize)]
pub struct HeatDocument<'a> {
    schema: &'static str,
    problem: &'a HeatProblem,
    cases: Vec<Case<'a>>,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Case<'a> {
    Solved { pipe: Option<&'a Pipe>, solution: &'a HeatSolution },
    Refused { pipe: Option<&'a Pipe>, why: String },
}

impl HeatQuestion {
    /// Answers it.
    ///
    /// # Errors
    /// There are too many pipes, or no case has a solution: then the error of the first.
    pub fn answer(self) -> Result<HeatAnswer, QuestionError<HeatError>> {
        if self.pipes.len() > MOST_PIPES {
            let what = format!("{} pipes: at most {MOST_PIPES} in one call", self.pipes.len());
            return QuestionError::part("pipe", what);
        }
        let solved = trend(&self.problem, &self.pipes);
        match solved.first() {
            Some(Err(error)) if solved.iter().all(Result::is_err) => Err(error.clone().into()),
            _ => Ok(HeatAnswer { question: self, solved }),
        }
    }
}

/// A pipe in a few words.
#[must_use]
pub fn pipe_name(pipe: Option<&Pipe>) -> String {
    pipe.map_or("none".to_owned(), |pipe| {
        format!(
            "{} x {} mm",
            significant(1e3 * pipe.length_m, 3),
            significant(1e3 * pipe.inner_diameter_m, 2)
        )
    })
}

impl HeatAnswer {
    /// Each pipe with its solution.
    pub fn cases(&self) -> impl Iterator<Item = (Option<&Pipe>, &Result<HeatSolution, HeatError>)> {
        self.question.pipes.iter().map(Option::as_ref).zip(&self.solved)
    }

    /// The JSON document.
    #[must_use]
    pub fn document(&self) -> HeatDocument<'_> {
        let cases = self.cases().map(|(pipe, solved)| match solved {
            Ok(solution) => Case::Solved { pipe, solution },
            Err(error) => Case::Refused { pipe, why: error.to_string() },
        });
        HeatDocument { schema: "bulge.heat/1", problem: &self.question.problem, cases: cases.collect() }
    }

    /// The mean temperature of the wall along the muscle.
    #[must_use]
    pub fn drawing(&self) -> Lines {
        let ambient = self.question.problem.surroundings.ambient_k;
        let mut lines = Vec::new();
        for (pipe, found) in self.cases().filter_map(|(pipe, found)| Some((pipe, found.as_ref().ok()?))) {
            let places = found.muscle.x_m.iter().zip(&found.muscle.wall_mean_k);
            let points = places.map(|(x, wall)| [1e3 * x, wall - ambient]).collect();
            lines.push((pipe_name(pipe), points));
        }
        let title = "wall above the ambient, by inner pipe".to_owned();
        Lines { title, axes: ["from the inlet [mm]", "rise [K]"], lines }
    }
}
