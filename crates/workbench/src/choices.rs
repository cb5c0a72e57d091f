//! What a person has chosen: everything that an answer depends on.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A file of measurements.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DataFile {
    /// What people call it.
    pub name: String,
    /// Where it lies.
    pub path: PathBuf,
}

/// A muscle: its file as text, and where that came from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MuscleFile {
    /// The TOML.
    pub toml: String,
    /// What a command line calls it: a path or the name of a shipped muscle; none once it was edited here.
    pub origin: Option<String>,
}

/// An effect that was switched on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChosenEffect {
    /// Its name in the catalogue.
    pub name: String,
}

/// All choices of a session at one time: undo goes back from one to the one before.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Choices {
    /// The measurements, one analysis.
    pub data: Vec<DataFile>,
    /// Which column is which, as `--columns` takes it.
    pub columns: Option<String>,
    /// The muscle.
    pub muscle: MuscleFile,
    /// Effects, in the order in which they were switched on.
    pub effects: Vec<ChosenEffect>,
    /// The user's own effects, as TOML.
    pub own_effects: Option<String>,
    /// Rows that were excluded by hand, in ascending order.
    pub excluded: Vec<usize>,
}

impl Choices {
    /// Whether the rows, the muscle or the catalogue differ: more than the effects that are switched on.
    pub(crate) fn needs_other_inputs(&self, other: &Self) -> bool {
        self.needs_other_data(other)
            || self.own_effects != other.own_effects
            || self.excluded != other.excluded
    }

    /// Whether the files must be read anew: how they are read depends on the muscle.
    pub(crate) fn needs_other_data(&self, other: &Self) -> bool {
        self.data != other.data || self.columns != other.columns || self.muscle.toml != other.muscle.toml
    }
}

/// A change of some of the choices; what isn't there stays.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Change {
    /// `null` takes the statement back.
    #[serde(default, deserialize_with = "present")]
    pub(crate) columns: Option<Option<String>>,
    pub(crate) muscle: Option<MuscleChange>,
    pub(crate) effects: Option<Vec<ChosenEffect>>,
    #[serde(default, deserialize_with = "present")]
    pub(crate) own_effects: Option<Option<String>>,
    pub(crate) excluded: Option<Vec<usize>>,
    pub(crate) view: Option<serde_json::Value>,
}

/// Another muscle: a shipped one by name, or a file.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub(crate) enum MuscleChange {
    Shipped { shipped: String },
    Toml { toml: String },
}

/// Tells a field that is `null` from one that isn't there.
fn present<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Option<Option<String>>, D::Error> {
    Option::deserialize(deserializer).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn null_takes_back_and_absence_leaves() {
        let change: Change = serde_json::from_str(r#"{"columns": null}"#).unwrap();
        assert!(change.columns == Some(None) && change.own_effects.is_none() && change.effects.is_none());
        let change: Change = serde_json::from_str(r#"{"columns": "force=F"}"#).unwrap();
        assert_eq!(change.columns.flatten().as_deref(), Some("force=F"));
        assert!(serde_json::from_str::<Change>(r#"{"column": "force=F"}"#).is_err());
        let change: Change = serde_json::from_str(r#"{"muscle": {"shipped": "ppam-1"}}"#).unwrap();
        assert!(matches!(change.muscle, Some(MuscleChange::Shipped { .. })));
    }
}
