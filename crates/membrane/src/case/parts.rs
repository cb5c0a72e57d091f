//! Materials of the groups of a case's mesh.

use bulge_muscles::settings::{Keys, Setting, Settings};
use bulge_muscles::shown::listed;
use bulge_muscles::{Dimension, FileError, Muscle, Parameter};
use std::collections::BTreeSet;

use super::materials::Materials;
use super::read::{direction, in_range, name, number, positive};
use super::source::Source;
use crate::element::RingLayer;
use crate::material::{Sheet, Thread};
use crate::mesh::CellKind;
use crate::structure::Part;

const KEYS: Keys = &[
    ("group", "group = \"wall\""),
    ("kind", "kind = \"sheet\""),
    ("material", "material = \"rubber\""),
    ("fullness", "fullness = 1.5"),
    ("warp", "warp = [0, 0, 1]"),
    ("fibres", "fibres = 40"),
    ("angle", "angle = \"25 deg\""),
    ("stiffness", "stiffness = \"12 kN\""),
    ("share", "share = 0.5"),
];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Sheet,
    Threads,
    Membrane,
    Facet,
    Cable,
}

const KINDS: &[(&str, Kind)] = &[
    ("membrane", Kind::Membrane),
    ("facet", Kind::Facet),
    ("cable", Kind::Cable),
    ("sheet", Kind::Sheet),
    ("threads", Kind::Threads),
];

/// The keys of each kind, beside `group` and `kind`.
fn known(kind: Kind) -> &'static [&'static str] {
    match kind {
        Kind::Sheet => &["material", "fullness"],
        Kind::Threads => &["fibres", "angle", "stiffness"],
        Kind::Membrane => &["material", "warp"],
        Kind::Facet => &[],
        Kind::Cable => &["stiffness", "share"],
    }
}

pub(super) fn read(
    settings: &Settings<'_>,
    source: &Source,
    materials: &[(String, Sheet)],
) -> Result<Vec<(String, Part)>, FileError> {
    let mut parts: Vec<(String, Part)> = Vec::new();
    let tables = settings.tables("part", "a `[[part]]`", KEYS)?.unwrap_or_default();
    if tables.is_empty() {
        return Err(settings.missing("part"));
    }
    for table in &tables {
        table.check_keys()?;
        let group = group(table, "group", source)?;
        let kind = table.word("kind", KINDS)?.ok_or_else(|| table.missing("kind"))?;
        check_keys(table, kind)?;
        check_cells(table, source, group, kind)?;
        let part = part(table, kind, source, materials)?;
        match (parts.iter_mut().find(|(name, _)| name == group), part) {
            // Layers of a membrane of revolution lie on each other. No other parts may share a group;
            // building the structure refuses them.
            (Some((_, Part::Revolved { layers })), Part::Revolved { layers: more }) => layers.extend(more),
            (_, part) => parts.push((group.to_owned(), part)),
        }
    }
    Ok(parts)
}

/// Groups whose material resists bending, with their bending stiffness.
pub(super) fn bending(
    settings: &Settings<'_>,
    source: &Source,
    materials: &Materials,
) -> Result<Vec<(String, f64)>, FileError> {
    let mut found = Vec::new();
    for table in &settings.tables("part", "a `[[part]]`", KEYS)?.unwrap_or_default() {
        let Some(material) = table.get("material").and_then(Setting::text) else { continue };
        let Some((_, bending)) = materials.bending.iter().find(|(name, _)| name == material) else {
            continue;
        };
        let group = group(table, "group", source)?;
        let of_group = || source.mesh.blocks.iter().filter(|block| block.group == group);
        if of_group().any(|block| !matches!(block.kind, CellKind::Point | CellKind::Triangle3)) {
            let what = format!(
                "`{material}` resists bending, which only triangles with three nodes do, and `{group}` has other cells"
            );
            let instead = "make it of triangles (`kind = \"membrane\"`) with three nodes each (`order = 1`), or give it a material without `bending`";
            return Err(table.error(table.value_span("material"), what, instead));
        }
        found.push((group.to_owned(), *bending));
    }
    Ok(found)
}

/// A group of the mesh, by name.
pub(super) fn group<'a>(table: &Settings<'a>, key: &str, source: &Source) -> Result<&'a str, FileError> {
    let group = name(table, key)?;
    let known: BTreeSet<&str> = source.mesh.blocks.iter().map(|block| block.group.as_str()).collect();
    if known.contains(group) {
        return Ok(group);
    }
    let list: Vec<&str> = known.iter().copied().filter(|name| !name.is_empty()).collect();
    let what = format!("the mesh has no group `{group}`");
    let instead = match bulge_muscles::settings::nearest(group, list.iter().copied()) {
        Some(near) => format!("did you mean `{near}`? It has {}", listed(20, "", list)),
        None if list.is_empty() => "the mesh has no named groups: give it physical groups".to_owned(),
        None => format!("it has {}", listed(20, "", list)),
    };
    Err(table.error(table.value_span(key), what, instead))
}

