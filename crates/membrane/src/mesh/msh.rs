//! Meshes of Gmsh: MSH 4.1 and 2.2, text and binary, <https://gmsh.info/doc/texinfo/gmsh.html#Gmsh-file-formats>.

mod assembly;
mod cursor;
mod legacy;
mod modern;
mod writer;

pub(super) use cursor::{find, quoted};

use super::{Mesh, MeshError};
use assembly::Assembly;
use cursor::{CUT, Cursor, DAMAGED, Encoding};

/// Remedy for an unsupported version.
const SAVE_AS: &str = "save it again as MSH 4.1 or 2.2 (`gmsh old.msh -save -format msh41 -o new.msh`)";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    Legacy,
    Modern,
}

impl Mesh {
    /// Reads a mesh of Gmsh: MSH 4.1 or 2.2, text or binary of either byte order. `origin` is the file's name
    /// in messages.
    ///
    /// A block contains the points, lines or triangles of one order in a physical group, in the order of the
    /// file. Groups with the same dimension and name are merged. A group without a name is named by its
    /// number, such as `7`. An element in several groups occurs in the block of each. If its surface or curve
    /// belongs to a group with a minus sign, it is reversed there, as Gmsh does when it saves as version 2.
    /// Elements without a physical group are only kept if the file has no groups of their dimension, in
    /// blocks without a name, because with `Save all elements` Gmsh also writes auxiliary geometry. All nodes
    /// are kept, used or not.
    ///
    /// # Errors
    ///
    /// If the file can't be read or isn't a mesh of points, lines and triangles of order 1 or 2. The error
    /// has the line (text) or the byte (binary).
    pub fn from_msh(bytes: &[u8], origin: &str) -> Result<Self, MeshError> {
        let mut cursor = Cursor::new(origin, bytes);
        let version = header(&mut cursor)?;
        let mut assembly = Assembly::default();
        let mut entities = None;
        let mut sections = Vec::new();
        while let Some(name) = cursor.open_section()? {
            let is_needed = matches!(name, "PhysicalNames" | "Entities" | "Nodes" | "Elements");
            if is_needed && sections.contains(&name) {
                return Err(
                    cursor.error(format_args!("the section ${name} stands in the file twice"), DAMAGED)
                );
            }
            // Elements are added to the mesh while they are read.
            if is_needed && sections.contains(&"Elements")
                || name == "Elements" && !sections.contains(&"Nodes")
            {
                let what = if name == "Elements" {
                    "there is no $Nodes before $Elements".to_owned()
                } else {
                    format!("${name} comes too late")
                };
                let order = "order the sections as Gmsh does: $PhysicalNames, $Entities, $Nodes, $Elements";
                return Err(cursor.error(what, order));
            }
            match (name, version) {
                ("PhysicalNames", _) => names(&mut cursor, &mut assembly)?,
                ("Entities", Version::Modern) => entities = Some(modern::entities(&mut cursor)?),
                ("Nodes", Version::Modern) => modern::nodes(&mut cursor, &mut assembly)?,
                ("Nodes", Version::Legacy) => legacy::nodes(&mut cursor, &mut assembly)?,
                ("Elements", Version::Modern) => {
                    modern::elements(&mut cursor, entities.as_ref(), &mut assembly)?;
                }
                ("Elements", Version::Legacy) => legacy::elements(&mut cursor, &mut assembly)?,
                ("PartitionedEntities", _) => {
                    let instead = "save the mesh without partitions (in Gmsh: Mesh > Unpartition)";
                    return Err(cursor.error("the mesh is partitioned", instead));
                }
                ("ParametricNodes", _) => {
                    let instead = "save it without `Mesh.SaveParametric`, or as MSH 4.1";
                    return Err(cursor.error("the nodes have parametric coordinates", instead));
                }
                _ => {
                    cursor.skip_section(name)?;
                    continue;
                }
            }
            cursor.close_section(name)?;
            sections.push(name);
        }
        for needed in ["Nodes", "Elements"] {
            if !sections.contains(&needed) {
                let what = format!("there is no section ${needed}");
                return Err(cursor.error_of_file(
                    what,
                    "mesh the geometry before saving it; or the file is cut: copy it again",
                ));
            }
        }
        assembly.finish(&cursor)
    }
}

/// Version, encoding and byte order.
fn header(cursor: &mut Cursor) -> Result<Version, MeshError> {
    match cursor.open_section() {
        Ok(Some("MeshFormat")) => {}
        Ok(Some("NOD")) => return Err(cursor.error("the file is of version 1 of MSH", SAVE_AS)),
        _ => {
            let instead = "give a mesh of Gmsh (.msh), not its geometry (.geo)";
            return Err(cursor.error("the file doesn't begin with `$MeshFormat`", instead));
        }
    }
    cursor.begin_record();
    let version: f64 = cursor.written("the version of the format")?;
    let version = match version {
        4.1 => Version::Modern,
        2.2 => Version::Legacy,
        _ => return Err(cursor.error(format_args!("the file is of version {version} of MSH"), SAVE_AS)),
    };
    let file_type: i32 = cursor.written("the type of the file")?;
    let is_binary = match file_type {
        0 => false,
        1 => true,
        _ => {
            let what = format!("the type of the file is {file_type} where 0 is text and 1 is binary");
            return Err(cursor.error(what, DAMAGED));
        }
    };
    let size: i32 = cursor.written("the size of data")?;
    if size != 8 {
        let what = format!("numbers have {size} bytes where 8 are expected");
        return Err(cursor.error(what, "save the mesh as text, or on a system of 64 bits"));
    }
    cursor.end_line("the format")?;
    if is_binary {
        cursor.encoding = match cursor.array("the mark of the byte order")? {
            [1, 0, 0, 0] => Encoding::LittleEndian,
            [0, 0, 0, 1] => Encoding::BigEndian,
            _ => return Err(cursor.error("the mark of the byte order is not a one", CUT)),
        };
    }
    cursor.close_section("MeshFormat")?;
    Ok(version)
}

/// Names of the physical groups, which are text in every file.
fn names(cursor: &mut Cursor, assembly: &mut Assembly) -> Result<(), MeshError> {
    for _ in 0..cursor.counted_line("the number of names", (7, 7))? {
        let line = cursor.line();
        // The name ends at the line's last quotation mark, because Gmsh doesn't escape those within a name.
        let parsed = std::str::from_utf8(line).ok().and_then(|line| {
            let (numbers, name) = line.split_once('"')?;
            let name = name.strip_suffix('"')?;
            let mut numbers = numbers.split_ascii_whitespace();
            let dimension = numbers.next()?.parse().ok().filter(|dimension| *dimension <= 3)?;
            let group = numbers.next()?.parse().ok()?;
            numbers.next().is_none().then_some((dimension, group, name))
        });
        let Some((dimension, group, name)) = parsed else {
            return Err(cursor.error(
                format_args!("`{}` is no name of a physical group", quoted(line)),
                "write its dimension, its number and its name in quotation marks, as UTF-8: `2 1 \"cloth\"`",
            ));
        };
        if !assembly.name(dimension, group, name) {
            let what = format!("physical group {group} of dimension {dimension} has two names");
            return Err(cursor.error(what, DAMAGED));
        }
    }
    Ok(())
}
