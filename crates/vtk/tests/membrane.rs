//! Files of membranes: written, read back and as a mesh, and measured against the state they show.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test that cannot be set up fails; numbers are read back as they were written"
)]

#[path = "membrane/read.rs"]
mod read;
#[path = "membrane/support.rs"]
mod support;

use bulge_membrane::case::Case;
use bulge_membrane::mesher::Pleated;
use bulge_membrane::{
    CellKind, Copies, Fields, Fitting, Mesh, Part, Solver, State, Structure, Support, Thread, Tolerance,
};
use bulge_vtk::{CaseFolder, MembranePicture, MembraneSeries, Whole, write_vtu};
use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::Path;
use support::{AIRBAG, CellType, PLEATED, Point, Read, SPHERE, TUBE, solved};

fn drawn(dir: &Path, state: &State, fields: &Fields, whole: Whole) -> Read {
    let path = dir.join("state.vtu");
    write_vtu(&path, &MembranePicture { state, fields, whole, time: 2.5 }).unwrap();
    Read::of(&path)
}

#[test]
fn a_tube_as_meshed_is_a_mesh_again() {
    let dir = tempfile::tempdir().unwrap();
    let (case, state, fields) = solved(TUBE);
    let read = drawn(dir.path(), &state, &fields, Whole::AsMeshed);
    assert_eq!(read.points, fields.places);
    assert_eq!((read.count(CellType::Line), read.cells.len()), (24, 24));
    for (name, value) in [
        ("pressure_Pa", 3e4),
        ("volume_m3", state.volume),
        ("energy_J", state.energy),
        ("force_N", state.forces[1]),
        ("unstable", state.unstable as f64),
        ("TimeValue", 2.5),
    ] {
        assert!((read.field(name) - value).abs() <= 1e-15 * value.abs(), "{name}");
    }
    let group = &fields.groups[0];
    assert_eq!((group.sheets.len(), group.threads.len()), (2, 1));
    for (cell, (sheet, thread)) in group.sheets[1].iter().zip(&group.threads[0]).enumerate() {
        let data = |name: &str| read.cell_data[name][cell];
        assert_eq!(data("membrane_force_1_N_per_m_2"), sheet.force[0]);
        assert_eq!(data("membrane_force_2_N_per_m"), sheet.force[1]);
        assert_eq!(data("stretch_2_2"), sheet.stretch[1]);
        assert_eq!(data("fibre_tension_N"), thread.tension);
        assert_eq!(data("fibre_strain"), thread.stretch - 1.0);
        assert_eq!(data("fibre_angle_rad"), thread.angle);
        assert_eq!(data("wrinkle_state_2"), 2.0);
        let d = read.vector("direction_1", cell);
        assert!((d[0].hypot(d[2]) - 1.0).abs() < 1e-14 && d[2] > 0.9);
    }
    assert!(!read.cell_data.contains_key("fibre_tension_N_2"));
    let mesh = Mesh::from_vtu(read.xml.as_bytes(), "state.vtu").unwrap();
    assert_eq!(mesh.nodes, fields.places);
    assert_eq!(mesh.blocks.len(), 1);
    let wall = case.mesh.blocks.iter().find(|block| block.group == "wall").unwrap();
    assert_eq!((&mesh.blocks[0].group, &mesh.blocks[0].cells), (&wall.group, &wall.cells));
}

#[test]
fn a_tube_revolved() {
    let dir = tempfile::tempdir().unwrap();
    let (case, state, fields) = solved(TUBE);
    assert_eq!(Whole::of(&case), Whole::Revolved { facets: 96, middle: None });
    for facets in [7_u32, 96] {
        let read = drawn(dir.path(), &state, &fields, Whole::Revolved { facets, middle: None });
        let n = facets as usize;
        assert_eq!(
            (read.points.len(), read.count(CellType::Quad), read.cells.len()),
            (25 * n, 24 * n, 24 * n)
        );
        // The section is a regular polygon: ratio of its area to that of the circle.
        let polygon = (TAU / f64::from(facets)).sin() / (TAU / f64::from(facets));
        assert!((read.volume() / (state.volume * polygon) - 1.0).abs() < 1e-12);
        assert_eq!(read.open_edges().len(), 2 * n);
        for (cell, nodes) in read.cells.iter().enumerate() {
            // Facet j is rotated: its meridian lies in the plane through its middle.
            let d = read.vector("direction_1", cell);
            let place = [0, 1].map(|k| nodes.iter().map(|node| read.points[*node][k]).sum::<f64>());
            assert!((d[0] * place[1] - d[1] * place[0]).abs() < 1e-12 * place[0].hypot(place[1]));
            let element = cell / n;
            assert_eq!(
                read.cell_data["membrane_force_1_N_per_m"][cell],
                fields.groups[0].sheets[0][element].force[0]
            );
        }
        for (point, place) in read.points.iter().enumerate() {
            let moved = read.vector("displacement_m", point);
            let before = [place[0] - moved[0], place[1] - moved[1]];
            assert!((before[0].hypot(before[1]) - 0.01).abs() < 1e-15);
        }
    }
}

