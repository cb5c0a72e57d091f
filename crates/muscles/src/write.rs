//! A muscle into TOML text that reads back as exactly the same muscle.

use crate::construction::{Construction, Ends};
use crate::fitted;
use crate::instrument::Instrument;
use crate::muscle::Muscle;
use crate::parameter::Parameter;
use crate::quantity::{Force, Length, Pressure};
use crate::specimen::toml_key;
use crate::units::{Quantity, Wanted, exact_text, exact_text_of};

/// Writes a muscle file. Reading it with `from_toml` gives an equal muscle, bit for bit.
///
/// ```
/// let muscle = bulge_muscles::preset("ppam-2-r16")?;
/// let text = bulge_muscles::to_toml(&muscle);
/// assert!(text.contains("length = \"110 mm\""));
/// assert_eq!(bulge_muscles::from_toml(&text, "copy").as_ref(), Ok(&muscle));
/// # Ok::<(), bulge_muscles::PresetError>(())
/// ```
#[must_use]
pub fn to_toml(muscle: &Muscle) -> String {
    let mut lines = vec![
        format!("name = {}", toml::Value::String(muscle.name().to_owned())),
        format!("kind = \"{}\"", muscle.kind().name()),
    ];
    let root = [Parameter::Length, Parameter::Radius, Parameter::BraidAngle, Parameter::Fibres];
    lines.extend(root.into_iter().filter_map(|parameter| line(muscle, parameter.key(), parameter)));
    match muscle.construction() {
        Construction::Pleated(_) if muscle.fibres().is_none() => {
            lines.push("fibres = \"continuous\"".to_owned());
        }
        Construction::Braided(braided) if braided.ends() != Ends::Clamped => {
            lines.push(format!("ends = \"{}\"", braided.ends().name()));
        }
        _ => {}
    }
    lines.extend(line(muscle, "wall", Parameter::Wall));
    if let Some(stiffness) = line(muscle, "stiffness", Parameter::FibreStiffness) {
        let section = muscle.fibre().and_then(|fibre| fibre.section());
        let section = section.map(|area| format!(", section = \"{}\"", exact_text(area))).unwrap_or_default();
        lines.push(format!("fibre = {{ {stiffness}{section} }}"));
    }
    effect_lines(&mut lines, muscle);
    for effect in muscle.learnt() {
        lines.push(format!("\n[effects.{}]", effect.name()));
        lines.extend(effect.values().iter().map(|value| format!("{} = {}", value.key, value.text())));
    }
    instrument_lines(&mut lines, muscle);
    for specimen in muscle.specimens() {
        lines.push(format!("\n[specimens.{}]", toml_key(specimen.name())));
        let number = |(parameter, value): &(Parameter, f64)| {
            format!("{} = {}", parameter.key(), parameter.text(*value, None))
        };
        lines.extend(specimen.numbers().iter().map(number));
    }
    if !muscle.data_columns().is_empty() {
        lines.push("\n[data.columns]".to_owned());
        let line = |(quantity, column): &(String, String)| {
            format!("{quantity} = {}", toml::Value::String(column.clone()))
        };
        lines.extend(muscle.data_columns().iter().map(line));
    }
    lines.extend(muscle.fitted().map(fitted::lines).unwrap_or_default());
    lines.push(String::new());
    lines.join("\n")
}

/// `key = "value"`, with the stated width if there is one; `None` if the number has no place of its own.
fn line(muscle: &Muscle, key: &str, parameter: Parameter) -> Option<String> {
    let value = muscle.stated(parameter)?;
    Some(format!("{key} = {}", parameter.text(value, muscle.width(parameter))))
}

/// Effects with numbers of the muscle, in the order in which they are written.
const EFFECTS: [&str; 7] = [
    "end-radius",
    "pleat-depth",
    "fibre-misalignment",
    "lobes",
    "bladder-elasticity",
    "wall-thickness",
    "limited-unfolding",
];

fn effect_lines(lines: &mut Vec<String>, muscle: &Muscle) {
    // Of these a number that is 0 and has no width need not be stated.
    let is_usual = |parameter| {
        matches!(parameter, Parameter::PleatDepth | Parameter::Misalignment | Parameter::C01)
            && muscle.stated(parameter) == Some(0.0)
            && muscle.width(parameter).is_none()
    };
    for effect in EFFECTS {
        let stated = Parameter::in_effect(effect).filter(|(parameter, _)| !is_usual(*parameter));
        let mut body: Vec<String> =
            stated.filter_map(|(parameter, key)| line(muscle, key, parameter)).collect();
        if effect == "bladder-elasticity"
            && let Some(wall) = muscle.bladder_wall()
        {
            // A width of the bladder's wall is that of the muscle's, if that states none of its own.
            let is_only = muscle.stated(Parameter::Wall).is_none();
            let width = muscle.width(Parameter::Wall).filter(|_| is_only);
            if is_only || muscle.wall() != Some(wall) {
                body.push(format!("wall = {}", Parameter::Wall.text(wall.si(), width)));
            }
        }
        // A missing thickness means that of the wall.
        let is_inner_gas = effect == "wall-thickness" && muscle.get(Parameter::GasWall).is_some();
        if !body.is_empty() || is_inner_gas {
            lines.push(format!("\n[effects.{effect}]"));
            lines.extend(body);
        }
    }
}

fn instrument_lines(lines: &mut Vec<String>, muscle: &Muscle) {
    let instruments = muscle.instruments();
    let written: Vec<String> = [
        instruments.force.map(|force| instrument_line::<Force>("force", "N", &force)),
        instruments.pressure.map(|pressure| instrument_line::<Pressure>("pressure", "Pa", &pressure)),
        instruments.length.map(|length| instrument_line::<Length>("length", "mm", &length)),
    ]
    .into_iter()
    .flatten()
    .collect();
    if !written.is_empty() {
        lines.push("\n[instruments]".to_owned());
        lines.extend(written);
    }
}

fn instrument_line<Q: Quantity>(name: &str, unit: &str, instrument: &Instrument) -> String {
    let entries = [
        ("noise", instrument.noise(), exact_text_of(Wanted::of::<Q>(), instrument.noise(), unit)),
        ("zero", instrument.zero(), exact_text_of(Wanted::of::<Q>(), instrument.zero(), unit)),
        ("gain", instrument.gain().si(), exact_text(instrument.gain())),
    ];
    let stated: Vec<String> = entries
        .into_iter()
        .filter(|(_, value, _)| *value > 0.0)
        .map(|(key, _, text)| format!("{key} = \"{text}\""))
        .collect();
    format!("{name} = {{ {} }}", stated.join(", "))
}
