//! `bulge air`, `bulge sense` and `bulge heat` as seen by a user.

use crate::support::{Folder, has_parts, json, line, refused, stdout};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The resistance rises as the muscle bulges; the table, the CSV and the JSON contain the same curve.
#[test]
fn a_channel_tells_the_contraction() {
    let folder = Folder::new("sense");
    let (plot, csv) = (folder.path("sense.svg"), folder.path("sense.csv"));
    let document = json(&["sense", "ppam-2-r16", "--json", "--plot", &plot, "--csv", &csv]);
    assert_eq!(document["schema"], "bulge.sensing/1");
    let readings = document["curve"]["readings"].as_array().unwrap();
    let resistances: Vec<f64> = readings.iter().map(|at| number(&at["resistance_ohm"])).collect();
    assert_eq!(resistances.len(), 101);
    assert!(resistances.windows(2).all(|pair| pair[1] > pair[0]));
    // rho L/A of 20 turns at rest: a helix of 16.5 mm on 44 mm.
    let length = ((20.0 * std::f64::consts::TAU * 0.0165).powi(2) + 0.044_f64.powi(2)).sqrt();
    let rest = 29.4e-8 * length / (0.25 * std::f64::consts::PI * 0.25e-3 * 0.25e-3);
    assert!((number(&document["curve"]["reference_resistance_ohm"]) / rest - 1.0).abs() < 1e-9);
    // 1 mohm divided by the slope of the last two points.
    let slope = (resistances[100] - resistances[99]) / 0.0025;
    assert!((number(&document["resolution"]["worst"]) * slope / 1e-3 - 1.0).abs() < 0.01);
    let written = std::fs::read_to_string(csv).unwrap();
    assert_eq!(written.lines().count(), 102);
    assert!(written.lines().last().unwrap().starts_with("0.3,"));
    assert!(std::fs::read_to_string(plot).unwrap().contains("resistance [ohm]"));
    assert_eq!(folder.names().len(), 2);
    let text =
        stdout(&line("sense dmsp-20-250 --contraction '2 %..25 %' --best '20 %' --least-gauge-factor 2"));
    has_parts(&text, &["the best of 81 places: the middle of the zone at 10", "gauge factor"]);
}

/// The trends of S3: the end without a pipe is hottest; a longer pipe cools the end and warms the inlet, a
/// wider one does the opposite.
#[test]
fn pipes_cool_the_closed_end() {
    let folder = Folder::new("heat");
    let plot = folder.path("heat.svg");
    let document = json(&["heat", "--cells", "20", "--json", "--plot", &plot]);
    assert_eq!(document["schema"], "bulge.heat/1");
    let cases = document["cases"].as_array().unwrap();
    let of = |key: &str| -> Vec<f64> { cases.iter().map(|case| number(&case["solution"][key])).collect() };
    let (end, inlet, hottest) = (of("end_rise_k"), of("inlet_rise_k"), of("hottest_rise_k"));
    assert!(end[0] > end[1] && end[1] > end[3] && end[3] > end[2], "{end:?}");
    assert!(inlet[2] > inlet[1] && inlet[2] > inlet[3] && inlet[1] > inlet[0], "{inlet:?}");
    assert!(hottest[1..].iter().all(|rise| *rise < hottest[0]));
    for case in cases {
        let solution = &case["solution"];
        assert!((number(&solution["heat_out_j"]) / number(&solution["enthalpy_in_j"]) - 1.0).abs() < 1e-4);
    }
    assert!(std::fs::read_to_string(plot).unwrap().contains("100 x 4.0 mm"));
    let text = stdout(&["heat", "--cells", "10", "--pipe", "none,150 mm x 4 mm"]);
    has_parts(&text, &["closed end", "150 x 4.0 mm", "no life"]);
}

