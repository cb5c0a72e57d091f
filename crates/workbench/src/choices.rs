//! The choices of a user: everything on which an answer depends.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A file of measurements.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DataFile {
    /// Its name for the user.
    pub name: String,
    /// Its path.
    pub path: PathBuf,
}

/// A muscle: its file as text, and the origin of the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MuscleFile {
    /// The TOML.
    pub toml: String,
    /// Its name on a command line: a path or the name of a shipped muscle; `None` once it was edited here.
    pub origin: Option<String>,
}

/// An effect that was switched on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChosenEffect {
    /// Its name in the catalogue.
    pub name: String,
    /// Fixed parameters, by name, with their values in the unit shown on the card of the effect. The others
    /// are fitted.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub hold: BTreeMap<String, f64>,
}

impl ChosenEffect {
    /// Each fixed parameter: effect, parameter, value in the unit shown on the card.
    pub(crate) fn held(&self) -> impl Iterator<Item = (&str, &str, f64)> {
        self.hold.iter().map(|(number, value)| (self.name.as_str(), number.as_str(), *value))
    }
}

/// All choices of a session at one time; undo returns to the previous ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Choices {
    /// The measurements of one analysis.
    pub data: Vec<DataFile>,
    /// Assignment of the columns, in the format of `--columns`.
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
    /// Whether the rows, the muscle or the catalogue differ, and not only the effects that are switched on.
    pub(crate) fn needs_other_inputs(&self, other: &Self) -> bool {
        self.needs_other_rows(other) || self.own_effects != other.own_effects
    }

    /// Whether the rows that count, or the muscle, differ.
    pub(crate) fn needs_other_rows(&self, other: &Self) -> bool {
        self.needs_other_data(other) || self.excluded != other.excluded
    }

    /// Whether the files must be read again: reading them depends on the muscle.
    pub(crate) fn needs_other_data(&self, other: &Self) -> bool {
        self.data != other.data || self.columns != other.columns || self.muscle.toml != other.muscle.toml
    }
}

/// A change of some of the choices; missing fields leave theirs unchanged.
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
    /// Whether it continues the previous change, as when a slider is being dragged: both are then one step of
    /// undo.
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

/// Change of an optional text: a missing field leaves it unchanged, `null` removes it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) enum Text {
    /// Unchanged.
    #[default]
    Left,
    /// A new text, or none.
    Is(Option<String>),
}

impl<'de> Deserialize<'de> for Text {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = Option::<String>::deserialize(deserializer)?;
        Ok(Self::Is(text.filter(|text| !text.trim().is_empty())))
    }
}

impl Text {
    /// Applies the change to the text in `place`.
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
