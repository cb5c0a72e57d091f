//! `bulge membrane` as seen by a user: result, files, and messages for wrong cases.

use crate::support::{Folder, bulge, failure, json, refused};
use bulge_membrane::case::{Case, Row};
use std::path::Path;
use std::process::Command;

const TUBE: &str = include_str!("../../../../meshes/tube.toml");

/// Cloth of 50 kN/m with a circumference of 270 mm: its last fold vanishes at a radius of 43 mm.
const PLEATED: &str = "[mesher]\nkind = \"pleated\"\nmuscle = \"ppam-2-r16\"\ncircumference = \"270 mm\"\ncells = [4, 12]\n\
    [[material]]\nname = \"cloth\"\nlaw = \"st-venant\"\nthickness = \"0.1 mm\"\nyoung = \"500 MPa\"\npoisson = 0.3\n\
    [[part]]\ngroup = \"cloth\"\nkind = \"membrane\"\nmaterial = \"cloth\"\n\
    [[part]]\ngroup = \"fibre\"\nkind = \"cable\"\nstiffness = \"12 kN\"\n\
    [[step]]\npressure = \"1 bar\"\ncontraction = \"4 %\"\n[[step]]\ncontraction = \"32 %\"\nstates = 14\n";

#[test]
fn a_case_gives_states_tables_and_pictures() {
    let folder = Folder::new("membrane-states");
    let (case, out) = (folder.write("case.toml", TUBE), folder.path("out"));
    let document = json(&["membrane", &case, "--out", &out, "--json"]);
    assert_eq!(document["schema"], "bulge.membrane/1");
    let state = &document["states"][0];
    // Shooting: -4.5093718857 N; 30 quadratic elements.
    assert!((state["force_n"].as_f64().unwrap() + 4.509_371_9).abs() < 1e-4);
    assert!((state["volume_m3"].as_f64().unwrap() - 34_161.1e-9).abs() < 1e-10);
    assert_eq!((state["unstable"].as_u64(), state["slack"].as_f64()), (Some(0), Some(0.0)));
    for name in ["states.csv", "forces.csv", "clamped-tube-of-rubber.pvd", "clamped-tube-of-rubber_0000.vtu"]
    {
        assert!(std::path::Path::new(&out).join(name).is_file(), "{name}");
    }
    let text = bulge(&["membrane", &case, "--out", &out]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("clamped tube of rubber: 61 nodes, 30 elements"));
}

/// A command runs on a thread of the pool: with one, nothing else may wait for the pool.
#[test]
fn one_thread_is_enough_and_gives_the_same_bytes() {
    let folder = Folder::new("membrane-threads");
    let airbag = include_str!("../../../../meshes/airbag.toml").replace("[40, 40]", "[16, 16]");
    let case = folder.write("case.toml", &airbag.replace("poisson = 0.4", "poisson = 0.4\nbending = true"));
    let [one, two] = ["1", "2"].map(|threads| {
        let out = folder.path(threads);
        let run = Command::new(env!("CARGO_BIN_EXE_bulge"))
            .args(["membrane", &case, "--out", &out])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        assert!(run.status.success());
        let read = |name: &str| std::fs::read(Path::new(&out).join(name)).unwrap();
        [read("states.csv"), read("square-airbag_0000.vtu"), read("square-airbag-whole.vtu")]
    });
    assert!(one == two && one.iter().all(|bytes| bytes.len() > 100));
}

