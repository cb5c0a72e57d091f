//! Every key of a muscle file, once: checks, suggestions and examples in messages come from this list.

use crate::construction::Kind;
use crate::parameter::Parameter;
use crate::quantity::Length;
use crate::settings::Keys;
use crate::units;

/// The table of a specimen, and that of its fibres.
pub(crate) const SPECIMEN: &str = "specimens.*";
pub(crate) const SPECIMEN_FIBRE: &str = "specimens.*.fibre";

/// The tables by their dotted paths, "" for the top of the file.
const TABLES: &[(&str, Keys)] = &[
    (
        "",
        &[
            ("name", "name = \"my muscle\""),
            ("kind", "kind = \"pleated\""),
            ("length", "length = \"110 mm\""),
            ("radius", "radius = \"16 mm\""),
            ("fibres", "fibres = 40"),
            ("braid_angle", "braid_angle = \"25 deg\""),
            ("ends", "ends = \"clamped\""),
            ("wall", "wall = \"2 mm\""),
            ("fibre", "fibre = { stiffness = \"12 kN\" }"),
            ("effects", "effects.end-radius = { radius = \"16 mm\" }"),
            ("instruments", "instruments.force = { noise = \"4 N\" }"),
            ("specimens", "specimens.short = { length = \"60 mm\" }"),
            ("data", "data.columns = { force = \"F1 [N]\" }"),
            ("fitted", "fitted = { error = \"4 N\", rows = 238 }"),
        ],
    ),
    (
        SPECIMEN,
        &[
            ("length", "length = \"60 mm\""),
            ("radius", "radius = \"16 mm\""),
            ("fibres", "fibres = 40"),
            ("braid_angle", "braid_angle = \"25 deg\""),
            ("wall", "wall = \"2 mm\""),
            ("fibre", "fibre = { stiffness = \"12 kN\" }"),
            ("effects", "effects.end-radius = { radius = \"16 mm\" }"),
        ],
    ),
    (SPECIMEN_FIBRE, &[("stiffness", "stiffness = \"12 kN\"")]),
    ("fibre", &[("stiffness", "stiffness = \"12 kN\""), ("section", "section = \"0.3 mm^2\"")]),
    (
        "effects",
        &[
            ("bladder-elasticity", "bladder-elasticity = { c10 = \"0.2 MPa\" }"),
            (
                "limited-unfolding",
                "limited-unfolding = { hoop_stiffness = \"81 kN/m\", unfolded_radius = \"52.6 mm\" }",
            ),
            ("end-radius", "end-radius = { radius = \"16 mm\" }"),
            ("wall-thickness", "wall-thickness = { thickness = \"2 mm\" }"),
            ("pleat-depth", "pleat-depth = { depth = \"4.5 mm\" }"),
            ("fibre-misalignment", "fibre-misalignment = { angle = \"2 deg\" }"),
            ("lobes", "lobes = { circumference = \"330 mm\" }"),
        ],
    ),
    (
        "effects.bladder-elasticity",
        &[("c10", "c10 = \"0.2 MPa\""), ("c01", "c01 = \"0.05 MPa\""), ("wall", "wall = \"2 mm\"")],
    ),
    (
        "effects.limited-unfolding",
        &[
            ("hoop_stiffness", "hoop_stiffness = \"81 kN/m\""),
            ("unfolded_radius", "unfolded_radius = \"52.6 mm\""),
        ],
    ),
    ("effects.end-radius", &[("radius", "radius = \"16 mm\"")]),
    ("effects.wall-thickness", &[("thickness", "thickness = \"2 mm\"")]),
    ("effects.pleat-depth", &[("depth", "depth = \"4.5 mm\"")]),
    ("effects.fibre-misalignment", &[("angle", "angle = \"2 deg\"")]),
    ("effects.lobes", &[("circumference", "circumference = \"330 mm\"")]),
    ("instruments", &[("force", "force = { noise = \"4 N\" }"), PRESSURE, LENGTH]),
    ("instruments.force", &[("noise", "noise = \"4 N\""), ("zero", "zero = \"1 N\""), GAIN]),
    ("instruments.pressure", &[("noise", "noise = \"30 Pa\""), ("zero", "zero = \"200 Pa\""), GAIN]),
    ("instruments.length", &[("noise", "noise = \"5 um\""), ("zero", "zero = \"0.05 mm\""), GAIN]),
    ("data", &[("columns", "columns = { force = \"F1 [N]\" }")]),
    (
        "data.columns",
        &[
            ("pressure", "pressure = \"P1 [psi]\""),
            ("contraction", "contraction = \"eps [%]\""),
            ("length", "length = \"L [mm]\""),
            ("displacement", "displacement = \"Weg [mm]\""),
            ("force", "force = \"Force_N [N]\""),
            ("time", "time = \"t [s]\""),
            ("sweep", "sweep = \"Sweep\""),
            ("specimen", "specimen = \"Specimen\""),
            ("cycle", "cycle = \"Cycle\""),
            ("direction", "direction = \"Direction\""),
            ("temperature", "temperature = \"T [degC]\""),
            ("diameter", "diameter = \"D [mm]\""),
            ("volume", "volume = \"V [ml]\""),
            ("force_sd", "force_sd = \"sF [N]\""),
            ("ignore", "ignore = \"Ignore\""),
        ],
    ),
];

