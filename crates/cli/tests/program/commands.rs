//! The command as seen by a user: exit statuses, messages, JSON names, and the files left on the disk.

use crate::support::{Folder, bulge, failure, has_parts, json, line, refused, stdout};
use std::path::Path;
use std::process::Command;

const PPAM: &str =
    "name = \"test\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n";

#[test]
fn shape_as_json_has_the_names_others_rely_on() {
    let folder = Folder::new("shape");
    let muscle = folder.write("muscle.toml", PPAM);
    let shape = json(&["shape", &muscle, "--pressure", "1 bar", "--contraction", "20 %", "--json"]);
    // physics: 544.0 N, 376.9 ml at 1 bar and 20 %
    assert!((shape["force_n"].as_f64().unwrap() - 544.0).abs() < 0.05);
    assert!((shape["volume_m3"].as_f64().unwrap() - 376.9e-6).abs() < 0.05e-6);
    for name in [
        "length_m",
        "contraction",
        "max_radius_m",
        "fibre_tension_n",
        "fibre_strain",
        "stiffness_n_per_m",
        "contraction_limit",
        "m",
        "phi_r",
        "force_f",
        "volume_v",
    ] {
        assert!(shape[name].is_f64(), "{name} is {}", shape[name]);
    }
    assert_eq!(shape["method"], "closed-form");
    let meridian = shape["meridian"].as_array().unwrap();
    for name in ["x_m", "r_m", "slope_rad", "braid_angle_rad"] {
        assert!(meridian.iter().all(|point| point[name].is_f64()), "{name}");
    }
    assert_eq!(meridian.len(), 101);
}

#[test]
fn the_four_questions_agree() {
    let ask = |option: &str, value: &str| {
        json(&["shape", "dmsp-20-250", "--pressure", "3 bar", option, value, "--json"])
    };
    let by_contraction = ask("--contraction", "15 %");
    let text = |name: &str, factor: f64, unit: &str| {
        format!("{:.12} {unit}", by_contraction[name].as_f64().unwrap() * factor)
    };
    for (option, value) in [
        ("--length", text("length_m", 1e3, "mm")),
        ("--force", text("force_n", 1.0, "N")),
        ("--volume", text("volume_m3", 1e6, "ml")),
    ] {
        let other = ask(option, &value);
        let difference = other["contraction"].as_f64().unwrap() - 0.15;
        assert!(difference.abs() < 1e-9, "{option} {value}: {difference:e}");
    }
}

#[test]
fn what_is_wrong_with_the_input_is_status_1() {
    let folder = Folder::new("input");
    let with = |from: &str, to: &str| folder.write("muscle.toml", &PPAM.replace(from, to));
    let at = ["--pressure", "1 bar", "--force", "10 N"];
    let cases = [
        ("length", "lenght", ":3:1", "did you mean `length`"),
        ("\"110 mm\"", "\"110 mn\"", ":3:", "mm"),
        ("\"110 mm\"", "\"-110 mm\"", ":3:", "greater than 0"),
        ("\"110 mm\"", "110", ":3:", "\"110 mm\""),
        ("= 40", "= 2", ":5:", "at least 3"),
        ("\"110 mm\"", "\"NaN mm\"", ":3:", "finite"),
        ("radius = \"16 mm\"\n", "", "radius", "16 mm"),
        (PPAM, "", "states nothing", "kind"),
    ];
    for (from, to, place, cure) in cases {
        let muscle = with(from, to);
        let (status, message) = failure(&[&["shape", &muscle], &at[..]].concat());
        assert_eq!(status, 1, "{message}");
        has_parts(&message, &[place, cure]);
    }
    let folder_path = folder.0.display().to_string();
    for (muscle, says) in
        [(folder_path.as_str(), "directory"), ("nowhere.toml", "no such file"), ("x", "ppam-1")]
    {
        refused(&[&["shape", muscle], &at[..]].concat(), 1, &[says]);
    }
    for (pressure, says) in [
        ("0 bar", "greater than 0"),
        ("-1 bar", "greater than 0"),
        ("1", "has no unit"),
        ("1 Bar", "did you mean `bar`"),
        ("1 mm", "is a length"),
        ("NaN bar", "not finite"),
    ] {
        let (status, message) =
            failure(&["shape", "ppam-2-r16", "--pressure", pressure, "--contraction", "20 %"]);
        assert!(status == 1 && message.contains(says), "{pressure}: {message}");
    }
}

