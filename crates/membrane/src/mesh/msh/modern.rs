//! Sections of MSH 4.1: <https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format>.

use super::super::MeshError;
use super::assembly::{self, Assembly};
use super::cursor::{Cursor, DAMAGED};
use std::collections::HashMap;

/// Most physical groups of one point, curve or surface; bounds how often its elements are repeated.
const MOST_GROUPS: usize = 64;

/// The physical groups of the points, curves and surfaces, by dimension and number. A negative number
/// reverses the elements.
pub(super) type Entities = HashMap<(i32, i32), Vec<i32>>;

pub(super) fn entities(cursor: &mut Cursor) -> Result<Entities, MeshError> {
    let mut entities = Entities::new();
    cursor.begin_record();
    let counts = [
        cursor.count("the number of points", (10, 36))?,
        cursor.count("the number of curves", (18, 68))?,
        cursor.count("the number of surfaces", (18, 68))?,
        cursor.count("the number of volumes", (18, 68))?,
    ];
    cursor.end_record("the numbers of points, curves, surfaces and volumes")?;
    for (dimension, (count, name)) in
        (0..).zip(counts.into_iter().zip(["point", "curve", "surface", "volume"]))
    {
        for _ in 0..count {
            cursor.begin_record();
            let tag = cursor.int(format_args!("the number of a {name}"))?;
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                // The bounding box of geometry without extent may be infinite; it isn't needed.
                cursor.any_number(format_args!("a coordinate of {name} {tag}"))?;
            }
            let groups = cursor.count("the number of physical groups", (2, 4))?;
            if groups > MOST_GROUPS {
                let what = format!("{name} {tag} is in {groups} physical groups");
                return Err(cursor.error(what, &format!("put it into {MOST_GROUPS} at most")));
            }
            let mut tags = Vec::with_capacity(groups);
            for _ in 0..groups {
                tags.push(cursor.int(format_args!("a physical group of {name} {tag}"))?);
            }
            if dimension > 0 {
                for _ in 0..cursor.count("the number of bounding entities", (2, 4))? {
                    cursor.int(format_args!("a part of the boundary of {name} {tag}"))?;
                }
            }
            cursor.end_record(format_args!("{name} {tag}"))?;
            if entities.insert((dimension, tag), tags).is_some() {
                return Err(cursor.error(format_args!("{name} {tag} stands in $Entities twice"), DAMAGED));
            }
        }
    }
    Ok(entities)
}

pub(super) fn nodes(cursor: &mut Cursor, assembly: &mut Assembly) -> Result<(), MeshError> {
    let (blocks, total) = head(cursor, "nodes", (8, 32))?;
    assembly.reserve_nodes(total);
    let mut found = 0;
    let mut tags = Vec::new();
    for _ in 0..blocks {
        cursor.begin_record();
        let dimension = cursor.int("the dimension of a block of nodes")?;
        cursor.int("the entity of a block of nodes")?;
        let parametric = cursor.int("the mark of parametric coordinates")?;
        let parameters = match (parametric, dimension) {
            (0, 0..=3) | (1, 0) => 0,
            (1, 1..=3) => dimension,
            _ => {
                let what = format!(
                    "a block of nodes has dimension {dimension} and the parametric mark {parametric}"
                );
                return Err(cursor.error(what, DAMAGED));
            }
        };
        let count = cursor.count("the number of nodes in a block", (8, 32))?;
        found += count;
        if found > total {
            break;
        }
        cursor.end_record("a block of nodes")?;
        tags.clear();
        for _ in 0..count {
            cursor.begin_record();
            tags.push(cursor.size("the number of a node")?);
            cursor.end_record("the number of a node")?;
        }
        for tag in tags.iter().copied() {
            cursor.begin_record();
            let mut place = [0.0; 3];
            for (axis, coordinate) in ["x", "y", "z"].into_iter().zip(&mut place) {
                *coordinate = cursor.number(format_args!("coordinate {axis} of node {tag}"))?;
            }
            for _ in 0..parameters {
                cursor.any_number(format_args!("a parametric coordinate of node {tag}"))?;
            }
            assembly.add_node(cursor, tag, place)?;
            cursor.end_record(format_args!("node {tag}"))?;
        }
    }
    agree(cursor, "nodes", total, found)
}

