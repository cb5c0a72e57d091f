//! Files of strangers: whatever they hold, a terminal shows text, on the lines that we gave it, with an end.

use crate::support::{Folder, MUSCLE, PROTOCOL, bulge, refused};
use bulge_muscles::shown::is_shown;
use std::fs;

/// What a terminal would obey (colours, links, its clipboard, its bell, a clearing of the screen), what writes a line
/// of its own, what can't be seen or turns the writing, and what has no end.
fn strings() -> [String; 5] {
    [
        "x\u{1b}[31m\u{1b}]8;;http://x\u{7}y\u{1b}]8;;\u{7}\u{1b}]52;c;Zm9v\u{7}\u{9b}2J".to_owned(),
        "x\r\nFORGED\n\nFORGED: done\r\u{b}\0\u{8}".to_owned(),
        "x\nFORGED".to_owned(),
        "x\u{202e}\u{2066}\u{200b}\u{feff}\u{2028}FORGED\u{e0041}".to_owned(),
        "x".repeat(200_000),
    ]
}

/// Longest line of a message, with the mark that it was cut.
const LONGEST: usize = 1000;

#[track_caller]
fn check(arguments: &[&str]) {
    let output = bulge(arguments);
    let [printed, said] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    for text in [&printed, &said] {
        let odd = text.chars().find(|c| *c != '\n' && !is_shown(*c));
        assert_eq!(odd, None, "{arguments:?}: {text:?}");
        assert!(!text.lines().any(|line| line.trim().starts_with("FORGED")), "{arguments:?}: {text}");
    }
    assert!(said.lines().all(|line| line.chars().count() <= LONGEST) && said.lines().count() < 310, "{said}");
    assert!(!said.contains("panicked"), "{arguments:?}: {said}");
    if arguments.contains(&"--json") {
        serde_json::from_str::<serde_json::Value>(&printed).unwrap();
    } else {
        let length = printed.chars().count();
        assert!(length < 100_000, "{arguments:?} print {length} characters");
    }
}

/// Writes each string into each hole of a file, and calls: `FILE` is the file, `OUT` a place for what is written.
fn fill(name: &str, texts: &[&str], calls: &[&str], written: impl Fn(&str) -> String) {
    let folder = Folder::new("hostile");
    let out = folder.path("out");
    for text in texts {
        assert!(text.contains("HOLE"), "{text}");
        for string in strings() {
            let file = folder.write(name, &text.replace("HOLE", &written(&string)));
            for call in calls {
                let words: Vec<&str> = crate::support::line(call)
                    .into_iter()
                    .map(|word| match word {
                        "FILE" => &*file,
                        "OUT" => &*out,
                        "MUSCLE" => MUSCLE,
                        "PROTOCOL" => PROTOCOL,
                        "DATA" => DATA,
                        other => other,
                    })
                    .collect();
                check(&words);
            }
        }
    }
}

/// A text of TOML: escapes write what a file can't hold as it is.
fn toml(string: &str) -> String {
    serde_json::to_string(string).unwrap()
}

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/data/braid-loops.csv");

const BRAID: &str = "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10.7 mm\"\nbraid_angle = \"25 deg\"\n\
    ends = \"cylinder\"\nwall = \"2 mm\"\n";