#[test]
fn the_cloth_becomes_an_effect_of_the_muscle() {
    let folder = Folder::new("membrane-effect");
    let (case, out, model) =
        (folder.write("case.toml", PLEATED), folder.path("out"), folder.path("model.toml"));
    let document = json(&["membrane", &case, "--out", &out, "--as-effect", &model, "--json"]);
    let effect = &document["effect"];
    let [after, before] = ["rmse_n", "before_rmse_n"].map(|name| effect[name].as_f64().unwrap());
    assert!(after < 0.3 * before, "{after} {before}");
    // The file is an ordinary muscle, and gives the force of the elements where the cloth is taut.
    let states = document["states"].as_array().unwrap();
    let state =
        states.iter().find(|state| (state["contraction"].as_f64().unwrap() - 0.2).abs() < 1e-9).unwrap();
    let shape = |muscle: &str| {
        let given = ["shape", muscle, "--pressure", "1 bar", "--contraction", "20 %", "--json"];
        json(&given)["force_n"].as_f64().unwrap()
    };
    let force = state["force_n"].as_f64().unwrap();
    let [learnt, stated] = [shape(&model), shape("ppam-2-r16")];
    assert!(
        (learnt - force).abs() < 2.5 * after && (stated - force).abs() > 100.0,
        "{learnt} {stated} {force}"
    );
    let text = std::fs::read_to_string(&model).unwrap();
    let radius =
        text.lines().find_map(|line| line.strip_prefix("unfolded_radius = \"")?.split(' ').next()).unwrap();
    assert!((radius.parse::<f64>().unwrap() / 42.97 - 1.0).abs() < 0.15, "{text}");
}

/// The cases in `meshes/` give the values of their README, which come from other methods than elements.
#[test]
fn the_ready_cases_give_their_numbers() {
    let force = |row: &Row| row.force.unwrap();
    // A case, a state counted from 1, and its deviation.
    let rows = |name: &str| {
        let case = Case::read(format!("{}/../../meshes/{name}.toml", env!("CARGO_MANIFEST_DIR"))).unwrap();
        let mut rows = Vec::new();
        case.start().unwrap().last_row(|row| rows.push(row.clone())).unwrap();
        assert!(rows.iter().all(|row| row.unstable == 0 && row.residual < 1e-9), "{name}");
        rows
    };
    let near = |what: &str, found: f64, exact: f64, tolerance: f64| {
        assert!((found / exact - 1.0).abs() < tolerance, "{what}: {found} {exact}");
    };
    let tube = rows("tube-3d");
    near("tube: force", force(&tube[0]), -4.509_371_885_7, 2e-3);
    near("tube: diameter", tube[0].diameter, 28.277_491_75e-3, 3e-4);
    near("airbag: volume", rows("airbag")[0].volume, 0.125, 1e-3);
    let dome = rows("dome");
    near("dome: volume", dome[3].volume, 9.859_602_82e-6, 5e-6);
    near("dome: pressure past its limit", dome[7].pressure, 36_277.64, 2e-5);
    let askew = &rows("askew")[3];
    near("askew: force", force(askew), 1_505.299_89, 5e-4);
    near("askew: volume", askew.volume, 326.802_79e-6, 1.5e-3);
    near("askew: tension", askew.threads[1], 267.023_7, 1e-3);
    // Shooting with u(r).
    let braid = rows("braid-bladder");
    near("braid: force at 5 %", force(&braid[0]), 456.356_632_06, 1e-7);
    near("braid: force at 20 %", force(&braid[3]), 116.237_819_77, 1e-7);
    near("braid: volume at 20 %", braid[3].volume, 34.085_971_6e-6, 1e-7);
}

/// Abundant cloth never becomes taut: the force lost to lobes must not be called limited unfolding.
#[test]
fn a_wrong_effect_is_not_written() {
    let folder = Folder::new("membrane-wrong-effect");
    let (out, model) = (folder.path("out"), folder.path("model.toml"));
    let case = folder.write("case.toml", &PLEATED.replace("270 mm", "330 mm"));
    let parts = ["nothing is written", "52.52 mm", "lobes", "contract further"];
    refused(&["membrane", &case, "--out", &out, "--as-effect", &model], 3, &parts);
    assert!(
        !std::path::Path::new(&model).exists() && std::path::Path::new(&out).join("forces.csv").is_file()
    );
    // A tube has no pleats.
    let tube = folder.write("tube.toml", TUBE);
    refused(&["membrane", &tube, "--out", &out, "--as-effect", &model], 1, &["--as-effect", "pleated"]);
}

