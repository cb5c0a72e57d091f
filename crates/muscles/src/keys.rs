//! Every key of a muscle file, once: checks, suggestions and examples in messages come from this list.

use crate::construction::Kind;

/// One key: its dotted path, a value as it is written, and the family it belongs to (none: both).
struct Key {
    path: &'static str,
    example: &'static str,
    kind: Option<Kind>,
}

const fn both(path: &'static str, example: &'static str) -> Key {
    Key { path, example, kind: None }
}

const fn only(kind: Kind, path: &'static str, example: &'static str) -> Key {
    Key { path, example, kind: Some(kind) }
}

const KEYS: &[Key] = &[
    both("name", "\"second-generation PPAM\""),
    both("kind", "\"pleated\""),
    both("length", "\"110 mm\""),
    both("radius", "\"16 mm\""),
    both("fibres", "40"),
    only(Kind::Braided, "braid_angle", "\"25 deg\""),
    only(Kind::Braided, "ends", "\"clamped\""),
    only(Kind::Braided, "wall", "\"2 mm\""),
    both("fibre.stiffness", "\"12 kN\""),
    both("fibre.section", "\"0.3 mm^2\""),
    only(Kind::Braided, "effects.bladder-elasticity.c10", "\"0.2 MPa\""),
    only(Kind::Braided, "effects.bladder-elasticity.c01", "\"0.05 MPa\""),
    only(Kind::Braided, "effects.bladder-elasticity.wall", "\"2 mm\""),
    both("effects.limited-unfolding.hoop_stiffness", "\"81 kN/m\""),
    both("effects.limited-unfolding.unfolded_radius", "\"52.6 mm\""),
    both("effects.end-radius.radius", "\"16 mm\""),
    only(Kind::Braided, "effects.wall-thickness.thickness", "\"2 mm\""),
    only(Kind::Pleated, "effects.pleat-depth.depth", "\"4.5 mm\""),
    only(Kind::Pleated, "effects.fibre-misalignment.angle", "\"2 deg\""),
    only(Kind::Pleated, "effects.lobes.circumference", "\"330 mm\""),
    both("instruments.force.noise", "\"4 N\""),
    both("instruments.force.zero", "\"1 N\""),
    both("instruments.force.gain", "\"0.1 %\""),
    both("instruments.pressure.noise", "\"30 Pa\""),
    both("instruments.pressure.zero", "\"200 Pa\""),
    both("instruments.pressure.gain", "\"0.1 %\""),
    both("instruments.length.noise", "\"5 um\""),
    both("instruments.length.zero", "\"0.05 mm\""),
    both("instruments.length.gain", "\"0.1 %\""),
    both("data.columns.pressure", "\"P1 [psi]\""),
    both("data.columns.contraction", "\"eps [%]\""),
    both("data.columns.length", "\"L [mm]\""),
    both("data.columns.displacement", "\"Weg [mm]\""),
    both("data.columns.force", "\"Force_N [N]\""),
    both("data.columns.time", "\"t [s]\""),
    both("data.columns.sweep", "\"Sweep\""),
    both("data.columns.specimen", "\"Specimen\""),
    both("data.columns.cycle", "\"Cycle\""),
    both("data.columns.direction", "\"Direction\""),
    both("data.columns.temperature", "\"T [degC]\""),
    both("data.columns.diameter", "\"D [mm]\""),
    both("data.columns.volume", "\"V [ml]\""),
    both("data.columns.force_sd", "\"sF [N]\""),
    both("data.columns.ignore", "\"Ignore\""),
];

/// Other words for a key: not accepted, but answered.
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

/// A muscle file as short as it can be.
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

/// The part of `path` below `parent`, if it is below it ("" is the whole file).
fn below<'p>(path: &'p str, parent: &str) -> Option<&'p str> {
    if parent.is_empty() { Some(path) } else { path.strip_prefix(parent)?.strip_prefix('.') }
}