#[test]
fn half_a_ball_becomes_a_closed_one() {
    let dir = tempfile::tempdir().unwrap();
    let (case, state, fields) = solved(SPHERE);
    let whole = Whole::of(&case);
    assert_eq!(whole, Whole::Revolved { facets: 96, middle: Some(0.0) });
    let read = drawn(dir.path(), &state, &fields, whole);
    // 32 circles in each half apart from the pole, of which the middle one is shared; two poles.
    assert_eq!(read.points.len(), (2 * 32 - 1) * 96 + 2);
    assert_eq!((read.count(CellType::Quad), read.count(CellType::Triangle)), (2 * 31 * 96, 2 * 96));
    assert_eq!(read.open_edges(), []);
    assert!((read.volume() / state.volume - 1.0).abs() < 2e-3, "{}", read.volume() / state.volume);
    let r = fields.places[0][0];
    assert!((read.area() / (4.0 * PI * r * r) - 1.0).abs() < 2e-3);
    // As meshed it has quadratic edges, which the mesh reader can read.
    let read = drawn(dir.path(), &state, &fields, Whole::AsMeshed);
    assert_eq!(read.count(CellType::QuadraticEdge), 16);
    let mesh = Mesh::from_vtu(read.xml.as_bytes(), "state.vtu").unwrap();
    assert_eq!((mesh.blocks[0].kind, mesh.blocks[0].group.as_str()), (CellKind::Line3, "wall"));
}

#[test]
fn half_a_lobe_becomes_the_whole_muscle() {
    let dir = tempfile::tempdir().unwrap();
    let (case, state, fields) = solved(PLEATED);
    let whole = Whole::of(&case);
    assert!(matches!(whole, Whole::Sector { lobes: 8, mirror: Some(_), middle: Some(0.0) }), "{whole:?}");
    let part = drawn(dir.path(), &state, &fields, Whole::AsMeshed);
    let read = drawn(dir.path(), &state, &fields, whole);
    let copies = 4 * 8;
    assert_eq!(read.count(CellType::Triangle), copies * part.count(CellType::Triangle));
    // Each fibre belongs to two half lobes and is drawn once.
    assert_eq!(read.count(CellType::Line), 8 * 2 * 20);
    // All seams are merged: 2 * 6 * 8 points around, 2 * 20 + 1 along.
    assert_eq!(read.points.len(), 96 * 41);
    assert_eq!(read.open_edges().len(), 2 * 96);
    assert!((read.volume() / state.volume - 1.0).abs() < 1e-12);
    assert!((read.area() / (copies as f64 * part.area()) - 1.0).abs() < 1e-12);
    // Without the mirror plane in the middle: half of it.
    let half = Whole::Sector { lobes: 8, mirror: Some([0.0, 1.0, 0.0]), middle: None };
    assert!((2.0 * drawn(dir.path(), &state, &fields, half).volume() / state.volume - 1.0).abs() < 1e-12);
    // The far edge is the other plane of the lobe.
    let mirror = Some([-(PI / 8.0).sin(), (PI / 8.0).cos(), 0.0]);
    let other = drawn(dir.path(), &state, &fields, Whole::Sector { lobes: 8, mirror, middle: Some(0.0) });
    assert!((other.volume() / state.volume - 1.0).abs() < 1e-12 && other.points.len() == read.points.len());
    // In each image of a triangle the cloth is pulled along the image of the same direction.
    let sheets = &fields.groups[0].sheets[0];
    let triangles = part.count(CellType::Triangle);
    let surface: Vec<usize> =
        (0..read.cells.len()).filter(|cell| read.types[*cell] == CellType::Triangle).collect();
    for (i, cell) in surface.iter().enumerate() {
        let element = i % triangles;
        let slant = |read: &Read, cell: usize| {
            let d = read.vector("direction_1", cell);
            let t = read.triangles(cell)[0];
            let middle = [0, 1].map(|k| t[0][k] + t[1][k] + t[2][k]);
            let out = (d[0] * middle[0] + d[1] * middle[1]) / middle[0].hypot(middle[1]);
            [out.abs(), d[2].abs()]
        };
        let (image, own) = (slant(&read, *cell), slant(&part, element));
        assert!(image.iter().zip(own).all(|(a, b)| (a - b).abs() < 1e-9), "{cell}: {image:?} {own:?}");
        assert_eq!(read.cell_data["stretch_1"][*cell], sheets[element].stretch[0]);
        assert_eq!(read.cell_data["fibre_tension_N"][*cell], 0.0);
    }
    // The ends move towards each other.
    let end = read.points.iter().map(|x| x[2]).fold(0.0, f64::max);
    assert!((end - 0.0495).abs() < 1e-12);
    for (point, place) in read.points.iter().enumerate().filter(|(_, x)| x[2].abs() > end - 1e-9) {
        assert!((read.vector("displacement_m", point)[2] + 0.0055 * place[2].signum()).abs() < 1e-12);
    }
    let states = &read.cell_data["wrinkle_state"];
    assert!(read.types.iter().zip(states).all(|(kind, state)| (*kind == CellType::Line) == (*state == -1.0)));
}