#[test]
fn a_pressure_beyond_the_limit_is_said_with_the_last_state() {
    let folder = Folder::new("membrane-limit");
    let text = TUBE.replace("pressure = \"30 kPa\"", "pressure = \"50 kPa\"\nstates = 2");
    let (case, out) = (folder.write("case.toml", &text), folder.path("out"));
    // The last state reached, and the one nearest to the limit.
    let last = "the last equilibrium on the way to state 2: 0.3434 bar";
    let parts = ["state 2", "prescribe the volume", "3.43", "states.csv", last];
    refused(&["membrane", &case, "--out", &out], 3, &parts);
    let states = std::fs::read_to_string(format!("{out}/states.csv")).unwrap();
    assert_eq!(states.lines().count(), 3);
    let pressure: f64 = states.lines().last().unwrap().split(',').nth(2).unwrap().parse().unwrap();
    assert!((pressure / 34_342.062 - 1.0).abs() < 1e-3, "{pressure}");
    // Prescribing the volume leads beyond it.
    let text = TUBE.replace("pressure = \"30 kPa\"", "volume = \"68.3118838 ml\"");
    let case = folder.write("volume.toml", &text);
    let document = json(&["membrane", &case, "--out", &out, "--json"]);
    assert!((document["states"][0]["pressure_pa"].as_f64().unwrap() / 32_353.062 - 1.0).abs() < 1e-4);
}

