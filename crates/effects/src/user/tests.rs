//! Files of effects: valid files, and the message for every kind of slip.

use super::*;

#[track_caller]
fn refused(text: &str, place: (usize, usize), parts: &[&str]) {
    let error = from_toml(text, "e.toml").map(|effects| effects.len()).unwrap_err();
    let message = error.to_string();
    assert_eq!((error.line(), error.column()), (Some(place.0), Some(place.1)), "{message}");
    for part in parts {
        assert!(message.contains(part), "{message}\ndoes not say {part:?}");
    }
}

/// The example with one replacement, which must occur.
#[track_caller]
fn with(from: &str, to: &str) -> String {
    assert!(EXAMPLE.contains(from), "{from}");
    EXAMPLE.replacen(from, to, 1)
}

#[test]
fn the_example() {
    let effects = from_toml(EXAMPLE, "e.toml").unwrap();
    assert_eq!(effects.len(), 1);
    let effect = &effects[0];
    assert_eq!((effect.name.as_str(), effect.title.as_str()), ("hose-stiffness", "Hose pulls on the muscle"));
    assert_eq!((&effect.about, &effect.source, &effect.family, effect.twins.len()), (&None, &None, &None, 0));
    assert_eq!((effect.mechanism, effect.form), (Mechanism::User, Form::Loose));
    assert_eq!(effect.formula.expression().text(), "-k * (eps - eps_free)");
    assert_eq!(effect.formula.expression().parameters(), ["k", "eps_free"]);
    let expected =
        [("k", "N", 1.0, 50.0, 0.0, 500.0, Some((50.0, 30.0))), ("eps_free", "1", 1.0, 0.1, -0.1, 0.4, None)];
    for (found, (name, unit, factor, typical, low, high, prior)) in effect.parameters.iter().zip(expected) {
        assert_eq!((found.name.as_str(), found.unit.as_str(), found.factor), (name, unit, factor));
        assert_eq!((found.typical, found.low, found.high, found.prior), (typical, low, high, prior));
    }
    let mut state = [0.0; crate::expression::VARIABLES.len()];
    state[1] = 0.3;
    assert!((effect.formula.expression().evaluate(&state, &[50.0, 0.1]) + 10.0).abs() < 1e-12);
}

#[test]
fn all_keys_and_units() {
    let text = r#"
[effects.second]
title = "Two"
about = "Rubber \"creeps\"."
source = "A. Author, 1999, eq. 3"
family = "material"
twins = ["force-offset", "hose-stiffness"]
force = """
    -drag * p * rate
    - k*angle*step(time - 1 [min])"""
[effects.second.parameters.k]
unit = "kN"
typical = "1 kN"
low = "0 N"
high = "2000 N"
about = "stiffness"
[effects.second.parameters]
drag = { unit = "N s/MPa", typical = "3 N s/MPa", low = "0 N s/MPa", high = "1 N s/kPa", prior = "3 N s/MPa +- 10 %" }
angle = { unit = "deg", typical = "25 deg", low = "0.1 rad", high = "90 °" }

[effects.first]
title = "One"
force = 'k'
parameters.k = { unit = "N", typical = "5 N", low = "-1 N", high = "+1e1 N" }
"#;
    let effects = from_toml(text, "e.toml").unwrap();
    assert_eq!(effects.iter().map(|effect| effect.name.as_str()).collect::<Vec<_>>(), ["second", "first"]);
    let effect = &effects[0];
    assert_eq!(effect.about.as_deref(), Some("Rubber \"creeps\"."));
    assert_eq!(
        (effect.source.as_deref(), effect.family.as_deref()),
        (Some("A. Author, 1999, eq. 3"), Some("material"))
    );
    assert_eq!(effect.twins, ["force-offset", "hose-stiffness"]);
    let [k, drag, angle] = effect.parameters.as_slice() else { panic!("three parameters") };
    assert_eq!(
        (k.name.as_str(), k.factor, k.typical, k.high, k.about.as_deref()),
        ("k", 1e3, 1e3, 2e3, Some("stiffness"))
    );
    assert_eq!((drag.unit.as_str(), drag.typical, drag.high), ("N s/MPa", 3e-6, 1e-3));
    assert!(
        drag.prior.is_some_and(|(mean, width)| (mean - 3e-6).abs() < 1e-20 && (width - 3e-7).abs() < 1e-20)
    );
    assert_eq!(drag.dimension.to_string(), "m^2 s");
    assert!(
        (angle.typical.to_degrees() - 25.0).abs() < 1e-12 && (angle.high.to_degrees() - 90.0).abs() < 1e-12
    );
}

