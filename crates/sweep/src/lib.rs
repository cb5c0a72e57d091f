//! Parameter sweeps of pneumatic muscles, parallel and resumable, and certified tables built from them.

mod chunk;
mod design;
mod difference;
mod family;
mod family_error;
mod file;
mod folder;
mod holds;
mod member;
mod output;
mod permutation;
pub mod plan;
mod points;
mod run;
mod sobol;
mod table;

pub use chunk::{Chunk, Column, Computer};
pub use design::{Coordinate, Layout};
pub use family::Family;
pub use family_error::FamilyError;
pub use file::SWEEP_EXAMPLE;
pub use folder::ChunkManifest;
pub use member::Member;
pub use output::{Output, Variable};
pub use plan::Plan;
pub use points::{Points, Reason, Values, evaluate};
pub use run::{Piece, Progress, RunOptions, Summary, SweepError, begin, complete, manifest, piece, run};
pub use table::{
    AxisDescription, BuildError, Built, EncodeError, Field, FieldAxis, FieldOutput, JointField, JointOutput,
    JointTable, MuscleField, NoValue, OutputDescription, Requirements, TableDescription, TabulateError,
    build, export, table_text, tabulate,
};