/// Files for every kind of input: a braid, data, a test protocol, a sweep, a joint.
fn ways_in(folder: &Folder, wall: &str, contraction: &str, pressure: &str) -> [String; 9] {
    let braid = format!(
        "name = \"b\"\nkind = \"braided\"\nlength = \"120 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nwall = \"{wall}\"\n"
    );
    let muscle = folder.write("m.toml", &braid);
    let row = |i: u32| format!("{},{contraction},{}\n", pressure.trim_end_matches(" bar"), 300 - 8 * i);
    let rows: String = (0..30).map(row).collect();
    let rows = rows.replace(" %", "");
    let data = folder.write("d.csv", &format!("pressure [bar],contraction [%],force [N]\n{rows}"));
    let block = format!(
        "[[block]]\npressures = [\"{pressure}\"]\ncontraction = \"1 %..{contraction}\"\nshape = \"loops\"\nwave = \"triangle\"\ncycles = 1\nperiod = \"50 s\"\nrows = 10\n"
    );
    let protocol = folder.write("p.toml", &block);
    let sweep = format!(
        "name = \"s\"\nmuscle = \"m.toml\"\npressure = \"{pressure}\"\noutputs = [\"force\"]\n[axes.contraction]\nrange = \"1 %..{contraction}\"\npoints = 3\n"
    );
    let sweep = folder.write("s.toml", &sweep);
    let joint = format!(
        "name = \"j\"\nmuscle = \"m.toml\"\nkind = \"pulley\"\nradius = \"20 mm\"\ncontraction = \"{contraction}\"\nangle = \"-5 deg..5 deg\"\npressure = \"0.5 bar..3 bar\"\n"
    );
    let joint = folder.write("j.toml", &joint);
    let [out, model] = ["out", "model.toml"].map(|name| folder.path(name));
    [
        format!("shape {muscle} --pressure '{pressure}' --contraction '{contraction}'"),
        format!("curve {muscle} --pressure '{pressure}' --contraction '0 %..{contraction}' --csv {model}"),
        format!(
            "size --muscle {muscle} --force '10 N' --stroke '5 mm' --pressure '{pressure}' --max-contraction '{contraction}'"
        ),
        format!("joint {joint} --pressure '{pressure},2 bar'"),
        format!("compare {data} --muscle {muscle} --out {out}"),
        format!("fit {data} --muscle {muscle} --with radius-error --out {model}"),
        format!("simulate {muscle} --protocol {protocol} --seed 1 --out {out}"),
        format!("sweep {sweep} --out {out}"),
        format!("air shut {muscle} --pressure '{pressure}' --contraction '{contraction}'"),
    ]
}

/// Impossible contractions, walls, pressures and holes give one message and status 1 for every kind of input,
/// and nothing is written.
#[test]
fn what_no_muscle_can_have_is_refused_by_every_way_in() {
    let folder = Folder::new("refused");
    for (wall, contraction, pressure) in [
        ("2 mm", "100 %", "2 bar"),
        ("2 mm", "120 %", "2 bar"),
        ("-2 mm", "10 %", "2 bar"),
        ("10 mm", "10 %", "2 bar"),
        ("2 mm", "10 %", "-2 bar"),
        ("2 mm", "10 %", "NaN bar"),
        ("2 mm", "10 %", "inf bar"),
    ] {
        for arguments in ways_in(&folder, wall, contraction, pressure) {
            let message = refused(&line(&arguments), 1, &[]);
            assert!(message.matches("error: ").count() == 1, "{arguments}: {message}");
        }
        assert_eq!(
            folder.names(),
            ["d.csv", "j.toml", "m.toml", "p.toml", "s.toml"],
            "{wall}, {contraction}, {pressure}"
        );
    }
    for hole in ["-2 mm", "0 mm", "20.1 mm", "NaN mm"] {
        let muscle = folder.path("m.toml");
        let (status, message) =
            failure(&["air", "fill", &muscle, "--supply", "3 bar", "--hole", hole, "--held", "10 %"]);
        assert!(status == 1 && message.contains("hole"), "{hole}: {message}");
    }
}

#[test]
fn usage_is_status_2() {
    assert_eq!(failure(&["shape", "ppam-2-r16"]).0, 2);
    assert_eq!(failure(&["shapes"]).0, 2);
    let (status, message) = failure(&["curve", "ppam-2-r16", "--pressure", "1 bar", "--plot", "a.PNG"]);
    assert!(status == 2 && message.contains("as SVG: write `a.svg`"), "{message}");
    assert_eq!(
        failure(&["shape", "ppam-2-r16", "--pressure", "1 bar", "--force", "1 N", "--length", "1 m"]).0,
        2
    );
}

