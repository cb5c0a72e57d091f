//! A muscle into TOML text that reads back as exactly the same muscle.

use crate::construction::{Braided, Construction, Ends, FibreCount, Pleated};
use crate::fitted;
use crate::instrument::Instrument;
use crate::muscle::Muscle;
use crate::parameter::Parameter;
use crate::quantity::{Force, Length, Pressure};
use crate::specimen::toml_key;
use crate::units::{Quantity, exact_text, exact_text_in};

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
        line(muscle, "length", Parameter::Length, muscle.length()),
    ];
    match muscle.construction() {
        Construction::Pleated(pleated) => pleated_lines(&mut lines, muscle, pleated),
        Construction::Braided(braided) => braided_lines(&mut lines, muscle, braided),
    }
    if let Some(fibre) = muscle.fibre() {
        let stiffness = line(muscle, "stiffness", Parameter::FibreStiffness, fibre.stiffness());
        let section =
            fibre.section().map(|area| format!(", section = \"{}\"", exact_text(area))).unwrap_or_default();
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
            format!("{} = {}", parameter.key(), parameter.text(*value))
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

/// `key = "value"`, with the stated width if there is one.
fn line<Q: Quantity>(muscle: &Muscle, key: &str, parameter: Parameter, value: Q) -> String {
    let unit = match parameter {
        Parameter::C10 | Parameter::C01 => "MPa",
        Parameter::FibreStiffness => "kN",
        _ => Q::SHOWN.0,
    };
    let width =
        muscle.width(parameter).map(|width| format!(" +- {}", exact_text_in(Q::from_si(width), unit)));
    format!("{key} = \"{}{}\"", exact_text_in(value, unit), width.unwrap_or_default())
}

fn pleated_lines(lines: &mut Vec<String>, muscle: &Muscle, pleated: &Pleated) {
    lines.push(line(muscle, "radius", Parameter::Radius, pleated.stated_radius()));
    lines.push(match pleated.fibres() {
        FibreCount::Discrete(count) => format!("fibres = {count}"),
        FibreCount::Continuous => "fibres = \"continuous\"".to_owned(),
    });
}

fn braided_lines(lines: &mut Vec<String>, muscle: &Muscle, braided: &Braided) {
    lines.push(line(muscle, "radius", Parameter::Radius, braided.radius()));
    lines.push(line(muscle, "braid_angle", Parameter::BraidAngle, braided.braid_angle()));
    lines.extend(braided.fibres().map(|count| format!("fibres = {count}")));
    if braided.ends() != Ends::Clamped {
        lines.push(format!("ends = \"{}\"", braided.ends().name()));
    }
    lines.extend(braided.wall().map(|wall| line(muscle, "wall", Parameter::Wall, wall)));
}

fn effect_lines(lines: &mut Vec<String>, muscle: &Muscle) {
    let mut effect = |name: &str, body: Vec<String>| {
        lines.push(format!("\n[effects.{name}]"));
        lines.extend(body);
    };
    // A number that is 0 and has no width need not be stated.
    let counts = |value: f64, parameter| value != 0.0 || muscle.width(parameter).is_some();
    let end_radius = match muscle.construction() {
        Construction::Pleated(pleated) => pleated.end_radius,
        Construction::Braided(braided) => braided.fitting_radius,
    };
    if let Some(radius) = end_radius {
        effect("end-radius", vec![line(muscle, "radius", Parameter::FittingRadius, radius)]);
    }
    if let Construction::Pleated(pleated) = muscle.construction() {
        let (depth, angle) = (pleated.pleat_depth(), pleated.misalignment());
        if counts(depth.si(), Parameter::PleatDepth) {
            effect("pleat-depth", vec![line(muscle, "depth", Parameter::PleatDepth, depth)]);
        }
        if counts(angle.si(), Parameter::Misalignment) {
            effect("fibre-misalignment", vec![line(muscle, "angle", Parameter::Misalignment, angle)]);
        }
        if let Some(cloth) = pleated.cloth_circumference() {
            effect("lobes", vec![line(muscle, "circumference", Parameter::ClothCircumference, cloth)]);
        }
    }
    if let Some(bladder) = muscle.bladder() {
        let mut body = vec![line(muscle, "c10", Parameter::C10, bladder.c10())];
        if counts(bladder.c01().si(), Parameter::C01) {
            body.push(line(muscle, "c01", Parameter::C01, bladder.c01()));
        }
        match muscle.own_wall() {
            None => body.push(line(muscle, "wall", Parameter::Wall, bladder.wall())),
            Some(own) if own == bladder.wall() => {}
            Some(_) => body.push(format!("wall = \"{}\"", exact_text(bladder.wall()))),
        }
        effect("bladder-elasticity", body);
    }
    if let Some(thickness) = muscle.gas_wall() {
        // A missing thickness means that of the wall.
        let stated = muscle.is_stated(Parameter::GasWall);
        let body = stated.then(|| line(muscle, "thickness", Parameter::GasWall, thickness));
        effect("wall-thickness", body.into_iter().collect());
    }
    if let Some(limit) = muscle.unfolding() {
        let stiffness = line(muscle, "hoop_stiffness", Parameter::HoopStiffness, limit.hoop_stiffness());
        let radius = line(muscle, "unfolded_radius", Parameter::UnfoldedRadius, limit.unfolded_radius());
        effect("limited-unfolding", vec![stiffness, radius]);
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
        ("noise", instrument.noise(), exact_text_in(Q::from_si(instrument.noise()), unit)),
        ("zero", instrument.zero(), exact_text_in(Q::from_si(instrument.zero()), unit)),
        ("gain", instrument.gain().si(), exact_text(instrument.gain())),
    ];
    let stated: Vec<String> = entries
        .into_iter()
        .filter(|(_, value, _)| *value > 0.0)
        .map(|(key, _, text)| format!("{key} = \"{text}\""))
        .collect();
    format!("{name} = {{ {} }}", stated.join(", "))
}