#[test]
fn a_quarter_of_an_airbag() {
    let dir = tempfile::tempdir().unwrap();
    let (case, state, fields) = solved(AIRBAG);
    let whole = Whole::of(&case);
    assert!(matches!(whole, Whole::Sector { lobes: 2, mirror: Some(_), middle: Some(0.0) }), "{whole:?}");
    let read = drawn(dir.path(), &state, &fields, whole);
    assert_eq!(read.count(CellType::QuadraticTriangle), 8 * 128);
    assert_eq!(read.open_edges(), []);
    assert!((read.volume() / state.volume - 1.0).abs() < 2e-3, "{}", read.volume() / state.volume);
    // A flat cloth at rest has both layers in one place: they stay separate.
    let mut flat = fields.clone();
    for (place, displacement) in flat.places.iter_mut().zip(&mut flat.displacements) {
        *place = std::array::from_fn(|k| place[k] - displacement[k]);
        *displacement = [0.0; 3];
    }
    let rest = drawn(dir.path(), &state, &flat, whole);
    assert_eq!(rest.cells.len(), read.cells.len());
    assert!((rest.area() / (2.0 * 0.64) - 1.0).abs() < 1e-11, "{}", rest.area());
    assert!(rest.volume().abs() < 1e-12, "{}", rest.volume());
    let mesh =
        Mesh::from_vtu(drawn(dir.path(), &state, &fields, Whole::AsMeshed).xml.as_bytes(), "state.vtu")
            .unwrap();
    assert_eq!((mesh.blocks[0].kind, mesh.blocks[0].cells.len()), (CellKind::Triangle6, 6 * 128));
}