#[test]
fn muscles() {
    let texts = [
        format!("name = HOLE\n{BRAID}"),
        format!("name = \"x\"\nHOLE = 1\n{BRAID}"),
        format!("name = \"x\"\n{}", BRAID.replace("\"250 mm\"", "HOLE")),
        format!("name = \"x\"\n{}", BRAID.replace("\"braided\"", "HOLE")),
        format!("name = \"x\"\n{BRAID}[effects.HOLE]\nk = \"1 N\"\n"),
        format!("name = \"x\"\n{BRAID}[specimens.HOLE]\nlength = \"1 m\"\n"),
        format!("name = \"x\"\n{BRAID}[data.columns]\nforce = HOLE\n"),
        format!("name = \"x\"\n{BRAID}[instruments]\nforce = {{ noise = HOLE }}\n"),
    ];
    let texts = texts.each_ref().map(String::as_str);
    let calls = [
        "shape FILE --pressure '1 bar' --contraction '5 %'",
        "shape FILE --pressure '1 bar' --contraction '5 %' --json",
        "compare DATA --muscle FILE",
        "simulate FILE --protocol PROTOCOL --out OUT",
    ];
    fill("muscle.toml", &texts, &calls, toml);
    // The other commands read the same file in the same way.
    let calls = [
        "curve FILE --pressure '1 bar' --points 3",
        "fit DATA --muscle FILE --with force-offset",
        "diagnose DATA --muscle FILE",
        "plan --muscle FILE --protocol PROTOCOL",
        "next DATA --muscle FILE",
        "predict DATA --muscle FILE",
        "muscle FILE",
        "air fill --muscle FILE",
        "sense FILE",
        "open DATA --muscle FILE --no-browser --port 1",
    ];
    fill("muscle.toml", &texts[2..3], &calls, toml);
}

#[test]
fn measurements() {
    let rows = "1,240,100,a\n1,239,98,a\n1,238,96,a\n1,237,94,b\n2,240,200,b\n2,239,195,b\n";
    let head = "pressure [bar],length [mm],force [N],specimen\n";
    let texts = [
        format!("{head}{rows}").replacen("force [N]", "force HOLE,force2 [N]", 1),
        format!("{head}{rows}").replacen("force [N]", "force [HOLE]", 1),
        format!("{head}{rows}").replacen(",98,", ",HOLE,", 1),
        format!("{head}{rows}").replacen(",a\n", ",HOLE\n", 1),
        format!("# HOLE\n{head}{rows}"),
        format!("HOLE\n{head}{rows}"),
    ];
    let texts = texts.each_ref().map(String::as_str);
    let calls = [
        "compare FILE --muscle MUSCLE",
        "compare FILE --muscle MUSCLE --json",
        "fit FILE --muscle MUSCLE --with force-offset",
        "diagnose FILE --muscle MUSCLE",
        "predict FILE --muscle MUSCLE",
        "next FILE --muscle MUSCLE",
    ];
    let quoted = |string: &str| format!("\"{}\"", string.replace('"', "\"\""));
    fill("data.csv", &texts, &calls[..2], quoted);
    fill("data.csv", &texts[2..4], &calls[2..], quoted);
    // As text whose separators are guessed, and as what it is not.
    fill("data.txt", &texts[..3], &calls[..1], str::to_owned);
    for name in ["data.xlsx", "data.mat", "data.parquet"] {
        fill(name, &["HOLE"], &calls[..1], str::to_owned);
    }
}

#[test]
fn names_without_number_are_counted() {
    let folder = Folder::new("hostile-names");
    let names = (0..100_000).map(|n| format!(",column{n} [m]")).collect::<Vec<_>>().concat();
    let wide = folder.write("wide.csv", &format!("pressure [bar],length [mm]{names}\n1,2\n"));
    check(&["compare", &wide, "--muscle", MUSCLE]);
    check(&["compare", &wide, "--muscle", MUSCLE, "--columns", "force=nothing"]);
    let row = |n| format!("{},{},{},s{n}\n", 1 + n % 3, 230 + n % 7, 100 + n % 9);
    let rows = (0..100_000).map(row).collect::<Vec<_>>().concat();
    let long = folder.write("long.csv", &format!("pressure [bar],length [mm],force [N],specimen\n{rows}"));
    let muscle = fs::read_to_string(MUSCLE).unwrap() + "[specimens.other]\nlength = \"200 mm\"\n";
    let muscle = folder.write("muscle.toml", &muscle);
    let output = bulge(&["compare", &long, "--muscle", &muscle]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("`s0`, `s1`") && said.contains("and 99980 more"), "{said}");
    check(&["compare", &long, "--muscle", &muscle]);
}