/// Shut, filled and used: the amounts of air agree.
#[test]
fn air_is_kept_counted_and_spent() {
    let folder = Folder::new("air");
    let (plot, csv) = (folder.path("fill.svg"), folder.path("fill.csv"));
    let held = "--pressure '2 bar' --contraction '15 %' --dead-volume '30 ml' --force '500 N'";
    let shut = folder.path("shut.svg");
    let shut = json(&line(&format!("air shut ppam-2-r16 {held} --json --plot {shut}")));
    assert_eq!(shut["schema"], "bulge.air/1");
    let mass = number(&shut["mass_kg"]);
    for at in shut["states"].as_array().unwrap() {
        let state = &at["state"];
        let volume = number(&state["response"]["volume_m3"]) + 30e-6;
        let gas = (number(&state["pressure_pa"]) + 101_325.0) * volume / (287.05 * 293.15);
        assert!((gas / mass - 1.0).abs() < 1e-9);
        let stiffness = &at["stiffness"];
        let sum = number(&stiffness["geometry_n_per_m"]) + number(&stiffness["gas_n_per_m"]);
        assert!((number(&stiffness["total_n_per_m"]) / sum - 1.0).abs() < 1e-12);
    }
    assert!((number(&shut["under_force"]["force_n"]) - 500.0).abs() < 1e-5);
    // Held at the same contraction: the same amount of air, less the initial one.
    let fill = "air fill ppam-2-r16 --supply '2 bar' --conductance '0.5 l/(s bar)' --held '15 %' --dead-volume '30 ml'";
    let fill = line(fill);
    let filling = json(&[&fill[..], &["--json", "--plot", &plot, "--csv", &csv]].concat());
    let filling = &filling["filling"];
    assert!(filling["settled"].as_bool().unwrap());
    let before = mass * 101_325.0 / 301_325.0;
    assert!((number(&filling["air_kg"]) / (mass - before) - 1.0).abs() < 1e-9);
    // ISO 6358, just below choking at the start.
    let over = (101_325.0 / 301_325.0 - 0.3) / 0.7;
    let flow = 0.5e-8 * 301_325.0 * 1.185 * (1.0_f64 - over * over).sqrt();
    assert!((number(&filling["samples"][0]["flow_kg_per_s"]) / flow - 1.0).abs() < 1e-9);
    assert!(std::fs::read_to_string(csv).unwrap().lines().count() > 100);
    assert!(std::fs::read_to_string(plot).unwrap().contains("pressure [bar]"));
    let text = stdout(&fill);
    assert!(text.contains("99 % after") && text.contains("litres (ANR)"), "{text}");
    let stroke = "air stroke ppam-2-r16 --load '500 N' --stroke '10 %..25 %' --supply '6 bar'";
    let stroke = json(&line(&format!("{stroke} --json --plot {}", folder.path("stroke.svg"))));
    for (name, words) in [("shut.svg", "valve shut"), ("stroke.svg", "with the load")] {
        assert!(std::fs::read_to_string(folder.path(name)).unwrap().contains(words), "{name}");
    }
    let cycle = |key: &str| number(&stroke["cycle"][key]);
    assert!((cycle("work_j") - 500.0 * 0.15 * 0.11).abs() < 1e-9);
    let spent = cycle("work_j") + cycle("not_passed_on_j") + cycle("throttled_j") + cycle("vented_j");
    assert!((spent / cycle("exergy_j") - 1.0).abs() < 1e-9 && cycle("efficiency") < 0.2);
}

/// A muscle with fibres of 5 N balloons: there is no equilibrium, and the answer says how far the muscle is
/// from one.
#[test]
fn fibres_that_are_too_soft_are_named() {
    let folder = Folder::new("design-soft");
    let soft = "name = \"soft\"\nkind = \"braided\"\nlength = \"60 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\nfibres = 60\nfibre = { stiffness = \"5 N\" }\n";
    let soft = folder.write("soft.toml", soft);
    let shut = ["air", "shut", &soft, "--pressure", "5 bar", "--contraction", "1 %"];
    refused(&shut, 3, &["the fibres are too soft and the muscle balloons"]);
}

#[test]
fn mistakes_are_named() {
    let folder = Folder::new("design-mistakes");
    // Along rigid fibres the channel doesn't change.
    let rigid =
        "name = \"rigid\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n";
    let rigid = folder.write("rigid.toml", rigid);
    for (given, status, words) in [
        ("sense ppam-2-r16 --turns 5000", 1, "take fewer turns"),
        ("sense ppam-2-r16 --zone '70 %..30 %'", 1, "from 70 % to 30 %"),
        ("sense ppam-2-r16 --channel '-1 mm'", 1, "diameter of the channel is -1 mm"),
        ("sense ppam-2-r16 --points 3", 1, "11 to 10001"),
        ("sense ppam-2-r16 --noise 1", 1, "--noise: `1` can't be read"),
        ("sense ppam-2-r16 --contraction '5 %..60 %'", 3, "the limit of this muscle is 41.8497 %"),
        (&format!("sense {rigid} --turns 0 --offset '0 mm'"), 3, "this winding feels nothing"),
        ("sense ppam-2-r16 --best '20 %' --least-gauge-factor 99", 3, "none of the 81 zones"),
        ("air fill ppam-2-r16 --supply '3 bar' --held '10 %'", 2, "--conductance"),
        ("air fill ppam-2-r16 --supply '3 bar' --hole '-2 mm' --held '10 %'", 1, "diameter of the hole"),
        ("air fill ppam-2-r16 --supply '3 bar' --conductance 2 --held '10 %'", 1, "`2` can't be read"),
        ("air shut ppam-2-r16 --pressure '2 bar' --contraction '15 %' --exponent 2", 1, "exponent is 2"),
        ("air shut ppam-2-r16 --pressure '1 bar' --contraction '42 %'", 3, "the limit of this muscle"),
        (
            "air stroke ppam-2-r16 --load '5000 N' --stroke '10 %..25 %' --supply '1 bar'",
            1,
            "higher supply pressure",
        ),
        ("heat --pipe 4", 1, "`4` is no pipe"),
        ("heat --pipe '300 mm x 4 mm'", 1, "length of the pipe"),
        ("heat --length '0.5 mm'", 1, "the length of the muscle is 0.5 mm; it must be 1 mm to 100 m"),
        ("heat --period 1", 1, "--period: `1` can't be read"),
        ("heat --pressure '5 bar..1 bar'", 1, "high gauge pressure"),
        ("heat --port '0.2 mm' --pipe none", 3, "Mach"),
    ] {
        refused(&line(given), status, &[words]);
    }
}