pub(super) fn elements(
    cursor: &mut Cursor,
    entities: Option<&Entities>,
    assembly: &mut Assembly,
) -> Result<(), MeshError> {
    let (blocks, total) = head(cursor, "elements", (4, 16))?;
    let mut found = 0;
    for _ in 0..blocks {
        cursor.begin_record();
        let dimension = cursor.int("the dimension of a block of elements")?;
        let entity = cursor.int("the entity of a block of elements")?;
        let element_type = cursor.int("the type of a block of elements")?;
        let count = cursor.count("the number of elements in a block", (4, 16))?;
        found += count;
        if found > total {
            break;
        }
        cursor.end_record("a block of elements")?;
        let mut groups = Vec::new();
        let mut known = None;
        for _ in 0..count {
            cursor.begin_record();
            let number = cursor.size("the number of an element")?;
            let kind = if let Some(kind) = known {
                kind
            } else {
                let kind = assembly::kind(cursor, element_type, number)?;
                if i32::from(assembly::dimension(kind)) != dimension {
                    let what = format!("element {number} can't be on an entity of dimension {dimension}");
                    return Err(cursor.error(what, DAMAGED));
                }
                for group in groups_of(cursor, entities, (dimension, entity))? {
                    let block = assembly.block(group.map(i32::unsigned_abs), kind);
                    // Groups with the same name are one group, which contains an element once.
                    if groups.iter().all(|(other, _)| *other != block) {
                        groups.push((block, group.is_some_and(i32::is_negative)));
                    }
                }
                *known.insert(kind)
            };
            let node = |cursor: &mut Cursor| cursor.size(format_args!("a node of element {number}"));
            let nodes = assembly.element(cursor, kind, number, node)?;
            for (block, is_reversed) in &groups {
                assembly.add_cell(*block, number, &nodes, *is_reversed);
            }
            cursor.end_record(format_args!("element {number}"))?;
        }
    }
    agree(cursor, "elements", total, found)
}

/// The physical groups of an entity, each once; a single `None` if there are none.
fn groups_of(
    cursor: &Cursor,
    entities: Option<&Entities>,
    entity: (i32, i32),
) -> Result<Vec<Option<i32>>, MeshError> {
    // Without a section $Entities there are no groups.
    let Some(entities) = entities else {
        return Ok(vec![None]);
    };
    let Some(tags) = entities.get(&entity) else {
        let (dimension, tag) = entity;
        let what =
            format!("there are elements on entity {tag} of dimension {dimension}, which isn't in $Entities");
        return Err(cursor.error(what, DAMAGED));
    };
    Ok(if tags.is_empty() { vec![None] } else { tags.iter().copied().map(Some).collect() })
}

/// The first line of a section: the number of blocks, and the total number of nodes or elements.
fn head(cursor: &mut Cursor, things: &str, each: (u64, u64)) -> Result<(usize, usize), MeshError> {
    cursor.begin_record();
    let blocks = cursor.count(&format!("the number of blocks of {things}"), (8, 20))?;
    let total = cursor.count(&format!("the number of {things}"), each)?;
    // Their least and largest numbers are only useful for allocating by number.
    cursor.size("the least number")?;
    cursor.size("the largest number")?;
    cursor.end_record(format_args!("the number of {things}"))?;
    Ok((blocks, total))
}

fn agree(cursor: &Cursor, things: &str, declared: usize, found: usize) -> Result<(), MeshError> {
    if declared == found {
        return Ok(());
    }
    let more = if found > declared { " or more" } else { "" };
    let what = format!("the section declares {declared} {things}, but its blocks have {found}{more}");
    Err(cursor.error_here(what, DAMAGED))
}