#[test]
fn what_an_effect_needs() {
    refused("", (1, 1), &["states no effect", "[effects.hose-stiffness]"]);
    refused("# nothing\n", (1, 1), &["states no effect"]);
    refused("[effects]\n", (1, 2), &["states no effect"]);
    refused("effects = 3", (1, 11), &["`effects` is a number, but must be a table"]);
    refused("[effect.a]\n", (1, 2), &["unknown key `effect` in the file", "did you mean `effects`?"]);
    refused("name = \"x\"\n", (1, 1), &["unknown key `name`", "known here: effects"]);
    refused("[effects]\nhose = 1", (2, 8), &["`hose` is a number", "[effects.hose]"]);
    refused(
        "[effects.Hose]\n",
        (1, 10),
        &["`Hose` is no name of an effect", "lower-case words with hyphens"],
    );
    refused("[effects.hose_x]\n", (1, 10), &["no name of an effect"]);
    refused("[effects.\"\"]\n", (1, 10), &["no name of an effect"]);
    refused(&format!("[effects.{}]\n", "a".repeat(65)), (1, 10), &["at most 64"]);
    refused("[effects.hose]\n", (1, 10), &["the effect `hose` needs `title`", "add such as `title = "]);
    refused(&with("force =", "# force ="), (1, 10), &["needs `force`", "add such as `force = "]);
    refused(&with("force =", "forces ="), (3, 1), &["unknown key `forces`", "did you mean `force`?"]);
    refused(
        &with("title =", "colour = 1\ntitle ="),
        (2, 1),
        &["known here: title, force, energy, area, twist, about"],
    );
    refused(
        &with("\"Hose pulls on the muscle\"", "3"),
        (2, 9),
        &["`title` is a number, but must be text in quotes"],
    );
    refused(&with("Hose pulls on the muscle", " "), (2, 9), &["`title` is empty"]);
    refused(&with("Hose pulls", &"x".repeat(200)), (2, 9), &["at most 120"]);
    refused(&with("force =", "twins = \"a\"\nforce ="), (3, 9), &["`twins` is text, but must be a list"]);
    refused(&with("force =", "twins = [\"a\", 3]\nforce ="), (3, 15), &["is a number"]);
    refused(&with("force =", "twins = [\"a b\"]\nforce ="), (3, 10), &["`a b` is no name"]);
    refused(&with("force =", "twins = [\"a\", \"a\"]\nforce ="), (3, 15), &["named twice"]);
    refused(&with("force =", "twins = [\"hose-stiffness\"]\nforce ="), (3, 10), &["its own twin"]);
    refused(&format!("{EXAMPLE}{EXAMPLE}"), (6, 10), &["not TOML", "duplicate key", "state each key once"]);
    refused("[effects.a\n", (1, 11), &["not TOML", "each line is"]);
    refused(
        &with("\"Hose pulls on the muscle\"", "Hose"),
        (2, 9),
        &["not TOML", "put text in quotes: `title = \"Hose\"`"],
    );
}