#[test]
fn what_does_not_exist_is_status_3_with_the_limit() {
    let ask = |muscle: &str, option: &str, value: &str| {
        failure(&["shape", muscle, "--pressure", "2 bar", option, value])
    };
    for (muscle, option, value, says) in [
        ("ppam-2-r16", "--contraction", "45 %", "41.8497 %"),
        ("ppam-2-r16", "--contraction", "0 %", "greater than 0.0000 %"),
        ("ppam-2-r16", "--force", "-5 N", "41.8497 %"),
        ("ppam-2-r16", "--volume", "1 l", "435.8984 ml"),
        ("ppam-2-r16", "--volume", "1 ml", "88.4672 ml"),
        ("dmsp-20-250", "--force", "1 MN", "the largest force found is"),
        ("dmsp-20-250", "--contraction", "40 %", "35.4"),
        ("dmsp-20-250", "--contraction", "-9.5 %", "greater than -8."),
    ] {
        let (status, message) = ask(muscle, option, value);
        assert!(status == 3 && message.contains(says), "{muscle} {option} {value}: {status} {message}");
    }
    let folder = Folder::new("range");
    let long = folder.write("long.toml", &PPAM.replace("110 mm", "20 m"));
    refused(&["shape", &long, "--pressure", "1 bar", "--contraction", "20 %"], 3, &["1250", "1000"]);
}

#[test]
fn files_appear_whole_or_not_at_all() {
    let folder = Folder::new("files");
    let curve = ["curve", "ppam-2-r16", "--pressure", "1 bar,2 bar", "--points", "21"];
    let (csv, svg) = (folder.path("a.csv"), folder.path("a.svg"));
    stdout(&[&curve[..], &["--csv", &csv, "--plot", &svg]].concat());
    let text = std::fs::read_to_string(&csv).unwrap();
    assert_eq!(text.lines().count(), 1 + 2 * 21);
    assert!(text.starts_with("pressure [Pa],contraction [-],length [m],force [N],volume [m^3],"));
    assert!(std::fs::read_to_string(&svg).unwrap().contains("<svg"));
    assert_eq!(folder.names(), ["a.csv", "a.svg"]);
    for (option, name, says) in [
        ("--csv", "missing/a.csv", "no folder"),
        ("--csv", "", "folder"),
        ("--plot", "missing/a.svg", "no folder"),
    ] {
        refused(&[&curve[..], &[option, &folder.path(name)]].concat(), 1, &[says]);
    }
    assert_eq!(folder.names(), ["a.csv", "a.svg"]);
}

/// Each curve ends where its own muscle ceases to pull: a braid with rubber reaches further at a higher
/// pressure.
#[test]
fn each_pressure_has_a_range_of_its_own() {
    let folder = Folder::new("own-ranges");
    let muscle = folder.path("braid.toml");
    let text = "name = \"b\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nwall = \"1 mm\"\n[effects.bladder-elasticity]\nc10 = \"0.2 MPa\"\n";
    std::fs::write(&muscle, text).unwrap();
    let both = ["curve", &muscle, "--pressure", "1 bar,4 bar", "--points", "5", "--json"];
    let document: serde_json::Value = serde_json::from_slice(&bulge(&both).stdout).unwrap();
    let limits = [0, 1].map(|i| {
        let curve = &document["curves"][i];
        let points = curve["points"].as_array().unwrap();
        let (limit, last) = (&curve["contraction_limit"], &points[points.len() - 1]["contraction"]);
        assert_eq!((points.len(), limit), (5, last));
        limit.as_f64().unwrap()
    });
    assert!(limits[1] > limits[0] + 0.02, "{limits:?}");
}

