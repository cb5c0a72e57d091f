//! Joints: torques against independent computations, and files with mistakes.

use super::*;
use bulge_fibre::Problem;
use bulge_muscles::{FileError, preset};
use std::path::Path;

pub(super) const PULLEY: &str = "muscle = \"ppam-2-r16\"\nkind = \"pulley\"\nradius = \"40 mm\"\ncontraction = \"20 %\"\nangle = \"-25 deg..25 deg\"\npressure = \"0.5 bar..3 bar\"\n";
pub(super) const LEVER: &str = "muscle = \"ppam-2-r16\"\nkind = \"lever\"\narm = \"40 mm\"\nbase = \"150 mm\"\nlever_angle = \"80 deg\"\ncontraction = \"20 %\"\nangle = \"-25..20 deg\"\npressure = \"0.5..3 bar\"\n";

fn from(text: &str) -> Result<Joint, FileError> {
    Joint::from_toml(text, "j.toml", None, Checks::Everywhere, |_| Ok(())).map(|(joint, ())| joint)
}

#[track_caller]
pub(super) fn read(text: &str) -> Joint {
    from(text).unwrap_or_else(|error| panic!("{error}"))
}

fn rest(joint: &Joint, pressures: [f64; 2]) -> f64 {
    joint.rest(pressures, 0.0).unwrap().angle_rad
}

fn unchecked(text: &str, folder: Option<&Path>) -> Joint {
    Joint::from_toml(text, "j.toml", folder, Checks::Linkage, |_| Ok(())).unwrap().0
}

/// Checks the error for a joint whose text has `old` replaced.
#[track_caller]
fn refused(text: &str, old: &str, new: &str, parts: &[&str]) {
    assert!(text.contains(old), "{old}");
    let message = from(&text.replace(old, new)).map(|joint| joint.name).unwrap_err().to_string();
    for part in parts {
        assert!(message.contains(part), "{message:?} does not say {part:?}");
    }
}

#[test]
fn every_key_is_read() {
    let joint = read(JOINT_EXAMPLE);
    assert_eq!((joint.name.as_str(), joint.linkage()), ("knee", &Linkage::Pulley { radius: 0.04 }));
    assert_eq!((joint.pressure, joint.muscles()[1].side()), ([5e4, 3e5], Side::Antagonist));
    assert!((joint.angle[0] + 25_f64.to_radians()).abs() < 1e-15);
    // The lines in comments are valid as well.
    let each =
        JOINT_EXAMPLE.replace("muscle = ", "# muscle = ").replace("contraction = \"20 %\"            #", "#");
    let each = each
        .replace("# agonist", "agonist")
        .replace("# antagonist", "antagonist")
        .replace("ppam-2-r11", "dmsp-20-250");
    let each = each.replace("\"18 %\"", "\"10 %\"");
    let joint = read(&each.replace("-25 deg..25 deg", "-20 deg..5 deg"));
    assert_eq!(joint.muscles().each_ref().map(|m| m.muscle().name()), ["ppam-2-r16", "dmsp-20-250"]);
    let lever = JOINT_EXAMPLE.replace("\"pulley\"", "\"lever\"").replace("radius", "# radius");
    let lever = lever.replace("# arm", "arm").replace("# base", "base").replace("# lever", "lever");
    assert!(matches!(read(&lever).linkage(), Linkage::Lever { arm: 0.04, base: 0.15, .. }));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("joint.toml");
    std::fs::write(&path, JOINT_EXAMPLE).unwrap();
    let from = |path| Joint::read(path, Checks::Linkage, |_| Ok(()));
    assert_eq!(from(&path).unwrap().0.name, "knee");
    assert!(from(folder.path()).unwrap_err().to_string().contains("a directory, not a joint file"));
}

