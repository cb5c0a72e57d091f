//! Whose fault an error is, so that a caller knows what to do about it.

/// The kind of answer that an error is. Errors of all crates that compute state it, so that an exit status
/// and an exception mean the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Fault {
    /// The input is wrong: write something else.
    Input,
    /// The question is right, and no solution exists.
    NoSolution,
    /// A solution may exist, and the search for it failed.
    NotConverged,
}