/// Rubber strained by wide fittings carries all of the pressure before the force vanishes. The limit is the
/// same in `shape`, in its errors and in `curve`, which ends there.
#[test]
fn a_muscle_whose_fibres_slacken_ends_there() {
    let folder = Folder::new("slacken");
    let text = "name = \"b\"\nkind = \"braided\"\nlength = \"60 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nwall = \"3 mm\"\n\
        [effects.wall-thickness]\n[effects.end-radius]\nradius = \"16 mm\"\n[effects.bladder-elasticity]\nc10 = \"2 MPa\"\n";
    let muscle = folder.write("braid.toml", text);
    let shape = ["shape", &muscle, "--pressure", "2 bar", "--contraction"];
    let pulling = json(&[&shape[..], &["10 %", "--json"]].concat());
    assert_eq!(pulling["ends_slack"], true, "{pulling}");
    let limit = pulling["contraction_limit"].as_f64().unwrap();
    let printed = stdout(&[&shape[..], &["10 %"]].concat());
    let (status, message) = failure(&[&shape[..], &["40 %"]].concat());
    assert_eq!(status, 3);
    for (text, digits) in [(&printed, 3), (&message, 4)] {
        let named = format!("{:.digits$} %", 100.0 * limit);
        assert!(text.contains(&named) && text.contains("slack"), "{named}: {text}");
    }
    let curve = ["curve", &muscle, "--pressure", "2 bar", "--points", "9"];
    let document = json(&[&curve[..], &["--json"]].concat());
    let curve_json = &document["curves"][0];
    let points = curve_json["points"].as_array().unwrap();
    assert_eq!((curve_json["contraction_limit"].as_f64(), points.len()), (Some(limit), 9));
    assert_eq!(curve_json["ends_slack"], true);
    assert!(points[8]["force_n"].as_f64().unwrap() > 1.0, "{curve_json}");
    let text = stdout(&curve);
    assert!(text.contains(&format!("{:.3} %, where the fibres slacken", 100.0 * limit)), "{text}");
    // Points beyond the limit are left out, and the limit is given.
    let farther = [&curve[..], &["--contraction", "0 %..40 %"]].concat();
    let text = stdout(&farther);
    assert!(text.contains("left out") && text.contains(&format!("{:.4} %", 100.0 * limit)), "{text}");
    // Below, its fibres would have to be longer than they are.
    assert!(text.contains("drawn straight") && !text.contains("converge"), "{text}");
    // For a force beyond the reach of the muscle the answer gives the largest one.
    refused(
        &["shape", &muscle, "--pressure", "2 bar", "--force", "10 MN"],
        3,
        &["the largest force found is"],
    );
}

#[test]
fn curve_leaves_out_what_does_not_exist_and_says_so() {
    let range =
        ["curve", "ppam-2-r16", "--pressure", "1 bar", "--contraction", "0 %..45 %", "--points", "10"];
    let text = stdout(&range);
    assert!(text.contains("1 contraction is left out") && text.contains("41.8497 %"), "{text}");
    let document = json(&[&range[..], &["--json"]].concat());
    let curve = &document["curves"][0];
    assert_eq!(curve["points"].as_array().unwrap().len(), 8);
    assert_eq!(curve["without_equilibrium"].as_array().unwrap().len(), 2);
    let (status, _) = failure(&["curve", "ppam-2-r16", "--pressure", "1 bar", "--contraction", "50 %..60 %"]);
    assert_eq!(status, 3);
    let (status, message) =
        failure(&["curve", "ppam-2-r16", "--pressure", "1 bar", "--contraction", "30 %..20 %"]);
    assert!(status == 1 && message.contains("smaller contraction first"), "{message}");
}

#[test]
fn a_curve_is_the_same_bytes_on_any_number_of_threads() {
    let run = |threads: &str| {
        Command::new(env!("CARGO_BIN_EXE_bulge"))
            .args(["curve", "dmsp-20-250", "--pressure", "1 bar,3 bar", "--points", "301", "--csv", "-"])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap()
            .stdout
    };
    let one = run("1");
    assert!(one.len() > 10_000 && one == run("2") && one == run("7"));
}

#[test]
fn the_series_for_paraview_lists_its_members() {
    let folder = Folder::new("series");
    let out = folder.path("vtk");
    let arguments =
        ["curve", "dmsp-20-250", "--pressure", "3 bar", "--points", "9", "--frames", "3", "--vtk", &out];
    stdout(&arguments);
    let list = std::fs::read_to_string(Path::new(&out).join("bulge.pvd")).unwrap();
    assert_eq!(list.matches("<DataSet").count(), 3);
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 4);
}

#[test]
fn a_shipped_muscle_is_a_file_to_start_from() {
    let folder = Folder::new("shipped");
    let shipped = stdout(&["muscle", "ppam-2-r16"]);
    let file = folder.write("my.toml", &shipped);
    let ask = |muscle: &str| json(&["shape", muscle, "--pressure", "2 bar", "--force", "500 N", "--json"]);
    assert_eq!(ask(&file), ask("ppam-2-r16"));
}

