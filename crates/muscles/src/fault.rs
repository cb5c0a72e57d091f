//! Whose fault an error is: what a caller does about it.

/// What kind of answer an error is. Errors of all crates that compute say it of themselves, so that an exit status and an exception mean the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Fault {
    /// The input is wrong: write something else.
    Input,
    /// The question is right, and no solution exists.
    NoSolution,
    /// A solution may exist, and the search for it failed.
    NotConverged,
}
