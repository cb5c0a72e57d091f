//! The mesh readers: files from other programs, every variant of the formats, every defect with its message,
//! and damage of all kinds.

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::too_many_lines,
    clippy::struct_excessive_bools,
    reason = "a test that cannot be set up fails; tables of defects are long"
)]

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use bulge_membrane::{Block, CellKind, Mesh};
use std::io::Write as _;

/// Files of Gmsh, VTK and meshio; `data/README.md` describes their origin.
const GMSH: [(&str, &[u8]); 4] = [
    ("gmsh-4.1-text.msh", include_bytes!("../data/gmsh-4.1-text.msh")),
    ("gmsh-4.1-binary.msh", include_bytes!("../data/gmsh-4.1-binary.msh")),
    ("gmsh-2.2-text.msh", include_bytes!("../data/gmsh-2.2-text.msh")),
    ("gmsh-2.2-binary.msh", include_bytes!("../data/gmsh-2.2-binary.msh")),
];
const VTK: [(&str, &[u8]); 4] = [
    ("vtk-ascii.vtu", include_bytes!("../data/vtk-ascii.vtu")),
    ("vtk-binary.vtu", include_bytes!("../data/vtk-binary.vtu")),
    ("vtk-appended.vtu", include_bytes!("../data/vtk-appended.vtu")),
    ("meshio.vtu", include_bytes!("../data/meshio.vtu")),
];

/// The positions in those files: corners, then midpoints of edges.
const PLACES: [[f64; 3]; 9] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.25],
    [0.0, 1.0, 0.0],
    [0.5, 0.0, 0.0],
    [1.0, 0.5, 0.125],
    [0.5, 0.5, 0.125],
    [0.5, 1.0, 0.125],
    [0.0, 0.5, 0.0],
];

#[track_caller]
fn reads(bytes: impl AsRef<[u8]>) -> Mesh {
    Mesh::from_bytes(bytes.as_ref(), "m").unwrap_or_else(|error| panic!("{error}"))
}

/// Requires a message with these parts that names the line.
#[track_caller]
fn refuses(bytes: impl AsRef<[u8]>, place: &str, parts: &[&str]) {
    let error = Mesh::from_bytes(bytes.as_ref(), "m").expect_err(&format!("{parts:?}"));
    assert_eq!(error.file, place, "{error}");
    for part in parts {
        assert!(error.to_string().contains(part), "{error}\n  does not say {part:?}");
    }
    assert!(error.what.len() < 300 && !error.what.contains('\n'), "{error}");
    assert!(!error.instead.is_empty());
}

fn block(group: &str, kind: CellKind, cells: &[usize], numbers: &[u64]) -> Block {
    Block { group: group.to_owned(), kind, cells: cells.to_vec(), numbers: numbers.to_vec(), pattern: None }
}

#[test]
fn files_of_gmsh() {
    for (name, bytes) in GMSH {
        let mesh = reads(bytes);
        assert_eq!(mesh.numbers, [1, 2, 3, 4, 5, 6, 7, 8, 9], "{name}");
        for (node, place) in mesh.nodes.iter().zip(PLACES) {
            assert!(node.iter().zip(place).all(|(a, b)| (a - b).abs() < 1e-9), "{name}: {node:?}");
        }
        // Version 2 gives an element a number for each of its groups.
        let (upper, again) = if name.contains("4.1") { (5, 4) } else { (6, 5) };
        let expected = [
            block("corner", CellKind::Point, &[0], &[1]),
            block("held edge", CellKind::Line3, &[1, 0, 4, 2, 3, 7], &[2, 3]),
            block("cloth \"fine\"", CellKind::Triangle6, &[0, 1, 2, 4, 5, 6, 0, 3, 2, 8, 7, 6], &[4, upper]),
            block("7", CellKind::Triangle6, &[0, 1, 2, 4, 5, 6], &[again]),
        ];
        assert_eq!(mesh.blocks, expected, "{name}");
    }
}

#[test]
fn files_of_vtk_and_meshio() {
    for (name, bytes) in VTK {
        let mesh = reads(bytes);
        assert_eq!(mesh.nodes, PLACES, "{name}");
        assert_eq!(mesh.numbers, [0, 1, 2, 3, 4, 5, 6, 7, 8]);
        let is_vtk = name.starts_with("vtk");
        let groups = if is_vtk { ["cloth fine", "held édge", "7"] } else { ["1", "2", ""] };
        let mut expected = [
            block(groups[0], CellKind::Triangle6, &[0, 1, 2, 4, 5, 6, 0, 2, 3, 6, 7, 8], &[0, 1]),
            block(groups[1], CellKind::Line3, &[0, 1, 4], &[2]),
            block(groups[2], CellKind::Point, &[2], &[3]),
        ];
        for block in expected.iter_mut().filter(|_| is_vtk) {
            let twice = |node: &usize| [2.0 * PLACES[*node][0], 2.0 * PLACES[*node][1]];
            block.pattern = Some(block.cells.iter().map(twice).collect());
        }
        assert_eq!(mesh.blocks, expected, "{name}");
    }
}

const LEGACY: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 2 \"edge\"\n2 1 \"cloth\"\n$EndPhysicalNames\n\
    $Nodes\n4\n10 0 0 0\n20 1 0 0\n30 0 1 0\n4000000000000 0.5 0 0\n$EndNodes\n\
    $Elements\n3\n1 2 2 1 1 10 20 30\n2 1 2 2 1 10 20\n3 8 2 2 1 10 20 4000000000000\n$EndElements\n";

const MODERN: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 2 \"edge\"\n2 1 \"cloth\"\n$EndPhysicalNames\n\
    $Entities\n1 1 1 0\n1 0 0 0 0\n1 0 0 0 1 0 0 1 2 0\n1 0 0 0 1 1 0 1 1 1 1\n$EndEntities\n\
    $Nodes\n2 4 10 4000000000000\n1 1 1 2\n10\n20\n0 0 0 0.5\n1 0 0 0.75\n2 1 0 2\n30\n4000000000000\n0 1 0\n0.5 0 0\n$EndNodes\n\
    $Elements\n3 3 1 3\n2 1 2 1\n1 10 20 30\n1 1 1 1\n2 10 20\n1 1 8 1\n3 10 20 4000000000000\n$EndElements\n";

fn small() -> Mesh {
    Mesh {
        nodes: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0]],
        numbers: vec![10, 20, 30, 4_000_000_000_000],
        blocks: vec![
            block("cloth", CellKind::Triangle3, &[0, 1, 2], &[1]),
            block("edge", CellKind::Line2, &[0, 1], &[2]),
            block("edge", CellKind::Line3, &[0, 1, 3], &[3]),
        ],
    }
}

