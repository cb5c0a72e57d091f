//! The supports of a case's mesh.

use bulge_muscles::settings::{Keys, Settings};
use bulge_muscles::{Dimension, FileError};

use super::parts::group;
use super::read::{direction, name};
use super::source::Source;
use crate::structure::{Fitting, Part, Support};
use crate::surface::sector;
use core::f64::consts::TAU;

const KEYS: Keys = &[
    ("group", "group = \"last\""),
    ("kind", "kind = \"fitting\""),
    ("fitting", "fitting = \"top\""),
    ("motion", "motion = \"placed\""),
    ("normal", "normal = [0, 0, 1]"),
    ("contact", "contact = true"),
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
    /// Groups of these in whose plane the cloth meets its mirror image.
    pub(super) contacts: Vec<String>,
    pub(super) fittings: Vec<(String, Fitting)>,
}

pub(super) fn read(settings: &Settings<'_>, source: &Source) -> Result<Supports, FileError> {
    let mut all = Supports {
        held: source.supports.clone(),
        contacts: source.contacts.clone(),
        fittings: source.fittings.clone(),
    };
    // The motions that tables state, by the names of the fittings.
    let mut stated = Vec::new();
    for table in settings.tables("support", "a `[[support]]`", KEYS)?.unwrap_or_default() {
        table.check_keys()?;
        let group = group(&table, "group", source)?;
        let kind = table.word("kind", KINDS)?.ok_or_else(|| table.missing("kind"))?;
        let used: &[&str] = match kind {
            Kind::Fixed | Kind::Axis | Kind::Slide => &[],
            Kind::Plane => &["normal", "contact"],
            Kind::Fitting => &["fitting", "motion"],
            Kind::Cyclic => &["partner", "angle"],
        };
        for key in ["fitting", "motion", "normal", "contact", "partner", "angle"] {
            if table.get(key).is_some() && !used.contains(&key) {
                let what = format!("this kind of support has no `{key}`");
                return Err(table.error(table.key_span(key), what, "leave it out"));
            }
        }
        let support = support(&table, kind, source, &mut all.fittings)?;
        if let Support::Fitting { fitting } = support {
            let (name, known) = &mut all.fittings[fitting];
            set_motion(&table, name, known, &mut stated)?;
        }
        if let Support::Cyclic { partner, angle } = &support {
            check_turn(&table, group, partner, *angle)?;
        }
        if let Some(contact) = table.flag("contact")? {
            all.contacts.retain(|known| known != group);
            all.contacts.extend(contact.then(|| group.to_owned()));
        }
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
            // The volume is measured between the membrane and the axis, so such planes close it without
            // elements.
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
            let fitting = fittings.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
                fittings.push((name.to_owned(), Fitting::Placed));
                fittings.len() - 1
            });
            Support::Fitting { fitting }
        }
        Kind::Cyclic => {
            let partner = group(table, "partner", source)?.to_owned();
            let angle = table.quantity("angle", Dimension::NONE)?.ok_or_else(|| table.missing("angle"))?;
            Support::Cyclic { partner, angle }
        }
    })
}

/// Sets the motion of a fitting from a table; two tables must agree.
fn set_motion(
    table: &Settings<'_>,
    name: &str,
    known: &mut Fitting,
    stated: &mut Vec<(String, Fitting)>,
) -> Result<(), FileError> {
    let Some(motion) = table.word("motion", MOTIONS)? else { return Ok(()) };
    match stated.iter().find(|(other, _)| other == name) {
        Some((_, before)) if *before != motion => {
            let what = format!("the fitting `{name}` has another motion in a `[[support]]` before");
            return Err(table.error(
                table.value_span("motion"),
                what,
                "state it once, or the same each time",
            ));
        }
        Some(_) => (),
        None => stated.push((name.to_owned(), motion)),
    }
    *known = motion;
    Ok(())
}

/// Checks that a cyclic edge has another one as its partner.
fn check_turn(table: &Settings<'_>, group: &str, partner: &str, angle: f64) -> Result<(), FileError> {
    if group == partner {
        let what = format!("`{group}` is its own partner");
        let instead = "name the other edge of the cyclic sector";
        return Err(table.error(table.value_span("partner"), what, instead));
    }
    let turn = angle.rem_euclid(TAU);
    if turn.min(TAU - turn) > 1e-6 {
        return Ok(());
    }
    let what = "`angle` is no turn: the far edge of a cyclic sector lies at an angle to its partner";
    Err(table.error(table.value_span("angle"), what, "write 360 degrees over the number of sectors"))
}

/// Checks that as many sectors as the case says make a full turn, if the supports fix their angle.
pub(super) fn check_sectors(
    settings: &Settings<'_>,
    source: &Source,
    parts: &[(String, Part)],
    supports: &Supports,
) -> Result<(), FileError> {
    let Some(scale) = settings.table("scale", "`[scale]`", super::source::SCALE)? else { return Ok(()) };
    // Other faults of the mesh are reported when the structure is built.
    let Ok(Some(angle)) = sector(&source.mesh, parts, &supports.held) else { return Ok(()) };
    let (around, fitting) = (source.copies.around, TAU / angle);
    if (fitting - around).abs() < 1e-2 {
        return Ok(());
    }
    let degrees = (angle.to_degrees() * 1e6).round() / 1e6;
    let what = format!(
        "`around` is {around}, but the mesh is a sector of {degrees} degrees, of which {around} make {}",
        (around * angle.to_degrees() * 1e6).round() / 1e6
    );
    let instead = if (fitting - fitting.round()).abs() < 1e-2 {
        format!("write `around = {}`", fitting.round())
    } else {
        "mesh a sector of 360 degrees over a whole number".to_owned()
    };
    Err(scale.error(scale.value_span("around"), what, instead))
}