#[test]
fn mistakes_have_a_place_and_a_cure() {
    refused(PULLEY, "kind", "knd", &["j.toml:2:1", "unknown key `knd`", "did you mean `kind`?"]);
    refused(PULLEY, "\"pulley\"", "\"puley\"", &["j.toml:2:8", "write `kind = \"pulley\"`"]);
    refused(PULLEY, "kind = \"pulley\"", "", &["needs `kind`", "add such as `kind = \"pulley\"`"]);
    refused(PULLEY, "radius = \"40 mm\"", "", &["needs `radius`", "radius = \"40 mm\""]);
    refused(PULLEY, "40 mm", "-40 mm", &["j.toml:3:10", "must be > 0"]);
    refused(PULLEY, "radius", "arm = \"1 mm\"\nradius", &["a pulley has no `arm`", "kind = \"lever\""]);
    refused(LEVER, "arm", "radius = \"1 mm\"\narm", &["a lever has no `radius`", "kind = \"pulley\""]);
    refused(LEVER, "80 deg", "80 %", &["j.toml:5:15", "deg"]);
    refused(PULLEY, "kind", "agonist = \"x\"\nkind", &["j.toml:2:1", "`agonist` to one", "delete `agonist`"]);
    refused(PULLEY, "muscle", "agonist", &["needs `antagonist`"]);
    refused(PULLEY, "muscle = \"ppam-2-r16\"", "", &["needs `muscle`"]);
    refused(PULLEY, "ppam-2-r16", "ppam-2-r61", &["j.toml:1:10", "did you mean"]);
    refused(PULLEY, "\"20 %\"", "20", &["j.toml:4:15", "between -1 and 1", "contraction = \"15 %\""]);
    refused(
        PULLEY,
        "-25 deg..25 deg",
        "25 deg..-25 deg",
        &["j.toml:5:9", "must rise", "angle = \"-25 deg..25 deg\""],
    );
    refused(PULLEY, "-25 deg..25 deg", "-25..25", &["`-25` has no unit", "an angle"]);
    refused(PULLEY, "0.5 bar..3 bar", "0..3 bar", &["j.toml:6:12", "must be > 0"]);
    refused(PULLEY, "0.5 bar..3 bar", "1 bar..limit", &["j.toml:6:12", "`limit`"]);
}

#[test]
fn angles_leave_no_domain() {
    // 20 % of 110 mm correspond to 31.513 degrees of the pulley.
    let straight =
        ["j.toml:5:9", "the agonist is straight at the angle -31.5127 deg", "`angle` above -31.5127 deg"];
    refused(PULLEY, "-25 deg", "-40 deg", &straight);
    let other = ["the antagonist is straight at the angle 31.5127 deg", "`angle` below 31.5127 deg"];
    refused(PULLEY, "..25 deg", "..32 deg", &other);
    // The limit of 41.85 % lies 21.85 % above.
    let limit = ["the agonist reaches its contraction limit", "41.8497 %, at the angle 34.4", "below 34.4"];
    let far = PULLEY.replace("-25 deg", "0 deg").replace("muscle", "antagonist = \"dmsp-20-250\"\nagonist");
    let far = far.replace(
        "contraction = \"20 %\"",
        "agonist_contraction = \"20 %\"\nantagonist_contraction = \"20 %\"",
    );
    refused(&far, "25 deg", "40 deg", &limit);
    let far = PULLEY.replace("muscle", "agonist = \"dmsp-20-250\"\nantagonist");
    let far = far.replace(
        "contraction = \"20 %\"",
        "agonist_contraction = \"5 %\"\nantagonist_contraction = \"20 %\"",
    );
    refused(
        &far,
        "-25 deg..25 deg",
        "-40 deg..0 deg",
        &["the antagonist reaches", "at the angle -34.4", "above -34.4"],
    );
    refused(
        LEVER,
        "\"80 deg\"",
        "\"15 deg\"",
        &["dead centre at the angle -15.0000 deg", "between -15.0000 deg and 15.0000 deg"],
    );
    refused(LEVER, "\"80 deg\"", "\"190 deg\"", &["must be less than 180 deg"]);
    refused(LEVER, "150 mm", "60 mm", &["88.0000 mm long at the angle 0", "66.0794", "a longer `base`"]);
}

#[test]
fn equal_pressures_balance() {
    for text in [PULLEY, LEVER] {
        let joint = read(text);
        for pressure in [5e4, 1e5, 3e5] {
            assert!(joint.torque(0.0, pressure, pressure).unwrap().abs() < 1e-12);
            assert!(rest(&joint, [pressure; 2]).abs() < 1e-12);
        }
        // If fibres don't stretch, torque and stiffness are proportional to the pressure, and the angle
        // depends on the ratio of the pressures.
        for angle in [-0.3, 0.1, 0.3] {
            let one = joint.torque(angle, 1e5, 0.6e5).unwrap();
            let three = joint.torque(angle, 3e5, 1.8e5).unwrap();
            assert!((three / one - 3.0).abs() < 1e-12);
            // The mirror image.
            assert!((joint.torque(-angle, 0.6e5, 1e5).unwrap() + one).abs() < 1e-11 * one.abs());
        }
        let angle = rest(&joint, [1.5e5, 1e5]);
        assert!(angle > 0.02 && (rest(&joint, [3e5, 2e5]) - angle).abs() < 1e-12, "{angle}");
        assert!(joint.torque(angle, 1.5e5, 1e5).unwrap().abs() < 1e-10);
        // The sum of the pressures sets the stiffness.
        let stiffness = |p: f64| joint.stiffness(angle, 1.5 * p, p).unwrap();
        assert!((stiffness(2e5) / stiffness(1e5) - 2.0).abs() < 1e-12 && stiffness(1e5) > 0.0);
    }
}