#[test]
fn text_of_both_versions_in_every_dress() {
    for text in [LEGACY, MODERN] {
        assert_eq!(reads(text), small());
        assert_eq!(reads(text.replace('\n', "\r\n")), small());
        assert_eq!(reads(format!("\u{feff}\n{}", text.replace('\n', " \t\n\n"))), small());
        assert_eq!(reads(text.trim_end()), small());
        let more = "$Comments\n$Nodes is not a section here, $EndCommentsNo\n$EndComments\n$Periodic\n1\n$EndPeriodic\n";
        assert_eq!(reads(text.replace("$Nodes", &format!("{more}$Nodes"))), small());
        assert_eq!(reads(format!("{text}{more}$NodeData\n1 2 $x\n$EndNodeData")), small());
        assert_eq!(reads(text.replace("2\n1 2 \"edge\"", "3\n3 1 \"\"\n1 2 \"edge\"")), small());
    }
}

#[test]
fn groups() {
    let groups =
        |mesh: Mesh| mesh.blocks.into_iter().map(|block| (block.group, block.numbers)).collect::<Vec<_>>();
    let named = |name: &str, numbers: &[u64]| (name.to_owned(), numbers.to_vec());
    // Without a name, and with unusual ones.
    let legacy = |from, to| groups(reads(LEGACY.replace(from, to)));
    assert_eq!(legacy("2 1 \"cloth\"", "2 9 \"cloth\"")[0], named("1", &[1]));
    assert_eq!(legacy("\"cloth\"", "\"\"")[0], named("1", &[1]));
    assert_eq!(legacy("\"cloth\"", "\" a \\\"b\\\" c\" ")[0], named(" a \\\"b\\\" c", &[1]));
    // Names apply to one dimension.
    assert_eq!(legacy("2 1 \"cloth\"", "1 1 \"cloth\"")[0], named("1", &[1]));
    // Elements without a group are dropped if others have one, dimension by dimension.
    assert_eq!(legacy("2 1 2 2 1 10 20", "2 1 2 0 1 10 20")[1..], [named("edge", &[3])]);
    assert_eq!(legacy("1 2 2 1 1 10", "1 2 0 10")[0], named("", &[1]));
    // Two groups with the same name are merged; an element occurs once.
    let two = MODERN
        .replace("2\n1 2 \"edge\"", "3\n2 5 \"cloth\"\n1 2 \"edge\"")
        .replace("1 1 0 1 1 1 1", "1 1 0 2 1 5 1 1");
    assert_eq!(groups(reads(&two))[0], named("cloth", &[1]));
    // In both groups; reversed in the second.
    let both = reads(MODERN.replace("1 1 0 1 1 1 1", "1 1 0 2 1 -8 1 1"));
    assert_eq!(
        both.blocks[..2],
        [
            block("cloth", CellKind::Triangle3, &[0, 1, 2], &[1]),
            block("8", CellKind::Triangle3, &[0, 2, 1], &[1]),
        ]
    );
    // No $Entities: no groups.
    let (head, rest) = MODERN.split_once("$Entities").unwrap();
    let (_, tail) = rest.split_once("$EndEntities").unwrap();
    assert_eq!(groups(reads(format!("{head}{tail}"))), [named("", &[1]), named("", &[2]), named("", &[3])]);
}