/// Every option that names one file writes the same bytes into a file, a link, a FIFO and standard output; a
/// full device is an error and stays a device.
#[cfg(unix)]
#[test]
fn every_writer_writes_into_what_a_name_stands_for() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let folder = Folder::new("writers");
    let row = |i: u32| format!("{},{},{}", 1 + i % 3, 5 + i, 900 - 25 * i + 300 * (i % 3));
    let rows = (0..24).map(row).collect::<Vec<_>>().join("\n");
    let data = folder.write("data.csv", &format!("pressure [bar],contraction [%],force [N]\n{rows}"));
    let curve = ["curve", "dmsp-20-250", "--pressure", "1 bar", "--points", "5"];
    let shape = ["shape", "dmsp-20-250", "--pressure", "1 bar", "--contraction", "10 %", "--points", "5"];
    let writers: Vec<Vec<&str>> = vec![
        [&curve[..], &["--csv"]].concat(),
        [&curve[..], &["--plot"]].concat(),
        [&shape[..], &["--vtk"]].concat(),
        vec!["sense", "dmsp-20-250", "--points", "11", "--csv"],
        vec!["sense", "dmsp-20-250", "--points", "11", "--plot"],
        vec!["heat", "--pipe", "none", "--plot"],
        vec!["size", "--force", "300 N", "--stroke", "30 mm", "--plot"],
        vec!["fit", &data, "--muscle", "dmsp-20-250", "--with", "force-offset", "--out"],
    ];
    // As root a device can be created for the test; other users can't replace one.
    let own = folder.path("full.vtp");
    let is_made =
        Command::new("mknod").args([own.as_str(), "c", "1", "7"]).output().is_ok_and(|o| o.status.success());
    let full = if is_made { own.as_str() } else { "/dev/full" };
    let is_device =
        |path: &str| std::fs::metadata(path).is_ok_and(|found| found.file_type().is_char_device());
    for (i, writer) in writers.iter().enumerate() {
        let call = |target: &str| bulge(&[&writer[..], &[target]].concat());
        let file = folder.path(&format!("{i}.vtp"));
        let made = call(&file);
        assert!(made.status.success(), "{writer:?}: {}", String::from_utf8_lossy(&made.stderr));
        let expected = std::fs::read(&file).unwrap();
        assert!(!expected.is_empty());
        let [link, real] = [format!("{i}-link.vtp"), format!("{i}-real.vtp")];
        symlink(&real, folder.path(&link)).unwrap();
        assert!(call(&folder.path(&link)).status.success());
        assert!(Path::new(&folder.path(&link)).is_symlink(), "{writer:?} replaced a link");
        assert_eq!(std::fs::read(folder.path(&real)).unwrap(), expected, "{writer:?} through a link");
        for name in ["-", "/dev/stdout"] {
            assert!(call(name).stdout == expected, "{writer:?} to {name}");
        }
        let fifo = folder.path(&format!("{i}-fifo.vtp"));
        if Command::new("mkfifo").arg(&fifo).status().is_ok_and(|status| status.success()) {
            let reader = std::thread::spawn({
                let fifo = fifo.clone();
                move || std::fs::read(fifo).unwrap()
            });
            assert!(call(&fifo).status.success());
            assert!(reader.join().unwrap() == expected, "{writer:?} into a FIFO");
        }
        // ParaView recognises files by their extension.
        if is_device(full) && (is_made || writer.last() != Some(&"--vtk")) {
            let output = call(full);
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(
                output.status.code() == Some(1) && message.contains("No space left"),
                "{writer:?}: {message}"
            );
            assert!(is_device(full), "{writer:?} replaced a device");
        }
    }
    // JSON that can't be written to standard output is an error as well.
    if let Ok(out) = std::fs::File::options().write(true).open("/dev/full") {
        let call = Command::new(env!("CARGO_BIN_EXE_bulge"))
            .args(shape)
            .arg("--json")
            .stderr(std::process::Stdio::null())
            .stdout(out)
            .status();
        assert_eq!(call.unwrap().code(), Some(1));
    }
    // A report goes into a folder, also through a link, and into nothing else.
    std::fs::create_dir(folder.path("reports")).unwrap();
    symlink("reports", folder.path("behind")).unwrap();
    let compare = ["compare", &data, "--muscle", "dmsp-20-250", "--out"];
    stdout(&[&compare[..], &[&folder.path("behind")]].concat());
    assert!(Path::new(&folder.path("reports/report.html")).is_file());
    for below in ["", "/report", "/a/report"] {
        let says = format!("{data} is a file; give the name of a folder");
        refused(&[&compare[..], &[&format!("{data}{below}")]].concat(), 1, &[&says]);
    }
    assert!(!folder.names().iter().any(|name| name.starts_with(".unfinished")), "{:?}", folder.names());
}