#[test]
fn mechanism_and_form() {
    let read = |lines: &str| {
        let effects = from_toml(&with("force =", &format!("{lines}\nforce =")), "e.toml").unwrap();
        (effects[0].mechanism, effects[0].form)
    };
    assert_eq!(
        read("mechanism = \"give-of-the-rig\"\nform = \"near\""),
        (Mechanism::GiveOfTheRig, Form::Near)
    );
    // A family of the catalogue has a mechanism. Any other family gets the user's own.
    assert_eq!(read("family = \"membrane-axial\""), (Mechanism::Rubber, Form::Loose));
    assert_eq!(read("family = \"hoses\"\nform = \"exact\""), (Mechanism::User, Form::Exact));
    let card = from_toml(&with("force =", "form = \"exact\"\nforce ="), "e.toml").unwrap();
    assert_eq!(crate::Effect::card(&card[0]).form, Form::Exact);

    refused(
        &with("force =", "mechanism = \"dry-fricton\"\nforce ="),
        (3, 13),
        &["`mechanism` is \"dry-fricton\", but must be one of", "write `mechanism = \"dry-friction\"`"],
    );
    refused(
        &with("force =", "mechanism = \"magnetism\"\nforce ="),
        (3, 13),
        &["must be one of: dry-friction, "],
    );
    refused(
        &with("force =", "family = \"creep\"\nmechanism = \"rubber\"\nforce ="),
        (4, 13),
        &["`creep` is a family of the mechanism `relaxation`, not `rubber`", "leave the mechanism out"],
    );
    refused(
        &with("force =", "form = \"good\"\nforce ="),
        (3, 8),
        &["`form` is \"good\", but must be one of: exact, near, loose", "form = \"near\""],
    );
    refused(&with("force =", "form = 1\nforce ="), (3, 8), &["`form` is a number", "form = \"loose\""]);
}

#[test]
fn what_a_formula_needs() {
    refused(&with("eps -", "epss -"), (3, 16), &["unknown name `epss`", "parameters here: k, eps_free"]);
    refused(&with("-k *", ""), (3, 11), &["gives a pure number, but must give a force (N)"]);
    let escaped = with("-k * (eps", "\\u002dk * (epss");
    refused(&escaped, (3, 9), &["unknown name `epss`"]);
    let lines = with("\"-k * (eps - eps_free)\"", "\"\"\"\n-k *\n  (epss - eps_free)\"\"\"");
    refused(&lines, (5, 4), &["unknown name `epss`"]);
    refused(&with("\"-k * (eps - eps_free)\"", "'-k * (epss - eps_free)'"), (3, 16), &["unknown name"]);
    refused(&with("\"-k * (eps - eps_free)\"", "5"), (3, 9), &["`force` is a number"]);
    refused(&with("-k * (eps - eps_free)", ""), (3, 9), &["`force` is empty"]);
    refused(
        &with(" - eps_free", ""),
        (5, 12),
        &["`eps_free` does not occur in `force`", "delete `parameters.eps_free`"],
    );
    let deep = "(".repeat(9000);
    refused(&with("-k *", &deep), (3, 75), &["64 levels deep"]);
}