/// The names that may stand in the table `parent`, in the order of the list.
pub(crate) fn children(parent: &str) -> Vec<&'static str> {
    let mut names = Vec::new();
    for key in KEYS {
        let name = below(key.path, parent).and_then(|rest| rest.split('.').next()).unwrap_or("");
        if !name.is_empty() && !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// The family that alone has this key, or this table.
pub(crate) fn owner(path: &str) -> Option<Kind> {
    KEYS.iter().find(|key| key.path == path || below(key.path, path).is_some())?.kind
}

/// The path of a child.
pub(crate) fn join(parent: &str, name: &str) -> String {
    if parent.is_empty() { name.to_owned() } else { format!("{parent}.{name}") }
}

/// How a key, or a whole table, is written: `length = "110 mm"`, or `c10 = "0.2 MPa"` in `[effects.bladder-elasticity]`.
pub(crate) fn example(path: &str) -> String {
    let Some(key) = KEYS.iter().find(|key| key.path == path || below(key.path, path).is_some()) else {
        return String::new();
    };
    match key.path.rsplit_once('.') {
        None => format!("`{} = {}`", key.path, key.example),
        // Short tables are written on one line.
        Some(("fibre", name)) if path == "fibre" => format!("`fibre = {{ {name} = {} }}`", key.example),
        Some((table, name)) => format!("`{name} = {}` in the table `[{table}]`", key.example),
    }
}

/// What to write instead of a name that the table `parent` does not know.
pub(crate) fn instead_of(unknown: &str, parent: &str) -> String {
    let known = children(parent);
    if let Some(name) = nearest(unknown, &known) {
        return format!("did you mean `{name}`?");
    }
    match elsewhere(unknown).filter(|_| parent.is_empty()) {
        Some(path) => format!("write {}", example(path)),
        None => format!("known here: {}; leave the rest out, or write it behind a `#`", known.join(", ")),
    }
}

/// The path of a key that was written at the top of the file, or under another name.
fn elsewhere(unknown: &str) -> Option<&'static str> {
    let word = unknown.to_lowercase().replace('-', "_");
    let is_it = |part: &str| part.replace('-', "_") == word;
    let synonym = SYNONYMS.iter().find(|(other, _)| *other == word).map(|(_, path)| *path);
    synonym.or_else(|| KEYS.iter().map(|key| key.path).find(|path| path.split('.').any(is_it)))
}

/// The name that was probably meant: the same but for case and hyphens, its beginning, or a slip or two away.
pub(crate) fn nearest<'n>(word: &str, names: &[&'n str]) -> Option<&'n str> {
    let plain = |text: &str| text.to_lowercase().replace(['-', ' '], "_");
    let word = plain(word);
    let length = word.chars().count();
    let slips = |name: &str| strsim::damerau_levenshtein(&plain(name), &word);
    let closest = names.iter().min_by_key(|name| slips(name)).filter(|name| slips(name) <= length / 3);
    closest.or_else(|| names.iter().find(|name| length >= 4 && plain(name).starts_with(&word))).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_a_tree() {
        assert_eq!(children("fibre"), ["stiffness", "section"]);
        assert_eq!(children("instruments"), ["force", "pressure", "length"]);
        assert!(children("").contains(&"effects") && !children("").contains(&"effects.end-radius"));
        assert_eq!(owner("effects.pleat-depth"), Some(Kind::Pleated));
        assert_eq!(owner("wall"), Some(Kind::Braided));
        assert_eq!(
            (owner("effects"), owner("length"), owner("effects.end-radius")),
            (Some(Kind::Braided), None, None)
        );
    }

    #[test]
    fn what_was_meant() {
        for (unknown, parent, part) in [
            ("lenght", "", "`length`"),
            ("Radius", "", "`radius`"),
            ("braid-angle", "", "`braid_angle`"),
            ("fibers", "", "`fibres`"),
            ("l0", "", "`length = \"110 mm\"`"),
            ("c10", "", "`c10 = \"0.2 MPa\"` in the table `[effects.bladder-elasticity]`"),
            ("end_radius", "", "[effects.end-radius]"),
            ("fitting_radius", "", "[effects.end-radius]"),
            ("pleat_depth", "", "[effects.pleat-depth]"),
            ("stiffness", "", "[fibre]"),
            ("colour", "", "known here: name, kind, length"),
            ("bladder", "effects", "`bladder-elasticity`"),
            ("creep", "effects", "known here: bladder-elasticity, limited-unfolding, end-radius"),
            ("radius", "effects.pleat-depth", "known here: depth;"),
            ("", "", "known here"),
        ] {
            let instead = instead_of(unknown, parent);
            assert!(instead.contains(part), "{unknown}: {instead}");
        }
    }
}
