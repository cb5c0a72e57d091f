//! What holds the mesh of a case.

use bulge_muscles::settings::{Keys, Settings};
use bulge_muscles::{Dimension, FileError};

use super::parts::group;
use super::read::{direction, name};
use super::source::Source;
use crate::structure::{Fitting, Support};

const KEYS: Keys = &[
    ("group", "group = \"last\""),
    ("kind", "kind = \"fitting\""),
    ("fitting", "fitting = \"top\""),
    ("motion", "motion = \"placed\""),
    ("normal", "normal = [0, 0, 1]"),
    ("partner", "partner = \"left\""),
    ("angle", "angle = \"30 deg\""),
];

#[derive(Debug, Clone, Copy)]
enum Kind {
    Fixed,
    Plane,
    Axis,
    Slide,
    Fitting,
    Cyclic,
}

const KINDS: &[(&str, Kind)] = &[
    ("fixed", Kind::Fixed),
    ("plane", Kind::Plane),
    ("axis", Kind::Axis),
    ("slide", Kind::Slide),
    ("fitting", Kind::Fitting),
    ("cyclic", Kind::Cyclic),
];

const MOTIONS: &[(&str, Fitting)] = &[("placed", Fitting::Placed), ("loaded", Fitting::Loaded)];

/// Supports and fittings.
pub(super) struct Supports {
    pub(super) held: Vec<(String, Support)>,
    pub(super) fittings: Vec<(String, Fitting)>,
}

pub(super) fn read(settings: &Settings<'_>, source: &Source) -> Result<Supports, FileError> {
    let mut all = Supports { held: source.supports.clone(), fittings: source.fittings.clone() };
    for table in settings.tables("support", "a `[[support]]`", KEYS)?.unwrap_or_default() {
        table.check_keys()?;
        let group = group(&table, "group", source)?;
        let kind = table.word("kind", KINDS)?.ok_or_else(|| table.missing("kind"))?;
        let used: &[&str] = match kind {
            Kind::Fixed | Kind::Axis | Kind::Slide => &[],
            Kind::Plane => &["normal"],
            Kind::Fitting => &["fitting", "motion"],
            Kind::Cyclic => &["partner", "angle"],
        };
        for key in ["fitting", "motion", "normal", "partner", "angle"] {
            if table.get(key).is_some() && !used.contains(&key) {
                let what = format!("this kind of support has no `{key}`");
                return Err(table.error(table.key_span(key), what, "leave it out"));
            }
        }
        let support = support(&table, kind, source, &mut all.fittings)?;
        all.held.push((group.to_owned(), support));
    }
    Ok(all)
}

fn support(
    table: &Settings<'_>,
    kind: Kind,
    source: &Source,
    fittings: &mut Vec<(String, Fitting)>,
) -> Result<Support, FileError> {
    Ok(match kind {
        Kind::Fixed => Support::Fixed,
        Kind::Axis => Support::Axis,
        Kind::Slide => Support::Slide,
        Kind::Plane => {
            let normal = direction(table, "normal")?.ok_or_else(|| table.missing("normal"))?;
            // The volume is that between the membrane and the axis: such planes close it without elements.
            let size = (normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]).sqrt();
            let (along, across) = (normal[2].abs() / size, normal[0].hypot(normal[1]) / size);
            if along > 1e-6 && across > 1e-6 {
                let what = "a plane of symmetry must be level or contain the z axis: the volume is measured from there";
                return Err(table.error(
                    table.value_span("normal"),
                    what,
                    "turn the mesh, or hold it otherwise",
                ));
            }
            Support::Plane { normal }
        }
        Kind::Fitting => {
            let name = name(table, "fitting")?;
            let motion = table.word("motion", MOTIONS)?;
            let fitting = fittings.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
                fittings.push((name.to_owned(), Fitting::Placed));
                fittings.len() - 1
            });
            if let Some(motion) = motion {
                fittings[fitting].1 = motion;
            }
            Support::Fitting { fitting }
        }
        Kind::Cyclic => {
            let partner = group(table, "partner", source)?.to_owned();
            let angle = table.quantity("angle", Dimension::NONE)?.ok_or_else(|| table.missing("angle"))?;
            Support::Cyclic { partner, angle }
        }
    })
}
