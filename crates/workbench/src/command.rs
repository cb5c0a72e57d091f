//! The command line and the Python call that are equivalent to the page.

use bulge_report::Call;
use std::sync::Arc;

use crate::choices::Choices;
use crate::inputs::{self, Inputs};

/// Names of the files that the page offers to save.
const MUSCLE: &str = "muscle.toml";
const EFFECTS: &str = "effects.toml";

/// The muscle as given on the command line: a file or a name.
fn muscle(choices: &Choices) -> &str {
    choices.muscle.origin.as_deref().unwrap_or(MUSCLE)
}

fn names(choices: &Choices) -> Vec<&str> {
    choices.effects.iter().map(|effect| effect.name.as_str()).collect()
}

/// The lines of the rows excluded by hand, in the format of `--exclude`.
fn excluded(choices: &Choices, inputs: Option<&Arc<Inputs>>) -> Option<String> {
    let inputs = inputs.filter(|_| !choices.excluded.is_empty())?;
    Some(inputs.data.line_ranges(&choices.excluded).join(","))
}

/// The fixed parameters, in the format of `--hold`.
fn held(choices: &Choices) -> Vec<String> {
    // Choices with unknown effects were already refused.
    let catalogue = inputs::catalogue(choices.own_effects.as_deref());
    catalogue.and_then(|catalogue| inputs::held(&choices.effects, &catalogue)).unwrap_or_default()
}

/// `bulge compare ...`
pub(crate) fn shell(choices: &Choices, inputs: Option<&Arc<Inputs>>) -> String {
    let call = Call {
        data: choices.data.iter().map(|file| file.name.clone()).collect(),
        columns: choices.columns.clone(),
        exclude: excluded(choices, inputs),
        muscle: muscle(choices).to_owned(),
        effects: choices.own_effects.as_ref().map(|_| EFFECTS.to_owned()),
        with: names(choices).into_iter().map(str::to_owned).collect(),
        restrictions: held(choices).into_iter().map(|text| ("--hold", text)).collect(),
    };
    format!("bulge compare {}", call.arguments())
}

/// `bulge.compare(...)`
pub(crate) fn python(choices: &Choices, inputs: Option<&Arc<Inputs>>) -> String {
    let list = |values: &[&str]| match values {
        [one] => text(one),
        _ => format!("[{}]", values.iter().map(|value| text(value)).collect::<Vec<_>>().join(", ")),
    };
    let muscle = match &choices.muscle.origin {
        Some(name) if !name.contains(['.', '/', '\\']) => format!("bulge.Muscle.preset({})", text(name)),
        _ => format!("bulge.Muscle.from_toml({})", text(muscle(choices))),
    };
    let files: Vec<&str> = choices.data.iter().map(|file| file.name.as_str()).collect();
    let columns = keyword("columns", choices.columns.as_deref().map(text));
    let with =
        if choices.effects.is_empty() { String::new() } else { format!(", {}", list(&names(choices))) };
    let own = keyword("own", choices.own_effects.as_ref().map(|_| text(EFFECTS)));
    let exclude = keyword("exclude", excluded(choices, inputs).map(|lines| text(&lines)));
    let held = held(choices);
    let held: Vec<String> = (held.iter().filter_map(|stated| stated.split_once('=')))
        .map(|(number, value)| format!("{}: {}", text(number), text(value)))
        .collect();
    let hold = keyword("hold", (!held.is_empty()).then(|| format!("{{{}}}", held.join(", "))));
    format!(
        "import bulge\nmuscle = {muscle}\ndata = bulge.read({}{columns}, muscle=muscle)\nprint(bulge.compare(data, muscle{with}{own}{exclude}{hold}))",
        list(&files)
    )
}

/// A text as a Python literal; the escapes of JSON are a subset of those of Python.
fn text(value: &str) -> String {
    serde_json::Value::from(value).to_string()
}

/// A further keyword argument, if it has a value.
fn keyword(name: &str, value: Option<String>) -> String {
    value.map_or_else(String::new, |value| format!(", {name}={value}"))
}