#[test]
fn every_defect_of_text_has_its_message() {
    let modern = |from: &str, to: &str, line: usize, parts: &[&str]| {
        assert!(MODERN.contains(from), "{from}");
        refuses(MODERN.replacen(from, to, 1), &format!("m:{line}"), parts);
    };
    let legacy = |from: &str, to: &str, line: usize, parts: &[&str]| {
        assert!(LEGACY.contains(from), "{from}");
        refuses(LEGACY.replacen(from, to, 1), &format!("m:{line}"), parts);
    };
    modern("4.1 0 8", "4 0 8", 2, &["version 4 of MSH", "MSH 4.1 or 2.2"]);
    modern("4.1 0 8", "3 0 8", 2, &["version 3"]);
    modern("4.1 0 8", "4.1 0 4", 2, &["4 bytes", "64 bits"]);
    modern("4.1 0 8", "4.1 2 8", 2, &["type of the file is 2"]);
    modern("4.1 0 8", "4.1 0 8 8", 2, &["`8` is too much"]);
    modern("$EndMeshFormat", "", 4, &["no `$EndMeshFormat`, but `$PhysicalNames`"]);
    modern("\"cloth\"", "cloth", 7, &["`2 1 cloth`", "quotation marks"]);
    modern("1 2 \"edge\"", "2 1 \"edge\"", 7, &["physical group 1 of dimension 2 has two names"]);
    modern("2\n1 2 \"edge\"", "3\n1 2 \"edge\"", 8, &["`$EndPhysicalNames` is no name"]);
    modern("1 0 0 0 0\n", "1 0 0 0 9\n", 11, &["a physical group of point 1 is missing: the line ends"]);
    modern(
        "1 0 0 0 1 0 0 1 2 0",
        "1 0 0 0 1 0 0 1 2",
        12,
        &["number of bounding entities is missing: the line ends"],
    );
    modern("1 1 1 0\n", "1 1 2 0\n", 14, &["the number of a surface is missing: `$EndEntities`"]);
    modern("1 1 1 0\n", "1 1 0 0\n", 13, &["after what $Entities declares", "`1 0 0 0 1 1 0 1 1 1 1`"]);
    modern("2 4 10", "2 5 10", 27, &["declares 5 nodes, but its blocks have 4"]);
    modern("2 4 10", "2 3 10", 22, &["declares 3 nodes", "4 or more"]);
    modern("2 4 10", "2 99999999999999 10", 16, &["number of nodes is 99999999999999", "bytes follow"]);
    modern("2 4 10", "18446744073709551615 4 10", 16, &["number of blocks of nodes", "bytes follow"]);
    modern("1 1 1 2\n", "1 1 2 2\n", 17, &["parametric mark 2"]);
    modern("1 1 1 2\n", "1 1 0 2\n", 20, &["`0.5` is too much on the line of node 10"]);
    modern("\n20\n", "\n10\n", 21, &["node 10 stands in the file twice"]);
    modern("\n20\n", "\nx\n", 19, &["number of a node can't be `x`"]);
    modern("\n20\n", "\n-20\n", 19, &["number of a node can't be `-20`"]);
    modern("1 0 0 0.75", "1 0 nan 0.75", 21, &["coordinate z of node 20 is NaN"]);
    modern("1 0 0 0.75", "1 1e999 0 0.75", 21, &["coordinate y of node 20 is inf"]);
    modern("0 1 0\n0.5", "0 1\n0.5", 25, &["coordinate z of node 30 is missing: the line ends"]);
    modern("$Elements\n3 3", "$Elements\n3 4", 36, &["declares 4 elements, but its blocks have 3"]);
    modern("2 1 2 1\n", "2 1 3 1\n", 31, &["element 1 is a 4-node quadrangle", "triangles"]);
    modern("2 1 2 1\n", "2 1 4 1\n", 31, &["element 1 is a 4-node tetrahedron", "only the surfaces"]);
    modern("2 1 2 1\n", "2 1 21 1\n", 31, &["element 1 is a 10-node triangle", "order 1 or 2"]);
    modern("2 1 2 1\n", "2 1 99 1\n", 31, &["element 1 is of type 99"]);
    modern("2 1 2 1\n", "1 1 2 1\n", 31, &["element 1 can't be on an entity of dimension 1"]);
    modern("2 1 2 1\n", "2 6 2 1\n", 31, &["entity 6 of dimension 2", "isn't in $Entities"]);
    modern("1 10 20 30", "1 10 20 31", 31, &["element 1 needs node 31"]);
    modern("1 10 20 30", "1 10 20 10", 31, &["element 1 has node 10 twice"]);
    modern("1 10 20 30", "1 10 20", 31, &["a node of element 1 is missing: the line ends"]);
    modern("1 10 20 30", "1 10 20 30 30", 31, &["`30` is too much on the line of element 1"]);
    modern("$EndElements\n", "$EndElement\n", 36, &["no `$EndElements`, but `$EndElement`"]);
    modern("$EndElements\n", "$EndEl", 36, &["the file ends before `$EndElements`", "cut"]);
    modern("$EndElements\n", "$EndElements\n$NodeData\n", 37, &["$NodeData has no `$EndNodeData`"]);
    modern("$Nodes", "Nodes", 15, &["`Nodes` stands where a section", "$Comments"]);
    modern("$Nodes", "$PartitionedEntities\n$Nodes", 15, &["partitioned", "Unpartition"]);
    modern("$Nodes", "$Elements\n0 0 0 0\n$EndElements\n$Nodes", 15, &["no $Nodes before $Elements"]);
    modern(
        "$Entities",
        "$PhysicalNames\n0\n$EndPhysicalNames\n$Entities",
        9,
        &["$PhysicalNames stands in the file twice"],
    );
    let many = format!("1 1 0 70{} 1 1", " 3".repeat(70));
    modern("1 1 0 1 1 1 1", &many, 13, &["surface 1 is in 70 physical groups", "64"]);

    legacy("2.2 0 8", "1 0 8", 2, &["version 1 "]);
    legacy("$Nodes\n4\n", "$Nodes\n5\n", 15, &["number of a node is missing: `$EndNodes`"]);
    legacy("$Nodes\n4\n", "$Nodes\n3\n", 14, &["no `$EndNodes`, but `4000000000000 0.5 0 0`"]);
    legacy("$Nodes\n4\n", "$Nodes\n400000000\n", 10, &["400000000", "bytes follow"]);
    legacy("$Nodes\n4\n", "$ParametricNodes\n4\n", 9, &["parametric", "SaveParametric"]);
    legacy("20 1 0 0", "20 1,5 0 0", 12, &["coordinate x of node 20 can't be `1,5`"]);
    legacy("3\n1 2 2", "4\n1 2 2", 21, &["number of an element is missing: `$EndElements`"]);
    legacy("1 2 2 1 1 10", "1 2 2 -1 1 10", 18, &["element 1 is in the physical group -1"]);
    legacy("1 2 2 1 1 10", "1 2 4 1 1 1 1 10", 18, &["element 1 is in a partition"]);
    legacy("1 2 2 1 1 10", "1 2 99 1 1 0 10", 18, &["a tag of element 1 is missing: the line ends"]);
    legacy("1 2 2 1 1 10", "1 5 2 1 1 10", 18, &["element 1 is an 8-node hexahedron"]);

    let names = "$PhysicalNames\n0\n$EndPhysicalNames\n";
    let (head, tail) =
        (LEGACY.split_once("$Phys").unwrap().0, LEGACY.split_once("$EndPhysicalNames\n").unwrap().1);
    refuses(
        format!("{head}{tail}{names}"),
        "m:17",
        &["too late", "$PhysicalNames, $Entities, $Nodes, $Elements"],
    );
    refuses("$NOD\n1\n1 0 0 0\n$ENDNOD\n", "m:1", &["version 1 of MSH"]);
    refuses("$Nodes\n", "m:1", &["doesn't begin with `$MeshFormat`"]);
    refuses(LEGACY.split_once("$Elements").unwrap().0, "m", &["no section $Elements", "mesh the geometry"]);
    refuses(LEGACY.split_once("$Nodes").unwrap().0, "m", &["no section $Nodes"]);
    let empty = LEGACY.split_once("$Elements").unwrap().0.to_owned() + "$Elements\n0\n$EndElements";
    refuses(empty, "m", &["no elements"]);
    refuses("", "m", &["empty", ".msh", ".vtu"]);
    refuses("solid cube\n", "m", &["no mesh that can be read"]);
}

/// Numbers in either byte order, written independently of the readers.
struct Binary {
    out: Vec<u8>,
    is_big: bool,
}

impl Binary {
    fn new(version: &str, is_big: bool) -> Self {
        let mut new = Self { out: Vec::new(), is_big };
        new.text(&format!("$MeshFormat\n{version} 1 8\n")).ints(&[1]).text("\n$EndMeshFormat\n");
        new.text("$PhysicalNames\n1\n2 1 \"cloth\"\n$EndPhysicalNames\n");
        // An unknown section, with bytes that look like other sections.
        new.text("$Strange\n\0\u{1}$Nodes\n$EndStrangest$End\0\n$EndStrange\n");
        new
    }

    fn text(&mut self, text: &str) -> &mut Self {
        self.out.extend(text.as_bytes());
        self
    }

    fn ints(&mut self, values: &[i32]) -> &mut Self {
        for value in values {
            self.out.extend(if self.is_big { value.to_be_bytes() } else { value.to_le_bytes() });
        }
        self
    }

    fn sizes(&mut self, values: &[u64]) -> &mut Self {
        for value in values {
            self.out.extend(if self.is_big { value.to_be_bytes() } else { value.to_le_bytes() });
        }
        self
    }