#[test]
fn effects_protocols_sweeps_and_joints() {
    let effect = "[effects.hose]\ntitle = \"t\"\nforce = \"-k * eps\"\n\
        parameters.k = { unit = \"N\", typical = \"50 N\", low = \"0 N\", high = \"500 N\" }\n";
    let texts = [
        effect.replace("effects.hose", "effects.HOLE"),
        effect.replace("\"t\"", "HOLE"),
        effect.replace("\"-k * eps\"", "HOLE"),
        effect.replace("parameters.k", "parameters.HOLE"),
        effect.replace("unit = \"N\"", "unit = HOLE"),
        format!("{effect}source = HOLE\nabout = HOLE\n")
            .replace("parameters.k", "source = HOLE\nparameters.k")
            .replace("source = HOLE\nabout = HOLE\n", ""),
        effect.replace("title", "twins = [HOLE]\ntitle"),
    ];
    let texts = texts.each_ref().map(String::as_str);
    let calls = [
        "effects --effects FILE",
        "effects hose --effects FILE",
        "compare DATA --muscle MUSCLE --effects FILE --with hose",
    ];
    fill("effects.toml", &texts, &calls, toml);

    let block =
        "[[block]]\npressures = [\"3 bar\"]\ncontraction = \"1 %..20 %\"\nperiod = \"50 s\"\nrows = 50\n";
    let texts = [
        block.replace("\"3 bar\"", "HOLE"),
        block.replace("\"1 %..20 %\"", "HOLE"),
        format!("{block}HOLE = 1\n"),
        format!("{block}shape = HOLE\n"),
    ];
    let calls = ["simulate MUSCLE --protocol FILE --out OUT", "plan --muscle MUSCLE --protocol FILE --json"];
    fill("protocol.toml", &texts.each_ref().map(String::as_str), &calls, toml);

    let sweep = "name = \"s\"\nmuscle = \"ppam-2-r16\"\noutputs = [\"force_f\"]\n[axes.contraction]\nvalues = [0.1]\n";
    let texts = [
        sweep.replace("\"ppam-2-r16\"", "HOLE"),
        sweep.replace("\"force_f\"", "HOLE"),
        sweep.replace("axes.contraction", "axes.HOLE"),
        sweep.replace("values = [0.1]", "range = HOLE"),
        sweep.replace("\"s\"", "HOLE"),
        format!("effects = HOLE\n{sweep}"),
    ];
    fill("sweep.toml", &texts.each_ref().map(String::as_str), &["sweep FILE --out OUT"], toml);

    let joint = "name = \"knee\"\nmuscle = \"ppam-2-r16\"\nkind = \"pulley\"\nradius = \"40 mm\"\ncontraction = \"20 %\"\n\
        angle = \"-25 deg..25 deg\"\npressure = \"0.5 bar..3 bar\"\n";
    let texts = [
        joint.replace("\"knee\"", "HOLE"),
        joint.replace("\"ppam-2-r16\"", "HOLE"),
        joint.replace("\"pulley\"", "HOLE"),
        joint.replace("\"40 mm\"", "HOLE"),
    ];
    let calls = ["joint FILE --pressure '2 bar,1.5 bar'"];
    fill("joint.toml", &texts.each_ref().map(String::as_str), &calls, toml);
    let calls = ["table info FILE", "table eval FILE --at 'contraction=0.1'", "table info FILE --json"];
    fill("made.table", &["HOLE", "BULGETABHOLE"], &calls, str::to_owned);
}