/// Files of an earlier run are neither taken for results of this one nor fitted.
#[test]
fn an_earlier_run_is_cleared_away() {
    let folder = Folder::new("membrane-again");
    let (out, model) = (folder.path("out"), folder.path("model.toml"));
    let short = PLEATED.replace("states = 14", "states = 3");
    let case = folder.write("case.toml", &short);
    json(&["membrane", &case, "--out", &out, "--json"]);
    let names = || {
        let mut names: Vec<String> = std::fs::read_dir(&out)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    assert!(names().len() == 8 && names().contains(&"membrane-whole.vtu".to_owned()), "{:?}", names());
    std::fs::write(format!("{out}/notes.txt"), "mine").unwrap();
    // Without pressure there is no force to fit, although there was one in the earlier run.
    let steps = short.find("[[step]]").unwrap();
    let slack = short[..steps].to_owned() + "[[step]]\npressure = \"0 bar\"\ncontraction = \"0 %\"\n";
    let case = folder.write("case.toml", &slack);
    refused(&["membrane", &case, "--out", &out, "--as-effect", &model], 1, &["nothing to learn from"]);
    assert_eq!(
        names(),
        ["membrane-whole.vtu", "membrane.pvd", "membrane_0000.vtu", "notes.txt", "states.csv"]
    );
    assert!(!std::path::Path::new(&model).exists());
    // An output file that can't be written is rejected before the run.
    let nowhere = folder.path("nowhere/model.toml");
    refused(&["membrane", &case, "--out", &out, "--as-effect", &nowhere], 1, &["there is no folder"]);
}

#[test]
fn a_run_that_does_not_converge_ends_with_4() {
    let folder = Folder::new("membrane-diverges");
    let text = format!("{TUBE}\n[solver]\niterations = 1\n");
    let (case, out) = (folder.write("case.toml", &text), folder.path("out"));
    refused(&["membrane", &case, "--out", &out], 4, &["no equilibrium after 1 iterations", "smaller load"]);
}

#[test]
fn mistaken_cases_are_refused_with_their_cure() {
    let folder = Folder::new("membrane-mistakes");
    let out = folder.path("out");
    let cases = [
        ("group = \"wall\"", "group = \"wal\"", "did you mean `wall`?"),
        ("material = \"rubber\"", "material = \"steel\"", "there is rubber"),
        ("shear = \"0.4 MPa\"", "shear = \"-0.4 MPa\"", "> 0"),
        ("shear = \"0.4 MPa\"", "young = \"0.4 MPa\"", "it has shear"),
        ("thickness = \"1 mm\"", "thickness = 1", "thickness"),
        ("law = \"neo-hooke\"", "law = \"neohooke\"", "neo-hooke"),
        ("cells = [30]", "cells = [30, 0]", "cells"),
        ("cells = [30]", "cells = [10, 30]", "of triangles"),
        ("order = 2", "order = 3", "`order` is 1"),
        ("kind = \"tube\"", "kind = \"tub\"", "tube"),
        ("pressure = \"30 kPa\"", "pressure = \"-30 kPa\"", "at least 0"),
        ("pressure = \"30 kPa\"", "pressure = \"30 kPa\"\nvolume = \"1 ml\"", "keep one of them"),
        ("pressure = \"30 kPa\"", "gas = \"isothermal\"", "no gas in it yet"),
        ("pressure = \"30 kPa\"", "pressure = \"30 kPa\"\nforces = { top = \"1 N\" }", "loaded"),
        (
            "pressure = \"30 kPa\"",
            "pressure = \"30 kPa\"\nplaces = { roof = \"1 mm\" }",
            "there is bottom, top",
        ),
        ("pressure = \"30 kPa\"", "presure = \"30 kPa\"", "did you mean `pressure`?"),
        ("[mesher]", "mesh = \"a.msh\"\n[mesher]", "keep one of them"),
    ];
    for (from, to, cure) in cases {
        assert!(TUBE.contains(from), "{from}");
        let case = folder.write("case.toml", &TUBE.replace(from, to));
        refused(&["membrane", &case, "--out", &out], 1, &[cure, "case.toml"]);
    }
    assert_eq!(folder.names(), ["case.toml"], "a refused case leaves nothing behind");
    // A plane of symmetry that doesn't close the volume, and contradictory supports.
    for (more, cure) in [
        (
            "[[support]]\ngroup = \"last\"\nkind = \"plane\"\nnormal = [1, 0, 1]\n",
            "level or contain the z axis",
        ),
        ("[[support]]\ngroup = \"last\"\nkind = \"fitting\"\nfitting = \"bottom\"\n", "two fittings"),
        ("[[support]]\ngroup = \"wall\"\nkind = \"fixed\"\n", "keep one of the two"),
    ] {
        let case = folder.write("case.toml", &format!("{TUBE}\n{more}"));
        refused(&["membrane", &case, "--out", &out], 1, &[cure]);
    }
}

/// The mesh of a quarter of a tube as a file of Gmsh.
fn gmsh() -> String {
    bulge_membrane::mesher::tube(10.0, 60.0, [6, 12], false, bulge_membrane::mesher::Grading::Even).to_msh()
}

const FROM_FILE: &str = "mesh = \"tube.msh\"\n[scale]\nunit = \"mm\"\naround = 4\nlength = \"60 mm\"\n\
    [[material]]\nname = \"rubber\"\nlaw = \"neo-hooke\"\nthickness = \"1 mm\"\nshear = \"0.4 MPa\"\n\
    [[part]]\ngroup = \"wall\"\nkind = \"membrane\"\nmaterial = \"rubber\"\n\
    [[support]]\ngroup = \"left\"\nkind = \"plane\"\nnormal = [0, 1, 0]\n\
    [[support]]\ngroup = \"right\"\nkind = \"plane\"\nnormal = [1, 0, 0]\n\
    [[support]]\ngroup = \"first\"\nkind = \"fitting\"\nfitting = \"bottom\"\n\
    [[support]]\ngroup = \"last\"\nkind = \"fitting\"\nfitting = \"top\"\n\
    [[step]]\npressure = \"20 kPa\"\ncontraction = \"5 %\"\n";

#[test]
fn meshes_come_from_gmsh() {
    let folder = Folder::new("membrane-gmsh");
    let out = folder.path("out");
    let mesh = gmsh();
    folder.write("tube.msh", &mesh);
    let case = folder.write("case.toml", FROM_FILE);
    let document = json(&["membrane", &case, "--out", &out, "--json"]);
    assert!((document["states"][0]["contraction"].as_f64().unwrap() - 0.05).abs() < 1e-12);
    let volume = document["states"][0]["volume_m3"].as_f64().unwrap();
    assert!(volume > 2e-5 && volume < 3e-5, "{volume}");
    // The same mesh in metres is a thousand times too large, but still valid; without a unit it is rejected.
    let no_unit = folder.write("no-unit.toml", &FROM_FILE.replace("unit = \"mm\"\n", ""));
    refused(&["membrane", &no_unit, "--out", &out], 1, &["`unit`"]);
    // Truncated in the middle.
    folder.write("tube.msh", &mesh[..mesh.len() / 2]);
    refused(&["membrane", &case, "--out", &out], 1, &["tube.msh"]);
    // A hole: a free edge without support.
    folder.write("tube.msh", &mesh);
    let support = "[[support]]\ngroup = \"right\"\nkind = \"plane\"\nnormal = [1, 0, 0]\n";
    let hole = folder.write("hole.toml", &FROM_FILE.replace(support, ""));
    refused(&["membrane", &hole, "--out", &out], 1, &["open edge", "element"]);
}

const BLADDER: &str = "name = \"braid\"\nkind = \"braided\"\nlength = \"60 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nwall = \"1 mm\"\n\
    fibres = 100\nfibre = { stiffness = \"2 kN\" }\n[effects.bladder-elasticity]\nc10 = \"0.2 MPa\"\n";

/// Two methods without common parts: shooting on the meridian, and elements on the energy.
#[test]
fn a_shape_by_elements_is_that_of_the_meridian() {
    let folder = Folder::new("membrane-shape");
    let bladder = folder.write("bladder.toml", BLADDER);
    for muscle in ["ppam-2-r16", "dmsp-20-250", &bladder] {
        for given in [["--contraction", "15 %"], ["--force", "150 N"]] {
            let shape = |method: &str| {
                json(
                    &[&["shape", muscle, "--pressure", "2 bar", "--method", method, "--json"], &given[..]]
                        .concat(),
                )
            };
            let [shot, found] = ["shooting", "membrane"].map(shape);
            assert_eq!(found["method"], "membrane");
            let names = [
                ("force_n", 1e-6),
                ("contraction", 1e-6),
                ("volume_m3", 1e-7),
                ("volume_polygon_m3", 1e-7),
                ("max_radius_m", 1e-6),
                ("fibre_tension_n", 1e-4),
                ("stiffness_n_per_m", 1e-4),
                ("stiffness_isothermal_n_per_m", 1e-4),
            ];
            for (name, tolerance) in names {
                let [a, b] = [&shot, &found].map(|shape| shape[name].as_f64().unwrap());
                assert!((a / b - 1.0).abs() < tolerance, "{muscle} {given:?} {name}: {a} {b}");
            }
            // In the middle, where both have a point.
            let [shot, found] = [&shot, &found].map(|shape| {
                let points = shape["meridian"].as_array().unwrap();
                points[points.len() / 2].clone()
            });
            for name in ["x_m", "r_m", "membrane_force_n_per_m", "fibre_length_m"] {
                let [a, b] = [&shot, &found].map(|point| point[name].as_f64().unwrap());
                assert!((a / b - 1.0).abs() < 1e-5, "{muscle} {given:?} {name}: {a} {b}");
            }
        }
    }
    // Where the meridian has no equilibrium, elements must give none either, although a surface of elements
    // may fold past its limit.
    for (muscle, contraction) in [("ppam-2-r16", "90 %"), ("ppam-2-r16", "-5 %"), ("dmsp-20-250", "45 %")] {
        let given = format!("--contraction={contraction}");
        let command =
            |method| ["shape", muscle, "--pressure", "1 bar", &given, "--method", method].map(String::from);
        let [shot, found] =
            ["shooting", "membrane"].map(|method| failure(&command(method).each_ref().map(String::as_str)));
        assert!(found.0 == 3 && found == shot, "{shot:?} {found:?}");
    }
    refused(&["curve", "ppam-1", "--pressure", "1 bar", "--method", "membrane"], 1, &["bulge membrane"]);
    let lobed =
        folder.write("lobed.toml", &(BLADDER.to_owned() + "[effects.force-offset]\nforce = \"3 N\"\n"));
    let call = ["shape", &lobed, "--pressure", "1 bar", "--contraction", "9 %", "--method", "membrane"];
    refused(&call, 1, &[]);
}