#[test]
fn stiffness_is_the_slope_of_the_torque() {
    for text in [PULLEY, LEVER] {
        let joint = read(text);
        for angle in [-0.25, 0.0, 0.2] {
            let h = 1e-4;
            let at = |times: f64| joint.torque(angle + times * h, 1.3e5, 0.9e5).unwrap();
            let slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
            let stiffness = joint.stiffness(angle, 1.3e5, 0.9e5).unwrap();
            assert!((stiffness + slope).abs() < 1e-8 * stiffness.abs().max(1.0), "{stiffness} {slope}");
        }
    }
}

/// Virtual work: M_1 = p dV/dtheta with the volume whose section carries the pressure.
#[test]
fn torque_is_the_work_of_the_gas() {
    for text in [PULLEY, LEVER] {
        let joint = read(text);
        let muscle = &joint.muscles[0];
        let problem = Problem::new(&preset("ppam-2-r16").unwrap(), Pressure::pa(1e5)).unwrap();
        let volume = |angle: f64| {
            let contraction = muscle.contraction(angle);
            problem.follow(contraction, Approach::Auto).unwrap().volume_polygon_m3
        };
        for angle in [-0.25, 0.0, 0.2] {
            let h = 1e-3;
            let slope = (8.0 * (volume(angle + h) - volume(angle - h))
                - (volume(angle + 2.0 * h) - volume(angle - 2.0 * h)))
                / (12.0 * h);
            let torque = muscle.pull(angle, 1e5).unwrap().torque;
            assert!((1e5 * slope / torque - 1.0).abs() < 1e-6, "{} {torque}", 1e5 * slope);
        }
    }
}

#[test]
fn what_has_no_answer() {
    let joint = read(PULLEY);
    assert!(
        joint.torque(0.5, 1e5, 1e5).unwrap_err().to_string().contains("28.6479 deg is outside the range")
    );
    assert!(joint.stiffness(f64::NAN, 1e5, 1e5).is_err());
    let error = joint.torque(0.1, -1.0, 1e5).unwrap_err().to_string();
    assert!(
        error.contains("the agonist at the angle 5.7296 deg") && error.contains("greater than 0"),
        "{error}"
    );
    let error = joint.rest([3e5, 5e4], 900.0).unwrap_err().to_string();
    assert!(error.contains("no rest at") && error.contains("at 25.0000 deg"), "{error}");
}

const FOUR_BAR: &str = "muscle = \"ppam-2-r16\"\nkind = \"four-bar\"\nradius = \"40 mm\"\nground = \"100 mm\"\ncrank = \"40 mm\"\ncoupler = \"100 mm\"\nrocker = \"40 mm\"\nrocker_angle = \"86 deg\"\ncontraction = \"20 %\"\nangle = \"-25 deg..25 deg\"\npressure = \"0.5 bar..3 bar\"\n";