#[test]
fn membranes() {
    let case = include_str!("../../../../meshes/airbag.toml");
    let texts = [
        case.replace("\"square airbag\"", "HOLE").replace("[40, 40]", "[2, 2]"),
        case.replace("\"square\"", "HOLE"),
        case.replace("group = \"cloth\"", "group = HOLE"),
        case.replace("material = \"foil\"", "material = HOLE"),
        case.replace("name = \"foil\"", "name = HOLE"),
        "mesh = HOLE\n".to_owned(),
    ];
    fill("case.toml", &texts.each_ref().map(String::as_str), &["membrane FILE --out OUT"], toml);
    // Names of groups stand in the mesh.
    let folder = Folder::new("hostile-mesh");
    let mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"HOLE\"\n$EndPhysicalNames\n$Nodes\n3\n\
        1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n1 2 2 1 1 1 2 3\n$EndElements\n";
    let grid = "<VTKFile type='UnstructuredGrid' version='1.0'><UnstructuredGrid><FieldData><Array type='String' Name='groups' \
        format='ascii'>HOLE</Array></FieldData><Piece NumberOfPoints='3' NumberOfCells='1'><Points><DataArray type='Float64' \
        NumberOfComponents='3' format='ascii'>0 0 0 1 0 0 0 1 0</DataArray></Points><Cells><DataArray type='Int64' \
        Name='connectivity' format='ascii'>0 1 2</DataArray><DataArray type='Int64' Name='offsets' format='ascii'>3</DataArray>\
        <DataArray type='UInt8' Name='types' format='ascii'>5</DataArray></Cells><CellData><DataArray type='Int64' Name='group' \
        format='ascii'>0</DataArray></CellData></Piece></UnstructuredGrid></VTKFile>\n";
    for string in strings() {
        let codes = string.bytes().chain([0]).map(|byte| byte.to_string()).collect::<Vec<_>>().join(" ");
        for (name, text) in [
            ("mesh.msh", mesh.replace("HOLE", &string)),
            ("mesh.vtu", grid.replace("HOLE", &codes)),
            ("mesh.vtu", grid.replace("groups", &string)),
            ("mesh.vtu", grid.replace("VTKFile", "HOLE").replace("HOLE", &string)),
        ] {
            folder.write(name, &text);
            let case = case.split_once("[mesher]").unwrap().1.split_once("[[material]]").unwrap().1;
            let case = folder.write(
                "case.toml",
                &format!("mesh = \"{name}\"\n[scale]\nunit = \"mm\"\n[[material]]{case}"),
            );
            check(&["membrane", &case, "--out", &folder.path("out")]);
        }
    }
}

#[test]
fn arguments_and_names_of_files() {
    let folder = Folder::new("hostile-arguments");
    for string in strings() {
        let string = string.replace(['\0', '/'], "");
        let path = folder.path(&format!("{}.toml", string.chars().take(100).collect::<String>()));
        fs::write(&path, "name = 1\n").unwrap();
        for arguments in [
            &["shape", &path, "--pressure", "1 bar"][..],
            &["compare", &path, "--muscle", MUSCLE],
            &["table", "info", &path],
            &["table", "info", &path, "--json"],
            &["membrane", &path, "--out", &folder.path("out")],
            &["sweep", &path, "--out", &folder.path("out")],
            &["compare", DATA, "--muscle", MUSCLE, "--with", &string],
            &["compare", DATA, "--muscle", MUSCLE, "--columns", &string],
            &["compare", DATA, "--muscle", MUSCLE, "--exclude", &string],
            &["shape", MUSCLE, "--pressure", &string],
            &[&string],
            &["effects", &string],
        ] {
            // The longest argument of all is too long for a system.
            let cut: Vec<&str> =
                arguments.iter().map(|word| &word[..word.floor_char_boundary(100_000)]).collect();
            check(&cut);
        }
    }
}

/// Whatever the command and whatever the option: a file that the command line names twice isn't written.
#[test]
fn a_file_that_is_read_is_not_written_over() {
    let folder = Folder::new("over");
    let text = fs::read_to_string(MUSCLE).unwrap();
    for (name, call) in [
        ("braid.csv", "curve FILE --pressure 1bar --points 5 --csv FILE"),
        ("braid.svg", "curve FILE --pressure 1bar --points 5 --plot=FILE"),
        ("braid.vtp", "shape FILE --pressure 1bar --contraction 5% --vtk SAME"),
    ] {
        let file = folder.write(name, &text);
        let same = folder.path(&format!("./{name}"));
        let call: Vec<String> =
            call.split(' ').map(|word| word.replace("FILE", &file).replace("SAME", &same)).collect();
        let call: Vec<&str> = call.iter().map(String::as_str).collect();
        refused(&call, 1, &[name, "the command reads it; give the name of another file"]);
        assert_eq!(fs::read_to_string(&file).unwrap(), text, "{name}");
    }
}
