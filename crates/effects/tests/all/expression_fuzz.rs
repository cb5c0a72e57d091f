//! Formulas and effect files from random and damaged text give an answer or a message quickly, and never a
//! panic.

use bulge_effects::expression::{Expression, MAX_BYTES, VARIABLES};
use bulge_effects::user;
use bulge_muscles::{Dimension, units};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRng, TestRunner};

const PARAMETERS: [(&str, Dimension); 3] =
    [("k", Dimension::FORCE), ("eps_c", Dimension::NONE), ("mu", Dimension::AREA)];

/// A text that is read must evaluate, be written and be read again. A text that is refused must have a place
/// and a reason.
fn check_formula(text: &str) {
    for result in [Dimension::FORCE, Dimension::NONE] {
        match Expression::parse(text, &PARAMETERS, result) {
            Ok(formula) => {
                let _: f64 = formula.evaluate(&[0.5; VARIABLES.len()], &[0.25; 3]);
                let again = Expression::parse(&formula.to_string(), &PARAMETERS, result);
                assert_eq!(again.as_ref(), Ok(&formula), "{text:?}");
            }
            Err(error) => {
                assert!(text.get(error.span()).is_some(), "{text:?}: {:?}", error.span());
                assert!(!error.what().is_empty() && !error.instead().is_empty(), "{error}");
                assert!(error.to_string().len() < 4000, "{error}");
            }
        }
    }
}

fn check_file(text: &str) {
    match user::from_toml(text, "effects.toml") {
        Ok(effects) => {
            for effect in effects {
                assert!((1..=user::MAX_PARAMETERS).contains(&effect.parameters.len()));
                for parameter in &effect.parameters {
                    assert!(parameter.low <= parameter.typical && parameter.typical <= parameter.high);
                    assert!(parameter.low < parameter.high && parameter.high.is_finite());
                }
            }
        }
        Err(error) => {
            assert!(!error.what().is_empty() && !error.instead().is_empty(), "{error}");
            assert!(error.to_string().len() < 8000, "{error}");
        }
    }
}

/// The same texts every time, so that a failure is reproducible.
fn runner(cases: u32) -> TestRunner {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let random = TestRng::deterministic_rng(config.rng_algorithm);
    TestRunner::new_with_rng(config, random)
}

/// A sequence of some of these pieces.
fn pieces(of: &'static [&'static str], most: usize) -> impl Strategy<Value = String> {
    prop::collection::vec(prop::sample::select(of), 0..most).prop_map(|pieces| pieces.concat())
}

/// A text with some characters replaced, inserted, cut out or repeated.
fn damaged(text: &'static str) -> impl Strategy<Value = String> {
    let change = (any::<prop::sample::Index>(), 0..4_u8, any::<char>(), 0..20_usize);
    prop::collection::vec(change, 1..6).prop_map(move |changes| {
        let mut characters: Vec<char> = text.chars().collect();
        for (place, kind, character, length) in changes {
            if characters.is_empty() {
                break;
            }
            let at = place.index(characters.len());
            let end = (at + length).min(characters.len());
            match kind {
                0 => characters[at] = character,
                1 => characters.insert(at, character),
                2 => drop(characters.drain(at..end)),
                _ => {
                    let again: Vec<char> = characters[at..end].to_vec();
                    characters.splice(at..at, again);
                }
            }
        }
        characters.into_iter().collect()
    })
}

fn check_all(cases: u32, texts: &impl Strategy<Value = String>, check: fn(&str)) {
    let outcome = runner(cases).run(texts, |text| {
        check(&text);
        Ok(())
    });
    assert!(outcome.is_ok(), "{outcome:?}");
}

