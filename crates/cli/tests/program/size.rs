//! `bulge size` as seen by a user: the example of S4, and messages for wrong loads.

use crate::support::{Folder, bulge, failure, has_parts, json, line, refused, stdout};

const LIFT: [&str; 5] = ["size", "--force", "500 N", "--stroke", "50 mm"];

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    LIFT.iter().copied().chain(more.iter().copied()).collect()
}

/// S4: 500 N after 50 mm need 345 mm at 4.5 bar.
#[test]
fn the_example_of_s4_with_its_picture() {
    let folder = Folder::new("size-s4");
    let plot = folder.path("size.svg");
    let given = ["--muscle", "dmsp-20", "--pressure", "4.5 bar,4 bar", "--json", "--plot", &plot];
    let document = json(&with(&given));
    assert_eq!(document["schema"], "bulge.size/1");
    let choices = document["choices"].as_array().unwrap();
    let number = |i: usize, key: &str| choices[i][key].as_f64().unwrap();
    // The choice with the lower strain comes first.
    assert!((number(0, "pressure_pa") - 4e5).abs() < 1e-9 && (number(1, "pressure_pa") - 4.5e5).abs() < 1e-9);
    assert!((number(1, "length_m") - 0.345).abs() < 0.0015, "{}", number(1, "length_m"));
    assert!((choices[1]["contraction"][1].as_f64().unwrap() - 0.145).abs() < 0.001);
    let points = choices[1]["points"].as_array().unwrap();
    assert_eq!((points.len(), points[0]["holding_pressure_pa"].as_f64()), (2, Some(0.0)));
    assert!((points[1]["available_n"].as_f64().unwrap() / 500.0 - 1.0).abs() < 0.002);
    assert_eq!(folder.names(), ["size.svg"]);
    let svg = std::fs::read_to_string(plot).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("dmsp-20 of 409.0 mm at 4.00 bar"));
}

#[test]
fn all_muscles_are_looked_through() {
    let text = stdout(&with(&["--top", "3"]));
    for words in [
        "500.0 N after 50.00 mm",
        "the kindest: dmsp-40",
        "more: --top",
        "dmsp-10 at 1.00 bar: it may carry 375 N",
        "scaled from 20 mm",
    ] {
        has_parts(&text, &[words]);
    }
    let found = json(&with(&["--json"]));
    let choices = found["choices"].as_array().unwrap();
    let of = |name: &str| choices.iter().filter(|choice| choice["family"] == name).count();
    assert!(of("ppam-2-r16") > 2 && of("dmsp-20") > 3 && of("dmsp-40") > 5 && of("dmsp-10") == 0);
    // Lengths are limited to ten strokes by default.
    assert!(choices.iter().all(|choice| choice["length_m"].as_f64().unwrap() <= 0.5 + 1e-9));
    let kilograms =
        json(&line("size --force '50 kg' --stroke '50 mm' --length '400 mm' --muscle dmsp-20 --json"));
    assert!((kilograms["load"][1]["force_n"].as_f64().unwrap() - 490.3325).abs() < 1e-9);
    assert!((kilograms["choices"][0]["pressure_pa"].as_f64().unwrap() - 4e5).abs() < 2e3);
}

