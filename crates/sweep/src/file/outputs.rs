//! The outputs of a sweep file.

use bulge_muscles::settings::{Setting, Settings, nearest, shortened};
use bulge_muscles::{FileError, Parameter};

use crate::output::{Output, Variable};

/// The outputs that a table of the file names, if it does; `has` says which numbers the muscle has.
pub(super) fn outputs(
    settings: &Settings<'_>,
    has: &dyn Fn(Parameter) -> bool,
) -> Result<Option<Vec<Output>>, FileError> {
    let Some(value) = settings.get("outputs") else { return Ok(None) };
    let refused = |value: Setting<'_>| settings.wrong_type("outputs", value, "a list of names in quotes");
    let items = value.items().ok_or_else(|| refused(value))?;
    let mut outputs = vec![];
    for item in items {
        let name = item.text().ok_or_else(|| refused(item))?;
        let output = Output::named(name).ok_or_else(|| unknown(settings, item, name))?;
        if outputs.contains(&output) {
            let what = format!("the output `{name}` is named twice");
            return Err(settings.error(item.span(), what, "delete one of the two"));
        }
        if let Output::ForceBy(variable) | Output::VolumeBy(variable) = output
            && let Variable::Parameter(parameter) = variable
            && !has(parameter)
        {
            let what = format!("`{name}` is a derivative by a number that this muscle doesn't have");
            let instead = format!("delete it, or name a muscle with `{}`", parameter.key());
            return Err(settings.error(item.span(), what, instead));
        }
        outputs.push(output);
    }
    if outputs.is_empty() {
        let what = "at least one output is needed";
        return Err(settings.unreadable("outputs", value, what));
    }
    Ok(Some(outputs))
}

fn unknown(settings: &Settings<'_>, item: Setting<'_>, name: &str) -> FileError {
    let names: Vec<String> = Output::all().map(Output::name).collect();
    let instead = match nearest(name, names.iter().map(String::as_str)) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!(
            "known are {}, force_by_ and volume_by_ with `pressure` or a number of the muscle",
            Output::PLAIN.map(Output::name).join(", ")
        ),
    };
    settings.error(item.span(), format!("unknown output `{}`", shortened(name)), instead)
}