/// A parallelogram acts as the pulley itself, and other links act as a gear: the work put in equals the work
/// obtained.
#[test]
fn a_four_bar_linkage_loses_no_work() {
    let (plain, same) = (read(PULLEY), read(FOUR_BAR));
    for angle in [-0.4, 0.0, 0.3] {
        let [a, b] = [&plain, &same].map(|joint| joint.torque(angle, 2e5, 1.4e5).unwrap());
        assert!((a - b).abs() < 1e-9 * a.abs().max(1.0), "{a} {b}");
        let [a, b] = [&plain, &same].map(|joint| joint.stiffness(angle, 2e5, 1.4e5).unwrap());
        assert!((a / b - 1.0).abs() < 1e-9);
    }
    let geared = FOUR_BAR.replace("rocker = \"40 mm\"", "rocker = \"60 mm\"").replace("86 deg", "100 deg");
    let geared = geared
        .replace("\"100 mm\"\nrocker", "\"95 mm\"\nrocker")
        .replace("-25 deg..25 deg", "-15 deg..15 deg");
    let joint = read(&geared);
    // The torque of the agonist, integrated over the angle, against force times shortening.
    let steps = 200;
    let (low, high) = (-0.25, 0.25);
    let at = |k: u32| low + (high - low) * f64::from(k) / f64::from(steps);
    let pull = |angle: f64| joint.muscles()[0].pull(angle, 2e5).unwrap();
    let work: f64 = (0..steps)
        .map(|k| {
            (pull(at(k)).torque + 4.0 * pull(f64::midpoint(at(k), at(k + 1))).torque + pull(at(k + 1)).torque)
                / 6.0
        })
        .sum::<f64>()
        * (high - low)
        / f64::from(steps);
    let muscle = preset("ppam-2-r16").unwrap();
    let problem = Problem::new(&muscle, Pressure::pa(2e5)).unwrap();
    let [from, to] = [low, high].map(|angle| pull(angle).contraction);
    let force = |k: u32| {
        let contraction = from + (to - from) * f64::from(k) / f64::from(2 * steps);
        let given = bulge_fibre::Given::Contraction(contraction);
        problem.solve(given, bulge_fibre::Approach::Auto).unwrap().force_n
    };
    let done: f64 =
        (0..steps).map(|k| (force(2 * k) + 4.0 * force(2 * k + 1) + force(2 * k + 2)) / 6.0).sum::<f64>()
            * (to - from)
            * 0.11
            / f64::from(steps);
    assert!((work / done - 1.0).abs() < 1e-7, "{work} {done}");
    assert!(pull(0.1).torque > 1.1 * plain.muscles()[0].pull(0.1, 2e5).unwrap().torque);
    refused(
        FOUR_BAR,
        "-25 deg..25 deg",
        "-120 deg..120 deg",
        &["four-bar linkage", "at the angle", "narrower range"],
    );
    refused(FOUR_BAR, "coupler = \"100 mm\"", "coupler = \"1 mm\"", &["doesn't close", "at the angle 0"]);
    refused(FOUR_BAR, "radius = ", "arm = \"9 mm\"\nradius = ", &["a pulley (`radius`) and a lever (`arm`)"]);
    refused(FOUR_BAR, "crank = \"40 mm\"\n", "", &["crank"]);
    refused(PULLEY, "kind", "crank = \"4 mm\"\nkind", &["a pulley has no `crank`", "four-bar"]);
}

/// A result at one angle or one pair of pressures doesn't fail because of the rest of the range, and it is
/// the same as in a narrow range.
#[test]
fn only_what_is_asked_is_checked() {
    for (text, angles, most) in
        [(PULLEY, "-25 deg..25 deg", "-80 deg..80 deg"), (LEVER, "-25..20 deg", "-70..70 deg")]
    {
        let (narrow, wide) = (read(text), text.replace(angles, most));
        assert!(from(&wide).is_err(), "{wide}");
        let wide = unchecked(&wide, None);
        for pressures in [[2e5, 1.5e5], [1e5, 1e5]] {
            let [one, other] = [&narrow, &wide]
                .map(|joint| joint.rest(pressures, 0.0).unwrap_or_else(|error| panic!("{error}")));
            assert!(
                (one.angle_rad - other.angle_rad).abs() < 1e-9 && one.sides[0].side == other.sides[0].side
            );
        }
        let beyond = wide.torque(1.2, 2e5, 2e5).unwrap_err().to_string();
        assert!(beyond.contains("agonist") || beyond.contains("antagonist"), "{beyond}");
    }
    // At the lowest pressure the rubber of a braid pushes at this angle; at most pressures it doesn't.
    let folder = tempfile::tempdir().unwrap();
    let braid = "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nwall = \"1 mm\"\n[effects.bladder-elasticity]\nc10 = \"0.1 MPa\"\n";
    std::fs::write(folder.path().join("braid.toml"), braid).unwrap();
    let text = "muscle = \"braid.toml\"\nkind = \"pulley\"\nradius = \"30 mm\"\ncontraction = \"12 %\"\nangle = \"-20 deg..20 deg\"\npressure = \"0.1 bar..6 bar\"\n";
    let all = Joint::from_toml(text, "j.toml", Some(folder.path()), Checks::Everywhere, |_| Ok(()));
    assert!(all.is_err());
    let joint = unchecked(text, Some(folder.path()));
    let stand = joint.stand(0.1, [4e5, 3e5]).unwrap();
    let found = joint.pressures_for(0.1, stand.stiffness_nm_per_rad, -stand.torque_nm).unwrap();
    assert!((found.sides[0].pressure_pa / 4e5 - 1.0).abs() < 1e-6, "{found:?}");
}