/// A lobe between two fibres with a cyclic edge: the seam joins different nodes.
#[test]
fn a_cyclic_lobe() {
    let dir = tempfile::tempdir().unwrap();
    let muscle = Pleated {
        fibres: 6,
        radius: 0.016,
        length: 0.11,
        circumference: TAU * 0.016,
        depth: 0.0,
        cells: [2, 10],
        is_quadratic: false,
    };
    let mut mesh = muscle.lobe();
    for block in &mut mesh.blocks {
        block.pattern = None;
    }
    let named = |name: &str| name.to_owned();
    let parts = [
        (named("cloth"), Part::Membrane { sheet: None, warp: [0.0, 0.0, 1.0] }),
        (named("fibre"), Part::Cable { thread: Thread::Inextensible, share: 1.0 }),
    ];
    let supports = [
        (named("top"), Support::Cyclic { partner: named("fibre"), angle: TAU / 6.0 }),
        (named("middle"), Support::Plane { normal: [0.0, 0.0, 1.0] }),
        (named("end"), Support::Fitting { fitting: 0 }),
    ];
    let structure = Structure::new(&mesh, &parts, &supports, &[Fitting::Placed]).unwrap();
    let mut solver =
        Solver::new(structure, Copies { around: 6.0, along: 2.0 }, Tolerance::default()).unwrap();
    let state = solver.at_rest();
    let fields = solver.fields(&state);
    let read =
        drawn(dir.path(), &state, &fields, Whole::Sector { lobes: 6, mirror: None, middle: Some(0.0) });
    assert_eq!(read.points.len(), 12 * 21);
    assert_eq!((read.count(CellType::Line), read.count(CellType::Triangle)), (6 * 20, 6 * 2 * 40));
    assert_eq!(read.open_edges().len(), 2 * 12);
    assert!((read.volume() / state.volume - 1.0).abs() < 1e-12);
    assert_eq!(
        read.cell_data["wrinkle_state"].iter().fold(-1.0, |a: f64, b| a.max(*b)),
        -1.0,
        "facets carry nothing"
    );
}