fn check_keys(table: &Settings<'_>, kind: Kind) -> Result<(), FileError> {
    for (key, _) in KEYS {
        if table.get(key).is_some() && !["group", "kind"].contains(key) && !known(kind).contains(key) {
            let what = format!("this kind of part has no `{key}`");
            let instead = match known(kind) {
                [] => "a facet only hands the pressure on: leave it out".to_owned(),
                keys => format!("it has {}", keys.join(", ")),
            };
            return Err(table.error(table.key_span(key), what, instead));
        }
    }
    Ok(())
}

fn check_cells(table: &Settings<'_>, source: &Source, group: &str, kind: Kind) -> Result<(), FileError> {
    let wants_lines = matches!(kind, Kind::Sheet | Kind::Threads | Kind::Cable);
    for block in source.mesh.blocks.iter().filter(|block| block.group == group) {
        let is_line = matches!(block.kind, CellKind::Line2 | CellKind::Line3);
        if block.kind != CellKind::Point && is_line != wants_lines {
            let (are, made) = if is_line {
                ("lines", "a cable, or threads and sheets that are revolved")
            } else {
                ("triangles", "a membrane or a facet")
            };
            let what = format!("the cells of `{group}` are {are}, of which this part can't be made");
            return Err(table.error(table.value_span("kind"), what, format!("of {are} make {made}")));
        }
        if matches!(kind, Kind::Sheet | Kind::Threads) {
            let off = block
                .cells
                .iter()
                .map(|node| source.mesh.nodes[*node])
                .find(|[x, y, _]| *x < 0.0 || y.abs() > 1e-9 * x.abs().max(1e-9));
            if let Some([x, y, z]) = off {
                let what =
                    format!("`{group}` is to be revolved about z, but has a node at ({x:e}, {y:e}, {z:e}) m");
                return Err(table.error(
                    table.value_span("group"),
                    what,
                    "put the line into the half-plane y = 0, x >= 0",
                ));
            }
        }
    }
    Ok(())
}

fn part(
    table: &Settings<'_>,
    kind: Kind,
    source: &Source,
    materials: &[(String, Sheet)],
) -> Result<Part, FileError> {
    let stiffness = || -> Result<Thread, FileError> {
        let stated = positive(table, "stiffness", Dimension::FORCE)?;
        let known = source.muscle.as_ref().and_then(Muscle::fibre).map(|f| f.stiffness().to_n());
        Ok(stated.or(known).map_or(Thread::Inextensible, |stiffness| Thread::Elastic { stiffness }))
    };
    Ok(match kind {
        Kind::Sheet => {
            let fullness = positive(table, "fullness", Dimension::NONE)?.unwrap_or(1.0);
            Part::Revolved { layers: vec![RingLayer::Sheet { sheet: material(table, materials)?, fullness }] }
        }
        Kind::Threads => {
            let muscle = source.muscle.as_ref();
            let count = match (table.count::<u32>("fibres")?, muscle.and_then(Muscle::fibres)) {
                (Some(0), _) => {
                    let what = "0 threads are none";
                    return Err(table.error(table.value_span("fibres"), what, "leave the part out"));
                }
                (Some(count), _) | (None, Some(count)) => count,
                // Only their sum matters if they are inextensible.
                (None, None) => 1,
            };
            let braid = muscle.and_then(|muscle| muscle.get(Parameter::BraidAngle));
            let steepest = 89.0_f64.to_radians();
            let range = "from 0 to 89 degrees to the meridian";
            let angle = in_range(table, "angle", Dimension::NONE, |a| (0.0..=steepest).contains(&a), range)?;
            let layer = RingLayer::Threads {
                thread: stiffness()?,
                count: f64::from(count),
                angle: angle.or(braid).unwrap_or(0.0),
            };
            Part::Revolved { layers: vec![layer] }
        }
        Kind::Membrane => Part::Membrane {
            sheet: Some(material(table, materials)?),
            warp: direction(table, "warp")?.unwrap_or([1.0, 0.0, 0.0]),
        },
        Kind::Facet => Part::Membrane { sheet: None, warp: [1.0, 0.0, 0.0] },
        Kind::Cable => {
            let share = number(table, "share", |x| x > 0.0 && x <= 1.0, "above 0 and at most 1")?;
            // In meshes of our own mesher, half a fibre lies on a plane of symmetry.
            let usual = if source
                .supports
                .iter()
                .any(|(name, _)| Some(name.as_str()) == table.get("group").and_then(Setting::text))
            {
                0.5
            } else {
                1.0
            };
            Part::Cable { thread: stiffness()?, share: share.unwrap_or(usual) }
        }
    })
}

fn material(table: &Settings<'_>, materials: &[(String, Sheet)]) -> Result<Sheet, FileError> {
    let wanted = name(table, "material")?;
    if let Some((_, sheet)) = materials.iter().find(|(name, _)| name == wanted) {
        return Ok(*sheet);
    }
    let known: Vec<&str> = materials.iter().map(|(name, _)| name.as_str()).collect();
    let instead = if known.is_empty() {
        "add a `[[material]]`".to_owned()
    } else {
        format!("there is {}", listed(20, "", known))
    };
    Err(table.error(table.value_span("material"), format!("there is no material `{wanted}`"), instead))
}
