//! Parallel, resumable parameter sweeps of pneumatic muscles, and certified tables from them.

mod certified;
mod chunk;
mod design;
mod difference;
pub mod export;
mod family;
mod family_error;
mod file;
mod folder;
mod joint;
mod muscle_field;
mod output;
mod permutation;
pub mod plan;
mod points;
mod run;
mod sobol;
mod tabulate;

pub use certified::{
    BuildError, Built, EncodeError, Field, FieldAxis, FieldOutput, NoValue, Requirements, build,
};
pub use chunk::{Chunk, Column, Computer};
pub use design::{Coordinate, Layout};
pub use family::{Family, Member};
pub use family_error::FamilyError;
pub use file::SWEEP_EXAMPLE;
pub use folder::ChunkManifest;
pub use joint::{
    Closed, Drive, FourBar, JOINT_EXAMPLE, Joint, JointError, JointField, JointMuscle, JointOutput,
    JointState, Linkage, Outside, Readings, Side, SideState,
};
pub use muscle_field::MuscleField;
pub use output::{Output, Variable};
pub use plan::Plan;
pub use points::{Points, Reason, Values, evaluate};
pub use run::{Piece, Progress, RunOptions, Summary, SweepError, begin, complete, manifest, piece, run};
pub use tabulate::{
    AxisDescription, OutputDescription, TableDescription, TabulateError, table_text, tabulate,
};