#[test]
fn a_series_grows_state_by_state() {
    let dir = tempfile::tempdir().unwrap();
    let case =
        Case::from_toml(&TUBE.replace("\"-2 mm\" }", "\"-2 mm\" }\nstates = 3"), "case.toml", None).unwrap();
    let mut run = case.start().unwrap();
    let mut series = MembraneSeries::new(dir.path().join("new"), "a & b").unwrap();
    assert!(!series.path().exists());
    while let Some(next) = run.advance(|_, _| ()) {
        let (row, state, fields) = next.unwrap();
        let picture = MembranePicture {
            state: &state,
            fields: &fields,
            whole: Whole::of(&case),
            time: row.state as f64,
        };
        let path = series.append(&picture).unwrap();
        assert_eq!(Read::of(&path).field("TimeValue"), row.state as f64);
        let pvd = fs::read_to_string(series.path()).unwrap();
        assert_eq!(pvd.matches("<DataSet").count(), row.state);
        let bad = MembranePicture { time: f64::NAN, ..picture };
        assert!(series.append(&bad).unwrap_err().to_string().contains("TimeValue is NaN"));
    }
    assert_eq!(series.states(), 3);
    let pvd = fs::read_to_string(series.path()).unwrap();
    assert!(pvd.contains(r#"<DataSet timestep="3" part="0" file="a &amp; b_0002.vtu"/>"#), "{pvd}");
    assert_eq!(fs::read_dir(dir.path().join("new")).unwrap().count(), 4);
    assert!(
        MembraneSeries::new(dir.path().join("other"), "up/down").is_err()
            && !dir.path().join("other").exists()
    );
}

/// A state is written while the next one is sought: what stops that is told with the state after it, or at the end, and
/// the states before it stay.
#[test]
fn a_state_that_cannot_be_written_is_told() {
    let text = TUBE.replace("\"-2 mm\" }", "\"-2 mm\" }\nstates = 3");
    let case = Case::from_toml(&text, "case.toml", None).unwrap();
    // The state whose file can't be written, and the rows that are taken before that is told.
    for (obstructed, taken) in [(None, 3), (Some(1), 2), (Some(2), 3)] {
        let dir = tempfile::tempdir().unwrap();
        let mut run = case.start().unwrap();
        let mut folder = CaseFolder::new(dir.path(), &case, false).unwrap();
        let stem = folder.pvd().file_stem().unwrap().to_str().unwrap().to_owned();
        if let Some(state) = obstructed {
            fs::create_dir(dir.path().join(format!("{stem}_000{state}.vtu"))).unwrap();
        }
        let mut told = None;
        while let Some(next) = run.advance(|_, _| ()) {
            let (row, state, fields) = next.unwrap();
            told = told.or(folder.take(row, state, fields).err());
        }
        assert_eq!(told.is_some(), obstructed == Some(1));
        told = told.or(folder.finish(&mut run).err());
        assert_eq!(folder.rows().len(), taken);
        let error = told.map(|error| error.to_string());
        assert_eq!(error.is_some(), obstructed.is_some(), "{error:?}");
        let written = obstructed.unwrap_or(3);
        assert!(error.is_none_or(|error| error.contains(&format!("{stem}_000{written}.vtu"))));
        let pvd = fs::read_to_string(folder.pvd()).unwrap();
        assert!(pvd.matches("<DataSet").count() >= written, "{pvd}");
    }
}

#[test]
fn refuses_and_leaves_nothing_behind() {
    let dir = tempfile::tempdir().unwrap();
    let (_, state, fields) = solved(TUBE);
    let (_, flat_state, flat) = solved(PLEATED);
    let path = dir.path().join("state.vtu");
    let refused = |path: &Path, state: &State, fields: &Fields, whole: Whole, part: &str| {
        let error =
            write_vtu(path, &MembranePicture { state, fields, whole, time: 0.0 }).unwrap_err().to_string();
        assert!(error.contains(part), "{error}\n  does not say {part:?}");
    };
    let round = |facets: u32| Whole::Revolved { facets, middle: None };
    let sector =
        |lobes: u32, mirror: Option<Point>, middle: Option<f64>| Whole::Sector { lobes, mirror, middle };
    let edited = |edit: &dyn Fn(&mut Fields)| {
        let mut fields = fields.clone();
        edit(&mut fields);
        fields
    };
    refused(&dir.path().join("state.vtk"), &state, &fields, round(96), "must end in .vtu");
    refused(&dir.path().join("nowhere/state.vtu"), &state, &fields, round(96), "no folder");
    refused(&path, &state, &fields, round(2), "2 facets");
    refused(&path, &state, &fields, round(u32::MAX), "more than a file holds");
    refused(&path, &state, &fields, round(96).middle(0.01), "two sides of its middle");
    refused(&path, &state, &fields, round(96).middle(f64::NAN), "z = NaN");
    refused(&path, &state, &fields, Whole::half_lobe(8), "membrane of revolution");
    refused(&path, &flat_state, &flat, sector(0, None, None), "no lobes");
    refused(
        &path,
        &flat_state,
        &flat,
        sector(u32::MAX, Some([0.0, 1.0, 0.0]), None),
        "more than a file holds",
    );
    refused(&path, &flat_state, &flat, sector(8, Some([0.0, 1.0, 1.0]), None), "z axis");
    refused(&path, &flat_state, &flat, sector(8, Some([0.0; 3]), None), "z axis");
    refused(
        &path,
        &flat_state,
        &flat,
        sector(8, Some([-0.2, 1.0, 0.0]), None),
        "two sides of the plane of its lobe",
    );
    let mut wrong = state.clone();
    wrong.energy = f64::INFINITY;
    refused(&path, &wrong, &fields, round(96), "energy_J is inf");
    let nan = edited(&|f| f.places[3][2] = f64::NAN);
    refused(&path, &state, &nan, round(96), "place_m is NaN at node 3");
    let nan = edited(&|f| f.groups[0].sheets[1][5].force[1] = f64::NAN);
    refused(&path, &state, &nan, round(96), "membrane_force_2_N_per_m is NaN at cell 5 of group `wall`");
    let nan = edited(&|f| f.groups[0].threads[0][7].stretch = f64::INFINITY);
    refused(&path, &state, &nan, round(96), "fibre_strain is inf at cell 7");
    let short = edited(&|f| f.displacements.truncate(4));
    refused(&path, &state, &short, round(96), "4 displacements of 25 nodes");
    let short = edited(&|f| f.groups[0].threads[0].truncate(4));
    refused(&path, &state, &short, round(96), "4 values for 24 cells");
    let beyond = edited(&|f| f.groups[0].cells[0] = 25);
    refused(&path, &state, &beyond, round(96), "node 25");
    refused(&path, &state, &edited(&|f| f.groups.clear()), round(96), "no cells");
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}

trait Mirrored {
    fn middle(self, z: f64) -> Self;
}

impl Mirrored for Whole {
    fn middle(mut self, z: f64) -> Self {
        match &mut self {
            Self::Revolved { middle, .. } | Self::Sector { middle, .. } => *middle = Some(z),
            Self::AsMeshed => (),
        }
        self
    }
}