    fn doubles(&mut self, values: &[f64]) -> &mut Self {
        for value in values {
            self.out.extend(if self.is_big { value.to_be_bytes() } else { value.to_le_bytes() });
        }
        self
    }
}

/// A triangle in the groups `cloth` and, reversed, 8.
fn binary_modern(is_big: bool) -> Vec<u8> {
    let mut file = Binary::new("4.1", is_big);
    file.text("$Entities\n").sizes(&[0, 0, 1, 0]);
    file.ints(&[3])
        .doubles(&[0.0, 0.0, f64::INFINITY, 1.0, 1.0, 0.0])
        .sizes(&[2])
        .ints(&[1, -8])
        .sizes(&[1])
        .ints(&[-4]);
    file.text("\n$EndEntities\n$Nodes\n").sizes(&[2, 3, 7, u64::MAX]);
    file.ints(&[2, 3, 1])
        .sizes(&[2, 7, u64::MAX])
        .doubles(&[0.0, 0.0, 0.0, 9.0, 9.0, 1.0, 0.0, 0.0, 9.0, 9.0]);
    file.ints(&[2, 3, 0]).sizes(&[1, 300]).doubles(&[0.0, 1.0, 0.0]);
    file.text("\n$EndNodes\n$Elements\n").sizes(&[1, 1, 5, 5]).ints(&[2, 3, 2]).sizes(&[
        1,
        5,
        7,
        u64::MAX,
        300,
    ]);
    file.text("\n$EndElements\n");
    file.out
}

/// The same triangle, and its edges in one block with an additional tag.
fn binary_legacy(is_big: bool) -> Vec<u8> {
    let mut file = Binary::new("2.2", is_big);
    file.text("$Nodes\n3\n").ints(&[7]).doubles(&[0.0; 3]).ints(&[9]).doubles(&[1.0, 0.0, 0.0]);
    file.ints(&[300]).doubles(&[0.0, 1.0, 0.0]).text("\n$EndNodes\n$Elements\n4\n");
    file.ints(&[2, 1, 2, 5, 1, 3, 7, 9, 300]).ints(&[1, 3, 3]);
    file.ints(&[1, 2, 1, 0, 7, 9, 2, 2, 1, 0, 9, 300, 3, 2, 1, 0, 300, 7]).text("\n$EndElements\n");
    file.out
}