const PRESSURE: (&str, &str) = ("pressure", "pressure = { noise = \"30 Pa\" }");
const LENGTH: (&str, &str) = ("length", "length = { noise = \"5 um\" }");
const GAIN: (&str, &str) = ("gain", "gain = \"0.1 %\"");

/// Other words for a key. They are not accepted, but answered.
const SYNONYMS: &[(&str, &str)] = &[
    ("l0", "length"),
    ("r", "radius"),
    ("r0", "radius"),
    ("diameter", "radius"),
    ("n", "fibres"),
    ("fibers", "fibres"),
    ("fiber", "fibre"),
    ("alpha0", "braid_angle"),
    ("angle", "braid_angle"),
    ("type", "kind"),
    ("thickness", "wall"),
    ("fitting_radius", "effects.end-radius.radius"),
    ("misalignment", "effects.fibre-misalignment.angle"),
    ("bladder", "effects.bladder-elasticity.c10"),
    ("modulus", "fibre.stiffness"),
    ("ea", "fibre.stiffness"),
];

/// The shortest possible muscle file.
pub(crate) const EXAMPLE: &str = "\
name = \"second-generation PPAM\"
kind = \"pleated\"        # or \"braided\"
length = \"110 mm\"       # unpressurised, between the end fittings
radius = \"16 mm\"        # pleated: of the fibres at the fittings; braided: of the braid at rest
fibres = 40             # pleated; or \"continuous\"
# braid_angle = \"25 deg\"                # braided: between fibre and axis at rest
# fibre = { stiffness = \"12 kN\" }       # optional: EA of one fibre
# [instruments]                         # optional: one standard deviation each
# force = { noise = \"4 N\" }
# pressure = { noise = \"30 Pa\" }
";

/// The keys of a table, in the order of the list.
pub(crate) fn of(path: &str) -> Keys {
    TABLES.iter().find(|(table, _)| *table == path).map_or(&[], |(_, keys)| *keys)
}

/// Dotted paths of all keys of a file, those of specimens aside.
#[cfg(test)]
pub(crate) fn paths() -> impl Iterator<Item = String> {
    let plain = TABLES.iter().filter(|(table, _)| !table.contains('*'));
    plain.flat_map(|(table, keys)| keys.iter().map(|(key, _)| join(table, key)))
}

