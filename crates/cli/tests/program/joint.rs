//! `bulge joint` as seen by a user: equilibrium, external torque, pressures, shut valves, and mistakes.

use crate::support::{Folder, has_parts, json, line, refused, stdout};
use serde_json::Value;

const KNEE: &str = "name = \"knee\"\nmuscle = \"ppam-2-r16\"\nkind = \"pulley\"\nradius = \"40 mm\"\ncontraction = \"20 %\"\n\
    angle = \"-25 deg..25 deg\"\npressure = \"0.5 bar..3 bar\"\n";

fn number(document: &Value, keys: &[&str]) -> f64 {
    keys.iter().fold(document, |value, key| &value[*key]).as_f64().unwrap()
}

/// The answers are consistent: 4.569 deg under 3 N m; the same external torque holds it there; its stiffness
/// gives back its pressures.
#[test]
fn the_questions_answer_each_other() {
    let folder = Folder::new("joint-questions");
    let knee = folder.write("knee.toml", KNEE);
    let rest = json(&["joint", &knee, "--pressure", "2 bar,1.5 bar", "--torque", "3 N m", "--json"]);
    assert_eq!((rest["schema"].as_str(), rest["name"].as_str()), (Some("bulge.joint/1"), Some("knee")));
    let [angle, stiffness] = ["angle_rad", "stiffness_nm_per_rad"].map(|key| number(&rest, &["stand", key]));
    let degrees = format!("{} deg", angle.to_degrees());
    let held = json(&line(&format!(
        "joint {knee} --pressure '2 bar,1.5 bar' --angle '{degrees}' --pressure-sd '500 Pa' --force-sd '10 N' --json"
    )));
    assert!((number(&held, &["outside", "torque_nm"]) - 3.0).abs() < 1e-6);
    // Two muscles of 10 N each on 40 mm, and the contribution of the pressures.
    let [pressures, angles, forces] =
        [0, 1, 2].map(|i: usize| held["outside"]["from_nm"][i].as_f64().unwrap());
    assert!((forces - 0.4 * 2_f64.sqrt()).abs() < 1e-9 && angles.abs() < 1e-12 && pressures > 0.1);
    let stiffness = format!("{stiffness} N m/rad");
    let found = json(&line(&format!(
        "joint {knee} --angle '{degrees}' --stiffness '{stiffness}' --torque '3 N m' --json"
    )));
    for (side, pressure) in found["stand"]["sides"].as_array().unwrap().iter().zip([2e5, 1.5e5]) {
        assert!((number(side, &["pressure_pa"]) / pressure - 1.0).abs() < 1e-6);
    }
    let shut = ["joint", &knee, "--pressure", "2 bar,1.5 bar", "--torque", "3 N m", "--closed", "adiabatic"];
    let document = json(&[&shut[..], &["--dead-volume", "30 ml", "--json"]].concat());
    let turned = number(&document, &["stand", "angle_rad"]) - number(&document, &["before", "angle_rad"]);
    assert!(turned > 0.0 && turned < angle - number(&document, &["before", "angle_rad"]));
    let text = stdout(&shut);
    assert!(text.contains("with shut valves") && text.contains("antagonist"), "{text}");
}

#[test]
fn its_range_and_a_picture() {
    let folder = Folder::new("joint-range");
    let (knee, plot) = (folder.write("knee.toml", KNEE), folder.path("knee.svg"));
    let text = stdout(&["joint", &knee, "--plot", &plot]);
    has_parts(&text, &["from -25", "0, ", "antagonist 3.000 bar"]);
    let svg = std::fs::read_to_string(plot).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("torque [N m]") && svg.contains("3.000 | 0.5000 bar"));
    let map = json(&["joint", &knee, "--json"]);
    let map = map["map"].as_array().unwrap();
    assert_eq!((map.len(), folder.names().len()), (25, 2));
    // With equal pressures it rests in the middle, and its stiffness increases with them.
    let even: Vec<f64> = [0, 6, 12, 18, 24]
        .map(|i: usize| {
            assert!(number(&map[i], &["angle_rad"]).abs() < 1e-9);
            number(&map[i], &["stiffness_nm_per_rad"])
        })
        .to_vec();
    assert!(even.windows(2).all(|pair| pair[1] > pair[0]));
}

#[test]
fn mistakes_are_named() {
    let folder = Folder::new("joint-mistakes");
    let knee = folder.write("knee.toml", KNEE);
    for (given, status, words) in [
        ("--pressure '2 bar'", 1, "1 pressures: write that of the agonist"),
        ("--pressure '2 bar,-1 bar'", 1, "a gauge pressure above 0"),
        ("--pressure '2 bar,1 bar' --torque 3", 1, "`3` can't be read"),
        ("--pressure '2 bar,1 bar' --torque 'x N m'", 1, "can't be read"),
        ("--angle '5 deg'", 1, "an angle alone is no question"),
        ("--pressure '2 bar,1 bar' --angle '5 deg' --torque '1 N m'", 1, "leave one of the three out"),
        (
            "--pressure '2 bar,1 bar' --angle '5 deg' --force-sd '-1 N'",
            1,
            "a standard deviation is 0 or more",
        ),
        ("--angle '5 deg' --stiffness '2300 N m/rad'", 3, "there it is 61.8883 to 248.1855 N m/rad"),
        ("--angle '40 deg' --stiffness '100 N m/rad'", 3, "outside the range of the joint"),
        ("--angle '0 deg' --stiffness '100 N m/rad' --torque '9 kN m'", 1, "can't be read"),
        ("--angle '0 deg' --stiffness '100 N m/rad' --torque '900 N m'", 3, "they can hold"),
        ("--pressure '3 bar,0.5 bar' --torque '900 N m'", 3, "no rest at 3 bar and 0.5 bar"),
        (
            "--pressure '0.1 bar,0.1 bar' --torque '1 N m' --closed isothermal --dead-volume '-1 ml'",
            1,
            "a volume is 0 or more",
        ),
    ] {
        refused(&line(&format!("joint {knee} {given}")), status, &[words]);
    }
    refused(&["joint", &folder.path("none.toml")], 1, &["none.toml"]);
}
