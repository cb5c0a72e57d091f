//! The outputs of a sweep file.

use bulge_muscles::settings::{Setting, Settings, nearest};
use bulge_muscles::shown::shortened;
use bulge_muscles::{FileError, Parameter};

use crate::output::{Output, Variable};

/// The outputs that the file names, if it names any; `has` tells whether the muscle has a parameter.
pub(super) fn outputs(
    settings: &Settings<'_>,
    has: &dyn Fn(Parameter) -> bool,
) -> Result<Option<Vec<Output>>, FileError> {
    listed(settings, |item, name| {
        let output = Output::named(name).ok_or_else(|| {
            let names: Vec<String> = Output::all().map(Output::name).collect();
            let plain = Output::PLAIN.map(Output::name).join(", ");
            let known =
                format!("{plain}, force_by_ and volume_by_ with `pressure` or a number of the muscle");
            unknown(settings, item, name, names.iter().map(String::as_str), &known)
        })?;
        if let Output::ForceBy(variable) | Output::VolumeBy(variable) = output
            && let Variable::Parameter(parameter) = variable
            && !has(parameter)
        {
            let what = format!("`{name}` is a derivative by a number that this muscle doesn't have");
            let instead = format!("delete it, or name a muscle with `{}`", parameter.key());
            return Err(settings.error(item.span(), what, instead));
        }
        Ok(output)
    })
}

/// The list of outputs in a table of a file, if there is one. Each may be named once.
pub(crate) fn listed<'a, T: PartialEq>(
    settings: &Settings<'a>,
    named: impl Fn(Setting<'a>, &str) -> Result<T, FileError>,
) -> Result<Option<Vec<T>>, FileError> {
    let Some(value) = settings.get("outputs") else { return Ok(None) };
    let refused = |value: Setting<'_>| settings.wrong_type("outputs", value, "a list of names in quotes");
    let items = value.items().ok_or_else(|| refused(value))?;
    let mut outputs = vec![];
    for item in items {
        let name = item.text().ok_or_else(|| refused(item))?;
        let output = named(item, name)?;
        if outputs.contains(&output) {
            let what = format!("the output `{name}` is named twice");
            return Err(settings.error(item.span(), what, "delete one of the two"));
        }
        outputs.push(output);
    }
    if outputs.is_empty() {
        return Err(settings.unreadable("outputs", value, "at least one output is needed"));
    }
    Ok(Some(outputs))
}

/// The error for a name that no output has.
pub(crate) fn unknown<'n>(
    settings: &Settings<'_>,
    item: Setting<'_>,
    name: &str,
    names: impl Iterator<Item = &'n str>,
    known: &str,
) -> FileError {
    let near = nearest(name, names);
    let instead = near.map_or_else(|| format!("known are {known}"), |near| format!("did you mean `{near}`?"));
    settings.error(item.span(), format!("unknown output `{}`", shortened(name)), instead)
}