#[test]
fn random_formulas() {
    const WORDS: &[&str] = &[
        "k",
        "eps",
        "p",
        "mu",
        "eps_c",
        "pressure",
        "pi",
        "x",
        "1",
        "0",
        "2.5",
        "1e3",
        "1e-400",
        "1e400",
        "3 [N]",
        "20 [%]",
        "[",
        "]",
        "[N",
        "(",
        ")",
        "+",
        "-",
        "*",
        "/",
        "^",
        ",",
        "<",
        ">=",
        "=",
        "max(",
        "min(",
        "if(",
        "sqrt(",
        "exp(",
        "clamp(",
        " ",
        "\n",
        "\t",
        ".",
        "\u{b5}",
        "\u{3b5}",
        "\u{2212}",
        "\u{1f600}",
        "\u{0}",
        "^2",
        "^0.5",
        "e",
        "%",
    ];
    check_all(20_000, &pieces(WORDS, 40), check_formula);
    check_all(5_000, &".{0,80}", check_formula);
}

#[test]
fn damaged_formulas() {
    const TEXT: &str = "-mu * p * (1 - eps) * direction + k*max(0, eps - eps_c)^2 \
         + if(rate < 1 [1/s], 3 [N], 2 [kN]*tanh(eps))";
    assert!(Expression::parse(TEXT, &PARAMETERS, Dimension::FORCE).is_ok());
    check_all(10_000, &damaged(TEXT), check_formula);
}

#[test]
fn random_and_damaged_files() {
    const LINES: &[&str] = &[
        "[effects.a]\n",
        "[effects.b]\n",
        "[effects]\n",
        "title = \"t\"\n",
        "force = \"k\"\n",
        "force = \"k*eps\"\n",
        "force = 3\n",
        "parameters.k = { unit = \"N\", typical = \"1 N\", low = \"0 N\", high = \"2 N\" }\n",
        "parameters.k.unit = \"N\"\n",
        "parameters.k.low = 0\n",
        "parameters.k.prior = \"1 +- 1 N\"\n",
        "parameters = []\n",
        "twins = [\"c\"]\n",
        "twins = []\n",
        "[[effects.a]]\n",
        "a.b.c = 1\n",
        "\u{feff}",
        "\"\\u0000\" = 1\n",
        "x = 1979-05-27\n",
    ];
    check_all(5_000, &damaged(user::EXAMPLE), check_file);
    check_all(2_000, &".{0,120}", check_file);
    check_all(10_000, &pieces(LINES, 12), check_file);
}

#[test]
fn random_units() {
    const UNITS: &[&str] = &[
        "N", "Pa", "mm", "s", "K", "%", "1", "2", "0.5", "^", "/", "*", ".", " ", "(", ")", "-", "+-",
        "\u{b5}", "\u{b2}", "deg", "degC", "x", "9",
    ];
    let check = |text: String| {
        let _ = units::unit(&text);
        if let Ok((value, width)) = units::any_with_width(&text) {
            prop_assert!(value.si.is_finite() && width.is_none_or(|width| width >= 0.0));
            let back =
                units::any(&units::exact_any_text(value.si, &value.unit)).map(|back| back.si.to_bits());
            prop_assert_eq!(back, Ok(value.si.to_bits()), "{}", text);
        }
        Ok(())
    };
    runner(20_000).run(&pieces(UNITS, 24), check).unwrap();
}

#[test]
fn texts_that_are_too_much() {
    for piece in
        ["(", "[", "-", "k+", "1^", "max(", "if(", "k k", "\"", "\\", "1e", ".", "<", "\u{1f600}", "n", "[["]
    {
        for count in [100, 5_000, 100_000] {
            let text = piece.repeat(count);
            check_formula(&text);
            check_file(&text);
            let parameter = "parameters.k = { unit = 'N' }";
            check_file(&format!("[effects.a]\ntitle = \"a\"\nforce = '{text}'\n{parameter}\n"));
            check_file(&format!("[effects.a]\ntitle = \"a\"\nforce = \"k\"\nparameters.k.unit = '{text}'\n"));
            check_file(&format!("effects = {text}"));
        }
    }
    for count in [100, 5_000, 100_000] {
        check_file(&format!("effects.{}a = 1", "a.".repeat(count)));
    }
    check_formula(&format!("k{}", "*eps".repeat(MAX_BYTES / 4 - 1)));
    let effect = |i: usize| user::EXAMPLE.replace("hose-stiffness", &format!("hose{i}"));
    check_file(&(0..2000).map(effect).collect::<String>());
}