/// Fitted muscle files and force laws of the literature can be sized too.
#[test]
fn learnt_muscles_and_laws() {
    let folder = Folder::new("size-learnt");
    let plain = "name = \"mine\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10.725 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\nwall = \"2 mm\"\n";
    let rubber = format!("{plain}[effects.bladder-elasticity]\nc10 = \"0.2 MPa\"\n");
    let [plain, rubber] = [("plain.toml", plain), ("rubber.toml", rubber.as_str())]
        .map(|(name, text)| folder.write(name, text));
    let pressure = |muscle: &str| {
        let found = json(&line(&format!(
            "size --force '400 N' --stroke '30 mm' --length '250 mm' --muscle {muscle} --json"
        )));
        found["choices"][0]["pressure_pa"].as_f64().unwrap()
    };
    assert!(pressure(&rubber) > 1.05 * pressure(&plain), "rubber takes pressure");
    // Friction opposes a muscle that lifts: it must pull 60 N more than the load.
    let friction =
        std::fs::read_to_string(&plain).unwrap() + "[effects.coulomb-friction]\nforce = \"60 N\"\n";
    let friction = folder.write("friction.toml", &friction);
    let more = pressure(&friction) / pressure(&plain);
    assert!((more - 460.0 / 400.0).abs() < 0.01, "{more}");
    let both = format!("{plain},{friction}");
    let found = json(&line(&format!(
        "size --force '400 N' --stroke '30 mm' --length '250 mm' --muscle {both} --json"
    )));
    let names: Vec<&str> =
        found["choices"].as_array().unwrap().iter().map(|c| c["family"].as_str().unwrap()).collect();
    assert!(
        names[0] == "mine" && names[1].starts_with("mine (") && names[1].ends_with("friction.toml)"),
        "{names:?}"
    );
    let law =
        json(&with(&["--muscle", "dmsp-20-400", "--law", "sarosi-5-branch", "--length", "400 mm", "--json"]));
    assert!(law["choices"][0]["basis"].as_str().unwrap().starts_with("sarosi-5-branch"));
}

/// With JSON the answer is that there is nothing, and why; status and message are those of a failure.
#[test]
fn none_is_an_answer_as_well() {
    let none = with(&["--pressure", "1 bar", "--muscle", "dmsp-20", "--json"]);
    let output = bulge(&none);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(message.starts_with("error: none of these muscles carries 500.0 N over 50.00 mm"), "{message}");
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["schema"], "bulge.size/1");
    assert_eq!(document["choices"].as_array().unwrap().len(), 0);
    let why = document["infeasible"].as_array().unwrap();
    assert!(why.iter().all(|not| not["family"] == "dmsp-20"));
    // The reason is the same one.
    assert!(message.contains(why[0]["why"].as_str().unwrap()), "{message}");
    // Without JSON standard output stays empty.
    assert!(failure(&none[..none.len() - 1]).1 == message);
}

#[test]
fn mistakes_are_named() {
    let lift = |more: &str| format!("size --force '500 N' --stroke '50 mm' {more}");
    for (given, status, words) in [
        ("size --force 500 --stroke '50 mm'".to_owned(), 1, "--force: `500` has no unit"),
        ("size --force 'x kg' --stroke '50 mm'".to_owned(), 1, "`x kg` is no mass"),
        ("size --force '500 N' --stroke '0 mm'".to_owned(), 1, "the load has no stroke"),
        ("size --force '0 N' --stroke '5 mm'".to_owned(), 1, "0 N everywhere"),
        ("size --load '50 mm'".to_owned(), 1, "`50 mm` is no travel with its force"),
        (
            "size --load '50 mm: 5 N, 20 mm: 5 N'".to_owned(),
            1,
            "point 2 of the load lies at the travel 20 mm",
        ),
        (lift("--muscle nosuch"), 1, "no shipped muscle is called `nosuch`"),
        (lift("--law nosuch --muscle dmsp-20-400"), 1, "there is no force law `nosuch`"),
        (lift("--law sarosi-6"), 1, "dmsp-10 stands for the law of S4"),
        (lift("--law sarosi-6 --muscle ppam-2-r16"), 1, "sarosi-6 is not for ppam-2-r16"),
        (lift("--law sarosi-6 --table x --muscle dmsp-20-400"), 1, "has no numbers called `x`"),
        (lift("--pressure '-1 bar'"), 1, "the pressure is -1 bar: it must be"),
        (lift("--margin '-100 %'"), 1, "the margin is -100 %"),
        (lift("--max-contraction '120 %'"), 1, "the largest contraction is 120 %"),
        (lift("--max-length '-1 m'"), 1, "the longest length is -1000 mm"),
        (lift("--pressure '1 bar' --muscle dmsp-20"), 3, "none of these muscles carries 500.0 N"),
    ] {
        refused(&line(&given), status, &[words]);
    }
}
