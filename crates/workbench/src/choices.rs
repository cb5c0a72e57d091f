//! What a person has chosen: everything that an answer depends on.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChosenEffect {
    /// Its name in the catalogue.
    pub name: String,
    /// Numbers that are held, by name, with their values in the unit that its card shows; the others are fitted.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub hold: BTreeMap<String, f64>,
}

impl ChosenEffect {
    /// Each number that is held: effect, number, value in the unit that the card shows.
    pub(crate) fn held(&self) -> impl Iterator<Item = (&str, &str, f64)> {
        self.hold.iter().map(|(number, value)| (self.name.as_str(), number.as_str(), *value))
    }
}

/// All choices of a session at one time: undo goes back from one to the one before.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
        self.needs_other_rows(other) || self.own_effects != other.own_effects
    }

    /// Whether the rows that count, or the muscle, differ.
    pub(crate) fn needs_other_rows(&self, other: &Self) -> bool {
        self.needs_other_data(other) || self.excluded != other.excluded
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
    #[serde(default)]
    pub(crate) columns: Text,
    pub(crate) muscle: Option<MuscleChange>,
    pub(crate) effects: Option<Vec<ChosenEffect>>,
    #[serde(default)]
    pub(crate) own_effects: Text,
    pub(crate) excluded: Option<Vec<usize>>,
    pub(crate) view: Option<serde_json::Value>,
    /// Whether it goes on with the change before it, as a slider does that is still held: both are one step then.
    #[serde(default)]
    pub(crate) goes_on: bool,
}

/// Another muscle: a shipped one by name, or a file.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub(crate) enum MuscleChange {
    Shipped { shipped: String },
    Toml { toml: String },
}

/// A text that may be stated: a field that isn't there leaves it, `null` takes it back.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) enum Text {
    /// As it was.
    #[default]
    Left,
    /// Stated, or taken back.
    Is(Option<String>),
}

impl<'de> Deserialize<'de> for Text {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = Option::<String>::deserialize(deserializer)?;
        Ok(Self::Is(text.filter(|text| !text.trim().is_empty())))
    }
}

impl Text {
    /// Puts it in the place of what was stated.
    pub(crate) fn put(self, place: &mut Option<String>) {
        if let Self::Is(text) = self {
            *place = text;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn null_takes_back_and_absence_leaves() {
        let change: Change = serde_json::from_str(r#"{"columns": null}"#).unwrap();
        assert!(
            change.columns == Text::Is(None) && change.own_effects == Text::Left && change.effects.is_none()
        );
        let change: Change = serde_json::from_str(r#"{"columns": "force=F"}"#).unwrap();
        assert_eq!(change.columns, Text::Is(Some("force=F".to_owned())));
        assert!(serde_json::from_str::<Change>(r#"{"column": "force=F"}"#).is_err());
        let change: Change = serde_json::from_str(r#"{"muscle": {"shipped": "ppam-1"}}"#).unwrap();
        assert!(matches!(change.muscle, Some(MuscleChange::Shipped { .. })));
    }
}
