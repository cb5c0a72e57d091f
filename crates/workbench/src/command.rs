//! The command line and the Python call that do the same as the page.

use bulge_report::Call;
use std::sync::Arc;

use crate::choices::Choices;
use crate::inputs::{self, Inputs};

/// What the files are called that the page offers to save.
const MUSCLE: &str = "muscle.toml";
const EFFECTS: &str = "effects.toml";

/// A file or a name as the command line has it.
fn muscle(choices: &Choices) -> &str {
    choices.muscle.origin.as_deref().unwrap_or(MUSCLE)
}

fn names(choices: &Choices) -> Vec<&str> {
    choices.effects.iter().map(|effect| effect.name.as_str()).collect()
}

/// The lines of the rows that were excluded by hand, as `--exclude` takes them.
fn excluded(choices: &Choices, inputs: Option<&Arc<Inputs>>) -> Option<String> {
    let inputs = inputs.filter(|_| !choices.excluded.is_empty())?;
    Some(inputs.data.line_ranges(&choices.excluded).join(","))
}

/// The numbers that are held, as `--hold` takes them.
fn held(choices: &Choices) -> Vec<String> {
    // Choices that name what there isn't were refused.
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
    let text = |value: &str| format!("{value:?}");
    let list = |values: &[&str]| match values {
        [one] => text(one),
        _ => format!("[{}]", values.iter().map(|value| text(value)).collect::<Vec<_>>().join(", ")),
    };
    let muscle = match &choices.muscle.origin {
        Some(name) if !name.contains(['.', '/', '\\']) => format!("bulge.Muscle.preset({})", text(name)),
        _ => format!("bulge.Muscle.from_toml({})", text(muscle(choices))),
    };
    let files: Vec<&str> = choices.data.iter().map(|file| file.name.as_str()).collect();
    let columns =
        choices.columns.as_ref().map_or_else(String::new, |columns| format!(", columns={}", text(columns)));
    let own = choices.own_effects.as_ref().map_or_else(String::new, |_| format!(", own={}", text(EFFECTS)));
    let with =
        if choices.effects.is_empty() { String::new() } else { format!(", {}", list(&names(choices))) };
    // What the package doesn't take yet is said, not left out.
    let lines = excluded(choices, inputs).map(|lines| format!("--exclude {lines}"));
    let held = held(choices).into_iter().map(|text| format!("--hold \"{text}\""));
    let untaken: Vec<String> = lines.into_iter().chain(held).collect();
    let untaken = if untaken.is_empty() {
        String::new()
    } else {
        format!("  # without {}: only the command has it", untaken.join(" "))
    };
    format!(
        "import bulge\nmuscle = {muscle}\ndata = bulge.read({}{columns}, muscle=muscle)\nprint(bulge.compare(data, muscle{with}{own})){untaken}",
        list(&files)
    )
}