/// The family that alone has this key or this table, if there is one.
pub(crate) fn owner(path: &str) -> Option<Kind> {
    let has = |parameter: &Parameter| {
        parameter.key().strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    match path {
        "ends" => Some(Kind::Braided),
        _ => Parameter::ALL.iter().find(|parameter| has(parameter))?.kind(),
    }
}

/// The path of a child.
pub(crate) fn join(parent: &str, name: &str) -> String {
    if parent.is_empty() { name.to_owned() } else { format!("{parent}.{name}") }
}

/// How a key is written: `length = "110 mm"`, or `c10 = "0.2 MPa"` in `[effects.bladder-elasticity]`.
pub(crate) fn example(path: &str) -> String {
    let (table, name) = path.rsplit_once('.').unwrap_or(("", path));
    let line = of(table).iter().find(|(key, _)| *key == name).map_or("", |(_, line)| *line);
    if table.is_empty() { format!("`{line}`") } else { format!("`{line}` in `[{table}]`") }
}

/// How to write a key that stands at the top of the file under another name, or that belongs in a table.
pub(crate) fn elsewhere(unknown: &str, value: Option<&str>) -> Option<String> {
    let plain = |text: &str| text.to_lowercase().replace('-', "_");
    let is_it = |name: &str| plain(name) == plain(unknown);
    if let Some(radius) = is_it("diameter").then(|| value.and_then(half)).flatten() {
        return Some(format!("write `radius = \"{radius}\"`, half of it"));
    }
    if let Some((_, path)) = SYNONYMS.iter().find(|(other, _)| is_it(other)) {
        return Some(format!("write {}", example(path)));
    }
    let of_muscle = |(table, _): &&(&str, Keys)| !table.contains('*');
    let of_table = |(table, keys): &(&str, Keys)| {
        keys.iter()
            .find(|(key, _)| is_it(key))
            .map(|(key, _)| format!("write {}", example(&join(table, key))))
    };
    TABLES.iter().filter(of_muscle).find_map(of_table)
}

/// Half a length, in its own unit; `None` if it is none, or has a width.
fn half(length: &str) -> Option<String> {
    let (number, unit) = length.split_at(length.find(char::is_alphabetic)?);
    let number: f64 = number.trim().parse().ok()?;
    units::parse::<Length>(length).ok().map(|_| format!("{} {unit}", number / 2.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_is_a_key_and_every_example_is_one_line_of_it() {
        for (table, keys) in TABLES.iter().filter(|(table, _)| !table.contains('*')) {
            let (parent, name) = table.rsplit_once('.').unwrap_or(("", table));
            assert!(table.is_empty() || of(parent).iter().any(|(key, _)| *key == name), "{table}");
            for (key, line) in *keys {
                assert!(line.starts_with(key) && line.parse::<toml::Table>().is_ok(), "{table}: {line}");
            }
        }
        let numbers = Parameter::ALL.iter().map(|parameter| parameter.key());
        for path in numbers.chain(SYNONYMS.iter().map(|(_, path)| *path)) {
            assert!(!example(path).starts_with("``"), "{path}");
        }
        assert_eq!(owner("effects.pleat-depth"), Some(Kind::Pleated));
        assert_eq!(
            (owner("wall"), owner("length"), owner("effects.end-radius")),
            (Some(Kind::Braided), None, None)
        );
    }

    #[test]
    fn what_was_meant() {
        for (unknown, part) in [
            ("l0", "`length = \"110 mm\"`"),
            ("c10", "`c10 = \"0.2 MPa\"` in `[effects.bladder-elasticity]`"),
            ("end_radius", "`end-radius = { radius = \"16 mm\" }` in `[effects]`"),
            ("fitting_radius", "`[effects.end-radius]`"),
            ("pleat_depth", "pleat-depth = "),
            ("stiffness", "`[fibre]`"),
        ] {
            let found = elsewhere(unknown, None).unwrap();
            assert!(found.contains(part), "{unknown}: {found}");
        }
        assert!(["colour", "lenght", ""].into_iter().all(|unknown| elsewhere(unknown, None).is_none()));
        assert_eq!(elsewhere("Diameter", Some("21 mm")).unwrap(), "write `radius = \"10.5 mm\"`, half of it");
        for other in ["21 mm +- 1 mm", "21 N", "21"] {
            assert!(elsewhere("diameter", Some(other)).unwrap().contains("16 mm"), "{other}");
        }
    }
}