#[test]
fn bytes_of_both_orders() {
    let place = |mesh: &Mesh| assert_eq!(mesh.nodes, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    for is_big in [false, true] {
        let mesh = reads(binary_modern(is_big));
        place(&mesh);
        assert_eq!(mesh.numbers, [7, u64::MAX, 300]);
        let turned = block("8", CellKind::Triangle3, &[0, 2, 1], &[5]);
        assert_eq!(mesh.blocks, [block("cloth", CellKind::Triangle3, &[0, 1, 2], &[5]), turned]);
        let mesh = reads(binary_legacy(is_big));
        place(&mesh);
        let edges = block("2", CellKind::Line2, &[0, 1, 1, 2, 2, 0], &[1, 2, 3]);
        assert_eq!(mesh.blocks, [block("cloth", CellKind::Triangle3, &[0, 1, 2], &[5]), edges]);
    }
}

#[test]
fn every_defect_of_bytes_has_its_message() {
    let damaged = |from: &[u8], to: &[u8], parts: &[&str]| {
        let bytes = binary_modern(false);
        let at = bytes.windows(from.len()).position(|window| window == from).unwrap();
        refuses([&bytes[..at], to, &bytes[at + from.len()..]].concat(), "m", parts);
    };
    refuses(b"$MeshFormat\n4.1 1 8\n\x01\x01\0\0\n$EndMeshFormat\n", "m:3", &["byte order is not a one"]);
    damaged(b"\n$EndNodes\n", b"\n$EndNode\n", &["byte ", "no `$EndNodes`"]);
    damaged(b"$EndStrange\n", b"\n", &["$Strange has no `$EndStrange`"]);
    damaged(&9.0_f64.to_le_bytes(), b"", &["byte "]);
    damaged(&1.0_f64.to_le_bytes(), b"", &["byte "]);
    let nan = [300_u64.to_le_bytes(), 0_f64.to_le_bytes()].concat();
    let bad = [300_u64.to_le_bytes(), f64::NAN.to_le_bytes()].concat();
    damaged(&nan, &bad, &["byte ", "coordinate x of node 300 is NaN"]);
    let counts = [2_u64, 3, 7].map(u64::to_le_bytes).concat();
    damaged(
        &counts,
        &[2, 1 << 60, 7].map(u64::to_le_bytes).concat(),
        &["number of nodes is 1152921504606846976"],
    );
    damaged(&counts, &[u64::MAX, 3, 7].map(u64::to_le_bytes).concat(), &["number of blocks of nodes"]);
    damaged(
        &[5, 7, u64::MAX].map(u64::to_le_bytes).concat(),
        &[5, 8, u64::MAX].map(u64::to_le_bytes).concat(),
        &["element 5 needs node 8"],
    );
    let file = binary_legacy(false);
    let at = file.windows(12).position(|window| window == [1, 3, 3].map(i32::to_le_bytes).concat()).unwrap();
    for follow in [0, -1, 4, i32::MAX] {
        let header = [1, follow, 3].map(i32::to_le_bytes).concat();
        let bytes = [&file[..at], &header, &file[at + 12..]].concat();
        refuses(bytes, "m", &[&format!("a block has {follow} elements where 1 to 3 are left")]);
    }
}

#[test]
fn what_is_written_is_read_again() {
    assert_eq!(reads(small().to_msh()), small());
    let legacy = reads(GMSH[2].1);
    assert_eq!(reads(legacy.to_msh()), legacy);
    // An element in two blocks gets two numbers.
    let modern = reads(GMSH[0].1);
    let again = reads(modern.to_msh());
    assert_eq!((again.nodes, again.numbers), (modern.nodes, modern.numbers));
    assert_eq!(again.blocks[2].numbers, [4, 5]);
    assert_eq!(again.blocks[3].numbers, [6]);
    assert!(again.blocks.iter().zip(&modern.blocks).all(|(a, b)| a.cells == b.cells && a.group == b.group));
    // VTK numbers from 0, which Gmsh doesn't allow; a name can't contain a line break; an inconsistent mesh
    // mustn't be written wrongly.
    let mut mesh = reads(VTK[3].1);
    mesh.blocks[0].group = "two\nlines".to_owned();
    let again = reads(mesh.to_msh());
    assert_eq!(again.numbers, [1, 2, 3, 4, 5, 6, 7, 8, 9]);
    assert_eq!(
        again.blocks.iter().map(|block| block.group.as_str()).collect::<Vec<_>>(),
        ["two lines", "2", ""]
    );
    mesh.blocks[0].cells[3] = 1000;
    mesh.numbers.clear();
    assert!(Mesh::from_msh(mesh.to_msh().as_bytes(), "m").is_err());
    assert!(Mesh::from_msh(Mesh::default().to_msh().as_bytes(), "m").is_err());
}

/// Storage style of a VTK grid.
#[derive(Debug, Clone, Copy, Default)]
struct Style {
    is_inline: bool,
    is_raw: bool,
    is_packed: bool,
    is_wide: bool,
    is_big: bool,
    /// Whether header and data of uncompressed arrays are two units of base64.
    is_split: bool,
}

impl Style {
    fn all() -> impl Iterator<Item = Self> {
        (0..64_u8).map(|bits| {
            let is = |bit: u8| bits >> bit & 1 == 1;
            Self {
                is_inline: is(0),
                is_raw: is(1),
                is_packed: is(2),
                is_wide: is(3),
                is_big: is(4),
                is_split: is(5),
            }
        })
    }

    fn word(self, value: usize) -> Vec<u8> {
        let value = value as u64;
        match (self.is_wide, self.is_big) {
            (true, true) => value.to_be_bytes().to_vec(),
            (true, false) => value.to_le_bytes().to_vec(),
            (false, true) => u32::try_from(value).unwrap().to_be_bytes().to_vec(),
            (false, false) => u32::try_from(value).unwrap().to_le_bytes().to_vec(),
        }
    }

    /// The header and the data.
    fn pack(self, bytes: &[u8]) -> (Vec<u8>, Vec<u8>) {
        const BLOCK: usize = 40;
        if !self.is_packed {
            return (self.word(bytes.len()), bytes.to_vec());
        }
        let blocks: Vec<_> = bytes.chunks(BLOCK).map(deflated).collect();
        let mut header = [self.word(blocks.len()), self.word(BLOCK), self.word(bytes.len() % BLOCK)].concat();
        header.extend(blocks.iter().flat_map(|block| self.word(block.len())));
        (header, blocks.concat())
    }

    fn encode(self, bytes: &[u8]) -> Vec<u8> {
        let (header, data) = self.pack(bytes);
        if self.is_raw && !self.is_inline {
            return [header, data].concat();
        }
        if self.is_packed || self.is_split {
            return (STANDARD.encode(header) + &STANDARD.encode(data)).into_bytes();
        }
        STANDARD.encode([header, data].concat()).into_bytes()
    }
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// The small grid with arrays of these types.
fn grid(style: Style, [points, nodes, groups]: [&str; 3]) -> Vec<u8> {
    let mut appended = Vec::new();
    let mut array = |number_type: &str, name: &str, components: usize, values: &[f64]| {
        let bytes: Vec<u8> =
            values.iter().flat_map(|value| number(number_type, *value, style.is_big)).collect();
        let data = style.encode(&bytes);
        let head = format!("<DataArray type='{number_type}' Name='{name}' NumberOfComponents='{components}'");
        if style.is_inline {
            let data = String::from_utf8(data).unwrap();
            return format!(
                "{head} format='binary'>\n{data}\n<InformationKey>1 2</InformationKey></DataArray>"
            );
        }
        let offset = appended.len();
        appended.extend(data);
        format!("{head} format='appended' offset='{offset}'/>")
    };
    let body = [
        "<UnstructuredGrid><Piece NumberOfPoints='4' NumberOfCells='3'><Points>".to_owned(),
        array(points, "", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0, 0.0]),
        "</Points><Cells>".to_owned(),
        array(nodes, "connectivity", 1, &[0.0, 1.0, 2.0, 0.0, 1.0, 0.0, 1.0, 3.0]),
        array(nodes, "offsets", 1, &[3.0, 5.0, 8.0]),
        array("UInt8", "types", 1, &[5.0, 3.0, 21.0]),
        "</Cells><CellData>".to_owned(),
        array(groups, "group", 1, &[1.0, 2.0, 2.0]),
        "</CellData></Piece></UnstructuredGrid>".to_owned(),
    ]
    .concat();
    let (order, header) =
        (["LittleEndian", "BigEndian"][usize::from(style.is_big)], 32 << u8::from(style.is_wide));
    let packed = if style.is_packed { " compressor='vtkZLibDataCompressor'" } else { "" };
    let head = format!(
        "<VTKFile type='UnstructuredGrid' byte_order='{order}' header_type='UInt{header}'{packed}>\n{body}"
    );
    let encoding = if style.is_raw { "raw" } else { "base64" };
    let data = if style.is_inline {
        Vec::new()
    } else {
        [format!("<AppendedData encoding='{encoding}'>\n _").as_bytes(), &appended, b"\n</AppendedData>"]
            .concat()
    };
    [head.as_bytes(), &data, b"</VTKFile>\n"].concat()
}

/// A number as bytes; written through the widest type of its kind.
#[expect(clippy::cast_possible_truncation, reason = "small whole numbers")]
fn number(number_type: &str, value: f64, is_big: bool) -> Vec<u8> {
    let (kind, bits) = number_type.split_at(number_type.find(|c: char| c.is_ascii_digit()).unwrap());
    let bytes = bits.parse::<usize>().unwrap() / 8;
    let mut little = match (kind, bytes) {
        ("Float", 4) => (value as f32).to_le_bytes().to_vec(),
        ("Float", _) => value.to_le_bytes().to_vec(),
        _ => (value as i64).to_le_bytes()[..bytes].to_vec(),
    };
    if is_big {
        little.reverse();
    }
    little
}

fn small_grid() -> Mesh {
    let mut mesh = small();
    mesh.numbers = vec![0, 1, 2, 3];
    for (place, (block, group)) in mesh.blocks.iter_mut().zip(["1", "2", "2"]).enumerate() {
        group.clone_into(&mut block.group);
        block.numbers = vec![place as u64];
    }
    mesh
}

#[test]
fn grids_in_every_style_and_type() {
    let whole =
        ["Int8", "Int16", "Int32", "Int64", "UInt8", "UInt16", "UInt32", "UInt64", "Float32", "Float64"];
    for (turn, style) in Style::all().enumerate() {
        let types = [["Float32", "Float64"][turn % 2], whole[turn % 10], whole[turn * 7 % 10]];
        assert_eq!(reads(grid(style, types)), small_grid(), "{style:?} {types:?}");
    }
}

const GRID: &str = "<?xml version='1.0'?>\n<VTKFile type='UnstructuredGrid'>\n<UnstructuredGrid>\n\
    <FieldData><Array type='String' Name='groups' format='ascii'>99 0 -61 -87 0 0</Array></FieldData>\n\
    <Piece NumberOfPoints='3' NumberOfCells='2'>\n\
    <Points><DataArray type='Float64' NumberOfComponents='3' format='ascii'>0 0 0 1 0 0 0 1 0</DataArray></Points>\n\
    <PointData><DataArray type='Float64' Name='pattern' NumberOfComponents='3' format='ascii'>0 1 2 3 4 5 6 7 8</DataArray></PointData>\n\
    <Cells>\n\
    <DataArray type='Int32' Name='connectivity' format='ascii'>0 1 2 2 1</DataArray>\n\
    <DataArray type='Int32' Name='offsets' format='ascii'>3 5</DataArray>\n\
    <DataArray type='UInt8' Name='types' format='ascii'>5 3</DataArray>\n\
    </Cells>\n\
    <CellData><DataArray type='Int32' Name='group' format='ascii'>0 1</DataArray></CellData>\n\
    </Piece>\n</UnstructuredGrid>\n</VTKFile>\n";

#[test]
fn pieces_patterns_and_names() {
    let groups = |text: String| reads(text).blocks.into_iter().map(|block| block.group).collect::<Vec<_>>();
    let mesh = reads(GRID);
    assert_eq!(mesh.blocks[0].pattern, Some(vec![[0.0, 1.0], [3.0, 4.0], [6.0, 7.0]]));
    assert_eq!(mesh.blocks[1].pattern, Some(vec![[6.0, 7.0], [3.0, 4.0]]));
    assert_eq!(groups(GRID.to_owned()), ["c", "é"]);
    for (cells, expected) in [("2 3", ["2", "3"]), ("-1 0", ["-1", "c"])] {
        assert_eq!(groups(GRID.replace(">0 1<", &format!(">{cells}<"))), expected, "{cells}");
    }
    let physical = GRID.replace("Name='group'", "Name='gmsh:physical'");
    assert_eq!(groups(physical), ["", "1"]);
    assert_eq!(groups(GRID.replace("Name='group'", "Name='other'")), ["", ""]);

    let (head, rest) = GRID.split_once("<Piece").unwrap();
    let (piece, tail) = rest.split_once("</Piece>").unwrap();
    let empty = "<Piece NumberOfPoints='0' NumberOfCells='0'></Piece>";
    let two = reads(format!("{head}<Piece{piece}</Piece>{empty}<Piece{piece}</Piece>{tail}"));
    assert_eq!(two.numbers, [0, 1, 2, 3, 4, 5]);
    assert_eq!(two.blocks.len(), 2);
    assert_eq!(
        (&two.blocks[0].cells[..], &two.blocks[0].numbers[..]),
        (&[0, 1, 2, 3, 4, 5][..], &[0, 2][..])
    );
    assert_eq!((&two.blocks[1].cells[..], &two.blocks[1].numbers[..]), (&[2, 1, 5, 4][..], &[1, 3][..]));
    assert_eq!(two.blocks[1].pattern.as_ref().map(Vec::len), Some(4));
    let other = piece.replace("'pattern'", "'other'");
    refuses(
        format!("{head}<Piece{piece}</Piece><Piece{other}</Piece>{tail}"),
        "m:14",
        &["some pieces have", "pattern"],
    );
    refuses(format!("{head}{empty}{tail}"), "m:3", &["no cells"]);
}

#[test]
fn every_defect_of_a_grid_has_its_message() {
    let grid = |from: &str, to: &str, line: usize, parts: &[&str]| {
        assert!(GRID.contains(from), "{from}");
        refuses(GRID.replacen(from, to, 1), &format!("m:{line}"), parts);
    };
    grid("'UnstructuredGrid'", "'PolyData'", 2, &["type `PolyData`", "Append Datasets"]);
    grid("'UnstructuredGrid'", "'ImageData'", 2, &["type `ImageData`"]);
    grid("'UnstructuredGrid'", "'PUnstructuredGrid'", 2, &["only names other files"]);
    grid(
        "<VTKFile type='UnstructuredGrid'>",
        "<VTKFile type='UnstructuredGrid' compressor='vtkLZ4DataCompressor'>",
        2,
        &["`vtkLZ4DataCompressor`", "ZLib"],
    );
    grid("<VTKFile ", "<VTKFile byte_order='Middle' ", 2, &["byte order is `Middle`"]);
    grid("<VTKFile ", "<VTKFile header_type='Int' ", 2, &["header type is `Int`"]);
    grid("</Piece>", "", 15, &["XML can't be read", "cut"]);
    grid("'3' NumberOfCells", "'x' NumberOfCells", 5, &["`NumberOfPoints` of <Piece> is `x`"]);
    grid(
        "'3' NumberOfCells",
        "'18446744073709551615' NumberOfCells",
        6,
        &["9 entries where 18446744073709551615"],
    );
    grid("NumberOfCells='2'", "NumberOfCells='3'", 13, &["array `group` has 2 entries where 3"]);
    grid(
        "NumberOfComponents='3' format='ascii'>0 0 0",
        "NumberOfComponents='2' format='ascii'>0 0 0",
        5,
        &["three components"],
    );
    grid(">0 0 0 1", ">0 0 nan 1", 6, &["entry 2 of an array without a name can't be `nan`"]);
    grid(">0 0 0 1", ">0 0 x 1", 6, &["can't be `x`"]);
    grid(">0 0 0 1", ">0 0 1", 6, &["has 8 entries where 9"]);
    grid(
        "Name='pattern' NumberOfComponents='3'",
        "Name='pattern'",
        7,
        &["array `pattern` has 1 components", "two"],
    );
    grid(">0 1 2 2 1<", ">0 1 3 2 1<", 8, &["cell 0 has point 3", "only 3 points"]);
    grid(">0 1 2 2 1<", ">0 -1 2 2 1<", 8, &["cell 0 has point -1"]);
    grid(">0 1 2 2 1<", ">0 1 2 2 2<", 8, &["cell 1 has point 2 twice"]);
    grid(">0 1 2 2 1<", ">0 1 2 2<", 8, &["cell 1 ends at offset 5 of 4"]);
    grid(">0 1 2 2 1<", ">0 1 2 2 1 0<", 8, &["1 entries more"]);
    grid(">3 5<", ">2 5<", 8, &["cell 0 ends at offset 2 of 5, not at 3"]);
    grid(">5 3<", ">9 3<", 8, &["cell 0 is a 4-node quadrangle (type 9 of VTK)", "triangles"]);
    grid(">5 3<", ">10 3<", 8, &["cell 0 is a volume", "only the surface"]);
    grid(">5 3<", ">5 4<", 8, &["cell 1 is a polyline"]);
    grid(">5 3<", ">5 0<", 8, &["cell 1 is no cell of a membrane (type 0 of VTK)"]);
    grid("Name='offsets'", "Name='ends'", 8, &["no array `offsets`"]);
    grid(
        "'Int32' Name='group' format='ascii'>0 1<",
        "'Float32' Name='group' format='ascii'>0 1.5<",
        13,
        &["`1.5`"],
    );
    grid("'Int32' Name='group'", "'Bit' Name='group'", 13, &["type `Bit`"]);
    grid("Name='group' format='ascii'", "Name='group' format='binary'", 13, &["array `group` is no base64"]);
    grid(
        "Name='group' format='ascii'",
        "Name='group' format='appended' offset='9'",
        13,
        &["begins at 9, after the end"],
    );
    grid("Name='group' format='ascii'", "Name='group' format='hex'", 13, &["format `hex`"]);
    grid("Name='group'", "Name='vtkGhostType'", 13, &["cell 1 is a ghost"]);
    grid("'String'", "'Int32'", 4, &["`groups` are no strings"]);
    grid("99 0 -61", "99 0 300", 4, &["array `groups` is no text"]);
    grid("99 0 -61 -87", "99 0 -61", 4, &["array `groups` is no text of UTF-8"]);
    refuses("<html><body/></html>", "m:1", &["XML of <html>"]);
    refuses("<!DOCTYPE a [<!ENTITY b 'c'>]><VTKFile/>", "m:1", &["XML can't be read"]);
    refuses("# vtk DataFile Version 3.0\n", "m", &["legacy kind", ".vtu"]);
    refuses(b"<VTKFile>\n\xff</VTKFile>", "m:2", &["UTF-8"]);
    refuses("<VTKFile><AppendedData encoding='raw'>_abc", "m", &["inside the appended data"]);
    refuses("<VTKFile><AppendedData>abc</AppendedData></VTKFile>", "m", &["underscore"]);
    refuses("<VTKFile><AppendedData encoding='hex'>_abc</AppendedData></VTKFile>", "m:1", &["`hex`"]);
    // Deeper than the stack.
    refuses("<a>".repeat(100_000), "m:1", &["XML"]);
    refuses("<a>".repeat(100_000) + &"</a>".repeat(100_000), "m:1", &["XML"]);
    // What the parser would compare each with each other, in whatever disguise.
    let many = |one: &str| (0..200).map(|n| one.replace('N', &n.to_string())).collect::<String>();
    for quiet in ["", "<!-- '= -->", "<?x \" ?>", "<![CDATA[<a b='>]]>", "<b c='>' d=\"'\"/>"] {
        let element = format!("<VTKFile>{quiet}\n<a{}/></VTKFile>", many(" bN='>'"));
        refuses(element, "m:2", &["too many attributes", "at most 100"]);
    }
    refuses(format!("<a{}/>", many(" xmlns:bN=''")), "m:1", &["too many namespaces", "at most 100"]);
    let nested = many("<a xmlns:bN='c'>") + &"</a>".repeat(200);
    refuses(nested, "m:1", &["too many namespaces"]);
    // No entity is expanded, be it ten times ten times ten.
    let laughs = "<!DOCTYPE a [<!ENTITY b 'ha'><!ENTITY c '&b;&b;&b;'>]><VTKFile>&c;</VTKFile>";
    refuses(laughs, "m:1", &["XML can't be read"]);
    // A hundred attributes, and signs that are none, are read.
    let few = format!(
        "<html{}>{}<!-- {} --></html>",
        many(" bN=''").split_inclusive("''").take(100).collect::<String>(),
        "= ".repeat(999),
        "=".repeat(999)
    );
    refuses(few, "m:1", &["XML of <html>"]);
}

#[test]
fn files_made_to_fill_the_memory() {
    // 400 blocks of a mebibyte of zeros, each in a kibibyte.
    let block = deflated(&vec![0; 1 << 20]);
    let with = |blocks: u32, size: u32| {
        let mut header: Vec<u8> = [blocks, size, 0].map(u32::to_le_bytes).concat();
        header.extend((0..400).flat_map(|_| u32::try_from(block.len()).unwrap().to_le_bytes()));
        let data = STANDARD.encode(header) + &STANDARD.encode(block.repeat(400));
        let packed =
            GRID.replace("'UnstructuredGrid'>", "'UnstructuredGrid' compressor='vtkZLibDataCompressor'>");
        packed.replace("Name='group' format='ascii'>0 1<", &format!("Name='group' format='binary'>{data}<"))
    };
    refuses(with(400, 1 << 20), "m:13", &["with array `group` the file unpacks to far more"]);
    refuses(with(400, u32::MAX), "m:13", &["far more"]);
    refuses(with(u32::MAX, 1), "m:13", &["shorter than its header says"]);
    // The same data for piece after piece: a hundred kilobytes of points, two thousand times.
    let points = "<DataArray type='UInt8' NumberOfComponents='3' format='appended' offset='0'/>";
    let piece =
        format!("<Piece NumberOfPoints='34952' NumberOfCells='0'><Points>{points}</Points></Piece>\n");
    let head = format!(
        "<VTKFile type='UnstructuredGrid'><UnstructuredGrid>{}</UnstructuredGrid>",
        piece.repeat(2000)
    );
    let size = 3 * 34_952_u32;
    let head = format!("{head}<AppendedData encoding='raw'>_").into_bytes();
    let many =
        [head, size.to_le_bytes().to_vec(), vec![1; 3 * 34_952], b"</AppendedData></VTKFile>".to_vec()]
            .concat();
    let error = Mesh::from_vtu(&many, "m").expect_err("too much");
    assert!(error.what.contains("far more"), "{error}");
    // It contains more than it declares.
    refuses(with(400, 1 << 10), "m:13", &["block 0 is damaged"]);
    let long = GRID.replace("Name='group' format='ascii'>0 1<", "Name='group' format='binary'>/////wAAAAA=<");
    refuses(long, "m:13", &["array `group` is shorter than its header says"]);
}

/// Every sample, small and of every kind.
fn samples() -> Vec<Vec<u8>> {
    let mut samples: Vec<_> = GMSH.iter().chain(&VTK).map(|(_, bytes)| bytes.to_vec()).collect();
    samples.extend([LEGACY, MODERN, GRID].map(|text| text.as_bytes().to_vec()));
    samples.extend([binary_modern(true), binary_legacy(true)]);
    samples.extend(Style::all().step_by(13).map(|style| grid(style, ["Float32", "Int32", "UInt8"])));
    samples
}

#[test]
fn cut_files_are_errors() {
    for sample in samples() {
        let whole = sample.trim_ascii_end().len();
        for end in 0..whole {
            let error =
                Mesh::from_bytes(&sample[..end], "cut").expect_err(&format!("cut to {end} of {whole}"));
            assert!(error.file.starts_with("cut") && !error.instead.is_empty());
        }
        assert!(Mesh::from_bytes(&sample[..whole], "whole").is_ok());
    }
}

/// A mesh that was read may be used without further checks.
fn is_sound(mesh: &Mesh) {
    assert_eq!(mesh.nodes.len(), mesh.numbers.len());
    assert!(mesh.nodes.as_flattened().iter().all(|coordinate| coordinate.is_finite()));
    for block in &mesh.blocks {
        assert!(block.cells.iter().all(|node| *node < mesh.nodes.len()));
        assert_eq!(block.cells.len(), block.numbers.len() * block.kind.nodes());
        assert!(block.pattern.as_ref().is_none_or(|pattern| pattern.len() == block.cells.len()));
    }
}

#[test]
fn damaged_bytes_never_panic() {
    for mut sample in samples() {
        for at in 0..sample.len() {
            let byte = sample[at];
            let mut others = [0, 0xff, b'9', b' ', b'-', b'$', byte ^ 1, byte ^ 0x80];
            others.rotate_left(at % 8);
            // XML is slow, so only one of them in turn.
            let tries = if sample.starts_with(b"<") { 1 } else { 8 };
            for other in others.into_iter().take(tries) {
                sample[at] = other;
                if let Ok(mesh) = Mesh::from_bytes(&sample, "damaged") {
                    is_sound(&mesh);
                }
            }
            sample[at] = byte;
        }
    }
}

#[test]
fn swapped_and_repeated_words_never_panic() {
    // Knuth's MMIX sequence, so that failures are reproducible.
    let mut state = 1_u64;
    let mut below = |bound: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).unwrap() % bound
    };
    let odd = [
        "-1",
        "0",
        "18446744073709551615",
        "9223372036854775808",
        "1e308",
        "nan",
        "$Nodes",
        "$EndNodes",
        "\"",
        "<",
        "",
    ];
    for text in samples().into_iter().filter_map(|sample| String::from_utf8(sample).ok()) {
        let words: Vec<_> = text.split_inclusive([' ', '\n', '>', '\'', '"']).collect();
        for _ in 0..150 {
            let mut words = words.clone();
            for _ in 0..=below(3) {
                let (from, to) = (below(words.len()), below(words.len()));
                match below(4) {
                    0 => words.swap(from, to),
                    1 => words[to] = words[from],
                    2 => drop(words.remove(to)),
                    _ => words.insert(to, odd[below(odd.len())]),
                }
            }
            if let Ok(mesh) = Mesh::from_bytes(words.concat().as_bytes(), "swapped") {
                is_sound(&mesh);
            }
        }
    }
}

