//! Sections of MSH 2.2: <https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format-version-2-_0028Legacy_0029>.

use super::super::MeshError;
use super::assembly::{self, Assembly};
use super::cursor::{Cursor, DAMAGED};

pub(super) fn nodes(cursor: &mut Cursor, assembly: &mut Assembly) -> Result<(), MeshError> {
    let count = cursor.counted_line("the number of nodes", (8, 28))?;
    assembly.reserve_nodes(count);
    for _ in 0..count {
        cursor.begin_record();
        let tag = number(cursor, "the number of a node")?;
        let mut place = [0.0; 3];
        for (axis, coordinate) in ["x", "y", "z"].into_iter().zip(&mut place) {
            *coordinate = cursor.number(format_args!("coordinate {axis} of node {tag}"))?;
        }
        assembly.add_node(cursor, tag, place)?;
        cursor.end_record(format_args!("node {tag}"))?;
    }
    Ok(())
}

pub(super) fn elements(cursor: &mut Cursor, assembly: &mut Assembly) -> Result<(), MeshError> {
    let count = cursor.counted_line("the number of elements", (8, 8))?;
    let mut left = count;
    while left > 0 {
        if cursor.is_text() {
            cursor.begin_record();
            let tag = number(cursor, "the number of an element")?;
            let element_type = cursor.int(format_args!("the type of element {tag}"))?;
            let tags = cursor.int(format_args!("the number of tags of element {tag}"))?;
            element(cursor, assembly, tag, element_type, tags)?;
            cursor.end_record(format_args!("element {tag}"))?;
            left -= 1;
        } else {
            let element_type = cursor.int("the type of a block of elements")?;
            let block = cursor.int("the number of elements in a block")?;
            let follow = usize::try_from(block).ok().filter(|follow| (1..=left).contains(follow));
            let Some(follow) = follow else {
                let what = format!("a block has {block} elements where 1 to {left} are left");
                return Err(cursor.error(what, DAMAGED));
            };
            let tags = cursor.int("the number of tags of a block of elements")?;
            for _ in 0..follow {
                let tag = number(cursor, "the number of an element")?;
                element(cursor, assembly, tag, element_type, tags)?;
            }
            left -= follow;
        }
    }
    Ok(())
}

/// The tags and the nodes of an element.
fn element(
    cursor: &mut Cursor,
    assembly: &mut Assembly,
    tag: u64,
    element_type: i32,
    tags: i32,
) -> Result<(), MeshError> {
    let kind = assembly::kind(cursor, element_type, tag)?;
    let mut group = 0;
    for place in 0..tags {
        let value = cursor.int(format_args!("a tag of element {tag}"))?;
        // Physical group, geometric entity, number of partitions, the partitions.
        if place == 0 {
            group = u32::try_from(value).map_err(|_| {
                let what = format!("element {tag} is in the physical group {value}, below zero");
                cursor.error(what, "save the mesh with Gmsh 3 or later")
            })?;
        } else if place == 2 && value > 0 && tags > 3 {
            return Err(cursor.error(
                format_args!("element {tag} is in a partition: the file may have a part of the mesh only"),
                "save the mesh without partitions (in Gmsh: Mesh > Unpartition)",
            ));
        }
    }
    let block = assembly.block((group > 0).then_some(group), kind);
    let node = |cursor: &mut Cursor| number(cursor, format_args!("a node of element {tag}"));
    let nodes = assembly.element(cursor, kind, tag, node)?;
    assembly.add_cell(block, tag, &nodes, false);
    Ok(())
}

/// The number of a node or an element; four bytes in binary files.
fn number(cursor: &mut Cursor, what: impl std::fmt::Display) -> Result<u64, MeshError> {
    if cursor.is_text() {
        return cursor.written(what);
    }
    let value = cursor.int(&what)?;
    u64::try_from(value).map_err(|_| cursor.error(format_args!("{what} is {value}, below zero"), DAMAGED))
}