/// A link stays a link, a FIFO is written into, and standard output holds only the file.
#[cfg(unix)]
#[test]
fn targets_that_are_no_regular_files_are_written_through() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let folder = Folder::new("targets");
    let call = |csv: &str| {
        let output = bulge(&["curve", "dmsp-20-250", "--pressure", "1 bar", "--points", "5", "--csv", csv]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let expected = call("-");
    assert!(expected.starts_with(b"pressure [Pa],"));
    assert_eq!(call("/dev/stdout"), expected);
    let link = folder.path("link.csv");
    symlink("real.csv", &link).unwrap();
    call(&link);
    assert!(Path::new(&link).is_symlink() && std::fs::read(folder.path("real.csv")).unwrap() == expected);
    let fifo = folder.path("fifo");
    if Command::new("mkfifo").arg(&fifo).status().is_ok_and(|status| status.success()) {
        let reader = std::thread::spawn({
            let fifo = fifo.clone();
            move || std::fs::read(fifo).unwrap()
        });
        call(&fifo);
        assert_eq!(reader.join().unwrap(), expected);
        assert!(std::fs::symlink_metadata(&fifo).unwrap().file_type().is_fifo());
    }
    let json = ["curve", "dmsp-20-250", "--pressure", "1 bar", "--points", "5", "--csv", "-", "--json"];
    refused(&json, 1, &["a file or JSON, not both"]);
    // A picture of one shape can be streamed too; a series is a folder.
    let shape =
        ["shape", "dmsp-20-250", "--pressure", "1 bar", "--contraction", "10 %", "--points", "5", "--vtk"];
    let file = folder.path("shape.vtp");
    stdout(&[&shape[..], &[&file]].concat());
    let drawn = std::fs::read(&file).unwrap();
    for name in ["-", "/dev/stdout"] {
        assert_eq!(bulge(&[&shape[..], &[name]].concat()).stdout, drawn);
    }
    refused(&[&shape[..], &["-", "--json"]].concat(), 1, &["a file or JSON, not both"]);
    refused(&["curve", "dmsp-20-250", "--pressure", "1 bar", "--vtk", "-"], 1, &["the name of a folder"]);
    // With a picture on standard output there is nothing else.
    let svg = bulge(&["curve", "dmsp-20-250", "--pressure", "1 bar", "--points", "5", "--plot", "-"]).stdout;
    assert!(svg.starts_with(b"<svg"), "{}", String::from_utf8_lossy(&svg[..60]));
}

/// What a shell and a manual know of every command; the examples of `keys` are files as commands read them.
#[test]
fn the_shell_is_served() {
    let folder = Folder::new("shell");
    for shell in ["bash", "zsh", "fish", "powershell"] {
        has_parts(&stdout(&["completions", shell]), &["bulge", "diagnose", "--tolerance"]);
    }
    let man = folder.path("man");
    stdout(&["man", &man]);
    let pages: Vec<String> = std::fs::read_dir(&man)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    for page in ["bulge.1", "bulge-compare.1", "bulge-air-fill.1"] {
        assert!(pages.iter().any(|name| name == page), "{page} of {pages:?}");
    }
    let text = std::fs::read_to_string(Path::new(&man).join("bulge-compare.1")).unwrap();
    has_parts(&text, &["bulge\\-compare", "rivals", "NAME"]);
    for kind in ["braided", "pleated"] {
        let muscle = folder.write(&format!("{kind}.toml"), &stdout(&["keys", kind]));
        let shape = json(&["shape", &muscle, "--pressure", "2 bar", "--contraction", "10 %", "--json"]);
        assert!(shape["force_n"].as_f64().unwrap() > 100.0);
    }
    let family = folder.write("sweep.toml", &stdout(&["keys", "sweep"]).replace("1e-6", "1e-2"));
    assert!(Path::new(&family).exists());
    refused(&["keys", "muscle"], 2, &["braided", "pleated", "joint"]);
}

#[test]
fn a_table_is_not_written_over_itself() {
    let folder = Folder::new("export");
    let table = folder.write("t.bulge", "what stood there");
    let parts = ["--out: ", "is the table, which is read; give the name of another file"];
    refused(&["table", "export", &table, "--to", "c", "--out", &table], 1, &parts);
    assert_eq!(std::fs::read_to_string(&table).unwrap(), "what stood there");
}