#[test]
fn what_a_parameter_needs() {
    let line = "parameters.eps_free = { unit = \"1\", typical = 0.1, low = -0.1, high = 0.4 }";
    let other = |to: &str| with(line, to);
    refused(&other("parameters.eps_free = 3"), (5, 23), &["`eps_free` is a number, but must be a table"]);
    refused(&other("parameters.eps_free = {}"), (5, 12), &["the parameter `eps_free` needs `unit`"]);
    refused(
        &other("parameters.eps = { unit = \"1\" }"),
        (5, 12),
        &["`eps` is a variable already: contraction", "delete it and use the variable"],
    );
    refused(&other("parameters.max = { unit = \"1\" }"), (5, 12), &["`max` is a function already"]);
    refused(&other("parameters.\"2x\" = { unit = \"1\" }"), (5, 12), &["`2x` is no name of a parameter"]);
    refused(&with("unit = \"N\"", "unit = \"nN\""), (4, 25), &["unknown unit `nN`", "`mN`"]);
    refused(&with("unit = \"N\"", "unit = 3"), (4, 25), &["`unit` is a number"]);
    refused(&with("unit = \"N\"", "unit = \"degC\""), (4, 25), &["293.15 K"]);
    refused(
        &with("unit = \"N\"", "unit = \"bar\""),
        (4, 56),
        &["`low` is a force (N), but a parameter in `bar` needs a pressure (Pa)", "low = \"50 bar\""],
    );
    refused(
        &with("\"50 N\"", "50"),
        (4, 40),
        &["`typical` has no unit, but a parameter in `N` needs a force (N)", "typical = \"50 N\""],
    );
    refused(&with("\"50 N\"", "\"50 Nn\""), (4, 40), &["unknown unit `Nn`"]);
    refused(&with("\"50 N\"", "\"1e400 N\""), (4, 40), &["not a finite number"]);
    refused(&with("\"50 N\"", "true"), (4, 40), &["is true or false"]);
    refused(&with("0.1,", "0x1,"), (5, 47), &["must be a number with its unit", "typical = 0.5"]);
    refused(&with("0.1,", "nan,"), (5, 47), &["not a finite number"]);
    refused(&with("0.1,", "inf,"), (5, 47), &["not a finite number"]);
    refused(
        &with("unit = \"1\"", "unit = \"%\""),
        (5, 58),
        &["`low` has no unit, but the parameter is in `%`", "low = \"50 %\""],
    );
    refused(&with("low = -0.1, ", ""), (5, 12), &["the parameter `eps_free` needs `low`", "add `low = 0.5`"]);
    refused(
        &with("low = \"0 N\"", "low = \"500 N\""),
        (4, 54),
        &["`low` is 500 N, but must be less than `high`, 500 N"],
    );
    refused(
        &with("typical = 0.1", "typical = 0.5"),
        (5, 47),
        &["`typical` is 0.5, outside of its bounds -0.1 to 0.4"],
    );
    refused(&with("50 N +- 30 N", "50 N"), (4, 85), &["`prior` has no standard deviation", "50 N +- 10 N"]);
    refused(&with("50 N +- 30 N", "50 N +- 0 N"), (4, 85), &["greater than 0"]);
    refused(&with("50 N +- 30 N", "50 N +- 3 bar"), (4, 85), &["is a pressure"]);
    refused(
        &with("50 N +- 30 N", "501 N +- 30 N"),
        (4, 85),
        &["mean of `prior` is 501 N, outside of its bounds 0 N to 500 N"],
    );
    refused(
        &with("prior =", "prio ="),
        (4, 77),
        &["unknown key `prio` in the parameter `k`", "did you mean `prior`?"],
    );
    let first = EXAMPLE.lines().take(3).collect::<Vec<_>>().join("\n");
    refused(&first, (1, 10), &["the effect `hose-stiffness` has no parameter", "add `parameters.k = "]);
    refused(&format!("{first}\nparameters = {{}}"), (4, 1), &["has no parameter"]);
    refused(&format!("{first}\nparameters = 3"), (4, 14), &["`parameters` is a number"]);
    let one = |i: usize| {
        format!("\nparameters.k{i} = {{ unit = \"N\", typical = \"1 N\", low = \"0 N\", high = \"2 N\" }}")
    };
    let many = (0..13).map(one).collect::<String>();
    refused(&format!("{first}{many}"), (16, 12), &["has 13 parameters, but at most 12 are read"]);
    let twelve = (0..12).map(one).collect::<String>();
    let sum = (0..12).map(|i| format!("k{i}")).collect::<Vec<_>>().join("+");
    let text = format!("{}{twelve}", first.replace("-k * (eps - eps_free)", &sum));
    assert_eq!(from_toml(&text, "e").unwrap()[0].parameters.len(), 12);
}

#[test]
fn files_that_cannot_be_read() {
    let folder = std::env::temp_dir().join(format!("bulge-effects-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("e.toml");
    let message = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        read(&path).map(|effects| effects.len()).map_err(|error| error.to_string())
    };
    assert_eq!(message(EXAMPLE.as_bytes()), Ok(1));
    assert_eq!(message(EXAMPLE.replace('\n', "\r\n").as_bytes()), Ok(1));
    assert_eq!(message(format!("\u{feff}{EXAMPLE}").as_bytes()), Ok(1));
    assert!(message(b"a = 1\n\xff").unwrap_err().contains("e.toml:2:1: byte 6 is not UTF-8 text"));
    assert!(
        message(&vec![b'#'; (1 << 20) + 1])
            .unwrap_err()
            .contains("larger than 1 MiB, so it is no effects file")
    );
    assert!(from_toml(&"#".repeat((1 << 20) + 1), "e").is_err());
    assert!(read(&folder).unwrap_err().to_string().contains("this is a directory, not an effects file"));
    assert!(read(folder.join("none.toml")).unwrap_err().to_string().contains("there is no such file"));
    std::fs::remove_dir_all(&folder).unwrap();
}