/// Bytes, lines and lengths changed at random.
struct Vandal {
    state: u64,
}

impl Vandal {
    fn below(&mut self, bound: usize) -> usize {
        // Knuth's MMIX sequence, so that failures are reproducible.
        self.state =
            self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(self.state >> 33).unwrap() % bound.max(1)
    }

    fn lines(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
        let (from, to) = (self.below(lines.len()), self.below(lines.len()));
        match self.below(3) {
            0 => lines.swap(from, to),
            1 => lines.insert(to, lines[from]),
            _ => drop(lines.remove(to)),
        }
        lines.concat()
    }

    fn change(&mut self, mut bytes: Vec<u8>) -> Vec<u8> {
        if bytes.is_empty() {
            return bytes;
        }
        let at = self.below(bytes.len());
        match self.below(8) {
            0 | 1 => bytes[at] = u8::try_from(self.below(256)).unwrap(),
            2 => bytes[at] ^= 1 << self.below(8),
            3 => drop(bytes.remove(at)),
            4 => bytes.insert(at, b"0123456789-. $<\"\n"[self.below(17)]),
            5 => bytes.truncate(at),
            _ => return self.lines(&bytes),
        }
        bytes
    }
}

/// The error says what is wrong, where, and what to write instead; and the memory never reaches the size that
/// a damaged count claims.
#[track_caller]
fn is_clear(answer: Result<Mesh, bulge_membrane::MeshError>, size: usize) {
    match answer {
        Ok(mesh) => {
            is_sound(&mesh);
            let numbers = mesh.nodes.len() + mesh.blocks.iter().map(|block| block.cells.len()).sum::<usize>();
            assert!(numbers <= 4 * size, "{numbers} numbers in {size} bytes");
        }
        Err(error) => {
            let place = error.file.strip_prefix("bad").expect("the name of the file");
            let has_line =
                place.strip_prefix(':').is_some_and(|line| line.parse::<u64>().is_ok_and(|n| n > 0));
            // Binary data have no lines, and missing data have no position.
            let names = |word: &str| error.what.contains(word);
            let has_what =
                ["file", "byte", "section", "node", "element", "cell", "array", "mesh", "data", "text", "$"];
            assert!(has_line || (place.is_empty() && has_what.into_iter().any(names)), "{error}");
            assert!(
                !error.what.is_empty() && error.what.len() < 300 && !error.what.contains('\n'),
                "{error}"
            );
            assert!(!error.instead.is_empty(), "{error}");
        }
    }
}

#[test]
fn vandalised_files_have_clear_messages() {
    let mut vandal = Vandal { state: 7 };
    let mut refused = 0;
    for (_, bytes) in GMSH.iter().chain(&VTK) {
        for _ in 0..600 {
            let mut damaged = bytes.to_vec();
            for _ in 0..=vandal.below(4) {
                damaged = vandal.change(damaged);
            }
            let answer = Mesh::from_bytes(&damaged, "bad");
            refused += usize::from(answer.is_err());
            is_clear(answer, damaged.len());
        }
    }
    // Most changes damage the file.
    assert!(refused > 2400, "{refused} of 4800");
}
